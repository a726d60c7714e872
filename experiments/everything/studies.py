"""The studies whose tables are recorded, and which tables those are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import polyfold
from experiments.everything.pictures import causes, curves, failures
from polyfold.analysis import Results
from polyfold.studies import Study
from polyfold.studies._study import with_variants

EXPERIMENTS = Path(__file__).parents[1]

Section = tuple[str, str]
"""A heading, empty for none, and what stands below it as markdown."""


@dataclass(frozen=True)
class StudyStep:
    """A study, and the tables made of it.

    Attributes:
        name: of its file in ``experiments``, without the ending; its table is ``results/NAME.md``.
        hours: of two cores.
        sections: what its file of results holds.
        also: further files of results made of the same episodes.
        pictured: whether ``results/NAME-failures.png`` shows what was folded wrongly.
        drawn: names of further pictures, and what draws them.
        variants: only these; all if empty.
        garments: instead of the study's own number.
    """

    name: str
    hours: float
    sections: Callable[[Results], Sequence[Section]]
    also: tuple[tuple[str, Callable[[Results], Sequence[Section]]], ...] = ()
    pictured: bool = False
    drawn: tuple[tuple[str, Callable[[Results], bytes]], ...] = ()
    variants: tuple[str, ...] = ()
    garments: int | None = None

    def study(self) -> Study:
        """What is run."""
        found = polyfold.load(EXPERIMENTS / f"{self.name}.toml")
        found = with_variants(found, self.variants) if self.variants else found
        return found if self.garments is None else found.model_copy(update={"garments": self.garments})

    def run(self, folder: Path, workers: int, accept_change: bool) -> dict[str, bytes]:
        """Run what is missing; returns the content of each file of results by name."""
        results = polyfold.run(self.study(), folder / self.name, workers, accept_change=accept_change)
        files = {f"{self.name}.md": self.sections, **dict(self.also)}
        found = {name: _text(sections(results)).encode() for name, sections in files.items()}
        if self.pictured:
            found[f"{self.name}-failures.png"] = failures(results, folder / self.name)
        return found | {name: draw(results) for name, draw in self.drawn}


def _text(sections: Sequence[Section]) -> str:
    return "\n\n".join(f"{heading}\n\n{text}" if heading else text for heading, text in sections) + "\n"


def _table(results: Results) -> Sequence[Section]:
    return [("", polyfold.table(results).markdown())]


HARDEST = (3, 4)
"""The two wordings of each task, polite and geometric, that the grammar before the reader was never widened on."""


def _by_wording(results: Results) -> Sequence[Section]:
    """The hardest wordings come first."""
    return [
        ("Wordings 3 (polite) and 4 (geometric):", polyfold.table(results.of_wordings(HARDEST)).markdown()),
        ("All wordings:", polyfold.table(results).markdown()),
        ("By wording:", polyfold.table(results, groups="wording").markdown()),
    ]


def _pairs(*pairs: tuple[str, str]) -> Callable[[Results], Sequence[Section]]:
    """Paired differences: variant and baseline."""
    return lambda results: [("", polyfold.compare(results, *pair).markdown()) for pair in pairs]


def _main(results: Results) -> Sequence[Section]:
    return [
        *_by_wording(results),
        ("By type of task:", polyfold.table(results, groups="type").markdown()),
        *_pairs(("polyfold", "true-lines"), ("true-lines", "oracle"))(results),
    ]


def _several_folds(results: Results) -> Sequence[Section]:
    """Tasks of several folds, told only the final goal, which is all that ``polyfold`` is ever told."""
    multi = results.of_length("multi")
    return [
        ("Wordings 3 (polite) and 4 (geometric):", _split(multi.of_wordings(HARDEST))),
        ("All wordings:", _split(multi)),
    ]


def _split(results: Results) -> str:
    return polyfold.table(results, groups="split").markdown()


def _recovery(results: Results) -> Sequence[Section]:
    faults = ("clean", "misses", "slips")
    return [*_table(results), *_pairs(*((fault, f"{fault}, no recovery") for fault in faults))(results)]


def _displaced(results: Results) -> Sequence[Section]:
    return [*_table(results), *_pairs(("displaced", "displaced, no recovery"), ("displaced", "clean"))(results)]


def _planners(results: Results) -> Sequence[Section]:
    others = ("direct-2arm", "direct-1arm")
    return [*_by_wording(results), *_pairs(*(("hierarchical", other) for other in others))(results)]


def _groundings(results: Results) -> Sequence[Section]:
    return [*_by_wording(results), *_pairs(("polygon", "keypoints"))(results)]


def _wardrobe(results: Results) -> Sequence[Section]:
    return [*_table(results), ("By task:", polyfold.table(results, groups="task").markdown())]


def _robustness(results: Results) -> Sequence[Section]:
    """Each disturbance beside the same policy undisturbed."""
    pairs = [(name, name.partition(", ")[0]) for name in results.study.variants if ", " in name]
    return [*_table(results), *_pairs(*pairs)(results)]


def _robot_cell(results: Results) -> Sequence[Section]:
    return [*_table(results), *_pairs(("cell", "cell, no recovery"), ("cell", "cloth alone"))(results)]


def _disturbances(results: Results) -> Sequence[Section]:
    """Each disturbance beside the cell undisturbed, seen by the same segmenter."""
    pairs = [(name, "cell, photo" if name.endswith(", photo") else "cell") for name in results.study.variants]
    return [*_table(results), *_pairs(*(pair for pair in pairs if pair[0] != pair[1]))(results)]


DEFAULT = "affordance-pair"
"""The policy that the others are compared with."""


def _policies(results: Results) -> Sequence[Section]:
    return [*_table(results), ("What picks decide:", _within_reach(results, DEFAULT)), *_beside_the_default(results)]


def _policies_oracle(results: Results) -> Sequence[Section]:
    return [*_table(results), *_beside_the_default(results)]


def _beside_the_default(results: Results) -> Sequence[Section]:
    return _pairs(*((DEFAULT, name) for name in results.study.variants if name != DEFAULT))(results)


def _within_reach(results: Results, default: str) -> str:
    """How much better than a variant the best pick of all variants could be: as good as any, chosen after the fact."""
    heads = ("kind", "n", "strict %", "strict % of the best variant, each time", "missed by every variant")
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    for kind in [*results.kinds(), None]:
        good: dict[str, list[bool]] = {}
        for name in results.study.variants:
            for record in results.of(name, kind):
                good.setdefault(record.key.partition("/")[2], []).append(record.success["strict"])
        own = [record.success["strict"] for record in results.of(default, kind)]
        best = [any(found) for found in good.values()]
        lines.append(
            f"| {kind or 'all'} | {len(own)} | {100 * sum(own) / len(own):.1f} | {100 * sum(best) / len(best):.1f} "
            f"| {len(best) - sum(best)} of the {len(own) - sum(own)} that {default} misses |"
        )
    return "\n".join(lines)


STUDIES = (
    StudyStep("main", 1.2, _main, also=(("final_goal.md", _several_folds),), pictured=True),
    StudyStep("noise_floor", 0.1, lambda results: [("", polyfold.table(results, noise=results).markdown())]),
    StudyStep("recovery", 0.4, _recovery),
    StudyStep("policies", 2.6, _policies, garments=9),
    StudyStep("policies_oracle", 0.4, _policies_oracle),
    StudyStep("displaced", 0.2, _displaced),
    StudyStep("robustness", 1.0, _robustness),
    StudyStep("robot_cell", 0.5, _robot_cell),
    StudyStep(
        "disturbances", 1.0, _disturbances, drawn=(("disturbances.png", curves), ("disturbances-causes.png", causes))
    ),
    StudyStep("ambiguous", 0.2, _table),
    StudyStep("planners", 0.5, _planners),
    StudyStep("groundings", 0.4, _groundings),
    StudyStep("floor", 0.3, _table),
    StudyStep("wardrobe", 0.2, _wardrobe),
)
"""In the order in which they are run."""
