"""Baselines that learn from demonstrations, each an agent: what PolyFold is compared with (Tables II and III)."""
