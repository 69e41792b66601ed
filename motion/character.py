"""Uploaded characters as bodies: a skinned mesh of any humanoid rig, brought onto SMPL22's T-pose.

The rig's joints are found as those of a motion file are, its pose of binding is read as a motion of one frame, and the
surface is moved once into SMPL22's T-pose, each part stretched along its bone to SMPL22's length. From then on it is a
:class:`~motion.body.Body` like those that ship: drawn, filmed and exported in the same ways. Joints that SMPL22 lacks,
such as fingers, move with the nearest one above them that it has.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .body import Body, bone_rotations, in_base64
from .errors import InputError
from .formats.glb_reader import Character
from .kinematics import swing
from .retarget import leg_scale, retarget, up_rotation
from .rigs import RigMotion, pairs_of
from .skeleton import SMPL22

Array = NDArray[np.floating]

ZONE = "character"
"""The only zone of a character's surface: it is tinted in its person's colour."""
MOST_DRAWN = 12_000
"""Vertices that a character keeps; a finer mesh is made coarser."""
_STRETCH = (0.4, 2.5)
_FOOT_STRETCH = (0.2, 2.5)
"""Soles lie between 2.5 and 30 cm under the ankle."""
_LEVEL = np.array([1.0, 0.0, 1.0])
_LARGEST = 3.0
"""Metres from the pelvis beyond which a part of the mesh is no part of a person."""
_REST = SMPL22.rest_positions()


def _named(*names: str) -> list[int]:
    return [SMPL22.index(name) for name in names]


_TRUNK = _named("pelvis", "spine1", "spine2", "spine3", "neck", "head", "left_collar", "right_collar")
_MARKS = [_named("left_hip", "right_hip"), _named("left_shoulder", "right_shoulder"), _named("neck"), _named("head")]
"""Joints whose middles say how far the trunk's surface is moved at their height."""
_APART = 0.02
"""Metres between the heights of two of these, at least."""
_ROOTS = (("left_hip", 1, 1.0), ("right_hip", 1, 1.0), ("left_shoulder", 0, -1.0), ("right_shoulder", 0, 1.0))
"""Where limbs begin, and the axis and the direction in which the trunk lies from there."""
_BLEND = 0.05
"""Metres from where a limb begins to where the surface is all of the trunk."""


def character_body(character: Character) -> Body:
    """A character as a body on SMPL22, its own proportions along the bones changed to SMPL22's.

    Raises:
        InputError: if no human body is found among its joints, or its mesh is nowhere near it.
    """
    rig = _rig(character)
    upright = up_rotation(rig) * leg_scale(rig)
    ours = pairs_of(rig)
    owner = np.array([_owner(rig, joint, ours) for joint in range(len(rig.parents))])
    joints = rig.positions[0] @ upright.T
    places = np.full((SMPL22.num_joints, 3), np.nan)
    for theirs, mine in ours.items():
        places[mine] = joints[theirs]
    world = bone_rotations(retarget(rig, fps=rig.fps, plant=False).positions)[0]
    vertices = character.vertices @ upright.T
    if np.abs(vertices - places[0]).max() > 10 * _LARGEST:
        raise InputError(f"The mesh of {character.name} is far away from its skeleton: apply its transforms.")
    weights = np.zeros((len(vertices), SMPL22.num_joints))
    np.add.at(weights, (np.arange(len(vertices))[:, None], owner[character.slots]), character.weights)
    moves, pivots = _moves(places, world), np.stack([places, _REST])
    for side in ("left", "right"):
        _ground(side, vertices, weights, moves, pivots, world)
    shares = _of_limbs(weights, vertices @ world[0], places @ world[0])
    posed = (1.0 - shares.sum(axis=1, keepdims=True)) * _trunk(vertices @ world[0], places @ world[0])
    for joint in np.flatnonzero(shares.any(axis=0)):
        turned = (vertices - pivots[0, joint]) @ moves[joint].T + pivots[1, joint]
        posed += shares[:, joint, None] * turned
    posed[:, 1] = np.maximum(posed[:, 1], _REST[:, 1].min())  # of a heel that moves with the shin a little
    if np.abs(posed - _REST[0]).max() > _LARGEST:
        raise InputError(f"The mesh of {character.name} is no person of a usual build: check its weights.")
    return _body(character.name, *_coarser(posed, character.faces, weights))


def _rig(character: Character) -> RigMotion:
    """The pose of binding as a motion of one frame."""
    parents = np.array(character.parents)
    offsets = character.joints - np.where(parents[:, None] < 0, 0.0, character.joints[np.maximum(parents, 0)])
    positions = character.joints[None].astype(np.float64)
    return RigMotion(character.joint_names, character.parents, offsets, positions, None, 30.0, name=character.name)


def _owner(rig: RigMotion, joint: int, ours: dict[int, int]) -> int:
    """SMPL22's joint that moves a joint of the rig: its own, or that of the nearest one above it."""
    return next((ours[above] for above in rig.path_to_root(joint) if above in ours), 0)


def _moves(places: Array, world: Array) -> Array:
    """(22, 3, 3) what each part's surface is turned and stretched by, from the pose of binding to the T-pose."""
    moves = np.empty((SMPL22.num_joints, 3, 3))
    for joint in range(SMPL22.num_joints):
        back = world[joint].T
        after = _next(places, joint)
        if after is None or np.isnan(places[joint]).any():
            moves[joint] = back
            continue
        bone, wanted = places[after] - places[joint], _REST[after] - _REST[joint]
        length, target = np.linalg.norm(bone), np.linalg.norm(wanted)
        if length < 1e-3:
            moves[joint] = back
            continue
        along = bone / length
        turn = swing(back @ along, wanted / target) @ back
        stretch = float(np.clip(target / length, *_STRETCH))
        moves[joint] = turn @ (np.eye(3) + (stretch - 1.0) * np.outer(along, along))
    return moves


def _of_limbs(weights: Array, vertices: Array, places: Array) -> Array:
    """(V, 22) shares of the joints of the limbs: of their roots only what lies beyond these, seen from the trunk.

    ``vertices`` (V, 3) and ``places`` (22, 3) face +Z.
    """
    shares = weights.copy()
    shares[:, _TRUNK] = 0.0
    for name, axis, side in _ROOTS:
        root = SMPL22.index(name)
        shares[:, root] *= 1.0 - np.clip(side * (vertices[:, axis] - places[root, axis]) / _BLEND, 0.0, 1.0)
    return shares


def _trunk(vertices: Array, places: Array) -> Array:
    """(V, 3) the trunk's surface in the T-pose; ``vertices`` (V, 3) and ``places`` (22, 3) face +Z before it, too.

    It is moved as one, more or less far by its height, so that no gaps open between parts that hang on one joint each.
    """
    heights: list[float] = []
    shifts: list[Array] = []
    for mark in _MARKS:
        place = places[mark].mean(axis=0)
        if np.isfinite(place).all() and (not heights or place[1] > heights[-1] + _APART):
            heights.append(float(place[1]))
            shifts.append(_REST[mark].mean(axis=0) - place)
    moved = [np.interp(vertices[:, 1], heights, [shift[axis] for shift in shifts]) for axis in range(3)]
    return vertices + np.stack(moved, axis=1)


def _ground(side: str, vertices: Array, weights: Array, moves: Array, pivots: Array, world: Array) -> None:
    """Turns and stretches a foot as one, in place, so that its sole is flat and as low as SMPL22's ball of the foot.

    Args:
        side: "left" or "right".
        vertices: (V, 3) in the pose of binding.
        weights: (V, 22) of each joint.
        moves: (22, 3, 3) as :func:`_moves` gives them.
        pivots: (2, 22, 3) what each part is turned about, before and after.
        world: (22, 3, 3) how each bone is turned in the pose of binding.
    """
    ankle, ball = SMPL22.index(f"{side}_ankle"), SMPL22.index(f"{side}_foot")
    back = world[ankle].T
    surface = (vertices[weights[:, [ankle, ball]].sum(axis=1) > 0.5] - pivots[0, ankle]) @ back.T
    if not len(surface) or surface[:, 1].min() > -1e-3:
        return
    scale = np.ones(3)
    scale[1] = np.clip((_REST[ball] - _REST[ankle])[1] / surface[:, 1].min(), *_FOOT_STRETCH)
    turn: Array = np.eye(3)
    bone, wanted = ((back @ (pivots[0, ball] - pivots[0, ankle])) * _LEVEL, (_REST[ball] - _REST[ankle]) * _LEVEL)
    if (length := float(np.linalg.norm(bone))) > 1e-2:  # not so where the rig has no toes
        turn = swing(bone / length, wanted / np.linalg.norm(wanted))
        scale[[0, 2]] = np.clip(np.linalg.norm(wanted) / length, *_STRETCH)
    moves[[ankle, ball]] = turn @ np.diag(scale) @ back
    pivots[:, ball] = pivots[:, ankle]


def _next(places: Array, joint: int) -> int | None:
    """The joint at the other end of a joint's bone, where it has one and the rig has it."""
    children = list(SMPL22.children[joint])
    if joint == 0 or not children:
        return None
    if len(children) > 1:  # the chest: its bone goes up
        children = [SMPL22.index("neck")] if SMPL22.index("neck") in children else children[:1]
    child = children[0]
    return child if not np.isnan(places[child]).any() else _next(places, child)


def _coarser(vertices: Array, faces: NDArray, weights: Array) -> tuple[Array, NDArray, Array]:
    """The surface with at most :data:`MOST_DRAWN` vertices: those of one cell of a grid become one."""
    cell = 1e-5
    while True:
        keys = np.floor((vertices - vertices.min(axis=0)) / cell).astype(np.int64)
        _, group, count = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
        if len(count) <= MOST_DRAWN:
            break
        cell = max(1.25 * cell, 2e-3)
    group = group.reshape(-1)
    mean = np.zeros((len(count), 3))
    shares = np.zeros((len(count), weights.shape[1]))
    np.add.at(mean, group, vertices)
    np.add.at(shares, group, weights)
    made = group[faces]
    whole = (made[:, 0] != made[:, 1]) & (made[:, 1] != made[:, 2]) & (made[:, 2] != made[:, 0])
    return mean / count[:, None], made[whole], shares / count[:, None]


def _body(name: str, vertices: Array, faces: NDArray, weights: Array) -> Body:
    strongest = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    shares = np.take_along_axis(weights, strongest, axis=1)
    shares = np.rint(255 * shares / shares.sum(axis=1, keepdims=True))
    shares[:, 0] += 255 - shares.sum(axis=1)
    return Body(
        name=name,
        vertices=vertices,
        faces=faces,
        face_zones=np.zeros(len(faces), dtype=np.int64),
        zones=(ZONE,),
        sky=np.ones(len(vertices)),
        joints=_REST.astype(np.float64),
        turns=np.tile(np.eye(3), (22, 1, 1)),
        bones=strongest.astype(np.int64),
        weights=shares / 255,
    )


def packed_body(body: Body) -> dict[str, Any]:
    """A body as the player takes it, in the format of ``static/bodies``.

    Raises:
        InputError: for more than 65,535 vertices.
    """
    if len(body.vertices) > 2**16 - 1:
        raise InputError(f"The player draws 65,535 vertices, not {len(body.vertices):,}: reduce the mesh.")
    low = body.vertices.min(axis=0)
    scale = np.maximum(np.ptp(body.vertices, axis=0), 1e-9) / (2**16 - 1)

    return {
        "zones": list(body.zones),
        "joint_names": list(SMPL22.joint_names),
        "rest": _REST.tolist(),
        "joints": body.joints.tolist(),
        "turns": body.turns.tolist(),
        "min": low.tolist(),
        "scale": scale.tolist(),
        "vertices": in_base64(np.rint((body.vertices - low) / scale), "<u2"),
        "faces": in_base64(body.faces, "<u2"),
        "face_zones": in_base64(body.face_zones, "u1"),
        "sky": in_base64(np.rint(255 * body.sky), "u1"),
        "bones": in_base64(body.bones, "u1"),
        "weights": in_base64(np.rint(255 * body.weights), "u1"),
    }
