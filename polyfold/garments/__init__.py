"""Garments: triangle meshes with named keypoints, and how to build them from panels, files and real outlines."""

from polyfold.garments.garment import Garment, Mesh
from polyfold.garments.naming import name_by_pose
from polyfold.garments.outline import Outline, curved_outline
from polyfold.garments.panels import mesh_panels

__all__ = ["Garment", "Mesh", "Outline", "curved_outline", "mesh_panels", "name_by_pose"]
