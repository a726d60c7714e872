"""The host of plugins: it finds them, keeps the catalog of components, makes them, and tells observers what happens.

Discovery is lazy, and happens again after a registration by hand. Every entry point is loaded on its own: a broken
plugin is recorded with its distribution, version and traceback, warned of once, and never takes the host down.
"""

from __future__ import annotations

import importlib
import traceback
import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import pluggy

from polyfold.errors import ConfigError, PluginError, did_you_mean, validation_problem
from polyfold.errors._hints import misplaced_truth
from polyfold.plugins import hookspecs
from polyfold.plugins._border import constructed, guarded
from polyfold.plugins._calling import call, implementations
from polyfold.plugins._observation import Observers
from polyfold.plugins._registry.carrying import portable, unpacked
from polyfold.plugins._registry.catalog import RENAME, SESSION, Catalog, Component, Plugin, Problem
from polyfold.plugins._registry.discovery import disabled_by_environment, discover, new_manager
from polyfold.plugins._registry.naming import refuse_name, refuse_target, which_garment
from polyfold.plugins._traits import Configurable, TakesArgument, moved_to
from polyfold.plugins.hookspecs import singular

if TYPE_CHECKING:
    from polyfold.config import ComponentSpec, Experiment


class Host:
    """Plugins, their components, and the observers of one process.

    The functions of :mod:`polyfold.plugins` are the methods of the process's own host. Make another one for what must
    not see its registrations.

    Args:
        third_party: whether plugins of other distributions count.
    """

    def __init__(self, third_party: bool = True) -> None:
        self._third_party = third_party
        self._by_hand: dict[tuple[str, str], Component] = {}
        self._observers = Observers()
        self._found: tuple[Catalog, pluggy.PluginManager] | None = None
        self._warned: set[str] = set()

    def __reduce__(self) -> str:
        """Travel to other processes by name: the process's own host is each process's own."""
        return "HOST"

    def catalog(self) -> Catalog:
        """The catalog of everything that is installed; discovered on first use."""
        return self._discovered()[0]

    def refresh(self, third_party: bool | None = None) -> Catalog:
        """Look again, for a plugin installed since; ``third_party=False`` keeps to the bundled ones."""
        if third_party is not None:
            self._third_party = third_party
        importlib.invalidate_caches()
        self._found = None
        return self.catalog()

    def third_party(self) -> bool:
        """Whether plugins of other distributions than PolyFold's own count."""
        return self._third_party

    def _discovered(self) -> tuple[Catalog, pluggy.PluginManager]:
        if self._found is None:
            found, manager = Catalog(), new_manager(blocked=disabled_by_environment())
            discover(found, manager, self._third_party)
            for (kind, _), component in self._by_hand.items():
                found.add(kind, component)
            for plugin in found.plugins:
                for problem in plugin.problems:
                    self._warn(f"plugin {plugin.label}: {problem.summary}")
            self._found = found, manager
        return self._found

    def _warn(self, message: str) -> None:
        """Say it once, however often what it says is met."""
        if message not in self._warned:
            self._warned.add(message)
            warnings.warn(message, stacklevel=3)

    def register(
        self, kind: str, name: str, target: type | str, summary: str = "", needs: tuple[str, ...] = ()
    ) -> None:
        """Register a component from a script or a notebook cell; a later registration of the name replaces the earlier.

        A plugin's component of that name gives way to it, which is warned of, until it is unregistered.

        Args:
            kind: one of :data:`polyfold.plugins.hookspecs.KINDS`, for example ``"policies"``.
            name: what to call it.
            target: the class itself, or ``"package.module:Class"``; for tasks the path of their file.
            summary: one line.
            needs: distributions it needs.

        Raises:
            PluginError: if there is no such kind, the name is not allowed, or the target is neither.
        """
        _check_kind(kind)
        refuse_name(kind, name)
        refuse_target(kind, name, target)
        if hidden := [entry for entry in self.catalog().components[kind].get(name, []) if not entry.plugin.is_session]:
            self._warn(
                f"the {singular(kind)} {name!r} of the plugin {hidden[0].plugin.label} gives way to the one registered "
                f"by hand, in this process, until polyfold.plugins.unregister({kind!r}, {name!r}); choose another name "
                "to have both"
            )
        self._add(kind, name, target, summary, needs)

    def _add(self, kind: str, name: str, target: type | str, summary: str = "", needs: tuple[str, ...] = ()) -> None:
        by_hand = Plugin(SESSION, "", "", "registered by hand")
        self._by_hand.pop((kind, name), None)
        self._by_hand[kind, name] = Component(name, target, summary, tuple(needs), by_hand)
        self.refresh()

    def unregister(self, kind: str, name: str) -> None:
        """Forget what :meth:`register` added under a name. Raises PluginError if nothing was."""
        if (kind, name) not in self._by_hand:
            raise PluginError(f"no {singular(kind)} {name!r} was registered by hand; there is nothing to forget")
        del self._by_hand[kind, name]
        self.refresh()

    def by_hand(self) -> list[tuple[str, str]]:
        """(kind, name) of what :meth:`register` added in this process."""
        return list(self._by_hand)

    def portable(self) -> list[tuple[str, str, str | bytes]]:
        """(kind, name, target) of what was registered by hand and can be had in another process.

        The target is what to import, or the class itself, packed, where it is of a notebook or a script.
        """
        targets = {key: portable(component.target) for key, component in self._by_hand.items()}
        return [(kind, name, target) for (kind, name), target in targets.items() if target is not None]

    def receive(self, kind: str, name: str, target: str | bytes) -> None:
        """Register what another process of this user's found :meth:`portable`, and warned of."""
        self._add(kind, name, unpacked(target) if isinstance(target, bytes) else target)

    def names(self, kind: str) -> list[str]:
        """Names of the usable components of a kind, sorted."""
        _check_kind(kind)
        return sorted(self.catalog().components[kind])

    def find(self, kind: str, name: str) -> Component:
        """The catalog's entry for a component.

        Raises:
            PluginError: if nobody registered it, if two plugins did, or if something it needs is not installed.
        """
        _check_kind(kind)
        entries = self.catalog().components[kind].get(name, [])
        if not entries:
            raise PluginError(self._unknown(kind, name))
        if len(entries) > 1:
            if all(entry.plugin is entries[0].plugin for entry in entries):
                label = entries[0].plugin.label
                raise PluginError(f"the plugin {label} registers the {singular(kind)} {name!r} twice; {RENAME}")
            owners = " and ".join(entry.plugin.label for entry in entries)
            raise PluginError(
                f"the {singular(kind)} {name!r} is registered by {owners}; "
                f"uninstall one of them or disable one with POLYFOLD_DISABLE={entries[-1].plugin.to_disable}"
            )
        entries[0].refuse_if_incomplete(f"the {singular(kind)} {name!r}")
        return entries[0]

    def _unknown(self, kind: str, name: str) -> str:
        found = self.catalog()
        known = sorted(found.components[kind])
        of_garment = kind == "garments" and isinstance(name, str)
        also = {one: tuple(getattr(self._class_if_any(one), "also_called", ())) for one in known if of_garment}
        hint = which_garment(name, also) if of_garment else did_you_mean(name, known)
        what = "task suite" if kind == "tasks" else singular(kind)
        message = f"no {what} is called {name!r}; {hint}"
        troubled = [plugin for plugin in found.plugins if plugin.problems]
        if troubled:
            listed = "; ".join(f"{plugin.label}: {plugin.problems[0].summary}" for plugin in troubled)
            message += f". A plugin that might have registered it has a problem: {listed}"
        return message

    def _class_if_any(self, kind: str) -> Any:
        try:
            return self.component_class("garments", kind)
        except PluginError:
            return None

    def component_class(self, kind: str, name: str) -> Any:
        """The class behind a name. Raises PluginError as :meth:`find` does, or if the class can't be imported."""
        return self.find(kind, name).load(f"the {singular(kind)} {name!r}")

    def create(self, kind: str, name: str, params: Mapping[str, Any] | None = None, **components: Any) -> Any:
        """Construct a component.

        Args:
            kind: one of :data:`polyfold.plugins.hookspecs.KINDS`.
            name: registered name, optionally with an argument: ``"litellm:openai/gpt-4o"``. The argument sets the
                configuration field that the class names (:class:`polyfold.plugins.interfaces.TakesArgument`).
            params: values for the fields of the class's ``Config``.
            components: further components, for agents
                (:class:`polyfold.plugins.interfaces.UsesComponents`).

        Raises:
            PluginError: see :meth:`find`; or it fails, or lacks what its kind must have.
            ConfigError: if a parameter is unknown or has an impossible value; the message names it.
        """
        cls, config = self.configured(kind, name, params)
        name = name.partition(":")[0]
        by_hand = (kind, name) in self._by_hand
        home = "that was registered by hand" if by_hand else f"of the plugin {self.find(kind, name).plugin.label}"
        owner = f"the {singular(kind)} {name!r} {home}"
        made = constructed(cls, [] if config is None else [config], components, owner)
        return guarded(made, kind, owner)

    def create_chosen(self, experiment: Experiment, field: str) -> Any:
        """Construct the component that an experiment names in ``field``, for example ``"policy"``.

        The fabric depends on the garment: see :func:`polyfold.plugins.make_fabric`.
        """
        spec: ComponentSpec = getattr(experiment, field)
        return self.create(hookspecs.plural(field), spec.name, spec.params)

    def configured(self, kind: str, name: str, params: Mapping[str, Any] | None = None) -> tuple[Any, Any]:
        """The class behind a name and its ``Config`` with the given values, as :meth:`create` takes them.

        The second is None for a class without parameters.
        """
        name, has_argument, argument = name.partition(":")
        cls = self.component_class(kind, name)
        owner = f"the {singular(kind)} {name!r}"
        values = dict(params or {})
        if has_argument:
            if not isinstance(cls, TakesArgument):
                raise ConfigError(f"{owner} takes no argument; write {name!r} without ':{argument}'")
            values[cls.argument] = argument
        if isinstance(cls, Configurable):
            return cls, _configured(cls, values, owner)
        if values:
            raise ConfigError(f"{owner} has no parameters; remove {', '.join(sorted(values))}")
        return cls, None

    def observe(self, observer: object) -> None:
        """Let an object's ``on_*`` methods watch runs in this process, as a plugin's hooks do.

        Raises:
            PluginError: if it has none of them, or one asks for an argument that the event does not have.
        """
        self._observers.add(observer)

    def unobserve(self, observer: object) -> None:
        """Stop an observer added by :meth:`observe`. Raises PluginError if it does not observe."""
        self._observers.discard(observer)

    def notify(self, hook: str, **values: Any) -> None:
        """Tell every observer; an observer's error is recorded against its plugin and warned of, nothing more."""
        found, manager = self._discovered()
        plugins = {plugin.label: plugin for plugin in found.plugins}
        for implementation in (*implementations(manager, hook), *implementations(self._observers, hook)):
            try:
                call(implementation, values)
            except Exception as error:
                summary = f"its observer {hook} failed ({type(error).__name__}: {error}); the run went on without it"
                self._record(plugins.get(implementation.plugin_name), implementation.plugin_name, summary)

    def blame(self, kind: str, name: str, problem: str) -> None:
        """Record a problem with a component against those who registered it, and warn of it."""
        for component in self.catalog().components[kind].get(name, []):
            self._record(component.plugin, component.plugin.label, problem)

    def _record(self, plugin: Plugin | None, label: str, summary: str) -> None:
        if plugin is not None and all(problem.summary != summary for problem in plugin.problems):
            plugin.problems.append(Problem(summary, traceback.format_exc()))
        self._warn(f"{'observer' if plugin is None else 'plugin'} {label}: {summary}")


def _check_kind(kind: str) -> None:
    if kind not in hookspecs.KINDS:
        raise PluginError(f"there is no kind of component called {kind!r}; {did_you_mean(kind, hookspecs.KINDS)}")


def _configured(cls: Any, values: dict[str, Any], owner: str) -> Any:
    from pydantic import ValidationError

    known = cls.Config.model_fields
    for name in values:
        if name not in known:
            advice = moved_to(cls, name) or did_you_mean(name, known)
            raise ConfigError(f"{owner} has no parameter {name!r}; {advice}")
    if wrong := misplaced_truth(values, known):
        raise ConfigError(f"{owner} {wrong}")
    try:
        return cls.Config(**values)
    except ValidationError as error:
        raise ConfigError(f"{owner} {validation_problem(error)}") from error


HOST = Host()
"""The process's own host."""
