"""Clauses: each says one fold, or what the whole should become."""
