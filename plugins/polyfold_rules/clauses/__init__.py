"""Clauses: the folds that each frame asks for, given those before it."""
