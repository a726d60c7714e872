"""Random fold lines: they lift something worth folding and lay it down inside the picture."""

import numpy as np
import pytest
from drawn_scenes import TSHIRT, model_of, scene_of
from polyfold_fgpnp.policies.lines import LINE_KINDS, PLAUSIBLE, random_line

from polyfold.errors import PlanError
from polyfold.geometry import FoldLine

FOLDED = model_of(TSHIRT).fold(FoldLine((200, 330), (200, 70)))


@pytest.mark.parametrize("model", [model_of(TSHIRT), FOLDED], ids=["flat", "folded"])
def test_lines_lift_a_usable_part_that_lands_in_the_picture(model):
    scene = scene_of(model)
    rng = np.random.default_rng(0)
    kinds = set()
    for _ in range(40):
        drawn = random_line(scene, rng)
        kinds.add(drawn.kind)
        assert drawn.region.distances.max() >= 20
        assert 0.01 < drawn.region.mask.sum() / scene.mask.sum() < 0.7
        landed = drawn.line.mirror(drawn.region.points)
        assert ((landed > -3) & (landed < 402)).all(1).mean() > 0.9
    assert kinds == set(LINE_KINDS)


def test_plausible_lines_are_of_the_plausible_kinds():
    rng = np.random.default_rng(1)
    assert {random_line(scene_of(FOLDED), rng, PLAUSIBLE).kind for _ in range(20)} == set(PLAUSIBLE)


def test_cloth_without_a_usable_line_is_refused():
    corners = {"a": (200, 200), "b": (212, 200), "c": (212, 212), "d": (200, 212)}
    with pytest.raises(PlanError, match="no fold line"):
        random_line(scene_of(model_of(corners)), np.random.default_rng(0))
