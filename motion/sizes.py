"""People of different sizes: a motion that was made at an adult's size, with a child in it.

A child is an adult in small: all bones are shorter by one factor, so poses stay as they are. Two children are the whole
scene in small. Beside an adult a child walks over the same floor, with longer steps for its legs, and the adult takes
shorter ones: the ways over the floor, and the distance between the two, shrink by the mean of both sizes. As a foot
that stands is one point of a way, it stands afterwards too. What then no longer meets is brought together by
:func:`met_again`.
"""

from __future__ import annotations

import itertools

import numpy as np
import scipy

from .limbs import HIPS, UPPER, ankle_moved, drawn_in, limb_length, over_planted_feet, sink, solve_two_bones
from .skeleton import ARMS, LEGS, SMPL22, TOES
from .smoothing import begun_before, eased_marks, smoothstep, without_flicker
from .touch.arms import arms_apart
from .transforms import facing
from .vectors import FLAT, Array, left_of, rotations_by, unit

_ON_FEET = (0.55, 0.75)
"""Heights in metres of an adult's pelvis up to which the feet go with the body and nobody stoops, and from which they
stand and do."""
_LOW = (0.15, 0.4)
"""Heights in metres of an adult's toe up to which a foot belongs to a step, and from which it goes with the body."""
_SINKS = 0.09
"""Metres by which a body sinks at most, as a share of its size, for steps that are long for its legs."""
_STRIDE, _EASED = 8, 5.0
"""Frames to both sides over which the deepest sinking counts, and over which it is smoothed: a walk bobs little."""
_STRAIGHT = 0.985
"""Share of a leg's length that a step uses."""
_LIFTED = 0.12
"""Height in metres of the lower toe of a person who is carried, at the size at which the motion was made."""
_HELD_UP = 0.75
"""Height in metres of the pelvis of a person who is carried, at least: one who lies has their toes up, too."""
_CARRIES = 0.9
"""Metres between the pelvises of a person who carries and the one carried, at most."""
_SHORTEST, _RISES = 12, 10
"""Frames of the shortest lift, which is longer than a jump, and those in which one begins and ends."""
_CHEST = SMPL22.index("spine3")


def at_sizes(pair: Array, sizes: tuple[float, float]) -> Array:
    """Two people at their own sizes.

    Args:
        pair: (2, T, 22, 3) metres on SMPL22's bones, floor at 0.
        sizes: of a's and b's bones, as shares of SMPL22's.

    Returns:
        (2, T, 22, 3); the very same array for two adults.
    """
    if sizes == (1.0, 1.0):
        return pair
    if sizes[0] == sizes[1]:
        return np.asarray(sizes[0] * pair, dtype=pair.dtype)
    made = np.asarray(pair, dtype=np.float64)
    way = floor_scale(sizes)
    lifted = [_lifted(made[person], made[1 - person]) for person in (0, 1)]
    small = np.stack([_stepping(made[p], sizes[p], way, 1 - lifted[p]) for p in (0, 1)])
    for person in (0, 1):
        if lifted[person].any():
            small[person] += _raised(made, small, person, way) * lifted[person][:, None, None]
    return np.asarray(met_again(made, small, sizes), dtype=pair.dtype)


def of_adults(pair: Array, sizes: tuple[float, float]) -> Array:
    """Two people of other sizes as adults, to go on from: the way back from :func:`at_sizes` but for their hands."""
    if sizes[0] == sizes[1]:
        return np.asarray(pair / sizes[0], dtype=pair.dtype)
    way, own = 1 / floor_scale(sizes), np.asarray(pair, dtype=np.float64)
    free = np.ones(own.shape[1])
    grown = [_stepping(own[person], 1 / size, way, free, now=size) for person, size in enumerate(sizes)]
    return np.asarray(np.stack(grown), dtype=pair.dtype)


def bones_of(sizes: tuple[float, float]) -> Array:
    """(2, 22) lengths of both people's bones in metres."""
    return np.multiply.outer(np.array(sizes), SMPL22.bone_lengths)


def floor_scale(sizes: tuple[float, float]) -> float:
    """Factor by which ways over the floor, from the world's origin, differ from those of two adults."""
    return (sizes[0] + sizes[1]) / 2


def _stepping(own: Array, size: float, way: float, free: Array, now: float = 1.0) -> Array:
    """A person (T, 22, 3) whose bones are ``size`` times as long as ``now``, and who goes ``way`` times as far.

    ``free`` (T,) is 0 where they are carried.
    """
    pelvis = own[:, :1]
    small = pelvis * [way, size, way] + size * (own - pelvis)
    upright = free * smoothstep(pelvis[:, 0, 1] / now, *_ON_FEET)
    goals = []
    for *_, ankle, toe in LEGS:
        steps = (upright * (1 - smoothstep(own[:, toe, 1] / now, *_LOW)))[:, None]
        aside = (own[:, toe] - pelvis[:, 0]) * FLAT
        stood = small[:, toe] + (way - size) * steps * aside
        goals.append(stood + small[:, ankle] - small[:, toe])
    reaches = [_STRAIGHT * limb_length(small, leg)[:, None] for leg in LEGS]
    need = sink([small[:, leg[0]] for leg in LEGS], goals, reaches, _SINKS * size * now)
    small[..., 1] -= (upright * begun_before(need, _STRIDE, _EASED))[:, None]
    for leg, goal in zip(LEGS, goals, strict=True):
        ankle_moved(small, leg, goal, facing(own))
    return small


def _lifted(own: Array, other: Array) -> Array:
    """(T,) how far a person is in the air beside the other, who stands: 0 to 1."""
    up = (own[:, TOES, 1].min(axis=1) > _LIFTED) & (own[:, 0, 1] > _HELD_UP)
    stands = other[:, TOES, 1].min(axis=1) <= _LIFTED
    near = np.linalg.norm((own[:, 0] - other[:, 0]) * FLAT, axis=-1) < _CARRIES
    return eased_marks(without_flicker(up & stands & near, _SHORTEST), _RISES)


def _raised(made: Array, small: Array, person: int, way: float) -> Array:
    """(T, 1, 3) what takes a carried person's chest to where it is for the one who carries them, above the floor."""
    between = made[person, :, _CHEST] - made[1 - person, :, _CHEST]
    goal = small[1 - person, :, _CHEST] + between * [way, 1.0, way]
    shift = goal - small[person, :, _CHEST]
    shift[:, 1] = np.maximum(shift[:, 1], -small[person, :, TOES, 1].min(axis=0))
    return np.asarray(shift[:, None])


# ---- hands that meet -----------------------------------------------------------------------------
# Where a hand was at the other's hand, both go to one place that both reach. Where it was at the other's body, it goes
# to the same place of the body as it is now; on a trunk it is nearer to the height of the hand itself: a child hugs
# its mother's waist, and she its shoulders. The taller of the two stoops as far as arms are too short, over feet that
# stay. Heads that were turned to the other's are turned to where that is now.


_HELD = (0.2, 0.42)
"""Metres between two wrists, of adults, up to which hands hold each other, and from which they are free."""
_TOUCHES = (0.17, 0.36)
"""Metres from a wrist to a bone of the other, up to which the hand touches, and from which it does not."""
_BLUR = 0.03
"""Metres by which bones may be farther away than the nearest and be touched as well."""
_OWN_HEIGHT = (0.5, 0.9)
"""Shares of the way to its own height that a hand goes along the other's trunk: it alone, and in an embrace."""
_FROM_ABOVE = (0.0, 0.2, 0.85)
"""Metres of a shoulder above the joint of the other's head up to which a hand at the head stays where it was, and from
which it is laid upon it; and how far at most."""
_CROWN = (0.08, 0.19)
"""Metres from the joint of an adult's head to the wrist of a hand upon it: towards that hand's shoulder, and up."""
_REACH = 0.965
"""Share of an arm's length that a hand reaches."""
_HANGS = 0.01
"""Metres beside its line by which an arm counts as bent downwards and back: what is straight has no side."""
_ROUNDS, _STOOPS, _SHARES = 2, 3, 12
"""Rounds in which hands reach for each other, in which the taller stoops, and in which a place is sought that two hands
reach."""
_LEANS, _BENDS, _MOST_LEAN, _BACK = 2.2, 0.45, 1.0, 0.16
"""Radians of lean, and metres by which the hips sink, for a metre by which an arm is too short; radians at most; and
metres that the hips go back for a radian."""
_LATE = 10
"""Frames to both sides over which the deepest stoop counts, and over which it is smoothed."""
_CERTAIN, _SPARED = (0.5, 1.0), 0.03
"""How much so a hand touches for the taller to stoop for it, and metres by which an arm may be too short."""
_HEADS = 0.34
"""Metres between two heads at a kiss, at most."""
_SEES, _NODS = (0.3, 0.7), 0.6
"""Cosines between where a chest faces and the other's head from which a head follows it; radians of a nod at most."""
_J = SMPL22.index
_NECK, _HEAD = _J("neck"), _J("head")
_BONES = (
    (0, _CHEST),
    (_CHEST, _NECK),
    *((_J(f"{side}_collar"), arm[0]) for side, arm in zip(("left", "right"), ARMS, strict=True)),
    (_NECK, _HEAD),
    *(bone for side in (0, 1) for limb in (ARMS[side], LEGS[side][:3]) for bone in itertools.pairwise(limb)),
)
_TRUNK = 4
"""The first of these, on which a hand slides up and down; the next is that of the head."""


def met_again(made: Array, small: Array, sizes: tuple[float, float]) -> Array:
    """Two people at their own sizes who touch each other where they did before.

    Args:
        made: (2, T, 22, 3) metres, both as adults.
        small: (2, T, 22, 3) the same motion at their own sizes, on their own ways.
        sizes: of their bones.

    Returns:
        (2, T, 22, 3) on bones as long as those of ``small``, with feet in the same places.
    """
    touch = _Touches(made, (sizes[0] + sizes[1]) / 2)
    tall = int(np.argmax(sizes))
    result, lean = small.copy(), np.zeros(small.shape[1])
    for _ in range(_STOOPS):
        more = _too_short(result, touch) * smoothstep(made[tall, :, 0, 1], *_ON_FEET)
        if not more.any():
            break
        by = np.minimum(_LEANS * more, _MOST_LEAN - lean)
        result[tall] = _stooped(result[tall], result[1 - tall], by, more)
        lean += by
    result = _looking(made, result, [lean if person == tall else 0 * lean for person in (0, 1)])
    for _ in range(_ROUNDS):
        result = _reaching(result, touch.goals(result))
    return arms_apart(result, sizes=sizes)


class _Touches:
    """Touches of two adults: the places of the other that their hands are at.

    Args:
        made: (2, T, 22, 3) both as adults.
        scale: of what lies between a wrist and the bone that it is at.
    """

    def __init__(self, made: Array, scale: float) -> None:
        self.scale = scale
        wrists = made[:, :, [wrist for *_, wrist in ARMS]]
        apart = wrists[0][:, :, None] - wrists[1][:, None]  # (T, hand of a, hand of b, 3)
        self.held = 1 - smoothstep(np.linalg.norm(apart, axis=-1), *_HELD)
        self.apart = scale * apart
        self.heads = made[1, :, _HEAD] - made[0, :, _HEAD]
        self.body = [[_Touch(made[1 - p], made[p, :, wrist]) for *_, wrist in ARMS] for p in (0, 1)]
        self.embrace = np.minimum(*(np.maximum(one.near, other.near) for one, other in self.body))

    def goals(self, pair: Array) -> list[list[tuple[Array, Array]]]:
        """For each hand of both people where it should be (T, 3), and how much so (T, 1)."""
        goals_by_limb: list[list[tuple[Array, Array]]] = []
        meetings = self._meetings(pair)
        for person in (0, 1):
            hands = []
            for hand in (0, 1):
                held = self.held[:, hand] if person == 0 else self.held[:, :, hand]  # (T, 2)
                share = held / np.maximum(held.sum(axis=1, keepdims=True), 1e-9)
                half = 0.5 if person == 0 else -0.5
                to = [
                    meetings[mine, theirs] + half * self.apart[:, mine, theirs]
                    for mine, theirs in (((hand, i) if person == 0 else (i, hand)) for i in (0, 1))
                ]
                there = share[:, :1] * to[0] + share[:, 1:] * to[1]
                grip = held.max(axis=1, keepdims=True)
                touch = self.body[person][hand]
                at = touch.place(pair[1 - person], pair[person][:, ARMS[hand]], self.scale, self.embrace)
                goal = grip * there + (1 - grip) * at
                hands.append((goal, np.maximum(grip, touch.near[:, None])))
            goals_by_limb.append(hands)
        return goals_by_limb

    def _meetings(self, pair: Array) -> dict[tuple[int, int], Array]:
        """(T, 3) the place at which each hand of a's meets each of b's: as near to both as both reach."""
        meetings = {}
        for mine, theirs in itertools.product((0, 1), (0, 1)):
            arms = (pair[0], ARMS[mine]), (pair[1], ARMS[theirs])
            place = 0.5 * sum(own[:, arm[-1]] for own, arm in arms)
            if self.held[:, mine, theirs].any():
                for _ in range(_SHARES):
                    for (own, arm), side in zip(arms, (0.5, -0.5), strict=True):
                        wrist = place + side * self.apart[:, mine, theirs]
                        place = place + _reached(wrist, own, arm) - wrist
            meetings[mine, theirs] = place
        return meetings


class _Touch:
    """The place of the other's body that one hand touches.

    Args:
        other: (T, 22, 3) the other as an adult.
        wrist: (T, 3)
    """

    def __init__(self, other: Array, wrist: Array) -> None:
        start, end = (other[:, [bone[i] for bone in _BONES]] for i in (0, 1))
        along = end - start
        length = np.maximum(np.sum(along**2, axis=-1), 1e-9)
        self.share = np.clip(np.sum((wrist[:, None] - start) * along, axis=-1) / length, 0.0, 1.0)
        self.off = wrist[:, None] - (start + self.share[..., None] * along)
        away = np.linalg.norm(self.off, axis=-1)
        nearest = away.min(axis=1)
        self.weight = np.exp((nearest[:, None] - away) / _BLUR)
        self.near = 1 - smoothstep(nearest, *_TOUCHES)

    def place(self, other: Array, arm: Array, scale: float, embrace: Array) -> Array:
        """(T, 3) the same place of the other's body (T, 22, 3) as it is now, for the hand of an arm (T, 3, 3).

        Where two embrace (T,) each other, arms go round the trunk, and not round the neck. A hand from above is laid
        upon the head.
        """
        start, end = (other[:, [bone[i] for bone in _BONES]] for i in (0, 1))
        places = start + self.share[..., None] * (end - start) + scale * self.off
        low, high = (other[:, [joint], 1] for joint in (0, _NECK))
        own = np.clip(arm[:, 2, 1:2], np.minimum(low, high), np.maximum(low, high))
        on_trunk = places[:, :_TRUNK, 1]
        slide = _OWN_HEIGHT[0] + (_OWN_HEIGHT[1] - _OWN_HEIGHT[0]) * embrace[:, None]
        places[:, :_TRUNK, 1] += slide * (own - on_trunk)
        head = other[:, _HEAD]
        over = _FROM_ABOVE[2] * smoothstep(arm[:, 0, 1] - head[:, 1], *_FROM_ABOVE[:2])[:, None]
        crown = head + scale * (_CROWN[0] * unit((arm[:, 0] - head) * FLAT) + [0.0, _CROWN[1], 0.0])
        places[:, _TRUNK] += over * (crown - places[:, _TRUNK])
        weight = self.weight.copy()
        weight[:, _TRUNK] *= 1 - embrace
        weight /= np.maximum(weight.sum(axis=1, keepdims=True), 1e-9)
        return np.asarray(np.einsum("tb,tbi->ti", weight, places))


def _reached(wrist: Array, own: Array, arm: tuple[int, ...]) -> Array:
    """(T, 3) a place for a wrist, drawn in to where the arm reaches."""
    return drawn_in(wrist, own[:, arm[0]], _REACH * limb_length(own, arm))


def _reaching(pair: Array, goals: list[list[tuple[Array, Array]]]) -> Array:
    """Two people whose hands go to their goals as far as arms reach; elbows stay on the side on which they were."""
    result = pair.copy()
    for person, hands in enumerate(goals):
        forward = facing(pair[person])
        for arm, (goal, weight) in zip(ARMS, hands, strict=True):
            if not weight.any():
                continue
            root, middle, end = (result[person, :, joint] for joint in arm)
            to = end + weight * (_reached(goal, result[person], arm) - end)
            pole = unit(middle - 0.5 * (root + end) + _HANGS * (np.array([0.0, -1.0, 0.0]) - forward))
            bent, met = solve_two_bones(root, middle, end, to, pole)
            result[person, :, arm[1]], result[person, :, arm[2]] = bent, met
    return result


def _too_short(pair: Array, touch: _Touches) -> Array:
    """(T,) metres by which arms, and heads that kiss, miss their goals, smooth in time."""
    need = np.zeros(pair.shape[1])
    for person, hands in enumerate(touch.goals(pair)):
        for arm, (goal, weight) in zip(ARMS, hands, strict=True):
            missed = np.linalg.norm(goal - _reached(goal, pair[person], arm), axis=-1)
            certain = smoothstep(weight[:, 0], *_CERTAIN)
            need = np.maximum(need, certain * np.maximum(missed - _SPARED, 0.0))
    kiss = 1 - smoothstep(np.linalg.norm(touch.heads, axis=-1), 0.8 * _HEADS, 1.2 * _HEADS)
    kiss *= 1 - touch.embrace
    now = np.linalg.norm(pair[1, :, _HEAD] - pair[0, :, _HEAD], axis=-1)
    apart = touch.scale * np.linalg.norm(touch.heads, axis=-1)
    need = np.maximum(need, kiss * np.maximum(now - apart, 0.0))
    if need.max() < 0.005:
        return 0 * need
    return begun_before(need, _LATE, _EASED)


def _stooped(own: Array, other: Array, lean: Array, short: Array) -> Array:
    """A person (T, 22, 3) who leans to the other by radians (T,) and bends the knees, over feet that stay."""
    way = unit((other[:, _NECK] - own[:, _NECK]) * FLAT)
    axis = left_of(way)
    turn = rotations_by(lean[:, None] * axis)
    moved = own.copy()
    leaned = own[:, :1] + np.einsum("tij,tkj->tki", turn, own - own[:, :1])
    moved[:, UPPER] = leaned[:, UPPER]
    shift = -_BACK * lean[:, None] * way - (_BENDS * short)[:, None] * [0.0, 1.0, 0.0]
    moved[:, [*UPPER, *HIPS]] += shift[:, None]
    return over_planted_feet(own, moved)


def _looking(made: Array, pair: Array, leans: list[Array]) -> Array:
    """Two people whose heads nod by as much as the other's head is now higher or lower, where they faced it."""
    result = pair.copy()
    for person in (0, 1):
        own, other = pair[person], pair[1 - person]
        before, now = (_elevation(p[1 - person, :, _HEAD] - p[person, :, _HEAD]) for p in (made, pair))
        ahead = facing(own)
        towards = unit((other[:, _HEAD] - own[:, _HEAD]) * FLAT)
        faces = smoothstep(np.sum(ahead * towards, axis=-1), *_SEES)
        angle = faces * np.clip(now - before + leans[person], -_NODS, _NODS)
        angle = scipy.ndimage.gaussian_filter1d(angle, _EASED, mode="nearest")
        right = np.cross(ahead, [0.0, 1.0, 0.0])
        turn = rotations_by(angle[:, None] * right)
        result[person, :, _HEAD] = own[:, _NECK] + np.einsum("tij,tj->ti", turn, own[:, _HEAD] - own[:, _NECK])
    return result


def _elevation(way: Array) -> Array:
    """(T,) radians by which a direction (T, 3) points upwards."""
    return np.asarray(np.arctan2(way[:, 1], np.linalg.norm(way * FLAT, axis=-1)))
