"""A polygon that fits badly on purpose: off by as much as asked, alike each time, and still followed through folds."""

import numpy as np
import pytest
from drawn_garments import SIZE, flat_garment, mask_of, seen

from polyfold import plugins
from polyfold.geometry import FoldLine


def ground(name, mask, previous=None, line=None, **config):
    template = plugins.create("garments", "tshirt").template()
    return plugins.create("groundings", name, config).ground(seen(mask), mask, template, previous, line)


@pytest.fixture(scope="module")
def shirt():
    return flat_garment("tshirt", 2004, 0.2)[0]


@pytest.mark.parametrize("vertex_px", [0.0, 5.0, 15.0])
def test_every_vertex_is_off_by_so_much_and_the_mask_is_not(shirt, vertex_px):
    true, moved = ground("polygon", shirt), ground("misfit", shirt, vertex_px=vertex_px)
    assert np.hypot(*(moved.model.rest - true.model.rest).T) == pytest.approx(np.full(len(true.model.rest), vertex_px))
    assert (moved.model.rest == ground("misfit", shirt, vertex_px=vertex_px).model.rest).all()
    assert (moved.mask == true.mask).all()
    assert (moved.text == true.text) == (vertex_px == 0), "who reads the text is misled too"


def test_a_misfit_polygon_is_followed_through_a_fold(shirt):
    line = FoldLine((SIZE / 2, SIZE), (SIZE / 2, 0))
    flat = ground("polygon", shirt)
    folded = mask_of(flat.model.fold(line))
    moved = ground("misfit", folded, ground("misfit", shirt, vertex_px=10.0), line, vertex_px=10.0)
    true = ground("polygon", folded, flat, line)
    assert len(moved.model.folds) == 1
    assert 5 < np.median(np.hypot(*(moved.model.rest - true.model.rest).T)) < 20
