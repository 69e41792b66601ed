"""Hands that touched the other person, and eyes that looked at them, at people's own sizes.

Where a hand was at the other's hand, both go to one place that both reach. Where it was at the other's body, it goes to
the same place of the body as it is now; on a trunk it is nearer to the height of the hand itself: a child hugs its
mother's waist, and she its shoulders. The taller of the two stoops as far as arms are too short, over feet that stay.
Heads that were turned to the other's are turned to where that is now.
"""

from __future__ import annotations

import itertools

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from .limbs import HIPS, UPPER, drawn_in, limb_length, over_planted_feet, solve_two_bones
from .skeleton import ARMS, SMPL22
from .smoothing import begun_before, smoothstep
from .touch.arms import arms_apart
from .transforms import facing
from .vectors import FLAT, rotations_by, unit

Array = NDArray[np.floating]

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
_ROUNDS, _STOOPS = 2, 3
_SHARES = 12
"""Rounds in which a place is sought that two hands reach."""
_LEANS, _BENDS, _MOST_LEAN, _BACK = 2.2, 0.45, 1.0, 0.16
"""Radians of lean, and metres by which the hips sink, for a metre by which an arm is too short; radians at most; and
metres that the hips go back for a radian."""
_ON_FEET = (0.55, 0.75)
"""Heights in metres of a pelvis up to which nobody stoops, and from which they do."""
_LATE, _EASED = 10, 5.0
"""Frames to both sides over which the deepest stoop counts, and over which it is smoothed."""
_CERTAIN, _SPARED = (0.5, 1.0), 0.03
"""How much so a hand touches for the taller to stoop for it, and metres by which an arm may be too short."""
_HEADS = 0.34
"""Metres between two heads at a kiss, at most."""
_SEES, _NODS = (0.3, 0.7), 0.6
"""Cosines between where a chest faces and the other's head from which a head follows it; radians of a nod at most."""
_J = SMPL22.index
_LIMBS = (("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle"))
_BONES = tuple(
    (_J(start), _J(end))
    for start, end in (
        ("pelvis", "spine3"),
        ("spine3", "neck"),
        ("left_collar", "left_shoulder"),
        ("right_collar", "right_shoulder"),
        ("neck", "head"),
        *((f"{side}_{start}", f"{side}_{end}") for side in ("left", "right") for start, end in _LIMBS),
    )
)
_TRUNK = 4
"""The first of these, on which a hand slides up and down; the next is that of the head."""
_NECK, _HEAD = _J("neck"), _J("head")


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
        found: list[list[tuple[Array, Array]]] = []
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
            found.append(hands)
        return found

    def _meetings(self, pair: Array) -> dict[tuple[int, int], Array]:
        """(T, 3) the place at which each hand of a's meets each of b's: as near to both as both reach."""
        found = {}
        for mine, theirs in itertools.product((0, 1), (0, 1)):
            arms = (pair[0], ARMS[mine]), (pair[1], ARMS[theirs])
            place = 0.5 * sum(own[:, arm[-1]] for own, arm in arms)
            if self.held[:, mine, theirs].any():
                for _ in range(_SHARES):
                    for (own, arm), side in zip(arms, (0.5, -0.5), strict=True):
                        wrist = place + side * self.apart[:, mine, theirs]
                        place = place + _reached(wrist, own, arm) - wrist
            found[mine, theirs] = place
        return found


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
    axis = np.cross([0.0, 1.0, 0.0], way)
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
