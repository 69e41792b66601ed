"""Voice: who does what a verb says and to whom it is done, in the passive and where the words leave one of them out."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from acts.frames import best
from acts.lexicon import Lexicon
from acts.plan import other_of
from acts.said import Event, Ref

from .vocabulary import vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Token


def other_person(ref: Ref) -> Ref | None:
    """The other of the two; None for both and for what is no person."""
    other = other_of(ref.who)
    return Ref("person", other) if ref.kind == "person" and other else None


def is_passive(token: Token) -> bool:
    """True for a passive of its own: "is pushed", "pushed by her"."""
    signs = any(child.dep_ in ("nsubjpass", "auxpass", "agent") for child in token.children)
    return signs and token.tag_ == "VBN"


def goes_on(token: Token) -> bool:
    """True for a participle that shares the auxiliary of a passive before it: "is pushed and kicked"."""
    if token.dep_ != "conj" or any(child.dep_ in ("nsubj", "auxpass", "aux") for child in token.children):
        return False
    being = next((child for child in token.head.children if child.dep_ == "auxpass"), None)
    present = being is not None and being.tag_ in ("VBZ", "VBP")
    return being is not None and (token.tag_ == "VBN" or (present and token.tag_ == "VBD"))


def is_suffered(token: Token, event: Event, known: Lexicon) -> bool:
    """True for a participle of what was done to the subject: "shoved in the chest, he falls"."""
    alone = token.tag_ == "VBN" and token.dep_ == "advcl" and event.object is None
    own = any(c.dep_ in ("aux", "auxpass", "agent", "mark", "nsubj") for c in token.children)
    if not alone or own or token.lower_ == "seated":
        return False
    return event.lemma in known.frames and best(known.frames, event) is None


def state_of(token: Token, event: Event, known: Lexicon) -> Event | None:
    """A passive that only says how somebody is, as an event of "be": "they are seated"; None for other verbs."""
    if not is_passive(token) or any(child.dep_ == "agent" for child in token.children):
        return None
    state = replace(event, lemma="be", words=[*event.words, token.lower_], ongoing=True)
    found = best(known.frames, state)
    named = found is not None and any(token.lower_ in element.words for element in found[1].elements)
    return state if named else None


def give_roles(token: Token, event: Event, agent: Ref | None) -> None:
    """Makes the subject of a passive the one to whom it is done, and the agent, said or not, its subject."""
    subject = event.subject
    if subject is not None and subject.kind == "part" and subject.who and _is_own(token):
        agent = agent or Ref("person", subject.who)  # "whose hands are clasped behind his head"
    agent = agent or (other_person(subject) if subject is not None else None)
    if agent is None and subject is not None and subject.kind in ("thing", "part"):  # "is held out to her"
        of = [*(ref for _, ref in event.prepositions if ref.kind == "person"), Ref("person", subject.who)]
        agent = other_person(of[0])
    if event.object is not None and event.dative is None:  # "she is given a book"
        event.dative, event.subject = subject, agent
    else:
        event.object, event.subject = subject, agent


def _is_own(token: Token) -> bool:
    """True for a participle of how a part of one's own body is: "crossed", "raised"."""
    return token.lower_ in vocabulary().verbs["held"]
