"""The acts of a plan with their times, as a network reads them (:mod:`models.intergen.plan_track`)."""

from __future__ import annotations

from collections.abc import Sequence

from acts import Act
from acts.plan import beats
from models.intergen.plan_track import TimedAct


def timed(acts: Sequence[Act], start: float, stop: float) -> tuple[TimedAct, ...]:
    """The acts that happen from frame ``start`` to ``stop``; those that follow one another get equal parts of it."""
    groups = beats([act for act in acts if act.happens])
    part = (stop - start) / max(len(groups), 1)
    return tuple(
        timed_act(act, start + k * part, start + (k + 1) * part)
        for k, group in enumerate(groups)
        for act in group
    )


def timed_act(act: Act, start: float, stop: float) -> TimedAct:
    """One act of a plan from frame ``start`` to ``stop``."""
    return TimedAct(
        act.act,
        tuple("ab".index(agent) for agent in act.agents),
        start,
        stop,
        patient=None if act.patient is None else "ab".index(act.patient),
        side=act.side,
        manner=act.manner,
        direction=act.direction,
        speed=act.speed,
    )
