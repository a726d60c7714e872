"""Real garments that come with the package."""

from __future__ import annotations

from pathlib import Path

_FOLDER = Path(__file__).parents[1] / "samples"


def samples() -> dict[str, Path]:
    """Outlines of real garments that come with the package, to try things on.

        >>> polyfold.garment("tshirt", outline=polyfold.samples()["tshirt"])

    Returns:
        Name -> file, as ``outline`` of :func:`garment` and :func:`ground`, and ``polyfold fold --outline``, read it:
        ``shorts``, ``towel`` and ``tshirt``, from the aRTF Clothes dataset (doi 10.5281/zenodo.10875542, CC-BY 4.0).
    """
    return {path.stem: path for path in sorted(_FOLDER.glob("*.json"))}
