"""Random folds in simulation: what policies learn from."""
