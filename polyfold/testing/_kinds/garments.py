"""What kinds of garment are held to."""

from __future__ import annotations

from collections import Counter

import numpy as np
from shapely import Point, Polygon

from polyfold import plugins
from polyfold.config import Experiment
from polyfold.plugins._fabrics import garment_template
from polyfold.testing._checks import checks
from polyfold.testing._subjects import Subject

SEEDS = range(5)
COARSE = 0.02
OFF = 0.03
"""How far a keypoint may be from the silhouette, and from itself at another edge length, in the garment's size."""


@checks("garments", "it is what it is called")
def _name(subject: Subject) -> None:
    kind = subject.make()
    names = {kind.kind, kind.template().kind, kind.generate(0, COARSE).kind}
    subject.require(names == {subject.name}, "kind", f"it calls itself {names}", f"write kind = {subject.name!r}")


@checks("garments", "its polygon is one, and its parts have names")
def _polygon(subject: Subject) -> None:
    template = subject.make().template()
    for shape in template.canonical_shapes:
        subject.require(
            Polygon(shape).is_valid, "template", "an outline crosses itself", "give its vertices in order around it"
        )
        back = template.generator.vertices(template.generator.parameters(shape * 200.0))
        off = float(np.abs(back - shape * 200.0).max())
        subject.require(
            off <= 60.0 and Polygon(back).is_valid, "template", f"its generator makes an outline {off:.0f} px off",
            "generator.vertices(generator.parameters(shape)) must come close to the canonical shape",
        )  # fmt: skip
    subject.require(
        template.parts, "template", "no part has a name, so no sentence can mean one", "give parts={'left sleeve': (…)}"
    )


@checks("garments", "a seed gives one garment, at every edge length")
def _seeded(subject: Subject) -> None:
    kind = subject.make()
    first, second, finer = kind.generate(3, COARSE), kind.generate(3, COARSE), kind.generate(3, 0.7 * COARSE)
    other = kind.generate(4, COARSE)
    subject.require(
        np.array_equal(first.mesh.vertices, second.mesh.vertices), "generate", "the same seed gives another garment",
        "draw from np.random.default_rng(seed) alone",
    )  # fmt: skip
    corners = [garment.mesh.vertices[list(garment.keypoints.values())] for garment in (first, finer)]
    off = float(np.abs(corners[0] - corners[1]).max())
    subject.require(
        off <= OFF * np.ptp(first.mesh.vertices), "generate", f"a finer mesh moves keypoints by {1000 * off:.0f} mm",
        "draw the shape before meshing, so that the edge length changes nothing of it",
    )  # fmt: skip
    counts = [len(garment.mesh.vertices) for garment in (first, finer)]
    subject.require(
        counts[0] < counts[1], "generate",
        f"it has {counts[0]} vertices at an edge length of {1000 * COARSE:.0f} mm, and {counts[1]} at "
        f"{700 * COARSE:.0f} mm",
        "mesh it at about the edge_length that generate is handed",
    )  # fmt: skip
    subject.require(
        not np.array_equal(first.mesh.vertices, other.mesh.vertices), "generate", "two seeds give the same garment",
        "let sizes depend on the seed: studies fold many garments of a kind",
    )  # fmt: skip


@checks("garments", "its mesh is a sheet that can be folded")
def _mesh(subject: Subject) -> None:
    for seed in SEEDS:
        mesh = subject.make().generate(seed, COARSE).mesh
        subject.require(np.isfinite(mesh.vertices).all(), "generate", "a vertex is not finite", "look at the outline")
        a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
        areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
        subject.require(
            (areas > 0).all(), "generate", "a triangle is clockwise or flat", "give triangles counter-clockwise, y up"
        )
        for panel in np.unique(mesh.panel):
            edges = Counter(
                tuple(sorted((int(t[k]), int(t[k - 1])))) for t in mesh.triangles[mesh.panel == panel] for k in range(3)
            )
            subject.require(
                max(edges.values()) <= 2, "generate", "more than two triangles of a panel share an edge",
                "a panel is one sheet; sew panels at shared vertices of the seam",
            )  # fmt: skip
        used = np.zeros(len(mesh.vertices), bool)
        used[mesh.triangles] = True
        subject.require(used.all(), "generate", "a vertex is in no triangle", "leave it out")


@checks("garments", "its keypoints are the polygon's vertices, on the silhouette")
def _keypoints(subject: Subject) -> None:
    for seed in SEEDS:
        garment = subject.make().generate(seed, COARSE)
        names = subject.make().template().names
        subject.require(
            set(garment.keypoints) == set(names), "generate",
            f"keypoints are {sorted(garment.keypoints)}, the template's vertices {sorted(names)}", "name them alike",
        )  # fmt: skip
        outline = Polygon(garment.mesh.vertices[garment.mesh.boundary])
        subject.require(outline.is_valid, "generate", "the silhouette crosses itself", "give mesh.boundary in order")
        corners = garment.mesh.vertices[list(garment.keypoints.values())]
        size = float(np.ptp(garment.mesh.vertices))
        off = max(outline.exterior.distance(Point(corner)) for corner in corners)
        subject.require(
            off <= OFF * size, "generate", f"a keypoint is {1000 * off:.0f} mm off the silhouette",
            "keypoints are vertices of mesh.boundary",
        )  # fmt: skip


@checks("garments", "the polygon fits what the generator makes")
def _fit(subject: Subject) -> None:
    chosen = Experiment()
    for seed in range(2):
        garment = plugins.generate_garment(subject.name, seed, COARSE)
        simulator = plugins.create_chosen(chosen, "simulator")
        seen = simulator.reset(garment, seed)
        mask = plugins.create_chosen(chosen, "segmenter").segment(seen)
        found = plugins.create_chosen(chosen, "grounding").ground(seen, mask, garment_template(subject.name))
        truth = simulator.state().keypoint_pixels()
        simulator.close()
        size = float(np.ptp(found.contour, axis=0).max())
        subject.require(
            found.residual <= 0.02 * size, "template", f"the polygon is {found.residual:.1f} px off its own garment",
            "let canonical_shapes and penalties cover what generate() makes",
        )  # fmt: skip
        places, covered = found.model.points(), subject.make().template().covered
        off = max(float(np.hypot(*(places[name] - truth[name]))) for name in places if name not in covered)
        subject.require(
            off <= 0.12 * size, "template", f"fitted to its own garment, a vertex is {off:.0f} px off",
            "penalties tell top from bottom and sides apart: see ratio_range and angle_range in polyfold.polygon",
        )  # fmt: skip
