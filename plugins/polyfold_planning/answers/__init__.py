"""Answers of language models: asked for, read, checked, and sent back where they can't be used."""
