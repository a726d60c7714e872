"""What a cell looks like to a colour camera: the table's texture, light, shadows and the sensor's grain."""

from polyfold_pybullet.scenery.pictures import PaintedCell, Scenery

__all__ = ["PaintedCell", "Scenery"]
