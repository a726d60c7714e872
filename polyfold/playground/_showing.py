"""How a playground shows itself: a widget where Jupyter has the means, beside a still picture for where it has not."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

from polyfold.playground._picture import still
from polyfold.playground._playground import Playground
from polyfold.types._views import makes
from polyfold.viz import png


@makes(Playground, "mimebundle")
def mimebundle(playground: Playground, options: dict[str, Any]) -> dict[str, Any]:
    """What IPython is given to choose from: media type -> content."""
    bundle: dict[str, Any] = {"image/png": png(still(playground)), "text/plain": repr(playground)}
    if find_spec("anywidget") is None:
        return bundle
    from polyfold.playground._widget import PlaygroundWidget

    if playground.widget is None:
        playground.widget = PlaygroundWidget(playground)
    playground.widget.show()
    shown = playground.widget._repr_mimebundle_(**options)
    return bundle if shown is None else {**shown[0], **bundle}
