"""Agents that ask a language model what to move where."""
