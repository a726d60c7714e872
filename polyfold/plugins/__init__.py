"""Discovery of plugins and the catalog of components: names become objects here and nowhere else.

What each kind of component must do stands in :mod:`polyfold.plugins.interfaces`, how to register one and how to watch
runs in :mod:`polyfold.plugins.hookspecs`. The functions here are the methods of the process's own host;
:func:`generate_garment` and :func:`make_fabric` ask it for garments with their fabric.
"""

from polyfold.plugins._fabrics import generate_garment, make_fabric
from polyfold.plugins._host import HOST

blame = HOST.blame
by_hand = HOST.by_hand
catalog = HOST.catalog
component_class = HOST.component_class
configured = HOST.configured
create = HOST.create
create_chosen = HOST.create_chosen
find = HOST.find
names = HOST.names
notify = HOST.notify
observe = HOST.observe
portable = HOST.portable
receive = HOST.receive
refresh = HOST.refresh
register = HOST.register
third_party = HOST.third_party
unobserve = HOST.unobserve
unregister = HOST.unregister

__all__ = [
    "catalog",
    "component_class",
    "create",
    "create_chosen",
    "find",
    "generate_garment",
    "make_fabric",
    "names",
    "observe",
    "refresh",
    "register",
    "unobserve",
    "unregister",
]
