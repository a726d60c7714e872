"""Options that several verbs share: numbers, components, which garment."""
