"""Shapes: which part of the garment a noun phrase means, and where the fold line of a fold lies."""
