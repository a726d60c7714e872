"""What a stereo depth camera makes of true depth: a model of Intel's RealSense D435i.

Stereo measures disparity d = f B / z, so an error of σ_d in it is one of z² σ_d / (f B) in depth: 2.5 mm at 1 m and
1.2 mm at 0.7 m here (Keselman et al. 2017, 10.48550/arXiv.1705.05548). The error is alike in pixels near each other, as
they are matched in windows that overlap, and part of it stays from picture to picture, as it is the scene's and the
sensor's.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field

Depth = NDArray[np.float32]
Floats = NDArray[np.float64]


class DepthNoise(BaseModel):
    """Constants of the camera; all at zero leave depth as it is.

    Disparity counts in pixels of a picture 1280 wide, in which the camera matches whatever is read from it.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    baseline: float = Field(default=0.05, ge=0.001, le=1, description="between the two imagers [m]")
    focal: float = Field(default=640.0, ge=10, le=1e5, description="focal length in a picture 1280 wide [px]")
    disparity_noise: float = Field(default=0.08, ge=0, le=10, description="standard deviation of disparity [px]")
    quantum: float = Field(default=1 / 32, ge=0, le=10, description="step of disparity [px]")
    correlation_px: float = Field(default=1.5, ge=0, le=50, description="over how many pixels errors are alike [px]")
    fixed_share: float = Field(default=0.4, ge=0, le=1, description="share of the variance that stays between pictures")
    bias: float = Field(default=0.0015, ge=0, le=0.1, description="by how much a plane is off and tilted, RMS [m]")
    edge_px: int = Field(default=2, ge=0, le=20, description="width of the band without depth along edges [px]")
    edge_step: float = Field(default=0.015, ge=0.001, le=1, description="what counts as an edge: a step of depth [m]")
    dropouts: float = Field(default=0.005, ge=0, lt=1, description="share of pixels without depth elsewhere")

    def deviation(self, depth: ArrayLike) -> Floats:
        """Standard deviation of depth [m] at depths [m], without bias and quantisation."""
        return np.square(np.asarray(depth, float)) * self.disparity_noise / (self.focal * self.baseline)


class NoisyDepth:
    """One camera, with the errors that stay with it.

    Args:
        noise: its constants.
        height, width: size of its pictures [px].
        seed: of all that is random.
    """

    def __init__(self, noise: DepthNoise, height: int, width: int, seed: int) -> None:
        self._noise, self._shape = noise, (height, width)
        self._rng = np.random.default_rng(seed)
        self._pattern = self._smooth()
        rows, columns = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
        offset, across, along = self._rng.normal(size=3)
        # Of unit mean square over the picture: a ramp from -1 to 1 has a third of that.
        self._plane = (offset + np.sqrt(3) * (across * columns + along * rows)) / np.sqrt(3)

    def measure(self, depth: Depth, frames: int = 1) -> Depth:
        """Depth as this camera measures it.

        Args:
            depth: true distance along the optical axis [m], shape (H, W); what is not finite or positive is not seen.
            frames: so many pictures are averaged, those in which a pixel has depth.

        Returns:
            Distance [m], NaN where none was measured, shape (H, W).
        """
        true = np.asarray(depth, np.float64)
        seen = np.isfinite(true) & (true > 0)
        total, count = np.zeros(self._shape), np.zeros(self._shape)
        for _ in range(frames):
            once = self._once(np.where(seen, true, 1.0))
            total += np.nan_to_num(once)
            count += np.isfinite(once)
        measured = np.where(count > 0, total / np.maximum(count, 1), np.nan) + self._noise.bias * self._plane
        measured[~seen | self._edges(true, seen)] = np.nan
        return measured.astype(np.float32)

    def _once(self, depth: Floats) -> Floats:
        noise = self._noise
        scale = noise.focal * noise.baseline
        fresh = np.sqrt(1 - noise.fixed_share) * self._smooth() + np.sqrt(noise.fixed_share) * self._pattern
        disparity = scale / depth + noise.disparity_noise * fresh
        if noise.quantum > 0:
            disparity = noise.quantum * np.round(disparity / noise.quantum)
        measured = scale / np.maximum(disparity, max(noise.quantum, 1e-6))
        measured[self._rng.random(self._shape) < noise.dropouts] = np.nan
        return measured

    def _smooth(self) -> Floats:
        """Random numbers of mean 0 and variance 1 that are alike near each other, shape (H, W)."""
        from scipy.ndimage import gaussian_filter

        white = self._rng.normal(size=self._shape)
        if self._noise.correlation_px == 0:
            return white
        smooth = gaussian_filter(white, self._noise.correlation_px, mode="wrap")
        return smooth / smooth.std()

    def _edges(self, depth: Floats, seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """The bands along steps of depth, where the two imagers do not see the same."""
        from scipy.ndimage import maximum_filter, minimum_filter

        if self._noise.edge_px == 0:
            return np.zeros(self._shape, bool)
        filled = np.where(seen, depth, np.inf)
        size = 2 * self._noise.edge_px + 1
        nearest, farthest = minimum_filter(filled, size), maximum_filter(np.where(seen, depth, -np.inf), size)
        return farthest - nearest > self._noise.edge_step
