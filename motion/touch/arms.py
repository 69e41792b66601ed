"""Arms of two people who hold each other: beside the other's body instead of in it, and around it in an embrace."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.kinematics import swing
from motion.limbs import HIPS, UPPER, across, bent_towards, over_planted_feet, solve_two_bones
from motion.metrics.bodies import CAPSULES
from motion.skeleton import ARMS, SMPL22, TOES
from motion.smoothing import eased_marks, without_flicker
from motion.transforms import facing
from motion.vectors import FLAT, Array, left_of, runs, unit

# ---- Arms that are in the other's body -------------------------------------------------------------------------------
# A network, and a plan that says where a wrist is, know nothing of how thick a body is. What is in the other's body is
# moved out where it is nearest to the surface: elbows and wrists are pushed, and the arm bends around what it would go
# through. Pushes are smooth in time, shoulders and lengths of bones stay.
SOFT = 0.008
"""Metres that an arm may be in the other's body: clothes and flesh give way as far as that."""
_SOFT_ARMS = 0.018
"""The same for an arm in the other's arm: hands that hold each other stay together."""
_NEAR = 1.5
"""Metres between two pelvises beyond which no arm reaches the other."""
_ROUNDS = 12
_SMOOTH = 2.0
"""Frames over which a push is spread (standard deviation): pushes that follow the other closely are jolts."""
_SHARES = ((0.0, 0.6), (0.0, 1.0), (0.35, 1.0), (0.7, 1.0), (1.0, 1.0))
"""Points of an arm: the share of the forearm and of the upper arm at which each lies."""
_RADII = np.array([0.045, 0.045, 0.038, 0.036, 0.035])
_GRIPS = (0.18, 0.28)
"""Metres between two wrists up to which the hands hold each other and stay, and from which they are free."""
_ON_LINE = 1e-3
"""Metres from the middle line of a capsule below which a push has no direction of its own."""
_BENDS = np.array([arm[1:] for arm in ARMS])
"""(side, elbow and wrist) of the joints that are pushed."""
_BODY = CAPSULES.part(~CAPSULES.are("ankle", "foot"))


def arms_apart(pair: Array, free: Array | None = None, sizes: tuple[float, float] = (1.0, 1.0)) -> Array:
    """Two people whose arms are not in each other's bodies, as far as two bones allow.

    Args:
        pair: (2, T, 22, 3) metres on constant bones.
        free: (2, T) how far what a person does may be changed, 0 to 1; wholly by default.
        sizes: of both bodies, as shares of an adult's.

    Returns:
        (2, T, 22, 3) with other elbows and wrists.
    """
    result = np.array(pair, dtype=np.float64)
    share = np.ones(result.shape[:2]) if free is None else np.asarray(free, dtype=np.float64)
    near = np.linalg.norm(result[0, :, 0] - result[1, :, 0], axis=-1) < _NEAR
    if not near.any():
        return result
    for first, last in _stretches(_touching(result, near, sizes)):
        inside = slice(first, last)
        result[:, inside] = _resolved(result[:, inside], share[:, inside], sizes)
    return result


def _touching(pair: Array, near: NDArray[np.bool_], sizes: tuple[float, float]) -> NDArray[np.bool_]:
    """(T,) frames at which an arm is in the other's body."""
    touching = np.zeros(pair.shape[1], dtype=bool)
    at = np.flatnonzero(near)
    grips = grips_of_hands(pair[:, at])
    for person in (0, 1):
        push = _pushes(pair[person][at], pair[1 - person][at], grips[person], sizes[person], sizes[1 - person])
        touching[at] |= np.abs(push).max(axis=(1, 2, 3)) > 0
    return touching


def _stretches(marked: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(first, last) of the stretches of marked frames, with room to ease in and out."""
    room = 3 * int(np.ceil(_SMOOTH)) + 4
    wide = scipy.ndimage.binary_dilation(marked, np.ones(2 * room + 1)) if marked.any() else marked
    return runs(wide)


def _resolved(pair: Array, share: Array, sizes: tuple[float, float]) -> Array:
    """Some frames (2, N, 22, 3) with their arms pushed out."""
    result, grips = pair.copy(), grips_of_hands(pair)
    for _ in range(_ROUNDS):
        pushes = np.stack([_pushes(result[p], result[1 - p], grips[p], sizes[p], sizes[1 - p]) for p in (0, 1)])
        if not pushes.any():
            break
        moved = (result - pair)[:, :, _BENDS] + pushes
        moved = scipy.ndimage.gaussian_filter1d(moved, _SMOOTH, axis=1, mode="nearest")
        for person in (0, 1):
            wanted = share[person][:, None, None, None] * moved[person]
            result[person] = _bent(pair[person], wanted, grips[person])
    return result


def grips_of_hands(pair: Array) -> Array:
    """(2, N, side) 1 for hands that are at a hand of the other's, 0 for those that are away from both."""
    wrists = pair[:, :, [wrist for *_, wrist in ARMS]]
    gaps = np.linalg.norm(wrists[0][:, :, None] - wrists[1][:, None], axis=-1)
    nearest = np.stack([gaps.min(axis=2), gaps.min(axis=1)])
    return np.asarray(np.clip((_GRIPS[1] - nearest) / (_GRIPS[1] - _GRIPS[0]), 0.0, 1.0))


def _bent(person: Array, moved: Array, grips: Array) -> Array:
    """A person (N, 22, 3) whose elbows and wrists are moved (N, side, 2, 3), on bones as long as before.

    Hands that hold the other's (``grips`` (N, side)) go where they are pushed, and no further to spare their elbows.
    """
    result = person.copy()
    for side, (shoulder, elbow, wrist) in enumerate(ARMS):
        bend = person[:, elbow] + moved[:, side, 0]
        grip = grips[:, side, None]
        goal = person[:, wrist] + moved[:, side, 1]
        upper = np.linalg.norm(person[:, elbow] - person[:, shoulder], axis=-1, keepdims=True)
        bend = person[:, shoulder] + unit(bend - person[:, shoulder]) * upper
        lower = np.linalg.norm(person[:, wrist] - person[:, elbow], axis=-1, keepdims=True)
        end = bend + unit(goal - bend) * lower
        # Half way between the arm that keeps its elbow and the one that keeps its hand.
        goal = goal + 0.5 * (1 - grip) * (end - goal)
        bent, met = solve_two_bones(person[:, shoulder], bend, end, goal, bend - person[:, wrist])
        goes = moved[:, side].any(axis=(1, 2))
        result[goes, elbow], result[goes, wrist] = bent[goes], met[goes]
    return result


def _pushes(own: Array, other: Array, grips: Array, own_size: float, other_size: float) -> Array:
    """(N, side, elbow and wrist, 3) metres that take the arms of ``own`` (N, 22, 3) out of ``other``.

    An arm that is in the other's arm goes half of the way: the other's goes the rest. Where its hand holds one of the
    other's (``grips`` (N, side)) the other's arms do not push it.
    """
    starts, along = other[:, _BODY.starts], other[:, _BODY.ends] - other[:, _BODY.starts]
    length2 = np.maximum(np.einsum("nci,nci->nc", along, along), 1e-12)
    an_arm = _BODY.are("elbow", "wrist")
    give, soft = np.where(an_arm, 0.5, 1.0), np.where(an_arm, _SOFT_ARMS, SOFT)
    pushes = np.zeros((len(own), 2, 2, 3))
    for side, (shoulder, elbow, wrist) in enumerate(ARMS):
        points = np.stack(
            [
                own[:, shoulder] + upper * (own[:, elbow] - own[:, shoulder]) + lower * (own[:, wrist] - own[:, elbow])
                for lower, upper in _SHARES
            ],
            axis=1,
        )  # (N, P, 3)
        between = points[:, :, None] - starts[:, None]
        along_it = np.clip(np.einsum("npci,nci->npc", between, along) / length2[:, None], 0, 1)
        out = between - along_it[..., None] * along[:, None]
        distance = np.sqrt(np.einsum("npci,npci->npc", out, out))
        depth = np.maximum(own_size * _RADII[:, None] + other_size * _BODY.radii - soft - distance, 0.0)
        if not depth.any():
            continue
        lower = np.array([share for share, _ in _SHARES])
        held = grips[:, side, None, None] * lower[:, None]
        depth *= np.where(an_arm, 1 - held, 1.0)
        weights = depth * give
        way = np.einsum("npc,npci->npi", weights / np.maximum(distance, _ON_LINE), out)
        size = np.linalg.norm(way, axis=-1, keepdims=True)
        push = way / np.maximum(size, 1e-9) * weights.max(axis=-1)[..., None]
        for joint, weight in ((0, 1 - lower), (1, lower)):
            each = push * weight[:, None]
            biggest = np.abs(each).max(axis=1)
            pushes[:, side, joint] = np.where(each.max(axis=1) >= biggest, each.max(axis=1), each.min(axis=1))
    return pushes


# ---- Embraces: people who reach around each other come close, and their hands lie on the other's back ---------------
# A network that was trained on bodies of lines has people hug at arm's length, with arms stretched out past the other.
# Where both do so, the trunks lean to each other over feet that stay, each head beside the other's. Each right arm goes
# over the other's left shoulder, and each left arm below the other's right one; elbows bend outwards.
# A person who holds the other from behind comes close to their back and reaches around the waist; the other lays their
# arms upon these.
# ``arms_apart`` then bends the arms around what is still in their way.
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
    masks = []
    for *_, wrist in ARMS:
        hand = own[:, wrist] - spine
        past = np.einsum("ti,ti->t", hand, way) > least
        beside = np.abs(np.einsum("ti,ti->t", hand, across)) < _AROUND[1]
        masks.append(past & beside & (low < own[:, wrist, 1]) & (own[:, wrist, 1] < high))
    near = np.linalg.norm((spine - own[:, _SPINE]) * FLAT, axis=-1) < _MOST
    return np.stack(masks, axis=1) & near[:, None]


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
    lifted = (pair[:, :, TOES, 1].min(axis=2) > _LIFTED).any(axis=0)
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
