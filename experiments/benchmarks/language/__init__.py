"""Measurements of language models and of the way to them."""
