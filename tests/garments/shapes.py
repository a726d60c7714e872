"""Shared by the garment tests: the standard kinds, and what a mesh is measured by."""

import numpy as np
from polyfold_standard.garments.pants import Pants
from polyfold_standard.garments.rectangle import Rectangle
from polyfold_standard.garments.square import Square
from polyfold_standard.garments.tshirt import TShirt

KINDS = {"square": Square(), "rectangle": Rectangle(), "tshirt": TShirt(), "pants": Pants()}


def pattern(kind):
    """How a kind is sewn."""
    return KINDS[kind].pattern


def triangle_areas(mesh):
    a, b, c = mesh.vertices[mesh.triangles].transpose(1, 0, 2)
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def smallest_angle(mesh):
    corner = mesh.vertices[mesh.triangles]
    along, back = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    cosine = (along * back).sum(-1) / np.linalg.norm(along, axis=-1) / np.linalg.norm(back, axis=-1)
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)).min())


def edges(mesh):
    """Undirected edges with the number of triangles that own each."""
    t = mesh.triangles
    directed = np.vstack([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    return np.unique(np.sort(directed, axis=1), axis=0, return_counts=True)


def rims(mesh):
    """Number of separate open rims: connected components of the edges that only one triangle owns."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    pairs, owners = edges(mesh)
    free = pairs[owners == 1]
    vertices, local = np.unique(free, return_inverse=True)
    local = local.reshape(-1, 2)
    graph = coo_matrix((np.ones(len(local)), local.T), (len(vertices), len(vertices)))
    return connected_components(graph, directed=False)[0]


def assert_sound(mesh, edge_length, least_angle=15.0, shortest=0.4):
    """What a simulator relies on."""
    assert (triangle_areas(mesh) > 0).all()
    assert smallest_angle(mesh) >= least_angle
    pairs, owners = edges(mesh)
    lengths = np.linalg.norm(np.diff(mesh.vertices[pairs], axis=1)[:, 0], axis=1) / edge_length
    assert lengths.min() > shortest
    assert lengths.max() < 1.9
    assert np.percentile(lengths, 5) > 0.7
    assert np.percentile(lengths, 95) < 1.4
    assert owners.max() <= 2, "front and back are welded along an inner edge"
    assert len(np.unique(mesh.triangles)) == len(mesh.vertices)
    assert len(np.unique(np.sort(mesh.triangles, axis=1), axis=0)) == len(mesh.triangles)
