"""The cell in PyBullet: what stands in it, how near things are to each other, and what it looks like."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import SimulationError
from polyfold_pybullet.bodies import Body, check_names, imported, load_body, readable
from polyfold_pybullet.robots import Arm, RobotModel, with_lean_hulls, written_part

Floats = NDArray[np.float64]


TABLE, TORSO = "the table", "the torso"


def _post_of(arm: Arm) -> str:
    return f"the post of the {arm.name} arm"


@dataclass(frozen=True)
class Clearances:
    """How far apart things must stay [m].

    Attributes:
        arms: one arm from the other.
        obstacles: an arm from the torso, the posts and the table.
        hands: a hand with its fingers, which picks from the table, from the table; negative where soft tips may press.
        itself: links of an arm that are not neighbours, from each other.
    """

    arms: float = 0.015
    obstacles: float = 0.010
    hands: float = -0.003
    itself: float = 0.002


@dataclass(frozen=True)
class Near:
    """Two things that are nearer than they may be.

    Attributes:
        one, other: what they are.
        distance: between them [m]; negative if they overlap.
    """

    one: str
    other: str
    distance: float

    def __str__(self) -> str:
        where = "overlap" if self.distance < 0 else "are apart"
        return f"{self.one} and {self.other} {where} by {1000 * abs(self.distance):.0f} mm"


class Cell:
    """Two arms at a table in PyBullet, without a window. Loaded by ``open``, or on entering ``with``.

    Args:
        model: the robot.
        clearances: how far apart things must stay.
        lean: measure finely meshed links by hulls that are up to a millimetre smaller, many times faster.
    """

    def __init__(self, model: RobotModel, clearances: Clearances | None = None, lean: bool = True) -> None:
        self.model = model
        self._lean = lean
        self.clearances = clearances or Clearances()
        self._client: int | None = None
        self._cloth: int | None = None
        self.arms: list[Body] = []
        self._obstacles: list[tuple[str, Body]] = []
        self._bounds: list[tuple[int, Sequence[float], Sequence[float]]] = []

    def open(self) -> Cell:
        """Load the cell; nothing if it is loaded."""
        if self._client is not None:
            return self
        pybullet = self._bullet
        client = pybullet.connect(pybullet.DIRECT)
        if client < 0:
            raise SimulationError("PyBullet has no room for another cell; close others first")
        self._client = client
        try:
            self._load()
        except Exception as error:
            self.close()
            if type(error) is pybullet.error:
                raise SimulationError(f"PyBullet can't load {self.model.name!r} ({error}); check its URDF") from None
            raise
        return self

    def close(self) -> None:
        """Free it; nothing if it is not loaded."""
        if self._client is not None:
            self._bullet.disconnect(self._client)
            self._client = None
        self.arms, self._obstacles, self._cloth = [], [], None

    def __enter__(self) -> Cell:
        return self.open()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    @property
    def client(self) -> int:
        """PyBullet's number of the loaded cell. Raises SimulationError if it is not loaded."""
        if self._client is None:
            raise SimulationError("the cell is closed; open it first")
        return self._client

    @property
    def _bullet(self) -> Any:
        return imported()

    def set_arm(self, arm: int, joints: ArrayLike) -> None:
        """Put an arm, 0 or 1, at joint angles [rad, m], shape (N,), at once and without dynamics."""
        reset, client, body = self._bullet.resetJointState, self.client, self.arms[arm]
        for joint, value in zip(body.joints, np.asarray(joints, float), strict=True):
            reset(body.number, joint, value, physicsClientId=client)

    def set_hand(self, arm: int, width: float) -> None:
        """Put each finger of an arm's hand at a position [m]."""
        body = self.arms[arm]
        for joint in body.fingers:
            self._bullet.resetJointState(body.number, joint, width, physicsClientId=self.client)

    def obstacles(self, arm: int) -> list[tuple[str, int, list[int]]]:
        """What stands in an arm's way, as names, PyBullet's numbers, and the arm's links that it may not be near to.

        An arm's base stands where it stands; its first link hangs on the torso, and its first two turn over its post.
        """
        body = self.arms[arm]
        last = {TORSO: body.joints[0], _post_of(self.model.arms[arm]): body.joints[min(1, len(body.joints) - 1)]}
        return [
            (what, other.number, [link for link in body.links if link > last.get(what, -1)])
            for what, other in self._obstacles
        ]

    def near_obstacles(self, arm: int, joints: ArrayLike, pressing: bool = False) -> Near | None:
        """What an arm at joint angles, shape (N,), is too near to, itself included; None if nothing.

        With ``pressing`` its fingertips may press on the table, as they do where they take cloth.
        """
        self.set_arm(arm, joints)
        body, limits = self.arms[arm], self.clearances
        over_table = limits.hands if pressing else max(0.0, limits.hands)
        for what, number, links in self.obstacles(arm):
            for link, distance in self._links_near(body, number, links, what == TORSO):
                if distance < (over_table if what == TABLE and link in body.tips else limits.obstacles):
                    return Near(self._name(arm, link), what, distance)
        for one, other in body.pairs:
            for _, _, distance in self._closest(body.number, body.number, limits.itself, one, other):
                if distance < limits.itself:
                    return Near(self._name(arm, one), self._name(arm, other), distance)
        return None

    def near_each_other(self, left: ArrayLike, right: ArrayLike) -> Near | None:
        """Which parts of the arms are too near to each other at joint angles, shape (N,) each; None if none."""
        self.set_arm(0, left)
        self.set_arm(1, right)
        found = list(self._closest(self.arms[0].number, self.arms[1].number, self.clearances.arms))
        if not found:
            return None
        one, other, distance = min(found, key=lambda near: near[2])
        return Near(self._name(0, one), self._name(1, other), distance)

    def drape(
        self, vertices: ArrayLike, triangles: ArrayLike, colour: tuple[float, float, float] = (0.7, 0.3, 0.3)
    ) -> None:
        """Show cloth in pictures, in place of what was shown before; it is in nothing's way.

        Args:
            vertices: where it is [m], shape (N, 3).
            triangles: vertex indices, shape (T, 3); seen from both sides.
            colour: RGB, 0 to 1.
        """
        bullet, client = self._bullet, self.client
        if self._cloth is not None:
            bullet.removeBody(self._cloth, physicsClientId=client)
        one_side = np.asarray(triangles, int)
        shown = bullet.createVisualShape(
            bullet.GEOM_MESH, vertices=np.asarray(vertices, float).tolist(), rgbaColor=(*colour, 1.0),
            indices=np.concatenate([one_side, one_side[:, ::-1]]).ravel().tolist(), physicsClientId=client,
        )  # fmt: skip
        self._cloth = bullet.createMultiBody(0, -1, shown, physicsClientId=client)

    def picture(
        self,
        width: int = 640,
        height: int = 480,
        eye: Sequence[float] = (1.3, 0.9, 0.75),
        target: Sequence[float] = (0.0, -0.1, 0.15),
        field_of_view: float = 45.0,
    ) -> NDArray[np.uint8]:
        """What the cell looks like, rendered on the processor.

        Args:
            width, height: size [px].
            eye, target: where the camera is and what it looks at [m].
            field_of_view: vertical [deg].

        Returns:
            RGB, uint8, shape (height, width, 3).
        """
        bullet = self._bullet
        view = bullet.computeViewMatrix(eye, target, (0.0, 0.0, 1.0))
        lens = bullet.computeProjectionMatrixFOV(field_of_view, width / height, 0.05, 10.0)
        _, _, pixels, _, _ = bullet.getCameraImage(
            width, height, view, lens, shadow=1, lightDirection=(0.5, -0.6, 1.5), renderer=bullet.ER_TINY_RENDERER,
            physicsClientId=self.client,
        )  # fmt: skip
        return np.ascontiguousarray(np.reshape(pixels, (height, width, 4))[:, :, :3], np.uint8)

    def _closest(
        self, one: int, other: int, within: float, link: int | None = None, other_link: int | None = None
    ) -> Iterable[tuple[int, int, float]]:
        """Pairs of links of two bodies nearer than ``within``: their indices, and the distance between them [m]."""
        chosen = {} if link is None else {"linkIndexA": link, "linkIndexB": other_link}
        found = self._bullet.getClosestPoints(one, other, within, **chosen, physicsClientId=self.client)
        return ((near[3], near[4], near[8]) for near in found or ())

    def _links_near(self, body: Body, number: int, links: Sequence[int], torso: bool) -> Iterator[tuple[int, float]]:
        """Links of an arm, of those that count, that are near an obstacle, and how near [m].

        A torso is no convex body, so that measuring takes long; it is done link by link and only for those about it.
        """
        within = max(self.clearances.obstacles, self.clearances.hands)
        if not torso:
            yield from ((link, far) for link, _, far in self._closest(body.number, number, within) if link in links)
            return
        for other, low, high in self._bounds:
            for link in links:
                least, most = self._bullet.getAABB(body.number, link, physicsClientId=self.client)
                if all(least[k] < high[k] + within and low[k] - within < most[k] for k in range(3)):
                    yield from ((link, far) for _, _, far in self._closest(body.number, number, within, link, other))

    def _name(self, arm: int, link: int) -> str:
        return f"the {self.model.arms[arm].name} arm's {self.arms[arm].links.get(link, 'base')}"

    def _load(self) -> None:
        bullet, model = self._bullet, self.model
        bullet.resetSimulation(physicsClientId=self.client)
        self._obstacles = [(TABLE, self._box_from_to(*_table_corners(model), (0.93, 0.92, 0.89, 1.0)))]
        with tempfile.TemporaryDirectory() as folder:
            if any(arm.has_torso for arm in model.arms):
                self._obstacles.append((TORSO, self._load_torso(Path(folder))))
            self.arms = [self._load_arm(arm, Path(folder)) for arm in model.arms]
        if model.stands:
            for arm in model.arms:
                x, y, z = arm.base_position
                post = self._box_from_to((x - 0.1, y - 0.16, z - 0.6), (x + 0.1, y + 0.075, z), (0.35, 0.37, 0.4, 1.0))
                self._obstacles.append((_post_of(arm), post))
        for index, arm in enumerate(model.arms):
            self.set_arm(index, arm.home)
            self.set_hand(index, arm.open_width)
            self.arms[index] = self._with_pairs(self.arms[index])

    def _box_from_to(self, low: Sequence[float], high: Sequence[float], colour: Sequence[float]) -> Body:
        bullet, client = self._bullet, self.client
        half = (np.array(high) - low) / 2
        shape = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=half.tolist(), physicsClientId=client)
        seen = bullet.createVisualShape(
            bullet.GEOM_BOX, halfExtents=half.tolist(), rgbaColor=colour, physicsClientId=client
        )
        centre = ((np.array(high) + low) / 2).tolist()
        return Body(bullet.createMultiBody(0, shape, seen, centre, physicsClientId=client), {})

    def _load_torso(self, folder: Path) -> Body:
        whole = [arm for arm in self.model.arms if arm.has_torso]
        torso = load_body(self._bullet, self.client, written_part(whole, None, folder), whole[0])
        links = [-1, *torso.links]
        self._bounds = [
            (link, *self._bullet.getAABB(torso.number, link, physicsClientId=self.client)) for link in links
        ]
        return torso

    def _load_arm(self, arm: Arm, folder: Path) -> Body:
        if arm.has_torso:
            path = written_part([one for one in self.model.arms if one.has_torso], arm.name, folder)
        else:
            path = readable(Path(arm.urdf))
        body = load_body(self._bullet, self.client, with_lean_hulls(path, folder) if self._lean else path, arm)
        check_names(arm, body)
        return body

    def _with_pairs(self, body: Body) -> Body:
        """The body with the pairs of its links that can collide: no neighbours, and apart at home."""
        order = [*body.joints, *(link for link in body.links if link > body.joints[-1])]
        pairs = []
        for later, link in enumerate(order):
            for earlier in range(-1, later - 2):
                other = -1 if earlier < 0 else order[earlier]
                both_behind = other >= body.joints[-1]
                if not both_behind and not list(self._closest(body.number, body.number, 0.01, other, link)):
                    pairs.append((other, link))
        return Body(body.number, body.links, body.joints, body.fingers, body.tips, tuple(pairs))


def _table_corners(model: RobotModel) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    table = model.table
    return (table.x[0], table.y[0], -table.thickness), (table.x[1], table.y[1], 0.0)
