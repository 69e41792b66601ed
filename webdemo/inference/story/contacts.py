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
from motion.transforms import heading
from motion.vectors import unit

from .gestures import SIDES

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
        sides: the hands that touch, "left", "right" or both; none for a kiss, which the head gives.
        times: how often a short touch is made; 0 for a hand that stays.
        late: something else goes on until then.
        behind: the one who touches stands behind the other.
        fells: the other falls from it, and stood before.
    """

    person: str
    region: Region
    sides: tuple[str, ...]
    times: int = 0
    late: bool = False
    behind: bool = False
    fells: bool = False


_JOINTS = {
    Region.HEAD: "head", Region.SHOULDER: "{side}_shoulder", Region.BACK: "spine3", Region.CHEST: "spine2",
    Region.WAIST: "spine2",
    Region.ARM: "{side}_elbow", Region.HAND: "{side}_wrist", Region.LEG: "{side}_knee", Region.FOOT: "{side}_ankle",
}  # fmt: skip
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
_HIP = 0.93
"""Height in metres of a standing person's pelvis."""


def reach(touch: Contact, pose: Array) -> float:
    """Metres between the pelvises at which a standing person reaches the other, leaning forward where that is low.

    Args:
        touch: the contact.
        pose: (22, 3) metres of the one who is touched.
    """
    height, angle = float(middle(touch, pose)[1]), lean(touch, pose)
    ahead, up = _TRUNK * np.sin(angle), _HIP + _TRUNK * np.cos(angle)
    if not touch.sides:
        return float(ahead + 0.08 + _KISS)
    if touch.region is Region.WAIST:
        return 0.36
    arm = float(np.sqrt(max(_ARM**2 - (up - height) ** 2, 0.1**2)))
    return float(min(ahead + arm, 0.55)) + _SKIN


def lean(touch: Contact, pose: Array) -> float:
    """Radians by which a standing person leans forward to touch the other, whose pose (22, 3) is given."""
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


def _facing(pose: Array) -> Array:
    angle = float(heading(np.asarray(pose)[None])[0])
    return np.array([np.sin(angle), 0.0, np.cos(angle)])
