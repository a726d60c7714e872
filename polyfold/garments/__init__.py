"""Garments: triangle meshes with named keypoints, and how to build them from panels, files and real outlines."""

from polyfold.garments._garment import Garment, Mesh
from polyfold.garments._naming import name_by_pose
from polyfold.garments._obj import load_obj
from polyfold.garments._outline import Outline, curved_outline
from polyfold.garments._outline_files import load_mask, load_outline, load_picture, outline_from_photo
from polyfold.garments._panels import mesh_panels
from polyfold.garments._pattern import Pattern
from polyfold.garments._silhouette import find_cloth
from polyfold.garments._twin import twin_from_outline

__all__ = [
    "Garment",
    "Mesh",
    "Outline",
    "Pattern",
    "curved_outline",
    "find_cloth",
    "load_mask",
    "load_obj",
    "load_outline",
    "load_picture",
    "mesh_panels",
    "name_by_pose",
    "outline_from_photo",
    "twin_from_outline",
]
