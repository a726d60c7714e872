"""Fitting the polygon model to a silhouette: flat garments at any rotation, then from fold to fold."""
