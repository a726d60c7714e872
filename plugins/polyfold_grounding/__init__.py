"""Groundings: from a picture to what a planner reasons about."""
