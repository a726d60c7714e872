"""Episodes as a LeRobotDataset v3.0: parquet, video and their descriptions, as ``lerobot`` 0.4 reads them.

A frame is a fold: the picture before it, where the arms are, and its picks and places as numbers; a second of the video
is a frame. What the numbers are stands in :mod:`polyfold_interchange.numbers` and in the data set's ``info.json``.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold import Episode
from polyfold.errors import ConfigError
from polyfold_interchange.numbers import ACTION_NAMES, STATE_NAMES, as_numbers, state_after

VERSION = "v3.0"
FPS = 1
CAMERA = "observation.images.top"
PLACE = "chunk-000/file-000"
QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}


@dataclass(frozen=True, eq=False)
class Recording:
    """An episode as its numbers, of K folds.

    Attributes:
        sentence: what was asked for.
        pictures: before each fold, uint8, shape (K, H, W, 3).
        states: where the arms were, float32, shape (K, 4).
        actions: float32, shape (K, 8).
    """

    sentence: str
    pictures: NDArray[np.uint8]
    states: NDArray[np.float32]
    actions: NDArray[np.float32]

    @classmethod
    def of(cls, episode: Episode) -> Recording:
        """An episode's folds, tries that were repeated left out. Raises ConfigError if it has none."""
        steps = episode.final_attempts()
        if not steps:
            raise ConfigError("an episode in which nothing was folded can't be exported; leave it out")
        actions = np.stack([as_numbers(step.action, step.observation.camera) for step in steps])
        states = np.stack([state_after(None), *(state_after(action) for action in actions[:-1])])
        return cls(episode.instruction, np.stack([step.observation.rgb for step in steps]), states, actions)


def write_dataset(episodes: Iterable[Episode | Recording] | Episode | Recording, folder: str | Path) -> Path:
    """Write episodes as a LeRobotDataset.

    Args:
        episodes: in order; each with its sentence.
        folder: a new one.

    Returns:
        The folder: ``LeRobotDataset("mine", root=folder)`` reads it.

    Raises:
        ConfigError: if the folder holds something, there is no episode, or pictures differ in size.
    """
    several = [episodes] if isinstance(episodes, Episode | Recording) else episodes
    recordings = [_recording(one) for one in (several if isinstance(several, Iterable) else [several])]
    folder = Path(folder)
    if folder.exists() and any(folder.iterdir()):
        raise ConfigError(f"{folder} holds something already; choose another folder")
    if not recordings:
        raise ConfigError("there is no episode to export; fold something first")
    if len({one.pictures.shape[1:] for one in recordings}) > 1:
        raise ConfigError("the episodes' pictures differ in size; export those of one camera at a time")
    # Beside it first, so that what was broken off is not taken for a whole one and can be written again.
    part = folder.with_name(f".{folder.name}.part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(parents=True)
    _write_video(recordings, part / "videos" / CAMERA / f"{PLACE}.mp4")
    _write_frames(recordings, part / "data" / f"{PLACE}.parquet")
    _write_episodes(recordings, part / "meta" / "episodes" / f"{PLACE}.parquet")
    _write_tasks(_sentences(recordings), part / "meta" / "tasks.parquet")
    _write_json(_statistics(recordings), part / "meta" / "stats.json")
    _write_json(_info(recordings), part / "meta" / "info.json")
    if folder.exists():
        folder.rmdir()
    part.replace(folder)
    return folder


def _recording(one: object) -> Recording:
    if isinstance(one, Episode):
        return Recording.of(one)
    if not isinstance(one, Recording):
        raise ConfigError(f"{one!r} is no episode; give what polyfold.fold returned, one or several")
    return one


def _sentences(recordings: Sequence[Recording]) -> list[str]:
    return list(dict.fromkeys(one.sentence for one in recordings))


def _write_video(recordings: Sequence[Recording], path: Path) -> None:
    """All pictures one after the other, a second each."""
    import av

    path.parent.mkdir(parents=True, exist_ok=True)
    height, width = recordings[0].pictures.shape[1:3]
    with av.open(str(path), "w") as container:
        stream: Any = container.add_stream("libx264", rate=FPS, options={"crf": "14", "g": "2"})
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.time_base = Fraction(1, FPS)
        for picture in np.concatenate([one.pictures for one in recordings]):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(stream.encode())


def _columns(recordings: Sequence[Recording]) -> dict[str, NDArray[Any]]:
    """The numbers of every frame, first axis over all frames."""
    lengths = [len(one.actions) for one in recordings]
    sentences = _sentences(recordings)
    within = np.concatenate([np.arange(length) for length in lengths])
    return {
        "observation.state": np.concatenate([one.states for one in recordings]),
        "action": np.concatenate([one.actions for one in recordings]),
        "timestamp": (within / FPS).astype(np.float32),
        "frame_index": within.astype(np.int64),
        "episode_index": np.repeat(np.arange(len(recordings)), lengths).astype(np.int64),
        "index": np.arange(sum(lengths), dtype=np.int64),
        "task_index": np.repeat([sentences.index(one.sentence) for one in recordings], lengths).astype(np.int64),
    }


def _write_frames(recordings: Sequence[Recording], path: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    path.parent.mkdir(parents=True, exist_ok=True)
    columns = {
        name: pa.FixedSizeListArray.from_arrays(pa.array(values.reshape(-1)), values.shape[1])
        if values.ndim == 2
        else pa.array(values)
        for name, values in _columns(recordings).items()
    }
    pq.write_table(pa.table(columns), path)


def _write_episodes(recordings: Sequence[Recording], path: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    path.parent.mkdir(parents=True, exist_ok=True)
    ends = np.cumsum([len(one.actions) for one in recordings])
    rows = []
    for number, (one, end) in enumerate(zip(recordings, ends, strict=True)):
        begin = int(end) - len(one.actions)
        row: dict[str, Any] = {
            "episode_index": number, "tasks": [one.sentence], "length": len(one.actions),
            "dataset_from_index": begin, "dataset_to_index": int(end),
            "data/chunk_index": 0, "data/file_index": 0, "meta/episodes/chunk_index": 0, "meta/episodes/file_index": 0,
            f"videos/{CAMERA}/chunk_index": 0, f"videos/{CAMERA}/file_index": 0,
            f"videos/{CAMERA}/from_timestamp": begin / FPS, f"videos/{CAMERA}/to_timestamp": int(end) / FPS,
        }  # fmt: skip
        for feature, told in _statistics([one]).items():
            row |= {f"stats/{feature}/{name}": value for name, value in told.items()}
        rows.append(row)
    pq.write_table(pa.Table.from_pylist(rows), path)


def _write_tasks(sentences: Sequence[str], path: Path) -> None:
    """Sentence by number; the sentence is the index, as pandas writes it."""
    import pandas

    path.parent.mkdir(parents=True, exist_ok=True)
    pandas.DataFrame({"task_index": range(len(sentences))}, index=list(sentences)).to_parquet(path)


def _statistics(recordings: Sequence[Recording]) -> dict[str, dict[str, Any]]:
    """Range and spread of each feature, by which policies normalise; of pictures by channel, from 0 to 1."""
    told = {name: _spread(values.reshape(len(values), -1)) for name, values in _columns(recordings).items()}
    pictures = np.concatenate([one.pictures for one in recordings])[:, ::4, ::4]
    seen = _spread(pictures.reshape(-1, 3) / 255.0)
    told[CAMERA] = {name: [[[value]] for value in values] for name, values in seen.items() if name != "count"}
    told[CAMERA]["count"] = [len(pictures)]
    return told


def _spread(values: NDArray[Any]) -> dict[str, list[Any]]:
    found = {"min": values.min(0), "max": values.max(0), "mean": values.mean(0), "std": values.std(0)}
    found |= {name: np.quantile(values, share, axis=0) for name, share in QUANTILES.items()}
    return {**{name: np.asarray(value, float).tolist() for name, value in found.items()}, "count": [len(values)]}


def _info(recordings: Sequence[Recording]) -> dict[str, Any]:
    height, width = recordings[0].pictures.shape[1:3]
    video = {
        "video.height": height, "video.width": width, "video.codec": "h264", "video.pix_fmt": "yuv420p",
        "video.is_depth_map": False, "video.fps": FPS, "video.channels": 3, "has_audio": False,
    }  # fmt: skip
    number = {"dtype": "int64", "shape": [1], "names": None}
    return {
        "codebase_version": VERSION,
        "robot_type": "polyfold",
        "total_episodes": len(recordings),
        "total_frames": sum(len(one.actions) for one in recordings),
        "total_tasks": len(_sentences(recordings)),
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": FPS,
        "splits": {"train": f"0:{len(recordings)}"},
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4",
        "features": {
            CAMERA: {
                "dtype": "video", "shape": [height, width, 3], "names": ["height", "width", "channels"], "info": video,
            },
            "observation.state": {"dtype": "float32", "shape": [4], "names": list(STATE_NAMES)},
            "action": {"dtype": "float32", "shape": [8], "names": list(ACTION_NAMES)},
            "timestamp": {"dtype": "float32", "shape": [1], "names": None},
            **dict.fromkeys(("frame_index", "episode_index", "index", "task_index"), number),
        },
    }  # fmt: skip


def _write_json(content: Any, path: Path) -> None:
    path.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
