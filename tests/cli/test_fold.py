import json

import numpy as np
import pytest
from PIL import Image

COARSE = ("--edge-length", "0.02")


def test_a_sentence_folds_a_t_shirt_into_a_block_and_leaves_its_pictures(polyfold, tmp_path):
    out = tmp_path / "demo"
    result = polyfold("fold", "fold the t-shirt into a rectangular block", "--seed", 2003, "--out", out)
    assert result.status == 0, result.err
    assert result.out.count("fold ") >= 3
    episode = json.loads((out / "episode.json").read_text())
    assert len(episode["subgoals"]) == len(episode["steps"]) == 3
    assert episode["fidelity"]["reference"] == "recognised"
    assert episode["fidelity"]["iou"] > 0.85
    assert episode["task"].startswith("tshirt-block")
    for line in (out / "transcript.jsonl").read_text().splitlines():
        exchange = json.loads(line)
        assert exchange["messages"]
        assert exchange["reply"]["text"]
    assert Image.open(out / "filmstrip.png").width > 800
    assert Image.open(out / "fold.gif").n_frames > 20


def test_json_is_one_object_with_everything_in_it(polyfold):
    result = polyfold("fold", "fold the square in half", "--garment", "square", "--json", *COARSE)
    episode = json.loads(result.out)
    assert {"instruction", "garment", "pose_seed", "subgoals", "steps", "fidelity", "out"} <= set(episode)
    (step,) = episode["steps"]
    assert {"fold_line", "picks", "places", "seconds"} <= set(step)
    assert {"grounding", "language", "policy", "execution"} == set(step["seconds"])


def test_the_fabric_is_chosen_and_recorded(polyfold):
    fold = ("fold", "fold the square in half", "--garment", "square", "--json", *COARSE)
    usual = json.loads(polyfold(*fold).out)
    assert usual["garment"]["fabric"]["name"] == "poplin"
    assert usual["experiment"]["fabric"] == {"name": "usual", "params": {}}
    felt = json.loads(polyfold(*fold, "--fabric", "felt", "--set", "fabric.thickness=0.0015").out)
    assert felt["garment"]["fabric"]["name"] == "felt"
    assert felt["garment"]["fabric"]["constants"]["thickness"] == 0.0015
    thicker = json.loads(polyfold(*fold, "--set", "fabric.thickness=0.0015").out)
    assert thicker["garment"]["fabric"]["constants"] != felt["garment"]["fabric"]["constants"]
    assert thicker["garment"]["fabric"]["name"] == "poplin"


def test_an_empty_grip_is_said_and_recorded(polyfold, tmp_path):
    fold = ("fold", "fold the square in half", "--garment", "square", *COARSE)
    good = polyfold(*fold, "--out", tmp_path / "good")
    assert "no cloth" not in good.out
    missing = ("--set", "simulator.miss=1", "--set", "agent.recover=false")
    missed = polyfold(*fold, "--simulator", "faulty", *missing, "--out", tmp_path / "missed")
    assert "no cloth in the grip of arm 1 at (" in missed.out
    for name, plies in (("good", 1), ("missed", 0)):
        (step,) = json.loads((tmp_path / name / "episode.json").read_text())["steps"]
        assert step["grasped"] == [plies] * len(step["picks"])
        assert step["short"] == step["slipped"] == [0.0] * len(step["picks"])


def test_a_garment_keeps_its_fabric_unless_one_is_named():
    import polyfold

    cloth = polyfold.garment("square", 2001, edge_length=0.03, fabric="felt")
    assert polyfold.fold("fold it in half", cloth).garment.fabric.name == "felt"
    assert polyfold.fold("fold it in half", cloth, fabric="denim").garment.fabric.name == "denim"


def test_the_same_seed_gives_the_same_episode(polyfold):
    episodes = []
    for _ in range(2):
        result = polyfold("fold", "fold it in half", "--garment", "rectangle", "--seed", 2005, "--json", *COARSE)
        episode = json.loads(result.out)
        for step in episode["steps"]:
            del step["seconds"]
        episodes.append((episode["steps"], episode["fidelity"]))
    assert episodes[0] == episodes[1]


@pytest.mark.parametrize(
    ("garment", "instruction"),
    [("tshirt", "iron the shirt"), ("square", "fold the left sleeve"), ("square", ""), ("pants", "fold the t-shirt")],
)
def test_what_cannot_be_done_is_refused_with_a_reason_and_nothing_is_folded(polyfold, tmp_path, garment, instruction):
    result = polyfold("fold", instruction, "--garment", garment, "--out", tmp_path, *COARSE)
    assert result.status == 3
    assert result.err.startswith("polyfold: refused: ")
    assert len(result.err) > 40
    episode = json.loads((tmp_path / "episode.json").read_text())
    assert episode["steps"] == []
    assert episode["failure"]["stage"] == "refused"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--garment", "tshrt"), "did you mean 'tshirt'"),
        (("--policy", "casso"), "did you mean 'caso'"),
        (("--set", "policy.gama=1"), "did you mean 'gamma'"),
        (("--set", "nonsense"), "KIND.PARAM=VALUE"),
        (("--fabric", "demin"), "did you mean 'denim'"),
        (("--set", "fabric.thickness=1"), "thickness"),
        (("--set", "simulator.thickness=0.002"), "use fabric.thickness"),
        (("--task", "tshirt-haf-hem"), "tshirt-half-hem"),
        (("--config", "nowhere.toml"), "there is no file"),
        (("--outline", "nowhere.json"), "nowhere.json"),
        (("--size", "30"), "from 0.1 to 2"),
    ],
)
def test_wrong_options_say_what_to_do(polyfold, arguments, says):
    result = polyfold("fold", "fold it in half", *arguments)
    assert result.status == 1
    assert says in result.err


@pytest.mark.parametrize("agent", ["noop", "random"])
def test_floors_run_without_a_language_model(polyfold, agent):
    result = polyfold(
        "fold", "fold it", "--garment", "square", "--agent", agent, "--task", "square-triangle-top_left", "--json",
        "--llm", "no-such-llm", *COARSE,
    )  # fmt: skip
    assert result.status == 0, result.err
    episode = json.loads(result.out)
    assert episode["fidelity"]["iou"] < 0.8
    assert episode["fidelity"]["moved_part_error_mm"] > 40


def shirt_mask():
    """A plain upright t-shirt, bool, shape (300, 300)."""
    from polyfold.geometry._masks import fill_polygon

    outline = [(90, 280), (90, 130), (60, 160), (20, 120), (90, 50), (125, 45), (150, 60), (175, 45), (210, 50)]
    outline += [(280, 120), (240, 160), (210, 130), (210, 280)]
    return fill_polygon(outline, 300, 300)


def test_a_mask_an_outline_and_a_photo_of_a_shirt_give_the_same_twin(polyfold, tmp_path):
    from polyfold.geometry import contour_of

    mask = shirt_mask()
    Image.fromarray(mask.astype(np.uint8) * 255).save(tmp_path / "mask.png")
    (tmp_path / "outline.json").write_text(json.dumps(contour_of(mask)[::4].tolist()))
    photo = np.full((300, 300, 3), (200, 190, 170), np.uint8)
    photo[mask] = (60, 80, 150)
    noise = np.random.default_rng(0).normal(0, 4, photo.shape)
    Image.fromarray((photo + noise).clip(0, 255).astype(np.uint8)).save(tmp_path / "photo.jpg", quality=92)
    found = {}
    for option, name in (("--mask", "mask.png"), ("--outline", "outline.json"), ("--image", "photo.jpg")):
        result = polyfold(
            "fold",
            "fold it in half, left over right",
            "--garment",
            "tshirt",
            option,
            tmp_path / name,
            "--json",
            *COARSE,
        )
        assert result.status == 0, result.err
        found[option] = json.loads(result.out)
    for episode in found.values():
        assert episode["task"] == "tshirt-half-left"
        assert episode["fidelity"]["iou"] > 0.85
    lines = np.array([[e["steps"][0]["fold_line"][end] for end in ("start", "end")] for e in found.values()])
    assert np.ptp(lines, axis=0).max() < 12


def test_ground_shows_the_polygon_of_a_mask(polyfold, tmp_path):
    Image.fromarray(shirt_mask().astype(np.uint8) * 255).save(tmp_path / "mask.png")
    out = tmp_path / "polygon.png"
    result = polyfold("ground", tmp_path / "mask.png", "--garment", "tshirt", "--json", "--out", out)
    assert result.status == 0, result.err
    keypoints = json.loads(result.out)["keypoints"]
    assert np.allclose(keypoints["hem_left"], (90, 280), atol=12)
    assert np.allclose(keypoints["armpit_right"], (210, 130), atol=12)
    assert Image.open(out).width > 300


def test_garments_draws_a_sheet(polyfold, tmp_path):
    out = tmp_path / "deep" / "sheet.png"
    result = polyfold("garments", "--garment", "square", "--garment", "pants", "--count", 2, "--out", out)
    assert result.status == 0, result.err
    assert Image.open(out).width > 300
    assert "square           poplin" in result.out
    assert "pants            denim" in result.out


def test_garments_are_seen_by_the_simulator_that_is_named(polyfold, tmp_path):
    result = polyfold("garments", "--simulator", "xpdb", "--out", tmp_path / "sheet.png")
    assert result.status == 1
    assert "did you mean 'xpbd'" in result.err


def test_episode_shows_itself_in_jupyter():
    import polyfold

    episode = polyfold.fold("fold the square in half", garment=polyfold.garment("square", 2001, edge_length=0.03))
    assert "data:image/png;base64," in episode._repr_html_()
    assert episode.show().shape[2] == 3


def test_a_mesh_file_is_folded_and_needs_its_keypoints(polyfold, tmp_path):
    import polyfold as library

    cloth = library.garment("rectangle", seed=2001, edge_length=0.03)
    lines = [f"v {x:.6f} {y:.6f} 0" for x, y in cloth.mesh.vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in cloth.mesh.triangles + 1]
    (tmp_path / "towel.obj").write_text("\n".join(lines) + "\n")
    (tmp_path / "keypoints.json").write_text(json.dumps(cloth.keypoints))
    arguments = ("fold", "fold the left edge onto the right edge", "--garment", "rectangle", "--mesh")
    without = polyfold(*arguments, tmp_path / "towel.obj", *COARSE)
    assert without.status == 1
    assert "keypoints" in without.err
    result = polyfold(
        *arguments, tmp_path / "towel.obj", "--keypoints", tmp_path / "keypoints.json", "--json", *COARSE
    )  # fmt: skip
    assert result.status == 0, result.err
    episode = json.loads(result.out)
    assert episode["garment"]["name"] == "towel"
    assert episode["fidelity"]["iou"] > 0.9
