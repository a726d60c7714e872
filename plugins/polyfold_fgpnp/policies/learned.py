"""Policies that choose picks by a learned value, and those of them whose picks don't know of each other."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from polyfold.geometry import FoldLine
from polyfold.types import Action, Scene
from polyfold_fgpnp.policies.actions import PickConfig, to_action
from polyfold_fgpnp.policies.frames import Frame, view
from polyfold_fgpnp.policies.pairs import pair_geometry
from polyfold_fgpnp.policies.region import FoldRegion, fold_region

if TYPE_CHECKING:
    from torch import Tensor

    from polyfold_fgpnp.policies.networks import ValueNetwork


Floats = NDArray[np.float64]


def network_of(name: str, variants: tuple[str, ...]) -> ValueNetwork:
    """A network by the name or file of its weights, read and checked once until the file changes."""
    from polyfold_fgpnp.policies.weights import weights_file

    file = weights_file(name)
    found = file.stat()
    return _read(file.resolve(), (found.st_mtime_ns, found.st_size), variants)


@lru_cache(maxsize=8)
def _read(file: Path, version: tuple[int, int], variants: tuple[str, ...]) -> ValueNetwork:
    from polyfold_fgpnp.policies.weights import load_weights

    return load_weights(file, *variants)[0]


WEIGHTS = "name of weights that come with the package, or file of `polyfold train`"


class LearnedConfig(PickConfig):
    """Parameters that the learned policies share."""

    weights: str = Field(description=WEIGHTS)


class LearnedPolicy(ABC):
    """Asks a value network and picks where it promises most."""

    variant: ClassVar[str]
    also: ClassVar[tuple[str, ...]] = ()
    """Other variants of the network that serve."""
    Config: ClassVar[type[LearnedConfig]]

    def __init__(self, config: LearnedConfig | None = None) -> None:
        # Every policy's own Config has a default for the weights.
        self.config = config or self.Config()  # pyright: ignore[reportCallIssue]
        self._network = network_of(self.config.weights, (self.variant, *self.also))

    @classmethod
    def files_read(cls, config: LearnedConfig) -> list[Path]:
        """The file of its weights. Raises ConfigError if there is none."""
        from polyfold_fgpnp.policies.weights import weights_file

        return [weights_file(config.weights)]

    def act(self, fold_line: FoldLine, scene: Scene, rng: np.random.Generator) -> Action:
        """Pick where the network promises most; ``rng`` is not used.

        Raises:
            PlanError: if no cloth lies left of the line.
        """
        region = fold_region(fold_line, scene)
        first, second = self._choose(region, scene)
        return to_action(region, first, second, self.config)

    def action_map(self, fold_line: FoldLine, scene: Scene) -> tuple[Floats, Floats]:
        """The lifted contour [px], shape (N, 2), and the value of picking there, shape (N,); higher is better."""
        region = fold_region(fold_line, scene)
        return region.points, self._values(region, scene, region.points).mean(axis=0)

    @abstractmethod
    def _choose(self, region: FoldRegion, scene: Scene) -> tuple[Floats, Floats]:
        """Two contour points [px], each of shape (2,)."""

    def _values(self, region: FoldRegion, scene: Scene, points: Floats) -> Floats:
        """Value of points [px], shape (N, 2), in each map, shape (maps, N)."""
        from polyfold_fgpnp.policies.networks import sampled

        maps, frame = self._maps(region, scene)
        return _array(sampled(maps.mean(0, keepdim=True), _points(frame, points)[None])[0].T)

    def _maps(self, region: FoldRegion, scene: Scene) -> tuple[Tensor, Frame]:
        """The network's maps, shape (M, C, H, W), and where the camera's pixels are in them.

        In the canonical frame M is 2: the maps of the flap and, turned back, those of its mirror image. Their mean is
        symmetric too.
        """
        import torch

        seen = view(region, scene.mask, self._network.config.frame)
        image = torch.from_numpy(seen.image)[None].float() / 255
        line = torch.from_numpy(seen.line)[None]
        with torch.inference_mode():
            if self._network.config.frame == "camera":
                return self._network(image, line), seen.frame
            both = self._network(torch.cat([image, image.flip(2)]), line.expand(2, -1))
            mirrored = both[1:].flip(2)
            mirrored = mirrored.flip(1) if self.variant == "2sam" else mirrored
            return torch.cat([both[:1], mirrored]), seen.frame

    def _pair_values(self, region: FoldRegion, scene: Scene, first: Floats, second: Floats) -> Floats:
        """Value of pairs of points [px], each of shape (K, 2), by a network that values pairs: shape (K,)."""
        import torch

        maps, frame = self._maps(region, scene)
        at = torch.stack([_points(frame, first), _points(frame, second)], 1)[None]
        geometry = torch.from_numpy(pair_geometry(region, first, second))[None]
        with torch.inference_mode():
            both = self._network.values(maps, *(one.expand(len(maps), *one.shape[1:]) for one in (at, geometry)))
            return _array(both[..., 0].mean(0))


class OneActionMap(LearnedPolicy):
    """One arm, at the contour point with the highest value."""

    variant: ClassVar[str] = "1sam"

    class Config(LearnedConfig):
        """Parameters."""

        weights: str = Field(default="1sam", description=WEIGHTS)

    def _choose(self, region: FoldRegion, scene: Scene) -> tuple[Floats, Floats]:
        pick = region.points[int(np.argmax(self._values(region, scene, region.points)[0]))]
        return pick, pick


class TwoActionMaps(LearnedPolicy):
    """Two arms, each at the highest value of a map of its own; neither knows of the other."""

    variant: ClassVar[str] = "2sam"

    class Config(LearnedConfig):
        """Parameters."""

        weights: str = Field(default="2sam", description=WEIGHTS)

    def _choose(self, region: FoldRegion, scene: Scene) -> tuple[Floats, Floats]:
        first, second = np.argmax(self._values(region, scene, region.points), axis=1)
        return region.points[first], region.points[second]


def _points(frame: Frame, points: Floats) -> Tensor:
    import torch

    return torch.from_numpy(frame.apply(points).astype(np.float32))


def _array(values: Tensor) -> Floats:
    return values.numpy().astype(float)
