"""Where cloth comes to lie when it is dragged, learned from random drags: graphs of what is seen, and the network."""
