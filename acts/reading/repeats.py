"""Verbs by which acts are done once more, or refused: "and B copies it", "he does too", "they switch roles"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from acts.lexicon import Lexicon
from acts.plan import Act, other_of
from acts.said import Event

from .vocabulary import vocabulary

_SAME = frozenset(("same", "it", "that", "this", "likewise", "so"))
_EXCHANGES = frozenset(("switch", "swap", "change", "exchange", "trade", "reverse"))
_OTHER = {"a": "b", "b": "a"}
_MIRRORED = {"left": "right", "right": "left"}
_MOVEMENTS = frozenset(("movement", "move", "gesture", "motion", "pose", "step", "action"))


def repeated(event: Event, last: Act, has_inner: bool, known: Lexicon) -> dict[str, Any] | None:
    """Fields by which an event does the last act once more; None where it says something else.

    Args:
        event: whose verb may repeat or refuse an act.
        last: the act before it.
        has_inner: whether a clause depends on the event, as in "mirrors it facing you".
        known: the lexicon, whose acts may be named: "shows a squat".
    """
    verbs, subject, ref = vocabulary().verbs, event.subject, event.object
    repeats = event.lemma in verbs["repeats"]
    named = ref is None or ref.lemma in _SAME or ref.kind == "person"
    named = named or (repeats and ref is not None and (ref.kind == "part" or ref.lemma in _MOVEMENTS))
    named = named or (repeats and ref is not None and ref.lemma in known.frames)
    if subject is None or subject.kind != "person" or not named:
        return None
    if has_inner and not (repeats and ref is not None and ref.lemma in _SAME):
        return None
    declines = event.lemma in verbs["not"] | verbs["wished"]
    if event.lemma != "do" and not repeats and not declines:
        return None
    if declines and ((ref is not None and ref.lemma not in _SAME) or not (event.denied or event.lemma in verbs["not"])):
        return None
    agents, other = tuple(subject.who), other_of(subject.who) or "a"
    if len(last.agents) > 1 or (len(agents) > 1 and event.lemma != "do"):
        return None
    both = len(agents) > 1 or last.patient is None
    return {
        "agents": agents,
        "patient": None if both else (last.patient if agents == last.agents else other),
        "polarity": "not" if declines or event.denied else "done",
        "modality": "told",
        "order": (),
        "already": False,
        "times": event.times or last.times,
        "part_of": agents[0] if last.part_of in last.agents else last.part_of,
        "side": event.side or (_MIRRORED.get(last.side or "", last.side) if event.lemma == "mirror" else last.side),
    }


def exchanged(event: Event, acts: Sequence[Act]) -> list[Act]:
    """The last acts of one person each, done by the other, where an event says that roles are exchanged; or none."""
    ref = event.object
    if event.lemma not in _EXCHANGES or ref is None or ref.lemma != "role" or event.denied:
        return []
    first = len(acts)
    while first and len(acts[first - 1].agents) == 1:
        first -= 1
    return [_exchanged(act) for act in acts[first:]]


def _exchanged(act: Act) -> Act:
    people = {"agents": tuple(_OTHER[who] for who in act.agents), "patient": _OTHER.get(act.patient or "")}
    return act.model_copy(update={**people, "part_of": _OTHER.get(act.part_of or ""), "order": ()})
