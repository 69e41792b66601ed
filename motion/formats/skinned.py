"""Two people as formats with skeletons and skins write them: joints, their turns, and the body bound to them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion.body import Body, bone_rotations, load_body
from motion.clip import Clip, Duet
from motion.colours import BODIES as COLOURS
from motion.hands import angles
from motion.kinematics import local_rotations
from motion.skeleton import SMPL22

from .hand_rig import FINGER_JOINTS, PARENTS, HandRig

Array = NDArray[np.floating]

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
    positions = clip.positions.astype(np.float64)
    world = bone_rotations(positions)
    rig = HandRig.of(body)
    offsets = np.concatenate([bone_offsets(positions, world), rig.offsets])
    offsets[0] = positions[0, 0]
    return Skinned(
        role,
        body,
        colours,
        positions,
        offsets,
        turns=np.concatenate([local_rotations(world), rig.rotations(body, shapes)], axis=1),
        bound_turns=np.concatenate([body.turns, rig.turns]),
        bound_places=np.concatenate([body.joints, rig.joints]),
        weights=rig.weights,
        bones=np.where(rig.weights > 0, rig.bones, 0),
    )


def bone_offsets(positions: Array, world: Array) -> Array:
    """(22, 3) a person's own bones in T-pose, metres: the mean of each where it changes its length."""
    offsets = np.zeros((SMPL22.num_joints, 3))
    for parent, joint in SMPL22.bones:
        bones = (positions[:, joint] - positions[:, parent])[:, None] @ world[:, parent]
        offsets[joint] = bones[:, 0].mean(axis=0)
    return offsets
