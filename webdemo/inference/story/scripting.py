"""A plan as beats: what happens one after another becomes a beat each, with its acts and the network's words."""

from __future__ import annotations

from collections.abc import Sequence

from acts import Act, Plan, read
from acts.captions import sentence
from acts.lexicon import Entry, Lexicon, lexicon
from motion import InputError

from .beats import Beat


def understood(text: str) -> Plan | None:
    """The plan of a text; None where nobody is told to do anything that is known, or no parser is installed."""
    try:
        plan = read(text)
    except InputError:
        return None
    return plan if any(act.happens for act in plan.acts) else None


def beats_of(plan: Plan, known: Lexicon | None = None) -> tuple[Beat, ...]:
    """The beats of a plan; an answer, such as a fall after a punch, shares the beat of what it answers.

    Args:
        plan: with or without a text.
        known: the lexicon; ours by default.
    """
    known = known or lexicon()
    found: list[list[list[Act]]] = []
    for group in plan.beats():
        if found and (_goes_on(found[-1], group) or _same_beat(found[-1][-1], group, known)):
            found[-1].append(group)
        else:
            found.append([group])
    if len(found) > 1 and not any(act.happens for group in found[0] for act in group):
        found[:2] = [found[0] + found[1]]
    return tuple(
        Beat(words, acts=tuple(act for group in groups for act in group))
        for groups in found
        if (words := sentence(groups, known))
    )


def _goes_on(before: Sequence[Sequence[Act]], group: Sequence[Act]) -> bool:
    """True if before a group only others do something, which goes on while it happens: "A sits until B taps him"."""
    earlier = [act for acts in before for act in acts]
    busy = {who for act in group if act.happens for who in act.agents}
    return all(act.already and not busy & set(act.agents) for act in earlier)


def _same_beat(before: Sequence[Act], group: Sequence[Act], known: Lexicon) -> bool:
    """True if a group of acts belongs into the beat of the one before it."""
    if not any(act.happens for act in group):
        return True  # who does not do something says nothing about when
    first, then = _with_entries(before, known), _with_entries(group, known)
    return any(_belongs(act, e, later, then_e) for act, e in first for later, then_e in then)


def _belongs(act: Act, entry: Entry, later: Act, after: Entry) -> bool:
    """True if one act answers another, or goes on with it in one movement."""
    does, then = {shape.do: shape for shape in entry.stage}, {shape.do: shape for shape in after.stage}
    other = "b" if act.agents[0] == "a" else "a"
    hit = "strike" in does or getattr(does.get("touch"), "fells", False)
    if hit and other in later.agents and len(later.agents) == 1:
        return bool(then.keys() & {"posture", "strike"}) or getattr(then.get("go"), "way", "") in (
            "back",
            "aside",
        )
    way, next_way = (getattr(shapes.get("go"), "way", "") for shapes in (does, then))
    if way and next_way == "after" and later.agents != act.agents:
        return True
    if way == "to" and len(act.agents) == 2 and after.mutual and not then:
        return True  # the network walks two people up to each other and into each other's arms
    same = later.agents == act.agents
    if "lift" in does and getattr(then.get("hold"), "hold", "") == "twirl":
        return True  # "picks her up and spins her around"
    if "lift" in does and "lift" in then:
        return same
    if not same:
        down = "posture" in does and not act.already
        helped = "touch" in then or getattr(then.get("posture"), "who", "") == "patient"
        return down and helped and later.patient in act.agents  # "she faints and he catches her"
    if "turn" in does:
        return next_way == "away" or after.mutual or "touch" in then
    pulled = getattr(then.get("go"), "linked", False) or (not then and later.patient is not None)
    led = bool(does.keys() & {"link", "touch"}) and pulled
    return led or (way == "away" and next_way == "away")


def _with_entries(acts: Sequence[Act], known: Lexicon) -> list[tuple[Act, Entry]]:
    return [(act, known.entries[act.act]) for act in acts if act.happens and act.act in known.entries]
