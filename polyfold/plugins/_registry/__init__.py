"""What is registered: where it comes from, how it is found, and how it reaches other processes."""
