"""Bodies beside each other instead of in each other: two people who stand or walk too close.

A network, and a plan that says where a pelvis is, know nothing of how wide a body is. Where two trunks, thighs or
upper arms are in each other, both bodies move apart along the line between them, smoothly; where it is shanks or feet,
the feet stand further apart. A foot that stands is set down elsewhere and stays there. Arms are left to
:func:`motion.touch.arms.arms_apart`. A person who is made for another does not stand where that one walks
(:func:`out_of_the_way`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.cleaning import foot_contacts
from motion.limbs import HIPS, UPPER, ankle_moved, over_planted_feet
from motion.metrics.bodies import CAPSULES, closest_points
from motion.skeleton import LEGS
from motion.smoothing import begun_before, eased_marks, minimum_jerk
from motion.transforms import facing
from motion.vectors import FLAT, Array, runs, unit

SOFT = 0.012
"""Metres that two bodies may be in each other: clothes and flesh give way as far as that."""
_NEAR = 1.2
"""Metres between two pelvises beyond which bodies do not touch."""
_UPRIGHT, _ON_FLOOR = 0.7, 0.12
"""Heights in metres of the pelvis at least, and of the lower toe at most, of a person on their feet."""
_EASE = 6
"""Frames beside those at which somebody is not on their feet over which bodies begin to be moved."""
_ROUNDS = 4
_MOST = 0.12
"""Metres by which a person is moved at most."""
_WIDE, _SMOOTH = 5, 5.0
"""Frames by which a push begins before it is needed, and over which pushes are spread (standard deviation)."""
_LEVEL = 0.4
"""Share of a push that goes over the floor, at least: bodies that lie over each other would go far."""
_ROOT = 0.4
"""Share of the upper arm that belongs to the body; the rest bends out of the way."""
_BODY = CAPSULES.part(~CAPSULES.are("wrist"))
_RAISED = 0.2
"""Height in metres of a toe from which a leg is raised."""


def bodies_apart(pair: Array, fps: float, free: Array | None = None) -> Array:
    """Two people on their feet whose trunks and legs are not in each other.

    Args:
        pair: (2, T, 22, 3) metres on constant bones, floor at 0.
        fps: frames a second.
        free: (T,) how far a frame may be changed, 0 to 1; wholly by default.

    Returns:
        (2, T, 22, 3) on bones as long as before.
    """
    result = np.array(pair, dtype=np.float64)
    near = np.linalg.norm((result[0] - result[1])[:, 0] * FLAT, axis=-1) < _NEAR
    share = _on_their_feet(result) * (1.0 if free is None else free)
    if not (near & (share > 0)).any():
        return result
    way = _way(result)
    bodies, feet = (np.zeros(result.shape[1]) for _ in range(2))
    contacts = [foot_contacts(person, fps) for person in pair]
    stands = [[runs(np.any(foot[:, 2 * side : 2 * side + 2], axis=1)) for side in (0, 1)] for foot in contacts]
    for _ in range(_ROUNDS):
        pushes = _pushes(result, way, near)
        if not any(push.any() for push in pushes):
            break
        bodies = np.minimum(bodies + share * begun_before(pushes[0], _WIDE, _SMOOTH), _MOST)
        feet = np.minimum(feet + share * begun_before(pushes[1], _WIDE, _SMOOTH), _MOST)
        result = np.stack(
            [
                _moved(pair[p], sign * bodies[:, None] * way, sign * feet[:, None] * way, stands[p])
                for p, sign in ((0, -0.5), (1, 0.5))
            ]
        )
    return _kicks_stopped(result, way, near, share)


def _kicks_stopped(pair: Array, way: Array, near: NDArray[np.bool_], share: Array) -> Array:
    """The two, with legs that are raised against the other ending at the other's body and not in it."""
    result = np.array(pair)
    for _ in range(_ROUNDS):
        before = result.copy()
        for person, sign in ((0, -1.0), (1, 1.0)):
            for leg in LEGS:
                raised = near & (before[person, :, leg[-1], 1] > _RAISED)
                depth = _leg_depth(before, person, leg, way, raised)
                if depth.any():
                    spread = share * begun_before(depth, 2, 2.0)
                    result[person] = _foot_moved(result[person], leg, sign * spread[:, None] * way)
    return result


def _leg_depth(pair: Array, person: int, leg: Sequence[int], way: Array, raised: NDArray[np.bool_]) -> Array:
    """(T,) metres that a shank and a foot are in the other's body along a level way, where they are raised."""
    deepest = np.zeros(len(way))
    at = np.flatnonzero(raised)
    if not len(at):
        return deepest
    starts, ends, radii, lower = _segments(pair[:, at])
    own = np.flatnonzero(np.isin(_BODY.ends, leg[2:]))
    other = np.flatnonzero(~lower)
    depth = _depth(
        starts[person][:, own],
        ends[person][:, own],
        radii[own],
        starts[1 - person][:, other],
        ends[1 - person][:, other],
        radii[other],
        way[at],
    )
    deepest[at] = depth.max(axis=(1, 2))
    return deepest


def _foot_moved(person: Array, leg: Sequence[int], by: Array) -> Array:
    """A person (T, 22, 3) with an ankle and a toe moved by (T, 3) metres, and the knee after them."""
    result = np.array(person)
    goes = np.abs(by).max(axis=1) > 0
    if goes.any():
        moved = result[goes]
        ankle_moved(moved, leg, moved[:, leg[2]] + by[goes], facing(moved))
        result[goes] = moved
    return result


def _on_their_feet(pair: Array) -> Array:
    """(T,) 1 where both are on their feet, easing to 0 where one is not."""
    toes = pair[:, :, [leg[-1] for leg in LEGS], 1].min(axis=2)
    down = ((pair[:, :, 0, 1] < _UPRIGHT) | (toes > _ON_FLOOR)).any(axis=0)
    return np.asarray(1 - eased_marks(down, _EASE))


def _way(pair: Array) -> Array:
    """(T, 3) the level way from one pelvis to the other."""
    line = scipy.ndimage.gaussian_filter1d((pair[1, :, 0] - pair[0, :, 0]) * FLAT, _SMOOTH, axis=0)
    return np.asarray(unit(line))


def _pushes(pair: Array, way: Array, near: NDArray[np.bool_]) -> tuple[Array, Array]:
    """(T,) metres by which two bodies, and their feet, are to be further apart along a level way (T, 3)."""
    at = np.flatnonzero(near)
    pushes = np.zeros((2, len(way)))
    starts, ends, radii, lower = _segments(pair[:, at])
    depth = _depth(starts[0], ends[0], radii, starts[1], ends[1], radii, way[at])
    of_legs = lower[:, None] | lower
    for kind, kept in enumerate((~of_legs, of_legs)):
        pushes[kind, at] = np.where(kept, depth, 0.0).max(axis=(1, 2))
    return pushes[0], pushes[1]


def _depth(
    start: Array, end: Array, radii: Array, other_start: Array, other_end: Array, other_radii: Array, way: Array
) -> Array:
    """(N, C, D) metres that capsules are in others along a way (N, 3)."""
    shape = (len(way), len(radii), len(other_radii), 3)
    one = (np.broadcast_to(each[:, :, None], shape).reshape(-1, 3) for each in (start, end))
    other = (np.broadcast_to(each[:, None], shape).reshape(-1, 3) for each in (other_start, other_end))
    here, there = closest_points(*one, *other)
    line = (there - here).reshape(shape)
    gap = np.linalg.norm(line, axis=-1)
    depth = np.maximum(radii[:, None] + other_radii - SOFT - gap, 0.0)
    along = np.abs(np.einsum("tabi,ti->tab", line, way)) / np.maximum(gap, 1e-6)
    return np.asarray(depth / np.maximum(along, _LEVEL))


def _segments(pair: Array) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
    """Middle lines from start to end (2, N, C, 3), radii (C,) and which are of shanks and feet (C,)."""
    starts, ends = pair[:, :, _BODY.starts], pair[:, :, _BODY.ends]
    ends = np.where(_BODY.are("elbow")[:, None], starts + _ROOT * (ends - starts), ends)
    return starts, ends, _BODY.radii, _BODY.are("ankle", "foot")


def _moved(person: Array, bodies: Array, feet: Array, stances: Sequence[Sequence[tuple[int, int]]]) -> Array:
    """A person (T, 22, 3) whose body goes aside by (T, 3) metres, and whose feet by as much as they need to."""
    if not (bodies.any() or feet.any()):
        return np.array(person)
    stood = np.array(person)
    for leg, steps in zip(LEGS, stances, strict=True):
        stood = _foot_moved(stood, leg, _set_aside(bodies, feet, steps))
    result = np.array(stood)
    result[:, [*UPPER, *HIPS]] += bodies[:, None]
    return over_planted_feet(stood, result)


def _set_aside(bodies: Array, feet: Array, stances: Sequence[tuple[int, int]]) -> Array:
    """(T, 3) metres by which a foot goes aside: while it stands, always as many."""
    known, values = [], []
    for start, stop in stances:
        value = _largest(feet[start:stop])
        value = _largest(np.stack([value, bodies[start:stop].mean(axis=0)]))
        known += [start, stop - 1]
        values += [value, value]
    if not known:
        return np.array(bodies)
    result = np.zeros_like(bodies)
    result[: known[0]], result[known[-1] :] = values[0], values[-1]
    for i in range(len(known) - 1):
        first, last = known[i], known[i + 1]
        share = minimum_jerk(np.arange(last - first + 1) / max(last - first, 1))[:, None]
        result[first : last + 1] = values[i] + share * (values[i + 1] - values[i])
    return result


def _largest(vectors: Array) -> Array:
    """The mean (3,) of the largest of some vectors (N, 3), each the heavier the larger it is."""
    size = np.linalg.norm(vectors, axis=1)
    weights = (size / max(float(size.max()), 1e-9)) ** 16
    return np.asarray((weights[:, None] * vectors).sum(axis=0) / max(float(weights.sum()), 1e-9))


# ---- Out of the way --------------------------------------------------------------------------------------------------
CLEAR = 0.55
"""Metres between two pelvises that pass each other: two bodies and some air."""
_WALKED_INTO, _WALKS = 0.3, 0.4
"""Metres between two pelvises below which one walks into the other, and metres a second from which people walk: who
stops in front of somebody to embrace them is slower by then."""
_INSIDE = 0.15
"""Metres between two pelvises below which two people are in each other whatever they do."""
_FARTHEST, _STEP = 8.0, 0.05
"""Metres over which a place is looked for, and between two places."""
_DIRECTIONS = 32
_ASIDE, _BACK = 4.0, 6.0
"""What a metre to the side, and one towards the other, counts beside one further away: a person who is addressed
stays in front, unless the other walks on and on."""
_LEAST = 30
"""Frames in which somebody whose first pose is given gets to another place, at least."""


def out_of_the_way(walker: Array, made: Array, fps: float, *, first_pose_given: bool = False) -> Array | None:
    """The way over the floor to a place where the other does not walk into a person.

    Args:
        walker: (T, 22, 3) metres, whose motion is given.
        made: (T, 22, 3) the other person.
        fps: frames a second.
        first_pose_given: their first frame stays; they go to their place before the other comes.

    Returns:
        (T, 3) metres by which the other is moved over the floor; None where nobody walks into them.
    """
    one, other = walker[:, 0, [0, 2]].astype(np.float64), made[:, 0, [0, 2]].astype(np.float64)
    into = _walks_into(one, other, fps)
    if not into.any():
        return None
    share: Array = np.ones(len(one))
    if first_pose_given:
        share = minimum_jerk(np.arange(len(one)) / max(int(np.argmax(into)) - fps / 2, _LEAST))
    ahead = other[0] - one[0]
    along = ahead / max(float(np.linalg.norm(ahead)), 1e-6)
    angles = np.linspace(-np.pi, np.pi, _DIRECTIONS, endpoint=False)
    towards = np.stack([np.cos(angles), np.sin(angles)], axis=-1) @ np.array([along, [-along[1], along[0]]])
    weights = np.hypot(np.cos(angles) * np.where(np.cos(angles) < 0, _BACK, 1.0), _ASIDE * np.sin(angles))
    lengths = np.arange(_STEP, _FARTHEST, _STEP)
    costs = np.outer(lengths, weights)
    for i in np.argsort(costs, axis=None):
        length, way = lengths[i // _DIRECTIONS], towards[i % _DIRECTIONS]
        moved = other + share[:, None] * length * way
        if _is_clear(one, moved, fps):
            return share[:, None] * np.array([length * way[0], 0.0, length * way[1]])
    return None


def _walks_into(one: Array, other: Array, fps: float) -> NDArray[np.bool_]:
    """(T,) whether one (T, 2) walks into the other, or is in them."""
    apart = np.linalg.norm(one - other, axis=-1)
    return (apart < _INSIDE) | ((apart < _WALKED_INTO) & _walking(one, fps))


def _is_clear(one: Array, moved: Array, fps: float) -> bool:
    apart = np.linalg.norm(one - moved, axis=-1)
    return bool((apart[_walking(one, fps)] >= CLEAR).all() and (apart >= _WALKED_INTO).all())


def _walking(one: Array, fps: float) -> NDArray[np.bool_]:
    """(T,) whether a pelvis (T, 2) moves as in a walk, over half a second."""
    reach = max(round(fps / 4), 1)
    frames = np.arange(len(one))
    first, last = np.maximum(frames - reach, 0), np.minimum(frames + reach, len(one) - 1)
    gone = np.linalg.norm(one[last] - one[first], axis=-1)
    return np.asarray(gone * fps / np.maximum(last - first, 1) > _WALKS)
