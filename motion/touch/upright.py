"""Backs that stay straight in a handshake: people reach for each other's hand with the arm, and not with the back.

A network has two people bow to each other's hand, their backs round and their eyes on the floor. Where hands are
shaken the upper back is straightened, and the body goes ahead over feet that stay by as much as the shoulders went
back, so that the hand is as near as before.
"""

from __future__ import annotations

import itertools

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.cleaning import solve_two_bones
from motion.planted import HIPS, UPPER, over_planted_feet
from motion.skeleton import ARMS, SMPL22
from motion.smoothing import eased_marks, without_flicker
from motion.transforms import facing

from .palms import Arm, shaken

Array = NDArray[np.floating]

_EASE, _SHORTEST = 18, 12
"""Frames in which backs are straightened before hands meet and after, and of the shortest handshake."""
_STRAIGHT, _MOST = -0.1, 0.5
"""Radians by which the upper back of people who stand leans forward, and that it is straightened at most."""
_SPINE, _NECK = SMPL22.index("spine3"), SMPL22.index("neck")
_HANGS = {joint: arm[0] for arm in ARMS for joint in arm[1:]}
"""The shoulder that an elbow and a wrist hang from."""
_BACK = [joint for joint in UPPER if joint not in _HANGS and not SMPL22.joint_names[joint].startswith("spine")]


def backs_straight(pair: Array, free: Array) -> Array:
    """Two people whose backs are straight where they shake hands.

    Args:
        pair: (2, T, 22, 3) metres on constant bones.
        free: (T,) how far a frame may be changed, 0 to 1.

    Returns:
        (2, T, 22, 3) on bones as long as before, with wrists that meet where they met.
    """
    result = np.array(pair, dtype=np.float64)
    for mine, theirs in itertools.product(ARMS, ARMS):
        marked = without_flicker(shaken(result, mine, theirs), _SHORTEST)
        share = free * eased_marks(marked, _EASE)
        if share.any():
            for person, arm in ((0, mine), (1, theirs)):
                result[person] = _straightened(result[person], arm, share)
    return result


def _straightened(person: Array, arm: Arm, share: Array) -> Array:
    """A person (T, 22, 3) whose upper back is straight by a ``share`` (T,), one hand where it was."""
    ahead, up = facing(person), np.array([0.0, 1.0, 0.0])
    back = person[:, _NECK] - person[:, _SPINE]
    leans = np.arctan2(np.sum(back * ahead, axis=-1), back[:, 1])
    angle = -share * np.clip(leans - _STRAIGHT, 0.0, _MOST)
    turn = scipy.spatial.transform.Rotation.from_rotvec(angle[:, None] * np.cross(up, ahead)).as_matrix()
    moved = person.copy()
    spine = person[:, _SPINE, None]
    moved[:, _BACK] = spine + np.einsum("tij,tkj->tki", turn, person[:, _BACK] - spine)
    shoulders = [each[0] for each in ARMS]
    went = (person[:, shoulders] - moved[:, shoulders]).mean(axis=1)
    shift = np.sum(went * ahead, axis=-1, keepdims=True) * ahead
    for joint, shoulder in _HANGS.items():
        moved[:, joint] += moved[:, shoulder] - person[:, shoulder]
    moved[:, [*UPPER, *HIPS]] += shift[:, None]
    result = over_planted_feet(person, moved)
    shoulder, elbow, wrist = arm
    goal = result[:, wrist] + share[:, None] * (person[:, wrist] - result[:, wrist])
    pole = result[:, elbow] - 0.5 * (result[:, shoulder] + result[:, wrist])
    result[:, elbow], result[:, wrist] = solve_two_bones(
        result[:, shoulder], result[:, elbow], result[:, wrist], goal, pole
    )
    return result
