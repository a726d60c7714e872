"""``polyfold maps``: a sheet for any policy that values picks, and a reason for others."""

import numpy as np
import pytest
from PIL import Image

import polyfold
from polyfold import plugins
from polyfold.cli import main
from polyfold.viz._draw._style import MAP


class Farthest:
    """From outside of the package: values what is far from the line."""

    def act(self, fold_line, scene, rng):
        return plugins.create("policies", "farthest").act(fold_line, scene, rng)

    def action_map(self, fold_line, scene):
        assert scene.model is not None, "as an agent sees it"
        lifted = scene.contour[fold_line.lifts(scene.contour)]
        return lifted, fold_line.distance(lifted)


@pytest.fixture(autouse=True)
def _registered():
    polyfold.register("policies", "outside", Farthest, "a test's policy")
    yield
    plugins.unregister("policies", "outside")


def test_maps_are_drawn_for_any_policy_that_values_picks(tmp_path):
    out = tmp_path / "sheets" / "maps.png"
    command = ["maps", "--policy", "outside", "--task", "square-corner-bottom_left", "--seed", "2003"]
    assert main([*command, "--out", str(out)]) == 0
    with Image.open(out) as picture:
        sheet = np.asarray(picture.convert("RGB")).astype(int)
    for colour in (MAP[0], MAP[-1]):
        assert (np.abs(sheet - colour).max(-1) < 30).sum() > 5


def test_a_policy_without_values_is_refused_with_the_reason(tmp_path, capsys):
    assert main(["maps", "--policy", "affordance-pair", "--out", str(tmp_path / "maps.png")]) != 0
    assert "csam+caso" in capsys.readouterr().err
    assert not (tmp_path / "maps.png").exists()
