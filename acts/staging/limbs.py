"""Legs, trunk and head that do something by themselves: a leg that is raised, a trunk that leans, a head that drops.

No caption of the training data names them, so the whole body but the arms is given, by the angles of its joints.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from acts.shapes import Limb
from motion import FPS
from motion.kinematics import swing
from motion.skeleton import ARMS
from motion.smoothing import minimum_jerk
from motion.transforms import heading, heading_matrix
from motion.vectors import Array

from .poses import ALL, BOTH_SIDES, HANDS, JOINT, SOLE, STANDS, TOES, TRUNK, Turns, about, all_but, poses_of, turns_of
from .recordings import standing_by
from .score import Score
from .window import OFTEN, SETTLES, Part, Stretch

RAMP = 0.7
"""Seconds in which a limb gets to its place, and back."""
BEGINS = 0.4
"""Seconds of a beat before it moves."""
SWING = 1.5
"""Seconds of a swing to and fro."""
LUNGE = 2.4
"""Seconds of one of several lunges."""


def limbed(limbs: Sequence[Limb], place: Array, angle: float, seconds: Array, length: float) -> Array:
    """A standing person who moves single limbs.

    Args:
        limbs: which, at the same time.
        place: (2,) x and z of the pelvis in metres.
        angle: heading in radians from +Z towards +X.
        seconds: (N,) moments of the beat.
        length: seconds of the beat.

    Returns:
        (N, 22, 3) metres; a foot that is not raised is on the floor where it stood.
    """
    seconds = np.asarray(seconds, dtype=float)
    held = minimum_jerk((seconds - BEGINS) / RAMP) * minimum_jerk((length - 0.2 - seconds) / RAMP)
    angles: dict[str, Array] = {}
    order = list(MOVES)  # legs are turned out before they are bent
    for limb in sorted(_standing_once(limbs), key=lambda limb: order.index(limb.does)):
        for joint, turn in MOVES[limb.does](limb, held, np.maximum(seconds - BEGINS, 0.0)).items():
            angles[joint] = angles[joint] @ turn if joint in angles else turn
    still, poses = _posed({}, 1, angle)[0], _posed(angles, len(seconds), angle)
    stance = [TOES[i] for i in _stance(limbs)]
    shift = still[stance].mean(axis=0) - poses[:, stance].mean(axis=1)
    shift[:, 1] = SOLE - poses[:, stance, 1].min(axis=1)
    ahead = 0.12 * np.array([np.sin(angle), 0.0, np.cos(angle)])
    toes = still[list(TOES)].mean(axis=0) * [1, 0, 1]
    return poses + shift[:, None] + np.array([place[0], 0.0, place[1]]) + ahead - toes


def _standing_once(limbs: Sequence[Limb]) -> Sequence[Limb]:
    """The movements without "stands on one leg" where another says how the free leg is held."""
    if any(limb.does in RAISES and limb.does != "stands on one leg" for limb in limbs):
        return [limb for limb in limbs if limb.does != "stands on one leg"]
    return limbs


def _posed(angles: Mapping[str, Array], count: int, angle: float) -> Array:
    """Poses (N, 22, 3) around the origin of a standing person, with further rotations of joints."""
    turns = turns_of(angle, STANDS)
    for joint, turn in angles.items():
        stands = turns.get(joint, np.eye(3))
        turns[joint] = turn @ stands if "shoulder" in joint else stands @ turn
    return poses_of(turns, count)


def _stance(limbs: Sequence[Limb]) -> list[int]:
    """The feet that stay on the floor: 0 for the left one, 1 for the right one."""
    raised = [_side(limb) for limb in limbs if limb.does in RAISES]
    return [i for i, side in enumerate(("left", "right")) if side not in raised] or [0, 1]


_SPINE, _HEAD = ("spine1", "spine2", "spine3"), ("neck", "head")
"""Joints of the trunk and of the head that turn together."""


def _side(limb: Limb) -> str:
    """The leg that is raised; both cannot be at once, so then it is the right one."""
    return "left" if limb.side == "left" else "right"


def _swing(since: Array, held: Array, times: int, period: float = SWING) -> Array:
    """A swing between -1 and 1, so many times or as long as it is held."""
    ends = since <= times * period if times else np.ones_like(since, dtype=bool)
    return np.sin(2 * np.pi * since / period) * held * ends


def _pulses(since: Array, held: Array, times: int, period: float = 1.0) -> Array:
    """Rises from 0 to 1 and back, so many times, the first of which is whole, or as long as it is held."""
    if times:
        held = np.where(since < period, 1.0, held) * (since <= times * period)
    return np.sin(np.pi * since / period) ** 2 * held


def _leg(limb: Limb, hip: Array, knee: Array, out: Array | float = 0.0) -> Turns:
    side = _side(limb)
    spread = about(2, (1.0 if side == "left" else -1.0) * np.asarray(out) + np.zeros_like(hip))
    return {f"{side}_hip": spread @ about(0, -hip), f"{side}_knee": about(0, knee)}


def _both_legs(share: Array, hip: float, knee: float, ankle: float) -> Turns:
    """Both legs bent by a share of some radians."""
    angles = {"hip": hip, "knee": knee, "ankle": ankle}
    return {f"{side}_{joint}": about(0, angle * share) for side, _ in BOTH_SIDES for joint, angle in angles.items()}


def _bent(limb: Limb, held: Array, joints: str, aside: float, back: float, ahead: float) -> Turns:
    """Joints that are bent by so many radians: to a side, up and back, or down and ahead."""
    if limb.direction in ("left", "right", "out"):
        return dict.fromkeys(joints.split(), about(2, -_aside(limb) * aside * held))
    return dict.fromkeys(joints.split(), about(0, (back if limb.direction in ("up", "back") else ahead) * held))


def _raised_leg(limb: Limb, held: Array, since: Array) -> Turns:
    if limb.direction == "back":
        return _leg(limb, -0.55 * held, 0.25 * held) | {"spine1": about(0, 0.2 * held)}
    if limb.direction in ("out", "left", "right"):
        return _leg(limb, 0.1 * held, 0.0 * held, 0.7 * held)
    return _leg(limb, 1.0 * held, 0.15 * held)


def _swung_leg(limb: Limb, held: Array, since: Array) -> Turns:
    swing = _swing(since, held, limb.times)
    return _leg(limb, 0.15 * held + 0.55 * swing, 0.15 * held + 0.2 * np.maximum(-swing, 0))


def _kicked_leg(limb: Limb, held: Array, since: Array) -> Turns:
    pulse = _pulses(since, held, limb.times or 2, 1.1)
    return _leg(limb, 1.3 * pulse, 0.5 * pulse * (1 - pulse))


def _stepped(limb: Limb, pulse: Array, hip: float, knee: float) -> Turns:
    return _leg(limb, hip * pulse, knee * pulse)


def _lunged(limb: Limb, held: Array, since: Array) -> Turns:
    """A long step of the leg that is named, the knees bent, over the other foot, which stays on its toes."""
    down = np.minimum(1.6 * _pulses(since, held, limb.times, LUNGE), 1.0) if limb.times > 1 else held
    front = _side(limb)
    back = "left" if front == "right" else "right"
    return _leg(limb, 1.1 * down, 1.25 * down) | {
        f"{back}_hip": about(0, 0.4 * down),
        f"{back}_knee": about(0, 0.75 * down),
        f"{back}_ankle": about(0, -0.55 * down),
        f"{front}_ankle": about(0, -0.15 * down),
    }


def _reached_down(limb: Limb, held: Array, since: Array) -> Turns:
    down = _pulses(since, held, limb.times or 1, 3.0) ** 0.5
    arms = {f"{side}_shoulder": about(0, -2.0 * down) for side, _ in BOTH_SIDES}
    return _both_legs(down, -1.8, 2.0, -0.45) | arms | dict.fromkeys(_SPINE, about(0, 0.5 * down))


def _crossed_legs(limb: Limb, held: Array, since: Array) -> Turns:
    sign = 1.0 if limb.side == "left" else -1.0
    return _leg(limb, 0.12 * held, 0.1 * held, -0.3 * held) | {
        f"{'right' if sign > 0 else 'left'}_hip": about(2, sign * 0.05 * held)
    }


def _aside(limb: Limb) -> float:
    """The sign of a turn or tilt to the side that is named: 1 for the left."""
    return 1.0 if "left" in (limb.direction, limb.side) and limb.direction != "right" else -1.0


def _twisted(limb: Limb, held: Array, since: Array) -> Turns:
    turned = _aside(limb) * held if limb.direction or limb.side != "both" else _swing(since, held, limb.times, 2.2)
    return dict.fromkeys(_SPINE, heading_matrix(0.26 * turned))


def _swaying(limb: Limb, held: Array, since: Array) -> Turns:
    swing = _swing(since, held, limb.times, 2.2)
    hips = {f"{side}_hip": about(2, 0.15 * swing) for side in ("left", "right")}
    return hips | {"pelvis": about(2, -0.15 * swing), "spine2": about(2, -0.12 * swing)}


def _rolled_head(limb: Limb, held: Array, since: Array) -> Turns:
    round_ = 2 * np.pi * since / 2.4
    return dict.fromkeys(_HEAD, about(0, 0.3 * held * np.cos(round_)) @ about(2, 0.3 * held * np.sin(round_)))


def _looking(turned: Array) -> Turns:
    """A head that is turned by radians (N,) to the left."""
    return dict.fromkeys(_HEAD, heading_matrix(turned))


def _shaking(limb: Limb, held: Array, since: Array) -> Turns:
    """A trunk that shakes with laughter or cold."""
    quick = _swing(since, held, limb.times, 0.45)
    return dict.fromkeys(_SPINE, about(0, 0.05 * quick + 0.04 * held)) | {"neck": about(0, 0.08 * quick)}


def _marching(limb: Limb, held: Array, since: Array) -> Turns:
    """One knee after the other."""
    swing = _swing(since, held, limb.times, 1.1)
    turns: Turns = {}
    for side, sign in BOTH_SIDES:
        up = np.maximum(sign * swing, 0.0)
        turns |= {f"{side}_hip": about(0, -1.0 * up), f"{side}_knee": about(0, 1.4 * up)}
    return turns


MOVES: Mapping[str, Callable[[Limb, Array, Array], Turns]] = {
    "raises leg": _raised_leg,
    "raises knee": lambda limb, held, since: _leg(limb, 1.45 * held, 1.7 * held),
    "swings leg": _swung_leg,
    "kicks": _kicked_leg,
    "stamps": lambda limb, held, since: _stepped(limb, _pulses(since, held, limb.times, 0.8), 0.7, 1.2),
    "taps foot": lambda limb, held, since: _stepped(limb, _pulses(since, held, limb.times, 0.6), 0.6, 1.0),
    "stands on one leg": lambda limb, held, since: _leg(limb, 0.7 * held, 1.3 * held),
    "turns legs out": lambda limb, held, since: {
        f"{side}_hip": heading_matrix(sign * 0.7 * held) for side, sign in BOTH_SIDES
    },
    "bends knees": lambda limb, held, since: _both_legs(
        _pulses(since, held, limb.times, 1.6) if limb.times > 1 else held, -0.9, 1.45, -0.55
    ),
    "lunges": _lunged,
    "stands tall": lambda limb, held, since: {},
    "reaches down": _reached_down,
    "on tiptoe": lambda limb, held, since: {f"{side}_ankle": about(0, 0.6 * held) for side in ("left", "right")},
    "crosses legs": _crossed_legs,
    "leans": lambda limb, held, since: _bent(limb, held, "spine1 spine2", 0.22, -0.2, 0.28),
    "is dipped": lambda limb, held, since: (
        _both_legs(held, -0.15, 0.5, -0.3) | dict.fromkeys(_SPINE, about(0, -0.26 * held))
    ),
    "twists": _twisted,
    "sways": _swaying,
    "moves head": lambda limb, held, since: _bent(limb, held, "neck head", 0.3, -0.7, 0.6),
    "rolls head": _rolled_head,
    "nods": lambda limb, held, since: dict.fromkeys(_HEAD, about(0, 0.28 * _pulses(since, held, limb.times, 0.7))),
    "shakes": _shaking,
    "shakes head": lambda limb, held, since: _looking(0.22 * _swing(since, held, limb.times, 0.7)),
    "turns head": lambda limb, held, since: _looking(
        0.42 * (_aside(limb) * held if limb.direction in ("left", "right") else _swing(since, held, limb.times, 2.4))
    ),
    "shrugs": lambda limb, held, since: {
        f"{side}_collar": about(2, sign * 0.4 * _pulses(since, held, limb.times or 1, 1.4)) for side, sign in BOTH_SIDES
    },
    "marches": _marching,
}
"""The movements: rotations (N, 3, 3) of joints, of how far each is held (N,) and of the seconds since it began (N,)."""
_BY_HEAD = frozenset(("moves head", "rolls head", "nods", "shakes head", "turns head"))
"""Those that leave the body below the chest to itself."""
RAISES = frozenset(
    ("raises leg", "raises knee", "swings leg", "kicks", "stamps", "stands on one leg", "crosses legs", "lunges")
)
"""Those in which a foot leaves the floor."""


def limb_parts(person: int, score: Score, beat: Stretch, seed: int) -> list[Part]:
    """The body of a person who moves single limbs, as far as it falls into a window.

    Their arms are those of recorded people who wait, unless their hands have something else to do. Who moves only the
    head stands as these do: their trunk is held, and their arms and legs are a draft.
    """
    frames = beat.every(OFTEN, SETTLES // 2 if beat.start else 0)
    if not len(frames):
        return []
    limbs = score.limbs["ab"[person]]
    angle, seconds = float(beat.stand.headings[person]), beat.frames / FPS
    poses = limbed(limbs, beat.halt(person), angle, frames / FPS, seconds)
    waits = standing_by(beat.halt(person), angle, frames + beat.start, 2 * seed + person)
    busy = HANDS if "ab"[person] in score.gestures or score.touch is not None else ()
    if _BY_HEAD.issuperset(limb.does for limb in limbs):
        body, held = _with_head(waits, poses, angle), (JOINT["pelvis"], *TRUNK)
        rest = beat.known(person, frames, body, all_but((*held, *busy)))
        return [beat.known(person, frames, body, held, kept=True), replace(rest, soft=True, free=True)]
    if any(limb.does == "reaches down" for limb in limbs):  # which the hands belong to
        return [beat.known(person, frames, poses, ALL, kept=True)]
    for shoulder, *arm in ARMS:
        poses[:, arm] = poses[:, [shoulder]] + waits[:, arm] - waits[:, [shoulder]]
    return [beat.known(person, frames, poses, all_but(busy), kept=True)]


def _with_head(body: Array, poses: Array, angle: float) -> Array:
    """A body (N, 22, 3) that moves its head against its trunk as upright poses (N, 22, 3) of a heading do."""
    neck, head = JOINT["neck"], JOINT["head"]
    ways = (poses[:, [neck, head]] - poses[:, [0, neck]]).swapaxes(1, 2)
    trunk, over = np.moveaxis(heading_matrix(heading(body) - angle) @ ways, -1, 0)
    moved = body.copy()
    leans = swing(trunk, body[:, neck] - body[:, 0])
    moved[:, head] = body[:, neck] + np.einsum("nij,nj->ni", leans, over)
    return moved
