"""The playground under a real mouse in a real browser: drawn on, folded, talked to, taken back."""

import pytest

TURNS = "document.querySelectorAll('.polyfold-turns li').length == {}"


@pytest.fixture
def table(lab):
    """A page with a playground, and a function that gives the mouse's place of a camera's pixel."""
    page = lab(
        "import polyfold\nplayground = polyfold.play(polyfold.garment('square', 0, edge_length=0.03))\nplayground"
    )
    canvas = page.locator(".polyfold-table")
    canvas.wait_for()
    page.wait_for_function("document.querySelector('.polyfold-table').width == 500")

    def at(x, y):
        box = canvas.bounding_box()
        return box["x"] + (x + 0.5) / 400 * box["width"], box["y"] + (y + 0.5) / 400 * box["height"]

    return page, at


def dragged(page, at, start, end):
    page.mouse.move(*at(*start))
    page.mouse.down()
    page.mouse.move(*at(*end), steps=6)
    page.mouse.up()


def test_a_line_is_drawn_folded_and_taken_back(table, keep_screenshot):
    page, at = table
    status, fold = page.locator(".polyfold-status"), page.locator("button.polyfold-main")
    assert fold.is_disabled()
    dragged(page, at, (80, 200), (320, 200))
    page.wait_for_function("document.querySelector('.polyfold-status').textContent.startsWith('two arms')")
    keep_screenshot(page, "playground-line")
    fold.click()
    page.wait_for_function(TURNS.format(1))
    keep_screenshot(page, "playground-folded")
    page.get_by_role("button", name="Undo").click()
    page.wait_for_function(TURNS.format(0))
    assert status.text_content() == "taken back"


def test_picks_are_dragged_and_a_sentence_goes_on(table, keep_screenshot):
    page, at = table
    page.locator(".polyfold-panel select").select_option("picks")
    dragged(page, at, (130, 130), (170, 170))
    page.wait_for_function("document.querySelector('.polyfold-status').textContent.startsWith('one arm')")
    page.locator("button.polyfold-main").click()
    page.wait_for_function(TURNS.format(1))
    page.get_by_label("a sentence").fill("fold it in half")
    page.keyboard.press("Enter")
    page.wait_for_function(TURNS.format(2))
    page.get_by_role("button", name="Code").click()
    page.wait_for_function("document.querySelector('.polyfold-panel textarea').value.includes('fold it in half')")
    keep_screenshot(page, "playground-code")
