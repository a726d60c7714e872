"""A study in words: what it will run, before it runs."""

from __future__ import annotations

from collections import Counter

from polyfold.studies._cells import cells
from polyfold.studies._study import Study
from polyfold.types._views import makes

NAMED = 6
"""So many variants are named."""


@makes(Study, "text")
def in_words(study: Study) -> str:
    """How many episodes of what, in five lines."""
    each = [cell for cell in cells(study) if cell.variant == next(iter(study.variants))]
    kinds = Counter(cell.garment for cell in each)
    tasks = len({cell.task for cell in each})
    variants = list(study.variants)
    between = "; " if any("," in variant for variant in variants) else ", "
    named = between.join(variants[:NAMED]) + (f" and {len(variants) - NAMED} more" if len(variants) > NAMED else "")
    return "\n".join([
        f"study {study.name}: {_count(len(each) * len(variants), 'episode')}",
        f"{_count(len(variants), 'variant')}: {named}",
        f"{_count(tasks, 'task')} of {study.suite}, {_count(study.garments, 'garment')} of each kind, "
        f"wordings: {study.instructions}",
        f"{len(each)} a variant: {', '.join(f'{count} {kind}' for kind, count in kinds.items())}",
        f"compared with the {study.reference}; success by {', '.join(study.criteria)}",
    ])  # fmt: skip


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
