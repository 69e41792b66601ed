"""Contact: arms that reach for the other person, hands that meet, bodies that recoil.

Everything works on the (T, 22, 3) positions of a person whose feet are already planted. Bones keep their length: arms
and legs are solved by :mod:`motion.limbs`, and the spine and the neck bend as rigid parts. A reach starts from the
arm's current pose and follows a minimum-jerk course (Flash and Hogan 1985), so nothing jumps.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.ndimage import gaussian_filter1d

from motion import FPS
from motion.limbs import limb_length, over_planted_feet, solve_two_bones
from motion.skeleton import SMPL22
from motion.smoothing import minimum_jerk
from motion.vectors import FLAT, left_of, rotations_by, unit

from .compose import ARMS, Array

UP = np.array([0.0, 1.0, 0.0])
SPINE = tuple(SMPL22.index(name) for name in ("spine1", "spine2", "spine3"))
NECK = SMPL22.index("neck")
ELBOW_DOWN = (0.45, -1.0, -0.25)
"""Direction of an elbow in its owner's frame: outwards, up, forwards."""
FULL_REACH = 0.93
"""Share of its length that an arm extends before the trunk leans to help."""
LEAN = 0.3
"""Radians by which the trunk leans at most for an arm that reaches."""
SOFT = 0.06
"""Share of its length, at its end, over which an arm that reaches far straightens ever more slowly."""


def envelope(frames: int, start: int, arrive: int, leave: int, end: int) -> Array:
    """(frames,) 0 up to ``start``, 1 from ``arrive`` to ``leave``, 0 from ``end``; minimum jerk between."""
    time = np.arange(frames, dtype=np.float64)
    rise = (time - start) / max(arrive - start, 1)
    fall = (end - time) / max(end - leave, 1)
    return minimum_jerk(rise) * minimum_jerk(fall)


def impulse(frames: int, start: int, *, rise: int = 5, fall: int = 22) -> Array:
    """(frames,) recoil of a body after a blow: rises within ``rise`` frames, returns within ``fall``."""
    return envelope(frames, start, start + rise, start + rise, start + rise + fall)


def axes(positions: Array) -> tuple[Array, Array]:
    """(T, 3) unit vectors to the person's left and ahead, level, of the shoulder girdle."""
    left = unit((positions[:, ARMS["left"][1]] - positions[:, ARMS["right"][1]]) * FLAT)
    return left, -left_of(left)


def on_body(positions: Array, joint: str, left: float | Array, up: float | Array, ahead: float | Array) -> Array:
    """(T, 3) a point beside a joint of a person: metres, fixed or (T,), to their left, up and ahead of it."""
    parts = zip((left, up, ahead), (axes(positions)[0], UP, axes(positions)[1]), strict=True)
    return sum((np.reshape(metres, (-1, 1)) * way for metres, way in parts), positions[:, SMPL22.index(joint)])


def towards(origin: Array, target: Array) -> Array:
    """(T, 3) level unit vector from one point to another."""
    return unit((target - origin) * FLAT)


def meeting(a: Array, b: Array, side_a: str, side_b: str, *, height: float, apart: float = 0.08) -> tuple[Array, Array]:
    """Targets of two wrists when two hands meet between two people.

    Args:
        a, b: (T, 22, 3) the two people.
        height: of the meeting point above the floor in metres.
        apart: distance between the wrists in metres; the hands reach over each other.

    Returns:
        (T, 3) wrist of a and (T, 3) wrist of b, steady over time.
    """
    own, other = a[:, ARMS[side_a][1]], b[:, ARMS[side_b][1]]
    middle = gaussian_filter1d((own + other) / 2, 4.0, axis=0, mode="nearest")
    middle[:, 1] = height
    line = towards(gaussian_filter1d(own, 4.0, axis=0), gaussian_filter1d(other, 4.0, axis=0)) * (apart / 2)
    return middle - line, middle + line


def bend(positions: Array, turn: Array, *, joints: tuple[int, ...] = SPINE) -> Array:
    """Bends the spine by a rotation vector (T, 3) in radians against the world, shared between ``joints``."""
    positions = positions.copy()
    matrices = rotations_by(np.asarray(turn) / len(joints))
    for joint in joints:
        moved = SMPL22.below(joint)
        pivot = positions[:, joint : joint + 1]
        positions[:, moved] = pivot + (positions[:, moved] - pivot) @ np.swapaxes(matrices, -1, -2)
    return positions


def lean_to(positions: Array, direction: Array, angle: Array) -> Array:
    """Leans the trunk by ``angle`` (T,) radians towards a level ``direction`` (T, 3)."""
    return bend(positions, np.cross(UP, direction) * angle[:, None])


def nod(positions: Array, angle: Array) -> Array:
    """Bends the neck forward by ``angle`` (T,) radians."""
    return bend(positions, np.cross(UP, axes(positions)[1]) * angle[:, None], joints=(NECK,))


def shift_hips(positions: Array, offset: Array) -> Array:
    """Moves the body by ``offset`` (T, 3) metres over feet that stay where they are."""
    return over_planted_feet(positions, positions + offset[:, None])


def reach(
    positions: Array,
    targets: Mapping[str, Array],
    weight: Array,
    *,
    elbow: tuple[float, float, float] = ELBOW_DOWN,
    twist: float = 0.55,
) -> Array:
    """Brings one or both wrists to moving targets and back again.

    Where a target is farther than the arm, the trunk turns that shoulder forward and leans towards it,
    then the hips move by up to 20 cm; no more than needed at the frame of the fullest reach, and as the arm's weight.

    Args:
        positions: (T, 22, 3) the person.
        targets: "left" and/or "right" to (T, 3) where that wrist should be.
        weight: (T,) from 0, the arm as it was, to 1, the wrist at its target.
        elbow: which way the elbows point (outwards, up, forwards).
        twist: radians by which the trunk turns at most.

    Returns:
        (T, 22, 3) with the same bone lengths.
    """
    arrived = np.flatnonzero(weight >= weight.max() - 1e-9)
    gaps = [target - positions[:, ARMS[side][1]] for side, target in targets.items()]
    full = arrived[np.argmax(np.linalg.norm(gaps, axis=-1).sum(axis=0)[arrived])]
    pose, goals = positions[[full]], {side: target[[full]] for side, target in targets.items()}
    direction = towards(pose[:, 0], sum(goals.values()) / len(goals))
    turn = twist * {("left",): -1.0, ("right",): 1.0}.get(tuple(goals), 0.0)
    trunk = np.cross(UP, direction) * LEAN + UP * turn
    shares = np.linspace(0, 1, 6)
    missing = [_missing(bend(pose, share * trunk), goals) for share in shares]
    share = float(np.interp(0.0, -np.minimum.accumulate(missing), shares))
    if share == 1 and missing[-1] > 0.004:
        positions = shift_hips(positions, direction * min(1.2 * missing[-1], 0.2) * weight[:, None])
    if share > 0:
        positions = bend(positions, share * trunk * weight[:, None])
    for side, target in targets.items():
        positions = reach_arm(positions, side, target, weight, elbow=elbow)
    return positions


def _missing(pose: Array, goals: Mapping[str, Array]) -> float:
    """Metres by which the arms of a person (1, 22, 3) are too short for goals: "left" and/or "right" to (1, 3)."""
    return max(
        float(np.linalg.norm(goal - pose[:, ARMS[side][1]], axis=-1)[0])
        - FULL_REACH * float(limb_length(pose, ARMS[side][1:])[0])
        for side, goal in goals.items()
    )


def reach_arm(
    positions: Array, side: str, target: Array, weight: Array, *, elbow: tuple[float, float, float] = ELBOW_DOWN
) -> Array:
    """Brings a wrist to ``target`` (T, 3) by ``weight`` (T,), and the elbow to its side; nothing but the arm moves."""
    _, *arm = ARMS[side]
    root, middle, end = (positions[:, joint] for joint in arm)
    share = weight[:, None]
    to_left, forward = axes(positions)
    outwards = to_left if side == "left" else -to_left
    pole = unit(elbow[0] * outwards + elbow[1] * UP + elbow[2] * forward)
    # An elbow that is bent turns to its side before the arm goes.
    line = unit(end - root)
    aside = middle - root - np.sum((middle - root) * line, axis=-1, keepdims=True) * line
    length = np.linalg.norm(aside, axis=-1, keepdims=True)
    side_of = aside * (1 - share) + length * share * (pole - np.sum(pole * line, axis=-1, keepdims=True) * line)
    turned = middle - aside + length * unit(side_of)
    goal = end * (1 - share) + target * share
    solved = positions.copy()
    solved[:, arm[1]], solved[:, arm[2]] = solve_two_bones(root, turned, end, goal, pole, soft=SOFT * share)
    solved[weight <= 0] = positions[weight <= 0]
    return solved


def settle(
    a: Array,
    b: Array,
    sides: tuple[str, str],
    weights: tuple[Array, Array],
    *,
    apart: float,
    away: tuple[Array, Array] = (np.zeros(3), np.zeros(3)),
    elbow: tuple[float, float, float] = ELBOW_DOWN,
) -> tuple[Array, Array]:
    """Makes two hands meet where an arm has stopped short: both go to the point between the wrists.

    Args:
        sides: whose which hand.
        weights: (T,) of the two reaches; the hands are joined as far as both have arrived.
        apart: distance between the wrists in metres.
        away: (T, 3) each by which a wrist keeps off the meeting point for the moment.
    """
    ends = [body[:, ARMS[side][3]] - gap for body, side, gap in zip((a, b), sides, away, strict=True)]
    smooth = [gaussian_filter1d(end, 2.0, axis=0, mode="nearest") for end in ends]
    middle = (smooth[0] + smooth[1]) / 2
    line = towards(a[:, 0], b[:, 0]) * (apart / 2)
    both = np.minimum(*weights) ** 2
    return (
        reach_arm(a, sides[0], middle - line + away[0], both, elbow=elbow),
        reach_arm(b, sides[1], middle + line + away[1], both, elbow=elbow),
    )


def shaking(frames: int, start: int, stop: int, *, hertz: float, size: float) -> Array:
    """(frames,) metres up and down of a handshake: starts gently and dies away."""
    time = (np.arange(frames) - start) / FPS
    return size * np.sin(2 * np.pi * hertz * time) * envelope(frames, start, *[start + (stop - start) // 3] * 2, stop)
