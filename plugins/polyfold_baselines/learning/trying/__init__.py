"""Learning by trying folds: the environment, and the training in it."""
