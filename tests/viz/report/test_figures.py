import itertools
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_up_runs import BAD, GOOD, picture, record

import polyfold.viz._report
from polyfold.analysis import Estimate
from polyfold.analysis._intervals import wilson
from polyfold.evaluation._criteria import criteria, succeeded
from polyfold.viz._report._charts import Part, bar, curve_panel, dot
from polyfold.viz._report._curves import SCALES, success_curve
from polyfold.viz._report._gallery import gallery
from polyfold.viz._report._source import open_source

STYLE = (Path(polyfold.viz._report.__file__).parent / "style.css").read_text("utf-8")
BLOCKS = [r"^:root", r"prefers-color-scheme: dark\) \{\s*:root"]

values = st.fixed_dictionaries(
    {"miou": st.floats(0, 1), "mppe": st.floats(0, 200), "moved-part": st.floats(0, 400) | st.just(float("nan"))}
)


LENIENT = criteria(["lenient"])["lenient"]


def episode_with(metrics, **changes):
    """A finished episode with these values; NaN is what there was nothing to measure of."""
    known = {name: None if value != value else value for name, value in metrics.items()}
    return record("ours", "tshirt-half-left", 2000, GOOD, metrics=known, **changes)


@given(st.lists(values, min_size=1, max_size=12))
def test_the_curve_rises_and_meets_the_success_rate_at_the_preset(metrics):
    curve = success_curve([episode_with(values) for values in metrics], LENIENT)
    assert list(curve.shares) == sorted(curve.shares)
    at_one = curve.shares[SCALES.index(1.0)]
    assert at_one == pytest.approx(sum(succeeded(episode, LENIENT) for episode in metrics) / len(metrics))
    assert all(
        low <= share + 1e-9 and share <= high + 1e-9
        for low, share, high in zip(curve.low, curve.shares, curve.high, strict=True)
    )


def test_episodes_that_ended_early_never_succeed():
    perfect = {"miou": 1.0, "mppe": 0.0, "moved-part": 0.0}
    failed = episode_with(perfect, failure={"stage": "grounding", "reason": "nothing in sight"})
    assert success_curve([failed], LENIENT).shares[-1] == 0.0


def test_wilson_interval_of_known_counts():
    assert wilson(0.8, 10) == pytest.approx((0.4902, 0.9433), abs=1e-4)
    assert wilson(0.0, 20)[0] == 0.0
    assert wilson(0.0, 20)[1] == pytest.approx(0.1611, abs=1e-4)


@given(st.lists(st.integers(0, 10), min_size=1, max_size=9))
def test_labels_of_curves_do_not_overlap_and_stay_inside(successes):
    curves = [
        (
            f"v{index}",
            success_curve([episode_with(GOOD if k < n else BAD | {"mppe": 999.0}) for k in range(10)], LENIENT),
        )
        for index, n in enumerate(successes)
    ]
    svg = curve_panel("all", curves, bands=False)
    heights = sorted(float(y) for y in re.findall(r'<text class="name [^>]* y="([\d.-]+)"', svg))
    assert len(heights) == len(successes)
    assert all(b - a >= 13.5 for a, b in itertools.pairwise(heights))
    assert heights[0] > 0
    assert heights[-1] < 236


@given(st.lists(st.floats(0, 1e4), min_size=1, max_size=6))
def test_bars_fill_their_share_of_the_width(lengths):
    svg = bar([Part(index, value, "x", f"part {index}") for index, value in enumerate(lengths)], sum(lengths) or 1.0)
    widths = [float(width) for width in re.findall(r' width="([\d.]+)%"', svg)]
    assert sum(widths) == pytest.approx(100.0 if sum(lengths) else 0.0, abs=0.05)


def test_dots_stay_on_the_axis():
    for percent in (0.0, 100.0):
        places = re.findall(r'(?:cx|x1|x2)="([\d.]+)%"', dot(Estimate(percent, percent, percent, 4), 0))
        assert all(0 <= float(place) <= 100 for place in places)


def _variables(css, block):
    found = re.search(block + r"\s*\{(.*?)\n\s*\}", css, re.S).group(1)
    return dict(re.findall(r"--([\w-]+): (#[0-9a-f]+)", found))


def _channels(colour):
    colour = colour if len(colour) == 7 else "#" + "".join(2 * letter for letter in colour[1:])
    return [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]


def _linear(colour):
    return [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in _channels(colour)]


def _luminance(colour):
    return float(np.dot([0.2126, 0.7152, 0.0722], _linear(colour)))


def _contrast(one, other):
    dark, light = sorted([_luminance(one), _luminance(other)])
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("block", BLOCKS)
def test_text_is_readable_in_light_and_dark(block):
    colours = _variables(STYLE, block)
    for name in ("ink", "faint", "accent", "good", "bad"):
        assert _contrast(colours[name], colours["paper"]) >= 4.5, name
        if name in ("ink", "faint"):
            assert _contrast(colours[name], colours["wash"]) >= 4.5, name
    assert _contrast(colours["faint"], colours["rest"]) >= 4.5
    for index in range(8):
        series = colours[f"s{index}"]
        assert _contrast(series, colours["paper"]) >= 3.0, "lines and bars"
        assert _contrast(_mixed(series, colours["ink"], 0.6), colours["paper"]) >= 4.5, "names of curves"
        assert _contrast(series, colours["on-bright" if index in (1, 2) else "on"]) >= 4.5, "figures in bars"


def _mixed(one, other, share):
    pairs = zip(_channels(one), _channels(other), strict=True)
    return "#" + "".join(f"{round(255 * (share * a + (1 - share) * b)):02x}" for a, b in pairs)


# What remains of linear RGB for protanopes and deuteranopes (Machado, Oliveira and Fernandes, 2009).
SIGHT = {
    "usual": np.eye(3),
    "protanope": [[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]],
    "deuteranope": [[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]],
}


@pytest.mark.parametrize("sight", SIGHT)
@pytest.mark.parametrize("block", BLOCKS)
def test_series_can_be_told_apart_without_seeing_red_or_green(block, sight):
    colours = _variables(STYLE, block)
    seen = np.array([_lab(colours[f"s{index}"], SIGHT[sight]) for index in range(8)])
    distances = [np.linalg.norm(one - other) for one, other in itertools.combinations(seen, 2)]
    assert min(distances) >= 15.0


def _lab(colour, sight):
    linear = np.clip(np.asarray(sight) @ _linear(colour), 0, 1)
    matrix = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    x, y, z = np.cbrt(np.maximum(matrix @ linear / matrix.sum(axis=1), 0.009))
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def test_the_gallery_keeps_what_stands_out_when_space_is_short(full_run):
    source = open_source(full_run)
    everything = gallery(source)
    assert (len(everything.cards), everything.left_out, everything.unpictured) == (12, 0, 0)
    size = len(everything.cards[0].picture)
    few = gallery(source, limit=8 * size)
    assert (len(few.cards), few.left_out) == (8, 4)
    kept = {card.record.key for card in few.cards}
    assert {card.record.key for card in everything.cards if card.pick} <= kept
    assert everything.cards[0].panels == 2


@pytest.mark.parametrize("path", ["../secret.webp", "/etc/hostname", "pictures/none.webp", "pictures"])
def test_pictures_outside_of_the_run_are_not_read(make_run, tmp_path, path):
    (tmp_path / "secret.webp").write_bytes(picture())
    folder = make_run([record("ours", "tshirt-half-left", 2000, GOOD, picture=path)], ["ours"], pictured=False)
    found = gallery(open_source(folder))
    assert (len(found.cards), found.unpictured) == (0, 1)


def test_files_that_are_no_pictures_are_left_out(make_run):
    folder = make_run([record("ours", "tshirt-half-left", 2000, GOOD)], ["ours"])
    (folder / "pictures" / "0.webp").write_bytes(b"<svg onload=alert(1)>")
    assert gallery(open_source(folder)).cards == []
