"""A person's pose on a rig of any make, once it is known how each of its joints is turned beside the body's."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

import numpy as np
from numpy.typing import NDArray

from motion.body import bone_rotations
from motion.clip import Clip
from motion.kinematics import swing
from motion.limbs import solve_two_bones
from motion.retarget import leg_scale
from motion.rigs import RigMotion, match_joints
from motion.skeleton import SMPL22
from motion.vectors import unit

Array = NDArray[np.floating]

_NEXT = {"collar": "shoulder", "shoulder": "elbow", "elbow": "wrist", "hip": "knee", "knee": "ankle", "ankle": "foot"}


def posed(
    rig: RigMotion, bones: Array, clip: Clip, pairs: Mapping[int, int], constants: Mapping[int, Array], usual: Array
) -> Array:
    """Rotations of a rig's joints in a person's pose, whose limbs point exactly where the person's do.

    Args:
        rig: whose joints.
        bones: (J, 3) from the parent to each joint, in the parent's axes.
        clip: on SMPL22.
        pairs: the joint of SMPL22 beside a joint of the rig.
        constants: (3, 3) rotation of each of those beside the body's.
        usual: (J, 3, 3) local rotations of the others, such as fingers; a root's counts from the world.

    Returns:
        (T, J, 3, 3) world rotations, Y up.
    """
    positions = clip.positions.astype(np.float64)
    body = bone_rotations(positions)
    world = np.empty((len(positions), len(rig.parents), 3, 3))
    by_name = {SMPL22.joint_names[ours]: joint for joint, ours in pairs.items()}
    for joint, parent in enumerate(rig.parents):
        if joint not in pairs:
            world[:, joint] = world[:, parent] @ usual[joint] if parent >= 0 else usual[joint]
            continue
        world[:, joint] = body[:, pairs[joint]] @ constants[joint]
        side, _, part = SMPL22.joint_names[pairs[joint]].rpartition("_")
        after = by_name.get(f"{side}_{_NEXT.get(part)}")
        if after is None or rig.parents[after] != joint or np.linalg.norm(bones[after]) < 1e-4:
            continue
        bone = world[:, joint] @ (bones[after] / np.linalg.norm(bones[after]))
        wanted = unit(positions[:, pairs[after]] - positions[:, pairs[joint]])
        world[:, joint] = swing(bone, wanted) @ world[:, joint]
    return world


def reached(
    rig: RigMotion,
    bones: Array,
    clip: Clip,
    pairs: Mapping[int, int],
    usual: Array,
    world: Array,
    lift: float,
    near: Mapping[str, Array],
) -> Array:
    """The rotations of :func:`posed` with wrists where the person's are; hands stay as turned as they were.

    Args:
        rig, bones, clip, pairs, usual: as for :func:`posed`.
        world: (T, J, 3, 3) as it gives them.
        lift: as for :func:`root_path`.
        near: (T,) share of the way that each wrist goes there, 0 to 1, by side.

    Returns:
        (T, J, 3, 3) world rotations, Y up.
    """
    path = root_path(rig, bones, clip, world, lift)
    places = _placed(rig, bones, world) + path[:, None]
    parts, world = match_joints(rig), np.array(world)
    for side, limb in (("left", parts.left), ("right", parts.right)):
        chain = cast(list[int], [limb[part] for part in ("shoulder", "elbow", "wrist")])
        shoulder, elbow, wrist = (places[:, joint] for joint in chain)
        goal = clip.positions[:, SMPL22.index(f"{side}_wrist")] + np.array([0.0, lift, 0.0])
        share = near[side][:, None]
        goal = wrist + share * (goal / leg_scale(rig) - wrist)
        bent, end = solve_two_bones(shoulder, elbow, wrist, goal, np.array([0.0, -1.0, 0.0]))
        upper = swing(unit(elbow - shoulder), unit(bent - shoulder))
        forearm = np.einsum("tij,tj->ti", upper, wrist - elbow)
        lower = swing(unit(forearm), unit(end - bent)) @ upper
        world[:, chain[0]] = upper @ world[:, chain[0]]
        world[:, chain[1]] = lower @ world[:, chain[1]]
    for joint, parent in enumerate(rig.parents):
        if joint not in pairs and parent >= 0:
            world[:, joint] = world[:, parent] @ usual[joint]
    return world


def _placed(rig: RigMotion, bones: Array, world: Array) -> Array:
    """(T, J, 3) places of the joints with their roots at the origin."""
    places = np.zeros((len(world), len(rig.parents), 3))
    for joint, parent in enumerate(rig.parents):
        if parent >= 0:
            places[:, joint] = places[:, parent] + world[:, parent] @ bones[joint]
    return places


def root_path(rig: RigMotion, bones: Array, clip: Clip, world: Array, lift: float) -> Array:
    """(T, 3) metres, Y up, where the root of the body is, so that the hips are where the person's are.

    Args:
        rig, bones, clip: as for :func:`posed`.
        world: as it gives them.
        lift: metres by which the person stands above the floor at 0.
    """
    places = _placed(rig, bones, world)
    parts = match_joints(rig)
    hips = cast(list[int], [parts.left["hip"], parts.right["hip"]])  # found, or match_joints had raised
    ours = [SMPL22.index("left_hip"), SMPL22.index("right_hip")]
    middle = clip.positions[:, ours].astype(np.float64).mean(axis=1) + np.array([0.0, lift, 0.0])
    found: Array = middle / leg_scale(rig) - places[:, hips].mean(axis=1)
    return found
