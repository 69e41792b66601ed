"""Sight: what a person's face points to, along a ray from between the eyes.

trimesh's own ``ray`` needs rtree or embree, which are no requirements of ours. The things of a scene have a few
triangles each, so every triangle is tried, with trimesh's plane and barycentric functions. A thing counts with its
hull: who looks through a window looks at it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from motion.body import bone_rotations
from motion.skeleton import SMPL22
from motion.vectors import Array

from .thing import Mesh, Thing

if TYPE_CHECKING:
    from trimesh import Trimesh


EYES = np.array([0.0, 0.07, 0.1])
"""Metres from the joint of the head to between the eyes, in the head's frame."""
ROUND = 0.1
"""Metres of flesh about the joints of a person who stands in the way."""
FARTHEST = 8.0
"""Metres beyond which nothing is looked at."""
_HEAD = SMPL22.index("head")


def gazes(positions: Array) -> tuple[Array, Array]:
    """The eyes (T, 3) of a person (T, 22, 3) and the directions (T, 3) in which the face points."""
    turned = bone_rotations(np.asarray(positions, dtype=np.float64))[:, _HEAD]
    return positions[:, _HEAD] + turned @ EYES, turned @ np.array([0.0, 0.0, 1.0])


def distance(surface: Trimesh, eye: Array, ahead: Array) -> float:
    """Metres along a ray to where it meets a surface; infinite where it does not."""
    from trimesh.intersections import planes_lines
    from trimesh.triangles import points_to_barycentric

    corners, count = surface.triangles, len(surface.faces)
    points, on, along = planes_lines(
        corners[:, 0], surface.face_normals, np.tile(eye, (count, 1)), np.tile(ahead, (count, 1)), return_distance=True
    )
    inside = (points_to_barycentric(corners[on], points) > -1e-9).all(axis=1) & (along > 1e-9)
    return float(along[inside].min(initial=np.inf))


def looked_at(things: Sequence[Thing], person: Array, other: Array) -> NDArray[np.integer]:
    """The number of the thing that a person's face points to in each frame.

    Args:
        things: beside them.
        person: (T, 22, 3) metres, who looks.
        other: (T, 22, 3) metres, who may be in the way.

    Returns:
        (T,) an index into ``things``, ``len(things)`` for the other person, and -1 for nothing.
    """
    eyes, ways = gazes(person)
    found = np.full(len(person), -1)
    for frame, (eye, ahead) in enumerate(zip(eyes, ways, strict=True)):
        far = []
        for thing in things:  # a thing is met in its own frame
            turned, place = thing.rotations[frame].astype(np.float64), thing.places[frame].astype(np.float64)
            far.append(distance(_hull(thing.mesh), (eye - place) @ turned, ahead @ turned))
        far.append(distance(_body(other[frame]), eye, ahead))
        nearest = int(np.argmin(far))
        if far[nearest] <= FARTHEST:
            found[frame] = nearest
    return found


@lru_cache(maxsize=64)
def _hull(mesh: Mesh) -> Trimesh:
    import trimesh

    return trimesh.Trimesh(mesh.vertices, mesh.faces).convex_hull


def _body(pose: Array) -> Trimesh:
    """The hull of a person (22, 3)."""
    import trimesh

    about = ROUND * np.concatenate([np.eye(3), -np.eye(3)])
    return trimesh.convex.convex_hull((pose[:, None] + about).reshape(-1, 3))
