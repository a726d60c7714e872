"""The closest demonstration, copied."""

import polyfold
from polyfold.api._fold import attempt


def test_it_does_what_was_done_on_a_garment_like_this(demonstrated):
    experiment = polyfold.Experiment.of(agent={"name": "nearest-demo", "demos": str(demonstrated)})
    task = "square-triangle-top_left-then-top_right"
    cloth = polyfold.garment("square", seed=1000, edge_length=0.022)
    episode = attempt("", cloth, 1000, experiment, task=task)
    assert len(episode.steps) == 2
    assert episode.fidelity.iou > 0.85
    unlike = polyfold.garment("pants", seed=1, edge_length=0.022)
    failed = attempt("", unlike, 1, experiment, task="pants-half-left")
    assert "no demonstration is of a pants" in failed.failure.reason
