"""The policies and the networks that they ask."""
