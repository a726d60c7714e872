"""How a network sees a flap: the canonical frame turns, moves and scales with the cloth."""

import numpy as np
import pytest
from drawn_scenes import CENTRE, TSHIRT, model_of, scene_of
from polyfold_fgpnp.policies.frames import CANONICAL_SIDE, view
from polyfold_fgpnp.policies.region import fold_region

from polyfold.geometry import FoldLine, iou, rotate

LINE = ((200.0, 330.0), (200.0, 95.0))


def seen(angle=0.0, size=1.0, frame="canonical"):
    corners = {name: CENTRE + size * (np.array(point) - CENTRE) for name, point in TSHIRT.items()}
    scene = scene_of(model_of(corners, angle))
    line = FoldLine.between(*rotate(CENTRE + size * (np.array(LINE) - CENTRE), angle, CENTRE))
    region = fold_region(line, scene)
    return region, view(region, scene.mask, frame)


@pytest.mark.parametrize(("angle", "size"), [(0.4, 1.0), (2.0, 1.0), (0.0, 0.6), (-1.1, 0.8)])
def test_canonical_view_is_the_same_however_the_cloth_lies(angle, size):
    plain, turned = seen()[1].image, seen(angle, size)[1].image
    for channel in (0, 1):
        assert iou(plain[channel] > 127, turned[channel] > 127) > 0.97


def test_fold_line_is_the_left_border_and_the_flap_fills_the_frame():
    region, found = seen(0.7)
    ends = found.frame.apply([region.fold_line.start, region.fold_line.end])
    assert ends[:, 0] == pytest.approx(2, abs=0.5)
    points = found.frame.apply(region.points)
    assert points.min() > 0
    assert points.max() < CANONICAL_SIDE
    assert np.ptp(points, axis=0).max() > 0.95 * (CANONICAL_SIDE - 5)


def test_mirrored_rest_lies_beneath_a_flap_that_will_land_on_it():
    # The shirt is folded along its middle, so the flap lands on its mirror image.
    _, found = seen()
    assert iou(found.image[0] > 127, found.image[1] > 127) > 0.95


def test_camera_view_is_the_partial_mask_with_the_line():
    region, found = seen(0.3, frame="camera")
    assert ((found.image[0] > 0) == region.mask).all()
    assert found.line * 400 == pytest.approx([*region.fold_line.start, *region.fold_line.end], abs=1e-3)
    assert found.frame.apply(region.points) == pytest.approx(region.points)
