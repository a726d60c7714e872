"""The loop over substeps, the one kernel that the solver calls."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from polyfold_xpbd.ahead.calling import ahead, digest
from polyfold_xpbd.compiling import kept
from polyfold_xpbd.kernels.contact import resolve, table, warm_start
from polyfold_xpbd.kernels.guarantee.apart import keep_apart
from polyfold_xpbd.kernels.guarantee.close import Watch
from polyfold_xpbd.kernels.listing import CROWDED, HORIZON, IMPOSSIBLE, PARTIAL, WHOLE, list_anew
from polyfold_xpbd.kernels.motion import carry, damp, is_finite, predict, rests, velocities
from polyfold_xpbd.kernels.sheet import bend, crease, hold_back, let_go, limit_strain, stretch
from polyfold_xpbd.kernels.touching import find_edge_contacts, find_vertex_contacts, keep_contacts

RUNNING, SETTLED, DIVERGED = 0, 1, 2
LOOK_EVERY = 8
"""Substeps between looks at which listed pairs touch, where and which way."""
LIMIT = 0.15
"""Strain that no edge keeps. Cloth is stretched by a tenth at most in use (Provot 1995), knits by more."""
BEFORE_CONTACTS, AFTER_CONTACTS = 16, 4
"""Looks for edges beyond the limit in a substep: contacts may pull some out again, and are not to be undone."""
STRETCHED = 1.5
"""Edges are taken to be no longer than the longest at rest by this factor.

What is stretched farther may be listed as late as with the whole list.
"""
REST_OVER = 40
"""Substeps over which the cloth is watched for rest."""


def _kept_under(sources: str) -> Callable[..., tuple[int, int]]:
    """The loop, whose machine code is kept on disk under a digest: numba's key holds what a function closes over."""

    @kept
    def advance(
        x, v, previous, start, mobility, normals, edges, rest_lengths, hinges, hinge_weights, elastic, set_curvature,
        rest, corners, panel, use, clock, listed, foreseen, rested, sharp, stray, order,
        vertices_again, edges_again, close, moved, vertex_starts, vertex_stops, edge_starts,
        edge_stops, first, second, side, over, load, old_second, old_side, old_over, old_load, bodies, weights,
        responses, contact_normals, inverse, source, table_load, grasped, offsets, arm, directions, path, turns, tied,
        anchors, lengths, lightness, bears, watch, begin, end, settings, damping, rest_speed,
    ):  # fmt: skip
        """Run substeps ``begin`` to ``end`` in place; stop once the cloth is slower than ``rest_speed`` [m/s], if > 0.

        Args (beyond the model's arrays and the state's buffers):
            clock: substeps since the stage began and since the list of pairs was made, its vertex pairs, all its pairs,
                the contacts in use, and substeps in which the grippers stood still, int64, shape (6,).
            settings: time step [s], thickness, slack and cell [m], friction of table and cloth, recovery [m] and top
                speed [m/s], share of a crease that stays, lead of bending [s], mean normal of a bend, shape (11,).
            lightness: inverse masses where nothing is held, as shares of the mean's, shape (N,).
            bears: strain of any edge at which the grippers stand still, and of an edge at a grip at which what is held
                slips out of it, shape (2,).
            watch: the arrays of a :class:`Watch`; None guarantees nothing. A class in the signature would be in numba's
                cache, and numba 0.68 loads even a stale one: moved or renamed, it could not be imported.

        Returns:
            (status, substeps done).
        """
        sources  # noqa: B018  # pyright: ignore[reportUnusedExpression]  (closed over, for numba's key)
        dt, thickness, slack, cell = settings[0], settings[1], settings[2], settings[3]
        table_friction, cloth_friction, recovery, fastest = settings[4], settings[5], settings[6], settings[7]
        inverse_dt = np.float32(1.0) / dt
        floor = np.float32(0.5) * thickness
        window = np.float32(LOOK_EVERY) * dt
        widest = np.float32(STRETCHED) * rest_lengths.max()
        for k in range(begin, end):
            # Looked ahead before bending acts: contacts take back most of what it adds, which is no travel to foresee.
            listing = list_anew(
                x, v, normals, dt, thickness, slack, cell, widest, edges, corners, use, clock, listed, foreseen, sharp,
                settings[10], stray, order, vertices_again, edges_again, close, moved, vertex_starts, vertex_stops,
                edge_starts, edge_stops, first, second, side, over, load, old_second, old_side, old_over, old_load,
            )  # fmt: skip
            if listing == IMPOSSIBLE:
                return DIVERGED, k
            if clock[1] % LOOK_EVERY == 0:
                crease(x, hinges, hinge_weights, elastic, settings[8], set_curvature, rest)
            if clock[1] % LOOK_EVERY == 0 or listing in (WHOLE, CROWDED):
                clock[4] = find_vertex_contacts(
                    x, v, window, mobility, corners, panel, thickness, 0, clock[2], 0, first, second, side, over, load,
                    bodies, weights, responses, contact_normals, inverse, source,
                )  # fmt: skip
                clock[4] = find_edge_contacts(
                    x, v, window, mobility, edges, thickness, clock[2], clock[3], clock[4], first, second, side, over,
                    load, bodies, weights, responses, contact_normals, inverse, source,
                )  # fmt: skip
            elif listing == PARTIAL:
                clock[4] = keep_contacts(
                    clock[4], moved, bodies, weights, responses, contact_normals, inverse, source
                )  # fmt: skip
                for i in order:
                    if vertices_again[i]:
                        clock[4] = find_vertex_contacts(
                            x, v, window, mobility, corners, panel, thickness, vertex_starts[i], vertex_stops[i],
                            clock[4], first, second, side, over, load, bodies, weights, responses, contact_normals,
                            inverse, source,
                        )  # fmt: skip
                for e in range(edges.shape[0]):
                    if edges_again[e]:
                        clock[4] = find_edge_contacts(
                            x, v, window, mobility, edges, thickness, edge_starts[e], edge_stops[e], clock[4], first,
                            second, side, over, load, bodies, weights, responses, contact_normals, inverse, source,
                        )  # fmt: skip
            damp(v, dt, damping)
            bend(x, v, mobility, previous, hinges, hinge_weights, rest, settings[9], dt)
            clock[0] += 1
            clock[1] = HORIZON if listing == CROWDED else clock[1] + 1
            predict(x, v, previous, start, mobility, dt, fastest)
            if grasped.shape[0] > 0:
                if let_go(x, mobility, lightness, edges, rest_lengths, bears[1]) > bears[0] and clock[5] < k:
                    clock[5] += 1
                carry(x, mobility, grasped, offsets, arm, directions, path, turns, k - clock[5], fastest * dt)
            fall = np.float32(9.81) * dt * dt
            warm_start(x, mobility, clock[4], bodies, responses, contact_normals, source, load, table_load, fall)
            if grasped.shape[0] > 0:
                hold_back(x, mobility, tied, anchors, lengths)
            stretch(x, mobility, edges, rest_lengths)
            limit_strain(x, mobility, edges, rest_lengths, np.float32(LIMIT), BEFORE_CONTACTS)
            resolve(
                x, previous, clock[4], bodies, weights, responses, contact_normals, inverse, source, load, thickness,
                cloth_friction, recovery,
            )  # fmt: skip
            limit_strain(x, mobility, edges, rest_lengths, np.float32(LIMIT), AFTER_CONTACTS)
            table(x, previous, mobility, table_load, floor, table_friction)
            parted = True
            if watch is not None:
                parted = keep_apart(x, start, dt, thickness, cell, corners, edges, mobility, Watch(*watch))
            if not parted:
                return DIVERGED, k
            velocities(x, previous, start, v, inverse_dt)
            if rest_speed > 0 and clock[0] % REST_OVER == 0:
                slow = rests(x, rested, np.float32(REST_OVER) * dt * rest_speed)
                if slow and clock[0] > REST_OVER:
                    return SETTLED, k + 1
        return (RUNNING if is_finite(x) else DIVERGED), end

    return advance


advance = ahead("advance", _kept_under(digest()))
