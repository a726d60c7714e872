"""What is typed at a prompt prints in a line or two, whatever arrays are inside."""

import pytest

import polyfold
from polyfold.analysis import Table

LINE = 420


@pytest.fixture(scope="module")
def episode():
    return polyfold.fold("fold it in half", polyfold.garment("square", 0, edge_length=0.05))


def test_an_episode_says_what_was_asked_and_how_it_came_out(episode):
    told = repr(episode)
    assert "“fold it in half”, 1 fold" in told
    assert "IoU" in told
    assert "\n" not in told


@pytest.mark.parametrize(
    "part",
    [
        lambda episode: episode.steps[0],
        lambda episode: episode.steps,
        lambda episode: episode.initial_state,
        lambda episode: episode.start,
        lambda episode: episode.steps[0].scene,
        lambda episode: episode.steps[0].scene.model,
        lambda episode: episode.garment,
        lambda episode: episode.garment.mesh,
        lambda episode: episode.calls[0],
        lambda episode: episode.calls[0].reply,
    ],
)
def test_values_print_in_a_line_with_the_names_of_their_fields(episode, part):
    told = repr(part(episode))
    assert len(told) < LINE
    assert "array(" not in told
    assert "=" in told


def test_sizes_are_told_and_short_values_kept(episode):
    assert "shape (400, 400, 3)" in repr(episode.start)
    assert "kind='square'" in repr(episode.garment)
    assert "“" not in repr(episode.steps[0])


def test_a_table_at_the_prompt_is_the_table():
    table = Table(("variant", "n"), (("a", "3"), ("b", "4")), "of three")
    assert repr(table) == str(table) == table.markdown()
    assert "| a | 3 |" in repr(table)
