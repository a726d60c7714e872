"""Learning from recorded folds."""
