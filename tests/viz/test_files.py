"""Filmstrips, sheets and animations: laid out to fit, written and readable again."""

import subprocess
import sys
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from polyfold import viz
from polyfold.errors import ConfigError
from polyfold.viz._draw._filmstrips import _legend
from polyfold.viz._draw._sheets import garment_sheet

LONG = "fold the lower hem of the garment up to the shoulder seams along the horizontal line through the middle " * 3


def frames_of(count, rgb, scene, fold_line, action):
    return [
        viz.Frame(rgb, scene, fold_line, action, f"fold part {i} to the left", "grounding 0.12 s") for i in range(count)
    ]


@pytest.mark.parametrize("count", [0, 1, 3, 7])
def test_filmstrip_has_a_panel_for_each_step_and_the_result(count, rgb, scene, fold_line, action, tmp_path):
    path = tmp_path / "new" / "strip.png"
    strip = viz.filmstrip(
        frames_of(count, rgb, scene, fold_line, action), rgb, "Fold it.", "IoU 0.95", scene.model.outline(), path
    )
    with Image.open(path) as written:
        assert (np.asarray(written) == strip).all()
    columns, rows = min(count + 1, 5), -(-(count + 1) // 5)
    assert 400 * columns < strip.shape[1] < 490 * columns
    assert 400 * rows < strip.shape[0] < 680 * rows


def test_filmstrip_shows_what_a_step_did(rgb, scene, fold_line, action):
    bare = viz.filmstrip([viz.Frame(rgb)], rgb)
    full = viz.filmstrip([viz.Frame(rgb, scene, fold_line, action)], rgb)
    panel = np.s_[60:380, 30:350]
    assert (bare[panel] != full[panel]).any()


def test_a_filmstrip_for_a_paper_keeps_words_as_words(rgb, scene, fold_line, action, tmp_path):
    frames = frames_of(2, rgb, scene, fold_line, action)
    written = []
    for name in ("strip.svg", "again.svg", "strip.pdf"):
        strip = viz.filmstrip(frames, rgb, "Fold it for $5 & more.", "IoU 0.95", scene.model.outline(), tmp_path / name)
        written.append((tmp_path / name).read_bytes())
    svg = written[0].decode()
    for words in ("Fold it for $5 &amp; more.", "2. fold part 1 to the left", "fold line, teeth on the lifted side"):
        assert f">{words}</text>" in svg
    assert f'viewBox="0 0 {0.75 * strip.shape[1]:g} {0.75 * strip.shape[0]:g}"' in svg, "a pixel is 1/96 inch"
    assert written[1] == written[0], "what is alike is the same file"
    assert written[2].startswith(b"%PDF")


def test_an_ending_that_is_no_picture_s_is_refused(rgb, tmp_path):
    for write in (viz.overlay, lambda rgb, path: viz.filmstrip([], rgb, path=path)):
        with pytest.raises(ConfigError, match=r"end it in \.png, \.pdf or \.svg"):
            write(rgb, path=tmp_path / "e.html")
    assert not list(tmp_path.iterdir())


def test_a_picture_can_be_written_as_shapes_too(rgb, scene, fold_line, action, tmp_path):
    drawn = viz.overlay(rgb, scene, fold_line, action, path=tmp_path / "new" / "picture.svg")
    assert drawn.shape == rgb.shape
    assert (tmp_path / "new" / "picture.svg").read_text().count("<path") > 30
    viz.overlay(rgb, scene, path=tmp_path / "picture.png")
    with Image.open(tmp_path / "picture.png") as written:
        assert written.size == (400, 400)


def test_long_texts_are_wrapped_and_cut_but_never_widen_the_page(rgb):
    short = viz.filmstrip([viz.Frame(rgb, title="x", caption="x")], rgb, "x", "x")
    long = viz.filmstrip([viz.Frame(rgb, title=LONG, caption=LONG)], rgb, LONG, "x" * 300)
    assert long.shape[1] == short.shape[1]
    assert long.shape[0] < short.shape[0] + 300
    assert (long[:, -20:] == 255).all()


def test_the_legend_fits_narrow_pages(rgb, scene, fold_line, action):
    outline = scene.model.outline()
    for count in (0, 1, 2, 4):
        strip = viz.filmstrip(frames_of(count, rgb, scene, fold_line, action), rgb, ideal_outline=outline)
        assert (strip[:, -20:] == 255).all()


def test_wide_pictures_leave_no_gap_below():
    square, wide = np.zeros((200, 200, 3), np.uint8), np.zeros((100, 200, 3), np.uint8)
    assert viz.filmstrip([], square).shape[0] - viz.filmstrip([], wide).shape[0] == pytest.approx(200, abs=2)


def test_png_bytes_can_be_read(rgb):
    assert (np.asarray(Image.open(BytesIO(viz.png(rgb)))) == rgb).all()


def test_gif_has_the_frames_and_holds_the_last_one(tmp_path):
    frames = [np.full((40, 60, 3), 20 * i, np.uint8) for i in range(10)]
    path = viz.gif(frames, tmp_path / "deep" / "fold.gif", fps=10)
    with Image.open(path) as animation:
        assert animation.n_frames == 10
        assert animation.size == (60, 40)
        durations = []
        for i in range(animation.n_frames):
            animation.seek(i)
            durations.append(animation.info["duration"])
        assert durations == [100] * 9 + [1500]
        assert np.abs(np.asarray(animation.convert("RGB")).astype(int) - 180).max() < 8


def test_gif_shrinks_until_it_is_small_enough(tmp_path):
    noise = np.random.default_rng(0).integers(0, 255, (4, 200, 200, 3), dtype=np.uint8)
    path = viz.gif(list(noise), tmp_path / "noise.gif", max_bytes=40_000)
    assert path.stat().st_size <= 40_000
    with Image.open(path) as animation:
        assert animation.size[0] < 200


def test_gif_refuses_frames_it_cannot_play(tmp_path):
    with pytest.raises(ConfigError, match="at least one frame"):
        viz.gif([], tmp_path / "none.gif")
    with pytest.raises(ConfigError, match="differ in size"):
        viz.gif([np.zeros((4, 4, 3), np.uint8), np.zeros((5, 4, 3), np.uint8)], tmp_path / "mixed.gif")


def test_garment_sheet_shows_every_picture(tmp_path):
    colours = {f"tshirt-{i:04d}": np.full((50, 80, 3), (20 * i, 100, 200 - 20 * i), np.uint8) for i in range(9)}
    page = garment_sheet(colours, "Nine garments", tmp_path / "sheet.png", columns=3, side=100)
    flat = page.reshape(-1, 3)
    for rgb in colours.values():
        assert (flat == rgb[0, 0]).all(1).sum() > 0.5 * 100 * 62
    assert page.shape[1] < 450
    assert (tmp_path / "sheet.png").is_file()


def test_score_sheet_puts_pictures_of_a_case_side_by_side():
    red, blue = np.full((40, 40, 3), (255, 0, 0), np.uint8), np.full((40, 40, 3), (0, 0, 255), np.uint8)
    page = viz.score_sheet([viz.Card((red, blue), "real and twin", "IoU 0.97")], side=100)
    row = page[np.argmax((page == (255, 0, 0)).all(-1).any(1)) + 50]
    assert (row == (255, 0, 0)).all(-1).sum() == 100
    assert (row == (0, 0, 255)).all(-1).sum() == 100


def test_an_empty_sheet_is_refused():
    with pytest.raises(ConfigError, match="at least one picture"):
        viz.score_sheet([])


def test_the_legend_explains_all_that_is_drawn(rgb, scene, fold_line, action):
    (frame,) = frames_of(1, rgb, scene, fold_line, action)
    told = [meaning for _, meaning, _ in _legend([frame], with_ideal=True)]
    unseen = [meaning for _, meaning, _ in _legend([replace(frame, scene=None)], with_ideal=False)]
    of_scenes = {"fitted polygon", "crease", "lifted part, tinted", "ideal outline"}
    assert of_scenes <= set(told)
    assert set(told) - set(unseen) - {"covered vertex"} == of_scenes


FULL = """
import resource, sys
import numpy as np
from polyfold import viz
noise = np.random.default_rng(0).integers(0, 255, (2, 90, 90, 3), dtype=np.uint8)
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
for write in (lambda: viz.gif(list(noise), "fold.gif"), lambda: viz.save(noise[0], "fold.png")):
    try:
        write()
    except OSError:
        print("refused")
"""


def test_a_folder_in_a_picture_s_place_is_named_as_it_was_given(rgb, tmp_path):
    with pytest.raises(IsADirectoryError) as caught:
        viz.save(rgb, tmp_path)
    assert caught.value.filename == str(tmp_path)


def test_a_picture_that_is_a_link_stays_one(rgb, tmp_path):
    (tmp_path / "link.png").symlink_to(tmp_path / "real.png")
    viz.save(rgb, tmp_path / "link.png")
    assert (tmp_path / "link.png").is_symlink()
    assert (tmp_path / "real.png").is_file()


def test_a_picture_that_does_not_fit_on_the_disk_leaves_what_was_there(tmp_path):
    for name in ("fold.gif", "fold.png"):
        (tmp_path / name).write_text("before")
    child = subprocess.run([sys.executable, "-c", FULL], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert child.stdout.split() == ["refused", "refused"], child.stderr
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"fold.gif": "before", "fold.png": "before"}
