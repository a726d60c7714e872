"""Where the package installs without a compiler: ``python -m experiments.benchmarks.wheels``.

For each Python, platform and extra: whether every requirement, and what that requires, has a wheel. Nothing is
installed and hardly anything downloaded: pip (25 or newer) reads what is in a wheel where it lies. Markers are
evaluated for the platform asked about, which pip itself does not do (``--platform`` of pip 26). Prints Markdown.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

PROJECT = Path(__file__).parents[2] / "pyproject.toml"
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
DEFAULT, DEVELOPERS = "default", ("test", "lint")


@dataclass(frozen=True)
class Platform:
    """A platform: pip's tags for it, and what markers are evaluated with."""

    name: str
    tags: tuple[str, ...]
    markers: Mapping[str, str]


def _linux(machine: str) -> Platform:
    tags = (*(f"manylinux_2_{minor}_{machine}" for minor in range(34, 4, -1)), f"manylinux2014_{machine}")
    return Platform(f"Linux {machine}", tags, _markers("linux", "Linux", machine, "posix"))


def _markers(system: str, name: str, machine: str, family: str) -> dict[str, str]:
    return {"sys_platform": system, "platform_system": name, "platform_machine": machine, "os_name": family}


PLATFORMS = (
    _linux("x86_64"),
    _linux("aarch64"),
    Platform(
        "macOS arm64",
        tuple(f"macosx_{major}_0_{kind}" for major in (14, 13, 12, 11) for kind in ("arm64", "universal2")),
        _markers("darwin", "Darwin", "arm64", "posix"),
    ),
    Platform("Windows", ("win_amd64",), _markers("win32", "Windows", "AMD64", "nt")),
)


@dataclass
class Found:
    """Wheels on one Python and platform.

    Attributes:
        wanted: what is asked of each package, by its name.
        requires: what the wheel of a package that was found requires, by name and what was asked of it.
        lacking: packages without any wheel that would do.
    """

    python: str
    platform: Platform
    wanted: dict[str, SpecifierSet] = field(default_factory=dict)
    requires: dict[str, list[Requirement]] = field(default_factory=dict)
    lacking: set[str] = field(default_factory=set)

    def lacks(self, requirements: Iterable[str]) -> list[str]:
        """Packages without a wheel among requirements and all that they require."""
        asked: set[str] = set()
        waiting = [self._of_here(Requirement(text), "") for text in requirements]
        lacking: set[str] = set()
        while batch := [one for one in waiting if one is not None and str(one) not in asked]:
            asked |= {str(one) for one in batch}
            self._look_up(batch)
            lacking |= {one.name for one in batch} & self.lacking
            waiting = [
                self._of_here(behind, extra)
                for one in batch
                for behind in self.requires.get(one.name, ())
                for extra in (one.extras or {""})
            ]
        return sorted(lacking)

    def _of_here(self, requirement: Requirement, extra: str) -> Requirement | None:
        """A requirement without its marker, or None if that does not hold here."""
        here = {"python_version": self.python, "python_full_version": f"{self.python}.0", "extra": extra}
        if requirement.marker is not None and not requirement.marker.evaluate({**self.platform.markers, **here}):
            return None
        extras = f"[{','.join(sorted(requirement.extras))}]" if requirement.extras else ""
        return Requirement(f"{requirement.name}{extras}{requirement.specifier}")

    def _look_up(self, batch: Sequence[Requirement]) -> None:
        """Find wheels of those that are new, or of which more is asked now."""
        new = []
        for one in batch:
            both = self.wanted.get(one.name, SpecifierSet()) & one.specifier
            if one.name not in self.wanted or both != self.wanted[one.name]:
                self.wanted[one.name] = both
                new.append(one.name)
        while new and (missing := self._without_wheel(new)):
            self.lacking.add(missing)
            new.remove(missing)

    def _without_wheel(self, names: Sequence[str]) -> str | None:
        """Have pip look for wheels of packages, without what they require; the first that has none."""
        with tempfile.TemporaryDirectory() as folder:
            report = Path(folder) / "report.json"
            command = [
                sys.executable,
                "-m",
                "pip",
                "install",
                "--dry-run",
                "--ignore-installed",
                "--no-deps",
                "--quiet",
            ]
            command += ["--use-feature=fast-deps", "--only-binary=:all:", "--python-version", self.python]
            command += [part for tag in self.platform.tags for part in ("--platform", tag)]
            command += ["--target", str(Path(folder) / "nowhere"), "--report", str(report)]
            command += [f"{name}{self.wanted[name]}" for name in names]
            ran = subprocess.run(command, capture_output=True, text=True, encoding="utf-8")
            if ran.returncode != 0:
                said = re.search(r"No matching distribution found for ([\w.-]+)", ran.stderr)
                if said is None:
                    sys.exit(ran.stderr)
                return next(name for name in names if _same(name, said[1]))
            for one in json.loads(report.read_text(encoding="utf-8"))["install"]:
                told = one["metadata"]
                name = next(name for name in names if _same(name, told["name"]))
                self.requires[name] = [Requirement(text) for text in told.get("requires_dist", ())]
        return None


def _same(one: str, other: str) -> bool:
    plain = (name.lower().replace("_", "-").replace(".", "-") for name in (one, other))
    return next(plain) == next(plain)


def extras() -> dict[str, list[str]]:
    """The requirements of the default install and of each user's extra, extras of the package itself taken apart."""
    project = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    listed = project["optional-dependencies"]

    def apart(texts: Iterable[str]) -> list[str]:
        found = []
        for requirement in map(Requirement, texts):
            if requirement.name == project["name"]:
                found += apart([text for extra in sorted(requirement.extras) for text in listed[extra]])
            else:
                found.append(str(requirement))
        return found

    users = {name: texts for name, texts in listed.items() if name not in DEVELOPERS}
    return {DEFAULT: project["dependencies"], **{name: apart(texts) for name, texts in users.items()}}


def main(arguments: Sequence[str] | None = None) -> None:
    """Look up and print."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.wheels", description=__doc__)
    parser.add_argument("--pythons", nargs="+", default=PYTHONS, metavar="VERSION")
    parser.add_argument("--extras", nargs="+", default=list(extras()), metavar="NAME")
    options = parser.parse_args(arguments)
    print(f"| Python, platform | {' | '.join(options.extras)} |")
    print("|---" * (len(options.extras) + 1) + "|")
    for platform in PLATFORMS:
        for python in options.pythons:
            found = Found(python, platform)
            cells = [", ".join(found.lacks(extras()[name])) or "yes" for name in options.extras]
            print(f"| {python}, {platform.name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
