"""What is given in place of what was meant gets an answer that says what to give."""

import numpy as np
import pytest
from polyfold_interchange import write_dataset

import polyfold
from polyfold.errors import ConfigError, GarmentError, PolyfoldError
from polyfold.rollout import run_episode


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: polyfold.fold(None), "no sentence; say in words"),
        (lambda: polyfold.fold("fold it in half", garment=3), "3 is no garment; give a kind"),
        (lambda: polyfold.garment(None), "no garment is called None; the known ones are"),
        (lambda: polyfold.describe(3), "no component is called 3"),
        (lambda: polyfold.load(None), "None is no path"),
        (lambda: polyfold.run("study.toml", "out"), "no study; give a polyfold.Study, or the file by polyfold.load"),
        (lambda: polyfold.open(None), "None is no folder; give the --out"),
        (lambda: polyfold.table("runs/main"), "give what polyfold.run returned, or polyfold.open"),
        (lambda: polyfold.compare(None), "None is no results"),
        (lambda: write_dataset(None, "out"), "None is no episode; give what polyfold.fold returned"),
        (lambda: write_dataset([1], "out"), "1 is no episode"),
    ],
)
def test_it_is_told_what_to_give(call, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(PolyfoldError) as caught:
        call()
    assert told in str(caught.value)
    assert not list(tmp_path.iterdir()), "nothing is made for it"


SQUARE = polyfold.garment("square", edge_length=0.05)


@pytest.mark.parametrize("seed", [-1, 1.5, "a", None, True, 2**63])
@pytest.mark.parametrize(
    "call",
    [
        lambda seed: polyfold.garment("square", seed),
        lambda seed: polyfold.fold("fold it in half", "square", seed),
        lambda seed: polyfold.play("square", seed),
        lambda seed: polyfold.plugins.generate_garment("square", seed),
        lambda seed: run_episode(polyfold.Experiment(), SQUARE, "fold it in half", seed),
    ],
)
def test_a_seed_is_a_whole_number_wherever_it_is_given(call, seed):
    with pytest.raises(ConfigError) as caught:
        call(seed)
    assert str(caught.value).startswith(f"seed: {seed!r} is not a whole number from 0")


def test_numpy_s_whole_numbers_are_seeds():
    garment = polyfold.garment("square", np.int64(3), edge_length=0.05)
    assert type(garment.seed) is int
    assert garment.seed == 3


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"tasks": "square-*"}, "the study has a bad value for 'tasks': a list is wanted, not 'square-*'"),
        ({"criteria": "lenient"}, "the study has a bad value for 'criteria': a list is wanted, not 'lenient'"),
        ({"garments": -1}, "the study has a bad value for 'garments': Input should be greater than or equal to 1"),
        ({"garments": True}, "the study has a bad value for 'garments': true is no number; give one"),
        ({"first_seed": -1}, "the study has a bad value for 'first_seed': Input should be greater"),
        ({"first_sed": 1}, "the study has no setting 'first_sed'; did you mean 'first_seed'?"),
    ],
)
def test_a_study_answers_a_wrong_setting_as_its_file_would(settings, told, tmp_path):
    with pytest.raises(ConfigError) as caught:
        polyfold.Study(name="mine", **settings)
    assert str(caught.value).startswith(told)
    file = tmp_path / "mine.toml"
    (name, value), written = next(iter(settings.items())), {True: "true"}
    file.write_text(f"{name} = {written.get(value, repr(value)) if isinstance(value, bool) else repr(value)}\n")
    with pytest.raises(ConfigError) as of_file:
        polyfold.load(file)
    assert str(of_file.value) == str(caught.value).replace("the study", str(file), 1)


def test_a_misspelt_setting_is_told_before_what_is_missing_for_it():
    with pytest.raises(ConfigError, match=r"^the study has no setting 'nme'; did you mean 'name'"):
        polyfold.Study(nme="mine")
    with pytest.raises(ConfigError, match=r"^the experiment has no setting 'polcy'; did you mean 'policy'"):
        polyfold.Experiment(polcy="caso")


def test_a_component_that_there_is_not_is_told_when_a_study_names_it():
    study = polyfold.Study(name="mine")
    with pytest.raises(PolyfoldError, match="no policy is called 'farthst'; did you mean 'farthest'"):
        polyfold.ablate(study, "policy", ["farthst"])
    with pytest.raises(PolyfoldError, match="no fabric is called 'demin'; did you mean 'denim'"):
        polyfold.grid(study, {"fabric": ["demin"]})
    assert list(polyfold.ablate(study, "fabric", ["usual", "denim"]).variants) == ["usual", "denim"]


@pytest.mark.parametrize(
    ("source", "told"),
    [
        ({"mask": np.zeros((90, 90))}, "the mask is empty; give one that is True where the cloth is"),
        ({"mask": np.ones((90, 90), bool)}, "the mask is full; give one that is True where the cloth is"),
        ({"mask": np.zeros((90, 90, 3), np.uint8)}, "not of uint8, shape (90, 90, 3); of a picture give one channel"),
        ({"mask": [["x"]]}, "a mask is an array of shape (H, W), True where the cloth is, and not of <U1"),
        ({"outline": [(0, 0), (90, 0), (90, np.nan)]}, "at least three finite points, shape (M, 2); correct it"),
        ({"outline": [("a", "b")]}, "an outline is an array of pixels (x, y), shape (N, 2), and not so (could not"),
    ],
)
def test_what_is_no_mask_or_outline_is_said_of_what_was_given(source, told):
    with pytest.raises(GarmentError) as caught:
        polyfold.garment("square", **source)
    assert told in str(caught.value)
