"""Cloth as messages describe it: parts, fold lines on its vertices, picks and places."""
