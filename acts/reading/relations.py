"""Relations in time of a text's acts, each to one that stands before it or above it in the syntax."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from acts.frames import Event
from acts.lexicon import Lexicon
from acts.plan import Act, Relation

from . import order

_KINDS = ("after", "with", "while", "before", "until")
_FOR_THE_OTHER = {"main-after": "after", "main-until": "until"}
"""Joints that say where the act above stands: "as soon as he waves, she bows"."""


def related(
    told: Sequence[Act],
    events: Sequence[Event],
    of: Mapping[int, str],
    beside: Mapping[str, Relation],
    *,
    known: Lexicon,
    repeated: Collection[str],
) -> list[Act]:
    """The acts with their relations.

    Args:
        told: the acts in the order of the text.
        events: of the text.
        of: the id of the act that each event, by its number, has become.
        beside: the relations of acts that are no event's own.
        known: the lexicon of the acts.
        repeated: ids of acts that do again what the one before does.
    """
    number_of = {name: number for number, name in of.items()}
    found: dict[str, list[Relation]] = {act.id: [] for act in told}
    acts = {act.id: act for act in told}
    for act in told:
        if act.id in beside:
            found[act.id].append(beside[act.id])
            continue
        kind, above = _joint(number_of[act.id], events, of)
        if above is None or of[above] == act.id:
            continue
        other = acts[of[above]]
        then, kind = kind == "then", "after" if kind == "then" else kind
        if kind == "after" and (other.already or _waits(other, known)):
            talk = next((r.act for r in found[other.id] if r.kind == "while"), None)
            # What follows "A talks while B waits" follows the talk.
            other = acts[_last_after(talk, act.id, told, found, known)] if talk else other
        if other.id == act.id:  # two clauses that the parser hangs on each other
            continue
        if kind == "conj":
            kind = order.coordinated(other, act, known, repeats=act.id in repeated)
        if kind == "after" and not then and order.answers_blow(other, act, known):
            kind = "with"
        if kind == "after":
            act = acts[act.id] = order.turned_to(other, act, known)
        apart = not set(other.agents) & set(act.agents)
        waits = _waits(act, known) and not then  # "then she waits" is said of what comes next
        if kind == "after" and apart and (other.already or act.already or waits):
            kind = "while"  # what goes on, goes on
        if kind in _FOR_THE_OTHER:
            found[other.id].append(Relation(kind=_FOR_THE_OTHER[kind], act=act.id))  # type: ignore[arg-type]
        else:
            found[act.id].append(Relation(kind=kind if kind in _KINDS else "with", act=other.id))  # type: ignore[arg-type]
    return [acts[act.id].model_copy(update={"order": tuple(found[act.id])}) for act in told]


def _joint(number: int, events: Sequence[Event], of: Mapping[int, str]) -> tuple[str, int | None]:
    """The joint of an event with the nearest above it that has become an act, and that one's number if there is one."""
    kind, above, seen = events[number].joint, events[number].beside, set[int]()
    while above is not None and above not in of and above not in seen:  # passed over
        seen.add(above)
        kind = events[above].joint if kind in ("comp", "") else kind
        above = events[above].beside
    return kind, above if above in of else None


def _waits(act: Act, known: Lexicon) -> bool:
    return {shape.do for shape in known.entries[act.act].stage} == {"stay"}


def _last_after(
    first: str, until: str, told: Sequence[Act], found: Mapping[str, Sequence[Relation]], known: Lexicon
) -> str:
    """The last of the acts that follow each other from ``first`` on, before the act ``until`` in the text."""
    for act in told:
        if act.id == until:
            break
        follows = any(r.kind == "after" and r.act == first for r in found[act.id])
        first = act.id if follows and not _waits(act, known) else first
    return first
