"""Link what a package requires by default, and what that requires, from this environment into the one it is in.

python link_requirements.py PACKAGE SITE_PACKAGES
"""

import sys
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement


def required(whole: Distribution, extras: set[str], found: dict[str, Distribution]) -> None:
    """Add to ``found`` what a distribution requires with some of its extras."""
    for requirement in map(Requirement, whole.requires or ()):
        marker = requirement.marker
        if marker is not None and not any(marker.evaluate({"extra": extra}) for extra in ("", *extras)):
            continue
        try:
            one = distribution(requirement.name)
        except PackageNotFoundError:
            continue  # what it can do without here
        if (asked := f"{one.name} {sorted(requirement.extras)}") not in found:
            found[asked] = one
            required(one, requirement.extras, found)


def main(package: str, site: Path) -> None:
    """Link every file's topmost folder."""
    found: dict[str, Distribution] = {}
    (whole,) = Distribution.discover(name=package, path=[str(site)])
    required(whole, set(), found)
    for one in found.values():
        for top in {Path(str(file)).parts[0] for file in one.files or ()} - {"..", "__pycache__"}:
            if not (site / top).exists():
                (site / top).symlink_to(Path(str(one.locate_file(top))))


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
