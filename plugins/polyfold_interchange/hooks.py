"""What this plugin registers."""

from polyfold import hookimpl


@hookimpl
def register_commands(register):
    """The verb ``export``."""
    register(
        "export", "polyfold_interchange.command:Export", "fold tasks and write the folds as a LeRobotDataset",
        needs=("polyfold[interchange]",),
    )  # fmt: skip
