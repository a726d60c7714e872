"""What segmenters are held to."""

from __future__ import annotations

import numpy as np

from polyfold.errors import GroundingError
from polyfold.geometry import iou
from polyfold.testing._checks import checks
from polyfold.testing._materials import OBLONG, changed, empty, kept, oblong, picture, scene
from polyfold.testing._subjects import Subject

GOOD = 0.95


@checks("segmenters", "it finds plain cloth on a plain table")
def _finds(subject: Subject) -> None:
    for kind in ("square", "tshirt"):
        seen = scene(kind)
        found = iou(subject.make().segment(oblong(picture(seen))), seen.mask[:OBLONG])
        subject.require(
            found >= GOOD, "segment", f"the mask of a blue {kind} on a pale table covers it to {found:.2f} (IoU)",
            "True is cloth; the mask's shape is (height, width) of observation.rgb",
        )  # fmt: skip


@checks("segmenters", "the same picture gives the same mask, and is left as it is")
def _pure(subject: Subject) -> None:
    segmenter, taken = subject.make(), picture(scene("square"))
    before = kept(taken)
    first = segmenter.segment(taken)
    part = changed(before, taken)
    subject.require(
        not part, "segment", f"it writes into observation.{part}", f"copy it first: observation.{part}.copy()"
    )
    second = segmenter.segment(taken)
    subject.require(np.array_equal(first, second), "segment", "a second look differs", "keep no state between pictures")


@checks("segmenters", "a bare table is refused")
def _bare(subject: Subject) -> None:
    try:
        mask = subject.make().segment(empty())
    except GroundingError:
        return
    subject.require(
        False, "segment", f"in a picture of a bare table it finds {int(mask.sum())} pixels of cloth",
        "raise GroundingError('there is no cloth in the picture') where there is none",
    )  # fmt: skip
