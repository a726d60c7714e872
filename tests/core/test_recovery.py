import pytest

import polyfold
from polyfold.folding import attempt

QUARTERS = "fold the left edge onto the right edge, then fold the bottom edge up to the top edge"


def run(seed, recover, **faults):
    experiment = polyfold.Experiment.of(
        simulator={"name": "faulty", **faults}, agent={"name": "polyfold", "recover": recover}
    )
    cloth = polyfold.garment("rectangle", seed=seed, edge_length=0.02)
    return attempt(QUARTERS, cloth, seed, experiment, task="rectangle-half-left-then-bottom")


def test_without_faults_nothing_is_repeated():
    episode = run(2004, True)
    assert [step.retry for step in episode.steps] == [False, False]


@pytest.mark.parametrize("seed", [2002, 2003, 2011])
def test_missed_grasps_are_seen_and_repeated(seed):
    without, with_recovery = run(seed, False, miss=0.75), run(seed, True, miss=0.75)
    assert any(step.retry for step in with_recovery.steps)
    assert not any(step.retry for step in without.steps)
    assert with_recovery.fidelity.moved_part_error_mm < 0.5 * without.fidelity.moved_part_error_mm


def test_repeating_is_bounded_when_nothing_ever_holds():
    episode = run(2004, True, miss=1.0)
    assert len(episode.steps) == 2 * (1 + 3)
    assert len(episode.settled()) == 2


def test_a_displaced_garment_is_found_again():
    episode = run(2004, True, displace=1.0)
    assert len(episode.steps) == 2
    assert episode.failure is None
    assert episode.steps[1].scene.residual < 6
