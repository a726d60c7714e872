"""``polyfold plugins show``: what a component is and what can be set of it."""

import re

import pytest

from polyfold import plugins
from polyfold.cli import main
from polyfold.plugins.hookspecs import KINDS


def test_a_component_shows_its_parameters_with_defaults(capsys):
    assert main(["plugins", "show", "caso"]) == 0
    shown = capsys.readouterr().out
    assert shown.startswith(
        "policy caso: a random contour point, the second pick by conditional affordance optimisation"
    )
    assert re.search(r"^  --set policy.gamma=0.04  weight of the picks' distance to the fold line", shown, re.MULTILINE)


def test_what_has_none_says_so(capsys):
    assert main(["plugins", "show", "strict"]) == 0
    assert "no parameters" in capsys.readouterr().out


@pytest.mark.parametrize("kind", KINDS)
def test_every_component_can_be_shown(kind, capsys):
    for name in plugins.names(kind):
        if not plugins.catalog().components[kind][name][0].missing_packages():
            assert main(["plugins", "show", name]) == 0
            assert f" {name}: " in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["show"], "plugins show needs a component's name, such as csam+caso"),
        (["show", "affordance-pear"], "no component is called 'affordance-pear'; did you mean 'affordance-pair'?"),
    ],
)
def test_what_is_not_there_is_said(arguments, says, capsys):
    assert main(["plugins", *arguments]) == 1
    assert says in capsys.readouterr().err
