"""What groundings are held to."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from polyfold.errors import GroundingError
from polyfold.plugins._fabrics import garment_template
from polyfold.prompts import prompt_names
from polyfold.testing._checks import checks
from polyfold.testing._materials import OBLONG, SIDE, changed, kept, oblong, picture, scene, scene_of, upward
from polyfold.testing._subjects import Subject
from polyfold.types import Scene

NEAR = 12.0
"""How far off the cloth a place may be said to be [px of 400]."""


def _ground(subject: Subject, seen: Scene, *more: Any) -> Scene:
    return subject.make().ground(oblong(picture(seen)), seen.mask[:OBLONG], garment_template(seen.kind), *more)


@checks("groundings", "what it says to a language model is strict JSON with places")
def _text(subject: Subject) -> None:
    found = _ground(subject, scene("square"))
    try:
        told = json.loads(found.text, parse_constant=lambda name: 1 / 0)
    except (ValueError, ZeroDivisionError):
        told = None
    subject.require(
        isinstance(told, dict), "ground", f"scene.text is no strict JSON object: {found.text[:60]!r}",
        "write json.dumps({...}, allow_nan=False)",
    )  # fmt: skip
    assert isinstance(told, dict)
    missing = [name for name in ("garment", "image") if name not in told]
    subject.require(not missing, "ground", f"scene.text lacks {missing}", "see polyfold.Scene for what it must hold")
    subject.require(
        "vertices" in told or "keypoints" in told or found.picture is not None, "ground",
        "scene.text names no place, and there is no scene.picture",
        "give vertices: name -> [x, y] [px], or keypoints as a list, or a picture",
    )  # fmt: skip


@checks("groundings", "a prompt explains what it shows")
def _shown(subject: Subject) -> None:
    shown = _ground(subject, scene("square")).shown
    if shown == ("polygon",):
        return
    begin = "-".join(shown)
    explained = sorted({found for name in prompt_names() if (found := _explains(name))})
    subject.require(
        begin in explained, "ground", f"scene.shown is {shown}, and no prompt explains {begin!r} to a language model",
        f"show one of {', '.join(explained)}, or register a prompt such as fold_line/{begin}-v1.md "
        "(polyfold.plugins.hookspecs.register_prompts)",
    )  # fmt: skip


def _explains(prompt: str) -> str:
    """What a scene must show for a prompt, ``keypoints-image`` of ``fold_line@keypoints-image-v2``; else empty."""
    return prompt.partition("@")[2].rpartition("-")[0]


@checks("groundings", "the places that it says are on the cloth")
def _places(subject: Subject) -> None:
    seen = scene("pants")  # which turned over its diagonal lies elsewhere, as a square does not
    try:
        told = json.loads(_ground(subject, seen).text)
    except GroundingError:
        return  # it knows other garments
    points = _points(told.get("vertices")) | _points(told.get("keypoints"))
    for name, point in points.items():
        off = float(np.hypot(*(np.argwhere(seen.mask)[:, ::-1] - point).T).min())
        subject.require(
            off <= NEAR, "ground", f"scene.text says that {name} is at {list(point)}, {off:.0f} px off the cloth",
            "places are [x, y] in pixels of the picture, x to the right, y down",
        )  # fmt: skip


def _points(told: Any) -> dict[str, tuple[float, float]]:
    """The places in a part of a scene's text, by name or number; what is none is left to others to judge."""
    named = told.items() if isinstance(told, dict) else enumerate(told) if isinstance(told, list) else ()
    at = {str(name): place.get("at") if isinstance(place, dict) else place for name, place in named}
    return {
        name: (float(place[0]), float(place[1]))
        for name, place in at.items()
        if isinstance(place, list) and len(place) == 2 and all(isinstance(value, int | float) for value in place)
    }


@checks("groundings", "the scene is of the picture")
def _fits(subject: Subject) -> None:
    seen = scene("square")
    found = _ground(subject, seen)
    subject.require(
        found.image_size == (SIDE, OBLONG), "ground", f"image_size is {found.image_size}, not {(SIDE, OBLONG)}",
        "it is (width, height)",
    )  # fmt: skip
    away = np.sqrt(((found.contour[:, None] - seen.contour) ** 2).sum(-1)).min(1) if len(found.contour) else [np.inf]
    off = float(np.max(away))
    subject.require(
        off <= 6.0,
        "ground",
        f"scene.contour is {off:.0f} px off the cloth",
        "contour_of(mask) gives it, (x, y), y down",
    )


@checks("groundings", "a fold is followed")
def _follows(subject: Subject) -> None:
    flat = scene("square")
    first = _ground(subject, flat)
    assert flat.model is not None
    line = upward(flat.model)
    second = _ground(subject, scene_of(flat.model.fold(line)), first, line)
    subject.require(second.kind == "square", "ground", f"the kind became {second.kind!r}", "take it from the template")


@checks("groundings", "the same picture gives the same scene, and is left as it is")
def _pure(subject: Subject) -> None:
    seen = scene("square")
    taken, mask, template = picture(seen), seen.mask.copy(), garment_template("square")
    before = kept(taken), mask.copy()
    first = subject.make().ground(taken, mask, template)
    part = changed(before[0], taken, "observation") or changed(before[1], mask, "mask")
    subject.require(not part, "ground", f"it writes into the {part} that it is handed", f"copy it first: {part}.copy()")
    second = _ground(subject, seen), _ground(subject, seen)
    subject.require(second[0].text == second[1].text, "ground", "a second look differs", "keep no state, draw nothing")
    subject.require(first.kind == "square", "ground", f"the kind became {first.kind!r}", "take it from the template")


@checks("groundings", "no cloth, and cloth at the border, end in a scene or a GroundingError")
def _odd(subject: Subject) -> None:
    seen = scene("square")
    nothing, cut = np.zeros_like(seen.mask), np.zeros_like(seen.mask)
    cut[:, : seen.mask.shape[1] // 2] = seen.mask[:, seen.mask.shape[1] // 2 :]
    for name, mask in (("an empty mask", nothing), ("cloth that the border cuts off", cut)):
        try:
            found = subject.make().ground(picture(seen), mask, garment_template("square"))
        except GroundingError:
            continue
        subject.require(
            mask.any() and np.isfinite(found.contour).all(), "ground", f"{name} becomes a scene with nothing in it",
            "raise GroundingError('too little cloth is visible')",
        )  # fmt: skip
