"""Measurements of the simulated cloth."""
