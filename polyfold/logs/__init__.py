"""What is kept of runs on disk: typed records in append-only directories, with what they depend on."""

from polyfold.logs._json_lines import JsonLines
from polyfold.logs._records import summary
from polyfold.logs._run_directory import RunDirectory, picture_path, read_episodes, versions, write_atomically

__all__ = [
    "JsonLines",
    "RunDirectory",
    "picture_path",
    "read_episodes",
    "summary",
    "versions",
    "write_atomically",
]
