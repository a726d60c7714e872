"""The segmenter ``sam``: a promptable network of your own, as a TorchScript file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import GroundingError
from polyfold.types import Observation
from polyfold_standard.segmenters.blobs import filled, main_blob
from polyfold_standard.segmenters.doubting import doubts_about
from polyfold_standard.segmenters.prompts import Box, Point, in_pixels

Mask = NDArray[np.bool_]

NO_CLOTH, CLOTH, TOP_LEFT, BOTTOM_RIGHT = 0.0, 1.0, 2.0, 3.0
"""Labels of points, as the SAM family has them."""

INTERFACE = "image (1, 3, H, W), points (1, 1, N, 2), labels (1, 1, N) -> logits (1, 1, M, H, W), scores (1, 1, M)"

MIDDLE = ((0.5, 0.5),)


class PromptableSegmenter:
    """Asks a network of the SAM family for the thing at points or in a box.

    The weights are one TorchScript file with EfficientSAM's interface: ``image`` from 0 to 1, shape (1, 3, H, W),
    ``points`` [px], shape (1, 1, N, 2), and their ``labels`` (0 no cloth, 1 cloth, 2 and 3 the corners of a box), shape
    (1, 1, N), give ``logits``, shape (1, 1, M, H, W), and how good each of the M masks is, shape (1, 1, M). TorchScript
    holds no Python code; checkpoints that need pickle are refused.
    """

    class Config(BaseModel):
        """Parameters; box and points are in shares of the picture, from 0 (left, top) to 1 (right, bottom)."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        weights: Path = Field(description="TorchScript file of a network with EfficientSAM's interface")
        box: Box | None = Field(default=None, description="[left, top, right, bottom] around the cloth")
        points: tuple[Point, ...] = Field(default=(), description="points on the cloth; by default the middle")
        no_cloth: tuple[Point, ...] = Field(default=(), description="points that are no cloth")

    argument: ClassVar[str] = "weights"

    @classmethod
    def files_read(cls, config: Config) -> Sequence[Path]:
        """The network."""
        return [config.weights]

    def __init__(self, config: Config) -> None:
        self._config = config
        self._network = _load(config.weights)

    def segment(self, observation: Observation) -> Mask:
        """Mask of the cloth, bool, shape (H, W). Raises GroundingError when the network finds none, or fails."""
        import torch

        rgb = np.ascontiguousarray(observation.rgb)
        image = torch.from_numpy(rgb.copy()).permute(2, 0, 1)[None].float() / 255.0
        points, labels = self._prompt(rgb.shape[:2])
        try:
            with torch.inference_mode():
                logits, scores = self._network(image, torch.from_numpy(points), torch.from_numpy(labels))
            best = int(scores.reshape(-1).argmax())
            answer = logits.reshape(-1, *logits.shape[-2:])[best].float().numpy()
        except (RuntimeError, TypeError, ValueError, AttributeError, IndexError) as error:
            reason = (str(error).strip().splitlines() or ["no reason given"])[-1]
            raise GroundingError(
                f"the network {self._config.weights} can't be asked ({reason}); its interface must be {INTERFACE}"
            ) from error
        if answer.shape != rgb.shape[:2] or not np.isfinite(answer).all():
            raise GroundingError(
                f"the network {self._config.weights} answers with a mask of shape {answer.shape} for a picture of "
                f"{rgb.shape[:2]}, or with no numbers; its interface must be {INTERFACE}"
            )
        mask = filled(main_blob(answer >= 0.0))
        if not mask.any():
            raise GroundingError("the network finds no cloth there; give a box around it or points on it")
        return mask

    def doubts(self, observation: Observation, mask: Mask) -> Sequence[str]:
        """What speaks against a mask, one line each."""
        return doubts_about(observation.rgb, mask)

    def _prompt(self, shape: tuple[int, int]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Points [px], shape (1, 1, N, 2), and their labels, shape (1, 1, N)."""
        config = self._config
        on_cloth = config.points if config.points or config.box else MIDDLE
        points, labels = (
            list(on_cloth) + list(config.no_cloth),
            [CLOTH] * len(on_cloth) + [NO_CLOTH] * len(config.no_cloth),
        )
        if config.box is not None:
            left, top, right, bottom = config.box
            points, labels = [(left, top), (right, bottom), *points], [TOP_LEFT, BOTTOM_RIGHT, *labels]
        pixels = in_pixels(tuple(points), shape).astype(np.float32)
        return pixels[None, None], np.array(labels, np.float32)[None, None]


def _load(path: Path) -> Any:
    """The network of a TorchScript file; such files are archives, and nothing in them is unpickled by Python."""
    import warnings
    import zipfile

    import torch

    if not path.is_file():
        raise GroundingError(f"there is no file {path}; give the TorchScript file of a promptable network")
    names = zipfile.ZipFile(path).namelist() if zipfile.is_zipfile(path) else []
    if not any(name.endswith("constants.pkl") for name in names) or not any("/code/" in name for name in names):
        raise GroundingError(
            f"{path} is no TorchScript file; export the network with torch.jit (a checkpoint would need pickle)"
        )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # torch's, of the format that such networks come in
            return torch.jit.load(str(path), map_location="cpu").eval()
    except (RuntimeError, ValueError) as error:
        reason = (str(error).strip().splitlines() or ["no reason given"])[0]
        raise GroundingError(
            f"the network {path} can't be loaded ({reason}); export it again with torch.jit"
        ) from error
