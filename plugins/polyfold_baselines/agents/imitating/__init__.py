"""Agents that fold as demonstrations or random drags taught their networks."""
