"""Segmenters for photographs: textured or shadowed tables, a picture of the empty one, boxes, strokes and prompts."""
