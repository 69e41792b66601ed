"""Forward kinematics, and rotations back from positions on a skeleton of constant bones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy  # its parts are loaded with their first use

from .skeleton import SMPL22, Skeleton
from .vectors import Array, unit


def forward_kinematics(rotations: Array, root: Array, skeleton: Skeleton = SMPL22) -> Array:
    """Joint positions from local rotations.

    Args:
        rotations: (…, J, 3, 3) rotation of each joint against its parent, the root's against the world.
        root: (…, 3) world position of the root in metres.

    Returns:
        (…, J, 3) world positions in metres.
    """
    world_rotations = _by_joint(rotations, 3)
    positions = np.empty((skeleton.num_joints, *rotations.shape[:-3], 3))
    positions[0] = root
    for parent, joint in skeleton.bones:
        positions[joint] = positions[parent] + world_rotations[parent] @ skeleton.offsets[joint]
        if skeleton.children[joint]:
            world_rotations[joint] = world_rotations[parent] @ world_rotations[joint]
    return _by_frame(positions, 2)


def global_rotations(rotations: Array, bones: Sequence[tuple[int, int]] = SMPL22.bones) -> Array:
    """(…, J, 3, 3) rotations of each joint against the world from local ones; ``bones`` as :attr:`Skeleton.bones`."""
    world = _by_joint(rotations, 3)
    for parent, joint in bones:
        world[joint] = world[parent] @ world[joint]
    return _by_frame(world, 3)


def local_rotations(world: Array, bones: Sequence[tuple[int, int]] = SMPL22.bones) -> Array:
    """(…, J, 3, 3) rotations against the parent from rotations against the world."""
    local = _by_joint(world, 3)
    for parent, joint in reversed(bones):  # parents stay as they were until their children are done
        local[joint] = np.swapaxes(local[parent], -1, -2) @ local[joint]
    return _by_frame(local, 3)


def _by_joint(values: Array, place: int) -> Array:
    """A copy with the axis of the joints, the ``place``-th from the end, first: each joint's lie together."""
    return np.array(np.moveaxis(values, -place, 0), dtype=np.float64, order="C")


def _by_frame(values: Array, place: int) -> Array:
    """The other way round."""
    return np.ascontiguousarray(np.moveaxis(values, 0, -place))


def fit_rotations(positions: Array, skeleton: Skeleton = SMPL22) -> Array:
    """Local rotations whose bones point where the positions say.

    A joint with several children takes the rotation that fits them best (Kabsch); a joint with one child
    takes its parent's rotation turned the shortest way onto the bone, so twist about a bone is the least
    that the positions allow; a leaf follows its parent. Bone lengths of ``positions`` need not be the
    skeleton's: only directions are used.

    Args:
        positions: (…, J, 3) metres.

    Returns:
        (…, J, 3, 3) local rotations.
    """
    places = _by_joint(positions, 2)
    world = np.empty((*places.shape, 3))
    bones = places - places[[max(parent, 0) for parent in skeleton.parents]]  # each to its joint; the root has none
    ways, rest_ways = unit(bones), unit(skeleton.offsets)
    for joint, children in enumerate(skeleton.children):
        parent = skeleton.parents[joint]
        inherited = np.broadcast_to(np.eye(3), world.shape[1:]) if parent < 0 else world[parent]
        if not children:
            world[joint] = inherited
        elif len(children) > 1:
            world[joint] = kabsch(skeleton.offsets[list(children)], np.moveaxis(bones[list(children)], 0, -2))
        else:
            (child,) = children
            world[joint] = swing_of_units(inherited @ rest_ways[child], ways[child]) @ inherited
    return local_rotations(np.moveaxis(world, 0, -3), skeleton.bones)


def followed_rotations(positions: Array) -> Array:
    """Rotations against the world as unit quaternions that go on from frame to frame, to smooth or to interpolate.

    Where one bone leaves the twist open, it is the least from frame to frame rather than from the parent, so a limb
    that passes the rest pose's opposite does not flip; signs are chosen so that neighbours are close.

    Args:
        positions: (T, 22, 3) metres.

    Returns:
        (T, 22, 4) quaternions, the real part last. A joint without bones has the identity.
    """
    world = np.zeros((*positions.shape[:2], 3, 3)) + np.eye(3)
    single = [(joint, children[0]) for joint, children in enumerate(SMPL22.children) if len(children) == 1]
    for joint, children in enumerate(SMPL22.children):
        if len(children) > 1:
            bones = positions[:, list(children)] - positions[:, joint, None]
            world[:, joint] = kabsch(SMPL22.offsets[list(children)], bones)
    joints, ends = np.array(single).T
    bones = positions[:, ends] - positions[:, joints]
    for frame, turn in enumerate(swing(bones[:-1], bones[1:]), start=1):
        world[frame, joints] = turn @ world[frame - 1, joints]
    return quaternions(world)


def quaternions(rotations: Array) -> Array:
    """(T, …, 4) unit quaternions x y z w of (T, …, 3, 3), of two signs the one nearer to the frame before."""
    turns = scipy.spatial.transform.Rotation.from_matrix(rotations.reshape(-1, 3, 3))
    xyzw = np.asarray(turns.as_quat()).reshape(*rotations.shape[:-2], 4)
    flips = np.where(np.sum(xyzw[1:] * xyzw[:-1], axis=-1) < 0, -1.0, 1.0)
    xyzw[1:] *= np.cumprod(flips, axis=0)[..., None]
    return xyzw


def rotation_matrices(quaternions: Array) -> Array:
    """(…, 3, 3) rotations of quaternions (…, 4), x y z w, of any length but 0."""
    turns = scipy.spatial.transform.Rotation.from_quat(quaternions.reshape(-1, 4)).as_matrix()
    return np.asarray(turns).reshape(*quaternions.shape[:-1], 3, 3)


def bone_vectors(positions: Array) -> Array:
    """(…, 21, 3) the way from its parent to each joint but the root of (…, 22, 3), in the order of the joints."""
    return np.asarray(positions[..., 1:, :] - positions[..., list(SMPL22.parents[1:]), :])


def bone_lengths(positions: Array) -> Array:
    """(…, 21) metres of :func:`bone_vectors`."""
    return np.asarray(np.linalg.norm(bone_vectors(positions), axis=-1))


def chained(root: Array, bones: Array) -> Array:
    """(…, 22, 3) the other way round: a root (…, 3), and each bone (…, 21, 3) at the end of the one above."""
    places = np.empty((*bones.shape[:-2], SMPL22.num_joints, 3))
    places[..., 0, :] = root
    for parent, joint in SMPL22.bones:
        places[..., joint, :] = places[..., parent, :] + bones[..., joint - 1, :]
    return places


def project_to_skeleton(positions: Array) -> tuple[Array, Array]:
    """The nearest motion with SMPL22's own bone lengths: the same root path and bone directions.

    Args:
        positions: (…, 22, 3) metres.

    Returns:
        positions (…, 22, 3) with constant bones, and local rotations (…, 22, 3, 3).
    """
    rotations = fit_rotations(positions)
    return forward_kinematics(rotations, np.asarray(positions)[..., 0, :]), rotations


def kabsch(rest: Array, observed: Array) -> Array:
    """(…, 3, 3) rotation R that minimises Σ |R rest_i − observed_i|²; rest (C, 3), observed (…, C, 3)."""
    covariance = np.swapaxes(observed, -1, -2) @ rest
    u, _, vt = np.linalg.svd(covariance)
    sign = np.sign(np.linalg.det(u @ vt))
    u = u * np.stack([np.ones_like(sign), np.ones_like(sign), sign], axis=-1)[..., None, :]
    return u @ vt


def swing(source: Array, target: Array) -> Array:
    """(…, 3, 3) the smallest rotation that turns ``source`` onto the direction of ``target`` (…, 3)."""
    return swing_of_units(unit(source), unit(target))


def swing_of_units(source: Array, target: Array) -> Array:
    """As :func:`swing`, of unit vectors."""
    x, y, z = _cross(source, target)
    cos = np.sum(source * target, axis=-1)[..., None, None]
    # Opposite directions have no smallest rotation; any axis square to the source serves.
    opposite = cos[..., 0, 0] < -1 + 1e-8
    if opposite.any():
        helper = np.where(np.abs(source[..., :1]) < 0.9, np.array([1.0, 0, 0]), np.array([0, 1.0, 0]))
        axis = unit(np.stack(_cross(source, helper), axis=-1))
        half_turn = 2 * axis[..., :, None] * axis[..., None, :] - np.eye(3)
    skew = np.zeros((*x.shape, 3, 3))
    skew[..., 0, 1], skew[..., 0, 2], skew[..., 1, 2] = -z, y, -x
    skew -= np.swapaxes(skew, -1, -2)
    rotation = np.eye(3) + skew + skew @ skew / np.maximum(1 + cos, 1e-8)
    return np.where(opposite[..., None, None], half_turn, rotation) if opposite.any() else rotation


def _cross(first: Array, second: Array) -> tuple[Array, Array, Array]:
    """The three parts of a cross product (…, 3): NumPy's own takes longer over a few vectors than all else here."""
    a, b, c = (first[..., axis] for axis in range(3))
    d, e, f = (second[..., axis] for axis in range(3))
    return b * f - c * e, c * d - a * f, a * e - b * d
