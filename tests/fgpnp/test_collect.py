"""Random interaction: what a data set holds, that killing loses nothing, and that nothing is taken on trust."""

import json
import shutil

import numpy as np
import pytest
from few_folds import FOLDS, MIX, interaction
from polyfold_fgpnp.affordance import fold_region
from polyfold_fgpnp.collect import collect
from polyfold_fgpnp.dataset import load_dataset
from polyfold_fgpnp.interaction import execute, explore
from polyfold_fgpnp.trials import RECIPES, parse_mix

from polyfold.cli import main
from polyfold.errors import ConfigError, SimulationError
from polyfold.types import Action


def test_every_state_gets_the_mix_of_picks_and_half_the_states_are_folded(folds):
    assert folds.states == 8
    assert folds.folds == 8 * sum(MIX.values())
    for recipe, count in MIX.items():
        assert (folds["recipe"] == list(RECIPES).index(recipe)).sum() == 8 * count
    assert 0.3 <= (folds["folds_before"] > 0).mean() <= 0.6


def test_picks_lie_on_the_lifted_contour(folds):
    for state in range(folds.states):
        region = fold_region(folds.line(state), folds.scene(state))
        for trial in np.flatnonzero(folds["trial_state"] == state):
            for point in (folds["first"][trial], folds["second"][trial]):
                assert np.hypot(*(region.points - point).T).min() < 1.0


def test_the_pair_of_best_affordance_is_better_than_one_arm_by_both_rewards(folds):
    for reward in ("particles", "contour"):
        values = folds.reward(reward)
        pairs, singles = values[folds.of_recipes("slid")], values[folds.of_recipes("single")]
        assert np.median(pairs) > np.median(singles) + 0.1
        assert values[folds.of_recipes("slid")].max() <= 1.0


def test_an_interrupted_collection_goes_on_to_the_same_data(folds_folder, tmp_path):
    again = tmp_path / "again"
    shutil.copytree(folds_folder, again)
    (again / "shards" / "00001.npz").unlink()
    (again / "shards" / "00000.part77").write_bytes(b"cut off")
    (again / "dataset.json").write_text(
        json.dumps({**json.loads((again / "dataset.json").read_text()), "complete": False})
    )
    with pytest.raises(ConfigError, match="not complete"):
        load_dataset(again)
    found = collect(interaction(), FOLDS, again, progress=False)
    assert found["hash"] == load_dataset(folds_folder).description["hash"]
    assert not list(again.rglob("*.part*"))


def test_other_parameters_and_changed_shards_are_refused(folds_folder, tmp_path):
    with pytest.raises(ConfigError, match="seed 0 there, 5 asked"):
        collect(interaction(seed=5), 28, folds_folder, progress=False)
    changed = tmp_path / "changed"
    shutil.copytree(folds_folder, changed)
    shutil.copy(changed / "shards" / "00000.npz", changed / "shards" / "00001.npz")
    with pytest.raises(ConfigError, match="have changed"):
        load_dataset(changed)


def test_another_schema_is_refused_and_not_guessed(folds_folder, tmp_path):
    other = tmp_path / "other"
    shutil.copytree(folds_folder, other)
    description = json.loads((other / "dataset.json").read_text())
    (other / "dataset.json").write_text(json.dumps({**description, "schema_version": 99}))
    with pytest.raises(ConfigError, match="schema version 99"):
        load_dataset(other)


class Diverging:
    """A simulator whose every fold diverges."""

    def restore(self, state):
        pass

    def execute(self, action):
        raise SimulationError("it diverged; report it")


def test_a_fold_that_diverges_is_recorded_as_such(monkeypatch, folds):
    from polyfold_fgpnp import interaction as module

    found = list(module.situations(interaction(), 0))
    monkeypatch.setattr(module, "situations", lambda *_: [(Diverging(), s, situation) for _, s, situation in found[:1]])
    shard = explore(interaction(), 0)
    assert shard["diverged"].all()
    assert len(shard["diverged"]) == sum(MIX.values())
    assert np.isnan(shard["flap_mm"]).all()
    outcome, mask = execute(Diverging(), None, found[0][2], Action([[1, 1]], [[2, 2]]))
    assert outcome is None
    assert not mask.any()


def test_describe_counts_and_shows(folds_folder, capsys):
    assert main(["collect", "--describe", str(folds_folder)]) == 0
    text = capsys.readouterr().out
    assert "56 folds from 8 states of 2 garments" in text
    assert "| particles | slid | 8 |" in text
    assert (folds_folder / "picks.png").stat().st_size > 10_000


def test_a_mix_is_read_strictly():
    assert parse_mix("uniform=3, single=1") == {"uniform": 3, "single": 1}
    for wrong in ("unifrom=3", "uniform", "uniform=0", "uniform=x"):
        with pytest.raises(ConfigError, match="RECIPE=COUNT"):
            parse_mix(wrong)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [(["--seeds", "9-3", "--out", "x"], "A-B"), ([], "--out"), (["--describe", "nowhere"], "no data set")],
)
def test_wrong_options_are_answered(arguments, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["collect", *arguments]) == 1
    assert message in capsys.readouterr().err
