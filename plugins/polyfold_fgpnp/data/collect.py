"""``polyfold collect``: fold in simulation, at random or as a network would, and record how it came out."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from polyfold.errors import ConfigError, validation_problem

if TYPE_CHECKING:
    from polyfold_fgpnp.data.dataset import Description
    from polyfold_fgpnp.data.interaction import Interaction


class Collect:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the options."""
        parser.add_argument("--out", type=Path, metavar="DIR", help="data set; resumed if it exists")
        parser.add_argument(
            "--describe", type=Path, metavar="DIR", help="show what a data set holds instead of collecting"
        )
        parser.add_argument("--pack", type=Path, metavar="FILE", help="when complete, write it into one small file too")
        parser.add_argument(
            "--folds", type="count", default=10_000, metavar="N", help="at least this many (default: 10000)"
        )
        parser.add_argument("--kind", default="tshirt", help="of the garments (default: tshirt)")
        parser.add_argument("--simulator", default="xpbd", metavar="NAME", help="default: xpbd")
        parser.add_argument(
            "--fabric", default="usual", metavar="NAME", help="default: usual, what the kind usually is"
        )
        parser.add_argument("--segmenter", default="colour", metavar="NAME", help="default: colour")
        parser.add_argument("--seeds", default="1000-1099", metavar="A-B", help="garment seeds (default: 1000-1099)")
        parser.add_argument(
            "--workers", type="count", default=1, metavar="N", help="processes on this machine (default: 1)"
        )
        parser.add_argument(
            "--edge-length", type="metres", default=0.018, metavar="M", help="of the mesh (default: 0.018)"
        )
        parser.add_argument(
            "--course",
            choices=("good-folds", "random"),
            default="good-folds",
            help="many picks from states after good folds, or one from whatever came of the last, as in the paper",
        )
        parser.add_argument("--mix", metavar="RECIPE=COUNT,...", help="picks tried from every state, by recipe")
        parser.add_argument("--weights", type=Path, metavar="FILE", help="or name: the network that chosen asks")
        parser.add_argument("--seed", type="seed", default=0, help="of everything random (default: 0)")

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Collect, or describe."""
        from polyfold_fgpnp.data.dataset import pack_dataset
        from polyfold_fgpnp.data.describe import describe

        if (arguments.out is None) == (arguments.describe is None):
            raise ConfigError("say either where to collect (--out DIR) or what to show (--describe DIR)")
        if arguments.describe is not None and arguments.pack is not None:
            raise ConfigError(
                "--pack packs what is collected; give --out DIR, which collects nothing anew if it is complete"
            )
        if arguments.describe is not None:
            print(describe(arguments.describe))
            return 0
        try:
            found = collect(_interaction(arguments), arguments.folds, arguments.out, arguments.workers)
        except KeyboardInterrupt:
            print(f"interrupted; what is finished is in {arguments.out}, run the same command to go on")
            raise
        counts = found["counts"]
        print(
            f"{counts['folds']} folds from {counts['states']} states in {arguments.out}, {counts['diverged']} diverged"
        )
        if arguments.pack is not None:
            print(f"packed: {arguments.pack}, {pack_dataset(arguments.out, arguments.pack) / 1e6:.1f} MB")
        return 0


def collect(
    interaction: Interaction, folds: int, out: str | Path, workers: int = 1, progress: bool = True
) -> Description:
    """Run what a data set's folder lacks and finish it.

    Args:
        interaction: what to try.
        folds: at least this many folds in all; whole jobs are run.
        out: the folder; resumed if it holds a data set with the same parameters.
        workers: processes on this machine.
        progress: show a progress bar.

    Raises:
        PluginError: if there is no such kind of garment, fabric, simulator or segmenter.
        ConfigError: if the folder holds a data set with other parameters or changed shards or is in use, the weights do
            not serve, or not even one fold or process is asked for.
    """
    from tqdm.auto import tqdm

    from polyfold.logs import exclusive
    from polyfold.studies import in_processes
    from polyfold_fgpnp.data.dataset import DatasetFolder
    from polyfold_fgpnp.data.exploring import check, explore, trials_per_job

    if folds < 1 or workers < 1:
        raise ConfigError(f"{folds} folds by {workers} processes can't be collected; give 1 or more of each")
    check(interaction)
    each = trials_per_job(interaction)
    total = -(-folds // each)
    with exclusive(out):
        folder = DatasetFolder(out, interaction.model_dump(mode="json"))
        folder.set_damage_aside()
        done = folder.jobs()
        missing = [job for job in range(total) if job not in done]
        with tqdm(total=total * each, initial=(total - len(missing)) * each, unit="fold", disable=not progress) as bar:
            for job, arrays in in_processes(partial(explore, interaction), missing, workers):
                folder.write(job, arrays)
                bar.update(each)
        return folder.finish()


def _interaction(arguments: argparse.Namespace) -> Interaction:
    from pydantic import ValidationError

    from polyfold_fgpnp.data.interaction import Interaction, usual_mix
    from polyfold_fgpnp.data.trials import parse_mix

    try:
        return Interaction(
            garment_kind=arguments.kind,
            simulator=arguments.simulator,
            fabric=arguments.fabric,
            segmenter=arguments.segmenter,
            seeds=_seeds(arguments.seeds),
            edge_length=arguments.edge_length,
            course=arguments.course,
            mix=parse_mix(arguments.mix) if arguments.mix else usual_mix(arguments.course),
            seed=arguments.seed,
            weights=arguments.weights,
        )
    except ValidationError as error:
        option = str(error.errors()[0]["loc"][0]).replace("_", "-")
        raise ConfigError(f"--{option} {validation_problem(error, below=1)}") from error


def _seeds(text: str) -> tuple[int, int]:
    first, _, last = text.partition("-")
    if not (first.isdigit() and last.isdigit() and int(first) <= int(last)):
        raise ConfigError(f"--seeds {text!r} does not read A-B; for example 1000-1099")
    return int(first), int(last)
