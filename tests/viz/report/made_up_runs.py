from io import BytesIO

from PIL import Image

from polyfold.evaluation import succeeded

TASKS = {
    "square-corner-top_left": ("square", "S-Corner"),
    "square-triangle-top_left": ("square", "S-Triangle"),
    "tshirt-half-left": ("tshirt", "T-Half"),
}


def picture(panels=2):
    buffer = BytesIO()
    Image.new("RGB", (100 * panels, 100), (40, 120, 160)).save(buffer, format="WEBP")
    return buffer.getvalue()


def record(variant, task, seed, metrics, /, **changes):
    kind, type_ = TASKS[task]
    success = {preset: succeeded(metrics, preset) for preset in ("polyfold", "strict")}
    return {
        "key": f"{variant}/{task}/{seed}/0",
        "variant": variant,
        "task": task,
        "type": type_,
        "steps_wanted": 1,
        "garment": kind,
        "garment_seed": seed,
        "wording": 0,
        "instruction": f"Do {task}.",
        "subgoals": ["fold it"],
        "steps": 1,
        "metrics": metrics,
        "step_errors_mm": [metrics["mppe"]],
        "success": success,
        "failure": None,
        "cause": None if success["polyfold"] else "policy",
        "privileged": False,
        "seconds": {"reset": 0.1, "grounding": 0.3, "execution": 0.2},
        "peak_memory_mb": 250,
        **changes,
    }


GOOD = {"miou": 0.96, "mppe": 4.0, "moved-part": 9.0}
BAD = {"miou": 0.7, "mppe": 40.0, "moved-part": 90.0}
