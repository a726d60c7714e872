"""The standard parts: four garment kinds, their polygon templates, a colour segmenter and the task suites."""
