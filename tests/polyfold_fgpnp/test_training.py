"""Training: it learns, resumes exactly, refuses what it should, and its weights make policies."""

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest
import torch
from drawn_scenes import SQUARE, TSHIRT, model_of, scene_of
from few_folds import MIX
from polyfold_fgpnp.data.dataset import load_dataset
from polyfold_fgpnp.policies import weights as weights_module
from polyfold_fgpnp.policies.coupled import CoupledActionMap, CoupledPairValue, PairValue, VertexLearned
from polyfold_fgpnp.policies.learned import OneActionMap, TwoActionMaps
from polyfold_fgpnp.policies.networks import NetworkConfig, ValueNetwork
from polyfold_fgpnp.policies.pairs import pair_geometry
from polyfold_fgpnp.policies.region import fold_region
from polyfold_fgpnp.policies.weights import load_weights, shipped_weights
from polyfold_fgpnp.training import learner
from polyfold_fgpnp.training.augmentation import augmented
from polyfold_fgpnp.training.config import TrainingConfig, read_config
from polyfold_fgpnp.training.examples import TRIALS_OF, label, make_examples
from polyfold_fgpnp.training.learner import Learner
from polyfold_fgpnp.training.training import train

from polyfold import plugins
from polyfold.cli import main
from polyfold.errors import ConfigError
from polyfold.geometry import FoldLine
from polyfold.plugins.interfaces import Policy

POLICIES = {
    "csam": CoupledActionMap,
    "pair": PairValue,
    "1sam": OneActionMap,
    "2sam": TwoActionMaps,
    "vertex-learned": VertexLearned,
}
COUPLED = {"pair+caso": CoupledPairValue}
LINES = {
    "half": (SQUARE, FoldLine((200, 350), (200, 50))),
    "sleeve": (TSHIRT, FoldLine((135, 180), (130, 85))),
    "hem": (TSHIRT, FoldLine((280, 205), (120, 205))),
}


def small(folder, variant="csam", **changes):
    network = NetworkConfig(variant=variant, base=4, levels=3, **changes.pop("network", {}))
    return TrainingConfig(**{"data": (str(folder),), "network": network, "epochs": 3, "batch": 4, **changes})


def metrics(out):
    return [json.loads(line) for line in (out / "metrics.jsonl").read_text().splitlines()]


@pytest.fixture(scope="module")
def weights(folds_folder, tmp_path_factory):
    """Weights of every variant, barely trained."""
    out = tmp_path_factory.mktemp("trained")
    return {name: train(small(folds_folder, name), out / name, "cpu", progress=False) for name in POLICIES}


def test_training_lowers_the_loss(folds_folder, tmp_path):
    train(small(folds_folder, epochs=30, learning_rate=5e-3), tmp_path, "cpu", progress=False)
    found = metrics(tmp_path)
    assert found[-1]["loss"] < 0.7 * found[0]["loss"]
    assert {"epoch", "loss", "validation_loss", "rank_correlation"} <= found[0].keys()


def test_the_camera_frame_trains_too(folds_folder, tmp_path):
    config = small(folds_folder, network={"frame": "camera"}, reward="contour", scale="linear", epochs=1)
    network, found = load_weights(train(config, tmp_path, "cpu", progress=False), "csam")
    assert network.config.frame == "camera"
    assert found.config["reward"] == "contour"


@pytest.mark.parametrize("frame", ["canonical", "camera"])
def test_pictures_of_any_size_get_a_map_of_their_size(frame):
    network = ValueNetwork(NetworkConfig(frame=frame, base=4, levels=3)).eval()
    images = torch.zeros(1, {"canonical": 2, "camera": 1}[frame], 102, 131)
    assert network(images, torch.zeros(1, 4)).shape == (1, 1, 102, 131)


def test_a_training_that_was_killed_ends_in_the_same_weights(folds_folder, tmp_path, monkeypatch, weights):
    save = Learner.save

    def save_and_die(run, path, epoch):
        save(run, path, epoch)
        if epoch == 2:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Learner, "save", save_and_die)
        with pytest.raises(KeyboardInterrupt):
            train(small(folds_folder), tmp_path, "cpu", progress=False)
    again = train(small(folds_folder), tmp_path, "cpu", progress=False)
    assert [line["epoch"] for line in metrics(tmp_path)] == [1, 2, 3]
    whole, resumed = (load_weights(path)[0].state_dict() for path in (weights["csam"], again))
    assert all(torch.allclose(whole[name].float(), resumed[name].float(), atol=1e-5) for name in whole)


def test_snapshots_are_the_weights_so_far_and_change_nothing_else(folds_folder, tmp_path, monkeypatch, weights):
    save = Learner.save

    def die_before_saving(run, path, epoch):
        if epoch == 2:
            raise KeyboardInterrupt
        save(run, path, epoch)

    config = small(folds_folder, snapshots=(2, 3))
    with monkeypatch.context() as patch:
        patch.setattr(Learner, "save", die_before_saving)
        with pytest.raises(KeyboardInterrupt):
            train(config, tmp_path, "cpu", progress=False)
    again = train(config, tmp_path, "cpu", progress=False)
    assert sorted(path.name for path in tmp_path.glob("weights-*")) == [f"weights-000{n}.safetensors" for n in (2, 3)]
    early, early_from = load_weights(tmp_path / "weights-0002.safetensors", "csam")
    late, _ = load_weights(tmp_path / "weights-0003.safetensors", "csam")
    end, end_from = load_weights(again)
    assert early_from.config["epochs_done"] == 2
    assert end_from.config == load_weights(weights["csam"])[1].config
    early, late, end, plain = (n.state_dict() for n in (early, late, end, load_weights(weights["csam"])[0]))
    assert all(torch.equal(late[name], end[name]) for name in end)
    assert all(torch.allclose(plain[name].float(), end[name].float(), atol=1e-5) for name in end)
    assert not all(torch.allclose(early[name].float(), end[name].float(), atol=1e-5) for name in end)
    train(small(folds_folder), tmp_path, "cpu", progress=False)  # the same training, without snapshots


def test_a_folder_with_another_training_is_refused(folds_folder, weights):
    with pytest.raises(ConfigError, match="another configuration"):
        train(small(folds_folder, seed=9), weights["csam"].parent, "cpu", progress=False)


def test_a_flipped_bit_of_a_checkpoint_is_found(folds_folder, weights, tmp_path):
    out = shutil.copytree(weights["csam"].parent, tmp_path / "copy")
    content = bytearray((out / "checkpoint.safetensors").read_bytes())
    content[-100] ^= 1
    (out / "checkpoint.safetensors").write_bytes(bytes(content))
    with pytest.raises(ConfigError, match=r"is damaged.*remove it to train from the beginning"):
        train(small(folds_folder), out, "cpu", progress=False)


def test_a_damaged_note_of_a_training_is_no_other_training(folds_folder, weights, tmp_path):
    out = shutil.copytree(weights["csam"].parent, tmp_path / "copy")
    (out / "training.json").write_text("{")
    with pytest.raises(ConfigError, match=r"training\.json is damaged.*remove that file to go on"):
        train(small(folds_folder), out, "cpu", progress=False)


def test_a_collapsed_network_stops_the_training(folds_folder, tmp_path, monkeypatch):
    monkeypatch.setattr(learner, "GUARD_STEPS", 1)
    with pytest.raises(ConfigError, match="collapsed"):
        train(small(folds_folder, learning_rate=1e-9), tmp_path, "cpu", progress=False)


def test_weights_tell_what_they_were_trained_from(weights, folds):
    _, found = load_weights(weights["csam"], "csam")
    assert found.data == (folds.description["hash"],)
    assert found.config["network"]["variant"] == "csam"


def test_a_file_with_one_changed_byte_is_refused_wherever_it_is(weights, tmp_path):
    content = weights["csam"].read_bytes()
    header = 8 + int.from_bytes(content[:8], "little")
    damaged = tmp_path / "damaged.safetensors"
    for place in [*range(0, header, 31), *range(header, len(content), 9973), len(content) - 1]:
        damaged.write_bytes(content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :])
        with pytest.raises(ConfigError, match=r"hash|safetensors|not written by"):
            load_weights(damaged)


def test_weights_that_were_changed_are_refused(weights, tmp_path):
    relabelled = tmp_path / "relabelled.safetensors"
    relabelled.write_bytes(weights["csam"].read_bytes().replace(b'\\"epochs\\": 3', b'\\"epochs\\": 4'))
    with pytest.raises(ConfigError, match="its own hash"):
        load_weights(relabelled)
    with pytest.raises(ConfigError, match="holds weights for csam, not for 1sam"):
        load_weights(weights["csam"], "1sam")
    with pytest.raises(ConfigError, match="polyfold train"):
        load_weights(tmp_path / "none.safetensors")
    (tmp_path / "text.safetensors").write_text("no weights at all")
    with pytest.raises(ConfigError, match="safetensors"):
        load_weights(tmp_path / "text.safetensors")


@pytest.mark.parametrize("variant", [*POLICIES, "pair+caso with pair", "vertex-learned with csam"])
@pytest.mark.parametrize(("corners", "line"), LINES.values(), ids=LINES)
def test_learned_policies_pick_on_the_cloth_left_of_the_line(variant, corners, line, weights):
    cls = (POLICIES | COUPLED)[variant.split()[0]]
    policy = cls(cls.Config(weights=str(weights[variant.split()[-1]])))
    assert isinstance(policy, Policy)
    scene = scene_of(model_of(corners))
    action = policy.act(line, scene, np.random.default_rng(0))
    again = policy.act(line, scene, np.random.default_rng(1))
    assert (action.picks == again.picks).all()
    assert line.lifts(action.picks).all()
    columns, rows = action.picks.astype(int).T
    assert scene.mask[rows, columns].all()
    assert action.places == pytest.approx(line.mirror(action.picks), abs=1e-6)
    assert action.arms == 1 or variant != "1sam"
    points, values = policy.action_map(line, scene)
    assert len(points) == len(values) > (0 if variant.startswith("vertex") else 20)
    assert np.isfinite(values).all()


def test_canonical_maps_are_symmetric_on_a_symmetric_flap(weights):
    policy = CoupledActionMap(CoupledActionMap.Config(weights=str(weights["csam"])))
    points, values = policy.action_map(LINES["half"][1], scene_of(model_of(SQUARE)))
    mirrored = [int(np.argmin(np.hypot(*(points - (x, 400 - y)).T))) for x, y in points]
    # The network of a few steps is nearly flat, so that ranks say little: compare with the spread of its values.
    assert np.median(np.abs(values - values[mirrored])) < 0.2 * np.ptp(values)


def test_every_learned_policy_is_registered():
    assert {"csam+caso", "pair+caso", "1sam", "2sam", "vertex-learned", "pair"} <= set(plugins.names("policies"))


@pytest.fixture
def shipping(weights, tmp_path, monkeypatch):
    """A package that comes with the weights csam and csam-fine."""
    package = tmp_path / "package"
    (package / "weights").mkdir(parents=True)
    for name in ("csam", "csam-fine"):
        shutil.copy(weights["csam"], package / "weights" / f"{name}.safetensors")
    monkeypatch.setattr(weights_module, "__file__", str(package / "policies" / "weights.py"))
    return package / "weights"


def test_weights_of_the_package_go_by_name(shipping, weights):
    line, scene = LINES["half"][1], scene_of(model_of(SQUARE))
    by_file = plugins.create("policies", "csam+caso", {"weights": str(weights["csam"])}).action_map(line, scene)[1]
    for parameters in ({"weights": "csam"}, {"weights": "csam-fine"}):
        found = plugins.create("policies", "csam+caso", parameters).action_map(line, scene)[1]
        assert (found == by_file).all()
    for name, parameters in (("csam+caso", {"weights": "csam-coarse"}), ("1sam", {})):
        with pytest.raises(ConfigError, match=r"with the package come csam, csam-fine; .* polyfold train"):
            plugins.create("policies", name, parameters)
    with pytest.raises(ConfigError, match="for csam, not for 2sam"):
        plugins.create("policies", "2sam", {"weights": "csam-fine"})


def test_weights_are_read_again_only_when_their_file_has_changed(shipping, folds_folder, tmp_path, monkeypatch):
    def values():
        policy = plugins.create("policies", "csam+caso", {"weights": "csam"})
        return policy.action_map(LINES["half"][1], scene_of(model_of(SQUARE)))[1]

    before = values()
    with monkeypatch.context() as patch:
        patch.setattr(weights_module, "load_weights", None)
        assert (values() == before).all()
    other = train(small(folds_folder, epochs=1, seed=1), tmp_path / "other", "cpu", progress=False)
    shutil.copy(other, shipping / "csam.safetensors")
    assert (values() != before).any()


def test_weights_that_come_with_the_package_are_sound_and_small():
    for name, file in shipped_weights().items():
        _, found = load_weights(file)
        assert file.stat().st_size <= 10_000_000, name
        assert found.data, f"{name} does not say what it was trained from"
        assert name not in POLICIES or found.config["network"]["variant"] == name
    for name in ("csam+caso", "pair+caso", "vertex-learned", "1sam", "2sam", "pair"):
        assert plugins.create("policies", name)


def test_weights_are_in_the_wheel_and_in_the_source_distribution(weights, tmp_path):
    from hatchling.builders.sdist import SdistBuilder
    from hatchling.builders.wheel import WheelBuilder

    repository = Path(__file__).parents[2]
    for name in ("pyproject.toml", ".gitignore", "README.md", "LICENSE"):
        shutil.copy(repository / name, tmp_path)
    there = "plugins/polyfold_fgpnp"
    (tmp_path / there / "weights").mkdir(parents=True)
    shutil.copy(repository / there / "hooks.py", tmp_path / there)
    shutil.copy(weights["csam"], tmp_path / there / "weights" / "csam.safetensors")
    for builder, inside in ((WheelBuilder, "polyfold_fgpnp"), (SdistBuilder, there)):
        found = {file.distribution_path for file in builder(str(tmp_path)).recurse_included_files()}
        assert {f"{inside}/hooks.py", f"{inside}/weights/csam.safetensors"} <= found


def test_labels_keep_the_order_and_the_logarithm_spreads_good_folds():
    rewards = np.array([-0.5, 0.0, 0.9, 0.97, 1.0])
    assert (np.diff(label(rewards, "linear")) > 0).all()
    spread = np.diff(label(rewards, "log"))
    assert (spread > 0).all()
    assert spread[2] > spread[0]


@pytest.mark.parametrize("frame", ["canonical", "camera"])
def test_augmented_examples_still_show_the_picks_on_the_contour(folds, frame):
    examples = make_examples([folds], "csam", frame, "particles", "log").chosen(np.arange(6))
    turned = augmented(examples, NetworkConfig(frame=frame), np.random.default_rng(2))
    assert not np.array_equal(turned.images, examples.images)
    for image, line, points, valid in zip(turned.images, turned.lines, turned.points, turned.valid, strict=True):
        y, x = np.nonzero(image[0] > 127)
        for point in points[valid][:, 0]:
            assert np.hypot(x - point[0], y - point[1]).min() < 3
        if frame == "camera":
            fold_line = FoldLine.between(400 * line[:2], 400 * line[2:])
            assert fold_line.lifts(np.column_stack([x, y])).mean() > 0.99


def test_a_network_s_pair_value_ignores_the_order_of_picks():
    network = ValueNetwork(NetworkConfig(variant="pair", base=4, levels=2)).eval()
    torch.nn.init.normal_(network.head.exit.weight)
    maps = network(torch.rand(1, 2, 128, 128), torch.zeros(1, 4))
    region = fold_region(LINES["half"][1], scene_of(model_of(SQUARE)))
    first, second = region.points[:50:10], region.points[60:160:20]
    points = torch.from_numpy(np.stack([first, second], 1)[None].astype(np.float32)) / 4
    one, other = (torch.from_numpy(pair_geometry(region, *picks))[None] for picks in ((first, second), (second, first)))
    assert torch.allclose(network.values(maps, points, one), network.values(maps, points.flip(2), other), atol=1e-5)
    assert network.values(maps, points, one).std() > 0


def test_a_variant_without_trials_says_what_to_collect(folds):
    none = type(folds)(folds.description, {**folds.columns, "recipe": np.full_like(folds["recipe"], 3)})
    with pytest.raises(ConfigError, match="--mix"):
        make_examples([none], "1sam", "canonical", "particles", "log")
    assert set().union(*TRIALS_OF.values()) >= set(MIX)


def test_trials_without_a_reward_are_left_out_since_they_would_make_every_weight_nan(folds):
    flap_mm = np.where(np.arange(folds.folds) % 5 == 0, np.nan, folds["flap_mm"])
    holed = type(folds)(folds.description, {**folds.columns, "flap_mm": flap_mm})
    examples = make_examples([holed], "pair", "canonical", "particles", "log")
    assert np.isfinite(examples.labels[examples.valid]).all()
    assert examples.valid.sum() == np.isfinite(flap_mm).sum()


def test_a_training_that_can_t_start_says_why_and_leaves_its_folder_to_a_corrected_one(folds_folder, tmp_path):
    with pytest.raises(ConfigError, match="no data for 1sam"):  # the first trials have other recipes
        train(small(folds_folder, "1sam", folds=2), tmp_path / "out", "cpu", progress=False)
    if not torch.cuda.is_available():
        with pytest.raises(ConfigError, match="no GPU"):
            train(small(folds_folder, "1sam"), tmp_path / "out", "cuda", progress=False)
    assert train(small(folds_folder, "1sam", epochs=1), tmp_path / "out", "cpu", progress=False).exists()


def test_training_from_the_command_line(folds_folder, tmp_path, capsys):
    config = tmp_path / "csam.toml"
    config.write_text(f'data = ["{folds_folder}"]\nepochs = 1\n[network]\nbase = 4\nlevels = 2\n')
    out = tmp_path / "out"
    assert (
        main(
            [
                "train",
                str(config),
                "--out",
                str(out),
                "--device",
                "cpu",
                "--seed",
                "3",
                "--epochs",
                "2",
                "--folds",
                "49",
            ]
        )
        == 0
    )
    assert "weights.safetensors" in capsys.readouterr().out
    found = load_weights(out / "weights.safetensors")[1].config
    assert (found["seed"], found["epochs"], found["folds"]) == (3, 2, 49)
    config.write_text('data = ["x"]\nepochs = 20\nsnapshots = [10, 30]\n')
    with pytest.raises(ConfigError, match="snapshots has 30"):
        read_config(config)
    assert read_config(config, epochs=100).snapshots == (10, 30)
    assert read_config(config, epochs=15).snapshots == (10,)
    config.write_text('data = ["x"]\nepochs = -1\n')
    with pytest.raises(ConfigError, match="epochs"):
        read_config(config)


def test_policies_and_verbs_are_listed_without_torch():
    import subprocess
    import sys

    code = "import sys; from polyfold import plugins; plugins.component_class('policies', 'csam+caso').Config(); "
    code += "plugins.component_class('policies', 'pair'); assert 'torch' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True, env=os.environ)


def test_weights_say_what_they_were_trained_from(folds_folder, weights):
    from experiments.benchmarks.policies.trained import HEADERS, table

    head, _, line = table({"mine": weights["csam"]}).splitlines()
    said = dict(zip(HEADERS, (cell.strip() for cell in line.strip("| ").split("|")), strict=True))
    assert head.startswith("| weights | values |")
    data = load_dataset(folds_folder)
    assert (said["weights"], said["values"], said["data"]) == ("`mine`", "csam", data.description["hash"][:8])
    coupled = data.of_recipes("uniform", "extreme", "chosen")
    assert 0 < int(said["folds"]) < len(coupled), "those of the garment that is held out are not counted"
    assert len(table(shipped_weights()).splitlines()) == 2 + len(shipped_weights())


def test_both_rewards_teach_the_mean_of_their_labels(folds_folder):
    data = [load_dataset(folds_folder)]
    contour, particles, both = (
        make_examples(data, "pair", "canonical", reward, "log") for reward in ("contour", "particles", "both")
    )
    assert both.valid.any()
    assert both.labels == pytest.approx((contour.labels + particles.labels) / 2, abs=1e-5)
    assert (contour.labels != particles.labels).any()
