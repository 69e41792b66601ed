"""The acts of looking at a thing: a ray from the eyes says whether it is looked at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from acts import Plan
from acts.checking import Verdict
from acts.things import kind_of
from motion import Duet
from motion.things.sight import looked_at

from .fixtures import BODIES, LEAVES
from .uses import act_frames

LOOKS = "look-at-thing"
"""The entry of the lexicon that says that somebody looks at something."""
LEAST = 0.4
"""Seconds for which somebody must look at a thing."""


def watched(
    verdicts: Sequence[Verdict], plan: Plan, duet: Duet, start: int, stop: int | None, lengths: Sequence[float]
) -> tuple[Verdict, ...]:
    """The verdicts, of which those on looks at a thing that is in the scene follow from where the face points.

    Args:
        verdicts: on the acts of the plan.
        plan: of the frames from ``start`` to ``stop``.
        duet: with its things.
        start, stop: frames; None for the end.
        lengths: seconds of the beats into which the sentence was split, where it was.
    """
    kinds = {act.id: _kinds(act.thing) for act in plan.acts if act.act == LOOKS and act.thing and act.happens}
    if not duet.things or not any(kinds.values()):
        return tuple(verdicts)
    looks = {}
    end = duet.num_frames if stop is None else stop
    for act, first, last in act_frames(plan, start, end, lengths):
        here = [i for i, thing in enumerate(duet.things) if thing.kind in kinds.get(act.id, ())]
        if here and last > first:
            looks[act.id] = min(_seconds(duet, who, first, last, here) for who in act.agents)
    return tuple(
        replace(each, done=looks[each.id] >= LEAST, measure=f"looks at it for {looks[each.id]:.1f} s")
        if each.id in looks
        else each
        for each in verdicts
    )


def _kinds(noun: str | None) -> set[str]:
    """The kinds of things that a noun may stand for: a window is its frame, its sashes and its curtains."""
    kind = kind_of(noun or "")
    body = BODIES.get(kind, kind)
    return {kind, body, *(leaf.kind for leaf in LEAVES.get(body, ()))} - {""}


def _seconds(duet: Duet, who: str, first: int, last: int, things: Sequence[int]) -> float:
    """Seconds for which a person's face points to one of some things."""
    me = "ab".index(who)
    people = duet.positions[:, first:last].astype(np.float64)
    cut = [thing.cut(first, last) for thing in duet.things]
    return float(np.isin(looked_at(cut, people[me], people[1 - me]), things).sum() / duet.fps)
