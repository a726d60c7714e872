"""Policies without learning: what they pick, what they refuse, and that they do the same every time."""

import numpy as np
import pytest
from drawn_scenes import CENTRE, SQUARE, TSHIRT, model_of, near, scene_of
from polyfold_fgpnp.policies.geometric import AffordancePair, Caso, Farthest, VertexRandom
from pydantic import ValidationError

from polyfold import plugins
from polyfold.errors import PlanError
from polyfold.geometry import FoldLine, rotate
from polyfold.plugins.interfaces import Policy

POLICIES = {"affordance-pair": AffordancePair, "caso": Caso, "vertex-random": VertexRandom, "farthest": Farthest}
every_policy = pytest.mark.parametrize("policy", POLICIES.values(), ids=POLICIES)

LINES = {
    "half": (SQUARE, ((200, 350), (200, 50))),
    "corner": (SQUARE, ((100, 200), (200, 100))),
    "sleeve": (TSHIRT, ((135, 180), (130, 85))),
    "slanted sleeve": (TSHIRT, ((135, 180), (165, 70))),
    "hem": (TSHIRT, ((280, 205), (120, 205))),
    "side": (TSHIRT, ((200, 330), (200, 95))),
}
every_line = pytest.mark.parametrize(("corners", "line"), LINES.values(), ids=LINES)


def act(policy, corners, line, angle=0.0, seed=0):
    fold_line = FoldLine.between(*rotate(np.array(line, float), angle, CENTRE))
    scene = scene_of(model_of(corners, angle))
    return fold_line, scene, policy.act(fold_line, scene, np.random.default_rng(seed))


@every_policy
def test_policies_are_registered_and_keep_to_the_interface(policy):
    name = next(name for name, known in POLICIES.items() if known is policy)
    assert isinstance(plugins.create("policies", name), policy)
    assert isinstance(policy(), Policy)


@every_policy
@every_line
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_picks_lie_on_the_cloth_left_of_the_line_and_places_mirror_them(policy, corners, line, angle):
    fold_line, scene, action = act(policy(), corners, line, angle)
    assert fold_line.lifts(action.picks).all()
    columns, rows = action.picks.astype(int).T
    assert scene.mask[rows, columns].all()
    assert action.places == pytest.approx(fold_line.mirror(action.picks), abs=1e-6)


@every_policy
@every_line
def test_the_same_scene_gives_the_same_action(policy, corners, line):
    once, again = (act(policy(), corners, line, seed=3)[2] for _ in range(2))
    assert (once.picks == again.picks).all()
    assert (once.places == again.places).all()


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.0, 2.5])
def test_the_best_pair_is_at_the_far_corners(angle):
    def picks(corners, line):
        return act(AffordancePair(AffordancePair.Config(slide=0)), corners, line, angle)[2].picks

    def turned(*names, of):
        return rotate(np.array([of[name] for name in names], float), angle, CENTRE)

    assert near(picks(*LINES["half"]), *turned("top_left", "bottom_left", of=SQUARE))
    assert near(picks(*LINES["corner"]), *turned("top_left", of=SQUARE))
    assert near(picks(*LINES["sleeve"]), *turned("sleeve_top_left", "sleeve_bottom_left", of=TSHIRT), within=8)
    assert near(picks(*LINES["hem"]), *turned("hem_left", "hem_right", of=TSHIRT), within=8)


def test_the_best_pair_slides_two_picks_towards_each_other_and_leaves_one_alone():
    wide = act(AffordancePair(AffordancePair.Config(slide=0)), *LINES["half"])[2]
    narrow = act(AffordancePair(), *LINES["half"])[2]
    assert np.ptp(narrow.picks[:, 1]) == pytest.approx(0.8 * np.ptp(wide.picks[:, 1]), rel=0.05)
    assert near(act(AffordancePair(), *LINES["corner"])[2].picks, SQUARE["top_left"])


def test_farthest_starts_from_the_point_farthest_from_the_line():
    picks = act(Farthest(), TSHIRT, LINES["side"][1])[2].picks
    assert np.hypot(*(picks - TSHIRT["sleeve_top_left"]).T).min() < 6


def test_caso_starts_anywhere_on_the_contour_and_takes_the_best_partner():
    actions = [act(Caso(Caso.Config(one_arm_px=0)), *LINES["half"], seed=seed)[2] for seed in range(30)]
    firsts, corners = set(), np.array([SQUARE["top_left"], SQUARE["bottom_left"]])
    for action in actions:
        away = np.hypot(*(action.picks[:, None] - corners).transpose(2, 0, 1)).min(axis=1)
        assert away.min() < 6, "the partner is a corner, whatever the first pick"
        firsts.add(tuple(np.round(action.picks[int(np.argmax(away))], -1)))
    assert len(firsts) > 15, "the first pick is drawn"


def test_vertex_random_takes_only_vertices_left_of_the_line_and_all_of_them():
    seen = set()
    for seed in range(30):
        action = act(VertexRandom(VertexRandom.Config(one_arm_px=0)), *LINES["half"], seed=seed)[2]
        for pick in action.picks:
            seen.add(min(SQUARE, key=lambda name: np.hypot(*(pick - SQUARE[name]))))
    assert seen == {"top_left", "bottom_left"}


def test_vertex_random_needs_a_polygon():
    scene = scene_of(model_of(SQUARE))
    blind = type(scene)(scene.kind, scene.image_size, scene.mask, scene.contour, None, "{}")
    with pytest.raises(PlanError, match="ground with polygon"):
        VertexRandom().act(FoldLine((200, 350), (200, 50)), blind, np.random.default_rng(0))


@every_policy
def test_a_line_with_no_cloth_on_its_left_is_refused(policy):
    with pytest.raises(PlanError):
        act(policy(), SQUARE, ((100, 350), (100, 50)))


def test_folded_cloth_is_picked_through_all_layers():
    line = FoldLine((200, 350), (200, 50))
    scene = scene_of(model_of(SQUARE).fold(line))
    action = AffordancePair(AffordancePair.Config(slide=0)).act(
        FoldLine((150, 200), (350, 200)), scene, np.random.default_rng(0)
    )
    assert near(action.picks, (200, 100), (300, 100))


@every_policy
def test_parameters_are_checked(policy):
    with pytest.raises(ValidationError):
        policy.Config(gamma=-1)
    with pytest.raises(ValidationError):
        policy.Config(gama=0.1)
