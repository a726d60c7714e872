"""Hosts: each has its own registrations and observers, and nothing that a plugin or an observer does takes one down."""

import pickle
import re
import subprocess
import sys
from dataclasses import dataclass, field

import pytest

from polyfold import plugins
from polyfold.errors import PluginError
from polyfold.plugins._host import Host
from polyfold.studies import in_processes


class Component:
    """A component without parameters."""


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Install a plugin of one module, given by its source; its entry point may name an object in it."""

    def install(name, source, attribute=""):
        (tmp_path / f"{name}.py").write_text(source)
        info = tmp_path / f"{name}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[polyfold]\n{name} = {name}{attribute}\n")
        monkeypatch.syspath_prepend(tmp_path)

    return install


def problems(host, name):
    return [problem.summary for plugin in host.catalog().plugins if plugin.name == name for problem in plugin.problems]


def test_hosts_share_no_registrations():
    one, other = Host(), Host()
    one.register("policies", "mine", Component)
    assert one.component_class("policies", "mine") is Component
    for host in (other, plugins):
        with pytest.raises(PluginError, match="no policy is called 'mine'"):
            host.find("policies", "mine")
    one.unregister("policies", "mine")
    assert "mine" not in one.names("policies")


def test_hosts_share_no_observers():
    class Counter:
        seen = 0

        def on_step(self, step):
            self.seen += 1

    one, other, counter = Host(), Host(), Counter()
    one.observe(counter)
    other.notify("on_step", step=None, role="method")
    assert counter.seen == 0
    one.notify("on_step", step=None, role="method")
    one.unobserve(counter)
    one.notify("on_step", step=None, role="method")
    assert counter.seen == 1


@pytest.mark.filterwarnings("ignore:the policy 'caso' of the plugin")
def test_what_is_registered_by_hand_gives_way_to_what_it_hid():
    host = Host()
    caso = host.component_class("policies", "caso")
    host.register("policies", "caso", Component)
    assert host.component_class("policies", "caso") is Component
    host.unregister("policies", "caso")
    assert host.component_class("policies", "caso") is caso


def test_functions_of_the_package_reach_the_host_of_the_process_that_calls_them():
    sent = pickle.dumps(plugins.register)
    assert len(sent) < 500, "only a name travels"
    code = (
        "import pickle, sys; from polyfold import plugins\n"
        "pickle.load(sys.stdin.buffer)('policies', 'sent', 'nowhere:Nothing')\n"
        "assert 'sent' in plugins.names('policies')"
    )
    subprocess.run([sys.executable, "-c", code], input=sent, check=True, timeout=60)


def test_observers_are_given_what_they_ask_for():
    seen = []

    class Observer:
        def on_step(self, step):
            seen.append(("step", step))

        def on_episode_start(self, start, role="method"):
            seen.append((role, start))

        def on_episode_end(self):
            seen.append("end")

    host = Host()
    host.observe(Observer())
    host.notify("on_episode_start", start=1, role="reference")
    host.notify("on_step", step=2, role="reference")
    host.notify("on_episode_end", episode=3, role="reference")
    assert seen == [("reference", 1), ("step", 2), "end"]


def test_an_observer_that_fails_disturbs_nobody_and_is_warned_of_once(recwarn):
    seen = []

    class Failing:
        def on_step(self, step):
            raise RuntimeError("trouble")

    class Working:
        def on_step(self, step):
            seen.append(step)

    host = Host()
    for observer in (Failing(), Working(), Failing()):
        host.observe(observer)
    recwarn.clear()
    for step in range(3):
        host.notify("on_step", step=step, role="method")
    assert seen == [0, 1, 2]
    warned = [str(warning.message) for warning in recwarn if "trouble" in str(warning.message)]
    assert len(warned) == 2, "once for each of the two"
    assert all("Failing" in message for message in warned)


@dataclass
class Equal:
    """Equal to others of its kind, and without a hash."""

    seen: list = field(default_factory=list, compare=False)

    def on_step(self, step):
        self.seen.append(step)


def test_observers_are_told_apart_by_identity():
    host, one, other = Host(), Equal(), Equal()
    host.observe(one)
    host.observe(other)
    host.notify("on_step", step=0, role="method")
    host.unobserve(one)
    host.notify("on_step", step=1, role="method")
    assert (one.seen, other.seen) == ([0], [0, 1])


@pytest.mark.parametrize(
    ("methods", "says"),
    [
        ({"on_stepp": lambda self, step: None}, "did you mean 'on_step'"),
        ({"on_step": lambda self, fold: None}, "fold"),
        ({}, "none of the methods"),
    ],
)
def test_an_observer_that_would_never_be_called_is_refused(methods, says):
    observer = type("Observer", (), methods)()
    with pytest.raises(PluginError, match=says):
        Host().observe(observer)


def test_stopping_who_does_not_observe_says_so():
    with pytest.raises(PluginError, match="does not observe"):
        Host().unobserve(object())


@pytest.mark.filterwarnings("ignore:plugin 'odd_")
@pytest.mark.parametrize(
    ("source", "attribute", "says"),
    [
        ("nothing = None\n", ":nothing", "is None"),
        ("class Rude:\n    def __dir__(self):\n        raise OSError('go away')\nrude = Rude()\n", ":rude", "go away"),
        (
            "from polyfold import hookimpl\n@hookimpl\ndef on_step(fold):\n    pass\n",
            "",
            "wrong arguments.*fold",
        ),
        (
            "from polyfold import hookimpl\n@hookimpl(wrapper=True)\ndef on_step(step):\n    yield\n",
            "",
            "wrapper",
        ),
        (
            "from polyfold import hookimpl\n@hookimpl\ndef register_llms(register):\n    register('Bad Name', 'a:B')\n",
            "",
            "is not allowed",
        ),
        ("import sys\nsys.exit('not on this machine')\n", "", "could not be imported.*not on this machine"),
        (
            "class Vain:\n    def __getattr__(self, name):\n        raise SystemExit(name)\nvain = Vain()\n",
            ":vain",
            "SystemExit",
        ),
        (
            "from polyfold import hookimpl\n@hookimpl\ndef register_llms(register):\n    raise SystemExit('enough')\n",
            "",
            "register_llms failed.*enough",
        ),
    ],
    ids=["none", "rude", "arguments", "wrapper", "name", "exit", "vain", "exit_later"],
)
def test_what_is_wrong_with_a_plugin_is_recorded_against_it_alone(installed, request, source, attribute, says):
    name = f"odd_{request.node.callspec.id}"
    installed(name, source, attribute)
    host = Host()
    (summary,) = problems(host, name)
    assert re.search(says, summary, re.DOTALL)
    assert "\n" not in summary
    assert "caso" in host.names("policies")
    host.notify("on_step", step=None, role="method")


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("trousers", "did you mean 'pants'"),
        ("Shirt", "did you mean 'tshirt'"),
        ("towels", "did you mean 'towel'"),
        ("scarves", "there are longsleeve (long-sleeved shirt"),
        ("scarf", "did you mean 'rectangle'"),
        ("tshrt", "did you mean 'tshirt'"),
        ("poncho", "pants (trousers, jeans, slacks), rectangle (towel, scarf, cloth), shorts ("),
    ],
)
def test_a_garment_by_another_name_is_told_its_kind_and_an_unknown_one_all_kinds(name, says):
    with pytest.raises(PluginError, match=re.escape(says)):
        Host().find("garments", name)


def test_a_property_that_raises_disturbs_nobody(installed):
    installed(
        "shy",
        "class Shy:\n    @property\n    def hook(self):\n        raise RuntimeError('no one home')\nshy = Shy()\n",
        ":shy",
    )
    host = Host()
    assert problems(host, "shy") == []
    assert "caso" in host.names("policies")


def test_what_a_plugin_prints_is_no_part_of_an_answer(installed, capsys):
    installed(
        "chatty",
        "from polyfold import hookimpl\nprint('hello')\n\n"
        "@hookimpl\ndef register_llms(register):\n    print('there')\n",
    )
    Host().catalog()
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err == "hello\nthere\n"


def test_a_name_that_one_plugin_registers_twice_is_told_as_its_own_fault(installed):
    installed(
        "stutters",
        "from polyfold import hookimpl\n\n@hookimpl\ndef register_policies(register):\n"
        "    register('again', 'a:B')\n    register('again', 'a:C')\n",
    )
    host = Host()
    with pytest.warns(UserWarning, match="'stutters'"):
        assert problems(host, "stutters") == [
            "it registers the policies name 'again' twice; give one of the two another name, or take it out of the hook"
        ]
    with pytest.raises(PluginError, match=r"the plugin 'stutters' \(.*\) registers the policy 'again' twice; give one"):
        host.find("policies", "again")


def test_a_requirement_that_is_installed_in_another_version_is_missing():
    host = Host()
    host.register("policies", "modern", Component, needs=("numpy>=99",))
    host.register("policies", "usual", Component, needs=("numpy>=1.20", "Pillow"))
    with pytest.raises(PluginError, match=r"needs numpy>=99; install with: pip install 'numpy>=99'"):
        host.find("policies", "modern")
    assert host.find("policies", "usual").name == "usual"


def test_an_extra_is_missing_until_all_that_it_asks_for_is_installed(tmp_path, monkeypatch):
    there = tmp_path / "sorter-1.0.dist-info"
    there.mkdir()
    (there / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: sorter\nVersion: 1.0\nProvides-Extra: fast\nProvides-Extra: all\n"
        "Requires-Dist: numpy\nRequires-Dist: numpy>=99; extra == 'fast'\nRequires-Dist: sorter[fast]; extra == 'all'\n"
        "Requires-Dist: nobody-has-this; python_version < '3' and extra == 'fast'\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    host = Host()
    for name, extra in (("plain", ""), ("fast", "[fast]"), ("whole", "[all]")):
        host.register("policies", name, Component, needs=(f"sorter{extra}",))
    assert host.find("policies", "plain").name == "plain"
    for name, extra in (("fast", "fast"), ("whole", "all")):
        with pytest.raises(
            PluginError, match=rf"needs sorter\[{extra}\]; install with: pip install 'sorter\[{extra}\]'"
        ):
            host.find("policies", name)
    (there / "METADATA").write_text((there / "METADATA").read_text().replace("numpy>=99", "numpy>=1"))
    assert host.find("policies", "whole").name == "whole"


@pytest.mark.filterwarnings("ignore:plugin 'unhashable'")
def test_a_plugin_may_be_any_object(installed):
    installed(
        "unhashable",
        "from dataclasses import dataclass\nfrom polyfold import hookimpl\n\n@dataclass\nclass Plugin:\n"
        "    @hookimpl\n    def register_policies(self, register):\n        register('from-object', 'a:B')\n\n"
        "plugin = Plugin()\n",
        ":plugin",
    )
    host = Host()
    assert problems(host, "unhashable") == []
    assert {"from-object", "caso"} <= set(host.names("policies"))
    assert "square" in host.names("garments")


def test_a_problem_is_warned_of_once_however_much_is_registered_by_hand(installed, recwarn):
    installed("undone", "def register_policies(register):\n    pass\n")
    host = Host()
    for name in ("one", "two"):
        host.register("policies", name, Component)
    assert len([warning for warning in recwarn if "lacks @hookimpl" in str(warning.message)]) == 1


def test_a_hook_of_a_later_version_may_be_marked_optional(installed):
    installed(
        "early",
        "from polyfold import hookimpl\n\n@hookimpl(optionalhook=True)\ndef on_wrinkle(wrinkle):\n    pass\n",
    )
    assert problems(Host(), "early") == []


@pytest.fixture
def forgotten():
    """Asked for before what installs a plugin: once that is gone again, the process's own host looks anew."""
    yield
    plugins.refresh(third_party=True)


def test_workers_know_the_plugins_that_their_parent_knows(forgotten, installed):
    installed(
        "elsewhere",
        "from polyfold import hookimpl\n\n@hookimpl\ndef register_policies(register):\n"
        "    register('elsewhere', 'a:B')\n",
    )
    for third_party in (True, False):
        plugins.refresh(third_party)
        found = [names for _, names in in_processes(plugins.names, ["policies"] * 2, workers=2)]
        assert found[0] == found[1]
        assert ("elsewhere" in found[1]) == third_party


def test_a_plugin_that_keeps_every_command_waiting_is_named(installed, monkeypatch):
    monkeypatch.setattr("polyfold.plugins._registry.discovery._SLOW", 0.2)
    installed("sluggard", "import time\ntime.sleep(0.3)\n")
    with pytest.warns(
        UserWarning, match=r"'sluggard' \(sluggard 1\.0\) took \d+\.\d s to import, .* POLYFOLD_DISABLE=sluggard"
    ):
        Host().names("policies")


def test_the_version_is_told_without_loading_plugins(installed, tmp_path, monkeypatch):
    installed("noisy", "import sys\nprint('loaded', file=sys.stderr)\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    told = {
        option: subprocess.run([sys.executable, "-m", "polyfold", option], capture_output=True, text=True).stderr
        for option in ("--help", "--version")
    }
    assert told == {"--help": "loaded\n", "--version": ""}


def test_a_verb_says_what_it_lacks_when_it_is_run_and_helps_before(monkeypatch, capsys, tmp_path):
    from polyfold.cli import main
    from polyfold.plugins._registry import catalog

    installed = catalog._installed
    monkeypatch.setattr(catalog, "_installed", lambda package: package != "polyfold[torch]" and installed(package))
    with pytest.raises(SystemExit) as ended:
        main(["train", "--help"])
    assert ended.value.code == 0
    capsys.readouterr()
    assert main(["train", "x.toml", "--out", str(tmp_path / "out")]) == 1
    assert capsys.readouterr().err == (
        "polyfold: polyfold train needs polyfold[torch]; install with: pip install 'polyfold[torch]'\n"
    )
    assert main(["fold", "fold it", "--garment", "square", "--policy", "csam+caso"]) == 1
    assert "the policy 'csam+caso' needs polyfold[torch]" in capsys.readouterr().err
