"""Learning curves and action maps."""
