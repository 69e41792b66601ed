"""Two people as formats with skeletons and skins write them: joints, their turns, and the body bound to them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion.body import Body, bone_rotations, load_body
from motion.clip import Clip, Duet
from motion.hands import FINGERS, angles
from motion.kinematics import local_rotations
from motion.looks import BODIES as COLOURS
from motion.skeleton import SIDES, SMPL22
from motion.vectors import Array

# ---- Fingers: 30 joints more below the wrists, in the order of :class:`motion.hands.Fingers` -------------------------
FINGER_JOINTS = tuple(f"{side}_{finger}{k}" for side in SIDES for finger in FINGERS for k in (1, 2, 3))
"""Their names, such as "left_index2"."""
PARENTS = tuple(
    SMPL22.index(f"{side}_wrist") if k == 0 else SMPL22.num_joints + 15 * s + 3 * f + k - 1
    for s, side in enumerate(SIDES)
    for f in range(len(FINGERS))
    for k in range(3)
)
"""The joint above each, where SMPL22's come first."""
_WRISTS = np.array([SMPL22.index(f"{side}_wrist") for side in SIDES])


def _bindings(body: Body) -> tuple[NDArray[np.integer], Array]:
    """(V, 4) joints and (V, 4) shares, with the fingers' in place of a part of the wrists'."""
    fingers = body.fingers
    count = SMPL22.num_joints
    rows = np.arange(len(fingers.vertices))[:, None]
    dense = np.zeros((len(fingers.vertices), count + 30))
    np.add.at(dense, (rows, body.bones[fingers.vertices]), body.weights[fingers.vertices])
    dense *= 1.0 - fingers.weights.sum(axis=1, keepdims=True)
    np.add.at(dense, (rows, count + fingers.bones), fingers.weights)
    order = np.argsort(-dense, axis=1, kind="stable")[:, :4]
    bones, weights = body.bones.copy(), body.weights.copy()
    bones[fingers.vertices] = order
    weights[fingers.vertices] = np.take_along_axis(dense, order, axis=1)
    return bones, weights / weights.sum(axis=1, keepdims=True)


JOINTS = (*SMPL22.joint_names, *FINGER_JOINTS)
"""SMPL22's joints, then those of the fingers."""
ABOVE = (*SMPL22.parents, *PARENTS)
"""The joint above each, -1 for the pelvis."""


@dataclass(frozen=True)
class Skinned:
    """A person of a duet; J joints are :data:`JOINTS`.

    Attributes:
        role: the person's name in the duet.
        body: the surface.
        colours: hex colour of each of its zones.
        positions: (T, 22, 3) of SMPL22's joints, metres.
        offsets: (J, 3) each joint from the one above it in T-pose; the pelvis where it begins.
        turns: (T, J, 3, 3) rotations against the joint above.
        bound_turns: (J, 3, 3) world rotations of the joints to which the surface is bound.
        bound_places: (J, 3) their places.
        weights: (V, 4) shares of the joints that move a vertex.
        bones: (V, 4) these joints; 0 where the share is 0.
    """

    role: str
    body: Body
    colours: Mapping[str, str]
    positions: Array
    offsets: Array
    turns: Array
    bound_turns: Array
    bound_places: Array
    weights: Array
    bones: NDArray[np.integer]


def skinned(duet: Duet) -> Iterator[Skinned]:
    """Both people of a duet on SMPL22."""
    now = np.arange(float(duet.num_frames))
    for person, (clip, role, look) in enumerate(zip(duet.people, duet.roles, duet.looks, strict=True)):
        shapes = angles(duet.grips, person, now, duet.fps)
        yield _skinned(clip, role, load_body(look), COLOURS[person], shapes)


def _skinned(clip: Clip, role: str, body: Body, colours: Mapping[str, str], shapes: Array) -> Skinned:
    turns, own = rigged(clip)
    joints = np.concatenate([body.joints, body.fingers.joints.reshape(30, 3)])
    wrists = np.repeat(body.turns[_WRISTS], 15, axis=0)  # fingers are bound as their wrist is
    bones, weights = _bindings(body)
    fingers = np.einsum("jik,jk->ji", wrists, joints[SMPL22.num_joints :] - joints[list(PARENTS)])
    shaped = wrists @ body.fingers.local(shapes).reshape(-1, 30, 3, 3) @ np.swapaxes(wrists, -1, -2)
    offsets = np.concatenate([own, fingers])
    offsets[0] = clip.positions[0, 0]
    return Skinned(
        role,
        body,
        colours,
        clip.positions.astype(np.float64),
        offsets,
        turns=np.concatenate([turns, shaped], axis=1),
        bound_turns=np.concatenate([body.turns, wrists]),
        bound_places=joints,
        weights=weights,
        bones=np.where(weights > 0, bones, 0),
    )


def rigged(clip: Clip) -> tuple[Array, Array]:
    """A person on a rig of their own, as every format writes them.

    Returns:
        (T, 22, 3, 3) rotations of SMPL22's joints against those above, and (22, 3) the person's own bones in T-pose,
        metres, which give the positions back: the mean of each where it changes its length.
    """
    positions = clip.positions.astype(np.float64)
    world = bone_rotations(positions)
    offsets = np.zeros((SMPL22.num_joints, 3))
    for parent, joint in SMPL22.bones:
        bones = (positions[:, joint] - positions[:, parent])[:, None] @ world[:, parent]
        offsets[joint] = bones[:, 0].mean(axis=0)
    return local_rotations(world), offsets
