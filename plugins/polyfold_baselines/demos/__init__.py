"""Demonstrations: folds along true lines on training garments, as pictures with their picks and places."""
