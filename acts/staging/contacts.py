"""Contacts: a hand that is laid on the other's shoulder, a pat on the back, a kiss on the cheek.

The network makes the touches of its training sentences. It often misses by a hand's breadth after a
walk, on a person who sits or kneels, or on a part of the body that those sentences never name. In such cases the person
who touches is led to where they reach the other, and the hand is given.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22
from motion.transforms import heading, heading_matrix
from motion.vectors import unit

from .bodies.gestures import SIDES
from .bodies.poses import TRUNK, about, kneeling, leaning, upright

Array = NDArray[np.floating]


class Region(Enum):
    """A part of the body that is touched."""

    HEAD = "head"
    SHOULDER = "shoulder"
    BACK = "back"
    CHEST = "chest"
    WAIST = "waist, from behind"
    ARM = "arm"
    HAND = "hand"
    LEG = "leg"
    FOOT = "foot"


@dataclass(frozen=True)
class Contact:
    """A touch of one person.

    Attributes:
        person: "a" or "b", the one who touches the other.
        region: of the other's body.
        sides: the hands that touch, "left", "right" or both; none for a kiss, which the head gives, or a head that is
            laid on the other's shoulder from beside.
        times: how often a short touch is made; 0 for a hand that stays.
        late: something else goes on until then.
        behind: the one who touches stands behind the other.
        fells: the other falls from it, and stood before.
        beside: the one who touches stands beside the other, and looks the same way.
    """

    person: str
    region: Region
    sides: tuple[str, ...]
    times: int = 0
    late: bool = False
    behind: bool = False
    fells: bool = False
    beside: bool = False


_JOINTS = {
    Region.HEAD: "head",
    Region.SHOULDER: "{side}_shoulder",
    Region.BACK: "spine3",
    Region.CHEST: "spine2",
    Region.WAIST: "spine2",
    Region.ARM: "{side}_elbow",
    Region.HAND: "{side}_wrist",
    Region.LEG: "{side}_knee",
    Region.FOOT: "{side}_ankle",
}
_SKIN = 0.1
"""Metres between a wrist and the joint inside the part of the body that its hand is on."""
_PALM = 0.05
"""Metres by which a wrist is further from the spine, so that the palm and not the wrist is on the back."""
_KISS = 0.22
"""Metres between two heads at a kiss."""
_ARM = 0.45
"""Metres from the shoulder to the wrist of an arm that is nearly straight."""
_TRUNK = 0.47
"""Metres from the pelvis to the line of the shoulders."""
_HIP, _KNEELING = 0.93, float(kneeling(np.zeros(2), 0.0)[0, 1])
"""Height in metres of the pelvis of a person who stands, and who kneels."""
_DOWN = 0.33
"""Metres that the hand of a person who kneels is below their shoulder."""
_FLAT = 0.3
"""Metres between the heights of head and pelvis of a person who lies, at most."""
BESIDE = 0.46
"""Metres between the pelvises of two people one of whom has an arm around the other or the head on their shoulder."""
_RESTS, _WHISPERS = (0.2, 0.65), (0.34, 0.7)
"""Radians to the side of a trunk, and further ones of the head, of a person whose head is on a shoulder, and of one who
whispers."""
_OWN_HAND = np.array([0.04, 0.1, 0.22])
"""Metres from their pelvis to that side, up and ahead, of the wrist on that side: clear of the other's body."""
_AT_MOUTH = np.array([0.05, -0.1, 0.16])
"""The same from the head of a person who whispers, of the other hand, whose fingers are before the mouth."""
_AROUND = (0.13, 0.06, 0.04)
"""Metres behind, inside of and under the other's far shoulder of a wrist whose arm is around them."""
LOW = frozenset((Region.LEG, Region.FOOT))
"""What one kneels down to reach on a person who stands."""
LOWEST = 0.55
"""Height in metres of the lowest place that somebody on their feet reaches."""


def kneels(touch: Contact, pose: Array) -> bool:
    """True for a place of a pose (22, 3) so low that the person who touches it kneels down to it."""
    return float(middle(touch, pose)[1]) < LOWEST and not touch.fells


def beside(pose: Array, place: Array) -> float | None:
    """The heading across a person's lying body (22, 3), from the side of a place (2,); None if they do not lie."""
    body = np.asarray(pose)[SMPL22.index("head")] - pose[0]
    if abs(body[1]) > _FLAT or pose[0][1] > _KNEELING:
        return None
    across = np.array([body[2], -body[0]])
    side = 1.0 if across @ (np.asarray(pose)[0][[0, 2]] - place) >= 0 else -1.0
    return float(np.arctan2(*(side * across)))


def touching(touch: Contact, pose: Array, place: Array, angle: float) -> Array:
    """The pose (22, 3) of a person at a place (2,) who leans, or kneels down, to the other's pose, arms hanging."""
    if touch.beside:
        own = upright(place, angle)
        return own if touch.sides else _tilted(pose, own, angle, whispers=touch.region is Region.HEAD)
    make = kneeling if kneels(touch, pose) else upright
    return leaning(make(place, angle), angle, lean(touch, pose))


def reach(touch: Contact, pose: Array) -> float:
    """Metres over the floor from a person's pelvis to what they touch of the other, leaning or kneeling if it is low.

    Args:
        touch: the contact.
        pose: (22, 3) metres of the one who is touched.
    """
    if touch.beside:
        return BESIDE
    height, angle = float(middle(touch, pose)[1]), lean(touch, pose)
    if kneels(touch, pose):
        return float(_TRUNK * np.sin(angle) + np.sqrt(_ARM**2 - _DOWN**2))
    ahead, up = _TRUNK * np.sin(angle), _HIP + _TRUNK * np.cos(angle)
    if not touch.sides:
        return float(ahead + 0.08 + _KISS)
    if touch.region is Region.WAIST:
        return 0.36
    arm = float(np.sqrt(max(_ARM**2 - (up - height) ** 2, 0.1**2)))
    return float(min(ahead + arm, 0.55)) + _SKIN


def lean(touch: Contact, pose: Array) -> float:
    """Radians by which a person leans forward to touch the other, whose pose (22, 3) is given."""
    if kneels(touch, pose):
        over = float(middle(touch, pose)[1]) + _DOWN - _KNEELING
        return float(np.arccos(np.clip(over / _TRUNK, 0.2, 1.0)))
    least = 0.05 if touch.sides else 0.15
    return float(np.clip(0.1 + 1.2 * (1.3 - middle(touch, pose)[1]), least, 1.0))


def middle(touch: Contact, pose: Array) -> Array:
    """The middle (3,) of the joints of a pose (22, 3) that are touched."""
    return np.asarray(pose)[_joints(touch.region)].mean(axis=0)


def _joints(region: Region) -> list[int]:
    name = _JOINTS[region]
    return [SMPL22.index(name.format(side=side)) for side in (SIDES if "{" in name else SIDES[:1])]


def touched(touch: Contact, other: Array, own: Array) -> Array:
    """The places of the wrists, or of the head, at a contact.

    Args:
        touch: the contact.
        other: (22, 3) metres, a pose of the one who is touched.
        own: (22, 3) metres, a pose of the one who touches, who leans forward at their place.

    Returns:
        (len(sides), 3) metres; (1, 3) for a kiss.
    """
    joints = _joints(touch.region)
    back = other[SMPL22.index("spine3")]
    if touch.region is Region.BACK and float((own[0] - other[0]) @ _facing(other)) > 0:
        joints = _joints(Region.SHOULDER)  # as far as an arm gets round somebody from the front
    if not touch.sides:
        return other[joints[0]] + _KISS * unit(own[SMPL22.index("head")] - other[joints[0]])[None]
    found = []
    for side in touch.sides:
        shoulder = own[SMPL22.index(f"{side}_shoulder")]
        if touch.beside:
            found.append(_around(other, shoulder))
            continue
        joint = min(joints, key=lambda j: float(np.linalg.norm(other[j] - shoulder)))
        place = other[joint] + _SKIN * unit(shoulder - other[joint])
        if touch.region is Region.WAIST:  # the arms go round
            across = unit((shoulder - own[0]) * [1.0, 0.0, 1.0])
            place = other[joint] + 0.12 * _facing(other) - 0.02 * across + np.array([0.0, 0.02, 0.0])
        elif len(joints) == 1 and len(touch.sides) == 2:
            place = place + 0.08 * unit((shoulder - own[0]) * [1.0, 0.0, 1.0])
        if touch.region is Region.BACK and len(joints) == 1:
            place = place + _PALM * unit(shoulder - back)
        found.append(place)
    return np.stack(found)


def inner_side(other: Array, place: Array, angle: float) -> str:
    """The side, "left" or "right", on which a person at a place (2,) has the other (22, 3)."""
    left = np.array([np.cos(angle), -np.sin(angle)])
    return SIDES[0] if float((np.asarray(other)[0][[0, 2]] - place) @ left) > 0 else SIDES[1]


def arms_beside(touch: Contact, other: Array, place: Array, angle: float) -> tuple[str, ...]:
    """The sides of the arms that are given of a person at a place (2,) beside the other (22, 3): the inner one, and of
    one who whispers both."""
    whispers = touch.region is Region.HEAD and not touch.sides
    return SIDES if whispers else (inner_side(other, place, angle),)


def _tilted(other: Array, own: Array, angle: float, *, whispers: bool = False) -> Array:
    """A pose (22, 3) whose trunk and head are tilted to the side where the other (22, 3) is.

    The hand on that side is before the belly; of a person who whispers the other hand is before the mouth.
    """
    side = inner_side(other, own[0][[0, 2]], angle)
    sign = -1.0 if side == SIDES[0] else 1.0
    found = own.copy()
    neck, head = SMPL22.index("neck"), SMPL22.index("head")
    for root, moved, tilt in zip((0, neck), (list(TRUNK), [head]), _WHISPERS if whispers else _RESTS, strict=True):
        turn = heading_matrix(angle) @ about(2, sign * tilt) @ heading_matrix(-angle)
        found[moved] = found[root] + (found[moved] - found[root]) @ turn.T
    inner = SIDES.index(side)
    hands = [(inner, 0, _OWN_HAND), *([(1 - inner, head, _AT_MOUTH)] if whispers else [])]
    for hand, root, at in hands:
        place = heading_matrix(angle) @ (at * [-sign, 1.0, 1.0])
        found[SMPL22.index(f"{SIDES[hand]}_wrist")] = found[root] + place
    return found


def _around(other: Array, shoulder: Array) -> Array:
    """The place (3,) of a wrist on the other's (22, 3) far shoulder, behind them, of an arm from a shoulder (3,)."""
    behind, inside, under = _AROUND
    far, near = sorted(
        (other[SMPL22.index(f"{side}_shoulder")] for side in SIDES),
        key=lambda joint: -float(np.linalg.norm(joint - shoulder)),
    )
    return np.asarray(far + inside * unit(near - far) - behind * _facing(other) - [0.0, under, 0.0])


def _facing(pose: Array) -> Array:
    angle = float(heading(np.asarray(pose)[None])[0])
    return np.array([np.sin(angle), 0.0, np.cos(angle)])
