"""A garment folded by hand: what can be asked for, taken back, and taken home."""

import json
import subprocess
import sys
import tomllib

import numpy as np
import pytest

import polyfold
from polyfold.errors import ActionError, ConfigError, PlanError, RefusedError
from polyfold.tasks import fold_lines, load_suite

ACROSS = polyfold.FoldLine((80.0, 200.0), (320.0, 200.0))
"""Over the middle of the picture: what lies above it is lifted."""


def square(seed=0, edge_length=0.04):
    return polyfold.garment("square", seed, edge_length=edge_length)


@pytest.fixture
def playground():
    with polyfold.play(square()) as playground:
        yield playground


def test_a_line_is_proposed_before_it_is_folded_and_the_same_line_has_the_same_picks(playground):
    before = playground.state.positions
    plan = playground.propose(ACROSS)
    assert ACROSS.lifts(plan.action.picks).all()
    np.testing.assert_array_equal(plan.action.picks, playground.propose(ACROSS).action.picks)
    assert playground.steps == ()
    (step,) = playground.fold(ACROSS)
    np.testing.assert_array_equal(step.action.picks, plan.action.picks)
    assert np.abs(playground.state.positions - before).max() > 0.1


def test_what_was_done_last_is_taken_back_to_the_bit(playground):
    playground.fold(ACROSS)
    before, seen = playground.state.positions, playground.observation.rgb
    playground.fold("fold it in half")
    assert playground.undo()
    np.testing.assert_array_equal(playground.state.positions, before)
    np.testing.assert_array_equal(playground.observation.rgb, seen)
    assert len(playground.steps) == 1
    assert playground.undo()
    assert not playground.undo()


def test_a_fold_after_an_undo_is_what_it_would_have_been_without(playground):
    with polyfold.play(square()) as other:
        expected = other.fold(ACROSS)[0].after.positions
    playground.fold(polyfold.FoldLine((200.0, 80.0), (200.0, 320.0)))
    playground.undo()
    np.testing.assert_array_equal(playground.fold(ACROSS)[0].after.positions, expected)


def test_a_fold_that_is_taken_back_and_done_again_meets_the_same_faults():
    faults = {"name": "faulty", "params": {"displace": 0.5, "slip": 0.5}}
    with polyfold.play(square(), simulator=faults) as playground:
        playground.fold(ACROSS)
        middle = playground.state.positions
        playground.fold(ACROSS)
        first = playground.state.positions
        for moves in (1, 2):
            for _ in range(moves):
                playground.undo()
            for _ in range(moves):
                playground.fold(ACROSS)
            np.testing.assert_array_equal(playground.state.positions, first)
        assert np.abs(first - middle).max() > 0.001


def test_a_sentence_goes_on_from_what_was_folded_by_hand(playground):
    corner = playground.scene.model.points()["bottom_left"]
    playground.fold(polyfold.Action([corner], [np.add(corner, [60.0, -60.0])]))
    steps = playground.fold("fold the top right corner inward to the centre")
    assert steps
    folded = steps[0].scene.model
    assert len(folded.folds) == 1  # the grounding knows of the corner that was folded by hand
    said = playground.episode
    assert said.instruction.startswith("fold bottom left over along the line")
    assert said.instruction.endswith("; then fold the top right corner inward to the centre")
    assert len(said.steps) == 1 + len(steps)
    assert said.fidelity is not None


def test_the_first_sentence_alone_is_what_fold_does():
    garment, words = square(3), "fold it in half"
    with polyfold.play(garment, 3) as playground:
        playground.fold(words)
        played = playground.episode
    folded = polyfold.fold(words, garment, 3)
    np.testing.assert_array_equal(played.final_state.positions, folded.final_state.positions)
    assert played.fidelity == folded.fidelity


@pytest.mark.parametrize(
    ("move", "error", "words"),
    [
        ("make me a coffee", RefusedError, "instruction"),
        (polyfold.FoldLine((0.0, 5.0), (399.0, 5.0)), PlanError, "misses the cloth"),
        (polyfold.Action([[10.0, 10.0]], [[500.0, 10.0]]), ActionError, "outside"),
    ],
)
def test_what_cannot_be_done_says_so_and_leaves_the_cloth(playground, move, error, words):
    before = playground.state.positions
    with pytest.raises(error, match=words):
        playground.fold(move)
    np.testing.assert_array_equal(playground.state.positions, before)
    assert playground.turns == []


def test_an_interrupted_fold_leaves_the_cloth_as_before_it(playground):
    playground.fold(ACROSS)
    before = playground.state.positions

    def interrupt(_):
        raise KeyboardInterrupt

    with playground.motion.watched(interrupt), pytest.raises(KeyboardInterrupt):
        playground.fold(polyfold.FoldLine((200.0, 80.0), (200.0, 320.0)))
    assert len(playground.steps) == 1
    assert playground._simulator.state().positions == pytest.approx(before, abs=0)


def test_a_sentence_that_is_broken_off_leaves_its_whole_folds_each_a_move_of_its_own(playground):
    seen = []

    def interrupt(_):
        seen.append(len(playground.steps))
        if seen[-1] == 1:
            raise KeyboardInterrupt

    with playground.motion.watched(interrupt), pytest.raises(KeyboardInterrupt):
        playground.fold("fold it in half, then fold it in half again")
    assert [type(turn.move) for turn in playground.turns] == [polyfold.Action]
    assert "polyfold.Action(" in playground.code()
    assert {moment.fold for moment in playground.motion.moments} == {0}
    playground.undo()
    done = playground.episode
    assert (done.steps, done.subgoals, done.calls) == ((), (), ())


def test_what_was_taken_back_is_told_no_more(playground):
    playground.fold(ACROSS)
    playground.fold("fold it in half")
    playground.undo()
    done = playground.episode
    assert (len(done.steps), done.subgoals, done.calls) == (1, (), ())
    assert "in half" not in done.instruction


def test_what_was_done_is_there_after_it_was_closed(playground):
    playground.fold(ACROSS)
    playground.close()
    assert len(playground.episode.steps) == 1
    for move in (playground.undo, lambda: playground.fold(ACROSS)):
        with pytest.raises(ConfigError, match="closed; begin anew"):
            move()
    assert len(playground.turns) == 1


@pytest.mark.parametrize("move", [None, 3, ((1, 2), (3, 4))])
def test_what_is_no_move_is_refused(playground, move):
    with pytest.raises(ConfigError, match=r"no move|finite pixel"):
        playground.fold(move)


def test_a_garment_is_made_of_the_fabric_that_is_asked_for():
    with polyfold.play(square(), fabric="denim") as playground:
        assert playground.garment.fabric.name == "denim"
    with pytest.raises(ConfigError, match="no garment"):
        polyfold.play(None)


def test_agents_that_need_more_than_a_sentence_are_refused():
    with pytest.raises(ConfigError, match="choose an agent that follows sentences"):
        polyfold.play(square(), agent="fold-lines")


def test_the_code_folds_the_same_again(tmp_path):
    with polyfold.play("square", 1) as playground:
        playground.fold(ACROSS)
        playground.fold(polyfold.Action([[200.0, 260.0]], [[210.5, 230.25]]))
        code, expected = playground.code(), playground.state.positions
    assert code.startswith("import polyfold\n\nplayground = polyfold.play('square', seed=1)\n")
    script = tmp_path / "again.py"
    script.write_text(f"{code}\nimport numpy\nnumpy.save('positions.npy', playground.state.positions)\n")
    subprocess.run([sys.executable, script], cwd=tmp_path, check=True)
    np.testing.assert_array_equal(np.load(tmp_path / "positions.npy"), expected)


def test_code_names_the_components_and_says_where_a_seed_does_not_make_the_garment():
    with polyfold.play(square(2), 2, policy="farthest", fabric={"name": "denim"}) as playground:
        code = playground.code()
    assert "garment = ...  # square-0002, made as you made it: polyfold.garment('square', seed=2, ...)" in code
    assert "polyfold.play(garment, seed=2, fabric='denim', policy='farthest')" in code


def test_what_was_done_becomes_a_task_for_others_of_its_kind(playground, tmp_path):
    keypoints = playground.state.keypoint_pixels()
    corner, other = keypoints["top_left"], keypoints["bottom_right"]
    diagonal = polyfold.FoldLine.moving(corner + 2.0, other - 3.0)
    slanted = polyfold.FoldLine((90.0, 230.0), (310.0, 215.0))
    playground.fold(diagonal)
    playground.fold(slanted)
    file = tmp_path / "mine.toml"
    file.write_text(playground.task("mine"), encoding="utf-8")
    task = load_suite(file).task("mine")
    assert task.garment == "square"
    assert task.steps[0].pairs == (({"top_left": 1.0}, {"bottom_right": 1.0}),)  # what the diagonal was meant for
    for planned, told in zip((diagonal, slanted), fold_lines(task, keypoints), strict=True):
        away = [abs(float(told.distance(point))) for point in (planned.start, planned.end)]
        assert max(away) < 6.0
        np.testing.assert_array_equal(told.lifts([corner, other]), planned.lifts([corner, other]))
    with polyfold.play(square(7), 7) as another:
        fold_lines(task, another.state.keypoint_pixels())


def test_lines_over_plies_are_told_as_they_were_drawn():
    from polyfold.playground._tasks import fold_along
    from polyfold.tasks._lines import points_after
    from polyfold.tasks._suite import Task

    shirt, rng = polyfold.garment("tshirt", 0, edge_length=0.03), np.random.default_rng(3)
    with polyfold.play(shirt) as playground:
        at = playground.state.keypoint_pixels()
    worst = 0.0
    for _ in range(150):
        task = None
        for _ in range(2):
            middle, angle = 200 + rng.uniform(-50, 50, 2), rng.uniform(0, 2 * np.pi)
            way = 120 * np.array([np.cos(angle), np.sin(angle)])
            line = polyfold.FoldLine.between(middle - way, middle + way)
            steps = (*(task.steps if task else ()), fold_along(line, points_after(task, at), shirt))
            task = Task(id="mine", garment="tshirt", type="custom", steps=steps)
            told = fold_lines(task, at)[-1]
            worst = max(worst, *(abs(float(told.distance(point))) for point in (line.start, line.end)))
    assert worst < 14.0  # what was meant for a keypoint is told by it


def test_folds_that_took_nothing_are_no_steps_and_every_move_is_in_the_words(playground):
    playground.fold("fold it in half")
    playground.fold(polyfold.Action([[5.0, 5.0]], [[50.0, 50.0]]))
    playground.fold(polyfold.FoldLine((200.0, 120.0), (200.0, 280.0)))
    told = tomllib.loads(playground.task("mine"))["task"][0]
    assert len(told["steps"]) == 2
    assert told["instructions"][0].startswith("fold it in half; then fold ")


def test_a_task_can_be_run_as_a_study_by_its_file(playground, tmp_path):
    playground.fold("fold it in half")
    file = tmp_path / "mine.toml"
    file.write_text(playground.task("mine"), encoding="utf-8")
    study = polyfold.Study(name="mine", suite=str(file), edge_length=0.04)
    assert str(study).startswith("study mine: 1 episode\n")
    (record,) = polyfold.run(study, tmp_path / "run", progress=False).records
    assert record.task == "mine"
    assert record.succeeded


def test_a_name_that_serves_no_task_is_refused(playground):
    with pytest.raises(ConfigError, match="nothing was folded yet"):
        playground.task()
    playground.fold(ACROSS)
    with pytest.raises(ConfigError, match="My Task"):
        playground.task("My Task")


def test_it_is_saved_as_a_fold_is(playground, tmp_path):
    playground.fold("fold it in half")
    folder = playground.save(tmp_path / "mine")
    assert {file.name for file in folder.iterdir()} >= {"episode.json", "filmstrip.png", "fold.gif"}
    told = json.loads((folder / "episode.json").read_text("utf-8"))
    assert told["instruction"] == "fold it in half"


def test_it_shows_a_picture_where_no_widget_can_be(playground, monkeypatch):
    monkeypatch.setattr("polyfold.playground._showing.find_spec", lambda name: None)
    bundle = playground._repr_mimebundle_()
    assert bundle["image/png"].startswith(b"\x89PNG")
    assert set(bundle) == {"image/png", "text/plain"}
