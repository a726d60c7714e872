"""The camera ``realsense``: an Intel RealSense, or a recording of one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import ConfigError, RobotError
from polyfold.plugins.hardware import RgbdFrame
from polyfold_pybullet.drivers.lens import Lens, straightening

Floats = NDArray[np.float64]

WARM_UP = 15
"""Pictures after which the exposure is right."""


class RealSense:
    """Colour and depth of a RealSense, depth aligned to colour. Implements the protocol ``DepthCamera``.

    It does not know where it stands: frames have a pose of NaN, which a calibration has to replace.
    """

    class Config(BaseModel):
        """Which camera, and what it sends."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        serial: str | None = Field(default=None, description="serial number, where there are several")
        recording: str | None = Field(default=None, description="a recording (.db3 or .bag) instead of a camera")
        width: int = Field(default=640, ge=160, le=4096, description="of the picture [px]")
        height: int = Field(default=480, ge=120, le=4096, description="of the picture [px]")
        rate: int = Field(default=30, ge=1, le=120, description="pictures a second")
        patience_s: float = Field(default=5.0, gt=0, le=60, description="how long a picture may take to come [s]")

    def __init__(self, config: Config | None = None) -> None:
        self.config = config or self.Config()
        self._pipeline: Any = None

    def connect(self) -> None:
        """Open it; nothing if it is open. Raises RobotError if it can't be."""
        if self._pipeline is not None:
            return
        recording = self.config.recording
        if recording is not None and not Path(recording).expanduser().is_file():
            raise ConfigError(f"there is no recording {recording}; check the path")
        rs = _library()
        pipeline, settings = rs.pipeline(), self._settings(rs)
        try:
            profile = pipeline.start(settings)
            self._scale = float(profile.get_device().first_depth_sensor().get_depth_scale())
            self._aligned = rs.align(rs.stream.color)
        except RuntimeError as error:
            raise RobotError(
                f"the RealSense can't be opened ({error}); is it plugged in (USB 3), free, and does it have "
                f"{self.config.width} x {self.config.height} at {self.config.rate} a second?"
            ) from error
        self._pipeline = pipeline
        try:
            for _ in range(0 if recording else WARM_UP):
                self._frames()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Release it; nothing if it is not open."""
        pipeline, self._pipeline = self._pipeline, None
        if pipeline is not None:
            pipeline.stop()

    def get_rgbd(self, frames: int = 1) -> RgbdFrame:
        """The last colour picture of so many, and the median of their depths where at least half measured any.

        Raises:
            RobotError: if it is not open, or gives no picture.
        """
        if self._pipeline is None:
            raise RobotError("the camera is not connected; call connect first")
        taken = [self._frames() for _ in range(frames)]
        colour = taken[-1][0]
        depths = np.stack([np.asanyarray(depth.get_data()) for _, depth in taken]).astype(np.float32) * self._scale
        depths[depths == 0.0] = np.nan
        seen = np.isfinite(depths).sum(axis=0)
        # Sorted, NaN comes last: the median of what was measured, without a warning where nothing was.
        middle = np.take_along_axis(np.sort(depths, axis=0), np.maximum(seen - 1, 0)[None] // 2, axis=0)[0]
        depth = np.where(2 * seen >= len(taken), middle, np.float32(np.nan))
        rgb = np.asanyarray(colour.get_data()).copy()
        intrinsics, coefficients, lens = _lens(colour.get_profile().as_video_stream_profile().get_intrinsics())
        where = straightening(intrinsics, coefficients, lens, (rgb.shape[1], rgb.shape[0]))
        if where is not None:
            rgb, depth = _straight(rgb, depth, where)
        return RgbdFrame(rgb, depth.astype(np.float32), intrinsics, np.full((4, 4), np.nan))

    def _settings(self, rs: Any) -> Any:
        config, settings = self.config, rs.config()
        if config.recording is not None:
            rs.config.enable_device_from_file(settings, str(Path(config.recording).expanduser()), True)
            return settings
        if config.serial is not None:
            settings.enable_device(config.serial)
        settings.enable_stream(rs.stream.depth, config.width, config.height, rs.format.z16, config.rate)
        settings.enable_stream(rs.stream.color, config.width, config.height, rs.format.rgb8, config.rate)
        return settings

    def _frames(self) -> tuple[Any, Any]:
        """A colour picture and the depth aligned to it."""
        try:
            both = self._aligned.process(self._pipeline.wait_for_frames(int(1000 * self.config.patience_s)))
        except RuntimeError as error:
            raise RobotError(
                f"the camera gave no picture within {self.config.patience_s:g} s ({error}); is it still plugged in?"
            ) from error
        colour, depth = both.get_color_frame(), both.get_depth_frame()
        if not colour or not depth:
            raise RobotError("the camera gave a picture without colour or without depth; plug it in anew")
        return colour, depth


def _library() -> Any:
    try:
        import pyrealsense2  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        # Its wheel (2.59) does not bring this library along.
        remedy = "install libusb-1.0 with the system's packages" if "libusb" in str(error) else "install it again"
        raise RobotError(f"pyrealsense2 can't be loaded ({error}); {remedy}") from error
    return pyrealsense2


def _lens(told: Any) -> tuple[Floats, Floats, Lens]:
    """Pinhole matrix [px], coefficients and what they do, of what the library says."""
    intrinsics = np.array([[told.fx, 0.0, told.ppx], [0.0, told.fy, told.ppy], [0.0, 0.0, 1.0]])
    model = str(told.model).rpartition(".")[2].casefold()
    if model == "none" or not any(told.coeffs):
        return intrinsics, np.zeros(5), "none"
    lenses: dict[str, Lens] = {
        "brown_conrady": "brown-conrady",
        "modified_brown_conrady": "brown-conrady",
        "inverse_brown_conrady": "inverse-brown-conrady",
    }
    if model not in lenses:
        raise RobotError(f"the camera has a lens of the kind {model!r}, which is not known here; use a D400")
    return intrinsics, np.array(told.coeffs, float), lenses[model]


def _straight(rgb: Any, depth: Any, where: Floats) -> tuple[Any, Any]:
    import cv2

    across, down = where[..., 0].astype(np.float32), where[..., 1].astype(np.float32)
    straight = cv2.remap(depth, across, down, cv2.INTER_NEAREST, borderValue=float("nan"))
    return cv2.remap(rgb, across, down, cv2.INTER_LINEAR), straight
