"""Clothes, shoes, hair and eyes: where they end, and the surface over the body."""

from __future__ import annotations

import numpy as np
import trimesh
from scipy.sparse import coo_matrix, csr_matrix, diags
from scipy.spatial import cKDTree

from motion.easing import smoothstep

from .makehuman import J, Look, MakeHuman

WAIST = 0.985
"""Where the top ends, metres above the floor in the pose of binding."""
EYE_AHEAD = 0.0017
"""Metres by which eyes are before those of MakeHuman, whose lids the reduction closes a little."""
EYE_CORNERS = 10
"""Corners of the edge of an iris."""
IRIS, SHOWN = np.radians([25.0, 72.0])
"""Angles about an eye's axis up to which it is iris, larger than a person's so that it is seen, and up to which it is
made."""
FRINGE = 0.055
"""Metres from the joint of a child's head to the hair over the forehead, of which an adult has less."""


def seams(points: np.ndarray, weights: np.ndarray, joints: np.ndarray, look: Look) -> dict[str, np.ndarray]:
    """Signed distances (V,) in metres, positive inside each piece of clothing and the hair."""
    x, y, z = points.T
    arm, hand = np.full(len(points), 9.0), np.zeros(len(points), dtype=bool)
    for s in ("left", "right"):
        shoulder, elbow, wrist = (joints[J[f"{s}_{n}"]] for n in ("shoulder", "elbow", "wrist"))
        on_arm = weights[:, [J[f"{s}_{n}"] for n in ("shoulder", "elbow", "wrist")]].sum(axis=1) > 0.5
        start, end, share = (
            (shoulder, elbow, look.sleeve) if look.sleeve < 1 else (elbow, wrist, look.sleeve - 1)
        )
        length = np.linalg.norm(end - start)
        arm = np.where(on_arm, share * length - (points - start) @ (end - start) / length, arm)
        hand |= on_arm
    # The collar is a ring about the neck, lower in front.
    ring = np.hypot(x, 1.15 * (z + 0.045)) - look.collar
    ring += 1.2 * np.maximum(0, 1.45 - y)
    neckline = np.minimum(ring, 1.515 - y - 0.75 * (z + 0.05))
    head = joints[J["head"]]
    back = (points - head) @ np.array([0, 0.62, -0.785])
    hairline = (
        back
        - (FRINGE if look.age == "child" else 0.062 if look.sex == "male" else 0.056)
        + 0.10 * np.abs(x)
        - 0.35 * np.maximum(0, 0.03 - (y - head[1]))
    )
    return {
        "cloth": np.where(hand, arm, np.minimum(neckline, y - look.hem)),
        "top": np.minimum(np.minimum(arm, neckline), np.where(hand, 9.0, y - WAIST)),
        "trousers": np.where(hand, -9.0, np.minimum(WAIST - y, y - look.hem)),
        "shoes": np.where(hand, -9.0, 0.075 - y),
        "hair": np.where(y > head[1] - 0.09, hairline, -0.2),
    }


def dressed(
    vertices: np.ndarray, faces: np.ndarray, weights: np.ndarray, joints: np.ndarray, look: Look
) -> np.ndarray:
    """The vertices with cloth over them: smoothed where it hangs, raised along the normals."""
    cover = seams(vertices, weights, joints, look)
    inside = {name: smoothstep(d, 0.0, 0.012) for name, d in cover.items()}
    flat = vertices.copy()
    step = neighbours(faces, len(vertices))
    chest = smoothstep(flat[:, 1], 1.1, 1.2) * (np.abs(flat[:, 0]) < 0.2)
    for round_ in range(30 if look.sex == "male" else 90):
        amount = 0.6 * inside["cloth"] * (1.0 if round_ < 20 else chest)
        flat += amount[:, None] * (step @ flat - flat)
    mesh = trimesh.Trimesh(flat, faces, process=False)
    raise_ = 0.005 * inside["cloth"] + 0.002 * inside["trousers"]
    raise_ += (0.010 if look.sex == "male" else 0.014) * smoothstep(cover["hair"], 0, 0.03)
    return flat + raise_[:, None] * mesh.vertex_normals


def neighbours(faces: np.ndarray, count: int) -> csr_matrix:
    """(V, V) sparse: the mean of each vertex' neighbours."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = np.concatenate([edges, edges[:, ::-1]])
    matrix = coo_matrix((np.ones(len(edges)), edges.T), shape=(count, count)).tocsr()
    matrix.data[:] = 1
    return diags(1 / np.maximum(np.asarray(matrix.sum(axis=1)).ravel(), 1)) @ matrix


def shoes(body: np.ndarray, weights: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Both shoes, the hulls of the feet: vertices, faces and weights."""
    parts, faces, carried = [], [], []
    for side in (1, -1):
        foot = np.nonzero((body[:, 1] < 0.074) & (side * body[:, 0] > 0))[0]
        centre = body[foot].mean(axis=0)
        hull = trimesh.convex.convex_hull((body[foot] - centre) * [1.08, 1.0, 1.03] + centre)
        hull = hull.subdivide_to_size(0.02)
        hull = trimesh.smoothing.filter_laplacian(hull, lamb=0.4, iterations=6)
        hull = hull.simplify_quadric_decimation(face_count=count)
        points = hull.vertices.copy()
        points[:, 1] = np.where(points[:, 1] < 0.016, 0.0, points[:, 1])
        _, near = cKDTree(body[foot]).query(points, k=6)
        faces.append(hull.faces + sum(map(len, parts)))
        parts.append(points)
        carried.append(weights[foot][near].mean(axis=1))
    return np.concatenate(parts), np.concatenate(faces), np.concatenate(carried)


def eyes(mh: MakeHuman, vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The part of both eyeballs that shows, a little forward, looking ahead.

    Returns:
        vertices, left eye first, faces, for each face whether it is of the white, and both middles (2, 3).
    """
    parts, faces, white, middles = [], [], [], []
    around = 2 * np.pi * np.arange(EYE_CORNERS) / EYE_CORNERS
    ring, after = np.arange(EYE_CORNERS), (np.arange(EYE_CORNERS) + 1) % EYE_CORNERS
    for side in ("l", "r"):
        ball = vertices[mh.used(f"helper-{side}-eye")]
        centre, radius = ball.mean(axis=0), np.ptp(ball[:, 0]) / 2
        rows = [np.array([[0.0, 0.0, 1.0]])]
        rows += [
            np.stack(
                [np.cos(around) * np.sin(edge), np.sin(around) * np.sin(edge), np.cos(edge) + 0 * around],
                axis=1,
            )
            for edge in (IRIS, SHOWN)
        ]
        first = sum(map(len, parts))
        inner, outer = first + 1, first + 1 + EYE_CORNERS
        cells = [
            np.stack([first + 0 * ring, inner + ring, inner + after], axis=1),
            np.stack([inner + ring, outer + ring, outer + after], axis=1),
            np.stack([inner + ring, outer + after, inner + after], axis=1),
        ]
        faces += cells
        white += [np.zeros(len(cells[0]), dtype=bool), np.ones(2 * EYE_CORNERS, dtype=bool)]
        middles.append(centre + np.array([0, 0, EYE_AHEAD]))
        parts.append(radius * np.concatenate(rows) * [0.92, 0.92, 1.0] + middles[-1])
    return np.concatenate(parts), np.concatenate(faces), np.concatenate(white), np.array(middles)


def tied(kind: str, joints: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of hair that is tied at the back of the head: a bun, or a pony tail at a child's."""
    ball = trimesh.creation.icosphere(2, 1.0)
    if kind == "bun":
        return ball.vertices * [0.047, 0.043, 0.040] + joints[J["head"]] + [0, 0.085, -0.115], ball.faces
    points = ball.vertices * [0.034, 0.095, 0.034]
    points[:, [0, 2]] *= 1.0 + 2.2 * points[:, 1:2]  # it narrows downwards
    tilt = np.radians(14.0)
    across = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    return points @ across.T + joints[J["head"]] + [0, 0.045, -0.175], ball.faces
