import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from polyfold_standard.templates.pants import pants_template
from polyfold_standard.templates.quads import rectangle_template, square_template, towel_template
from polyfold_standard.templates.shorts import shorts_template
from polyfold_standard.templates.tshirt import tshirt_template

from polyfold.errors import GarmentError
from polyfold.polygon import SymmetricGenerator, Template, angle_range, offset_range, position_range, ratio_range

TEMPLATES = [
    square_template(),
    rectangle_template(),
    towel_template(),
    tshirt_template(),
    pants_template(),
    shorts_template(),
]


@pytest.fixture(params=TEMPLATES, ids=lambda template: template.kind)
def template(request):
    return request.param


def test_canonical_shapes_are_plausible_and_upright(template):
    for shape in template.canonical_shapes:
        assert template.penalties.energy(300.0 * shape) < 4.0
        assert (shape.max(0) - shape.min(0)).max() == pytest.approx(1.0)
    point = dict(zip(template.names, template.canonical, strict=True))
    for name in template.names:
        if name.endswith("_left"):
            assert point[name][0] < point[name.replace("_left", "_right")][0]


def test_the_generator_reproduces_canonical_shapes_wherever_they_lie(template):
    generator = template.generator
    turn = np.array([[0.6, 0.8], [-0.8, 0.6]])
    for shape in template.canonical_shapes:
        placed = 250.0 * shape @ turn + (180.0, 220.0)
        np.testing.assert_allclose(generator.vertices(generator.parameters(placed)), placed, atol=1e-6)


def test_jacobians_match_differences(template):
    rng = np.random.default_rng(1)
    parameters = template.generator.parameters(250.0 * template.canonical) + rng.normal(0, 3, 1)
    steps = 1e-5 * np.eye(len(parameters))
    generate = template.generator.vertices
    differences = [(generate(parameters + step) - generate(parameters - step)) / 2e-5 for step in steps]
    np.testing.assert_allclose(template.generator.jacobian(parameters), np.stack(differences, -1), atol=1e-4)

    vertices = 100.0 * rng.normal(size=template.canonical.shape)
    residuals, jacobian = template.penalties.residuals_and_jacobian(vertices)
    assert template.penalties.energy(vertices) == pytest.approx(0.5 * residuals @ residuals)
    for v, c in np.ndindex(vertices.shape):
        step = np.zeros_like(vertices)
        step[v, c] = 1e-5
        slope = (template.penalties.residuals(vertices + step) - template.penalties.residuals(vertices - step)) / 2e-5
        np.testing.assert_allclose(jacobian[:, v, c], slope, atol=1e-4 * np.abs(jacobian).max())


def test_text_names_everything_once(template):
    content = json.loads(template.to_text())
    assert list(content) == ["garment", "vertices", "parts"]
    assert list(content["vertices"]) == list(template.names)
    assert {name for members in content["parts"].values() for name in members} <= set(template.names)


def test_templates_agree_on_the_contract():
    assert tshirt_template().names[:3] == ("hem_left", "armpit_left", "sleeve_bottom_left")
    assert square_template().names == ("bottom_left", "top_left", "top_right", "bottom_right")
    assert pants_template().names[-1] == "crotch"
    assert [t.kind for t in TEMPLATES if t.cyclic] == ["square", "rectangle", "towel"]


NAMES = ("a_left", "b_left", "b_right", "a_right")
ACROSS = ("a_left", "a_right")


@given(st.floats(0.2, 5.0), st.floats(-3.0, 3.0), st.floats(0.1, 4.0))
def test_penalties_ignore_scale_and_rotation(scale, angle, height):
    penalties = [
        ratio_range(("a_left", "b_left"), ACROSS, 1.0, 2.0),
        angle_range(("a_left", "b_left"), ACROSS, -100, -80),
        position_range("b_left", ACROSS, 0.1, 0.2),
        offset_range("b_left", ACROSS, 0.0, 1.0),
    ]
    shape = np.array([(-1.0, 0.0), (-1.2, -height), (1.0, -height), (1.0, 0.0)])
    template = Template(
        "box", NAMES, dict.fromkeys(NAMES, "corner"), {}, [shape], SymmetricGenerator(NAMES, [ACROSS]), penalties
    )
    c, s = np.cos(angle), np.sin(angle)
    moved = scale * shape @ np.array([[c, s], [-s, c]]) + 7.0
    np.testing.assert_allclose(template.penalties.residuals(moved), template.penalties.residuals(shape), atol=1e-6)


def test_measures_are_what_they_say():
    shape = np.array([(0.0, 0.0), (0.0, -1.0), (2.0, -1.0), (2.0, 0.0)])

    def violation(penalty):
        t = Template(
            "box", NAMES, dict.fromkeys(NAMES, "x"), {}, [shape], SymmetricGenerator(NAMES, [ACROSS]), [penalty]
        )
        return float(t.penalties.residuals(shape)[0])

    up = ("a_left", "b_left")
    assert violation(ratio_range(up, ACROSS, 0.5, 0.5)) == 0.0
    assert violation(ratio_range(up, ACROSS, 0.7, 0.9, sigma=0.1)) == pytest.approx(-2.0)
    assert violation(angle_range(up, ACROSS, -90, -90)) == pytest.approx(0.0)  # from right to up: anticlockwise
    assert violation(angle_range(up, ACROSS, -120, -100, sigma=5)) == pytest.approx(2.0)
    assert violation(position_range("b_right", ACROSS, 1.0, 1.0)) == pytest.approx(0.0)
    assert violation(offset_range("b_right", ACROSS, -0.5, -0.5)) == pytest.approx(0.0)  # above, so on its left


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"names": ("a", "b")}, "shape"),
        ({"descriptions": {}}, "does not describe"),
        ({"kind": "Skirt!"}, "no usable name"),
        ({"parts": {"hem": ("elbow",)}}, "unknown vertices"),
        ({"covered": ("elbow",)}, "unknown vertices"),
        ({"canonical_shapes": [[(0, 0), (1, np.nan), (1, 1), (0, 1)]]}, "finite"),
        ({"penalties": [ratio_range(("a_left", "elbow"), ACROSS, 0, 1)]}, "elbow"),
    ],
)
def test_mistakes_in_a_template_are_named(change, says):
    arguments = {
        "kind": "skirt",
        "names": NAMES,
        "descriptions": dict.fromkeys(NAMES, "corner"),
        "parts": {},
        "canonical_shapes": [[(-1, 1), (-1, -1), (1, -1), (1, 1)]],
        "generator": SymmetricGenerator(NAMES, [ACROSS]),
    }
    with pytest.raises(GarmentError, match=says):
        Template(**{**arguments, **change})


def test_impossible_ranges_and_pairs_are_refused():
    with pytest.raises(GarmentError, match="low <= high"):
        ratio_range(ACROSS, ACROSS, 2.0, 1.0)
    with pytest.raises(GarmentError, match="unknown vertices"):
        SymmetricGenerator(NAMES, [("a_left", "elbow")])
