"""Measurements of the polygon fit."""
