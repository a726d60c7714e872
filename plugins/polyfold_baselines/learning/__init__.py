"""One way to train whatever learns from demonstrations: heatmaps of picks and places, budgets, checkpoints, weights."""
