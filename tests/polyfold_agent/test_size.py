"""Language models are told how large the garment is when it lies flat."""

import json

import polyfold
from polyfold.api import attempt


def test_the_template_that_is_asked_about_has_the_garments_size():
    towel = polyfold.garment("rectangle", seed=2001, edge_length=0.03)
    width, height = (100 * side for side in towel.mesh.vertices.max(0) - towel.mesh.vertices.min(0))
    for seed in (2001, 2002):
        episode = attempt("Fold the left edge to the right edge.", towel, seed, polyfold.Experiment())
        asked = episode.calls[0].messages[-1]["content"]
        told = json.loads(asked.partition("Garment template: ")[2].partition("\n")[0])["size_cm"]
        assert abs(told[0] - width) <= 2
        assert abs(told[1] - height) <= 2
