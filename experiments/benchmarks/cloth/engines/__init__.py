"""Half folds in our simulator and in other engines, side by side."""
