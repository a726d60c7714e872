"""Studies: a grid of variants over tasks and garments, defined in TOML or in a few lines of Python.

>>> import polyfold
>>> study = polyfold.ablate(polyfold.load("experiments/smoke.toml"), "policy", ["affordance-pair", "farthest"])
>>> results = polyfold.run(study, "runs/policies")
>>> polyfold.table(results)
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from polyfold import plugins
from polyfold.config import ComponentSpec, Experiment, Settings, read_toml
from polyfold.errors import ConfigError, did_you_mean
from polyfold.plugins import hookspecs
from polyfold.plugins._fabrics import LARGEST, SMALLEST, is_usual
from polyfold.plugins._inspection import moved_parameter, parameter_names
from polyfold.types._views import view_of

Overrides = dict[str, Any]


class Study(Settings):
    """What to run: a suite's tasks and goals on seeded garments, once per variant.

    Attributes:
        name: what results are labelled with.
        suite: registered task suite, or the path of a suite's file, which ends in ``.toml``.
        tasks: patterns of ids of tasks and goals (``tshirt-*``); all by default.
        garments: number of garments per kind.
        first_seed: of the first garment; the others follow.
        instructions: ``first`` asks with the first wording, ``in-turn`` with the next one on each garment, ``all`` with
            each of them.
        edge_length: mesh size [m].
        sizes: longest side of garments by their kind [m], for example ``{"tshirt": 0.45}`` for a robot with short arms;
            by default what seeds draw.
        split: only the tasks that learning baselines may train on (``seen``), or only the others (``unseen``).
        steps: only tasks of one fold (``single``), or only those of several (``multi``). Goals have neither a split nor
            a number of folds and are left out by both.
        reference: what results are compared with: the ``ideal``, the flat garment folded geometrically, as thick as its
            fabric, which owes nothing to any simulator or policy; or, as in the paper, the ``oracle``'s end in the same
            simulator, in which a fault that both share is none.
        criteria: registered success criteria to count; the first is the one that ``success %`` means.
        metrics: parameters of metrics by name, for example ``{"mppe": {"align": true}}``.
        published: success [%] that others published, by label and row (``tshirt``, ``all``, ``seen``), for the tables.
        seed: of the run; part of every episode's seed.
        base: the experiment that variants start from, as dotted paths or nested tables.
        variants: name -> overrides by dotted path, for example ``{"farthest": {"policy": "farthest"}}``.
        factors: name of a variant -> what tells it from the others, by setting; :func:`grid` fills it in, so that
            effects can be told apart by setting.
    """

    name: str = Field(pattern=r"^[A-Za-z0-9_.-]{1,60}$")
    suite: str = "polyfold70"
    tasks: tuple[str, ...] = ("*",)
    garments: int = Field(default=1, ge=1, le=10_000)
    first_seed: int = Field(default=0, ge=0)
    instructions: Literal["first", "in-turn", "all"] = "in-turn"
    edge_length: float = Field(default=0.0155, gt=0.004, le=0.05)
    sizes: dict[str, Annotated[float, Field(ge=SMALLEST, le=LARGEST)]] = Field(default_factory=dict)
    split: Literal["seen", "unseen"] | None = None
    steps: Literal["single", "multi"] | None = None
    reference: Literal["oracle", "ideal"] = "ideal"
    criteria: tuple[str, ...] = Field(default=("lenient", "strict"), min_length=1)
    metrics: dict[str, dict[str, Any]] = Field(default_factory=dict)
    published: dict[str, dict[str, float]] = Field(default_factory=dict)
    seed: int = 0
    base: Overrides = Field(default_factory=dict)
    variants: dict[str, Overrides] = Field(default_factory=lambda: {"polyfold": {}}, min_length=1)
    factors: dict[str, dict[str, str]] = Field(default_factory=dict)

    def __str__(self) -> str:
        """What it will run, in five lines. Raises ConfigError if it can't be run as it is."""
        return view_of(self, "text")

    def _repr_html_(self) -> str:
        lines = escape(str(self)).splitlines()
        return f"<b>{lines[0]}</b><br>" + "<br>".join(lines[1:])


def load(path: str | Path) -> Study:
    """Read a study from TOML. Raises ConfigError with the file and the setting that is wrong."""
    settings = read_toml(path)
    study = Study.model_validate({"name": Path(path).stem, **settings}, context={"source": str(path)})
    for variant in study.variants:
        _check_components(experiment_of(study, variant))
    return study


def ablate(base: Study, path: str, values: Sequence[Any], names: Sequence[str] | None = None) -> Study:
    """A study with one variant per value of one setting.

    Args:
        base: the study to vary; its first variant is what the others differ from.
        path: dotted path of the setting: ``"policy"``, ``"fabric"``, ``"fabric.thickness"``.
        values: its values.
        names: names of the variants; by default the values.

    Raises:
        ConfigError: if there is no such setting, or its values are no list.
        PluginError: if a value names no component that there is; the message suggests the nearest.
    """
    return grid(base, {path: values}, names)


def grid(base: Study, settings: dict[str, Sequence[Any]], names: Sequence[str] | None = None) -> Study:
    """A study with one variant per combination of values; see :func:`ablate`."""
    for path, values in settings.items():
        if isinstance(values, str | bytes) or not isinstance(values, Sequence) or not values:
            raise ConfigError(f'{path} needs a list of values, not {values!r}; for example ["caso", "farthest"]')
    if not settings:
        raise ConfigError('a grid needs settings; for example {"policy": ["caso", "farthest"]}')
    combinations = [dict(zip(settings, values, strict=True)) for values in itertools.product(*settings.values())]
    names = names or [", ".join(_shown(value) for value in combination.values()) for combination in combinations]
    if len(names) != len(combinations):
        raise ConfigError(f"{len(combinations)} variants need as many names, not {len(names)}")
    if twice := [name for name, count in Counter(names).items() if count > 1]:
        raise ConfigError(f"two variants would be called {twice[0]!r}; give each its own with names=[...]")
    common = next(iter(base.variants.values()))
    variants = {name: {**common, **combination} for name, combination in zip(names, combinations, strict=True)}
    factors = {
        name: {path: _shown(value) for path, value in combination.items()}
        for name, combination in zip(names, combinations, strict=True)
    }
    study = base.model_copy(update={"variants": variants, "factors": factors})
    for variant in variants:
        _check_components(experiment_of(study, variant))
    return study


def made_of(study: Study, fabric: str) -> Study:
    """The study with its garments made of a fabric; constants that it gives and variants that name one stay.

    Raises:
        PluginError: if there is no such fabric.
    """
    plugins.find("fabrics", fabric)
    constants = {path: value for path, value in _flat(study.base).items() if path.startswith("fabric.")}
    others = {path: value for path, value in study.base.items() if path.partition(".")[0] != "fabric"}
    return study.model_copy(update={"base": {"fabric": fabric, **others, **constants}})


def with_variants(study: Study, names: Sequence[str]) -> Study:
    """The study with some of its variants, in the order given. Raises ConfigError for one that it does not have."""
    for name in names:
        if name not in study.variants:
            raise ConfigError(
                f"the study {study.name!r} has no variant {name!r}; {did_you_mean(name, list(study.variants))}"
            )
    chosen = {name: study.variants[name] for name in names}
    factors = {name: found for name, found in study.factors.items() if name in chosen}
    return study.model_copy(update={"variants": chosen, "factors": factors})


def _shown(value: Any) -> str:
    if not isinstance(value, dict) or "name" not in value:
        return str(value)
    params = value.get("params", {key: one for key, one in value.items() if key != "name"})
    return " ".join([str(value["name"]), *(f"{key}={one}" for key, one in params.items())])


def experiment_of(study: Study, variant: str) -> Experiment:
    """The experiment of a variant. Raises ConfigError naming the wrong dotted path and the nearest right one."""
    settings: dict[str, Any] = {}
    for path, value in {**_flat(study.base), **_flat(study.variants[variant])}.items():
        field, _, parameter = path.partition(".")
        if field not in Experiment.model_fields:
            raise ConfigError(
                f"variant {variant!r} sets {path!r}; {did_you_mean(field, list(Experiment.model_fields))}"
            )
        if not parameter:
            settings[field] = value
            continue
        chosen = getattr(Experiment.of(**settings), field)
        if not isinstance(chosen, ComponentSpec):
            raise ConfigError(f"variant {variant!r} sets {path!r}, but {field!r} has no parameters; set it as a whole")
        settings[field] = chosen.with_parameter(parameter, value)
    experiment = Experiment.of(**settings)
    _check_parameters(experiment, variant)
    name = experiment.simulator.name
    if not getattr(plugins.component_class("simulators", name.partition(":")[0]), "unattended", True):
        raise ConfigError(
            f"variant {variant!r} folds on a real table ({name!r}), where nobody knows the cloth's true state and "
            "somebody must lay out each garment; study a simulation, and fold there by 'polyfold fold'"
        )
    return experiment


def _flat(settings: Overrides) -> Overrides:
    """Nested tables as dotted paths; a table with a name stays a component."""
    flat: Overrides = {}
    for key, value in settings.items():
        if isinstance(value, dict) and "name" not in value:
            flat |= {f"{key}.{inner}": content for inner, content in value.items()}
        else:
            flat[key] = value
    return flat


def _check_components(experiment: Experiment) -> None:
    """Raises PluginError for a component that nobody registered, naming the nearest; what it needs may be missing."""
    for field in Experiment.model_fields:
        spec = getattr(experiment, field)
        if not isinstance(spec, ComponentSpec):
            continue
        kind, name = hookspecs.plural(field), spec.name.partition(":")[0]
        if not is_usual(kind, spec) and name not in plugins.names(kind):
            plugins.find(kind, name)


def _check_parameters(experiment: Experiment, variant: str) -> None:
    """Raises ConfigError for a parameter that the chosen component does not have, naming the nearest that it has."""
    for field in Experiment.model_fields:
        spec = getattr(experiment, field)
        if not isinstance(spec, ComponentSpec):
            continue
        kind = hookspecs.plural(field)
        known = parameter_names(kind, spec) if spec.params else ()
        for parameter in spec.params:
            if parameter not in known:
                nearest = did_you_mean(f"{field}.{parameter}", [f"{field}.{name}" for name in known])
                raise ConfigError(
                    f"variant {variant!r} sets '{field}.{parameter}', which {spec.name!r} does not have; "
                    + (moved_parameter(kind, spec, parameter) or nearest)
                )
