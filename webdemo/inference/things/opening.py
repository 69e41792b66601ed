"""The acts of opening and closing a window, a door or curtains: what of them moves says whether they are done."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from acts import Act, Plan, lexicon
from acts.checking import Verdict
from acts.things import kind_of
from motion import Duet
from motion.things import Thing

from .fixtures import BODIES, LEAVES, TAKES
from .holding import Hands
from .uses import act_frames

Array = NDArray[np.floating]

AT_HAND = 0.35
"""Metres from a palm to a thing of which it moves a part, at most."""
_TURNED, _SHIFTED = np.radians(30.0), 0.1
"""Radians and metres by which a part moves at least that is opened or closed."""
_BEGINS = 0.05
"""The share of that with which its movement begins."""


def opened(
    verdicts: Sequence[Verdict], plan: Plan, duet: Duet, start: int, stop: int | None, lengths: Sequence[float]
) -> tuple[Verdict, ...]:
    """The verdicts, of which those on acts that open or close what is in the scene follow from what moves there.

    Such an act is done where a part of the thing begins to move while one of its agents has a hand at it.

    Args:
        verdicts: on the acts of the plan.
        plan: of the frames from ``start`` to ``stop``.
        duet: with its things.
        start, stop: frames; None for the end.
        lengths: seconds of the beats into which the sentence was split, where it was.
    """
    end = duet.num_frames if stop is None else stop
    frames = {act.id: (act, first, last) for act, first, last in act_frames(plan, start, end, lengths)}
    hands: Hands | None = None
    found = []
    for each in verdicts:
        if each.done is None and each.id in frames:
            act, first, last = frames[each.id]
            if parts := _parts(act, duet.things):
                hands = hands or Hands.of(duet)
                last = min(last + round(TAKES * duet.fps), duet.num_frames)
                body = BODIES.get(kind := kind_of(act.thing or ""), kind)
                whole = [*parts, *(thing for thing in duet.things if thing.kind == body)]
                palms = hands.palms[["ab".index(who) for who in act.agents]].reshape(-1, duet.num_frames, 3)
                each = _judged(each, palms, parts, whole, range(first, last))
        found.append(each)
    return tuple(found)


def _parts(act: Act, things: Sequence[Thing]) -> list[Thing]:
    """The parts of the scene's things that an act opens or closes."""
    entry = lexicon().entries.get(act.act)
    if entry is None or entry.thing not in ("opens", "closes"):
        return []
    noun = kind_of(act.thing or "")
    kinds = {leaf.kind for leaves in LEAVES.values() for leaf in leaves if leaf.moved_by == noun}
    return [thing for thing in things if thing.kind in kinds]


def _judged(verdict: Verdict, palms: Array, parts: Sequence[Thing], whole: Sequence[Thing], frames: range) -> Verdict:
    """A verdict from the palms (P, T, 3) of its agents, the parts that move, and these with what they are part of."""
    starts = [frame for part in parts if (frame := _starts(part, frames)) is not None]
    if not starts:
        return replace(verdict, done=False, measure="nothing of it moves")
    near = min(_away(palms[:, min(starts)], thing, min(starts)) for thing in whole)
    return replace(verdict, done=near <= AT_HAND, measure=f"hand {100 * near:.0f} cm from it as it moves")


def _starts(part: Thing, frames: range) -> int | None:
    """The frame of some in which a part begins to move; None where it hardly does."""
    turns, places = (track[frames.start : frames.stop].astype(np.float64) for track in (part.rotations, part.places))
    cosines = (np.einsum("tij,ij->t", turns, turns[0]) - 1) / 2
    turned = np.arccos(np.clip(cosines, -1.0, 1.0)) / _TURNED
    moved = np.maximum(turned, np.linalg.norm(places - places[0], axis=1) / _SHIFTED)
    return frames[int(np.argmax(moved > _BEGINS))] if moved.max() >= 1 else None


def _away(palms: Array, thing: Thing, frame: int) -> float:
    """The metres from the nearest of some palms (P, 3) to the box around a thing."""
    own = (palms - thing.places[frame]) @ thing.rotations[frame]
    low, high = thing.mesh.vertices.min(axis=0), thing.mesh.vertices.max(axis=0)
    return float(np.linalg.norm(own - np.clip(own, low, high), axis=1).min())
