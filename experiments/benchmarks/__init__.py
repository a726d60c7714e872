"""Measurements that can be run again: ``python -m experiments.benchmarks.<name>``."""
