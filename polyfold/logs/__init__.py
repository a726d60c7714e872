"""What is kept of runs on disk: typed records in append-only directories, with what they depend on."""

from polyfold.logs._disk.exclusive import exclusive
from polyfold.logs._disk.json_lines import JsonLines
from polyfold.logs._records import FoldRecord, KeyedRecord, RunRecord, StudyEpisodeRecord
from polyfold.logs._run_directory import RunDirectory, read_episodes, read_run

__all__ = [
    "FoldRecord",
    "JsonLines",
    "KeyedRecord",
    "RunDirectory",
    "RunRecord",
    "StudyEpisodeRecord",
    "exclusive",
    "read_episodes",
    "read_run",
]
