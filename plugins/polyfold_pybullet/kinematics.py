"""Where an arm's tool is, and joint angles that put it where it is wanted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold_pybullet.robots import Arm, Chain, read_chain

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Reached:
    """Joint angles for a pose of the tool.

    Attributes:
        joints: joint angles [rad, m], shape (N,).
        position_error: how far the tool is off [m].
        rotation_error: by what angle [rad].
    """

    joints: Floats
    position_error: float
    rotation_error: float


@dataclass(frozen=True)
class OutOfReach:
    """No joint angles within limits were found for a pose.

    Attributes:
        reason: one line.
    """

    reason: str


class Kinematics:
    """Forward and inverse kinematics of one arm, in the world's frame. Compiled on first use.

    Inverse kinematics is damped least squares on the arm's own chain, from the posture that is nearest first and then
    from others; what the redundant joint is free to do goes towards the home posture. The same pose is always
    answered alike.

    Args:
        arm: the arm.
        position_tolerance, rotation_tolerance: of inverse kinematics [m], [rad].
        restarts: from how many other postures it tries.
        margin: how far answers stay from the joints' limits [rad, m].
    """

    def __init__(
        self,
        arm: Arm,
        position_tolerance: float = 1e-4,
        rotation_tolerance: float = 1e-3,
        restarts: int = 500,
        margin: float = 0.0,
    ) -> None:
        self.arm = arm
        self.chain: Chain = read_chain(arm)
        self.home = np.array(arm.home)
        self.park = np.array(arm.park if arm.park is not None else arm.home)
        self._tolerances = (position_tolerance, rotation_tolerance)
        chain = self.chain
        lower, upper = chain.lower + margin, chain.upper - margin
        self._arrays = (chain.origins, chain.axes, chain.prismatic, chain.tool, lower, upper)
        self._reach = _reach(chain)
        rng = np.random.default_rng(0)
        anywhere = rng.uniform(lower, upper, (restarts, len(chain)))
        # Near home first: most poses of a task are reached from there.
        near = np.minimum(1.0, np.arange(1, restarts + 1) / 10)[:, None]
        self._starts = np.vstack([self.home, (1 - near) * self.home + near * anywhere])

    def forward(self, joints: ArrayLike) -> Floats:
        """Pose of the tool for joint angles, shape (N,): a matrix, shape (4, 4)."""
        return self.along(np.asarray(joints, float)[None])[0]

    def along(self, path: ArrayLike) -> Floats:
        """Poses of the tool, shape (T, 4, 4), for rows of joint angles, shape (T, N)."""
        from polyfold_pybullet.kernels.chains import tools_along

        path = np.ascontiguousarray(path, float)
        found = np.empty((len(path), 4, 4))
        tools_along(self._arrays, path, found)
        return found

    def jacobian(self, joints: ArrayLike) -> Floats:
        """Velocity and angular velocity of the tool in the world for each joint's, shape (6, N)."""
        from polyfold_pybullet.kernels.chains import forward

        chain = self.chain
        found, jacobian = np.empty((4, 4)), np.empty((6, len(chain)))
        forward(chain.origins, chain.axes, chain.prismatic, chain.tool, np.asarray(joints, float), found, jacobian)
        return jacobian

    def inverse(self, pose: ArrayLike, near: ArrayLike | None = None) -> Reached | OutOfReach:
        """Joint angles within limits that put the tool at a pose.

        Args:
            pose: of the tool in the world, shape (4, 4).
            near: joint angles to begin from, shape (N,); by default home.
        """
        pose = np.ascontiguousarray(pose, float)
        starts = self._starts if near is None else np.vstack([np.asarray(near, float), self._starts])
        answers = self._answers(pose, starts, 1)
        if not len(answers):
            return OutOfReach(self._why(pose))
        off, turned = self.error(answers[0], pose)
        return Reached(answers[0], off, turned)

    def postures(self, pose: ArrayLike, most: int = 4) -> Floats:
        """Up to ``most`` different postures for a pose, shape (K, N), the nearest to home first; K = 0 if none."""
        found = self._answers(np.ascontiguousarray(pose, float), self._starts, most)
        return found[np.argsort(np.abs(found - self.home).max(axis=1), kind="stable")] if len(found) else found

    def leaning(self, pose: ArrayLike, joints: ArrayLike, shares: Sequence[float]) -> Floats:
        """Other postures for a pose with the elbow turned to either side, shape (K, N); K = 0 without a free joint.

        Args:
            pose: of the tool, shape (4, 4).
            joints: joint angles that reach it, shape (N,).
            shares: how far to go along the free direction of the joints [rad].
        """
        from polyfold_pybullet.kernels.chains import descend

        joints = np.asarray(joints, float)
        if len(joints) < 7:
            return np.empty((0, len(joints)))
        free = np.linalg.svd(self.jacobian(joints))[2][-1]
        # Its sign is the solver's whim; let the largest part be positive.
        free = free * np.sign(free[np.abs(free).argmax()])
        pose, found = np.ascontiguousarray(pose, float), []
        for share in shares:
            wish = np.clip(joints + share * free, self.chain.lower, self.chain.upper)
            answer = np.empty(len(joints))
            if descend(self._arrays, pose, wish, wish, self._tolerances, 40, 15, answer):
                found.append(answer)
        return np.array(found).reshape(-1, len(joints))

    def follow(self, poses: ArrayLike, start: ArrayLike) -> Floats | None:
        """Joint angles, shape (T, N), along poses near each other, shape (T, 4, 4), each from the one before.

        Returns None where the arm can't follow without a leap: none of its joints may move by more than half a radian
        from one pose to the next.
        """
        from polyfold_pybullet.kernels.chains import descend

        poses = np.ascontiguousarray(poses, float)
        path = np.empty((len(poses), len(self.chain)))
        before = np.ascontiguousarray(start, float)
        for row, pose in zip(path, poses, strict=True):
            # Home draws the free joint, so it is drawn as little as the solver needs: a path must not creep.
            if not descend(self._arrays, pose, before, before, self._tolerances, 40, 0, row):
                return None
            if np.abs(row - before).max() > 0.5:
                return None
            before = row
        return path

    def error(self, joints: ArrayLike, pose: ArrayLike) -> tuple[float, float]:
        """How far the tool is from a pose: distance [m] and angle [rad]."""
        from polyfold_pybullet.kernels.chains import twist_between

        way = np.empty(6)
        twist_between(self.forward(joints), np.ascontiguousarray(pose, float), way)
        return float(np.linalg.norm(way[:3])), float(np.linalg.norm(way[3:]))

    def _answers(self, pose: Floats, starts: Floats, wanted: int) -> Floats:
        from polyfold_pybullet.kernels.chains import solve

        answers = np.empty((wanted, len(self.chain)))
        if self._away(pose) > self._reach:
            return answers[:0]
        count = solve(
            self._arrays, pose, self.home, np.ascontiguousarray(starts), self._tolerances, 30, 15, wanted, answers
        )
        return answers[:count]

    def _why(self, pose: Floats) -> str:
        """Whether it is too far away, or only can't be reached like this."""
        away, (x, y, z) = self._away(pose), pose[:3, 3]
        where = f"the {self.arm.name} arm can't reach ({x:.3f}, {y:.3f}, {z:.3f}) m"
        if away > self._reach:
            return f"{where}: it is {away:.2f} m from its shoulder, farther than {self._reach:.2f} m"
        return f"{where} with the hand turned like this within the limits of its joints"

    def _away(self, pose: Floats) -> float:
        """From the first joint to a pose [m]."""
        return float(np.linalg.norm(pose[:3, 3] - self.chain.origins[0][:3, 3]))


def _reach(chain: Chain) -> float:
    """The length of the stretched arm [m]: nothing beyond it can be reached."""
    links = sum(float(np.linalg.norm(link[:3, 3])) for link in (*chain.origins[1:], chain.tool))
    return links + float(np.abs([chain.lower, chain.upper]).max(axis=0)[chain.prismatic].sum())
