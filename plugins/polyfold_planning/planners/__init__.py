"""Planners: from an instruction and what is seen to fold lines, or to picks and places."""
