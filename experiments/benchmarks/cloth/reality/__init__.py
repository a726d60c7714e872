"""Textile tests of the simulated cloth beside published ones: ``python -m experiments.benchmarks.cloth.reality``."""
