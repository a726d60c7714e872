"""Agents that try what might be done, in a simulator or in a learned model, and do the best of it."""
