"""Wishes: sentences that name a purpose, a size or a shape instead of folds, and the folds that grant them."""
