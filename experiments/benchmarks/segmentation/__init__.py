"""How well cloth is told from the table on photographs; ``python -m experiments.benchmarks.segmentation``."""
