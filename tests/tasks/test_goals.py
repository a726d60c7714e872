"""Goals that leave the folds open: their file format, their bounds, and how studies judge them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from laid_flat import SUITE

import polyfold
from polyfold.errors import ConfigError
from polyfold.evaluation import suite
from polyfold.evaluation._references import Reference, reference_for
from polyfold.geometry import rotate
from polyfold.geometry._masks import fill_polygon
from polyfold.studies._cell import evaluate_cell
from polyfold.studies._cells import cells
from polyfold.tasks import load_suite
from polyfold.tasks._goals import Bounds, measure
from polyfold.viz._report import report_html

SIZE = 400
MEASURED = {"miou": 1.0, "moved-part": 0.0, "mppe": 0.0}
"""The standard metrics with the values of a perfect end."""
angles = st.floats(0.0, 2 * np.pi)
sides = st.floats(60.0, 180.0)


def drawn(points, angle=0.0, centre=(200.3, 199.6)):
    """The mask of a polygon given about the origin, turned and moved to a place."""
    return fill_polygon(rotate(points, angle) + centre, SIZE, SIZE)


def box(width, height):
    return np.array([[-width, -height], [width, -height], [width, height], [-width, height]]) / 2


FLAT = drawn(box(180, 180))


def hull_of(radii, angle):
    """The convex hull of points about the origin, evenly spaced by direction."""
    import cv2

    turns = angle + 2 * np.pi * np.arange(len(radii)) / len(radii)
    points = np.column_stack([np.cos(turns), np.sin(turns)]) * np.array(radii)[:, None]
    return cv2.convexHull(points.astype(np.float32)).reshape(-1, 2).astype(float)


convex = st.builds(hull_of, st.lists(st.floats(50.0, 120.0), min_size=3, max_size=9), angles)


class TestMeasure:
    @settings(max_examples=25)
    @given(sides, sides, angles)
    def test_rectangles_at_any_angle(self, width, height, angle):
        found = measure(drawn(box(width, height), angle), FLAT, 1)
        assert found.rectangular == pytest.approx(1.0, abs=0.04)
        assert found.triangular == pytest.approx(0.5, abs=0.02), "half of the least triangle about it"
        assert found.area == pytest.approx(width * height / 180**2, rel=0.03)
        assert found.length == pytest.approx(max(width, height) / 180, abs=0.02)

    @settings(max_examples=25)
    @given(base=sides, height=sides, apex=st.floats(-1.0, 1.0), angle=angles)
    def test_triangles_at_any_angle(self, base, height, apex, angle):
        corners = np.array([[-base / 2, height / 2], [base / 2, height / 2], [apex * base / 2, -height / 2]])
        found = measure(drawn(corners, angle), FLAT, 1)
        assert found.triangular == pytest.approx(1.0, abs=0.06)
        assert found.rectangular == pytest.approx(0.5, abs=0.03)
        assert found.area == pytest.approx(base * height / 2 / 180**2, rel=0.03)

    @settings(max_examples=20)
    @given(convex)
    def test_no_convex_shape_fills_less_than_half_of_a_triangle_or_more_than_all(self, hull):
        found = measure(drawn(hull), FLAT, 1)
        assert 0.48 < found.triangular < 1.01
        assert 0.48 < found.rectangular < 1.01

    @settings(max_examples=20)
    @given(convex)
    def test_the_least_triangle_is_that_of_a_search_among_many(self, hull):
        mask = drawn(hull)
        assert mask.sum() / measure(mask, FLAT, 1).triangular == pytest.approx(_least_triangle(hull), rel=0.05)

    def test_cloth_outside_of_the_picture_keeps_no_bound(self):
        bounds = Bounds(area_max=0.5)
        nothing, cut = np.zeros_like(FLAT), np.zeros_like(FLAT)
        cut[:40, 100:140] = True
        for mask in (nothing, cut):
            assert bounds.failing(measure(mask, FLAT, 2)) == ("in_view",)

    def test_each_bound_fails_on_its_own(self):
        half = measure(drawn(box(180, 90)), FLAT, 2)
        kept = {
            "area_min": 0.4, "area_max": 0.6, "rectangular_min": 0.9, "triangular_min": 0.4, "length_max": 1.0,
            "steps_min": 2, "steps_max": 2,
        }  # fmt: skip
        missed = {
            "area_min": 0.6, "area_max": 0.4, "rectangular_min": 1.0, "triangular_min": 0.6, "length_max": 0.8,
            "steps_min": 3, "steps_max": 1,
        }  # fmt: skip
        assert Bounds(**kept).failing(half) == ()
        tilted = measure(drawn(box(180, 90), 0.3), FLAT, 2)
        assert {name: Bounds(**{name: bound}).failing(tilted) for name, bound in missed.items()} == {
            name: (name,) for name in missed
        }


def _least_triangle(hull):
    """Area of the least triangle about a convex polygon whose sides lie along edges or in one of 45 directions."""
    from itertools import combinations

    edges = np.roll(hull, -1, axis=0) - hull
    across = np.column_stack([edges[:, 1], -edges[:, 0]])
    across *= np.sign(((hull - hull.mean(axis=0)) * across).sum(axis=1))[:, None]
    turns = np.sort(
        np.concatenate([np.arctan2(across[:, 1], across[:, 0]) % (2 * np.pi), np.radians(range(0, 360, 8))])
    )
    normals = np.column_stack([np.cos(turns), np.sin(turns)])
    reach = (normals @ hull.T).max(axis=1)
    chosen = np.array(list(combinations(range(len(turns)), 3)))
    gaps = np.diff(np.column_stack([turns[chosen], turns[chosen[:, 0]] + 2 * np.pi]), axis=1)
    chosen = chosen[((gaps > 1e-6) & (gaps < np.radians(178))).all(axis=1)]
    a, b, c = (_crossing(normals, reach, chosen[:, i], chosen[:, j]) for i, j in ((0, 1), (1, 2), (2, 0)))
    u, v = b - a, c - a
    return float(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).min() / 2)


def _crossing(normals, reach, i, j):
    """Where the lines with these normals and distances from the origin cross, shape (N, 2)."""
    (a, b), (c, d) = normals[i].T, normals[j].T
    return np.column_stack([reach[i] * d - reach[j] * b, a * reach[j] - c * reach[i]]) / (a * d - b * c)[:, None]


VALID = """
schema_version = 1
name = "mine"
[[goal]]
id = "smaller"
garment = "square"
text = "Make it smaller."
accept = ["square-corners-all"]
done = { area_max = 0.6 }
"""

TASK = """
[[task]]
id = "diagonal"
garment = "square"
type = "Own"
steps = [{ pairs = [["top_left", "bottom_right"]] }]
instructions = ["Fold it along the diagonal."]
"""


def write(tmp_path, text):
    path = tmp_path / "mine.toml"
    path.write_text(text)
    return str(path)


class TestFile:
    def test_a_suite_may_hold_tasks_and_goals(self, tmp_path):
        found = load_suite(write(tmp_path, VALID + TASK))
        assert [entry.id for entry in found.entries] == ["diagonal", "smaller"]
        assert found.entry("smaller").instructions == ("Make it smaller.",)
        with pytest.raises(ConfigError, match="no task 'smaller'"):
            found.task("smaller")
        with pytest.raises(ConfigError, match="did you mean 'smaller'"):
            found.entry("smalle")

    @pytest.mark.parametrize(
        ("old", "new", "words"),
        [
            ("area_max", "area", r"goal smaller has no setting 'done\.area'"),
            ("area_max = 0.6", "area_max = 60", r"goal smaller has a bad value for 'done\.area_max'"),
            (
                "area_max = 0.6",
                "area_max = 0.6, area_min = 0.7",
                r"goal smaller has a bad value for 'done': area_min 0.7 is above",
            ),
            (
                "area_max = 0.6",
                "steps_max = 1, steps_min = 2",
                r"goal smaller has a bad value for 'done': steps_min 2 is above",
            ),
            ("{ area_max = 0.6 }", "{}", "goal smaller has a bad value for 'done': it has no bound"),
            ('text = "Make it smaller."', "", "goal smaller has no 'text'; add it"),
            ('id = "smaller"', "", "goal number 1 has no 'id'; add it"),
            (
                '["square-corners-all"]',
                '["a", "a"]',
                "goal smaller has a bad value for 'accept': the task 'a' is named twice",
            ),
            (
                'accept = ["square-corners-all"]\ndone = { area_max = 0.6 }',
                "",
                "goal smaller can't be used: nothing counts",
            ),
            (VALID[VALID.index("[[goal]]") :], "", "the suite is empty"),
            ('id = "smaller"', 'id = "diagonal"', "the id 'diagonal' is used twice"),
        ],
    )
    def test_mistakes_are_named_by_file_goal_and_field(self, tmp_path, old, new, words):
        text = VALID.replace(old, new) + (TASK if "diagonal" in new else "")
        with pytest.raises(ConfigError, match=words) as caught:
            load_suite(write(tmp_path, text))
        assert "mine.toml" in str(caught.value)

    @pytest.mark.parametrize(
        ("old", "new", "words"),
        [
            ("square-corners-all", "square-corners-al", "field accept: .*did you mean 'square-corners-all'"),
            ("square-corners-all", "tshirt-half-hem", "field accept: tshirt-half-hem is for a tshirt"),
            ('name = "mine"', 'name = "mine"\naccept_from = "polyfold7"', "field accept: .*polyfold7.*accept_from"),
        ],
    )
    def test_accepted_tasks_are_checked_where_suites_are_known(self, registered, old, new, words):
        with pytest.raises(ConfigError, match=words) as caught:
            suite(registered(VALID.replace(old, new)))
        assert "mine.toml: goal smaller" in str(caught.value)

    def test_a_suite_may_accept_tasks_of_its_own(self, registered):
        text = VALID.replace('name = "mine"', 'name = "mine"\naccept_from = "mine"')
        found = suite(registered(text.replace("square-corners-all", "diagonal") + TASK))
        assert found.task("diagonal").garment == "square"


@pytest.fixture
def registered(tmp_path, monkeypatch):
    """Registers a suite from its text, and gives it back its name."""
    monkeypatch.setenv("POLYFOLD_CACHE", str(tmp_path / "cache"))

    def register(text):
        polyfold.register("tasks", "by-hand", write(tmp_path, text))
        return "by-hand"

    yield register
    polyfold.plugins.unregister("tasks", "by-hand")


GOALS = """
schema_version = 1
name = "mine"

[[goal]]
id = "triangle"
garment = "square"
text = "Fold it along the diagonal that runs from the bottom left to the top right corner, the top left corner moves."
accept = ["square-corner-top_left", "square-triangle-top_left"]

[[goal]]
id = "half"
garment = "square"
text = "Fold the top left corner onto the bottom right corner."
done = { area_min = 0.4, area_max = 0.62, steps_max = 1 }

[[goal]]
id = "tiny"
garment = "square"
text = "Fold the top left corner onto the bottom right corner."
done = { area_max = 0.3, rectangular_min = 0.8 }

[[goal]]
id = "nonsense"
garment = "square"
text = "Sing it a song."
done = { area_max = 0.62 }
"""


class TestStudy:
    @pytest.fixture
    def results(self, registered, tmp_path):
        study = polyfold.Study(
            name="open",
            suite=registered(GOALS),
            first_seed=2000,
            reference="oracle",
            edge_length=0.02,  # at 30 mm the crease alone takes a tenth of the area
            variants={"polyfold": {}, "oracle": {"agent": "oracle"}, "noop": {"agent": "noop"}},
        )
        return polyfold.run(study, tmp_path / "run", progress=False)

    def test_goals_are_judged_by_accepted_tasks_or_their_own_bounds(self, results, tmp_path):
        ours, oracle, noop = ({r.task: r for r in results.of(name)} for name in results.study.variants)

        assert ours["half"].success == {"lenient": True, "strict": True}, "bounds count under both"
        assert {ours["half"].metrics[name] for name in MEASURED} == {None}
        assert ours["half"].done.holds
        assert ours["half"].done.measured["area"] == pytest.approx(0.5, abs=0.05)
        assert ours["half"].steps_wanted is None

        assert not ours["tiny"].succeeded
        assert ours["tiny"].done.failing == ("area_max", "rectangular_min")
        assert ours["tiny"].cause == "subgoal", "the fold came out as planned"
        assert (ours["nonsense"].failure.stage, ours["nonsense"].cause) == ("refused", "subgoal")

        assert ours["triangle"].succeeded, "the second of the accepted tasks"
        assert ours["triangle"].done is None
        assert ours["triangle"].metrics["miou"] > 0.9
        assert {name: oracle["triangle"].metrics[name] for name in MEASURED} == MEASURED, "guided by the first"

        assert oracle["half"].failure.stage == oracle["half"].cause == "infrastructure"
        assert "half accepts none" in oracle["half"].failure.reason
        assert oracle["half"].privileged

        assert not any(record.succeeded for record in noop.values())
        assert {record.cause for record in noop.values()} == {"subgoal"}

        table = polyfold.table(results)
        assert "nearest task that each accepts" in table.note
        row = next(row for row in table.rows if row[:2] == ["polyfold", "square"])
        assert dict(zip(table.headers, row, strict=True))["success %"].startswith("50.0")
        page = report_html(tmp_path / "run")
        assert "missed: area_max, rectangular_min" in page
        assert "the reference itself moves nothing" not in page

    def test_patterns_choose_goals_and_a_split_leaves_them_out(self, registered):
        settings = {"name": "open", "suite": registered(GOALS + TASK), "first_seed": 2000}
        chosen = [cell.task for cell in cells(polyfold.Study(**settings, tasks=("t*", "diagonal")))]
        assert chosen == ["diagonal", "triangle", "tiny"]
        assert [cell.task for cell in cells(polyfold.Study(**settings, steps="single"))] == ["diagonal"]

    @pytest.mark.parametrize("mixed", [True, False])
    def test_thresholds_hold_against_one_reference_together(self, registered, monkeypatch, mixed):
        def two(task, garment, seed, simulator):
            """One has the silhouette of the result, the other its particles, unless the second has both."""
            real = reference_for(SUITE.task("square-corner-top_left"), garment, seed, simulator).outcome
            if task.id == "square-corner-top_left":
                astray = replace(real.end, positions=real.end.positions + np.array([0.2, 0.0, 0.0]))
                return Reference(replace(real, end=astray), ())
            return Reference(replace(real, mask=np.zeros_like(real.mask)) if mixed else real, ())

        monkeypatch.setattr("polyfold.studies._cell.reference_for", two)
        study = polyfold.Study(
            name="open",
            suite=registered(GOALS),
            tasks=("triangle",),
            first_seed=2000,
            edge_length=0.03,
            reference="oracle",
            base={"agent": "oracle"},
        )
        record = evaluate_cell(study, next(cells(study)))[0]
        assert record.success == {"lenient": not mixed, "strict": not mixed}
