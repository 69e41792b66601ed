"""Hands of two people: held as they walk, raised against each other or shaken, over backs that stay straight.

A network that is told where two people walk, and that one hand of each is beside the other, lets the hands glide about
each other. Where the words have the two hold hands, the hands meet between them and stay together, and each elbow is on
its own side.

A motion has no hands beyond the wrists, so a network brings wrist to wrist, and the hands that are drawn beyond them
pass through each other. Where two wrists meet, raised or with forearms that point at each other, the palms beyond
them do instead.

A network has two people bow to each other's hand, their backs round and their eyes on the floor. Where hands are
shaken the upper back is straightened, and the body goes ahead over feet that stay by as much as the shoulders went
back, so that the hand is as near as before.
"""

from __future__ import annotations

import itertools

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.limbs import HIPS, UPPER, across, bent_towards, drawn_in, limb_length, over_planted_feet, solve_two_bones
from motion.skeleton import ARMS, SMPL22
from motion.smoothing import eased_marks, without_flicker
from motion.transforms import facing
from motion.vectors import FLAT, Array, left_of, rotations_by, unit

APART = 0.075
"""Metres between two wrists whose hands hold each other, palm to palm."""
_NEAR = 0.45
"""Metres between two wrists up to which hands that are to be held can be."""
_EASE, _SHORTEST = 12, 8
"""Frames in which hands come together, and that they are held at least."""
_SMOOTH = 3.0
"""Frames over which the place where hands are held is spread (standard deviation)."""
_REACH = 0.96
"""Share of an arm's length at which a held hand is at most."""
_OUT = 0.6
"""How far an elbow is to its own side, for a metre backwards."""
_SPINE = SMPL22.index("spine3")


def hands_clasped(pair: Array, held: Array) -> Array:
    """Two people who hold each other by the hand.

    Args:
        pair: (2, T, 22, 3) metres on constant bones.
        held: (T,) how far hands are to be held, 0 to 1.

    Returns:
        (2, T, 22, 3) with other elbows and wrists, of those hands alone that are nearest to each other.
    """
    result = np.array(pair, dtype=np.float64)
    if not (held > 0).any():
        return result
    mine, theirs = min(itertools.product(ARMS, ARMS), key=lambda arms: _gap(pair, arms)[held > 0].mean())
    near = without_flicker((_gap(pair, (mine, theirs)) < _NEAR) & (held > 0), _SHORTEST)
    share = held * eased_marks(near, _EASE)
    at = np.flatnonzero(share)
    if not len(at):
        return result
    middle: Array = 0.5 * (pair[0, :, mine[-1]] + pair[1, :, theirs[-1]])
    middle = scipy.ndimage.gaussian_filter1d(middle, _SMOOTH, axis=0, mode="nearest")[at]
    for person, arm in 2 * list(enumerate((mine, theirs))):
        reach = _REACH * limb_length(pair[person, at], arm) - 0.5 * APART
        middle = drawn_in(middle, pair[person, at, arm[0]], reach)
    ahead = 0.5 * FLAT * (facing(pair[0]) + facing(pair[1]))
    way = unit((pair[1, at, _SPINE] - pair[0, at, _SPINE]) * FLAT)
    for person, arm, side in ((0, mine, -1.0), (1, theirs, 1.0)):
        shoulder, elbow, wrist = (result[person, at, joint] for joint in arm)
        goal = wrist + share[at, None] * (middle + 0.5 * side * APART * way - wrist)
        pole = across(elbow - shoulder, wrist - shoulder)
        pole += share[at, None] * (_OUT * side * way - ahead[at] - pole)
        bent, met = bent_towards(shoulder, elbow, wrist, goal, pole)
        result[person, at, arm[1]], result[person, at, arm[2]] = bent, met
    return result


def _gap(pair: Array, arms: tuple[tuple[int, ...], tuple[int, ...]]) -> Array:
    """(T,) metres between the wrists of an arm of each."""
    return np.asarray(np.linalg.norm(pair[0, :, arms[0][-1]] - pair[1, :, arms[1][-1]], axis=-1))


# ---- Palms that meet -----------------------------------------------------------------
Arm = tuple[int, ...]

PALM, GRIP = 0.09, 0.07
"""Metres from a wrist along the forearm to the middle of the palm, and to where hands grip each other."""
PALMS_APART = 0.042
"""Metres between the middles of two hands that lie palm to palm."""
_MEETS = 0.2
"""Metres between two wrists up to which hands meet."""
_MEET_EASE, _SHORTEST_MEETING, _SHAKEN = 10, 3, 12
"""Frames in which hands come to the place where they meet, that they meet at least, and that they are shaken."""
_ROUNDS = 3
"""Rounds in which the palms are brought together: a forearm turns as its wrist moves."""
_SOFT = 0.06
"""Share of an arm's length before its end that is used up ever more slowly: a straight arm jolts its elbow."""
_AGAINST = -0.2
"""Cosine between two forearms that point at each other, at most."""


def palms_met(pair: Array, free: Array | None = None) -> Array:
    """Two people whose palms meet where they raise their hands against each other, or shake them.

    Args:
        pair: (2, T, 22, 3) metres on constant bones.
        free: (T,) how far a frame may be changed, 0 to 1; wholly by default.

    Returns:
        (2, T, 22, 3) with other elbows and wrists where hands meet.
    """
    result = np.array(pair, dtype=np.float64)
    way = unit((result[1, :, _SPINE] - result[0, :, _SPINE]) * FLAT)
    for mine, theirs in itertools.product(ARMS, ARMS):
        if not _near(result, mine, theirs).any():
            continue
        aside = _aside(way, mine, theirs)
        against, clasped = (
            without_flicker(meets(result, mine, theirs), shortest)
            for meets, shortest in ((_raised, _SHORTEST_MEETING), (shaken, _SHAKEN))
        )
        for meets, line, palm in ((against, way, PALM), (clasped, aside, GRIP)):
            share = eased_marks(meets, _MEET_EASE)
            share = share if free is None else share * free
            if share.any():
                at = np.flatnonzero(share)
                result[:, at] = _met(result[:, at], mine, theirs, share[at], PALMS_APART * line[at], palm)
    return result


def _raised(pair: Array, mine: Arm, theirs: Arm) -> NDArray[np.bool_]:
    """(T,) frames at which two wrists meet above the chest of both people."""
    raised = [pair[i, :, arm[-1], 1] > pair[i, :, _SPINE, 1] for i, arm in enumerate((mine, theirs))]
    return np.asarray(_near(pair, mine, theirs) & raised[0] & raised[1])


def shaken(pair: Array, mine: Arm, theirs: Arm) -> NDArray[np.bool_]:
    """(T,) frames at which two wrists meet, not both above the chest, whose forearms point at each other."""
    ahead = [_forearm(pair[i], arm) for i, arm in enumerate((mine, theirs))]
    against = np.einsum("ti,ti->t", *ahead) < _AGAINST
    return np.asarray(_near(pair, mine, theirs) & against & ~_raised(pair, mine, theirs))


def _near(pair: Array, mine: Arm, theirs: Arm) -> NDArray[np.bool_]:
    """(T,) frames at which two wrists meet."""
    return np.asarray(_gap(pair, (mine, theirs)) < _MEETS)


def _aside(way: Array, mine: Arm, theirs: Arm) -> Array:
    """(T, 3) where the other's palm lies from one's own in a handshake; above it, where a right hand holds a left."""
    if mine != theirs:
        return np.tile([0.0, 1.0, 0.0], (len(way), 1))
    return left_of(way) if mine == ARMS[1] else -left_of(way)


def _met(pair: Array, mine: Arm, theirs: Arm, share: Array, apart: Array, palm: float) -> Array:
    """Some frames (2, N, 22, 3) with the palms of two arms brought to be ``apart`` (N, 3) by a ``share`` (N,).

    A palm is so many metres beyond the wrist.
    """
    result = pair.copy()
    for _ in range(_ROUNDS):
        gap = _palm(result[1], theirs, palm) - _palm(result[0], mine, palm) - apart
        for person, arm, half in ((0, mine, 0.5), (1, theirs, -0.5)):
            shoulder, elbow, wrist = arm
            own = result[person]
            goal = own[:, wrist] + half * share[:, None] * gap
            away = unit(own[:, shoulder] - result[1 - person, :, shoulder])  # where a straight arm bends
            pole = own[:, elbow] - 0.5 * (own[:, shoulder] + own[:, wrist]) + 1e-3 * away
            own[:, elbow], own[:, wrist] = solve_two_bones(
                own[:, shoulder], own[:, elbow], own[:, wrist], goal, pole, soft=_SOFT
            )
    return result


def _forearm(person: Array, arm: Arm) -> Array:
    """(N, 3) the direction in which a forearm points."""
    return unit(person[:, arm[2]] - person[:, arm[1]])


def _palm(person: Array, arm: Arm, palm: float) -> Array:
    """(N, 3) the middle of a palm, so many metres beyond the wrist."""
    return np.asarray(person[:, arm[2]] + palm * _forearm(person, arm))


# ---- Backs that stay straight --------------------------------------------------------
_BACK_EASE, _SHORTEST_SHAKE = 18, 12
"""Frames in which backs are straightened before hands meet and after, and of the shortest handshake."""
_STRAIGHT, _MOST = -0.1, 0.5
"""Radians by which the upper back of people who stand leans forward, and that it is straightened at most."""
_NECK = SMPL22.index("neck")
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
        marked = without_flicker(shaken(result, mine, theirs), _SHORTEST_SHAKE)
        share = free * eased_marks(marked, _BACK_EASE)
        if share.any():
            for person, arm in ((0, mine), (1, theirs)):
                result[person] = _straightened(result[person], arm, share)
    return result


def _straightened(person: Array, arm: Arm, share: Array) -> Array:
    """A person (T, 22, 3) whose upper back is straight by a ``share`` (T,), one hand where it was."""
    ahead = facing(person)
    back = person[:, _NECK] - person[:, _SPINE]
    leans = np.arctan2(np.sum(back * ahead, axis=-1), back[:, 1])
    angle = -share * np.clip(leans - _STRAIGHT, 0.0, _MOST)
    turn = rotations_by(angle[:, None] * left_of(ahead))
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
