"""How to write a component of each kind: what `polyfold new-plugin` writes, what it must do and what it is held to."""

from __future__ import annotations

import tempfile
from pathlib import Path

from docs.making.components import bundled
from polyfold import plugins
from polyfold.cli.new_plugin import ABOUT, write_plugin
from polyfold.plugins.hookspecs import KINDS as PLURAL
from polyfold.plugins.hookspecs import singular
from polyfold.testing._checks import checks_of

KINDS = tuple(map(singular, PLURAL))

PROMISES = {
    "simulator": ("interfaces.Simulator", "interfaces.RecordsMotion", "interfaces.HasReferenceConfig"),
    "camera": ("hardware.DepthCamera",),
    "robot": ("hardware.Robot",),
    "segmenter": ("interfaces.Segmenter", "interfaces.HasReferenceConfig"),
    "grounding": ("interfaces.Grounding",),
    "planner": ("interfaces.Planner", "interfaces.StepwisePlanner", "interfaces.Conversation"),
    "policy": ("interfaces.Policy", "interfaces.ValuesPicks"),
    "llm": ("interfaces.LLM",),
    "agent": ("interfaces.Agent", "interfaces.Goal", "interfaces.UsesComponents"),
    "garment": ("interfaces.GarmentKind", "interfaces.SewnKind"),
    "fabric": ("interfaces.FabricKind",),
    "task": (),
    "metric": ("interfaces.Metric", "interfaces.LabelledMetric", "interfaces.RoundedMetric"),
    "criterion": ("interfaces.SuccessCriterion",),
}
"""The protocol of each kind, then what it may do besides."""

MEETS = {
    "simulator": ("Observation", "Action", "SimState"),
    "camera": ("Observation",),
    "robot": ("Action",),
    "segmenter": ("Observation",),
    "grounding": ("Observation", "Scene"),
    "planner": ("Subgoal", "Scene", "Message", "Reply"),
    "policy": ("Scene", "Action"),
    "llm": ("Message", "Reply"),
    "agent": ("Observation", "Decision", "Subgoal"),
    "metric": ("Outcome", "Threshold"),
    "criterion": ("Threshold",),
}
"""The values that a component of a kind is handed or hands on, in ``polyfold.types``."""


def table() -> str:
    """The kinds, in the order of the data flow, as part of a page of ``docs``."""
    rows = [
        f"| [{kind}](made/howto/{kind}.md) | {_promise(kind)} | {len(bundled(plural))} |"
        for kind, plural in zip(KINDS, PLURAL, strict=True)
    ]
    return "\n".join(["| kind | what it does | come with PolyFold |", "|---|---|---|", *rows, ""])


def page(kind: str) -> str:
    """How to write one component of a kind (singular)."""
    plural = dict(zip(KINDS, PLURAL, strict=True))[kind]
    about, usage = ABOUT[plural]
    name = "polyfold-mine"
    files = _written(name, kind)
    told = [
        f"# {_article(kind)} {kind}", "", f"{_promise(kind)}.", "",
        "## Begin", "", f"    polyfold new-plugin {name} --kind {kind}", "",
        f"writes a package whose tests pass: {about}. Change it into yours, piece by piece.", "",
    ]  # fmt: skip
    for place, content in files.items():
        fence = {"py": "python", "toml": "toml"}[place.rsplit(".", 1)[-1]]
        told += [f"`{place}`", "", f"```{fence}", content.rstrip(), "```", ""]
    told += ["Try it:", "", f"    {usage.format(name='mine')}", ""]
    if PROMISES[kind]:
        told += ["## What it must do", ""]
        told += [f"- {{py:class}}`polyfold.plugins.{place}`" for place in PROMISES[kind]]
        told += [
            "",
            "```{eval-rst}",
            f".. autoclass:: polyfold.plugins.{PROMISES[kind][0]}",
            "   :no-index:",
            "```",
            "",
        ]
    else:
        told += [
            "{py:class}`polyfold.tasks.Suite` tells what a suite holds, {py:class}`polyfold.tasks.Task` a task.",
            "",
        ]
    if kind in MEETS:
        linked = ", ".join(f"{{py:class}}`polyfold.types.{value}`" for value in MEETS[kind])
        told += [f"The values that it meets: {linked}; [with an example each](../../values.md).", ""]
    told += ["## What it is held to", "", "`polyfold check NAME` looks at each of these and says what is wrong:", ""]
    told += [f"- {one.says}" for one in checks_of(plural)]
    told += ["", "## What comes with PolyFold", ""]
    told += [f"- `{one}`: {_summary(plural, one)}" for one in bundled(plural)]
    return "\n".join([*told, ""])


def _written(name: str, kind: str) -> dict[str, str]:
    """The parts of the package that a person reads: the component, its registration, its test."""
    with tempfile.TemporaryDirectory() as folder:
        made = write_plugin(name, kind, Path(folder))
        written = [file for file in sorted(made.rglob("*")) if file.is_file()]
        files = {file.relative_to(made).as_posix(): file.read_text("utf-8") for file in written}
    wanted = ("hooks.py", "tests/test_conformance.py", f"{kind}.py", "tasks.toml")
    return {place: text for place, text in files.items() if place.endswith(wanted)}


def _promise(kind: str) -> str:
    """A kind in one line, from its hook."""
    from polyfold.plugins import hookspecs

    plural = dict(zip(KINDS, PLURAL, strict=True))[kind]
    first = (getattr(hookspecs, f"register_{plural}").__doc__ or "").split("\n")[0]
    said = (first.rpartition("`, ")[2] if "`, " in first else first.partition(": ")[2]).rstrip(".")
    return said[0].upper() + said[1:]


def _summary(kind: str, name: str) -> str:
    return plugins.catalog().components[kind][name][0].summary


def _article(word: str) -> str:
    return "An" if word[0] in "aeiou" else "A"
