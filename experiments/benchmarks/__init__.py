"""Measurements that can be run again: ``python -m polyfold.benchmark.<name>``."""
