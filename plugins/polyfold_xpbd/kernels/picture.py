"""The compiled renderer: triangles with depth, and samples averaged to pixels."""

from __future__ import annotations

import numpy as np

from polyfold_xpbd.compiling import kept


@kept
def rasterise(screen, normals, triangles, outside_up, colours, depth, shade):
    """Draw triangles into ``depth`` [m], shape (H, W), and ``shade``, shape (H, W, 3), where they are nearer.

    Args:
        screen: columns, rows and distances [m] of the particles, shape (N, 3).
        normals: unit normals of the particles, shape (N, 3).
        triangles: vertex indices, shape (T, 3).
        outside_up: whether a triangle's counter-clockwise side is the garment's outside, shape (T,).
        colours: outside and inside colour, RGB, shape (2, 3).
        depth, shade: changed.
    """
    height, width = depth.shape
    one, zero = np.float32(1.0), np.float32(0.0)
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay, bx, by, cx, cy = screen[a, 0], screen[a, 1], screen[b, 0], screen[b, 1], screen[c, 0], screen[c, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if abs(area) < np.float32(1e-6):
            continue
        # y points down on the screen, so a counter-clockwise triangle seen from above has a negative area here.
        colour = colours[0] if (area < zero) == outside_up[t] else colours[1]
        inverse = one / area
        left, right = max(0, int(np.ceil(min(ax, bx, cx)))), min(width - 1, int(np.floor(max(ax, bx, cx))))
        top, bottom = max(0, int(np.ceil(min(ay, by, cy)))), min(height - 1, int(np.floor(max(ay, by, cy))))
        for y in range(top, bottom + 1):
            py = np.float32(y)
            for x in range(left, right + 1):
                px = np.float32(x)
                wb = ((px - ax) * (cy - ay) - (py - ay) * (cx - ax)) * inverse
                wc = ((bx - ax) * (py - ay) - (by - ay) * (px - ax)) * inverse
                wa = one - wb - wc
                if wa < zero or wb < zero or wc < zero:
                    continue
                z = wa * screen[a, 2] + wb * screen[b, 2] + wc * screen[c, 2]
                if z >= depth[y, x]:
                    continue
                depth[y, x] = z
                nx = wa * normals[a, 0] + wb * normals[b, 0] + wc * normals[c, 0]
                ny = wa * normals[a, 1] + wb * normals[b, 1] + wc * normals[c, 1]
                nz = wa * normals[a, 2] + wb * normals[b, 2] + wc * normals[c, 2]
                length = np.sqrt(nx * nx + ny * ny + nz * nz) + np.float32(1e-9)
                facing = np.float32(-0.35) * nx + np.float32(0.40) * ny + np.float32(0.847) * nz
                if nz < zero:
                    facing = -facing
                light = np.float32(0.62) + np.float32(0.42) * max(zero, facing / length)
                for k in range(3):
                    shade[y, x, k] = min(np.float32(255.0), light * colour[k])


@kept
def average(depth, shade, table, rgb, out):
    """Mean of the samples of each pixel, darkened under the edge of a higher layer; depth of the cloth's samples."""
    height, width = out.shape
    near = np.float32(0.003)
    for y in range(height):
        for x in range(width):
            red, green, blue = np.float32(0.0), np.float32(0.0), np.float32(0.0)
            cloth, total = 0, np.float32(0.0)
            for v in range(2):
                for u in range(2):
                    yy, xx = 2 * y + v, 2 * x + u
                    z = depth[yy, xx]
                    dim = np.float32(1.0)
                    if z < table:
                        cloth += 1
                        total += z
                        step = np.float32(0.0)
                        for r in range(1, 6, 2):
                            if yy >= r:
                                step = max(step, z - depth[yy - r, xx])
                            if yy + r < 2 * height:
                                step = max(step, z - depth[yy + r, xx])
                            if xx >= r:
                                step = max(step, z - depth[yy, xx - r])
                            if xx + r < 2 * width:
                                step = max(step, z - depth[yy, xx + r])
                        if step > near:
                            dim = np.float32(0.84)
                    red += dim * shade[yy, xx, 0]
                    green += dim * shade[yy, xx, 1]
                    blue += dim * shade[yy, xx, 2]
            rgb[y, x, 0] = np.uint8(red * np.float32(0.25) + np.float32(0.5))
            rgb[y, x, 1] = np.uint8(green * np.float32(0.25) + np.float32(0.5))
            rgb[y, x, 2] = np.uint8(blue * np.float32(0.25) + np.float32(0.5))
            out[y, x] = total / np.float32(cloth) if cloth >= 2 else table
