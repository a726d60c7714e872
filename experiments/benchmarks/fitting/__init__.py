"""How well polygons are fitted; ``python -m experiments.benchmarks.fitting`` measures it."""
