"""An example plugin: one policy."""
