"""Parts, outlines and creases: where on the garment the words point."""
