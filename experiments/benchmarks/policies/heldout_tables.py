"""What held-out states say of learned maps and of policies: rank correlation, error, regret, with intervals.

Everything is compared within a state: a data set has many first picks from each, and every policy folds each once.

* **Rank correlation** (Spearman) of what was predicted of a state's picks and how they came out, by particles and by
  silhouette; a state counts if three picks came out differently. Learned maps stand beside two predictions that learn
  nothing: ``distance``, of the first pick from the line, and ``affordance``, of the pair that was tried.
* **Error**: how far the flap is from its ideal place and the rest from where it lay, the sum of both means [mm].
* **Regret**: the error of the chosen pick less that of the best first pick that the data set tried in that state. This
  zero does not move with the policies that are compared, but it is no optimum: a finite number of picks was tried, the
  more the better, with partners by affordance. So a policy's regret can be negative.
* **Paired differences** to the first policy, and to the prediction by affordance, on the same states.

States of one garment share its shape and partly their folds, so they are not independent. All intervals are 95 %
bootstrap intervals that draw whole garments; states are not clustered in any other way, since all that a job shares, it
shares within one garment. They hold for the weights at hand: what another seed of the training would give, they don't
tell. Medians, quartiles and the 90th percentile are of states.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray
from polyfold_fgpnp.data.dataset import Dataset
from polyfold_fgpnp.policies.actions import PickConfig
from polyfold_fgpnp.policies.affordance import affordance
from polyfold_fgpnp.policies.coupled import Coupled
from polyfold_fgpnp.policies.region import FoldRegion, fold_region
from polyfold_fgpnp.training.ranks import rank_correlation

from polyfold.analysis import Estimate, Table, mean, shown
from polyfold.errors import PlanError
from polyfold.geometry import FoldLine
from polyfold.types import Scene

Floats = NDArray[np.float64]

Predictor = Callable[[FoldLine, Scene, FoldRegion, Floats, Floats], Floats]
"""Values, shape (K,), that should order pairs of picks [px], each of shape (K, 2); higher is better."""

RANDOM, BEST = "random first pick", "best of the picks tried"
REFERENCE = "affordance"
RECIPE = "uniform"
"""First picks anywhere on the lifted contour, their partners by affordance."""


def over_garments(data: Dataset, values: Floats) -> Estimate:
    """Mean of values by state, shape (S,), NaN where there is none, with an interval for other garments."""
    return mean(values.tolist(), data["garment_seed"].tolist())


def tried(data: Dataset) -> Iterator[NDArray[np.int64]]:
    """For each state the indices of its trials with random first picks that have an outcome, shape (K,)."""
    trials = data.of_recipes(RECIPE)
    for state in range(data.states):
        yield trials[data["trial_state"][trials] == state]


def correlation_table(data: Dataset, maps: Mapping[str, Coupled]) -> Table:
    """How well predictions order the picks of a state; see the module's docstring.

    Args:
        data: held-out states.
        maps: name -> a policy with a learned map, which is read at its point nearest to each first pick.
    """
    predictors = {"distance": _distance, REFERENCE: _affordance} | {name: _read(one) for name, one in maps.items()}
    found = {name: _correlations(data, predictor) for name, predictor in predictors.items()}
    counts = [len(trials) for trials in tried(data)]
    rows = []
    for name, columns in found.items():
        cells = [name, str(int(np.isfinite(columns["particles"]).sum())), f"{min(counts)}-{max(counts)}"]
        for reward, values in columns.items():
            low, median, high = np.nanpercentile(values, (25, 50, 75)) if np.isfinite(values).any() else [np.nan] * 3
            less = over_garments(data, values - found[REFERENCE][reward])
            cells += [f"{median:.3f}", f"{low:.2f} to {high:.2f}", shown(over_garments(data, values), 3)]
            cells += ["–" if name == REFERENCE else shown(less, 3, signed=True)]
        rows.append(cells)
    per_reward = ("median", "quartiles", "mean", f"less {REFERENCE}")
    headers = [f"{reward}: {column}" for reward in ("particles", "contour") for column in per_reward]
    note = f"Rank correlation of predictions and outcomes over a state's picks; {_garments(data)}."
    return Table(["predicted by", "states", "picks", *headers], rows, note)


def _correlations(data: Dataset, predictor: Predictor) -> dict[str, Floats]:
    """Rank correlation in every state, shape (S,), by reward; NaN where it is not defined."""
    rewards = {name: data.reward(name) for name in ("particles", "contour")}
    found = {name: np.full(data.states, np.nan) for name in rewards}
    for state, trials in enumerate(tried(data)):
        line, scene = data.line(state), data.scene(state)
        first, second = (data[name][trials].astype(float) for name in ("first", "second"))
        try:
            predicted = predictor(line, scene, fold_region(line, scene), first, second)
        except PlanError:
            continue  # as stored, rounded, the line cuts off nothing worth grasping
        for name, reward in rewards.items():
            found[name][state] = rank_correlation(predicted, reward[trials])
    return found


def _distance(line: FoldLine, scene: Scene, region: FoldRegion, first: Floats, second: Floats) -> Floats:
    return line.distance(first)


def _affordance(line: FoldLine, scene: Scene, region: FoldRegion, first: Floats, second: Floats) -> Floats:
    return affordance(region, first, second, PickConfig().gamma)


def _read(policy: Coupled) -> Predictor:
    def predictor(line: FoldLine, scene: Scene, region: FoldRegion, first: Floats, second: Floats) -> Floats:
        points, values = policy.action_map(line, scene)
        return values[np.argmin(((points - first[:, None]) ** 2).sum(-1), axis=1)]

    return predictor


def regret_table(data: Dataset, errors: Mapping[str, Floats]) -> Table:
    """Errors of policies, what they lack to the best pick tried, and what they differ from the first of them.

    Args:
        data: held-out states.
        errors: policy -> error of the flap [mm] in every state, shape (S,), NaN where the cloth diverged, which is
            left out and shows in n.
    """
    outcomes = [data.error_mm[trials] for trials in tried(data)]
    random, best = (np.array([of(found) if len(found) else np.nan for found in outcomes]) for of in (np.mean, np.min))
    first = next(iter(errors))
    rows = []
    for name, values in {RANDOM: random, **errors, BEST: best}.items():
        sound = values[np.isfinite(values)]
        rows.append(
            [
                name,
                str(len(sound)),
                shown(over_garments(data, values)),
                f"{np.median(sound):.1f}",
                f"{np.percentile(sound, 90):.1f}",
                *(shown(over_garments(data, np.where(part, values, np.nan))) for part in _parts(data)),
                "–" if name == BEST else shown(over_garments(data, values - best)),
                "–" if name == BEST else f"{np.nanmedian(values - best):.1f}",
                "–" if name == first else shown(over_garments(data, values - errors[first]), signed=True),
            ]
        )
    headers = ["pick", "states", "error [mm]", "median", "p90", "on flat cloth", "on folded cloth", "regret [mm]"]
    note = f"Error of flap and rest; regret: less the best of the random first picks tried; {_garments(data)}."
    return Table([*headers, "median regret", f"less {first} [mm]"], rows, note)


def _parts(data: Dataset) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    flat = data["folds_before"] == 0
    return flat, ~flat


def _garments(data: Dataset) -> str:
    return f"mean [95 % bootstrap interval over {len(np.unique(data['garment_seed']))} garments]"
