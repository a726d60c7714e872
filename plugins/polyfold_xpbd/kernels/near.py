"""What may touch soon: boxes around primitives and where they will be, sorted into cells seen from above."""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.kernels.vectors import compiled

ROOM = 1024
"""Candidates that one vertex or edge can have."""


@compiled
def swept_boxes(x, v, horizon, corners, chosen, margin):
    """Boxes around the chosen primitives and where they will be [m], shape (K, 6): low corner, then high corner.

    Args:
        x, v: positions [m] and velocities [m/s], shape (N, 3).
        horizon: how far ahead [s].
        corners: vertices of every primitive, shape (P, C).
        chosen: numbers of primitives, shape (K,).
        margin: grows every box [m].
    """
    boxes = np.empty((chosen.shape[0], 6), np.float32)
    for k in range(chosen.shape[0]):
        for axis in range(3):
            low, high = np.float32(1e9), np.float32(-1e9)
            for c in range(corners.shape[1]):
                i = corners[chosen[k], c]
                here = x[i, axis]
                there = here + horizon * v[i, axis]
                low, high = min(low, min(here, there)), max(high, max(here, there))
            boxes[k, axis], boxes[k, axis + 3] = low - margin, high + margin
    return boxes


@compiled
def with_any(corners, marked):
    """Numbers of primitives with vertices ``corners``, shape (P, C), of which any is ``marked``, shape (N,)."""
    chosen, count = np.empty(corners.shape[0], np.int32), 0
    for k in range(corners.shape[0]):
        any_marked = False
        for c in range(corners.shape[1]):
            any_marked |= marked[corners[k, c]]
        chosen[count] = k
        count += any_marked
    return chosen[:count]


@compiled
def sort_by_cell(boxes, cell):
    """Sort boxes [m], shape (K, 6), into square cells of side ``cell`` [m] by their centres.

    Returns:
        Where each cell's members start, row by row; the members' numbers, shape (K,), and boxes, shape (6, K), in that
        order; columns and rows; and the grid's low corner and half the widest box's extents [m], shape (4,).
    """
    count, half = boxes.shape[0], np.float32(0.5)
    grid = np.array([1e9, 1e9, 0.0, 0.0], np.float32)
    high = np.array([-1e9, -1e9], np.float32)
    for k in range(count):
        for axis in range(2):
            centre = half * (boxes[k, axis] + boxes[k, axis + 3])
            grid[axis], high[axis] = min(grid[axis], centre), max(high[axis], centre)
            grid[axis + 2] = max(grid[axis + 2], half * (boxes[k, axis + 3] - boxes[k, axis]))
    columns, rows = int((high[0] - grid[0]) / cell) + 1, int((high[1] - grid[1]) / cell) + 1
    start = np.zeros(columns * rows + 1, np.int32)
    cell_of = np.empty(count, np.int32)
    for k in range(count):
        column = int((half * (boxes[k, 0] + boxes[k, 3]) - grid[0]) / cell)
        row = int((half * (boxes[k, 1] + boxes[k, 4]) - grid[1]) / cell)
        cell_of[k] = row * columns + column
        start[cell_of[k] + 1] += 1
    for c in range(columns * rows):
        start[c + 1] += start[c]
    fill = start[:-1].copy()
    members = np.empty(count, np.int32)
    in_order = np.empty((6, count), np.float32)
    for k in range(count):
        m = fill[cell_of[k]]
        fill[cell_of[k]] += 1
        members[m] = k
        for a in range(6):
            in_order[a, m] = boxes[k, a]
    return start, members, in_order, columns, rows, grid


@compiled
def gather(box, cell, start, members, in_order, columns, rows, grid, mine, asking, hits, near):
    """Numbers of the sorted boxes that meet ``box`` [m], shape (6,), into ``near``; how many.

    Of boxes that ask, too, which ``asking`` says in sorted order, shape (K,), only those sorted behind ``mine``: the
    others have found this one. ``hits``, uint8, shape (ROOM,), is overwritten.
    """
    first_column = max(0, int(np.floor((box[0] - grid[2] - grid[0]) / cell)))
    last_column = min(columns - 1, int(np.floor((box[3] + grid[2] - grid[0]) / cell)))
    first_row = max(0, int(np.floor((box[1] - grid[3] - grid[1]) / cell)))
    last_row = min(rows - 1, int(np.floor((box[4] + grid[3] - grid[1]) / cell)))
    found = 0
    words = hits.view(np.uint64)
    x0, y0, z0, x1, y1, z1 = box[0], box[1], box[2], box[3], box[4], box[5]
    for row in range(first_row, last_row + 1):
        last = start[row * columns + last_column + 1]
        for begin in range(start[row * columns + first_column], last, ROOM):
            # First without branches, side by side: this loop sees most of the work. Then eight at a time: most are far.
            count = min(last - begin, ROOM)
            stop = begin + count
            low_x, low_y, low_z = in_order[0, begin:stop], in_order[1, begin:stop], in_order[2, begin:stop]
            high_x, high_y, high_z = in_order[3, begin:stop], in_order[4, begin:stop], in_order[5, begin:stop]
            for m in range(count):
                hits[m] = (
                    (low_x[m] <= x1) & (high_x[m] >= x0) & (low_y[m] <= y1) & (high_y[m] >= y0)
                    & (low_z[m] <= z1) & (high_z[m] >= z0)
                )  # fmt: skip
            for word in range((count + 7) // 8):
                if words[word] == 0:
                    continue
                for m in range(8 * word, min(8 * word + 8, count)):
                    near[found] = members[begin + m]
                    found = min(found + (hits[m] & ((begin + m > mine) | ~asking[begin + m])), ROOM - 1)
    return found


@compiled
def sort_by_height(x, step, order):
    """Put vertices at ``x`` [m], shape (N, 3), into ``order``, shape (N,), bin by bin of ``step`` [m] up the table."""
    bins = 512
    start = np.zeros(bins + 1, np.int32)
    inverse = np.float32(1.0) / step
    for i in range(x.shape[0]):
        start[min(bins - 1, max(0, int(x[i, 2] * inverse))) + 1] += 1
    for b in range(bins):
        start[b + 1] += start[b]
    for i in range(x.shape[0]):
        b = min(bins - 1, max(0, int(x[i, 2] * inverse)))
        order[start[b]] = i
        start[b] += 1
