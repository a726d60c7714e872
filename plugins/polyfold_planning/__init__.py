"""Planners: from a sentence to fold lines."""
