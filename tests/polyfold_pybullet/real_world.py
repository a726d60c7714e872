"""A stand-in for a laboratory: simulated cloth that only a tilted camera sees and only planned arms move."""

from __future__ import annotations

import cv2
import numpy as np
from polyfold_pybullet.arms import PybulletArms

from polyfold import plugins
from polyfold.errors import RobotError
from polyfold.plugins.hardware import RgbdFrame
from polyfold.types import Action

CENTRE, TURN = (0.03, 0.02), np.radians(8.0)
"""Where the cloth's own world lies in the robot's."""
INTRINSICS = np.array([[610.0, 0.0, 319.5], [0.0, 610.0, 239.5], [0.0, 0.0, 1.0]])


def tilted(degrees=18.0, height=0.9, seen=(0.03, 0.02)):
    """Pose of a camera that looks at a point of the table from the side."""
    tilt = np.radians(degrees)
    along = np.array([0.0, np.sin(tilt), -np.cos(tilt)])
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([[1.0, 0.0, 0.0], np.cross(along, [1.0, 0.0, 0.0]), along])
    pose[:3, 3] = np.array([*seen, 0.0]) - along * height / np.cos(tilt)
    return pose


class World:
    """Cloth, and what happens to it."""

    def __init__(self, kind="rectangle", seed=2002, pose=None):
        self.cloth = plugins.create("simulators", "xpbd", {"rotation_deg": 10.0})
        self.garment = plugins.generate_garment(kind, seed, 0.022)
        self.cloth.reset(self.garment, seed)
        self.pose = tilted() if pose is None else pose
        self.moves = []
        self.stops = self.parked = 0
        self.dies_after = None
        self.looked = 0

    def to_robot(self, points):
        turn = np.array([[np.cos(TURN), -np.sin(TURN)], [np.sin(TURN), np.cos(TURN)]])
        return np.concatenate([points[..., :2] @ turn.T + CENTRE, points[..., 2:]], axis=-1)

    def to_cloth(self, points):
        turn = np.array([[np.cos(TURN), -np.sin(TURN)], [np.sin(TURN), np.cos(TURN)]])
        return np.concatenate([(points[..., :2] - CENTRE) @ turn, points[..., 2:]], axis=-1)

    def frame(self):
        """What the tilted camera measures: rays are followed down to where they meet the heights of the cloth."""
        seen, camera = self.cloth.observe(), self.cloth.state().camera
        risen = (camera.elevation - seen.depth).astype(np.float32)
        rows, columns = np.indices((480, 640))
        rays = np.stack([columns, rows, np.ones_like(rows)], axis=-1) @ np.linalg.inv(INTRINSICS).T
        ways = rays @ self.pose[:3, :3].T
        height = np.zeros((480, 640), np.float32)
        for _ in range(4):
            depth = (height - self.pose[2, 3]) / ways[..., 2]
            points = self.to_cloth(self.pose[:3, 3] + ways * depth[..., None])
            pixels = camera.to_pixels(points).astype(np.float32)
            height = cv2.remap(risen, pixels[..., 0], pixels[..., 1], cv2.INTER_LINEAR)
        rgb = cv2.remap(seen.rgb, pixels[..., 0], pixels[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return RgbdFrame(rgb, depth.astype(np.float32), INTRINSICS, self.pose)


def components(world):
    """A camera and a robot of that world, to be registered."""

    class Tripod:
        def connect(self):
            pass

        def close(self):
            pass

        def get_rgbd(self, frames=1):
            world.looked += 1
            if world.dies_after is not None and world.looked > world.dies_after:
                raise RobotError("the camera gave no picture within 1 s; is it plugged in?")
            return world.frame()

    class Arms(PybulletArms):
        def plan(self, picks, places):
            self.asked = np.array(picks), np.array(places)
            return super().plan(picks, places)

        def execute(self, plan, watch=None):
            super().execute(plan, watch)
            world.moves.append(plan.mode)
            picks, places = map(world.to_cloth, self.asked)
            camera = world.cloth.state().camera
            for arms in [[0], [1]] if plan.mode == "in sequence" else [list(range(len(picks)))]:
                heights = np.maximum(picks[arms, 2], 0.0)
                world.cloth.execute(Action(camera.to_pixels(picks[arms]), camera.to_pixels(places[arms]), heights))

        def park(self):
            world.parked += 1
            super().park()

        def stop(self):
            world.stops += 1
            super().stop()

    return Tripod, Arms
