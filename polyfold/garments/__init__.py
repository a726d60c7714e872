"""Garments: triangle meshes with named keypoints, their fabric, how they are cut and sewn, how corners are named.

Garments from files and pictures of real ones are made by :func:`polyfold.garment`.
"""

from polyfold.garments._fabric import Fabric
from polyfold.garments._garment import Garment, Mesh
from polyfold.garments._naming import name_by_pose
from polyfold.garments._outline import Outline, curved_outline
from polyfold.garments._outline_files import samples
from polyfold.garments._panels import mesh_panels
from polyfold.garments._pattern import Pattern
from polyfold.garments._silhouette import find_cloth

__all__ = [
    "Fabric",
    "Garment",
    "Mesh",
    "Outline",
    "Pattern",
    "curved_outline",
    "find_cloth",
    "mesh_panels",
    "name_by_pose",
    "samples",
]
