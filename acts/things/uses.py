"""The acts of a plan that are done with things, each with its frames."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from acts import Act, Plan, lexicon
from acts.lexicon import SEATS, Does, is_fixture, is_listed, kind_of, nouns_in, thing_of
from acts.staging.strikes import BOUTS
from motion.things import HELD

TABLES = ("computer", "table")
"""Furniture at which people sit."""
ONE_EACH = ("book", "cigarette", "cup", "flower", "guitar", "phone", "sword")
"""Kinds of which two people hold one each."""
_THROUGH = re.compile(r"\bthrough (?:the|an?) ((?:\w+ )?(?:door|doorway|gate))\b")
_ON = re.compile(r"\b(?:on|onto|upon|at|to) (?:the|an?|his|her|their) ((?:\w+ )?\w+)")


@dataclass(frozen=True)
class Use:
    """One act with one thing.

    Attributes:
        id: of the act.
        does: what is done with it.
        kind: of the thing; "" for the seat of a person of whom no seat is named.
        name: what the words call it.
        agents: indices of the people who do it.
        other: index of the other person who takes part, or None.
        side: "left", "right" or "".
        start, stop: frames between which it happens.
        on: kind of furniture that it is put on, or that people sit at; "" for none.
    """

    id: str
    does: Does
    kind: str
    name: str
    agents: tuple[int, ...]
    other: int | None
    side: str
    start: int
    stop: int
    on: str = ""


def uses_of(plan: Plan, start: int, stop: int, lengths: Sequence[float]) -> list[Use]:
    """The uses of things in a plan, in the order of time.

    Args:
        plan: of the frames from ``start`` to ``stop`` (exclusive).
        start, stop: frames.
        lengths: seconds of the beats into which the sentence was split, where it was.
    """
    uses = list[Use]()
    for act, first, last in act_frames(plan, start, stop, lengths):
        words = plan.text(act.words)
        each = (read(act, words, first, last) for read in (_use, _fixture, _door))
        uses += [_same(use, uses, words) for use in each if use]
    return [each for use in _at_desks(uses) for each in _in_turn(use)]


def _same(use: Use, uses: Sequence[Use], words: str) -> Use:
    """A use; of what goes without saying, it is of a thing of its kind that was named before."""
    unnamed = use.name == use.kind and use.name not in words
    return replace(use, name=next((u.name for u in uses if unnamed and u.kind == use.kind), use.name))


def _in_turn(use: Use) -> Iterator[Use]:
    """A use; of two who throw each other something, one throw after the other."""
    if use.does != "throws" or len(use.agents) == 1:
        yield use
        return
    times = max(round((use.stop - use.start) / BOUTS["throws"].period), 2)
    edges = np.linspace(use.start, use.stop, times + 1).astype(int).tolist()
    for i, (start, stop) in enumerate(pairwise(edges)):
        who = use.agents[i % 2]
        yield replace(use, agents=(who,), other=1 - who, start=start, stop=stop)


def _at_desks(uses: Sequence[Use]) -> list[Use]:
    """The uses; people who type sit at a computer, and what is put down by a person at a desk is put on it."""
    typists = {who for use in uses if "computer" in (use.kind, use.on) for who in use.agents}
    desks: dict[int, str] = {}
    seated = []
    for use in uses:
        if use.does == "sits" and (use.on or typists & {*use.agents}):
            use = replace(use, on="computer" if typists & {*use.agents} else use.on)
            desks |= dict.fromkeys(use.agents, use.on)
        elif use.does == "puts" and not use.on:
            use = replace(use, on=desks.get(use.agents[0], ""))
        seated.append(use)
    return seated


def act_frames(plan: Plan, start: int, stop: int, lengths: Sequence[float]) -> Iterator[tuple[Act, int, int]]:
    """The acts of a plan that happen, each with its frames; the arguments are those of :func:`uses_of`."""
    groups = [[act for act in group if act.happens] for group in plan.beats()]
    edges = _edges(groups, start, stop, lengths)
    for group, (first, last) in zip(groups, pairwise(edges), strict=True):
        for act in group:
            yield act, first, last


def _edges(groups: Sequence[Sequence[Act]], start: int, stop: int, lengths: Sequence[float]) -> list[int]:
    """Frames at which the groups of a plan begin, and the last one ends."""
    if len(lengths) == len(groups):
        shares = np.array(lengths, dtype=float)
    else:
        shares = np.array([max((_seconds(act) for act in group), default=1.0) for group in groups])
    return [start + round(x) for x in np.r_[0.0, np.cumsum(shares) / max(shares.sum(), 1e-9)] * (stop - start)]


def _seconds(act: Act) -> float:
    entry = lexicon().entries.get(act.act)
    return act.seconds or (entry.seconds if entry else 3.0)


def _use(act: Act, words: str, start: int, stop: int) -> Use | None:
    entry = lexicon().entries.get(act.act)
    does: Does = entry.thing if entry else ""
    if not does:
        return None
    agents = tuple("ab".index(who) for who in act.agents)
    other = "ab".index(act.patient) if act.patient else (1 - agents[0] if len(agents) == 1 else None)
    side = act.side if act.side in ("left", "right") else ""
    place = _place(words)
    if does == "sits":
        sits = [shape for shape in lexicon().entries[act.act].stage if shape.do == "posture"]
        if act.patient and all(shape.who == "patient" for shape in sits):
            agents = ("ab".index(act.patient),)  # whom the agent seats
        place = place or "table" * (kind_of(act.thing or "") == "table")
        if is_listed(words, "floor") and not place:
            return None
        seats = [noun for noun in nouns_in(f"{words} {act.thing or ''}") if noun[1] in SEATS]
        name, kind = seats[0] if seats else ("chair", "")
        return Use(act.id, does, kind, name, agents, other, side, start, stop, place)
    name, kind = thing_of(act, words)
    struck = does == "holds" and kind == "ball" and entry is not None and entry.prop not in ("", kind)
    if does == "uses" and kind not in HELD:
        kind = ""  # "sweeps the floor" with a tool
    if struck or (not kind and (does == "uses" or not act.thing)):  # who hits a ball holds the racket
        name = kind = entry.prop if entry else ""
    if does in ("throws", "kicks"):
        other = {"up": agents[0], "away": None, "down": None}.get(act.direction or "", other)
    if not kind or is_fixture(name):
        return None
    if does in ("opens", "closes"):
        does = "holds"
    if does == "holds" and len(agents) == 2 and act.thing and kind not in ONE_EACH:
        does = "carries"
    on = place if does in ("puts", "drops") and place != kind else ""
    return Use(act.id, does, kind, name, agents, other, side, start, stop, on)


def _fixture(act: Act, words: str, start: int, stop: int) -> Use | None:
    """The window or the like before which an act is done."""
    name, kind = thing_of(act, words) if act.thing else ("", "")
    if not is_fixture(name):
        return None
    entry = lexicon().entries.get(act.act)
    does = entry.thing if entry and entry.thing in ("opens", "closes", "carries") else "faces"
    agents = tuple("ab".index(who) for who in act.agents)
    return None if does == "carries" else Use(act.id, does, kind, name, agents, None, "", start, stop)


def _place(words: str) -> str:
    """ "table" or "computer" where the words name one as a place, "" elsewhere."""
    kinds = {kind_of(noun) for noun in _ON.findall(words.lower())}
    return next((kind for kind in TABLES if kind in kinds), "")


def _door(act: Act, words: str, start: int, stop: int) -> Use | None:
    """The door frame of one who goes through a door."""
    if not (door := _THROUGH.search(words.lower())):
        return None
    agents = tuple("ab".index(who) for who in act.agents)
    return Use(act.id, "passes", "door frame", door[1], agents, None, "", start, stop)
