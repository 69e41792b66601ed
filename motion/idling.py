"""Waiting that is alive: people who do nothing shift their weight, breathe, and look at what the other does.

A body that a plan has stand, sit or lie is a statue. Here it moves as people at rest do, only as far as nothing else
goes on in it: feet stay where they stand, hands that touch somebody or something stay there, and a body that walks,
holds or is held is left alone. Everybody rests in a way of their own, which the seed draws.

Amplitudes are those of 319 stretches of 8 s in which people stand idle (ReActIdle): between their median and their
upper quartile the pelvis goes 2 to 11 cm from side to side, the chest turns by 7 to 15 degrees, the head by 10 to 21,
and a wrist wanders over 4 to 12 cm.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # its parts are loaded with their first use

from .limbs import HIPS, UPPER, limb_length, over_planted_feet, solve_two_bones
from .skeleton import ARMS, SMPL22, TOES
from .smoothing import begun_before, least_jerk, minimum_jerk, smoothstep
from .transforms import facing
from .vectors import Array, rotations_by, unit

WEIGHT, BOW = 0.026, 0.012
"""Metres by which the pelvis goes to either side, and forwards and back."""
TURN = np.radians(4.0)
"""Radians by which the chest turns to either side."""
GLANCE = np.radians(9.0)
"""Radians by which the head turns to either side of what it looks at."""
SWING, SPREAD, BEND = np.radians([8.0, 4.0, 14.0])
"""Radians by which a hanging arm swings to the front and back, goes outwards, and bends."""
BREATH = 0.004
"""Metres by which the shoulders rise and fall."""
BREATHS = (3.2, 4.6)
"""Seconds of a breath of people at rest (13 to 19 a minute)."""
_EVERY, _TAKES = (2.2, 5.5), (0.9, 1.7)
"""Seconds from one shift to the next, and those that a shift takes."""
_LOOKS, _FOLLOWS = np.radians(55.0), np.radians(14.0)
"""Radians between chest and head at most, and by which the chest turns after what the head looks at."""
_NODS = np.radians([-12.0, 38.0])
"""Radians by which a head is raised, and lowered, at most, to look at the other's."""
_BEHIND = np.radians([95.0, 140.0])
"""Radians aside up to which a person is looked at, and from which they are behind one's back."""
_OWN_LOOK = np.radians([18.0, 35.0])
"""Radians that a head is turned of its own up to which it follows the other, and from which it does as it did."""
_LATE = 7.0
"""Frames (standard deviation) over which a look follows what it looks at."""
_WAITS = (0.07, 0.25)
"""Metres a second of a body at rest at most, and of one that does something."""
_HAND_WAITS = (0.2, 0.5)
"""The same of a hand as seen from the shoulder."""
_SETTLES = 12
"""Frames before and after an act in which a body does nothing else."""
_NEAR = (0.24, 0.42)
"""Metres from a hand to the other's joints up to which they touch, and from which they do not."""
_HANGS = (0.16, 0.28)
"""Metres of a wrist below its shoulder, per half metre of the arm, from which the arm begins to hang, and hangs."""
_STANDS = (0.7, 0.8)
"""Heights in metres of the pelvis: of a sitting person at most, and of a standing one at least."""
_SOLE = 0.12
"""Height in metres of a toe of a foot that is on the floor, at most."""
_LOOSE, _TIGHT, _LAID = 5.0, -4.0, -5.5
"""Tens' exponents of the weight of what was made against least jerk: of a body in motion, which stays as it is, of one
at rest, of which is kept what is slower than a hertz, and of arms that have nothing to do, slower than 0.6."""
_END = 30
"""Frames by which a motion is mirrored at its ends: a path of least jerk would run away there."""
_SETTLED = (0.15, 0.5)
"""The same of a body whose arms have nothing to do: they lie still on it sooner."""
_J = SMPL22.index
_WRISTS = [wrist for *_, wrist in ARMS]
_HEAD, _NECK, _CHEST, _WAIST = (_J(name) for name in ("head", "neck", "spine3", "spine2"))
_ABOVE = [joint for joint in UPPER if joint not in (_J("spine1"), _J("spine2"))]
"""Joints that turn with the chest, about the lower spine."""


def alive(pair: Array, fps: float, seed: int = 0, free: Array | None = None, loose: Array | None = None) -> Array:
    """Two people of whom nobody is a statue.

    Args:
        pair: (2, T, 22, 3) metres on constant bones, floor at 0.
        fps: frames a second.
        seed: draws how each of them rests.
        free: (2, T) how far what a person does may be changed, 0 to 1; wholly by default.
        loose: (2, T) how far their arms have nothing to do, 0 to 1; by default, arms that move do something.

    Returns:
        (2, T, 22, 3) on the same bones, with feet in the same places.
    """
    pair = np.asarray(pair, dtype=np.float64)
    if pair.shape[1] < 4:
        return pair.copy()
    share = np.ones(pair.shape[:2]) if free is None else np.asarray(free, dtype=np.float64)
    apart = _apart(pair)
    found = []
    for person in (0, 1):
        speed, own = _body_speed(pair[person], fps), share[person] * apart
        rest = own * _calm(speed, _WAITS)
        laid = np.zeros(len(rest)) if loose is None else own * loose[person] * _calm(speed, _SETTLED)
        if max(rest.max(), laid.max()) < 1e-3:
            found.append(pair[person].copy())
            continue
        manner = _Manner.drawn(np.random.default_rng([seed, person]), pair.shape[1], fps)
        calm = _calmed(pair[person], fps, rest, laid)
        found.append(_rested(calm, pair[1 - person], fps, rest, manner))
    return np.stack(found)


@dataclass(frozen=True, eq=False)
class _Manner:
    """A way of resting, frame by frame, each number between -1 and 1.

    Attributes:
        body: (T, 3) to the left, ahead, and turned to the left.
        head: (T, 2) how far they look aside of what they look at, and how far they look at it (0 to 1).
        arms: (T, side, 3) forwards, outwards (0 to 1) and bent (0 to 1).
        breath: (T,)
    """

    body: Array
    head: Array
    arms: Array
    breath: Array

    @classmethod
    def drawn(cls, rng: np.random.Generator, frames: int, fps: float) -> _Manner:
        body, head, *arms = (_shifts(rng, frames, fps, count) for count in (3, 2, 3, 3))
        period, phase = rng.uniform(*BREATHS), rng.uniform(0, 2 * np.pi)
        breath = np.sin(2 * np.pi * np.arange(frames) / (period * fps) + phase)
        both = np.stack(arms, axis=1)
        own = rng.uniform(-1, 1, (2, 3))  # the side that an arm keeps to
        both = 0.6 * both + 0.4 * own
        both[..., 1:] = 0.5 + 0.5 * both[..., 1:]
        head[:, 1] = np.clip(1.1 + 0.8 * head[:, 1], 0.3, 1.0)
        return cls(body, head, both, breath)


def _shifts(rng: np.random.Generator, frames: int, fps: float, count: int) -> Array:
    """(T, count) numbers from -1 to 1 that stay for seconds and then go elsewhere along a minimum-jerk course."""
    seconds = np.arange(frames) / fps
    now = rng.uniform(-1, 1, count)
    found = np.tile(now, (frames, 1))
    at = rng.uniform(0.3, _EVERY[1])
    while at < seconds[-1]:
        takes = rng.uniform(*_TAKES)
        then = -np.sign(now) * rng.uniform(0.15, 1, count) * np.where(rng.random(count) < 0.75, 1, -1)
        found += (then - now) * minimum_jerk((seconds - at) / takes)[:, None]
        now, at = then, at + takes + rng.uniform(*_EVERY)
    return found


def _calmed(own: Array, fps: float, rest: Array, laid: Array) -> Array:
    """A person (T, 22, 3) whose bones above the legs do not tremble while they rest, nor arms that are ``laid`` (T,).

    Poses that are given now and then leave the frames between them to waver at a hertz or two; people at rest sway
    more slowly.
    """
    result = own.copy()
    weights = dict.fromkeys(UPPER, _LOOSE - (_LOOSE - _TIGHT) * rest)
    for shoulder, elbow, wrist in ARMS:
        hand = own[:, wrist] - own[:, shoulder]
        still = rest * _calm(_speed(hand, fps), _HAND_WAITS)
        tight = np.minimum(_LOOSE - (_LOOSE - _TIGHT) * still, _LOOSE - (_LOOSE - _LAID) * laid)
        weights |= dict.fromkeys((elbow, wrist), tight)
    parents = {child: parent for parent, child in SMPL22.bones}
    groups: dict[int, list[int]] = {}
    for joint in UPPER:
        groups.setdefault(id(weights[joint]), []).append(joint)
    for joints in groups.values():
        bones = own[:, joints] - own[:, [parents[joint] for joint in joints]]
        calm = _smoothed(bones, 10.0 ** weights[joints[0]])
        calm = unit(calm) * np.linalg.norm(bones, axis=-1, keepdims=True)
        for joint, bone in zip(joints, np.moveaxis(calm, 1, 0), strict=True):
            result[:, joint] = result[:, parents[joint]] + bone
    return result


def _smoothed(bones: Array, weights: Array) -> Array:
    """Bones (T, N, 3) held by weights (T,) to what they were, along paths of least jerk that end in rest."""
    ends = min(_END, len(bones))
    held = np.pad(weights, ends, mode="symmetric")
    padded = np.pad(bones, ((ends, ends), (0, 0), (0, 0)), mode="symmetric")
    return least_jerk(padded, held)[ends:-ends]


def _rested(own: Array, other: Array, fps: float, rest: Array, manner: _Manner) -> Array:
    """A person (T, 22, 3) who rests by ``rest`` (T,) in a manner of their own."""
    forward, up = facing(own), np.array([0.0, 1.0, 0.0])
    left = np.cross(up, forward)
    stands = smoothstep(own[:, 0, 1], *_STANDS) * (own[:, TOES, 1].max(axis=1) < _SOLE)
    stands = rest * scipy.ndimage.gaussian_filter1d(stands.astype(np.float64), _SETTLES / 3)
    result = own.copy()
    shift = (stands * WEIGHT * manner.body[:, 0])[:, None] * left
    shift += (stands * BOW * manner.body[:, 1])[:, None] * forward
    result[:, [*HIPS, *UPPER]] += shift[:, None]
    # The trunk leans back over the feet, and turns by itself and after what is looked at.
    trunk = unit(own[:, _CHEST] - own[:, 0])
    lean = np.cross(trunk, -0.5 * shift) / np.linalg.norm(own[:, _CHEST] - own[:, 0], axis=-1, keepdims=True)
    looks = rest * _calm(_speed(own[:, _HEAD] - own[:, _CHEST], fps), _HAND_WAITS)
    gaze, nod = _look(own, other, manner.head)
    turned = rest * TURN * manner.body[:, 2] + looks * np.clip(0.25 * gaze, -_FOLLOWS, _FOLLOWS)
    turned *= smoothstep(trunk[:, 1], 0.5, 0.85)  # who lies does not turn over
    result[:, UPPER] = _about(result[:, 0], rotations_by(lean), result[:, UPPER])
    result[:, _ABOVE] = _about(result[:, _WAIST], rotations_by(turned[:, None] * trunk), result[:, _ABOVE])
    yaw = looks * (gaze - np.clip(0.25 * gaze, -_FOLLOWS, _FOLLOWS))
    axis = unit(result[:, _NECK] - result[:, _CHEST])
    result[:, _HEAD] = _about(result[:, _NECK], rotations_by((looks * nod)[:, None] * left), result[:, _HEAD])
    result[:, _HEAD] = _about(result[:, _NECK], rotations_by(yaw[:, None] * axis), result[:, _HEAD])
    result = over_planted_feet(own, result) if stands.any() else result
    return _with_arms(own, result, fps, rest, stands, manner)


def _with_arms(own: Array, moved: Array, fps: float, rest: Array, stands: Array, manner: _Manner) -> Array:
    """The body that was ``moved``, with arms that hang loosely, and with hands that lie somewhere kept there."""
    result = moved.copy()
    forward = facing(own)
    left = np.cross([0.0, 1.0, 0.0], forward)
    for side, (sign, (shoulder, elbow, wrist)) in enumerate(zip((1.0, -1.0), ARMS, strict=True)):
        rise = (rest * BREATH * manner.breath)[:, None] * [0.0, 1.0, 0.0]
        collar = _J(("left_collar", "right_collar")[side])
        bone = result[:, shoulder] - result[:, collar]
        lifted = unit(bone + rise) * np.linalg.norm(bone, axis=-1, keepdims=True) - bone
        result[:, [shoulder, elbow, wrist]] += lifted[:, None]
        arm = own[:, wrist] - own[:, shoulder]
        low = smoothstep(-arm[:, 1] / limb_length(own, (shoulder, elbow, wrist)), *(2 * np.array(_HANGS)))
        hangs = stands * low * _calm(_speed(arm, fps), _HAND_WAITS)
        ahead, out, bend = (manner.arms[:, side, i] for i in range(3))
        swing = -(hangs * SWING * ahead)[:, None] * left + (hangs * SPREAD * out * sign)[:, None] * forward
        result[:, [elbow, wrist]] = _about(result[:, shoulder], rotations_by(swing), result[:, [elbow, wrist]])
        hinge = -(hangs * BEND * bend)[:, None] * left
        result[:, wrist] = _about(result[:, elbow], rotations_by(hinge), result[:, wrist])
        # A sitting or lying person's hands stay where they are.
        lies = (rest * (1 - smoothstep(own[:, 0, 1], *_STANDS)))[:, None]
        goal = result[:, wrist] + lies * (own[:, wrist] - result[:, wrist])
        pole = -forward + np.array([0.0, -1.0, 0.0])
        joints = result[:, shoulder], result[:, elbow], result[:, wrist]
        bent, met = solve_two_bones(*joints, goal, pole)
        result[:, elbow] = np.where(lies > 0, bent, result[:, elbow])
        result[:, wrist] = np.where(lies > 0, met, result[:, wrist])
    return result


def _look(own: Array, other: Array, manner: Array) -> tuple[Array, Array]:
    """(T,) radians by which a head turns to the left and nods, towards the other's head and past it."""
    left = unit(own[:, ARMS[0][0]] - own[:, ARMS[1][0]])
    up = unit(own[:, _NECK] - own[:, _CHEST])
    ahead = unit(np.cross(left, up))

    def aside(way: Array) -> Array:
        return np.asarray(np.arctan2(np.sum(way * left, axis=-1), np.sum(way * ahead, axis=-1)))

    now, way = aside(own[:, _HEAD] - own[:, _NECK]), other[:, _HEAD] - own[:, _HEAD]
    wanted = aside(way)
    seen = manner[:, 1] * (1 - smoothstep(np.abs(wanted), *_BEHIND))
    follows = 1 - smoothstep(np.abs(now), *_OWN_LOOK)
    to = seen * np.clip(wanted, -np.pi / 2, np.pi / 2) + GLANCE * manner[:, 0]
    turns = follows * (np.clip(to, -_LOOKS, _LOOKS) - now)
    down = np.arctan2(-way[:, 1], np.linalg.norm(way[:, [0, 2]], axis=-1))
    nods = follows * seen * smoothstep(up[:, 1], 0.8, 0.95) * np.clip(down, *_NODS)
    late = scipy.ndimage.gaussian_filter1d(np.stack([turns, nods]), _LATE, axis=1, mode="nearest")
    return late[0], late[1]


def _apart(pair: Array) -> Array:
    """(T,) 1 where no hand is at the other's body, 0 where one is, and shortly before and after it."""
    gaps = []
    for person in (0, 1):
        between = pair[person][:, _WRISTS, None] - pair[1 - person][:, None]
        gaps.append(np.sqrt(np.einsum("tsji,tsji->tsj", between, between)).min(axis=(1, 2)))
    return _lasting(smoothstep(np.min(gaps, axis=0), *_NEAR))


def _body_speed(person: Array, fps: float) -> Array:
    """(T,) metres a second of the pelvis, the chest or a foot, whichever is fastest."""
    parts = person[:, [0, _CHEST, *TOES]]
    return np.max([_speed(parts[:, i], fps) for i in range(parts.shape[1])], axis=0)


def _speed(place: Array, fps: float) -> Array:
    """(T,) metres a second of a joint (T, 3), without what trembles."""
    calm = scipy.ndimage.gaussian_filter1d(place, 1.2, axis=0, mode="nearest")
    return np.asarray(np.linalg.norm(np.gradient(calm, axis=0), axis=-1) * fps)


def _calm(speed: Array, span: tuple[float, float]) -> Array:
    """(T,) 1 where something rests and 0 where it moves, and shortly before and after that."""
    return _lasting(1 - smoothstep(speed, *span))


def _lasting(share: Array) -> Array:
    """A share (T,) that is as low as nearby, and smooth."""
    return 1 - begun_before(1 - share, _SETTLES, _SETTLES / 2)


def _about(centre: Array, turns: Array, places: Array) -> Array:
    """Places (T, 3) or (T, N, 3) turned by (T, 3, 3) about a centre (T, 3)."""
    several = places if places.ndim == 3 else places[:, None]
    found = np.einsum("tij,tnj->tni", turns, several - centre[:, None]) + centre[:, None]
    return np.asarray(found if places.ndim == 3 else found[:, 0])
