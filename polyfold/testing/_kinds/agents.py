"""What agents are held to."""

from __future__ import annotations

from polyfold import plugins
from polyfold.config import Experiment
from polyfold.evaluation._suites import suite as suite_of
from polyfold.plugins._traits import UsesComponents
from polyfold.rollout import run_episode
from polyfold.rollout._inputs import GUIDED, PRIVILEGED
from polyfold.testing._checks import checks
from polyfold.testing._subjects import Subject

SUITE, COARSE = "polyfold70", 0.03
OFFERED = frozenset({"instruction", "fold_count"}) | GUIDED | PRIVILEGED


@checks("agents", "it requires what a loop can give")
def _requires(subject: Subject) -> None:
    requires = subject.cls().requires
    subject.require(
        isinstance(requires, frozenset), "requires", f"it is a {type(requires).__name__}", "write frozenset({…})"
    )
    unknown = sorted(requires - OFFERED)
    subject.require(
        not unknown, "requires", f"no loop can give {unknown}", f"choose among {', '.join(sorted(OFFERED))}"
    )
    if isinstance(subject.cls(), UsesComponents):
        known = sorted(set(subject.cls().uses) - set(Experiment.model_fields))
        subject.require(not known, "uses", f"no experiment has {known}", "name kinds in the singular: 'policy'")


@checks("agents", "it folds a square to the end, or says why not")
def _folds(subject: Subject) -> None:
    experiment = Experiment.of(agent={"name": subject.name, "params": dict(subject.params)})
    task = next(task for task in suite_of(SUITE).tasks if task.garment == "square")
    garment = plugins.generate_garment("square", 0, COARSE)
    episode = run_episode(experiment, garment, task.instructions[0], 0, task=task)
    subject.require(
        episode.steps or episode.failure is not None or subject.name == "noop", "decide",
        "it folds nothing and says nothing", "return a Decision until it is done, or raise PlanError with the reason",
    )  # fmt: skip
