"""Generators of the standard kinds of garment."""
