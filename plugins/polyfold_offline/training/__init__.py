"""Training of the reader: sentences with their meanings, varied, to weights."""
