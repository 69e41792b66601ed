"""Arms beside the other's body instead of in it: two people who hold each other, arm by arm.

A network, and a plan that says where a wrist is, know nothing of how thick a body is. What is in the other's body is
moved out where it is nearest to the surface: elbows and wrists are pushed, and the arm bends around what it would go
through. Pushes are smooth in time, shoulders and lengths of bones stay.
"""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.limbs import solve_two_bones
from motion.metrics.bodies import CAPSULES
from motion.skeleton import ARMS
from motion.vectors import Array, runs

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
_AROUND = 1e-3
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
    found = np.zeros(pair.shape[1], dtype=bool)
    at = np.flatnonzero(near)
    grips = grips_of_hands(pair[:, at])
    for person in (0, 1):
        push = _pushes(pair[person][at], pair[1 - person][at], grips[person], sizes[person], sizes[1 - person])
        found[at] |= np.abs(push).max(axis=(1, 2, 3)) > 0
    return found


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
        upper = bend - person[:, shoulder]
        length = np.linalg.norm(person[:, elbow] - person[:, shoulder], axis=-1, keepdims=True)
        bend = person[:, shoulder] + upper * length / np.maximum(np.linalg.norm(upper, axis=-1, keepdims=True), 1e-9)
        lower = np.linalg.norm(person[:, wrist] - person[:, elbow], axis=-1, keepdims=True)
        ahead = goal - bend
        end = bend + ahead * lower / np.maximum(np.linalg.norm(ahead, axis=-1, keepdims=True), 1e-9)
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
    found = np.zeros((len(own), 2, 2, 3))
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
        held = grips[:, side, None, None] * np.array([lower for lower, _ in _SHARES])[:, None]
        depth *= np.where(an_arm, 1 - held, 1.0)
        weights = depth * give
        total = weights.sum(axis=-1)
        way = np.einsum("npc,npci->npi", weights / np.maximum(distance, _AROUND), out)
        size = np.linalg.norm(way, axis=-1, keepdims=True)
        push = way / np.maximum(size, 1e-9) * (depth * give).max(axis=-1)[..., None]
        push[total <= 0] = 0.0
        lower = np.array([share for share, _ in _SHARES])
        for joint, weight in ((0, 1 - lower), (1, lower)):
            each = push * weight[:, None]
            biggest = np.abs(each).max(axis=1)
            found[:, side, joint] = np.where(each.max(axis=1) >= biggest, each.max(axis=1), each.min(axis=1))
    return found
