"""The values that flow through an episode: what a camera sees, what is planned, what is done, how it came out.

Frames and units: pixels are ``(x, y)``, y down, ``(0, 0)`` the centre of the top-left pixel. The world is in metres,
x right, y away from the viewer, z up from the table. :class:`Camera` is the only converter between the two.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold import geometry
from polyfold.errors import ActionError

if TYPE_CHECKING:
    from polyfold.polygon import FoldedModel

__all__ = ["Action", "ActionMap", "Camera", "Decision", "FoldLine", "Observation", "Scene", "SimState", "Subgoal"]

Floats = NDArray[np.float64]

ActionMap = tuple[Floats, Floats]
"""Places to pick [px], shape (N, 2), and how good a policy takes each for, shape (N,); higher is better."""


@dataclass(frozen=True)
class Camera:
    """A pinhole camera that looks straight down; its optical axis meets the table at the world's origin.

    Attributes:
        width, height: image size [px].
        focal: focal length [px].
        elevation: height of the pinhole above the table [m].
    """

    width: int = 400
    height: int = 400
    focal: float = 800.0
    elevation: float = 2.0

    @classmethod
    def framing(cls, extent: float, width: int = 400, height: int = 400, elevation: float = 2.0) -> Camera:
        """The camera whose image shows ``extent`` metres of the table along its shorter side."""
        return cls(width, height, min(width, height) * elevation / extent, elevation)

    @property
    def centre(self) -> tuple[float, float]:
        """Principal point [px]."""
        return (self.width - 1) / 2, (self.height - 1) / 2

    @property
    def pixels_per_metre(self) -> float:
        """Image scale at the height of the table [px/m]."""
        return self.focal / self.elevation

    def to_pixels(self, points: ArrayLike) -> Floats:
        """Project world points [m], shape (..., 2) on the table or (..., 3), to pixels, shape (..., 2)."""
        points = np.asarray(points, float)
        depth = self.elevation - (points[..., 2] if points.shape[-1] == 3 else 0.0)
        scale = self.focal / depth
        return np.stack([self.centre[0] + points[..., 0] * scale, self.centre[1] - points[..., 1] * scale], axis=-1)

    def to_world(self, pixels: ArrayLike, z: ArrayLike = 0.0) -> Floats:
        """World points [m], shape (..., 3), seen at pixels, shape (..., 2), at height ``z`` [m] above the table."""
        pixels, z = np.asarray(pixels, float), np.asarray(z, float)
        scale = (self.elevation - z) / self.focal
        x = (pixels[..., 0] - self.centre[0]) * scale
        y = (self.centre[1] - pixels[..., 1]) * scale
        return np.stack([x, y, np.broadcast_to(z, x.shape)], axis=-1)


@dataclass(frozen=True, eq=False)
class Observation:
    """What an RGB-D camera gives, and all that an unprivileged agent ever sees.

    Attributes:
        rgb: colours, uint8, shape (H, W, 3).
        depth: distance along the optical axis [m], float32, shape (H, W).
        camera: the camera that took it.
    """

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    camera: Camera


@dataclass(frozen=True)
class FoldLine:
    """A directed fold line [px]. The cloth to its LEFT, as seen in the image, is lifted and mirrored across it."""

    start: tuple[float, float]
    end: tuple[float, float]

    @classmethod
    def between(cls, start: ArrayLike, end: ArrayLike) -> FoldLine:
        """Build from two array-likes of shape (2,)."""
        (x0, y0), (x1, y1) = np.asarray(start, float), np.asarray(end, float)
        return cls((float(x0), float(y0)), (float(x1), float(y1)))

    @classmethod
    def moving(cls, pick: ArrayLike, place: ArrayLike) -> FoldLine:
        """The fold line that carries ``pick`` onto ``place``: their directed perpendicular bisector."""
        return cls.between(*geometry.perpendicular_bisector(pick, place))

    @property
    def length(self) -> float:
        """Distance from start to end [px]."""
        return float(np.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1]))

    def lifts(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Which points [px], shape (..., 2), are on the lifted (left) side."""
        return geometry.left_of(points, self.start, self.end)

    def distance(self, points: ArrayLike) -> Floats:
        """Signed distance [px] of points, shape (..., 2); positive on the lifted side."""
        return geometry.signed_distance(points, self.start, self.end)

    def mirror(self, points: ArrayLike) -> Floats:
        """Points [px], shape (..., 2), reflected across the line."""
        return geometry.mirror(points, self.start, self.end)

    def reversed(self) -> FoldLine:
        """The same line with the other side lifted."""
        return FoldLine(self.end, self.start)


@dataclass(frozen=True)
class Subgoal:
    """One bimanual fold in words: *fold <part> <direction> to <part> <axis>* (paper, Sec. IV-B)."""

    text: str


@dataclass(frozen=True, eq=False)
class Action:
    """One pick-and-place with one or two arms; arms move together.

    Attributes:
        picks, places: pixels, float, shape (arms, 2), arms 1 or 2.
    """

    picks: Floats
    places: Floats

    def __post_init__(self) -> None:
        picks, places = np.asarray(self.picks, float), np.asarray(self.places, float)
        if picks.shape != places.shape or picks.shape not in ((1, 2), (2, 2)):
            raise ActionError(
                f"picks and places must both have shape (1, 2) or (2, 2), got {picks.shape} and {places.shape}; "
                "give one (x, y) pixel per arm"
            )
        if not (np.isfinite(picks).all() and np.isfinite(places).all()):
            raise ActionError("picks and places must be finite pixels; one is NaN or infinite")
        object.__setattr__(self, "picks", picks)
        object.__setattr__(self, "places", places)

    @property
    def arms(self) -> int:
        """Number of arms, 1 or 2."""
        return len(self.picks)

    def check_inside(self, camera: Camera) -> None:
        """Raise :class:`ActionError` if a pick or place lies outside the camera's image."""
        points = np.vstack([self.picks, self.places])
        outside = (points < -0.5).any(1) | (points[:, 0] > camera.width - 0.5) | (points[:, 1] > camera.height - 0.5)
        if outside.any():
            x, y = points[outside][0]
            raise ActionError(
                f"the pixel ({x:.0f}, {y:.0f}) lies outside the {camera.width} x {camera.height} image; "
                "keep picks and places inside it"
            )


@dataclass(frozen=True, eq=False)
class Scene:
    """What grounding made of an observation: pure data, enough to plan from and to ground the next image.

    Attributes:
        kind: garment kind, e.g. ``tshirt``.
        image_size: (width, height) [px].
        mask: where the cloth is, bool, shape (H, W).
        contour: outer boundary of the cloth [px], shape (N, 2).
        model: the fitted polygon model, or None for groundings without one.
        text: what a language model is shown: strict JSON.
        residual: Chamfer distance between model and contour [px]; NaN without a model.
        notes: things the caller should know (a displaced garment, an ambiguous silhouette).
        picture: what a vision model is shown beside the text: colours, uint8, shape (H, W, 3); None for none.
        shown: what text and picture hold, of ``polygon``, ``keypoints``, ``image``; it decides which prompt explains
            them to the language model (``fold_line/keypoints-image-v1.md``).
    """

    kind: str
    image_size: tuple[int, int]
    mask: NDArray[np.bool_]
    contour: Floats
    model: FoldedModel | None
    text: str
    residual: float = float("nan")
    notes: tuple[str, ...] = ()
    picture: NDArray[np.uint8] | None = None
    shown: tuple[str, ...] = ("polygon",)


@dataclass(frozen=True, eq=False)
class SimState:
    """Privileged state of a simulated cloth: for metrics, oracle and training rewards, never for agents.

    Attributes:
        positions: particle positions [m], shape (N, 3).
        velocities: particle velocities [m/s], shape (N, 3).
        keypoints: named ground-truth keypoint -> particle index.
        camera: the camera in use.
        extra: simulator-specific arrays that :meth:`Simulator.restore` needs.
    """

    positions: Floats
    velocities: Floats
    keypoints: Mapping[str, int]
    camera: Camera
    extra: Mapping[str, Any] = field(default_factory=dict)

    def keypoint_positions(self) -> dict[str, Floats]:
        """Named keypoint -> position [m], shape (3,)."""
        return {name: self.positions[index] for name, index in self.keypoints.items()}

    def keypoint_pixels(self) -> dict[str, Floats]:
        """Named keypoint -> projected pixel, shape (2,)."""
        return {name: self.camera.to_pixels(point) for name, point in self.keypoint_positions().items()}


@dataclass(frozen=True, eq=False)
class Decision:
    """What an agent wants done next, and what led to it.

    Attributes:
        action: the picks and places to execute.
        subgoal: the step in words, if the agent has one.
        fold_line: the fold line behind the action, if there is one.
        scene: the scene it decided on, if it made one.
        seconds: time spent per stage (``grounding``, ``language``, ``policy``) [s].
        retry: whether this repeats a fold that was seen to have failed.
        action_map: computes what the policy thinks of every place to pick, for pictures; None where it can't say, or
            did not choose the picks (:func:`polyfold.interfaces.action_map_later`).
    """

    action: Action
    subgoal: Subgoal | None = None
    fold_line: FoldLine | None = None
    scene: Scene | None = None
    seconds: Mapping[str, float] = field(default_factory=dict)
    retry: bool = False
    action_map: Callable[[], ActionMap] | None = None
