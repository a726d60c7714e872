"""The oracle, and the baselines that any method must beat."""
