"""A study watched by an observer: what it is told, in which order, and which episodes are the oracle's."""

import pytest

import polyfold
from polyfold import plugins
from polyfold.studies._run import evaluate

SMALL = {
    "name": "watched",
    "tasks": ("square-corner-top_left",),
    "garments": 2,
    "first_seed": 2000,
    "edge_length": 0.03,
    "reference": "oracle",
}
EPISODE = ["start", "step", "end"]


class Watcher:
    """Writes down every event with the role of its episode."""

    def __init__(self):
        self.events = []

    def on_study_start(self, study):
        self.events.append(("study start", study.name))

    def on_episode_start(self, start, role):
        self.events.append((role, "start"))

    def on_step(self, step, role):
        if not step.retry:  # the oracle may need several tries
            self.events.append((role, "step"))

    def on_episode_end(self, episode, role):
        self.events.append((role, "end" if episode.failure is None else episode.failure.stage))

    def on_study_end(self, study, finished):
        self.events.append(("study end", finished))


@pytest.fixture
def watcher(tmp_path, monkeypatch):
    monkeypatch.setenv("POLYFOLD_CACHE", str(tmp_path / "cache"))
    watcher = Watcher()
    plugins.observe(watcher)
    yield watcher
    plugins.unobserve(watcher)


def episodes(role, count=1):
    return [(role, event) for event in EPISODE] * count


def test_a_study_is_told_from_start_to_end_with_the_oracle_apart(watcher, tmp_path):
    study = polyfold.Study(**SMALL)
    evaluate(study, tmp_path / "run", progress=False)
    once = [*episodes("method"), *episodes("reference")]
    assert watcher.events == [("study start", "watched"), *once, *once, ("study end", 2)]


def test_references_from_the_cache_are_no_episodes(watcher, tmp_path):
    study = polyfold.Study(**SMALL)
    evaluate(study, tmp_path / "first", progress=False)
    watcher.events.clear()
    evaluate(study, tmp_path / "second", progress=False)
    assert watcher.events == [("study start", "watched"), *episodes("method", 2), ("study end", 2)]


def test_a_study_that_lacks_nothing_starts_and_ends(watcher, tmp_path):
    study = polyfold.Study(**SMALL)
    evaluate(study, tmp_path / "run", progress=False)
    watcher.events.clear()
    evaluate(study, tmp_path / "run", progress=False)
    assert watcher.events == [("study start", "watched"), ("study end", 2)]


def test_an_interrupted_study_ends_with_what_is_finished(watcher, tmp_path):
    class Impatient:
        def on_episode_end(self, episode, role):
            if role == "reference":
                raise KeyboardInterrupt

    impatient = Impatient()
    plugins.observe(impatient)
    try:
        with pytest.raises(KeyboardInterrupt):
            evaluate(polyfold.Study(**SMALL), tmp_path / "run", progress=False)
    finally:
        plugins.unobserve(impatient)
    assert watcher.events[-1] == ("study end", 0)
    assert watcher.events.count(("method", "end")) == 1


def test_a_refused_episode_ends_without_a_start(watcher):
    with pytest.raises(polyfold.RefusedError):
        polyfold.fold("iron it", polyfold.garment("square", seed=2001, edge_length=0.03))
    assert watcher.events == [("method", "refused")]


def test_a_fold_is_told_as_a_study_tells_it(watcher):
    polyfold.fold("fold the square in half", polyfold.garment("square", seed=2001, edge_length=0.03))
    assert watcher.events == episodes("method")


def test_in_worker_processes_observers_of_plugins_see_episodes_and_the_parent_sees_the_study(watcher, tmp_path):
    evaluate(polyfold.Study(**SMALL), tmp_path / "run", workers=2, progress=False)
    # The first episode runs in this process, so that the workers find the compiler's cache filled.
    once = [*episodes("method"), *episodes("reference")]
    assert watcher.events == [("study start", "watched"), *once, ("study end", 2)]
