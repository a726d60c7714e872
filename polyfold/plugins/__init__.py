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

__all__ = [
    "Component",
    "Plugin",
    "Problem",
    "by_hand",
    "catalog",
    "component_class",
    "create",
    "create_chosen",
    "find",
    "names",
    "notify",
    "observe",
    "portable",
    "refresh",
    "register",
    "unobserve",
    "unregister",
]
