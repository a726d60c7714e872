"""Discovery of plugins and the catalog of components: names become objects here and nowhere else."""

from polyfold.plugins._catalog import Component, Plugin, Problem
from polyfold.plugins._host import (
    by_hand,
    catalog,
    component_class,
    create,
    create_chosen,
    find,
    names,
    notify,
    observe,
    portable,
    refresh,
    register,
    unobserve,
    unregister,
)
from polyfold.plugins._inspection import files_of, parameter_names, parameters, prompts_of
from polyfold.plugins.hookspecs import plural, singular

__all__ = [
    "Component",
    "Plugin",
    "Problem",
    "by_hand",
    "catalog",
    "component_class",
    "create",
    "create_chosen",
    "files_of",
    "find",
    "names",
    "notify",
    "observe",
    "parameter_names",
    "parameters",
    "plural",
    "portable",
    "prompts_of",
    "refresh",
    "register",
    "singular",
    "unobserve",
    "unregister",
]
