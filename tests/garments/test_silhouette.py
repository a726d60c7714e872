import json

import numpy as np
import pytest
from PIL import Image
from polyfold_standard.segmenters.colour import ColourThreshold
from shapes import KINDS

from polyfold.errors import GarmentError, GroundingError
from polyfold.garments import find_cloth
from polyfold.garments._outline_files import load_mask, load_outline, outline_from_photo
from polyfold.geometry import Camera, iou, rotate
from polyfold.geometry._masks import fill_polygon
from polyfold.types import Observation

TABLE = (236, 236, 232)


def shape_mask(height=400, width=400, kind="tshirt", seed=2000, angle=0.2):
    mesh = KINDS[kind].generate(seed, 0.03).mesh
    ring = rotate(mesh.vertices[mesh.boundary], angle)
    ring = ring / np.ptp(ring, axis=0).max() * 0.75 * min(height, width)
    return fill_polygon(ring * [1, -1] + [width / 2, height / 2], height, width)


def picture(mask, cloth=(60, 90, 150), table=TABLE, noise=0.0, shade=0.0, seed=0):
    rng = np.random.default_rng(seed)
    rgb = np.where(mask[..., None], np.array(cloth, float), np.array(table, float))
    rgb = rgb * (1.0 - shade * np.linspace(0, 1, mask.shape[1]))[None, :, None]
    return np.clip(rgb + rng.normal(0, 1, rgb.shape) * noise, 0, 255).astype(np.uint8)


def observe(rgb):
    return Observation(rgb, np.full(rgb.shape[:2], 2.0, np.float32), Camera())


class TestSegmenter:
    segmenter = ColourThreshold(ColourThreshold.Config())

    @pytest.mark.parametrize("kind", KINDS)
    def test_finds_the_cloth_to_the_pixel(self, kind):
        mask = shape_mask(kind=kind)
        assert iou(self.segmenter.segment(observe(picture(mask))), mask) > 0.995

    def test_takes_both_sides_of_the_fabric_for_cloth(self):
        mask = shape_mask()
        rgb = picture(mask)
        inside = mask.copy()
        inside[200:] = False
        rgb[inside] = (190, 180, 170)
        assert iou(self.segmenter.segment(observe(rgb)), mask) > 0.995

    def test_keeps_a_gap_through_which_the_table_shows(self):
        mask = shape_mask()
        mask[180:200, 190:210] = False
        assert not self.segmenter.segment(observe(picture(mask)))[185:195, 195:205].any()

    def test_ignores_noise_and_crumbs(self):
        mask = shape_mask()
        rgb = picture(mask, noise=4.0)
        rgb[20:24, 20:24] = 0
        assert iou(self.segmenter.segment(observe(rgb)), mask) > 0.99

    def test_an_empty_table_is_an_error(self):
        empty = np.zeros((400, 400), bool)
        with pytest.raises(GroundingError, match="no cloth stands out"):
            self.segmenter.segment(observe(picture(empty, noise=3.0)))

    def test_a_cloth_that_fills_the_picture_is_an_error(self):
        rgb = picture(np.zeros((400, 400), bool))
        rgb[120:280] = rgb[:, 120:280] = (10, 20, 30)
        with pytest.raises(GroundingError, match="show the whole cloth"):
            self.segmenter.segment(observe(rgb))

    def test_unknown_settings_are_refused(self):
        with pytest.raises(ValueError, match="treshold"):
            ColourThreshold.Config(treshold=3)


def test_a_threshold_is_found_under_uneven_light():
    mask = shape_mask(480, 640)
    assert iou(find_cloth(picture(mask, noise=5.0, shade=0.3)), mask) > 0.98


def test_grey_pictures_are_refused():
    with pytest.raises(GarmentError, match="convert it to RGB"):
        find_cloth(np.zeros((100, 100), np.uint8))


def test_outline_from_a_large_photo_is_in_its_own_pixels(tmp_path):
    mask = shape_mask(1500, 2000)
    Image.fromarray(picture(mask, noise=6.0, shade=0.2)).save(tmp_path / "photo.jpg", quality=90)
    outline = outline_from_photo(tmp_path / "photo.jpg")
    assert iou(fill_polygon(outline, 1500, 2000), mask) > 0.98


def test_a_photo_taken_sideways_is_turned_as_its_camera_says(tmp_path):
    mask = shape_mask(300, 400)
    sideways = Image.fromarray(picture(mask)).rotate(90, expand=True)
    exif = Image.Exif()
    exif[0x0112] = 6
    sideways.save(tmp_path / "photo.png", exif=exif)
    assert iou(fill_polygon(outline_from_photo(tmp_path / "photo.png"), 300, 400), mask) > 0.98


@pytest.mark.parametrize(
    "rgb",
    [
        picture(np.zeros((300, 400), bool), noise=5.0),
        picture(shape_mask(300, 400), cloth=(226, 230, 228), noise=8.0),
        np.random.default_rng(0).integers(0, 255, (300, 400, 3)).astype(np.uint8),
    ],
    ids=["nothing", "cloth like the table", "noise"],
)
def test_photos_without_a_clear_garment_are_refused(tmp_path, rgb):
    Image.fromarray(rgb).save(tmp_path / "photo.png")
    with pytest.raises(GarmentError, match=r"photo\.png.*plain background"):
        outline_from_photo(tmp_path / "photo.png")


def test_several_things_in_a_photo_are_refused(tmp_path):
    rgb = picture(np.zeros((300, 400), bool))
    rgb[50:150, 50:150] = rgb[160:260, 200:300] = (40, 60, 90)
    Image.fromarray(rgb).save(tmp_path / "photo.png")
    with pytest.raises(GarmentError, match="several"):
        outline_from_photo(tmp_path / "photo.png")


class TestMask:
    def test_reads_grey_and_transparent_pictures(self, tmp_path):
        mask = shape_mask()
        Image.fromarray(mask.astype(np.uint8) * 255).save(tmp_path / "grey.png")
        rgba = np.dstack([np.full((*mask.shape, 3), 90, np.uint8), mask.astype(np.uint8) * 255])
        Image.fromarray(rgba).save(tmp_path / "alpha.png")
        for name in ("grey.png", "alpha.png"):
            np.testing.assert_array_equal(load_mask(tmp_path / name), mask)

    @pytest.mark.parametrize(
        ("pixels", "words"),
        [
            (np.zeros((50, 50), np.uint8), "empty"),
            (np.full((50, 50), 255, np.uint8), "full"),
            (np.pad(np.zeros((30, 30), np.uint8), 10, constant_values=255), "inverted"),
        ],
    )
    def test_unusable_masks_say_what_to_do(self, tmp_path, pixels, words):
        Image.fromarray(pixels).save(tmp_path / "mask.png")
        with pytest.raises(GarmentError, match=words):
            load_mask(tmp_path / "mask.png")

    def test_something_else_is_no_picture(self, tmp_path):
        (tmp_path / "mask.png").write_text("hello")
        with pytest.raises(GarmentError, match="PNG or JPEG"):
            load_mask(tmp_path / "mask.png")
        with pytest.raises(GarmentError, match="there is no file"):
            load_mask(tmp_path / "absent.png")

    @pytest.mark.parametrize("turn", range(1, 9))
    def test_a_turned_mask_is_read_as_it_is_shown(self, tmp_path, turn):
        from PIL import ImageOps

        exif = Image.Exif()
        exif[0x0112] = turn
        mask = Image.fromarray(shape_mask(120, 160).astype(np.uint8) * 255)
        mask.save(tmp_path / "mask.png", exif=exif)
        shown = np.asarray(ImageOps.exif_transpose(Image.open(tmp_path / "mask.png"))) > 127
        np.testing.assert_array_equal(load_mask(tmp_path / "mask.png"), shown)

    @pytest.mark.parametrize(
        ("name", "pixels"),
        [
            ("labels.png", shape_mask().astype(np.uint8)),
            ("16 bit.png", shape_mask().astype(np.uint16) * 65_535),
            ("float.tiff", shape_mask().astype(np.float32)),
            ("int.tiff", shape_mask().astype(np.int32) * 255),
        ],
    )
    def test_depths_and_labels_are_read(self, tmp_path, name, pixels):
        Image.fromarray(pixels).save(tmp_path / name)
        np.testing.assert_array_equal(load_mask(tmp_path / name), shape_mask())

    def test_a_cut_off_picture_is_said_to_be_damaged(self, tmp_path):
        Image.fromarray(shape_mask().astype(np.uint8) * 255).save(tmp_path / "mask.png")
        whole = (tmp_path / "mask.png").read_bytes()
        (tmp_path / "mask.png").write_bytes(whole[: len(whole) // 2])
        with pytest.raises(GarmentError, match=r"damaged.*save it again"):
            load_mask(tmp_path / "mask.png")

    def test_a_black_shirt_on_white_is_a_photo(self, tmp_path):
        from polyfold.api._loaders import is_mask

        Image.fromarray(np.where(shape_mask(), 0, 255).astype(np.uint8)).save(tmp_path / "shirt.png")
        Image.fromarray(np.where(shape_mask(), 255, 0).astype(np.uint8)).save(tmp_path / "mask.png")
        assert not is_mask(tmp_path / "shirt.png")
        assert is_mask(tmp_path / "mask.png")
        assert iou(fill_polygon(outline_from_photo(tmp_path / "shirt.png"), 400, 400), shape_mask()) > 0.98


class TestOutlineFile:
    square = ((0, 0), (10, 0), (10, 10), (0, 10))

    @pytest.mark.parametrize(
        "content",
        [
            square,
            {"outline": square},
            {"garment": "towel", "mask": [((0, 0), (1, 0), (0, 1)), square]},
            {"mask": [square, []]},
            {"shapes": [{"label": "cup", "points": [[1, 1]], "shape_type": "point"}, {"points": square}]},
            {"annotations": [{"image_id": 3, "segmentation": [[0, 0, 1, 0, 0, 1], [0, 0, 10, 0, 10, 10, 0, 10]]}]},
        ],
        ids=["list", "object", "aRTF", "beside an empty one", "labelme", "COCO"],
    )
    def test_reads_every_form(self, tmp_path, content):
        (tmp_path / "outline.json").write_text(json.dumps(content))
        np.testing.assert_array_equal(load_outline(tmp_path / "outline.json"), self.square)

    @pytest.mark.parametrize(
        "text", ["[[1, 2], [3, 4]]", "{}", "[]", '[["a", 1]]', "[[1, 2], [3]]", "[[1, 2], [3, NaN], [4, 5]]", "7", "{"]
    )
    def test_anything_else_is_refused_with_what_to_do(self, tmp_path, text):
        (tmp_path / "outline.json").write_text(text)
        with pytest.raises(GarmentError, match=r"\[\[x, y\], \.\.\.\]"):
            load_outline(tmp_path / "outline.json")

    @pytest.mark.parametrize(
        ("content", "says"),
        [
            ({"annotations": [{"image_id": 1}, {"image_id": 2}]}, "annotates 2 pictures"),
            ({"annotations": [{"segmentation": {"counts": "x", "size": [2, 2]}}]}, "export polygons"),
        ],
    )
    def test_annotations_that_hold_no_one_outline_say_why(self, tmp_path, content, says):
        (tmp_path / "outline.json").write_text(json.dumps(content))
        with pytest.raises(GarmentError, match=says):
            load_outline(tmp_path / "outline.json")

    def test_a_byte_order_mark_is_no_part_of_it(self, tmp_path):
        (tmp_path / "outline.json").write_text(json.dumps(self.square), "utf-8-sig")
        np.testing.assert_array_equal(load_outline(tmp_path / "outline.json"), self.square)

    def test_a_missing_file_is_named(self, tmp_path):
        with pytest.raises(GarmentError, match=r"absent\.json"):
            load_outline(tmp_path / "absent.json")


def test_a_photo_of_many_megapixels_is_decoded_once_and_warns_of_nothing(tmp_path, monkeypatch, recwarn):
    """Beyond 89 megapixels Pillow warns of an attack; that bound is lowered here, so that the test is quick."""
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 100_000)
    picture = np.full((400, 400, 3), 240, np.uint8)
    picture[shape_mask()] = (40, 60, 120)
    Image.fromarray(picture).save(tmp_path / "photo.png")
    opened, was = [], Image.open
    monkeypatch.setattr(Image, "open", lambda path: opened.append(path) or was(path))
    from polyfold.api._loaders import is_mask
    from polyfold.api._photos import look

    assert not is_mask(tmp_path / "photo.png")
    seen = look(tmp_path / "photo.png", None, None)
    assert (len(opened), len(recwarn)) == (1, 0)
    assert (seen.rgb == picture).all()
    assert iou(fill_polygon(seen.outline, 400, 400), shape_mask()) > 0.98
