"""Legs, trunk and head that do something by themselves: a leg that is raised, a trunk that leans, a head that drops.

No caption of the training data names them, so the whole body but the arms is given, by the angles of its joints.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from acts.shapes import Limb
from motion import FPS
from motion.kinematics import swing
from motion.skeleton import ARMS, SIDES, TOES
from motion.smoothing import minimum_jerk
from motion.transforms import heading, heading_matrix
from motion.vectors import FLAT, Array

from .poses import (
    ALL,
    BOTH_SIDES,
    HANDS,
    JOINT,
    SOLE,
    STANCE,
    STANDS,
    TRUNK,
    Turns,
    about,
    ahead_of,
    all_but,
    poses_of,
    turns_of,
)
from .recordings import standing_by
from .score import Score
from .window import OFTEN, SETTLES, Part, Stretch

RAMP = 0.7
"""Seconds in which a limb gets to its place, and back."""
BEGINS = 0.4
"""Seconds of a beat before it moves."""


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
    order = list(MOVES)
    for limb in sorted(_standing_once(limbs), key=lambda limb: order.index(limb.does)):
        for joint, turn in _turns(limb, held, np.maximum(seconds - BEGINS, 0.0)).items():
            angles[joint] = angles[joint] @ turn if joint in angles else turn
    still, poses = _posed({}, 1, angle)[0], _posed(angles, len(seconds), angle)
    stance = [TOES[i] for i in _stance(limbs)]
    shift = still[stance].mean(axis=0) - poses[:, stance].mean(axis=1)
    shift[:, 1] = SOLE - poses[:, stance, 1].min(axis=1)
    return poses + shift[:, None] + ahead_of(place, angle, STANCE) - still[TOES].mean(axis=0) * FLAT


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
    return [i for i, side in enumerate(SIDES) if side not in raised] or [0, 1]


def _side(limb: Limb) -> str:
    """The leg that is raised; both cannot be at once, so then it is the right one."""
    return "left" if limb.side == "left" else "right"


def _turns(limb: Limb, held: Array, since: Array) -> Turns:
    """The rotations (N, 3, 3) of joints in a movement.

    Args:
        limb: the movement.
        held: (N,) how far it is held, from 0 to 1.
        since: (N,) seconds since it began.
    """
    move = MOVES[limb.does]
    sideways = limb.direction in ("left", "right", "out") or (bool(move.get("sided")) and limb.side != "both")
    own = move.get("aside" if sideways else limb.direction, move)
    left = "left" in (limb.direction, limb.side) and limb.direction != "right"
    sign = -1.0 if sideways and "aside" in move and not left else 1.0
    angles: dict[str, Array] = {}
    for course, share in _courses(move, limb.times, held, since).items():
        for name, turn in own.get(course, {}).items():
            turned = share[:, None] * np.pad(turn, (0, 3 - len(turn)))
            for joint, mirror in _joints(name, _side(limb), sign):
                angles[joint] = angles.get(joint, 0.0) + turned * [1.0, mirror, mirror]
    return {joint: about(2, by[:, 2]) @ about(1, by[:, 1]) @ about(0, by[:, 0]) for joint, by in angles.items()}


def _courses(move: Mapping[str, Any], told: int, held: Array, since: Array) -> dict[str, Array]:
    """The courses (N,) of a movement that is told to be done so many times, 0 for as long as it is held."""
    times, period = told or int(move.get("times", 0)), float(move.get("period", 1.0))
    turn, ends = 2 * np.pi * since / period, since <= times * period if times else since >= 0.0
    swings, whole = np.sin(turn) * held * ends, np.where(since < period, 1.0, held) if times else held
    rises = (np.sin(turn / 2) ** 2 * whole * ends) ** float(move.get("power", 1.0))
    return {
        "held": held,
        "swings": swings,
        "swings-up": np.maximum(swings, 0.0),
        "swings-down": np.maximum(-swings, 0.0),
        "swings-later": np.cos(turn) * held * ends,
        "rises": rises,
        "often": rises if told > 1 else held,
    }


def _joints(name: str, side: str, sign: float) -> list[tuple[str, float]]:
    """The joints that a name of ``limbs.toml`` stands for, each with the sign of what turns to the left.

    Args:
        name: of a joint, or of several.
        side: of the leg that is named.
        sign: of what the trunk and the head do.
    """
    if name in ("spine", "head"):
        return [(joint, sign) for joint in JOINT if joint.startswith(name) or (name == "head" and joint == "neck")]
    if name.removeprefix("other-") in ("hip", "knee", "ankle"):
        own = side if "-" not in name else SIDES[side == "left"]
        name = f"{own}_{name.removeprefix('other-')}"
    both = [(f"{own}_{name.removesuffix('s')}", mirror) for own, mirror in BOTH_SIDES]
    if both[0][0] in JOINT:
        return both
    return [(name, dict(BOTH_SIDES).get(name.split("_")[0], sign))]


MOVES: Mapping[str, Mapping[str, Any]] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
"""The movements by their names in the lexicon."""
_BY_HEAD = frozenset(("moves head", "rolls head", "nods", "shakes head", "turns head"))
"""Those that leave the body below the chest to itself."""
RAISES = frozenset(name for name, move in MOVES.items() if move.get("raises"))
"""Those in which a foot leaves the floor."""


def limb_parts(person: int, score: Score, beat: Stretch, seed: int) -> list[Part]:
    """The body of a person who moves single limbs, as far as it falls into a window.

    Their arms are those of recorded people who wait, unless their hands have something else to do. Who moves only the
    head stands as these do: their trunk is held, and their arms and legs are a draft.
    """
    frames = beat.every(OFTEN, SETTLES // 2 if beat.start else 0)
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
