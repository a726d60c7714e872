"""An episode in a notebook: all folds at once, or one at a time in large, without a script."""

import re

import pytest

import polyfold
from polyfold.viz._pictures import stepper


@pytest.fixture(scope="module")
def html():
    square = polyfold.garment("square", 0, edge_length=0.04)
    return polyfold.fold("fold it in half, then fold it in half again", square)._repr_html_()


def test_each_fold_has_its_button_and_its_picture(html):
    assert re.findall(r"<label for=[^>]+>([^<]+)</label>", html) == ["all", "1", "2", "result"]
    assert html.count("<figure") == html.count("<img") == 4
    assert "<script" not in html
    assert "onclick" not in html


def test_one_is_shown_first_and_each_button_shows_its_own(html):
    assert html.count(" checked>") == 1
    shown = re.findall(r"#(\S+):checked~figure:nth-of-type\((\d)\)", html)
    assert [int(number) for _, number in shown] == [1, 2, 3, 4]
    assert [one for one, _ in shown] == re.findall(r'<input type="radio" name="[^"]+" id="([^"]+)"', html)


def test_two_in_one_notebook_do_not_answer_to_each_other_s_buttons():
    one, other = (stepper(["a", "b"], ["<figure>the same</figure>", "<figure></figure>"]) for _ in range(2))
    name = re.compile(r'name="([^"]+)"')
    assert set(name.findall(one)).isdisjoint(name.findall(other))


def test_words_are_words(html):
    assert "&lt;b&gt;" in stepper(["<b>"], ["<figure></figure>"])
