"""Real distributions, built and installed into a temporary folder that only the child processes see."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "plugins" / "polyfold-example"

HOOKIMPL = "from polyfold import hookimpl\n\n@hookimpl\n"
SOURCES = {
    "misspelt": HOOKIMPL + "def register_polices(register):\n    register('a', 'x:Y')\n",
    "undecorated": "def register_policies(register):\n    register('bare', 'undecorated:Bare')\n",
    "duplicate": HOOKIMPL + "def register_policies(register):\n    register('middle', 'duplicate:Other')\n",
    "crashing": "raise ZeroDivisionError('boom at import')\n",
    "lacking": "import a_module_nobody_has\n",
    "needy": HOOKIMPL + "def register_policies(register):\n"
    "    register('needy', 'needy:Needy', needs=['a-distribution-nobody-has>=2'])\n",
    "watching": HOOKIMPL + "def on_step(step):\n    raise RuntimeError('observer trouble')\n\n"
    "@hookimpl\ndef on_episode_end(episode):\n    print('WATCHED', episode.instruction)\n",
    "verbose": HOOKIMPL + "def register_commands(register):\n    register('greet', 'verbose:Greet', 'say hello')\n\n"
    "class Greet:\n    @staticmethod\n    def configure(parser):\n"
    "        parser.add_argument('--name', default='you')\n\n"
    "    @staticmethod\n    def run(arguments):\n        print('hello', arguments.name)\n        return 0\n",
}


def _write(folder: Path, name: str, source: str) -> Path:
    project = folder / name
    project.mkdir(parents=True)
    (project / f"{name}.py").write_text(source)
    (project / "pyproject.toml").write_text(
        f'[build-system]\nrequires = ["hatchling"]\nbuild-backend = "hatchling.build"\n'
        f'[project]\nname = "polyfold-{name}"\nversion = "1.2.3"\n'
        f'[project.entry-points.polyfold]\n{name} = "{name}"\n'
        f'[tool.hatch.build.targets.wheel]\nonly-include = ["{name}.py"]\n'
    )
    return project


@pytest.fixture(scope="session")
def installed(tmp_path_factory):
    """Install each plugin into a folder of its own; returns name -> folder."""
    folders = {}
    for name, source in {**SOURCES, "example": None}.items():
        target = tmp_path_factory.mktemp(name)
        project = EXAMPLE if source is None else _write(tmp_path_factory.mktemp("source"), name, source)
        command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation"]
        subprocess.run([*command, "--target", str(target), str(project)], check=True)
        folders[name] = target
    return folders


@pytest.fixture
def polyfold(installed):
    """Run the command line in a child process that sees the named plugins."""

    def run(*arguments, plugins=(), **environment):
        path = os.pathsep.join(str(installed[name]) for name in plugins)
        return subprocess.run(
            [sys.executable, "-m", "polyfold", *arguments],
            capture_output=True,
            text=True,
            env={**os.environ, "PYTHONPATH": path, **environment},
            timeout=120,
            check=False,
        )

    return run
