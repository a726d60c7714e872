"""Reading: sentence to program, by a small network, with how sure it is."""
