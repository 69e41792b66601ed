"""The parts of a sentence that a verdict leaves out: words in no act, and qualifiers of acts that no rule measures.

A word is in an act that its clause names: as one of the entry's own words or a verb of like meaning, as the act's
thing, part of the body or manner, or as its number, side, direction, speed, length or distance. Words of grammar and of
the two people count for nothing.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from typing import TYPE_CHECKING

from motion import InputError

from .lexicon import Entry, Lexicon, lexicon
from .plan import FROM_BEHIND, Act, Plan
from .reading import wordnet
from .reading.parses import Parse, parses
from .reading.people import A_NAME, B_NAME
from .reading.spelling import Speller
from .reading.vocabulary import vocabulary
from .reading.wording import prepared
from .shapes import Go
from .things import kind_of

if TYPE_CHECKING:
    from spacy.tokens import Token

MOST_WORDS = 12
"""Stretches of words that are reported of one sentence, at most."""
_CONTENT = frozenset(("NOUN", "PROPN", "VERB", "ADJ", "ADV", "NUM"))
_FILLERS_TEXT = (
    "then finally again next now afterwards afterward meanwhile later first second last also too so "
    "very just still already even only almost together simultaneously immediately instead back "
    "around away off not never there here ever other another each same such one time turn way "
    "something nothing each-other when while how where let"
)
_FILLERS = frozenset(_FILLERS_TEXT.split())
"""Words of grammar, of order and of together and apart, which the acts' agents and order stand for."""
_SCENERY = frozenset(
    ["floor", "ground", "room", "place", "spot", "air", "direction", "body", "scene", "person", "people"]
)
"""What is there in every scene."""
_KINDS = (
    "begins",
    "ends",
    "light",
    "causes",
    "tried",
    "pretended",
    "wished",
    "offered",
    "not",
    "seems",
    "sees",
)
"""Verbs about other verbs, which the acts' modality, polarity and order stand for."""
_STATES = frozenset(("be", "have", "stand", "stay", "remain", "keep", "do", "go", "come"))
_WORD, _SLOTS = re.compile(r"[a-z]+"), re.compile(r"\{(?![\w.]+:)[^}]*\}")
_TURNS = frozenset(("left", "right", "clockwise", "counterclockwise"))
"""Directions that never belong to what an act's own words mean."""
_SIDED = frozenset(("hand", "arm", "foot", "leg"))
"""Families of the parts with which something is done: "with both hands"."""
_BOTH = re.compile(
    r"\bboth (?:\w+ )?(?:hands|arms|palms|fists|feet|legs|knees|elbows|shoulders|cheeks)\b", re.IGNORECASE
)


# ---- words that are in no act ----------------------------------------------------------------------------
def unread_words(plan: Plan, known: Lexicon | None = None) -> tuple[str, ...]:
    """The stretches of a plan's sentence that are in no act, in its order, as they were written.

    Args:
        plan: with the sentence that it was read from; one that was written by hand has none.
        known: the lexicon; ours by default.
    """
    if not plan.sentence.strip():
        return ()
    return _unread(plan, lexicon() if known is None else known)


@lru_cache(maxsize=256)
def _unread(plan: Plan, known: Lexicon) -> tuple[str, ...]:
    whole = [(each.words.start, each.words.stop) for each in plan.unread]
    found = list(whole)
    if not any(start == 0 and stop >= len(plan.sentence.rstrip()) for start, stop in whole):
        speller = Speller(known)
        try:
            parsed = next(parses(prepared(plan.sentence, speller), speller))
        except InputError:  # no parser is installed, where a kept plan is shown
            return tuple(plan.sentence[i:j] for i, j in _joined(found, plan.sentence))[:MOST_WORDS]
        for token in parsed.doc:
            start, stop = parsed.text.span(token.idx, token.idx + len(token))
            inside = any(first <= start and stop <= last for first, last in whole)
            if (
                not inside
                and _counts(token, parsed)
                and not _explained(token, start, stop, plan, known, parsed)
            ):
                found.append(parsed.text.span(*_phrase(token)))
    return tuple(plan.sentence[i:j] for i, j in _joined(found, plan.sentence))[:MOST_WORDS]


def _counts(token: Token, parsed: Parse) -> bool:
    """True for a word that says something of what is done."""
    lemma, words = _lemma(token, parsed), vocabulary()
    if (
        token.pos_ not in _CONTENT
        or not token.text[0].isalnum()
        or (len(token.text) < 2 and not token.text.isdigit())
    ):
        return False
    if {lemma, token.lower_} & (_FILLERS | _SCENERY) or token.text in (A_NAME, B_NAME):
        return False
    if token.pos_ in ("VERB", "AUX") and (
        lemma in _STATES or any(lemma in words.verbs[kind] for kind in _KINDS)
    ):
        return False
    if token.dep_ in ("prt", "aux", "auxpass", "neg", "mark") or token.lower_ in words.both:
        return False
    if token.pos_ in ("NOUN", "PROPN") and (words.is_person(lemma) or words.is_person(token.lower_)):
        return False
    if token.pos_ == "PROPN" and token.dep_ in ("nsubj", "compound", "dobj", "pobj", "poss"):
        return token.text.islower()  # a name
    if token.pos_ in ("NUM", "ADJ") and words.is_person(_lemma(token.head, parsed)):
        return not (token.pos_ == "NUM" or words.age(lemma))
    return True


def _explained(token: Token, start: int, stop: int, plan: Plan, known: Lexicon, parsed: Parse) -> bool:
    """True for a word that an act stands for: one of its clause, or of a word that was read with it."""
    around = [
        act.words for act in plan.acts if act.words and act.words.start <= start and stop <= act.words.stop
    ]
    for act in plan.acts:
        entry, own = known.entries.get(act.act), act.words
        near = own is None or any(own.start < span.stop and span.start < own.stop for span in around)
        if entry is not None and near and _in_act(token, act, entry, parsed):
            return True
    return False


def _in_act(token: Token, act: Act, entry: Entry, parsed: Parse) -> bool:
    words, lemma, text = vocabulary(), _lemma(token, parsed), token.lower_
    forms = {lemma, text, *_WORD.findall(text)}
    if (way := words.directions.get(text)) in _TURNS:
        return way in (act.direction, act.side)
    if forms & said_words((*entry.frames, *entry.caption)) or (
        text == "behind" and FROM_BEHIND in act.manner
    ):
        return True
    if token.pos_ in ("VERB", "NOUN") and _alike(lemma, entry.frames, entry.synsets):
        return True
    if act.thing and forms & set(act.thing.split()):
        return bool(kind_of(act.thing))
    if family := words.part(lemma):
        sided = (
            act.side is not None and family in _SIDED and any(c.lower_ == act.side for c in token.children)
        )
        return sided or (act.part is not None and family == words.part(act.part))
    if forms & set(act.manner) or (text in words.speeds and act.speed != 1.0):
        return True
    if (way is not None and way == act.direction) or (text == "both" and act.side == "both"):
        return True
    if text in words.numbers or text.isdigit():
        return any(value is not None for value in (act.times, act.seconds, act.distance))
    return (lemma in words.metres and act.distance is not None) or (
        lemma in words.seconds and act.seconds is not None
    )


@lru_cache(maxsize=1024)
def said_words(texts: tuple[str, ...]) -> frozenset[str]:
    """The words of frames and captions, without the slots of captions."""
    return frozenset(word for text in texts for word in _WORD.findall(_SLOTS.sub("", text.lower())))


@lru_cache(maxsize=4096)
def _alike(lemma: str, frames: tuple[str, ...], synsets: tuple[str, ...]) -> bool:
    """True for a verb, or the noun of one, that means what one of an entry's verbs does."""
    mine = {sense for sense, _ in wordnet.meanings(lemma)} | set(wordnet.senses(lemma)[:2])
    theirs = {wordnet.synset(name) for name in synsets}
    for verb in {verb for frame in frames for verb in frame.split()[1].split("|")}:
        theirs |= set(wordnet.senses(verb)[:2])
    return bool(mine & theirs)


def _lemma(token: Token, parsed: Parse) -> str:
    return str(parsed.lemmas.get(token.i, token.lemma_.lower()))


def _phrase(token: Token) -> tuple[int, int]:
    """A word with what belongs to it on its left, and its preposition: "against the wall"."""
    first = token
    if token.pos_ in ("NOUN", "PROPN") and token.lower_ not in vocabulary().directions:
        own = [c for c in token.lefts if c.dep_ in ("det", "amod", "compound", "poss", "nummod")]
        first = min((token, *own), key=lambda each: each.i)
        if token.dep_ == "pobj" and 0 < first.i - token.head.i <= 1:
            first = token.head
    return first.idx, token.idx + len(token)


def _joined(spans: list[tuple[int, int]], text: str) -> Iterator[tuple[int, int]]:
    """Spans in order, of which those that overlap or touch are one."""
    last: tuple[int, int] | None = None
    for start, stop in sorted(spans):
        if last is not None and (start <= last[1] or not text[last[1] : start].strip()):
            last = (last[0], max(last[1], stop))
            continue
        if last is not None:
            yield last
        last = (start, stop)
    if last is not None:
        yield last


# ---- qualifiers of acts ----------------------------------------------------------------------------------
OTHER_THING = "which thing"
"""The kind of qualifier without which an act is not judged: pointing at a door is not pointing at the other person."""


def qualifiers(act: Act, entry: Entry, who: str, mask: str, said: str) -> Iterator[tuple[str, str]]:
    """Qualifiers of an act that no rule of its entry measures: each kind of qualifier, and a rule that does, or "".

    Args:
        act: told, and of this entry.
        entry: of the lexicon.
        who: one of its agents.
        mask: the predicate by which it is seen; "" where it has none.
        said: the act's own words in the sentence.
    """
    names = set(re.findall(r"\w+", " ".join(entry.rule)))
    words = said_words((*entry.frames, *entry.caption))
    goes = next((shape for shape in entry.stage if isinstance(shape, Go)), None)
    if act.times is not None and act.times > 1 and act.distance is None and "n" not in names:
        yield "how often", ""
    if act.side in ("left", "right") and act.side != act.direction and "side" not in names:
        yield "which side", ""
    if (
        act.side == "both"
        and not names & {"side", "hands"}
        and _BOTH.search(said)
        and not _is_two_handed(entry)
    ):
        yield "with both hands", ""
    if act.direction is not None and act.direction not in words and "way" not in names:
        yield "which way", _goes_way(act, who) if goes else ""
    if abs(act.speed - 1.0) > 0.15:
        yield "how fast", _at_speed(act.speed, goes, who) if goes else ""
    if act.distance is not None:
        yield (
            "how far",
            f"happens(goes_metres({who}, {0.65 * act.distance:.2f}, {1.5 * act.distance + 0.3:.2f}))"
            * bool(goes),
        )
    if act.seconds is not None:
        yield "how long", ""
    if FROM_BEHIND in act.manner:
        yield "from where", f"happens(both({mask}, behind({who})))" if mask else ""
    if any(
        adverb not in _FILLERS and adverb != FROM_BEHIND and adverb not in vocabulary().speeds
        for adverb in act.manner
    ):
        yield "in which manner", ""
    if (
        act.part
        and "part" not in names
        and not {act.part, f"{act.part}s", vocabulary().part(act.part)} & words
    ):
        yield "where on the body", ""
    if act.thing and not (entry.thing and kind_of(act.thing)) and not set(act.thing.split()) & words:
        yield OTHER_THING, ""


def plain(act: Act, kinds: frozenset[str]) -> Act:
    """An act without the qualifiers of these kinds."""
    left: dict[str, dict[str, object]] = {
        "how often": {"times": None}, "which side": {"side": None}, "with both hands": {"side": None},
        "which way": {"direction": None}, "how fast": {"manner": ()}, "in which manner": {"manner": ()},
        "from where": {"manner": ()},
    }  # fmt: skip
    return act.model_copy(
        update={name: value for kind in kinds for name, value in left.get(kind, {}).items()}
    )


def _is_two_handed(entry: Entry) -> bool:
    """True for an entry whose own shape has both hands or arms."""
    return any("both" in (getattr(shape, "sides", ""), getattr(shape, "hands", "")) for shape in entry.stage)


def _goes_way(act: Act, who: str) -> str:
    ahead = {"forward": f"happens(goes_ahead({who}, 0.3))", "back": f"happens(backs({who}, 0.2))"}
    if act.direction in ("left", "right"):
        return f"happens(goes_way({who}, '{act.direction}'))"
    return ahead.get(act.direction or "", "")


def _at_speed(factor: float, goes: Go, who: str) -> str:
    """Faster, or nowhere as fast, as half way between the usual speed and the one that the words ask for."""
    between = goes.speed * (1.0 + factor) / 2.0
    if factor > 1.0:
        return f"happens(walks({who}, 0.4, {between:.2f}))"
    return f"never(walks({who}, 0.4, {max(between, 0.6):.2f}))"
