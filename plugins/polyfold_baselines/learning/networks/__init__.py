"""Networks from the cloth, and what is wanted of it, to picks and places."""
