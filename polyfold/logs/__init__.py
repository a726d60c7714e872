"""What is kept of runs on disk: typed records in append-only directories, with what they depend on."""

from polyfold.logs._accounts import Account, accounts
from polyfold.logs._files import picture_path, write_atomically
from polyfold.logs._fingerprint import Fingerprint, fingerprint
from polyfold.logs._json_lines import JsonLines
from polyfold.logs._records import (
    CallRecord,
    EpisodeRecord,
    FoldRecord,
    KeyedRecord,
    MetricRecord,
    RunRecord,
    StepRecord,
    StudyEpisodeRecord,
    ThresholdRecord,
)
from polyfold.logs._run_directory import RunDirectory, read_episodes, read_run
from polyfold.logs._writing import fold_record, transcript_lines

__all__ = [
    "Account",
    "CallRecord",
    "EpisodeRecord",
    "Fingerprint",
    "FoldRecord",
    "JsonLines",
    "KeyedRecord",
    "MetricRecord",
    "RunDirectory",
    "RunRecord",
    "StepRecord",
    "StudyEpisodeRecord",
    "ThresholdRecord",
    "accounts",
    "fingerprint",
    "fold_record",
    "picture_path",
    "read_episodes",
    "read_run",
    "transcript_lines",
    "write_atomically",
]
