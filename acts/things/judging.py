"""The verdicts on acts that the things of a motion show: a look at one, and what is opened or closed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from acts import Act, Plan, lexicon
from acts.checking import Verdict
from motion import Duet
from motion.things import Thing
from motion.things.hands import Hands
from motion.things.sight import looked_at

from .furniture import BODIES, LEAVES, TAKES
from .nouns import kind_of
from .uses import act_frames

Array = NDArray[np.floating]

LOOKS = "look-at-thing"
"""The entry of the lexicon that says that somebody looks at something."""
LEAST = 0.4
"""Seconds for which somebody must look at a thing."""
AT_HAND = 0.35
"""Metres from a palm to a thing of which it moves a part, at most."""
_TURNED, _SHIFTED = np.radians(30.0), 0.1
"""Radians and metres by which a part moves at least that is opened or closed."""
_BEGINS = 0.05
"""The share of that with which its movement begins."""


def judge_things(
    verdicts: Sequence[Verdict], plan: Plan, duet: Duet, start: int, stop: int, lengths: Sequence[float]
) -> tuple[Verdict, ...]:
    """The verdicts, of which those on acts with a thing that is in the scene follow from the things.

    A look at a thing follows from where the face points. Something is opened or closed where a part of it begins to
    move while one of the act's agents has a hand at it.

    Args:
        verdicts: on the acts of the plan.
        plan: of the frames from ``start`` to ``stop``.
        duet: with its things.
        start, stop: frames.
        lengths: seconds of the beats into which the sentence was split, where it was.
    """
    if not duet.things:
        return tuple(verdicts)
    frames = {act.id: (act, first, last) for act, first, last in act_frames(plan, start, stop, lengths)}
    return tuple(_judge(each, duet, *frames[each.id]) if each.id in frames else each for each in verdicts)


def _judge(verdict: Verdict, duet: Duet, act: Act, first: int, last: int) -> Verdict:
    """The verdict on an act of some frames."""
    if act.act == LOOKS and act.thing and last > first:
        kinds = _kinds(act.thing)
        seen = [i for i, thing in enumerate(duet.things) if thing.kind in kinds]
        if not seen:
            return verdict
        seconds = min(_seconds(duet, who, first, last, seen) for who in act.agents)
        return replace(verdict, done=seconds >= LEAST, measure=f"looks at it for {seconds:.1f} s")
    entry = lexicon().entries.get(act.act)
    if verdict.done is not None or entry is None or entry.thing not in ("opens", "closes"):
        return verdict
    kind = kind_of(act.thing or "")
    moving = {leaf.kind for leaves in LEAVES.values() for leaf in leaves if leaf.moved_by == kind}
    parts = [thing for thing in duet.things if thing.kind in moving]
    if not parts:
        return verdict
    frames = range(first, min(last + round(TAKES * duet.fps), duet.num_frames))
    starts = [frame for part in parts if (frame := _starts(part, frames)) is not None]
    if not starts:
        return replace(verdict, done=False, measure="nothing of it moves")
    whole = [*parts, *(thing for thing in duet.things if thing.kind == BODIES.get(kind, kind))]
    palms = Hands.of(duet).palms[["ab".index(who) for who in act.agents], :, min(starts)].reshape(-1, 3)
    near = min(_away(palms, thing, min(starts)) for thing in whole)
    return replace(verdict, done=near <= AT_HAND, measure=f"hand {100 * near:.0f} cm from it as it moves")


def _kinds(noun: str) -> set[str]:
    """The kinds of things that a noun may stand for: a window is its frame, its sashes and its curtains."""
    kind = kind_of(noun)
    body = BODIES.get(kind, kind)
    return {kind, body, *(leaf.kind for leaf in LEAVES.get(body, ()))} - {""}


def _seconds(duet: Duet, who: str, first: int, last: int, things: Sequence[int]) -> float:
    """Seconds for which a person's face points to one of some things."""
    me = "ab".index(who)
    people = duet.positions[:, first:last].astype(np.float64)
    cut = [thing.cut(first, last) for thing in duet.things]
    return float(np.isin(looked_at(cut, people[me], people[1 - me]), things).sum() / duet.fps)


def _starts(part: Thing, frames: range) -> int | None:
    """The frame of some in which a part begins to move; None where it hardly does."""
    turns, places = (track[frames.start : frames.stop].astype(np.float64) for track in (part.rotations, part.places))
    cosines = (np.einsum("tij,ij->t", turns, turns[0]) - 1) / 2
    turned = np.arccos(np.clip(cosines, -1.0, 1.0)) / _TURNED
    moved = np.maximum(turned, np.linalg.norm(places - places[0], axis=1) / _SHIFTED)
    return frames[int(np.argmax(moved > _BEGINS))] if moved.max() >= 1 else None


def _away(palms: Array, thing: Thing, frame: int) -> float:
    """The metres from the nearest of some palms (P, 3) to the box around a thing."""
    local = (palms - thing.places[frame]) @ thing.rotations[frame]
    low, high = thing.mesh.vertices.min(axis=0), thing.mesh.vertices.max(axis=0)
    return float(np.linalg.norm(local - np.clip(local, low, high), axis=1).min())
