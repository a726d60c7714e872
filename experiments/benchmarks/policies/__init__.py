"""Measurements of learned policies on garments that they never saw."""
