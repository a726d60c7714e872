"""How well policies pick on garments that nothing was trained on.

    python -m experiments.benchmarks.policies.heldout DATA POLICY...

``DATA`` is a data set of ``polyfold collect --seeds 1150-1199 --mix uniform=16``. Each policy folds every state; a
policy is written NAME or NAME=WEIGHTS. Prints two Markdown tables, which
:mod:`experiments.benchmarks.policies.heldout_tables` explains: how well learned maps order the picks tried in a state,
beside what learns nothing; and the error and regret of the pick that each policy chose, beside those of a random first
pick. Where a policy refuses a state, that counts as leaving the cloth as it is.

What was executed is kept in ``DATA/policies``, or beside a packed data set, so that another policy can be added later;
other weights are another file. After a change to the code of a policy or of the simulator, remove the files of what it
concerns.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from polyfold_fgpnp.data.dataset import Dataset, load_dataset
from polyfold_fgpnp.data.interaction import Interaction
from polyfold_fgpnp.data.situations import execute, situations, states_per_job
from polyfold_fgpnp.policies.coupled import Coupled
from polyfold_fgpnp.policies.learned import LearnedPolicy
from polyfold_fgpnp.policies.weights import file_hash, weights_file

from experiments.benchmarks.policies.heldout_tables import RECIPE, correlation_table, regret_table
from polyfold import plugins
from polyfold.errors import ConfigError, PlanError, PolyfoldError
from polyfold.logs import JsonLines
from polyfold.plugins.interfaces import Policy
from polyfold.studies import in_processes

SAME_STATE = 0.01
"""States whose flap's way differs by more than this share are not the same."""


@dataclass(frozen=True)
class Contestant:
    """A policy with its weights, if they are not those of the package."""

    text: str

    def create(self) -> Policy:
        """The policy. Raises PluginError or ConfigError."""
        name, _, weights = self.text.partition("=")
        return plugins.create("policies", name, {"weights": weights} if weights else {})

    @property
    def file(self) -> str:
        """Name of the file that keeps its results: other weights, be they the package's, another file."""
        name, _, weights = self.text.partition("=")
        cls = plugins.component_class("policies", name)
        if not weights and not issubclass(cls, LearnedPolicy):
            return name
        file = weights_file(weights or str(cls.Config.model_fields["weights"].default))
        return f"{name}-{file_hash(file)[:12]}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Run what is missing and print the tables."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.policies.heldout", description=__doc__)
    parser.add_argument("data", type=Path, help="held-out data set")
    parser.add_argument(
        "policies", nargs="+", metavar="POLICY[=WEIGHTS]", help="such as affordance-pair, csam+caso=out/weights…"
    )
    parser.add_argument("--workers", type=int, default=1, help="processes (default 1)")
    options = parser.parse_args(arguments)
    try:
        _compare(load_dataset(options.data), options)
    except PolyfoldError as error:
        sys.exit(f"{parser.prog}: {error}")


def _compare(data: Dataset, options: argparse.Namespace) -> None:
    if not len(data.of_recipes(RECIPE)):
        raise ConfigError(f"{options.data} has no random first picks; collect some with --mix {RECIPE}=16")
    if Interaction(**data.description["parameters"]).course != "good-folds":
        raise ConfigError(
            f"{options.data} was collected on a random course, where every policy would come to other states"
        )
    contestants = [Contestant(text) for text in options.policies]
    errors = {one.text: _executed(options.data, data, one, options.workers) for one in contestants}
    policies = {one.text: one.create() for one in contestants}
    maps = {name: policy for name, policy in policies.items() if isinstance(policy, Coupled)}
    print(correlation_table(data, maps).markdown())
    print()
    print(regret_table(data, errors).markdown())


def _executed(path: Path, data: Dataset, contestant: Contestant, workers: int) -> NDArray[np.float64]:
    """Error [mm] after the policy's action in every state, shape (S,); what is missing is executed."""
    from tqdm import tqdm

    contestant.create()
    kept = JsonLines(_results(path) / f"{contestant.file}.jsonl")
    found: dict[int, list[float | None]] = {record["job"]: record["error_mm"] for record in kept.read()}
    interaction = Interaction(**data.description["parameters"])
    each = states_per_job(interaction)
    missing = [job for job in range(data.states // each) if job not in found]
    work = partial(_fold_job, interaction, contestant)
    for job, (errors, ways) in tqdm(in_processes(work, missing, workers), total=len(missing), desc=contestant.text):
        _refuse_other_states(data["travel_mm"][each * job : each * (job + 1)], ways)
        kept.append({"job": job, "error_mm": errors})
        found[job] = errors
    # None, where the cloth diverged, becomes NaN.
    return np.array([error for job in sorted(found) for error in found[job]], float)


def _results(data: Path) -> Path:
    """Where what was executed is kept: in a data set's folder, or beside its file."""
    return data.with_name(f"{data.stem}-policies") if data.is_file() else data / "policies"


def _refuse_other_states(there: NDArray[np.float32], ways: Sequence[float]) -> None:
    if not np.allclose(there, ways, rtol=SAME_STATE, equal_nan=True):
        raise ConfigError(
            "the states of this data set can't be made again: the simulator, its rounding on this machine or how lines "
            "are drawn has changed since, so picks would be compared in different states; collect the data set anew"
        )


def _fold_job(interaction: Interaction, contestant: Contestant, job: int) -> tuple[list[float | None], list[float]]:
    """The policy's error in each state of a job, and the flap's way there, which tells states apart [mm].

    Where the policy refuses, the error is that of doing nothing; None where the cloth diverged.
    """
    policy, errors, ways = contestant.create(), [], []
    for simulator, segmenter, situation in situations(interaction, job):
        ways.append(situation.expectation.travel_mm)
        try:
            action = policy.act(situation.line.line, situation.scene, situation.rng)
        except PlanError:
            errors.append(situation.expectation.travel_mm)
            continue
        outcome, _ = execute(simulator, segmenter, situation, action)
        errors.append(None if outcome is None else outcome.error_mm)
    return errors, ways


if __name__ == "__main__":
    main()
