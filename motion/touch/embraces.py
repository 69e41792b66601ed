"""Embraces: people who reach around each other come close, and their hands lie on the other's back.

A network that was trained on bodies of lines has people hug at arm's length, with arms stretched out past the other.
Where both do so, the trunks lean to each other over feet that stay, each head beside the other's. Each right arm goes
over the other's left shoulder, and each left arm below the other's right one; elbows bend outwards.
A person who holds the other from behind comes close to their back and reaches around the waist; the other lays their
arms upon these.
:func:`motion.touch.arms.arms_apart` then bends the arms around what is still in their way.
"""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.kinematics import swing
from motion.limbs import HIPS, UPPER, across, bent_towards, over_planted_feet
from motion.skeleton import ARMS, LEGS, SMPL22
from motion.smoothing import eased_marks, without_flicker
from motion.transforms import facing
from motion.vectors import FLAT, Array, left_of, unit

from .arms import grips_of_hands

Hands = tuple[tuple[float, float, float, float], ...]

CLOSE = 0.29
"""Metres between two spines in an embrace: two chests touch."""
_MOST = 0.75
"""Metres between two spines beyond which arms that are held out are no embrace."""
_AROUND = (-0.2, 0.27)
"""Metres past the other's chest, at least, and beside it, at most, of a wrist that is around the other."""
_HANDS = ((0.05, 0.14, -0.17, 1.2), (0.05, 0.07, 0.15, 0.0))
"""Of the left and of the right wrist: metres past the other's spine, beside it and over it, and how far the elbow
hangs for a metre outwards. Of hundreds drawn at random, such hands leave few arms in the other's body, and the hands
beyond the wrists stand out least behind it."""
_CLOSE_BEHIND = 0.27
"""Metres between two spines where one holds the other from behind."""
_ASIDE_BEHIND = 0.06
_WAIST = ((0.1, 0.13, -0.17, 0.2), (0.12, 0.12, -0.14, 0.2))
"""As :data:`_HANDS`, for hands around the waist of a person who faces the same way."""
_UPON = ((0.21, 0.12, -0.12, 0.9), (0.23, 0.12, -0.09, 0.9))
"""As :data:`_HANDS`, of the hands that the person who is held lays upon them, from their own spine."""
_OPEN, _OPENS = (-0.12, 0.36), 1.0
"""Metres past the other's spine and beside it of a wrist whose arm is open, and its share of the height at which the
hand will lie."""
_SHARE = 0.55
"""Share of the way to the other that the pelvis goes; the rest is lean."""
_ASIDE = 0.13
"""Metres by which two heads pass each other, each to its own left."""
_LEVEL = 0.15
"""Metres between the heights of two pelvises up to which both stand."""
_EASE, _SHORTEST = 24, 10
"""Frames in which people come close and part, and of the shortest embrace."""
_FACES = 0.5
"""Cosine between the ways that people face and the way to the other, at least."""
_LIFTED = 0.12
"""Height in metres of the lifted person's lower toe."""
_SPINE = SMPL22.index("spine3")
_TOES = [leg[-1] for leg in LEGS]


def embraced(pair: Array, free: Array | None = None) -> Array:
    """Two people who come close where both reach around each other, with hands on the other's back.

    Args:
        pair: (2, T, 22, 3) metres on constant bones.
        free: (T,) how far a frame may be changed, 0 to 1; wholly by default.

    Returns:
        (2, T, 22, 3) metres; what is no embrace stays as it is.
    """
    result = np.array(pair, dtype=np.float64)
    share = np.ones(result.shape[1]) if free is None else free
    close = share * _eased(_hugs(result), result)
    if close.any():
        drawn = [_drawn(result[p], result[1 - p], close) for p in (0, 1)]
        ways = [_way(drawn[p], drawn[1 - p]) for p in (0, 1)]
        result = np.stack([_wrapped(drawn[p], drawn[1 - p][:, _SPINE], ways[p], _HANDS, close) for p in (0, 1)])
    for holder in (0, 1):
        own, other = result[[holder, 1 - holder]]
        close = share * _eased(_holds_from_behind(own, other), result)
        if close.any():
            result[[holder, 1 - holder]] = _held_from_behind(own, other, close)
    return result


def _held_from_behind(own: Array, other: Array, close: Array) -> Array:
    """The person behind, with their arms around the waist by ``close`` (T,), and the other: (2, T, 22, 3)."""
    own = _drawn(own, other, close, 1.0, _CLOSE_BEHIND, _ASIDE_BEHIND)
    way = _way(own, other)
    own = _wrapped(own, other[:, _SPINE], way, _WAIST, close)
    return np.stack([own, _wrapped(other, other[:, _SPINE], way, _UPON, close)])


def _around(own: Array, other: Array, least: float = _AROUND[0]) -> NDArray[np.bool_]:
    """(T, side) hands that are ``least`` metres past the other's spine, at the height of their trunk."""
    spine = other[:, _SPINE]
    way = _way(own, other)
    across = left_of(way)
    low, high = other[:, 0, 1], other[:, SMPL22.index("neck"), 1] + 0.05
    found = []
    for *_, wrist in ARMS:
        hand = own[:, wrist] - spine
        past = np.einsum("ti,ti->t", hand, way) > least
        beside = np.abs(np.einsum("ti,ti->t", hand, across)) < _AROUND[1]
        found.append(past & beside & (low < own[:, wrist, 1]) & (own[:, wrist, 1] < high))
    near = np.linalg.norm((spine - own[:, _SPINE]) * FLAT, axis=-1) < _MOST
    return np.stack(found, axis=1) & near[:, None]


def _hugs(pair: Array) -> NDArray[np.bool_]:
    """(T,) frames at which two who stand face to face have at least three arms around each other."""
    a, b = pair
    hands = np.stack([_around(a, b), _around(b, a)]) & (grips_of_hands(pair) < 0.5)  # hands that are held hold no back
    around = hands.sum(axis=(0, 2))
    way = _way(a, b)
    face = np.einsum("ti,ti->t", facing(a), way) > _FACES
    face &= np.einsum("ti,ti->t", facing(b), -way) > _FACES
    stands = np.abs(a[:, 0, 1] - b[:, 0, 1]) < _LEVEL
    return face & stands & (around >= 3)


def _holds_from_behind(own: Array, other: Array) -> NDArray[np.bool_]:
    """(T,) frames at which both hands of a person who stands behind the other are before them."""
    way = _way(own, other)
    same = np.minimum(np.einsum("ti,ti->t", facing(own), way), np.einsum("ti,ti->t", facing(other), way))
    stands = np.abs(own[:, 0, 1] - other[:, 0, 1]) < _LEVEL
    return np.asarray(_around(own, other, 0.03).all(axis=1) & (same > _FACES) & stands)


def _eased(marked: NDArray[np.bool_], pair: Array) -> Array:
    """(T,) how far each frame is an embrace of people on their feet, 0 to 1."""
    return eased_marks(_on_their_feet(without_flicker(marked, _SHORTEST), pair), _EASE)


def _on_their_feet(marked: NDArray[np.bool_], pair: Array) -> NDArray[np.bool_]:
    """Marked frames but for those at which, or next to which, somebody is lifted."""
    lifted = (pair[:, :, _TOES, 1].min(axis=2) > _LIFTED).any(axis=0)
    near = scipy.ndimage.binary_dilation(lifted, np.ones(2 * _EASE + 1)) if lifted.any() else lifted
    stretches, _ = scipy.ndimage.label(marked)
    return marked & ~np.isin(stretches, stretches[near])


def _drawn(
    own: Array, other: Array, weight: Array, share: float = 0.5, close: float = CLOSE, aside: float = _ASIDE / 2
) -> Array:
    """A person (T, 22, 3) who comes a share of the way to the other by ``weight`` (T,), over feet that stay."""
    way = _way(own, other)
    gap = np.linalg.norm((other[:, _SPINE] - own[:, _SPINE]) * FLAT, axis=-1)
    metres = share * weight * np.maximum(gap - close, 0.0)
    ahead = metres[:, None] * way + (aside * weight)[:, None] * left_of(way)
    shift = _SHARE * ahead
    result = own.copy()
    result[:, UPPER] = (_leaned(own, ahead - shift) + shift[:, None])[:, UPPER]
    result[:, HIPS] += shift[:, None]
    return over_planted_feet(own, result)


def _leaned(own: Array, ahead: Array) -> Array:
    """A person (T, 22, 3) whose trunk turns about the pelvis and takes the chest ``ahead`` by (T, 3) metres."""
    arm = own[:, _SPINE] - own[:, 0]
    turn = swing(arm, arm + ahead)
    return own[:, :1] + np.einsum("tij,tkj->tki", turn, own - own[:, :1])


def _wrapped(own: Array, spine: Array, way: Array, hands: Hands, weight: Array) -> Array:
    """A person (T, 22, 3) whose hands lie on the trunk around a ``spine`` (T, 3) by ``weight`` (T,).

    On their way there and back the arms open to the sides, and go round the other instead of through them.
    """
    result = own.copy()
    left, up = left_of(way), np.array([0.0, 1.0, 0.0])
    w = weight[:, None]
    for (shoulder, elbow, wrist), side, (past, beside, height, hang) in zip(ARMS, (1.0, -1.0), hands, strict=True):
        goal = spine + past * way + beside * side * left + height * up
        opened = spine + _OPEN[0] * way + _OPEN[1] * side * left + _OPENS * height * up
        goal = (1 - w) ** 2 * own[:, wrist] + 2 * w * (1 - w) * opened + w**2 * goal
        pole = side * left - hang * up
        bends = across(own[:, elbow] - own[:, shoulder], own[:, wrist] - own[:, shoulder])
        pole = (1 - w) ** 2 * bends + (1 - (1 - w) ** 2) * pole
        moves = weight > 0
        bent, met = bent_towards(own[:, shoulder], own[:, elbow], own[:, wrist], goal, pole)
        result[moves, elbow], result[moves, wrist] = bent[moves], met[moves]
    return result


def _way(own: Array, other: Array) -> Array:
    """(T, 3) the level way from one person's spine to the other's."""
    return unit((other[:, _SPINE] - own[:, _SPINE]) * FLAT)
