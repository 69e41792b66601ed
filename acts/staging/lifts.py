"""Lifts: a person picks the other up, carries them in the arms, takes them on the back or drags them by the feet.

No scene of the training data has anybody off the floor on another person, so the whole body of the person carried is
given, and the carrier's hands.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22
from motion.kinematics import forward_kinematics
from motion.touch.bending import bent_towards
from motion.transforms import heading_matrix

from .bodies.poses import about, bending

Array = NDArray[np.floating]


class Carry(Enum):
    """Ways in which somebody is held, and the place of their pelvis beside the carrier's, who faces +Z, in metres."""

    UP = (0.0, 0.38, 0.3)
    ARMS = (0.0, 0.2, 0.29)
    BACK = (0.0, 0.22, -0.2)
    DRAGS = (0.0, -0.83, 1.0)

    @property
    def words(self) -> str:
        """The act of the carrier: "picks the other up"."""
        return _WORDS[self]

    @property
    def near(self) -> float:
        """Metres between the pelvises at which one takes hold of the other."""
        return 1.0 if self is Carry.DRAGS else 0.45


@dataclass(frozen=True)
class Lift:
    """A lift of one person by the other.

    Attributes:
        carrier: "a" or "b".
        carry: how the other is held.
        spins: the two turn round meanwhile.
        comes: the person who walks up to the other first, if either does.
    """

    carrier: str
    carry: Carry
    spins: bool = False
    comes: str = ""


_WORDS = {
    Carry.UP: "picks the other up",
    Carry.ARMS: "carries the other in their arms",
    Carry.BACK: "carries the other on their back",
    Carry.DRAGS: "drags the other",
}
_LEANS = {Carry.UP: -0.08, Carry.ARMS: -0.03, Carry.BACK: 0.3, Carry.DRAGS: 1.0}
"""Radians by which the carrier leans forward."""
_LEGS = {
    Carry.UP: (-0.15, 0.0, 0.35),
    Carry.ARMS: (-0.9, 0.0, 1.2),
    Carry.BACK: (-1.25, 0.6, 1.3),
    Carry.DRAGS: (-0.9, 0.0, 0.1),
}
"""Radians of the thighs forward (negative) and out, about the upright, and of the knees, of the person carried."""
_UNEVEN = 0.05
"""Metres by which the left of two hands before the carrier's chest is higher, and the right one lower."""
_SIDES = (("left", 1.0), ("right", -1.0))


def carried(carry: Carry, place: Array, angle: float) -> tuple[Array, Array]:
    """The pose of the person carried, and the carrier's.

    Args:
        carry: how.
        place: (2,) x and z of the carrier's pelvis in metres.
        angle: the carrier's heading in radians.

    Returns:
        (22, 3) metres in the world, with wrists where they hold on and elbows below, and (22, 3) of the carrier, of
        which the trunk and the arms are meant.
    """
    turn = heading_matrix(angle)
    carrier = bending(place, angle, _LEANS[carry])
    pose = _pose(carry) @ turn.T + carrier[0] + turn @ np.array(carry.value)

    def own(name: str) -> Array:
        return carrier[SMPL22.index(name)]

    def theirs(name: str) -> Array:
        return pose[SMPL22.index(name)]

    left, up, ahead = turn[:, 0], np.array([0.0, 1.0, 0.0]), turn[:, 2]
    if carry is Carry.UP:
        hands = {s: theirs("spine2") + sign * 0.12 * left + 0.08 * ahead for s, sign in _SIDES}
        holds = {s: own(f"{o}_shoulder") + 0.1 * up for s, o in (("left", "right"), ("right", "left"))}
    elif carry is Carry.ARMS:
        hands = {
            "left": theirs("spine3") - 0.1 * up,
            "right": 0.7 * theirs("right_knee") + 0.3 * theirs("right_hip") - 0.11 * up,
        }
        holds = {
            "left": theirs("pelvis") + 0.13 * up + 0.05 * ahead,  # in the lap
            "right": own("neck") + 0.05 * left - 0.1 * ahead,  # around the neck
        }
    elif carry is Carry.DRAGS:
        hands = {s: theirs(f"{o}_ankle") for s, o in (("left", "right"), ("right", "left"))}
        holds = {s: theirs(f"{s}_shoulder") + 0.45 * ahead - 0.04 * up for s, _ in _SIDES}
    else:
        hands = {s: 0.7 * theirs(f"{s}_knee") + 0.3 * theirs(f"{s}_hip") - 0.1 * up for s, _ in _SIDES}
        holds = {
            s: own("spine3") + 0.16 * ahead + sign * 0.02 * left + (sign * _UNEVEN - 0.02) * up for s, sign in _SIDES
        }
    for side, _ in _SIDES:
        _bend(carrier, side, hands[side])
        if carry is Carry.DRAGS:  # the arms trail on the floor
            pose[SMPL22.index(f"{side}_wrist")] = holds[side]
        else:
            _bend(pose, side, holds[side])
    return pose, carrier


def _bend(pose: Array, side: str, hand: Array) -> None:
    """Has an arm of a pose (22, 3) reach for a place, with the elbow below."""
    arm = [SMPL22.index(f"{side}_{joint}") for joint in ("shoulder", "elbow", "wrist")]
    shoulder, elbow, wrist = pose[arm][:, None]
    elbow, _ = bent_towards(shoulder, elbow, wrist, hand[None], np.array([[0.0, -1.0, 0.0]]))
    pose[arm[1:]] = elbow[0], hand


def _pose(carry: Carry) -> Array:
    """(22, 3) metres from the pelvis of a person whose carrier faces +Z."""
    hip, out, knee = _LEGS[carry]
    turns = np.tile(np.eye(3), (1, SMPL22.num_joints, 1, 1))
    if carry is Carry.UP:
        turns[:, 0] = heading_matrix(np.pi)
    elif carry is Carry.BACK:
        turns[:, 0] = about(0, 0.25)
    elif carry is Carry.DRAGS:  # on the back, the feet towards the carrier
        turns[:, 0] = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
    else:  # the head on the carrier's left, the face up
        turns[:, 0] = np.array([[0.0, 0.85, -0.53], [0.0, 0.53, 0.85], [1.0, 0.0, 0.0]])
        turns[:, SMPL22.index("spine1")] = about(0, 0.2)
    for side, sign in _SIDES:
        turns[:, SMPL22.index(f"{side}_hip")] = heading_matrix(sign * out) @ about(0, hip)
        turns[:, SMPL22.index(f"{side}_knee")] = about(0, knee)
        turns[:, SMPL22.index(f"{side}_shoulder")] = about(2, -sign * 1.2)
    return forward_kinematics(turns, np.zeros((1, 3)))[0]
