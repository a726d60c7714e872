"""How well policies pick on garments that nothing was trained on: ``python -m polyfold_fgpnp.heldout DATA POLICY...``.

``DATA`` is a data set of ``polyfold collect --seeds 1100-1149 --mix uniform=16``. Each policy folds every state; a
policy is written NAME or NAME=WEIGHTS. Prints two Markdown tables: the rank correlation of learned maps with what came
out, over the picks of a state; and the error of the pick that each policy chose, beside that of a random first pick
(the mean over the picks tried) and of the best fold known of the state, whoever made it. What was executed is kept in
``DATA/policies``, so that another policy can be added later.
"""

from __future__ import annotations

import argparse
import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.errors import PlanError
from polyfold.interfaces import Policy
from polyfold.statistics import Estimate, estimate

from .dataset import Dataset, load_dataset
from .interaction import LINES_PER_STAGE, Interaction, execute, situations
from .learned import CoupledActionMap
from .ranks import rank_correlation
from .weights import weights_file
from .workers import in_processes

__all__ = ["main"]

RANDOM, BEST = "random first pick", "best known"


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
        """Name of the file that keeps its results: other weights, another file."""
        name, _, weights = self.text.partition("=")
        return f"{name}-{hashlib.sha256(weights_file(weights).read_bytes()).hexdigest()[:12]}" if weights else name


def main(arguments: Sequence[str] | None = None) -> None:
    """Run what is missing and print the tables."""
    parser = argparse.ArgumentParser(prog="python -m polyfold_fgpnp.heldout", description=__doc__)
    parser.add_argument("data", type=Path, help="held-out data set")
    parser.add_argument("policies", nargs="+", metavar="POLICY[=WEIGHTS]", help="such as caso, csam+caso=out/weights…")
    parser.add_argument("--workers", type=int, default=1, help="processes (default 1)")
    options = parser.parse_args(arguments)
    data = load_dataset(options.data)
    contestants = [Contestant(text) for text in options.policies]
    errors = {one.text: _executed(options.data, data, one, options.workers) for one in contestants}
    print("\n".join(_correlation_table(data, contestants)))
    print()
    print("\n".join(_error_table(data, errors)))


def _executed(path: Path, data: Dataset, contestant: Contestant, workers: int) -> NDArray[np.float64]:
    """Error of the flap [mm] after the policy's action in every state, shape (S,); what is missing is executed."""
    from tqdm import tqdm

    contestant.create()
    kept = path / "policies" / f"{contestant.file}.jsonl"
    kept.parent.mkdir(exist_ok=True)
    found = dict(_kept(kept))
    interaction = Interaction(**data.description["parameters"])
    each = sum(LINES_PER_STAGE)
    missing = [job for job in range(data.states // each) if job not in found]
    work = partial(_fold_job, interaction, contestant)
    with kept.open("a", encoding="utf-8") as stream:
        for job, errors in tqdm(in_processes(work, missing, workers), total=len(missing), desc=contestant.text):
            stream.write(json.dumps({"job": job, "flap_mm": errors}) + "\n")
            stream.flush()
            found[job] = errors
    return np.concatenate([found[job] for job in sorted(found)]).astype(float)


def _kept(path: Path) -> Iterator[tuple[int, list[float | None]]]:
    if not path.exists():
        return
    for line in path.read_text("utf-8").splitlines():
        try:
            record = json.loads(line)
        except json.JSONDecodeError:
            continue  # cut off when a run was killed
        yield record["job"], record["flap_mm"]


def _fold_job(interaction: Interaction, contestant: Contestant, job: int) -> list[float | None]:
    """The policy's error [mm] in each state of a job; doing nothing's where it refuses, None where it diverged."""
    policy, errors = contestant.create(), []
    for simulator, segmenter, situation in situations(interaction, job):
        try:
            action = policy.act(situation.line.line, situation.scene, situation.rng)
        except PlanError:
            errors.append(situation.expectation.travel_mm)
            continue
        outcome, _ = execute(simulator, segmenter, situation, action)
        errors.append(None if outcome is None else outcome.flap_mm)
    return errors


def _correlation_table(data: Dataset, contestants: Sequence[Contestant]) -> list[str]:
    rows = ["| learned map | states | picks | particles: rank correlation, median | quartiles | contour | quartiles |"]
    rows.append("|---|---|---|---|---|---|---|")
    for one in contestants:
        policy = one.create()
        if isinstance(policy, CoupledActionMap):
            rows.append(_correlation_row(one.text, data, policy))
    return rows if len(rows) > 2 else []


def _correlation_row(name: str, data: Dataset, policy: CoupledActionMap) -> str:
    cells, picks, used = [], [], 0
    for reward in ("particles", "contour"):
        found = []
        for state, trials in _trials_by_state(data):
            points, values = policy.action_map(data.line(state), data.scene(state))
            at = [int(np.argmin(((points - first) ** 2).sum(1))) for first in data["first"][trials]]
            found.append(rank_correlation(values[at], data.reward(reward)[trials]))
            picks.append(len(trials))
        low, median, high = np.nanpercentile(found, (25, 50, 75))
        used = int(np.isfinite(found).sum())
        cells += [f"{median:.3f}", f"{low:.2f} to {high:.2f}"]
    return f"| {name} | {used} | {min(picks)}-{max(picks)} | " + " | ".join(cells) + " |"


def _trials_by_state(data: Dataset) -> Iterator[tuple[int, NDArray[np.int64]]]:
    trials = data.of_recipes("uniform")
    for state in range(data.states):
        yield state, trials[data["trial_state"][trials] == state]


def _error_table(data: Dataset, errors: Mapping[str, NDArray[np.float64]]) -> list[str]:
    """Errors, regret against the best known fold of each state, and the paired difference to the first policy."""
    tried = [data["flap_mm"][trials].astype(float) for _, trials in _trials_by_state(data)]
    least = np.array([found.min() for found in tried])
    best = np.nanmin(np.stack([least, *errors.values()]), axis=0)
    columns = {RANDOM: np.array([found.mean() for found in tried]), **errors, BEST: best}
    first = next(iter(errors))
    rows = [
        f"| pick | n | error [mm] | median | p90 | on flat cloth | on folded cloth | regret [mm] | less {first} [mm] |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    flat = data["folds_before"] == 0
    for name, values in columns.items():
        sound = values[np.isfinite(values)]
        cells = [
            name,
            str(len(sound)),
            _interval(estimate(values)),
            f"{np.median(sound):.1f}",
            f"{np.percentile(sound, 90):.1f}",
            f"{np.nanmean(values[flat]):.1f}",
            f"{np.nanmean(values[~flat]):.1f}",
            _interval(estimate(values - best)),
            _interval(estimate(values - errors[first])),
        ]
        rows.append("| " + " | ".join(cells) + " |")
    return rows


def _interval(found: Estimate) -> str:
    return f"{found.mean:.1f} [{found.low:.1f}, {found.high:.1f}]"


if __name__ == "__main__":
    main()
