"""Plane and mask geometry, the camera and the directed fold line: pure functions and values."""

from polyfold.geometry._calibration import Calibration
from polyfold.geometry._camera import Camera
from polyfold.geometry._fold_line import FoldLine
from polyfold.geometry._masks import contour_of, iou, span_on_mask
from polyfold.geometry._plane import chamfer, mirror, polygon_area, resample, rotate, signed_distance, turn_onto

__all__ = [
    "Calibration",
    "Camera",
    "FoldLine",
    "chamfer",
    "contour_of",
    "iou",
    "mirror",
    "polygon_area",
    "resample",
    "rotate",
    "signed_distance",
    "span_on_mask",
    "turn_onto",
]
