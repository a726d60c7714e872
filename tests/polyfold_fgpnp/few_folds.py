"""The parameters of a small data set of real random folds."""

from polyfold_fgpnp.data.interaction import Interaction

MIX = {"uniform": 3, "slid": 1, "pair": 1, "single": 1, "vertex": 1}
FOLDS = 2 * 4 * sum(MIX.values())


def interaction(**changes):
    return Interaction(**{"seeds": (2000, 2001), "edge_length": 0.035, "mix": MIX, **changes})
