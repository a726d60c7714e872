import json
import re

import pytest

FOLD = ("fold", "fold the square in half", "--garment", "square", "--edge-length", "0.03")


def listing(result):
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def test_third_party_plugin_is_listed_with_its_provenance(polyfold):
    found = listing(polyfold("plugins", "--json", plugins=["example"]))
    (middle,) = [component for component in found["components"] if component["name"] == "middle"]
    assert (middle["kind"], middle["distribution"], middle["version"]) == ("policies", "polyfold-example", "0.1.0")


def test_third_party_policy_folds_with_its_parameter(polyfold):
    result = polyfold(*FOLD, "--policy", "middle", "--set", "policy.arms=1", "--json", plugins=["example"])
    assert result.returncode == 0, result.stderr
    assert all(len(step["picks"]) == 1 for step in json.loads(result.stdout)["steps"])


@pytest.mark.parametrize("name", ["misspelt", "undecorated", "crashing", "lacking"])
def test_broken_plugin_never_takes_the_host_down(polyfold, name):
    result = polyfold("plugins", "--json", plugins=[name, "example"])
    found = listing(result)
    (broken,) = [plugin for plugin in found["plugins"] if plugin["name"] == name]
    assert len(broken["problems"]) == 1
    assert (broken["distribution"], broken["version"]) == (f"polyfold-{name}", "1.2.3")
    assert any(component["name"] == "middle" for component in found["components"])
    assert result.stderr.count("warning") == 1


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("misspelt", "did you mean 'register_policies'"),
        ("undecorated", "lacks @hookimpl"),
        ("crashing", "boom at import"),
        ("lacking", "pip install --force-reinstall polyfold-lacking"),
    ],
)
def test_using_what_a_broken_plugin_might_have_registered_says_so(polyfold, name, says):
    result = polyfold(*FOLD, "--policy", "bare", plugins=[name])
    assert result.returncode == 1
    error = result.stderr.splitlines()[-1]
    assert says in error
    assert f"polyfold-{name} 1.2.3" in error


def test_traceback_of_a_crash_is_kept(polyfold):
    found = listing(polyfold("plugins", "--json", plugins=["crashing"]))
    (broken,) = [plugin for plugin in found["plugins"] if plugin["name"] == "crashing"]
    assert "ZeroDivisionError" in broken["problems"][0]["traceback"]


def test_duplicate_name_is_refused_when_used_and_names_both(polyfold):
    result = polyfold(*FOLD, "--policy", "middle", plugins=["example", "duplicate"])
    assert result.returncode == 1
    assert re.search(r"registered by .*polyfold-duplicate.* and .*polyfold-example", result.stderr.splitlines()[-1])
    assert "POLYFOLD_DISABLE" in result.stderr


def test_duplicate_leaves_other_components_usable(polyfold):
    result = polyfold(*FOLD, "--json", plugins=["example", "duplicate"])
    assert result.returncode == 0, result.stderr


def test_disabling_one_of_two_duplicates_resolves_them(polyfold):
    arguments = (*FOLD, "--policy", "middle", "--json")
    result = polyfold(*arguments, plugins=["example", "duplicate"], POLYFOLD_DISABLE="duplicate")
    assert result.returncode == 0, result.stderr


def test_missing_requirement_is_answered_with_the_pip_command(polyfold):
    result = polyfold(*FOLD, "--policy", "needy", plugins=["needy"])
    assert result.returncode == 1
    assert "pip install 'a-distribution-nobody-has>=2'" in result.stderr


def test_no_plugins_keeps_to_the_bundled_ones(polyfold):
    found = listing(polyfold("--no-plugins", "plugins", "--json", plugins=["example", "crashing"]))
    assert {plugin["distribution"] for plugin in found["plugins"]} == {"polyfold"}


def test_unknown_component_suggests_the_nearest(polyfold):
    result = polyfold(*FOLD, "--policy", "farthets")
    assert result.returncode == 1
    assert "did you mean 'farthest'" in result.stderr


def test_unknown_parameter_suggests_the_nearest(polyfold):
    result = polyfold(*FOLD, "--set", "fabric.thicknes=0.01")
    assert result.returncode == 1
    assert "did you mean 'thickness'" in result.stderr


def test_observer_error_is_recorded_and_the_run_goes_on(polyfold):
    result = polyfold(*FOLD, plugins=["watching"])
    assert result.returncode == 0, result.stderr
    assert "WATCHED fold the square in half" in result.stdout
    assert "observer trouble" in result.stderr


def test_plugin_adds_a_verb(polyfold):
    assert "say hello" in polyfold("--help", plugins=["verbose"]).stdout
    assert polyfold("greet", "--name", "cloth", plugins=["verbose"]).stdout == "hello cloth\n"


def test_the_example_does_what_policies_promise(polyfold):
    checked = polyfold("check", "polyfold-example", plugins=["example"])
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert "policy middle" in checked.stdout
    assert checked.stdout.rstrip().endswith("9 checks, 0 faults")


@pytest.mark.parametrize("name", ["crashing", "misspelt"])
def test_what_keeps_a_plugin_from_being_checked_is_said_once(polyfold, name):
    checked = polyfold("check", name, plugins=[name, "watching"])
    assert checked.returncode == 1
    (told,) = checked.stderr.splitlines()
    assert told.startswith(f"polyfold: the plugin '{name}' (polyfold-{name} 1.2.3) has a problem: ")


def test_what_is_wrong_with_another_plugin_is_warned_of_nevertheless(polyfold):
    checked = polyfold("check", "polyfold-example", plugins=["example", "misspelt"])
    assert checked.returncode == 0, checked.stderr
    assert checked.stderr.count("warning: plugin 'misspelt'") == 1
