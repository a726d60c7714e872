"""The outlines that come with the package."""

import pytest

import polyfold
from polyfold.garments import samples


def test_each_is_a_garment_and_the_licence_stands_beside_it():
    assert sorted(samples()) == ["shorts", "towel", "tshirt"]
    assert "CC-BY 4.0" in (samples()["tshirt"].parent / "README.md").read_text("utf-8")


@pytest.mark.parametrize(("name", "kind"), [("shorts", "pants"), ("towel", "rectangle"), ("tshirt", "tshirt")])
def test_each_is_grounded_as_its_kind(name, kind):
    assert polyfold.ground(kind, outline=samples()[name]).scene.residual < 12
