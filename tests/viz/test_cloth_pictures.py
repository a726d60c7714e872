"""Pictures for people: sides can be told apart, cloth lies where the camera sees it, and films say what happens."""

import numpy as np
import pytest
from PIL import Image

import polyfold
from polyfold.viz._draw._cloth import cloth_picture, sides_of
from polyfold.viz._pictures import _frame

TABLE = np.array([236, 236, 232])


@pytest.fixture(scope="module")
def folded(tmp_path_factory):
    """A t-shirt folded in half from the hem up, with its pictures."""
    out = tmp_path_factory.mktemp("half")
    garment = polyfold.garment("tshirt", seed=2001, edge_length=0.03)
    return polyfold.fold("fold the hem up to the shoulders", garment, seed=0, out=out), out


def near(picture, colour, within=40):
    """How many pixels have nearly a colour."""
    return int((np.abs(picture.astype(int) - colour).max(axis=2) < within).sum())


def test_the_back_is_seen_where_it_was_folded_up_and_nowhere_before(folded):
    episode, _ = folded
    (_, front), (_, back) = sides_of(episode.garment)
    flat, done = (cloth_picture(state, episode.garment) for state in (episode.initial_state, episode.final_state))
    assert near(flat, front) > 20 * near(flat, back)
    assert near(done, back) > 2 * near(done, front), "only the sleeves still show the front"
    seen = episode.final.rgb
    assert near(seen, episode.garment.colours[0]) > 5 * near(seen, back), "the camera sees one colour on both sides"


@pytest.mark.parametrize("kind", ["square", "pants"])
@pytest.mark.parametrize("zoom", [1.0, 2.0])
def test_cloth_lies_where_the_camera_sees_it(kind, zoom):
    from polyfold import plugins

    garment = polyfold.garment(kind, seed=2002, edge_length=0.03)
    simulator = plugins.create("simulators", "xpbd")
    seen = simulator.reset(garment, 1)
    picture = cloth_picture(simulator.state(), garment, zoom)
    assert picture.shape == (400 * zoom, 400 * zoom, 3)
    small = np.asarray(Image.fromarray(picture).resize((400, 400), Image.Resampling.BOX), int)
    drawn = np.abs(small - TABLE).max(axis=2) > 60
    there = np.abs(seen.rgb.astype(int) - TABLE).max(axis=2) > 60
    assert (drawn & there).sum() / (drawn | there).sum() > 0.985


def test_a_film_shows_the_plan_first_then_the_arms_then_the_result(folded):
    episode, out = folded
    with Image.open(out / "fold.gif") as film:
        pages = []
        for number in range(film.n_frames):
            film.seek(number)
            pages.append((film.info["duration"], np.asarray(film.convert("RGB"), int)))
    assert len(episode.steps) == 1
    assert len(pages) > 8
    assert pages[0][0] > 1000, "the plan stays"
    assert pages[-1][0] > 1500, "and so does the result"
    orange, green = (245, 133, 24), (0, 150, 94)
    assert all(near(page, orange, 60) for _, page in pages[:-1]), "arms are seen until the fold is over"
    assert not near(pages[-1][1], orange, 60)
    assert all(near(page, green, 60) for _, page in pages[:-1]), "and so is the fold line"
    titles = [page[:60] for _, page in pages]
    assert (titles[0] < 100).any(), "the sentence stands above"
    assert all(np.abs(title - titles[0]).max() < 60 for title in titles)


def test_a_filmstrip_says_what_happened_and_not_how_long_it_took(folded):
    episode, _ = folded
    (step,) = episode.steps
    assert step.in_words() == "two arms"
    assert _frame(step, None).caption == "two arms"
