"""Cloth is told from real-looking tables in any light by the segmenters for photographs; nothing there is refused."""

from functools import lru_cache

import numpy as np
import pytest
from onnx_network import promptable
from PIL import Image

from experiments.benchmarks.segmentation.scenes import KINDS, drawn_scene
from polyfold import plugins
from polyfold.errors import ConfigError, GroundingError
from polyfold.geometry import Camera, iou
from polyfold.types import Observation

scene = lru_cache(drawn_scene)
FIRST = 1001  # of the seeds for development; the kinds take turns from here on


def observed(rgb):
    height, width = rgb.shape[:2]
    return Observation(rgb, np.full((height, width), 2.0, np.float32), Camera(width, height))


def segmenter(name, **params):
    return plugins.create("segmenters", name, params)


def saved(rgb, path):
    Image.fromarray(rgb).save(path)
    return str(path)


def box_around(mask, margin=0.03):
    (rows, columns), (height, width) = np.nonzero(mask), mask.shape
    low = (columns.min() / width - margin, rows.min() / height - margin)
    high = (columns.max() / width + margin, rows.max() / height + margin)
    return [float(np.clip(value, 0, 1)) for value in (*low, *high)]


@pytest.mark.parametrize("seed", range(FIRST, FIRST + len(KINDS)), ids=lambda seed: scene(seed).kind)
class TestEveryKindOfScene:
    def test_the_automatic_one_finds_the_garment_and_nothing_on_the_empty_table(self, seed):
        photo = segmenter("photo")
        assert iou(photo.segment(observed(scene(seed).rgb)), scene(seed).mask) > 0.95
        with pytest.raises(GroundingError, match="no cloth stands out"):
            photo.segment(observed(scene(seed).empty))

    def test_a_picture_of_the_empty_table_finds_it_in_other_light(self, seed, tmp_path):
        background = segmenter("background", picture=saved(scene(seed).empty, tmp_path / "empty.png"))
        found = background.segment(observed(scene(seed).rgb))
        assert iou(found, scene(seed).mask) > (0.85 if scene(seed).kind == "pattern" else 0.95)


class TestPhoto:
    def test_a_mask_is_the_same_whenever_it_is_made(self):
        first, again = (segmenter("photo").segment(observed(scene(FIRST).rgb)) for _ in range(2))
        np.testing.assert_array_equal(first, again)

    def test_a_cable_is_cut_off_unless_thin_things_count(self):
        seen = scene(FIRST + KINDS.index("cable") - KINDS.index(scene(FIRST).kind))
        assert seen.kind == "cable"
        beside = segmenter("photo").segment(observed(seen.rgb)) & ~seen.mask
        kept = segmenter("photo", thin=0.003).segment(observed(seen.rgb)) & ~seen.mask
        assert beside.sum() < 0.005 * seen.mask.sum()
        assert kept.sum() >= beside.sum()

    def test_two_garments_are_one_too_many(self):
        rgb = np.full((300, 400, 3), 200, np.uint8)
        rgb[80:220, 60:160] = rgb[80:220, 240:340] = (40, 60, 140)
        with pytest.raises(GroundingError, match="several things"):
            segmenter("photo").segment(observed(rgb))

    def test_cloth_that_the_border_cuts_off_is_doubted(self):
        rgb, mask = np.full((300, 400, 3), 200, np.uint8), np.zeros((300, 400), bool)
        mask[100:, 120:280] = True
        rgb[mask] = (40, 60, 140)
        assert any("border cuts the cloth off" in doubt for doubt in segmenter("photo").doubts(observed(rgb), mask))
        whole = np.zeros_like(mask)
        whole[100:250, 120:280] = True
        assert segmenter("photo").doubts(observed(np.where(whole[..., None], rgb[200, 200], rgb[10, 10])), whole) == ()

    def test_a_shadow_that_is_taken_for_cloth_is_doubted_and_so_is_an_outline_that_nothing_shows(self):
        rgb = np.full((300, 400, 3), (200, 170, 140), np.uint8)
        rgb[80:200, 100:300] = (130, 110, 91)
        shadow = np.zeros((300, 400), bool)
        shadow[80:200, 100:300] = True
        assert any("shadow" in doubt for doubt in segmenter("photo").doubts(observed(rgb), shadow))
        invented = np.zeros((300, 400), bool)
        invented[140:280, 40:180] = True
        assert any(
            "nothing sets the cloth apart" in doubt for doubt in segmenter("photo").doubts(observed(rgb), invented)
        )

    def test_a_grey_yoke_that_was_lost_is_doubted(self):
        rng = np.random.default_rng(0)
        rgb = rng.normal((205, 205, 202), 4, (300, 400, 3))
        rgb[70:110, 100:300], rgb[110:240, 100:300] = (120, 120, 119), (225, 90, 30)
        mask = np.zeros((300, 400), bool)
        mask[110:240, 100:300] = True
        picture = observed(rgb.clip(0, 255).astype(np.uint8))
        assert any("is it cloth?" in doubt for doubt in segmenter("photo").doubts(picture, mask))
        mask[70:110, 100:300] = True
        assert not any("is it cloth?" in doubt for doubt in segmenter("photo").doubts(picture, mask))


class TestBackground:
    def test_a_hand_that_reaches_in_is_no_cloth(self, tmp_path):
        rng = np.random.default_rng(0)
        empty = rng.normal((120, 130, 140), 4, (300, 400, 3)).clip(0, 255).astype(np.uint8)
        mask = np.zeros((300, 400), bool)
        mask[90:210, 120:260] = True
        laden = np.where(mask[..., None], (60, 80, 170), empty).astype(np.uint8)
        laden[130:170, 255:] = (210, 160, 130)
        background = segmenter("background", picture=saved(empty, tmp_path / "empty.png"))
        cloth = mask.copy()
        cloth[130:170, 255:] = False
        assert iou(background.segment(observed(laden)), cloth) > 0.97

    def test_nothing_new_is_no_cloth(self, tmp_path):
        background = segmenter("background", picture=saved(scene(FIRST).empty, tmp_path / "empty.png"))
        with pytest.raises(GroundingError, match="no cloth stands out"):
            background.segment(observed(scene(FIRST).empty))

    def test_a_picture_of_another_shape_is_refused_with_both_sizes_and_one_of_another_resolution_is_not(self, tmp_path):
        seen = scene(FIRST)
        cropped = segmenter("background", picture=saved(seen.empty[:400], tmp_path / "cropped.png"))
        with pytest.raises(GroundingError, match=r"640 x 400 px, the one with cloth 640 x 480.*same camera"):
            cropped.segment(observed(seen.rgb))
        half = np.asarray(Image.fromarray(seen.empty).resize((320, 240)))
        background = segmenter("background", picture=saved(half, tmp_path / "half.png"))
        assert iou(background.segment(observed(seen.rgb)), seen.mask) > 0.95

    def test_a_missing_or_damaged_picture_is_named(self, tmp_path):
        (tmp_path / "text.png").write_text("hello")
        for name, says in (("absent.png", "No such file"), ("text.png", "no picture")):
            with pytest.raises(GroundingError, match=rf"{name}.*{says}.*give a PNG or JPEG"):
                segmenter("background", picture=str(tmp_path / name))


class TestGrabCut:
    def test_a_box_says_which_of_two_things_is_meant(self):
        rgb = np.random.default_rng(1).normal(200, 4, (300, 400, 3)).clip(0, 255).astype(np.uint8)
        left, right = np.zeros((2, 300, 400), bool)
        left[80:220, 60:160] = right[80:220, 240:340] = True
        rgb[left | right] = (40, 60, 140)
        for mask in (left, right):
            assert iou(segmenter("grabcut", box=box_around(mask)).segment(observed(rgb)), mask) > 0.98

    def test_without_a_box_it_finds_one(self):
        assert iou(segmenter("grabcut").segment(observed(scene(FIRST).rgb)), scene(FIRST).mask) > 0.95

    def test_a_stroke_on_the_table_takes_away_what_was_taken_for_cloth(self):
        rgb = np.full((300, 400, 3), 200, np.uint8)
        rgb[100:200, 100:300] = (40, 60, 140)
        rgb[130:170, 300:360] = (60, 150, 60)
        cloth = np.zeros((300, 400), bool)
        cloth[100:200, 100:300] = True
        box = [0.2, 0.25, 0.95, 0.75]
        without = segmenter("grabcut", box=box).segment(observed(rgb))
        with_it = segmenter("grabcut", box=box, table=[[[0.78, 0.5], [0.88, 0.5]]]).segment(observed(rgb))
        assert without[150, 330]
        assert iou(with_it, cloth) > 0.97

    @pytest.mark.parametrize(
        "params", [{"box": [0.5, 0.1, 0.2, 0.9]}, {"box": [10, 20, 300, 200]}, {"cloth": [[[0.5, 2]]]}, {"cloth": [[]]}]
    )
    def test_boxes_in_pixels_or_inside_out_are_refused(self, params):
        with pytest.raises(ConfigError, match=rf"'grabcut' has a bad value for '{next(iter(params))}"):
            segmenter("grabcut", **params)

    def test_a_box_without_any_table_is_refused(self):
        with pytest.raises(GroundingError, match="leaves no table"):
            segmenter("grabcut", box=[0, 0, 1, 1]).segment(observed(scene(FIRST).rgb))


class TestPromptable:
    """A real network: the best of its masks is what is dark and left of the farthest point or corner shown."""

    @pytest.fixture
    def weights(self, tmp_path):
        (tmp_path / "network.onnx").write_bytes(promptable())
        return str(tmp_path / "network.onnx")

    @pytest.fixture
    def two(self):
        rgb = np.full((120, 160, 3), 220, np.uint8)
        rgb[30:90, 10:70] = rgb[40:80, 95:145] = (40, 60, 140)
        return observed(rgb)

    @staticmethod
    def mask(rows, columns):
        found = np.zeros((120, 160), bool)
        found[rows, columns] = True
        return found

    def test_points_and_boxes_reach_the_network(self, weights, two):
        whole, part = self.mask(slice(30, 90), slice(10, 70)), self.mask(slice(30, 90), slice(10, 40))
        assert iou(segmenter("sam", weights=weights, box=[0.05, 0.2, 0.5, 0.8]).segment(two), whole) > 0.95
        assert iou(segmenter("sam", weights=weights, points=[[0.25, 0.25]]).segment(two), part) > 0.9

    def test_a_mask_that_holds_what_is_no_cloth_is_passed_over(self, two, tmp_path):
        (tmp_path / "network.onnx").write_bytes(promptable(scores=(0.1, 0.9, 0.7)))
        common = {"weights": str(tmp_path / "network.onnx"), "points": [[0.25, 0.25]]}
        whole, part = self.mask(slice(30, 90), slice(10, 70)), self.mask(slice(30, 90), slice(10, 40))
        assert iou(segmenter("sam", **common).segment(two), whole) > 0.95
        assert iou(segmenter("sam", **common, no_cloth=[[0.75, 0.5]]).segment(two), part) > 0.9

    def test_nothing_there_is_said(self, weights, two):
        with pytest.raises(GroundingError, match="finds no cloth"):
            segmenter("sam", weights=weights, points=[[0.0, 0.03]]).segment(two)

    def test_files_that_are_no_such_network_are_refused(self, tmp_path):
        (tmp_path / "other.onnx").write_bytes(promptable(masks="logits"))
        (tmp_path / "text.onnx").write_text("hello")
        for name, says in (("other.onnx", "no output_masks"), ("text.onnx", "no ONNX"), ("absent.onnx", "no file")):
            with pytest.raises(GroundingError, match=says):
                segmenter("sam", weights=str(tmp_path / name))

    def test_more_points_than_it_takes_are_refused(self, weights):
        with pytest.raises(ConfigError, match="at most 4 points"):
            segmenter("sam", weights=weights, points=[[0.5, 0.5]] * 5)
