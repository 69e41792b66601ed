"""Completion of clauses by what others say: whose part of the body it is about, an object, whom it is done to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from acts.events import Event, Ref
from acts.lexicon import Lexicon
from acts.plan import Act, other_of

from .vocabulary import vocabulary

_SHARING = frozenset(("conj", "after", "with"))
"""Joints of clauses that may share an object."""

_LIMBS = frozenset(("hand", "arm", "leg", "foot"))


def completed(
    number: int, event: Event, events: Sequence[Event], acts: Sequence[Act], known: Lexicon, alone: bool
) -> Iterator[tuple[Event, float]]:
    """The event with what other words say of it, as the object of "he reads and tears up the letter", and the cost.

    Args:
        number: of the event.
        event: that no act fits as it is.
        events: of the text.
        acts: before it.
        known: the lexicon.
        alone: whether the text names a single person.
    """
    if event.subject is not None and event.subject.kind == "part" and event.object is None:
        above = events[event.beside].subject if event.beside is not None else None
        whose = event.subject.who or (above.who if above is not None and above.kind == "person" else "")
        if len(whose) == 1:  # "an arm hooked around his waist": who hooks it there
            yield replace(event, subject=Ref("person", whose), object=event.subject, state=True), 0.0
    if (limb := event.subject) is not None and limb.kind == "part" and limb.family in _LIMBS:
        whose = limb.who or ("".join(acts[-1].agents) if acts else "a")
        by = ("with", replace(limb, who=""))  # "his right hand picks it up": with it, he does
        yield replace(event, subject=Ref("person", whose), prepositions=[*event.prepositions, by]), 0.0
    if event.object is not None and _is_implied(event.subject):  # "is frozen" needs nobody who freezes him
        yield replace(event, subject=event.object, object=None), 0.0
    if event.object is not None or event.dative is not None:
        return
    beside = events[event.beside] if event.beside is not None and event.joint in _SHARING else None
    after = [other for other in events if other.beside == number and other.joint in _SHARING]
    for other in (beside, *after):
        if other is not None and other.object is not None and other.subject == event.subject:
            yield replace(event, object=other.object), 0.0
    if (patient := _meant(event, acts, known)) is not None:  # "leans in, but does not kiss"
        yield replace(event, object=Ref("person", patient)), 0.0
    bare = not alone and event.lemma in known.frames and not event.particles and event.joint != "comp"
    bare = bare and event.lemma not in vocabulary().verbs["vague"]  # "leads with arm circles"
    bare = bare and all(ref.kind == "thing" for _, ref in event.prepositions)
    inner = any(other.beside == number and other.joint == "comp" for other in events)
    if event.subject is not None and bare and not inner and (whom := other_of(event.subject.who)):
        yield replace(event, object=Ref("person", whom)), 1.0  # "one pushes and the other falls"


def of_the_last(event: Event, acts: Sequence[Act]) -> Event | None:
    """The event about the other's body, where what is done to it follows what was done to them.

    As in "walks up to the other and covers his eyes", where nothing says whose.
    """
    part, who = event.object, event.subject.who if event.subject is not None else ""
    if part is None or part.kind != "part" or part.who:
        return None
    last = next((act for act in reversed(acts) if "".join(act.agents) == who), None)
    if last is None or last.patient is None:
        return None
    handles = not part.bare or (last.part is not None and part.definite)
    return replace(event, object=replace(part, who=last.patient)) if handles else None


def _meant(event: Event, acts: Sequence[Act], known: Lexicon) -> str | None:
    """The other person, where a verb without an object follows what was done to them."""
    last, subject = next(reversed(acts), None), event.subject
    if last is None or subject is None or subject.who != "".join(last.agents):
        return None
    bare = not event.particles and not event.prepositions and event.lemma in known.frames
    return last.patient if bare else None


def _is_implied(subject: Ref | None) -> bool:
    """True for the agent of a passive that the words leave out."""
    return subject is not None and subject.kind == "person" and not subject.last


# ---- repeats -------------------------------------------------------------------------------------------
_SAME = frozenset(("same", "it", "that", "this", "likewise", "so"))
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
