"""Shared by the task tests: the suite, and garments laid flat under a camera without a simulator."""

from functools import cache

import numpy as np
from polyfold_standard.garments.pants import Pants
from polyfold_standard.garments.rectangle import Rectangle
from polyfold_standard.garments.square import Square
from polyfold_standard.garments.tshirt import TShirt

from polyfold.garments import name_by_pose
from polyfold.geometry import Camera, rotate
from polyfold.plugins import generate_garment
from polyfold.tasks import load_suite
from polyfold.types import SimState

KINDS = {"square": Square(), "rectangle": Rectangle(), "tshirt": TShirt(), "pants": Pants()}
SUITE = load_suite("polyfold_standard:tasks/polyfold70.toml")


@cache
def lay(kind, seed=2000, degrees=0.0, edge_length=0.02):
    """A garment and its state, flat on the table."""
    garment = generate_garment(kind, seed, edge_length)
    flat = rotate(garment.mesh.vertices, np.radians(degrees))
    positions = np.column_stack([flat, garment.fabric.thickness * (0.5 + garment.mesh.layer)])
    camera = Camera.framing(2 * np.hypot(*flat.T).max() / 0.8)
    keypoints = name_by_pose(garment.cyclic, garment.keypoints, positions)
    return garment, SimState(positions, np.zeros_like(positions), keypoints, camera)
