"""Fold-line-guided pick-and-place policies."""
