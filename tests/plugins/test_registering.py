"""What can't be a component is refused where it is registered, with what to give; and nothing is hidden in silence."""

import re
import warnings

import pytest

import polyfold
from polyfold import plugins
from polyfold.errors import PluginError
from polyfold.plugins._host import Host


class Mine:
    def act(self, fold_line, scene, rng):
        """Never called."""


def choose(fold_line, scene, rng):
    """A function and no component."""


@pytest.mark.parametrize(
    ("target", "says"),
    [
        (Mine(), "with act(fold_line, scene, rng), not an instance of Mine; give Mine itself, of which one is made"),
        (None, "the policy 'mine' is to be a class with act(fold_line, scene, rng), not None; write such a class"),
        (choose, "not the function 'choose'; write such a class"),
        ("my_module", "the target 'my_module' of 'mine' must read 'package.module:Class'"),
        ("my_module:", "must read 'package.module:Class'"),
    ],
)
def test_what_is_no_class_is_refused_with_what_to_give(target, says):
    host = Host()
    with pytest.raises(PluginError, match=re.escape(says)):
        host.register("policies", "mine", target)
    assert host.by_hand() == []


@pytest.mark.parametrize("name", ["", "Mine", "my policy", "caso:fast", "-mine", "m" * 51, None, 3])
def test_names_are_what_users_can_type(name):
    with pytest.raises(PluginError, match=r"the component name .* is not allowed; use lower-case letters"):
        Host().register("policies", name, Mine)


def test_a_suite_of_tasks_is_a_file():
    with pytest.raises(PluginError, match="the suite of tasks 'mine' is a file; give its path, not the class Mine"):
        Host().register("tasks", "mine", Mine)


def test_what_a_plugin_s_component_gives_way_to_is_warned_of_once():
    host = Host()
    says = r"the policy 'caso' of the plugin 'fgpnp' .* gives way to .*unregister\('policies', 'caso'\); choose another"
    with pytest.warns(UserWarning, match=says) as caught:
        host.register("policies", "caso", Mine)
    assert caught[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        host.register("policies", "caso", Mine)  # the cell is run again
        host.register("policies", "mine", Mine)
        Host().receive("policies", "caso", "my_module:Mine")


def test_an_unknown_usual_fabric_is_told_with_the_garment_that_names_it():
    class Napkin:
        kind, default_fabric = "napkin", "popline"

    plugins.register("garments", "napkin", Napkin)
    try:
        with pytest.raises(PluginError) as caught:
            polyfold.garment("napkin")
    finally:
        plugins.unregister("garments", "napkin")
    assert str(caught.value) == (
        "the garment 'napkin' that was registered by hand is usually made of 'popline' (default_fabric), and no fabric "
        "is called so; did you mean 'poplin'?"
    )
