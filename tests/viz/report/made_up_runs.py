from io import BytesIO

from PIL import Image

from polyfold.evaluation._criteria import criteria, succeeded
from polyfold.logs import RunRecord, StudyEpisodeRecord
from polyfold.logs._fingerprint import Fingerprint
from polyfold.logs._records import MetricRecord

TASKS = {
    "square-corner-top_left": ("square", "S-Corner"),
    "square-triangle-top_left": ("square", "S-Triangle"),
    "tshirt-half-left": ("tshirt", "T-Half"),
}


def picture(panels=2):
    buffer = BytesIO()
    Image.new("RGB", (100 * panels, 100), (40, 120, 160)).save(buffer, format="WEBP")
    return buffer.getvalue()


METRICS = {
    "mppe": MetricRecord(label="MPPE", unit="mm", digits=1, higher_is_better=False),
    "miou": MetricRecord(label="mIoU", unit="", digits=3, higher_is_better=True),
    "moved-part": MetricRecord(label="moved part", unit="mm", digits=1, higher_is_better=False),
}
CRITERIA = criteria(["lenient", "strict"])


def run_record(study):
    """What a run of a study would be described by."""
    fingerprint = Fingerprint(distributions={"numpy": "2.4.6"})
    asked = {"study": study.model_dump(mode="json")}
    return RunRecord(asked=asked, started=None, fingerprint=fingerprint, host=None, metrics=METRICS, criteria=CRITERIA)


def record(variant, task, seed, metrics, /, **changes):
    kind, type_ = TASKS[task]
    success = {name: succeeded(metrics, bounds) for name, bounds in criteria(["lenient", "strict"]).items()}
    garment = {"kind": kind, "name": f"{kind}-{seed}", "seed": seed, "size_m": 0.4, "particles": 900}
    step = {"subgoal": "fold it", "fold_line": None, "picks": ((1, 1),), "places": ((2, 2),), "seconds": {}}
    fields = {
        "key": f"{variant}/{task}/{seed}/0",
        "variant": variant,
        "task": task,
        "type": type_,
        "split": None,
        "steps_wanted": 1,
        "garment": garment | changes.pop("garment", {}),
        "pose_seed": seed,
        "agent_seed": 1,
        "agent": "polyfold",
        "wording": 0,
        "instruction": f"Do {task}.",
        "subgoals": ("fold it",),
        "steps": (step,),
        "metrics": metrics,
        "step_errors_mm": (metrics["mppe"],),
        "success": success,
        "failure": None,
        "cause": None if success["lenient"] else "policy",
        "privileged": False,
        "seconds": {"reset": 0.1, "grounding": 0.3, "execution": 0.2},
        "peak_memory_mb": 250,
        "started": None,
        "finished": None,
        "processor": None,
    }
    return StudyEpisodeRecord(**{**fields, **changes})


GOOD = {"miou": 0.96, "mppe": 4.0, "moved-part": 9.0}
BAD = {"miou": 0.7, "mppe": 40.0, "moved-part": 90.0}
