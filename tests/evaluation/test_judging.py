"""What `fold` says of a result: praise only where something besides the plan says which fold was wanted."""

import pytest

import polyfold
from polyfold import plugins
from polyfold.geometry import FoldLine
from polyfold.types import Subgoal

ONTO = "Fold the top left corner of the square onto the bottom right one."


class Fixed:
    """A planner whose only plan is the line that a test sets, between named vertices or in pixels."""

    line = None

    def subgoals(self, instruction, template, conversation):
        return [Subgoal("as it pleases")]

    def plan(self, subgoal, scene, conversation):
        ends = [scene.model.vertices()[end].point if isinstance(end, str) else end for end in Fixed.line]
        return FoldLine.between(*ends)


@pytest.fixture(autouse=True)
def _registered():
    polyfold.register("planners", "fixed", Fixed)
    yield
    plugins.unregister("planners", "fixed")


def sentence_of(task, kind, wording=0):
    from polyfold.evaluation import known_tasks

    return next(known for known in known_tasks(kind) if known.id == task).instructions[wording]


def folded(sentence, line, kind="square", **settings):
    Fixed.line = line
    cloth = polyfold.garment(kind, seed=2000, edge_length=0.02)
    return polyfold.fold(sentence, cloth, seed=2000, planner="fixed", **settings)


def said(episode):
    return episode.fidelity.in_words(episode.task)


def test_what_the_sentence_asks_for_and_gets_is_good():
    sentence = sentence_of("square-triangle-top_left", "square")
    otherwise = sentence.upper().rstrip(".").replace(" ", "-", 1)
    episode = folded(f'  "{otherwise}" ?', ("bottom_left", "top_right"))
    assert episode.fidelity.reference == "sentence"
    assert episode.fidelity.verdict == "good"
    assert episode.fidelity.quality > 80
    assert said(episode).startswith("good: IoU 0.9")
    assert "square-triangle-top_left" in said(episode)


def test_a_line_on_the_wrong_side_is_bad_though_the_fold_is_neat():
    sentence = sentence_of("square-triangle-top_left", "square")
    episode = folded(sentence, ("top_right", "bottom_left"))
    assert said(episode).startswith("bad: ")
    assert episode.fidelity.quality < 10
    assert "good" not in said(episode)


def test_a_fold_of_the_wrong_part_is_bad_if_the_task_is_named():
    left = ("shoulder_left", "armpit_left")
    episode = folded("fold the right sleeve in", left, "tshirt", task="tshirt-sleeve-right-straight")
    assert episode.fidelity.reference == "task"
    assert said(episode).startswith("bad: ")


def test_a_task_that_the_sentence_contradicts_gets_no_verdict():
    sentence = sentence_of("square-triangle-top_left", "square")
    episode = folded(sentence, ("bottom_right", "top_left"), task="square-triangle-bottom_left")
    assert episode.fidelity.verdict is None
    assert "although the sentence asks for square-triangle-top_left" in said(episode)


def test_a_plan_that_is_some_task_but_was_not_asked_for_gets_no_praise():
    episode = folded("do something nice with it", ("bottom_left", "top_right"))
    assert episode.fidelity.reference == "recognised"
    assert "nothing vouches" in said(episode)
    assert not {"good", "fair"} & set(said(episode).replace(":", " ").split())


def test_a_line_of_nobodys_gets_no_praise_however_neat_the_fold():
    """The solver once answered with the line of the prompt's own example, and was told IoU 0.987 with the ideal."""
    episode = folded("fold it in half", ((120.0, 300.0), (310.0, 150.0)))
    assert episode.fidelity.reference == "self-referenced"
    assert said(episode).startswith("nothing vouches for the plan")
    assert "ideal" not in said(episode)


def test_where_no_criterion_is_installed_nothing_is_claimed(monkeypatch):
    monkeypatch.setattr("polyfold.evaluation._judging.VERDICTS", (("good", "none-such", 0.0),))
    episode = folded(sentence_of("square-triangle-top_left", "square"), ("bottom_left", "top_right"))
    assert episode.fidelity.verdict is None
    assert said(episode).startswith("compared: ")


def test_what_was_asked_for_and_not_done_is_bad():
    cloth = polyfold.garment("square", seed=2000, edge_length=0.02)
    sentence = sentence_of("square-triangle-top_left", "square")
    assert said(polyfold.fold(sentence, cloth, seed=2000, agent="noop")).startswith("bad: ")


def test_a_crumpled_shirt_is_not_good_though_its_means_are():
    episode = polyfold.fold("", polyfold.garment("tshirt", seed=7), seed=7, task="tshirt-half-left", agent="fold-lines")
    assert episode.fidelity.quality < 70
    assert not said(episode).startswith("good")
