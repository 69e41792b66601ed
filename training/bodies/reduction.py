"""A mesh of few triangles on the same surface, with edges along the seams of the clothes."""

from __future__ import annotations

import numpy as np
import trimesh

from motion.easing import smoothstep

from .clothes import seams
from .makehuman import J, Look

ZONES = ("skin", "top", "trousers", "shoes", "hair", "eyes", "whites")
"""The parts that the player colours; a face stores an index into them."""


LARGEST_HOLE = 4
"""Triangles of a patch of skin between two pieces of clothing that is a fault of the seams."""


HEADS = ((0.16, 1.7), (0.13, 1.3))
"""Metres about the middle of an adult's head and of a child's, which is large already, and how far it is blown up."""


def magnified(points: np.ndarray, joints: np.ndarray, head: tuple[float, float]) -> np.ndarray:
    """Head and hands blown up, so that reducing the mesh leaves them more triangles."""
    out = points.copy()
    for name, reach, factor in (("head", *head), ("left_wrist", 0.17, 1.5), ("right_wrist", 0.17, 1.5)):
        centre = joints[J[name]] + ([0, 0.06, 0.02] if name == "head" else 0)
        offset = points - centre
        near = 1 - smoothstep(np.linalg.norm(offset, axis=1), reach, 1.6 * reach)
        out += (factor - 1) * near[:, None] * offset
    return out


def reduced(
    vertices: np.ndarray,
    faces: np.ndarray,
    weights: np.ndarray,
    joints: np.ndarray,
    count: int,
    head: tuple[float, float],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices, faces and weights of a mesh of about ``count`` triangles on the same surface."""
    import fast_simplification

    full = trimesh.Trimesh(magnified(vertices, joints, head), faces, process=False)
    points, small = fast_simplification.simplify(full.vertices, full.faces, target_count=count, agg=3)
    _, _, face = trimesh.proximity.closest_point(full, points)
    corners = full.triangles[face]
    share = np.clip(trimesh.triangles.points_to_barycentric(corners, points), 0, 1)
    share /= share.sum(axis=1, keepdims=True)

    def carried(values: np.ndarray) -> np.ndarray:
        return np.einsum("vc,vcd->vd", share, values[faces[face]])

    return carried(vertices), small, carried(weights)


def with_seams(
    vertices: np.ndarray, faces: np.ndarray, weights: np.ndarray, joints: np.ndarray, look: Look
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Moves vertices along their edges onto the seams, so that clothes end in clean lines; zones (F,)."""
    zone = np.zeros(len(faces), dtype=np.uint8)
    for number, name in enumerate(ZONES):
        if name not in ("top", "trousers", "shoes", "hair"):
            continue
        distance = seams(vertices, weights, joints, look)[name]
        edges = np.unique(
            np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0
        )
        edges = np.concatenate([edges, edges[:, ::-1]])
        a, b = edges.T
        at = distance[a] / np.where(distance[a] == distance[b], 1, distance[a] - distance[b])
        crossing = (distance[a] * distance[b] < 0) & (at <= 0.5)
        order = np.argsort(-at[crossing])  # the nearest crossing of a vertex is written last and stays
        start, end, share = a[crossing][order], b[crossing][order], at[crossing][order][:, None]
        moved, carried = vertices.copy(), weights.copy()
        moved[start] = vertices[start] + share * (vertices[end] - vertices[start])
        carried[start] = weights[start] + share * (weights[end] - weights[start])
        distance[start] = 0
        # No triangle may turn over: where one would, its corners stay, and the seam is less straight.
        before, after = (
            np.cross(v[faces[:, 1]] - v[faces[:, 0]], v[faces[:, 2]] - v[faces[:, 0]])
            for v in (vertices, moved)
        )
        unfit = np.sum(before * after, axis=1) < 0.0 * np.linalg.norm(before, axis=1) * np.linalg.norm(
            after, axis=1
        )
        stay = np.unique(faces[unfit])
        moved[stay], carried[stay] = vertices[stay], weights[stay]
        vertices, weights = moved, carried
        zone[distance[faces].sum(axis=1) > 1e-6] = number
    return vertices, weights, without_holes(faces, zone)


def without_holes(faces: np.ndarray, zone: np.ndarray) -> np.ndarray:
    """The zones (F,) where a few triangles of skin among clothes, which lie between two seams, are clothes as well."""
    beside = trimesh.graph.face_adjacency(faces)
    filled, skin = zone.copy(), ZONES.index("skin")
    bare = beside[(zone[beside] == skin).all(axis=1)]
    for patch in trimesh.graph.connected_components(bare, nodes=np.flatnonzero(zone == skin)):
        if len(patch) <= LARGEST_HOLE:
            rim = beside[np.isin(beside, patch).sum(axis=1) == 1]
            around = zone[rim[~np.isin(rim, patch)]]
            filled[patch] = np.bincount(around).argmax() if len(around) else skin
    return filled
