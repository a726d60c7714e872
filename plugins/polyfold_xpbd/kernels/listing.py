"""When near pairs are listed anew, and whose."""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.motion import is_finite
from polyfold_xpbd.kernels.near import sort_by_height
from polyfold_xpbd.kernels.pairs import list_edge_pairs, list_vertex_pairs, mark_sharp, set_aside
from polyfold_xpbd.kernels.strays import mark_around, redirect, strays
from polyfold_xpbd.kernels.vectors import compiled, copy_rows, vertex_normals

HORIZON = 16
"""Substeps for which a list of pairs looks ahead."""
NOTHING, PARTIAL, WHOLE, CROWDED, IMPOSSIBLE = 0, 1, 2, 3, -1
"""What was listed: nothing, pairs of what strayed, all, all without looking ahead, or the cloth is beyond listing."""


@compiled
def list_anew(
    x, v, normals, dt, thickness, slack, edge_length, widest, edges, corners, use, clock, listed, foreseen, sharp, bent,
    stray, order, vertices_again, edges_again, close, moved, vertex_starts, vertex_stops, edge_starts, edge_stops,
    first, second, side, over, load, old_second, old_side, old_over, old_load,
):  # fmt: skip
    """List pairs within ``thickness`` and ``slack`` [m] anew: all in time, or those of what strayed by half the slack.

    Returns:
        What was listed.
    """
    whole, elapsed, limit = clock[1] < 0 or clock[1] >= HORIZON, np.float32(clock[1]) * dt, np.float32(0.5) * slack
    if not whole and not strays(x, listed, foreseen, elapsed, limit):
        return NOTHING
    if not is_finite(x):
        return IMPOSSIBLE
    vertex_normals(x, corners, use, normals)
    reach = thickness + slack
    count = 0 if whole else redirect(x, v, listed, foreseen, elapsed, limit, stray)
    whole |= count < 0
    if whole:
        clock[1] = 0
        copy_rows(x, listed)
        copy_rows(v, foreseen)
        sort_by_height(x, thickness, order)
        mark_sharp(normals, edges, sharp, bent)
        vertices_again[:], edges_again[:], close[:] = True, True, True
    else:
        # What goes on as foreseen may be off by half the slack already.
        reach += limit
    horizon, zero = np.float32(HORIZON - clock[1]) * dt, np.float32(0.0)
    if not whole:
        mark_around(
            x, foreseen, horizon, reach, widest, corners, edges, stray, count, vertices_again, edges_again, close
        )  # fmt: skip
    set_aside(clock[3], moved, second, side, over, load, old_second, old_side, old_over, old_load)
    # What flies wildly comes near everything in that time: then there is room for what is near now, and the next
    # substep lists anew.
    crowded = False
    for ahead in (horizon, zero):
        clock[2] = list_vertex_pairs(
            x, foreseen, normals, ahead, reach, edge_length, corners, thickness, order, close, vertices_again,
            vertex_starts, vertex_stops, moved, old_second, old_side, old_over, old_load, first, second, side, over,
            load,
        )  # fmt: skip
        if clock[2] >= 0:
            break
        vertices_again[:], close[:], whole, crowded = True, True, True, True
    if clock[2] < 0:
        return IMPOSSIBLE
    for ahead in (horizon, zero):
        clock[3] = list_edge_pairs(
            x, foreseen, ahead, reach, edge_length, edges, sharp, whole, close, edges_again, edge_starts, edge_stops,
            clock[2], moved, old_second, old_side, old_over, old_load, first, second, side, over, load,
        )  # fmt: skip
        if clock[3] >= 0:
            break
        close[:], whole, crowded = True, True, True
    if clock[3] < 0:
        return IMPOSSIBLE
    return CROWDED if crowded else (WHOLE if whole else PARTIAL)
