"""What fabrics are held to."""

from __future__ import annotations

from polyfold.garments import Fabric
from polyfold.plugins._traits import Configurable
from polyfold.testing._checks import checks
from polyfold.testing._subjects import Subject


@checks("fabrics", "every constant can be set")
def _constants(subject: Subject) -> None:
    cls = subject.cls()
    known = set(cls.Config.model_fields) if isinstance(cls, Configurable) else set()
    missing = sorted(set(Fabric.LIMITS) - known)
    subject.require(
        not missing, "Config", f"{', '.join(missing)} can't be set", "give Config a field for each of Fabric.LIMITS"
    )
    for name, (low, high) in Fabric.LIMITS.items():
        value = getattr(subject.make().fabric(), name)
        subject.require(low <= value <= high, "fabric", f"{name} is {value:g}", f"it lies between {low:g} and {high:g}")
