"""Random interaction: what a data set holds, that killing loses nothing, and that nothing is taken on trust."""

import contextlib
import json
import shutil

import numpy as np
import pytest
import torch
from few_folds import FOLDS, MIX, interaction
from polyfold_fgpnp.data.collect import collect
from polyfold_fgpnp.data.dataset import DatasetFolder, load_dataset
from polyfold_fgpnp.data.exploring import explore
from polyfold_fgpnp.data.interaction import Interaction
from polyfold_fgpnp.data.situations import execute, situations
from polyfold_fgpnp.data.trials import RECIPES, Flap, draw_trials, parse_mix
from polyfold_fgpnp.policies.actions import PickConfig
from polyfold_fgpnp.policies.affordance import PARTNER_SLIDE, coupled_pick, second_pick
from polyfold_fgpnp.policies.coupled import value_policy
from polyfold_fgpnp.policies.lines import LINE_KINDS
from polyfold_fgpnp.policies.networks import NetworkConfig, ValueNetwork
from polyfold_fgpnp.policies.region import fold_region
from polyfold_fgpnp.policies.weights import Provenance, save_weights
from polyfold_fgpnp.training.examples import make_examples

from polyfold.cli import main
from polyfold.errors import ConfigError, SimulationError
from polyfold.types import Action


def test_every_state_gets_the_mix_of_picks(folds):
    assert folds.states == 8
    assert folds.folds == 8 * sum(MIX.values())
    for recipe, count in MIX.items():
        assert (folds["recipe"] == list(RECIPES).index(recipe)).sum() == 8 * count


@pytest.mark.parametrize(("good", "folds_before"), [(-np.inf, [0, 0, 1, 2]), (np.inf, [0, 0, 0, 0])])
def test_half_the_states_are_folded_where_folds_come_out_well_enough(monkeypatch, good, folds_before):
    monkeypatch.setattr("polyfold_fgpnp.data.situations.GOOD_FOLD", good)
    found = [situation for _, _, situation in situations(interaction(), 0)]
    assert [situation.folds_before for situation in found] == folds_before
    changed = [bool((situation.scene.mask != found[0].scene.mask).any()) for situation in found]
    assert changed == [count > 0 for count in folds_before]


def test_picks_lie_on_the_lifted_contour(folds):
    for state in range(folds.states):
        region = fold_region(folds.line(state), folds.scene(state))
        for trial in np.flatnonzero(folds["trial_state"] == state):
            for point in (folds["first"][trial], folds["second"][trial]):
                assert np.hypot(*(region.points - point).T).min() < 1.0


def test_a_random_course_goes_on_from_what_came_of_the_last_pick(tmp_path):
    collect(Interaction(course="random", seeds=(2000, 2000), edge_length=0.035), 1, tmp_path, progress=False)
    data = load_dataset(tmp_path)
    assert data.states == data.folds == 12
    assert (data["line_kind"] == LINE_KINDS.index("chord")).all(), "between two random points of the contour"
    before = data["folds_before"]
    assert before[0] == 0
    assert before.max() == 3
    for state in np.flatnonzero(before):
        assert before[state] == before[state - 1] + 1
        assert (data.mask(state) == data.result(state - 1)).all()
    for state in range(data.states):
        region = fold_region(data.line(state), data.scene(state))
        partner = second_pick(region, data["first"][state].astype(float), PickConfig().gamma)
        assert np.hypot(*(data["second"][state] - partner)) < 1.0, "the conditional optimum itself"


def test_one_pick_is_tried_from_a_state_of_a_random_course():
    with pytest.raises(ConfigError, match="--mix uniform=1"):
        interaction(course="random", mix={"uniform": 2})


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
    with pytest.raises(ConfigError, match="have changed"):  # else the very command that resumes would bless them
        collect(interaction(), FOLDS, changed, progress=False)


def test_a_data_set_that_is_being_extended_is_not_complete_until_it_is_finished(folds_folder, tmp_path):
    more = tmp_path / "more"
    shutil.copytree(folds_folder, more)
    folder = DatasetFolder(more, interaction().model_dump(mode="json"))
    assert load_dataset(more).folds == FOLDS, "to open it changes nothing"
    with np.load(more / "shards" / "00001.npz") as shard:
        folder.write(3, dict(shard))
    with pytest.raises(ConfigError, match="run the same `polyfold collect` again"):
        load_dataset(more)
    DatasetFolder(more, interaction().model_dump(mode="json")).finish()
    assert load_dataset(more).folds > FOLDS


def test_another_schema_is_refused_and_not_guessed(folds_folder, tmp_path):
    other = tmp_path / "other"
    shutil.copytree(folds_folder, other)
    description = json.loads((other / "dataset.json").read_text())
    (other / "dataset.json").write_text(json.dumps({**description, "schema_version": 99}))
    with pytest.raises(ConfigError, match="schema version 99"):
        load_dataset(other)


@pytest.mark.parametrize("course", ["good-folds", "random"])
def test_a_data_set_in_one_file_is_the_same_and_smaller(folds_folder, tmp_path, course, capsys):
    from polyfold_fgpnp.data.dataset import pack_dataset

    folder, file = folds_folder, tmp_path / "published" / "folds.npz"
    if course == "random":
        folder = tmp_path / "random"
        collect(interaction(course=course, mix={"uniform": 1}), 12, folder, progress=False)
    size = pack_dataset(folder, file)
    whole, packed = load_dataset(folder), load_dataset(file)
    assert packed.description == whole.description
    assert packed.columns.keys() == whole.columns.keys()
    for name, values in whole.columns.items():
        np.testing.assert_array_equal(packed[name], values, name)
        assert packed[name].dtype == values.dtype
    assert size < 0.7 * sum(shard.stat().st_size for shard in (folder / "shards").glob("*.npz"))
    pack_dataset(folder, tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == file.read_bytes()
    assert main(["collect", "--describe", str(file)]) == 0
    assert f"{whole.folds} folds from {whole.states} states" in capsys.readouterr().out
    assert file.with_name("folds-picks.png").exists()


def test_a_damaged_file_of_a_data_set_is_refused_whichever_byte_it_is(folds_folder, tmp_path):
    from polyfold_fgpnp.data.dataset import pack_dataset
    from polyfold_fgpnp.data.packing import write_packed

    file = tmp_path / "folds.npz"
    size = pack_dataset(folds_folder, file)
    whole, rng = file.read_bytes(), np.random.default_rng(0)
    for at in rng.integers(size, size=40):
        file.write_bytes(whole[:at] + bytes([whole[at] ^ 0x10]) + whole[at + 1 :])
        with contextlib.suppress(ConfigError):  # else it is a byte that nothing reads, such as a date
            np.testing.assert_array_equal(load_dataset(file)["result"], load_dataset(folds_folder)["result"])
    file.write_bytes(whole[: size // 2])
    with pytest.raises(ConfigError, match="is no data set"):
        load_dataset(file)
    data = load_dataset(folds_folder)
    write_packed(file, {**data.description, "schema_version": 99}, data.columns, row=50)
    with pytest.raises(ConfigError, match="schema version 99"):
        load_dataset(file)


def test_what_is_only_described_is_not_packed(folds_folder, tmp_path, capsys):
    assert main(["collect", "--describe", str(folds_folder), "--pack", str(tmp_path / "folds.npz")]) == 1
    assert "give --out DIR" in capsys.readouterr().err
    assert not (tmp_path / "folds.npz").exists()


class Diverging:
    """A simulator whose every fold diverges."""

    def restore(self, state):
        pass

    def execute(self, action):
        raise SimulationError("it diverged; report it")


def test_a_fold_that_diverges_is_recorded_as_such(monkeypatch, folds):
    from polyfold_fgpnp.data import exploring as module

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
    [
        (["--seeds", "9-3", "--out", "x"], "A-B"),
        ([], "--out"),
        (["--describe", "nowhere"], "no data set"),
        (["--edge-length", "1", "--out", "x"], "--edge-length"),
        (["--kind", "tent", "--out", "x"], "no garment is called 'tent'"),
        (["--simulator", "xpdb", "--out", "x"], "did you mean 'xpbd'"),
    ],
)
def test_wrong_options_are_answered_and_leave_no_folder_behind(arguments, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["collect", *arguments]) == 1
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("option", ["--folds", "--workers"])
def test_none_of_what_is_counted_is_wrong_usage(option, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit, match="2"):
        main(["collect", option, "0", "--out", "x"])
    assert f"{option}: '0' is not a whole number from 1" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.fixture(scope="module")
def networks(tmp_path_factory):
    """Files of untrained networks, which value the points of a contour at random."""
    return {
        name: untrained(tmp_path_factory.mktemp("networks") / f"{name}.safetensors", variant, seed)
        for name, variant, seed in (("csam", "csam", 0), ("other", "csam", 1), ("pair", "pair", 0), ("1sam", "1sam", 0))
    }


def untrained(path, variant, seed):
    torch.manual_seed(seed)
    network = ValueNetwork(NetworkConfig(variant=variant, base=4, levels=2))
    torch.nn.init.normal_(network.head.exit.weight if variant == "pair" else network.exit.weight)
    save_weights(path, network, Provenance({"network": network.config.model_dump()}, (), 0.0, 1.0))
    return path


@pytest.fixture(scope="module")
def chosen_folder(networks, tmp_path_factory):
    out = tmp_path_factory.mktemp("chosen")
    command = ["collect", "--out", str(out), "--weights", str(networks["csam"]), "--mix", "chosen=3,uniform=1"]
    assert main([*command, "--folds", "1", "--seeds", "2000-2000", "--edge-length", "0.04"]) == 0
    return out


def test_chosen_picks_are_where_the_network_promises_most(chosen_folder, networks):
    data = load_dataset(chosen_folder)
    policy = value_policy(networks["csam"])
    assert data.states == 4
    # Data keep the line rounded, and so a point next to it that was not lifted when it was asked for may be now.
    found = [situation for _, _, situation in situations(interaction(seeds=(2000, 2000), edge_length=0.04), 0)]
    for state in range(data.states):
        trials = data.of_recipes("chosen")
        firsts = data["first"][trials[data["trial_state"][trials] == state]]
        points, values = policy.action_map(found[state].line.line, found[state].scene)
        at = [int(np.argmin(np.hypot(*(points - first).T))) for first in firsts]
        assert len(at) == 3
        assert values[at[0]] > values.max() - 1e-3 * np.ptp(values), "the first is the best of all"
        assert (values[at] >= np.quantile(values, 0.7)).all(), "the others are good"
        apart = np.hypot(*(firsts[:, None] - firsts[None]).transpose(2, 0, 1))[np.triu_indices(3, 1)]
        assert apart.min() > 0.045 * len(points), "and not the same again"
        region = fold_region(data.line(state), data.scene(state))
        partners = data["second"][trials[data["trial_state"][trials] == state]]
        # Firsts are kept rounded: a partner that slides to the border between two contour pixels may be either. They
        # need not be among the points that the map was asked at.
        shares = [near * PARTNER_SLIDE for near in (0.99, 1.0, 1.01)]
        wanted = np.array([[coupled_pick(region, first, PickConfig(), share) for share in shares] for first in firsts])
        assert (np.abs(partners[:, None] - wanted).max(axis=2).min(axis=1) < 0.5).all()


def test_the_same_weights_give_the_same_data_wherever_their_file_is_and_others_are_refused(
    chosen_folder, networks, tmp_path
):
    again, moved = tmp_path / "again", tmp_path / "moved.safetensors"
    shutil.copytree(chosen_folder, again)
    shutil.copy(networks["csam"], moved)
    (again / "shards" / "00000.npz").unlink()
    same = {"seeds": (2000, 2000), "edge_length": 0.04, "mix": {"chosen": 3, "uniform": 1}}
    found = collect(interaction(**same, weights=moved), 1, again, progress=False)
    assert found["hash"] == load_dataset(chosen_folder).description["hash"]
    with pytest.raises(ConfigError, match="weights_hash"):
        collect(interaction(**same, weights=networks["other"]), 1, again, progress=False)


def test_chosen_picks_teach_the_coupled_map_and_pairs_only(chosen_folder):
    data = load_dataset(chosen_folder)
    counts = {name: int(make_examples([data], name, "canonical", "particles", "log").valid.sum()) for name in TAUGHT}
    assert counts == TAUGHT
    with pytest.raises(ConfigError, match="no data for 1sam"):
        make_examples([data], "1sam", "canonical", "particles", "log")


TAUGHT = {"csam": 16, "pair": 16, "2sam": 4}


@pytest.mark.parametrize("variant", ["csam", "pair"])
@pytest.mark.parametrize("count", [1, 4, 30])
def test_so_many_chosen_picks_are_drawn_as_asked_and_differ(folds, networks, variant, count):
    policy = value_policy(networks[variant])
    line, scene = folds.line(0), folds.scene(0)
    flap = Flap(fold_region(line, scene), lambda: policy.action_map(line, scene))
    drawn = draw_trials(flap, {"chosen": count}, np.random.default_rng(0))
    assert len({tuple(trial.first) for trial in drawn}) == len(drawn) == count
    again = draw_trials(flap, {"chosen": count}, np.random.default_rng(0))
    assert all((one.first == other.first).all() for one, other in zip(drawn, again, strict=True))


def test_weights_and_the_recipe_that_asks_them_come_together(networks, tmp_path, capsys):
    out = ["collect", "--out", str(tmp_path / "new")]
    for arguments, message in (
        (["--mix", "chosen=3"], "give its file with --weights"),
        (["--weights", str(networks["csam"])], "add chosen"),
        (["--mix", "chosen=3", "--weights", str(tmp_path / "none")], "polyfold train"),
        (["--mix", "chosen=3", "--weights", str(networks["1sam"])], "holds weights for 1sam, not for csam or pair"),
    ):
        assert main([*out, *arguments]) == 1
        assert message in capsys.readouterr().err
    assert not (tmp_path / "new").exists(), "a refused collection leaves no folder behind"


@pytest.mark.parametrize("keys", [["weights_hash"], []])
def test_data_of_schema_1_is_still_read_and_resumed(folds_folder, tmp_path, keys):
    """It named no segmenter and only parameters of the simulator, and before there were weights no hash of them."""
    old = tmp_path / "old"
    shutil.copytree(folds_folder, old)
    description = json.loads((old / "dataset.json").read_text())
    new = description["parameters"]
    parameters = {key: value for key, value in new.items() if key not in ("garment_kind", "segmenter", *keys)}
    parameters |= {"kind": new["garment_kind"], "simulator": new["simulator"]["params"]}
    (old / "dataset.json").write_text(json.dumps({**description, "schema_version": 1, "parameters": parameters}))
    data = load_dataset(old)
    assert data.folds == FOLDS
    assert data.scene(0).kind == "tshirt"
    assert collect(interaction(), FOLDS, old, progress=False)["hash"] == description["hash"]
    with pytest.raises(ConfigError, match="seed 0 there, 5 asked"):
        collect(interaction(seed=5), 28, old, progress=False)


def test_what_folds_and_what_sees_can_be_chosen(tmp_path):
    few = {"mix": {"uniform": 1}, "edge_length": 0.05}
    plain = collect(interaction(**few), 4, tmp_path / "plain", progress=False)
    assert plain["parameters"]["simulator"]["name"] == "xpbd"
    slippery = {"name": "denim", "table_friction": 0.0}
    other = collect(interaction(**few, fabric=slippery), 4, tmp_path / "slippery", progress=False)
    assert other["parameters"]["fabric"] == {"name": "denim", "params": {"table_friction": 0.0}}
    assert other["hash"] != plain["hash"]
    with pytest.raises(ConfigError, match="did you mean 'threshold'"):
        collect(interaction(segmenter={"name": "colour", "treshold": 3}), 4, tmp_path / "wrong", progress=False)
    assert not (tmp_path / "wrong").exists()


def test_recipes_keep_their_places_in_stored_data():
    assert list(RECIPES) == ["uniform", "extreme", "slid", "pair", "single", "vertex", "chosen"]
