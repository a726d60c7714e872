"""Garments: triangle meshes with named keypoints, and how to build them from panels, files and real outlines."""

from polyfold.garments.garment import Garment, Mesh

__all__ = ["Garment", "Mesh"]
