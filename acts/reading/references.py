"""References: what the nouns and pronouns of a text stand for, beside the people parts of bodies and things."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from acts.frames import Ref
from acts.things import is_fixture

from .people import A_NAME, ANYONE, B_NAME, PRONOUN_SEX, Cast, begins_clause
from .vocabulary import closed, vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

_SOMEBODY = ANYONE | {"someone", "somebody"}
_PLAIN = _SOMEBODY | {"man", "woman", "guy", "boy", "girl", "human", "kid", "child", "dude", "figure", "sim"}
"""Nouns that name nobody's part in a scene, as "nurse" does, who has a patient."""


def names_one(doc: Doc) -> bool:
    """True for a parsed text that names a single person, whose every part of a body and pronoun are."""
    words_of = vocabulary()
    nouns = [t for t in doc if t.lower_ in _SOMEBODY or words_of.is_usual_person(t.lemma_.lower())]
    nouns = [t for t in nouns if t.pos_ not in ("VERB", "ADV", "ADJ") and t.dep_ != "amod"]
    words = {t.lower_ for t in doc if not _is_of_thing(t)}
    if any(t.lower_ == "one" and words_of.part(t.nbor().lemma_) for t in doc[:-1]):
        words -= {"other"}  # "one foot in front of the other"
    new = sum(any(c.lower_ in ("a", "an") for c in t.children) for t in nouns)
    plain = all(t.lemma_.lower() in _PLAIN for t in nouns)
    objects = (t for t in doc if t.lower_ in ("him", "her", "them") and t.dep_ != "poss")
    plain = plain and all(
        t.head.lower_ in closed("around oneself") or (t.lower_ == "them" and t.dep_ != "pobj") for t in objects
    )
    same = plain and len({t.lemma_.lower() for t in nouns}) == 1 and new < 2 and all(t.tag_ == "NN" for t in nouns)
    sexes = {PRONOUN_SEX[word] for word in words & PRONOUN_SEX.keys()}
    sexes |= {words_of.sex(t.lemma_.lower()) for t in nouns} - {""}
    named = any(t.text in (A_NAME, B_NAME) for t in doc) or bool(words & closed("company"))
    return same and len(sexes) < 2 and not named


def _is_of_thing(token: Token) -> bool:
    """True for a word of company that says of a thing which one it is: "another ball", "the other hand"."""
    noun, words = token.head.lemma_.lower(), vocabulary()
    counted = token.lower_ == "another" and any(c.dep_ == "nummod" for c in token.head.children)
    if token.head == token or (token.head.tag_ != "NN" and not counted):  # "the other hands him a cup"
        return False
    if token.lower_ == "another":
        return not words.is_person(noun)
    return token.lower_ in closed("ordinals") and bool(words.part(noun) or noun in closed("countable"))


def reference(token: Token, cast: Cast, subject: str) -> Ref:
    """The reference of a noun or pronoun; see :class:`acts.frames.Ref`."""
    first, last = token.idx, token.idx + len(token.text)
    lemma = token.lemma_.lower()
    children = {child.lower_ for child in token.children}
    if token.lower_.endswith(("self", "selves")):
        return Ref("self", subject, lemma, first=first, last=last)
    if token.lower_ in ("other", "another") and children & {"each", "one"}:
        return Ref("each", "ab", "other", first=first, last=last)
    behind = cast.alone and token.dep_ == "pobj"  # "holds them in front of them"
    if token.lower_ == "them" and cast.things is not None and len(subject) == 1 and not behind:
        return replace(cast.things, first=first, last=last)  # "drops her keys, and he picks them up"
    if token.lower_ == "it" and cast.thing is not None and not cast.person(token):
        said_of = cast.thing_of if cast.thing_of != subject and len(cast.thing_of) == 1 else ""
        hers = bool(cast.thing_sex) and cast.thing_sex == cast.sex(subject)  # "kisses her hand; she withdraws it"
        owner = cast.thing.who or (said_of if cast.thing.kind == "part" and not hers else "")
        return replace(cast.thing, who=owner, first=first, last=last)  # "extends a hand, and she shakes it"
    ref = _reference(token, cast, subject)
    cast.seen[token.i] = ref
    if ref.kind == "person":
        cast.note_states(token, ref.who)
        of = (c for c in token.children if c.lower_ == "of")  # "one of the kids"
        cast.seen |= {c.i: ref for each in of for c in each.children if vocabulary().is_person(c.lemma_.lower())}
    _note_thing(token, ref, cast, subject)
    return ref


def _is_aside(token: Token, cast: Cast) -> bool:
    """True for the noun of a preposition whose verb does something with a thing: "throws the ball in the air"."""
    verb = token.head.head if token.dep_ == "pobj" else token
    objects = (child for child in verb.children if child.dep_ in ("dobj", "obj"))
    thing = cast.thing
    return thing is not None and thing.kind == "thing" and any(o.lemma_.lower() == thing.lemma for o in objects)


def _note_thing(token: Token, ref: Ref, cast: Cast, subject: str) -> None:
    """Notes what "it" and "them" mean from here on."""
    light = token.head.lemma_.lower() in vocabulary().verbs["light"]  # "does two jumps"
    many = ref.kind == "thing" or (ref.kind == "part" and cast.alone)
    taken = token.dep_ == "dobj" or (ref.kind == "part" and token.head.lower_ in ("with", "of"))
    if many and token.tag_ == "NNS" and taken and (ref.kind == "part" or not light):
        cast.things = ref
    beside = token.dep_ == "pobj" and cast.thing is not None and (ref.kind, cast.thing.kind) == ("part", "thing")
    lifted = cast.alone and cast.thing is not None and cast.thing.family in closed("limbs")
    if lifted and ref.kind == "part" and (ref.family not in closed("limbs") or token.head.lower_ in ("at", "from")):
        return  # "raises a hand, rubs his head and lowers it", "bends an arm at the elbow and lowers it"
    if beside or _is_aside(token, cast):  # "throws the ball over her shoulder, and he catches it"
        return
    if ref.lemma in closed("manners"):
        return
    goal = ref.kind == "thing" and cast.thing is None and is_fixture(ref.lemma)  # "at the door, and opens it"
    if ref.kind in ("part", "thing") and token.tag_ in ("NN", "NNP") and (goal or not ref.place):
        cast.thing, cast.thing_of = ref, subject
        cast.thing_sex = next((sex for c in token.children if (sex := PRONOUN_SEX.get(c.lower_))), "")


def _reference(token: Token, cast: Cast, subject: str) -> Ref:
    words = vocabulary()
    first, last = token.idx, token.idx + len(token.text)
    lemma = token.lemma_.lower()
    family = words.part(lemma)
    if family and not (token.ent_type_ or token.pos_ == "PROPN"):
        owner = cast.owner(token, subject)
        side = next((child.lower_ for child in token.children if child.lower_ in ("left", "right", "both")), "")
        if not side and token.tag_ == "NNS" and family in ("hand", "arm", "foot", "leg", "knee", "shoulder"):
            side = "both"
        lemma = "back" if lemma == "spine" else lemma
        bare = all(c.dep_ != "poss" and c.tag_ != "PRP$" and c.lower_ != "of" for c in token.children)
        definite = any(c.lower_ == "the" for c in token.children)
        return Ref("part", owner, lemma, family, side, bare=bare, definite=definite, first=first, last=last)
    thirds = len(cast.third)
    who = cast.person(token, subject)
    if who:
        conjuncts = [c for c in token.conjuncts if c.i > token.i and c.dep_ == "conj" and not begins_clause(c)]
        if len(who) == 1 and any(cast.person(c, who) not in (None, who) for c in conjuncts):
            both = Ref("person", "ab", lemma, first=first, last=last)
            cast.seen |= {c.i: both for c in conjuncts}
            return both
        return Ref("person", who, lemma, first=first, last=last)
    if len(cast.third) > thirds:
        return Ref("third", "", lemma, first=first, last=last)
    owner = cast.owner(token, subject) if any(c.dep_ == "poss" for c in token.children) else ""
    owner = "ab" if owner == "each" else owner
    bare = token.tag_ == "NN" and all(c.dep_ not in ("det", "poss", "nummod", "predet") for c in token.children)
    return Ref("thing", owner, lemma, place=lemma in words.places, bare=bare, first=first, last=last)
