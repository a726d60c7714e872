"""What the package's weights were trained from: ``python -m experiments.benchmarks.policies.trained``.

Prints a Markdown table, one row for each file of weights: what its values mean, how it sees the flap, its label, the
folds that taught it, the passes over them, the first digits of its data sets' hashes, its parameters and its size.
"""

from __future__ import annotations

import sys
from pathlib import Path

from polyfold_fgpnp.policies.weights import load_weights, shipped_weights

HEADERS = ("weights", "values", "frame", "label", "folds", "passes", "data", "parameters", "MB")

_DIGITS = 8


def row(name: str, file: Path) -> tuple[str, ...]:
    """What one file of weights says of itself."""
    network, found = load_weights(file)
    config, shape = found.config, network.config
    return (
        f"`{name}`",
        shape.variant,
        shape.frame,
        f"{config['reward']}, {config['scale']}",
        f"{found.folds:,}" if found.folds else "–",
        str(config["epochs"]),
        ", ".join(data[:_DIGITS] for data in found.data),
        f"{sum(parameter.numel() for parameter in network.parameters()):,}",
        f"{file.stat().st_size / 1e6:.1f}",
    )


def table(weights: dict[str, Path]) -> str:
    """All rows, as Markdown."""
    rows = [HEADERS, ("---",) * len(HEADERS), *(row(name, file) for name, file in weights.items())]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in rows)


if __name__ == "__main__":
    print(table(shipped_weights()))
    sys.exit(0)
