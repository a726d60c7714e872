"""Fabrics as a user meets them: listed, within what was published, overridden, put into garments of every source."""

import numpy as np
import pytest

import polyfold
from polyfold import plugins
from polyfold.config import ComponentSpec
from polyfold.errors import ConfigError, GarmentError, PluginError
from polyfold.garments._fabric import UNCHOSEN
from polyfold.plugins._fabrics import garment_template

BUNDLED = {"jersey", "poplin", "denim", "terry", "felt"}
PUBLISHED = {
    "denim": {"thickness": (0.0008, 0.00119), "weight": (0.32, 0.38), "bending_length": (0.016, 0.022)},
    "jersey": {"bending_length": (0.008, 0.013), "table_friction": (0.27, 0.3), "cloth_friction": (0.6, 0.6)},
    "poplin": {"bending_length": (0.011, 0.019)},
    "terry": {"weight": (0.3, 0.5), "bending_length": (0.011, 0.029)},
    "felt": {"weight": (0.3, 0.5), "bending_length": (0.011, 0.029)},
}


def made(name, **constants):
    return plugins.create("fabrics", name, constants).fabric()


def test_the_bundled_fabrics_are_listed_with_a_summary():
    assert set(plugins.names("fabrics")) >= BUNDLED
    assert all(plugins.find("fabrics", name).summary for name in BUNDLED)


@pytest.mark.parametrize("name", sorted(BUNDLED))
def test_constants_lie_within_what_was_published(name):
    fabric = made(name)
    assert fabric.name == name
    for constant, (low, high) in PUBLISHED[name].items():
        assert low <= getattr(fabric, constant) <= high, constant
    assert fabric.bending_length_weft <= fabric.bending_length_warp


@pytest.mark.parametrize("name", sorted(BUNDLED))
def test_every_constant_has_a_source_and_a_unit(name):
    cls = plugins.component_class("fabrics", name)
    source = __import__(cls.__module__, fromlist=["x"]).__doc__
    assert source.count("\n* ") == len(cls.Config.model_fields) == 8
    for field in cls.Config.model_fields.values():
        assert field.description.endswith("]")


def test_a_constant_is_overridden_like_any_parameter():
    thick = made("denim", thickness=0.0012)
    assert thick.thickness == 0.0012
    assert thick.weight == made("denim").weight
    with pytest.raises(ConfigError, match="did you mean 'thickness'"):
        made("denim", thicknes=0.0012)
    for impossible in (-0.001, 0.0, 0.5, float("nan"), float("inf")):
        with pytest.raises(ConfigError, match="thickness"):
            made("denim", thickness=impossible)


def test_implausible_fabrics_are_refused_with_what_to_give():
    constants = made("denim").constants()
    with pytest.raises(GarmentError, match=r"weight=nan.*give it in SI units"):
        polyfold.Fabric("odd", **{**constants, "weight": float("nan")})
    with pytest.raises(GarmentError, match=r"thickness=0.95.*from 0.0001 to 0.01"):
        polyfold.Fabric("odd", **{**constants, "thickness": 0.95})


@pytest.mark.parametrize(
    ("kind", "fabric"), [("tshirt", "jersey"), ("pants", "denim"), ("square", "poplin"), ("rectangle", "poplin")]
)
def test_each_kind_is_made_of_what_it_usually_is(kind, fabric):
    assert polyfold.garment(kind, seed=2000, edge_length=0.04).fabric == made(fabric)


def test_the_fabric_is_chosen_by_name_by_table_or_by_constant_alone():
    def fabric(choice):
        return polyfold.garment("tshirt", seed=2000, edge_length=0.04, fabric=choice).fabric

    assert fabric("denim") == made("denim")
    assert fabric({"name": "denim", "thickness": 0.0011}) == made("denim", thickness=0.0011)
    assert fabric({"thickness": 0.0011}) == made("jersey", thickness=0.0011)
    with pytest.raises(PluginError, match="no fabric is called 'demin'; did you mean 'denim'"):
        fabric("demin")


def test_the_mesh_is_the_same_in_every_fabric():
    jersey, felt = (polyfold.garment("tshirt", seed=2000, edge_length=0.04, fabric=name) for name in ("jersey", "felt"))
    np.testing.assert_array_equal(jersey.mesh.vertices, felt.mesh.vertices)
    assert jersey.colours == felt.colours


def test_twins_and_meshes_from_files_have_a_fabric_too(tmp_path):
    outline = [(0, 0), (300, 0), (300, 200), (0, 200)]
    twin = polyfold.garment("rectangle", outline=outline, fabric="terry")
    assert twin.fabric == made("terry")
    lines = [f"v {x:.6f} {y:.6f} 0" for x, y in twin.mesh.vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in twin.mesh.triangles + 1]
    (tmp_path / "towel.obj").write_text("\n".join(lines) + "\n")
    (tmp_path / "points.json").write_text(str(dict(twin.keypoints)).replace("'", '"'))
    loaded = polyfold.garment("rectangle", mesh=tmp_path / "towel.obj", keypoints=tmp_path / "points.json")
    assert loaded.fabric == made("poplin")


def test_a_kind_that_names_no_fabric_is_made_of_poplin():
    class Napkin:
        """As a third party's kind, which may know nothing of fabrics."""

        kind = "napkin"

        def template(self):
            return plugins.create("garments", "square").template()

        def generate(self, seed, edge_length=0.01):
            return plugins.create("garments", "square").generate(seed, edge_length)

    polyfold.register("garments", "napkin", Napkin)
    try:
        napkin = plugins.generate_garment("napkin", 2000, 0.04)
        assert napkin.fabric == made("poplin")
        assert plugins.generate_garment("napkin", 2000, 0.04, ComponentSpec(name="felt")).fabric == made("felt")
    finally:
        plugins.unregister("garments", "napkin")


@pytest.mark.parametrize(("kind", "panels"), [("tshirt", 2), ("pants", 2), ("square", 1), ("rectangle", 1)])
def test_templates_know_how_thick_all_panels_of_the_fabric_are_together(kind, panels):
    usual, felt = polyfold.garment(kind, seed=2000, edge_length=0.04).fabric, made("felt")
    assert garment_template(kind).thickness == pytest.approx(panels * usual.thickness)
    assert garment_template(kind, felt).thickness == pytest.approx(panels * felt.thickness)
    assert plugins.create("garments", kind).template().thickness is None, "the kind's own is as it was"


def test_what_generators_make_is_poplin_until_a_fabric_is_put_in():
    assert made("poplin") == UNCHOSEN
    assert plugins.create("garments", "tshirt").generate(2000, 0.04).fabric == UNCHOSEN


def test_a_third_party_fabric_is_used_by_its_name_and_usual_is_taken():
    class Silk:
        """Without parameters."""

        def fabric(self):
            return polyfold.Fabric("silk", 0.0002, 0.06, 0.02, 0.015, 0.3, 0.2, 100.0, 0.3)

    polyfold.register("fabrics", "silk", Silk)
    try:
        assert polyfold.garment("square", seed=2000, edge_length=0.04, fabric="silk").fabric.weight == 0.06
    finally:
        plugins.unregister("fabrics", "silk")
    with pytest.raises(PluginError, match="choose another"):
        polyfold.register("fabrics", "usual", Silk)
