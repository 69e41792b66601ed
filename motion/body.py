"""Skinned bodies on the 22 SMPL joints: what the player, the exports and the films draw.

A body is a closed surface bound to SMPL22 (``static/bodies``, made from MakeHuman's mesh, CC0). Joint positions alone
pose it: :func:`bone_rotations` finds how each bone is turned, twist included, and :func:`skin` moves the surface by
linear blend skinning. ``static/player/pose.js`` and ``body.js`` do the same in the browser, number for number.
"""

from __future__ import annotations

import base64
import itertools
import json
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .hands import NUMBERS, SHAPES, Fingers
from .kinematics import swing_of_units
from .looks import LOOKS
from .skeleton import SMPL22
from .smoothing import smoothstep
from .vectors import Array, rotation_vectors, rotations_by, square_frame, square_to, unit

FOLDER = Path(__file__).resolve().parents[1] / "static" / "bodies"
_J = {name: index for index, name in enumerate(SMPL22.joint_names)}
_REST = SMPL22.rest_positions()


@dataclass(frozen=True, eq=False)
class Body:
    """A surface and how it hangs on SMPL22's joints.

    Attributes:
        name: one of :data:`motion.looks.LOOKS`.
        vertices: (V, 3) metres in the pose of binding, the soles at 0, facing +Z.
        faces: (F, 3) vertex indices, counter-clockwise seen from outside.
        face_zones: (F,) index into ``zones``.
        zones: what there is: skin, top, trousers, shoes, hair (or grey), eyes (iris and pupil), whites (of the eyes).
        sky: (V,) ambient light that reaches each vertex, 0 to 1.
        joints: (22, 3) places of the joints in the pose of binding.
        turns: (22, 3, 3) rotation that takes each bone from the pose of binding to SMPL22's T-pose.
        bones: (V, 4) joints that move each vertex.
        weights: (V, 4) their shares, which sum to 1.
        fingers: how its hands take shapes.
    """

    name: str
    vertices: Array = field(repr=False)
    faces: NDArray[np.integer] = field(repr=False)
    face_zones: NDArray[np.integer] = field(repr=False)
    zones: tuple[str, ...]
    sky: Array = field(repr=False)
    joints: Array = field(repr=False)
    turns: Array = field(repr=False)
    bones: NDArray[np.integer] = field(repr=False)
    weights: Array = field(repr=False)
    fingers: Fingers = field(repr=False)


def in_base64(values: NDArray, kind: str) -> str:
    """Numbers as the text that :func:`load_body` and the browser read back, in a type such as "<u2"."""
    return base64.b64encode(np.ascontiguousarray(values).astype(kind).tobytes()).decode("ascii")


@lru_cache(maxsize=8)
def load_body(name: str, *, small: bool = False) -> Body:
    """The body ``name``, one of :data:`motion.looks.LOOKS`; ``small`` gives about a third of the triangles.

    Raises:
        InputError: for another name, or where the file is missing or damaged.
    """
    if name not in LOOKS:
        raise InputError(f"There is no body {name!r}: take one of {', '.join(LOOKS)}.")
    path = FOLDER / f"{name}{'-small' if small else ''}.json"
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))

        def decoded(text: str, kind: str, columns: int) -> NDArray:
            return np.frombuffer(base64.b64decode(text), dtype=kind).reshape(-1, columns)

        def numbers(key: str, kind: str, columns: int) -> NDArray:
            return decoded(stored[key], kind, columns)

        return Body(
            name=name,
            vertices=np.array(stored["min"]) + np.array(stored["scale"]) * numbers("vertices", "<u2", 3),
            faces=numbers("faces", "<u2", 3).astype(np.int64),
            face_zones=numbers("face_zones", "u1", 1)[:, 0],
            zones=tuple(stored["zones"]),
            sky=numbers("sky", "u1", 1)[:, 0] / 255,
            joints=np.array(stored["joints"]),
            turns=np.array(stored["turns"]),
            bones=numbers("bones", "u1", 4).astype(np.int64),
            weights=numbers("weights", "u1", 4) / 255,
            fingers=Fingers.from_stored(stored["fingers"], decoded),
        )
    except (OSError, ValueError, KeyError) as error:
        raise InputError(f"The body {path.name} cannot be read ({error}): restore static/bodies.") from error


def skin(body: Body, positions: Array, hands: Array | None = None) -> Array:
    """The body's surface in each frame.

    Args:
        positions: (T, 22, 3) metres.
        hands: (T, 2, 20) finger shapes as :func:`motion.hands.angles` gives them; relaxed by default.

    Returns:
        (T, V, 3) float32 metres.
    """
    turned = bone_rotations(positions) @ body.turns
    surface = np.zeros((len(positions), len(body.vertices), 3), dtype=np.float32)
    for joint in range(SMPL22.num_joints):
        vertex, slot = np.nonzero((body.bones == joint) & (body.weights > 0))
        if not len(vertex):
            continue
        placed = (body.vertices[vertex] - body.joints[joint]) @ np.swapaxes(turned[:, joint], -1, -2)
        placed += positions[:, None, joint]
        surface[:, vertex] += (body.weights[vertex, slot, None] * placed).astype(np.float32)
    _shape_hands(body, turned, surface, hands)
    return surface


def _shape_hands(body: Body, turned: Array, surface: Array, hands: Array | None) -> None:
    """Moves the fingers of a posed surface (T, V, 3); ``turned`` (T, 22, 3, 3) are its bones."""
    shapes = np.broadcast_to(SHAPES["relaxed"], (len(turned), 2, NUMBERS)) if hands is None else hands
    shift = body.fingers.shift(body.vertices, shapes)
    left = body.vertices[body.fingers.vertices, 0] > 0
    for side, chosen in (("left", left), ("right", ~left)):
        wrist = turned[:, _J[f"{side}_wrist"]]
        surface[:, body.fingers.vertices[chosen]] += (shift[:, chosen] @ np.swapaxes(wrist, -1, -2)).astype(np.float32)


def vertex_normals(vertices: Array, faces: NDArray[np.integer]) -> Array:
    """(V, 3) unit normals of a surface with vertices (V, 3) and faces (F, 3); zeros where all faces have no area."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    flat = np.cross(b - a, c - a)
    total = np.empty_like(vertices)
    for axis in range(3):
        total[:, axis] = np.bincount(faces.ravel(), weights=np.repeat(flat[:, axis], 3), minlength=len(vertices))
    return unit(total)


def bone_rotations(positions: Array) -> Array:
    """World rotation of each bone against SMPL22's T-pose, from joint positions only.

    Bones point where the positions say. Their twist follows from their neighbours: trunk and pelvis turn with
    hips and collars; elbows and knees bend about one axis, which fixes the twist of a bent limb, and a
    straight one keeps the least twist; shins turn with the feet; soles and palms near the floor lie flat, toes
    bend; the head turns to the side on which it lies in front of the neck, and looks ahead if only the neck bends.

    Args:
        positions: (T, 22, 3) metres, Y up, floor at 0.

    Returns:
        (T, 22, 3, 3) world rotations.
    """
    positions = np.asarray(positions, dtype=np.float64)
    world, ways = np.empty((*positions.shape, 3)), _ways(positions)
    _turn_trunk(positions, ways, world)
    _turn_head(ways, world)
    for side, sign in (("left", -1.0), ("right", 1.0)):
        _turn_arm(positions, ways, world, side, sign)
        _turn_leg(positions, ways, world, side)
    return world


_LEAST_AHEAD = 0.25
"""Least distance of the head in front of the neck at which its side counts, in lengths of the neck."""
_MOST_YAW = 1.2
_MOST_LEVEL = 0.4
_MOST_SHIN = 0.9
_MOST_ROLL = 0.6
_ARM_BEND = (0.2, 0.55)
"""Sines of the bend between which the axis of a hinge begins to count and counts in full."""
_LEG_BEND = (0.2, 0.5)
_LOW_HAND = (0.07, 0.13)
"""Heights in metres of the wrist between which a hand stops lying flat on the floor."""
_STEEP_ARM = (0.25, 0.6)
"""Sines of a forearm's way down between which its hand begins to lie flat and lies flat."""
_LOW_FOOT = (0.03, 0.1)
"""Heights in metres of the ball of the foot between which a sole stops lying flat."""


_PAIRS = (
    ("right_hip", "left_hip"),
    ("right_collar", "left_collar"),
    *itertools.pairwise(("spine1", "spine2", "spine3", "neck", "head")),
    *(
        (f"{side}_{first}", f"{side}_{second}")
        for side in ("left", "right")
        for limb in (("collar", "shoulder", "elbow", "wrist"), ("hip", "knee", "ankle", "foot"))
        for first, second in itertools.pairwise(limb)
    ),
)
Ways = dict[tuple[str, str], Array]


def _ways(poses: Array) -> Ways:
    """(…, 3) unit vectors from one joint to another, by :data:`_PAIRS`, of poses (…, 22, 3)."""
    starts, ends = np.array([(_J[a], _J[b]) for a, b in _PAIRS]).T
    return dict(zip(_PAIRS, np.moveaxis(unit(poses[..., ends, :] - poses[..., starts, :]), -2, 0), strict=True))


_REST_WAYS = _ways(_REST)


def _follow(ways: Ways, base: Array, a: str, b: str) -> Array:
    """(T, 3, 3) ``base`` turned by the least rotation that points its bone from ``a`` to ``b`` as it lies."""
    return swing_of_units(base @ _REST_WAYS[a, b], ways[a, b]) @ base


def _turn_trunk(positions: Array, ways: Ways, world: Array) -> None:
    """Pelvis and chest turn with hips and collars; the spine between them shares their difference."""
    middle = (positions[:, _J["left_hip"]] + positions[:, _J["right_hip"]]) / 2
    rest_middle = (_REST[_J["left_hip"]] + _REST[_J["right_hip"]]) / 2
    pelvis = square_frame(positions[:, _J["spine1"]] - middle, ways["right_hip", "left_hip"])
    pelvis = pelvis @ square_frame(_REST[_J["spine1"]] - rest_middle, _REST_WAYS["right_hip", "left_hip"]).T
    chest = square_frame(ways["spine3", "neck"], ways["right_collar", "left_collar"])
    chest = chest @ square_frame(_REST_WAYS["spine3", "neck"], _REST_WAYS["right_collar", "left_collar"]).T
    world[:, _J["pelvis"]], world[:, _J["spine3"]] = pelvis, chest
    between = rotation_vectors(np.swapaxes(pelvis, -1, -2) @ chest)
    for name, child, share in (("spine1", "spine2", 1 / 3), ("spine2", "spine3", 2 / 3)):
        world[:, _J[name]] = _follow(ways, pelvis @ rotations_by(share * between), name, child)


def _turn_head(ways: Ways, world: Array) -> None:
    """Neck and head turn to the side on which the head lies, and the face takes back a part of its pitch."""
    chest = world[:, _J["spine3"]]
    # The head joint lies in front of the neck, so its place shows to which side the face turns.
    ahead = np.einsum("tji,tj->ti", chest, ways["neck", "head"])
    yaw = np.clip(np.arctan2(ahead[:, 0], np.maximum(ahead[:, 2], _LEAST_AHEAD)), -_MOST_YAW, _MOST_YAW)
    for name, share in (("neck", 0.5), ("head", 1.0)):
        turned = chest @ rotations_by(share * yaw[:, None] * np.array([0.0, 1.0, 0.0]))
        world[:, _J[name]] = _follow(ways, turned, "neck", "head")
    # People who bend their necks go on looking ahead.
    pitch = -np.arcsin(np.clip(world[:, _J["head"], 1, 2], -1.0, 1.0))
    level = _MOST_LEVEL * np.tanh(0.6 * pitch / _MOST_LEVEL)
    world[:, _J["head"]] = world[:, _J["head"]] @ rotations_by(level[:, None] * np.array([-1.0, 0.0, 0.0]))


def _turn_arm(positions: Array, ways: Ways, world: Array, side: str, sign: float) -> None:
    """The elbow bends about one axis, which gives the twist; ``sign`` is that of the axis in the T-pose."""
    collar, shoulder, elbow, wrist = (f"{side}_{n}" for n in ("collar", "shoulder", "elbow", "wrist"))
    world[:, _J[collar]] = _follow(ways, world[:, _J["spine3"]], collar, shoulder)
    straight = _follow(ways, world[:, _J[collar]], shoulder, elbow)
    upper = ways[shoulder, elbow]
    hinge = straight @ np.array([0.0, sign, 0.0])
    twist = _hinge_twist(upper, ways[elbow, wrist], hinge, _ARM_BEND)
    # Half of the twist sits in the upper arm, all of it in the forearm: shoulders keep their shape.
    world[:, _J[shoulder]] = rotations_by(0.5 * twist[:, None] * upper) @ straight
    world[:, _J[elbow]] = _follow(ways, rotations_by(twist[:, None] * upper) @ straight, elbow, wrist)
    world[:, _J[wrist]] = _flat_hand(positions[:, _J[wrist], 1], world[:, _J[elbow]], sign)


def _flat_hand(height: Array, forearm: Array, sign: float) -> Array:
    """(T, 3, 3) rotations of a hand in line with its forearm (T, 3, 3), or flat on the floor where it is put there.

    Args:
        height: (T,) metres of the wrist.
        forearm: its rotations.
        sign: -1 for the left hand.
    """
    down, palm = np.array([0.0, -1.0, 0.0]), -forearm[:, :, 1]
    steep = smoothstep(sign * forearm[:, 1, 0], *_STEEP_ARM)
    axis = np.cross(palm, down)
    angle = np.arctan2(np.linalg.norm(axis, axis=-1), palm @ down)
    bent = steep * (1 - smoothstep(height, *_LOW_HAND)) * angle
    return rotations_by(bent[:, None] * unit(axis)) @ forearm


def _turn_leg(positions: Array, ways: Ways, world: Array, side: str) -> None:
    """The knee and the foot give the twist of the leg; a sole near the floor lies flat and its toes bend."""
    hip, knee, ankle, foot = (f"{side}_{n}" for n in ("hip", "knee", "ankle", "foot"))
    straight = _follow(ways, world[:, _J["pelvis"]], hip, knee)
    thigh, shin = ways[hip, knee], ways[knee, ankle]
    sole, rest_sole = ways[ankle, foot], _REST_WAYS[ankle, foot]
    bend = _bend(thigh, shin, _LEG_BEND)
    by_knee = _hinge_twist(thigh, shin, straight @ np.array([1.0, 0.0, 0.0]), _LEG_BEND)
    by_foot = _angle_about(shin, _follow(ways, straight, knee, ankle) @ rest_sole, sole)
    twist = np.clip(by_knee, -1.2, 1.2) + (1 - bend) * 0.6 * np.clip(by_foot, -_MOST_SHIN, _MOST_SHIN)
    world[:, _J[hip]] = rotations_by(twist[:, None] * thigh) @ straight
    lower = _follow(ways, world[:, _J[hip]], knee, ankle)
    by_foot = np.clip(_angle_about(shin, lower @ rest_sole, sole), -_MOST_SHIN, _MOST_SHIN)
    world[:, _J[knee]] = rotations_by(by_foot[:, None] * shin) @ lower
    loose = _follow(ways, world[:, _J[knee]], ankle, foot)
    low = 1 - smoothstep(positions[:, _J[foot], 1], *_LOW_FOOT)
    up = np.broadcast_to(np.array([0.0, 1.0, 0.0]), sole.shape)
    roll = np.clip(_angle_about(sole, loose[:, :, 1], up), -_MOST_ROLL, _MOST_ROLL)
    world[:, _J[ankle]] = rotations_by((low * roll)[:, None] * sole) @ loose
    raised = np.arcsin(np.clip(-world[:, _J[ankle], 1, 2], 0.0, 0.9))  # the heel above the toes
    axis = np.array([-1.0, 0.0, 0.0])
    world[:, _J[foot]] = world[:, _J[ankle]] @ rotations_by((low * raised)[:, None] * axis)


def _bend(first: Array, second: Array, span: tuple[float, float]) -> Array:
    """(T,) 0 where two bones are in line, 1 where the direction of their hinge is well determined."""
    return smoothstep(np.linalg.norm(np.cross(first, second), axis=-1), *span)


def _hinge_twist(first: Array, second: Array, hinge: Array, span: tuple[float, float]) -> Array:
    """(T,) angle about ``first`` that brings its ``hinge`` to where it bends onto ``second``."""
    angle = _angle_about(first, hinge, np.cross(first, second))
    # Half a turn away both ways are equal: fade out before the angle jumps.
    return angle * _bend(first, second, span) * (1 - smoothstep(np.abs(angle), 2.4, 3.0))


def _angle_about(axis: Array, first: Array, second: Array) -> Array:
    """(T,) signed angle about unit ``axis`` from ``first`` to ``second``, each (T, 3)."""
    first, second = square_to(first, axis), square_to(second, axis)
    return np.arctan2(np.sum(axis * np.cross(first, second), axis=-1), np.sum(first * second, axis=-1))
