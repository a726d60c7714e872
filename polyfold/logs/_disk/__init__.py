"""How files of runs are written: whole or not at all, line by line, by one process at a time."""
