"""The words of a sentence that a verdict leaves out.

A word is said by an act that its clause names: as one of its captions' words or a verb of like meaning, as the act's
thing, part of the body or manner, or as its number, side, direction, speed, length or distance. One that only led to
the act, as a word of its frames, is read and not said: an act whose captions say none of its clause's verbs is another
act than the words name. Words of grammar and of the two people count for nothing.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Set
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from motion import InputError

from .captions import VERB, caption_of, gerund, past, singular, usual_limb, with_thing
from .lexicon import Entry, Lexicon, kind_of, lexicon
from .plan import GAITS, ON_TIPTOE, Act, Plan, merged
from .reading import wordnet
from .reading.parses import Parse, parses
from .reading.people import A_NAME, ANYONE, B_NAME
from .reading.spelling import Speller
from .reading.syntax import has, is_likeness, seems
from .reading.vocabulary import FORMATION, closed, is_act, vocabulary
from .shapes import Gesture, Go, Strike, Touch

if TYPE_CHECKING:
    from spacy.tokens import Token


MOST_WORDS = 12
"""Stretches of words that are reported of one sentence, at most."""
_CONTENT = frozenset(("NOUN", "PROPN", "VERB", "ADJ", "ADV", "NUM"))
_KINDS = ("begins", "ends", "light", "causes", "tried", "pretended", "wished", "offered", "not")
"""Verbs about other verbs, which the acts' modality, polarity and order stand for."""
_SLOWEST_WALK = 0.7
"""The factor of speed from which a verb says how fast somebody walks; slower ones are gaits of their own."""
_PHRASAL = re.compile(r"\[([a-z-]+)\] (?:\{b\} )?([a-z]+)")
_HANDLED = re.compile(r"\[([a-z-]+)\] (?:out |up )?(?:both|their|the|a|an) ([a-z]+)")
"""A verb of captions with its object."""
_EACH_OTHER = re.compile(r"\b(?:each other|one another)\b", re.IGNORECASE)
_WORD, _SLOTS = re.compile(r"[a-z]+"), re.compile(r"\{(?![\w.]+:)[^{}]*\}")


# ---- words that no verdict says --------------------------------------------------------------------------
class Account(NamedTuple):
    """The words that the acts of a plan leave out of its sentence, as it was written.

    Attributes:
        unread: the stretches that are in no act, in the sentence's order.
        unsaid: those that an act was read from and that its captions do not say, by the act's id.
        others: the words of the acts whose captions say none of their verbs, by the act's id.
        towards: the ids of the acts whose clauses name the person to whom they are done.
    """

    unread: tuple[str, ...] = ()
    unsaid: Mapping[str, tuple[str, ...]] = {}
    others: Mapping[str, str] = {}
    towards: Set[str] = frozenset()


def account(plan: Plan) -> Account:
    """All that the acts of a plan leave out of its sentence.

    Args:
        plan: with the sentence that it was read from; one that was written by hand has none.
    """
    return _account(plan, lexicon()) if plan.sentence.strip() else Account()


@lru_cache(maxsize=256)
def _account(plan: Plan, known: Lexicon) -> Account:
    left = [(each.words.start, each.words.stop) for each in plan.unread]
    whole = tuple(left)
    unsaid: dict[str, list[tuple[int, int]]] = {}
    others: dict[str, str] = {}
    taken: list[tuple[int, int]] = []
    towards: set[str] = set()
    if not any(start == 0 and stop >= len(plan.sentence.rstrip()) for start, stop in whole):
        speller = Speller(known)
        try:
            parsed = next(parses(plan.sentence, speller))
        except InputError:  # no parser is installed, where a kept plan is shown
            return Account(_quoted(left, plan.sentence))
        names = {word.lower() for person in plan.people for word in person.words}
        spans = {t.i: parsed.text.span(t.idx, t.idx + len(t)) for t in parsed.doc}
        for act in plan.acts:
            entry, own = known.entries.get(act.act), act.words
            if entry is not None and entry.caption and own is not None:
                within = [t for t in parsed.doc if own.start <= spans[t.i][0] and spans[t.i][1] <= own.stop]
                towards |= {act.id} if any(_is_other(t, names) for t in within) else set()
                if within and not _is_named(within, act, entry, plan, parsed):
                    verb = next((t for t in within if t.pos_ == "VERB"), within[0])
                    taken.append((spans[verb.i][0], own.stop))
                    others[act.id] = plan.sentence[spans[verb.i][0] : own.stop].strip(" ,;.")
        left = [(i, j) for i, j in left if not any(start <= i and j <= stop for start, stop in taken)]
        left += [each for each in parsed.text.left_out() if not any(i < each[1] and each[0] < j for i, j in whole)]
        for token in parsed.doc:
            start, stop = spans[token.i]
            told = any(first <= start and stop <= last for first, last in (*whole, *taken))
            if told or not _counts(token, parsed, names):
                continue
            by = _read_by(token, start, stop, plan, known, parsed)
            if by is None and token.dep_ in ("xcomp", "ccomp"):  # "keeps walking", "helps her sit"
                by = _read_by(token, *spans[token.head.i], plan, known, parsed)
            if by is None:
                left.append(parsed.text.span(*_phrase(token)))
            elif by:
                unsaid.setdefault(by, []).append(parsed.text.span(*_phrase(token)))
    left = [(i, j) for i, j in left if plan.sentence[i:j].strip().upper() not in ("A", "B")]
    named = {
        of: _quoted([(i, j) for i, j in each if not any(x <= i and j <= y for x, y in left)], plan.sentence)
        for of, each in unsaid.items()
    }
    return Account(_quoted(left, plan.sentence), named, others, frozenset(towards))


def _quoted(spans: list[tuple[int, int]], text: str) -> tuple[str, ...]:
    return tuple(text[i:j] for i, j in merged(spans, text))[:MOST_WORDS]


def _is_named(within: list[Token], act: Act, entry: Entry, plan: Plan, parsed: Parse) -> bool:
    """True for an act whose captions say what the words of its clause do: a verb, or several of the other words."""
    words, captions = vocabulary(), said_words(entry.caption)
    caption, verbs = shown_caption(act, entry, plan.text(act.words)), _verbs(entry.caption)
    if _is_other_thing(act, entry, caption):
        return False  # "points at the floor" is not "points at B"
    parts = {words.part(_lemma(t, parsed)) for t in within} - {""}
    shown = {words.part(word) for word in said_words((caption.replace("side by side", ""),))} - {""}
    if parts and shown and not parts & shown and "{part}" not in caption and not act.part_of:
        return False  # "lays her head on B's lap" is not "on B's shoulder"
    spots = {word for t in within if words.part(word := _lemma(t, parsed)) not in closed("limbs") | {""}}
    near = {word for word in said_words((caption,)) if words.part(word) in {words.part(each) for each in spots}}
    if near and near.isdisjoint(spots) and "{part}" not in caption:
        return False  # "rubs his nose" is not "rubs his face"
    handled = any(verb in closed("handles") and words.named_part(noun) for verb, noun in _HANDLED.findall(caption))
    several = VERB.findall(caption)
    said_verbs = [_lemma(t, parsed) for t in within if t.pos_ in ("VERB", "NOUN")]
    if handled and not parts and not act.part:
        return False  # "supports her" is not "puts both hands on B's shoulders"
    if len(several) > 1 and not all(
        verb in said_verbs or any(_alike(own, (verb,), ()) for own in said_verbs) for verb in several
    ):
        return False  # "spins" is not "holds hands and spins"
    shared = set()
    for token in within:
        lemma = _lemma(token, parsed)
        if {lemma, token.lower_} & captions and not (token.is_stop and token.pos_ not in ("ADP", "ADV")):
            shared.add(lemma)
        if token.pos_ not in ("VERB", "NOUN") or (token.pos_ == "NOUN" and words.part(lemma)):
            continue
        if lemma in captions and lemma not in words.light and lemma not in closed("states"):
            return True
        if _alike(lemma, verbs, ()):
            return True
        if lemma in words.gaits and not (words.verbs["goes"] | words.gaits.keys()).isdisjoint(verbs):
            return True  # and not "runs into B", who is bumped into
    own = [t for t in within if t.pos_ == "VERB" and _counts(t, parsed) and not _is_empty(t, parsed)]
    empty = not any(_counts(t, parsed) for t in within)  # "starts to fight"
    return len(shared) >= 2 or (not own and (bool(shared) or empty))


def shown_caption(act: Act, entry: Entry, said: str = "") -> str:
    """The caption in whose words the verdict on an act is given.

    It is one with the act's direction, or its own verb, where one has, to the other where the act is, and of those
    the one that adds least to the words that are ``said``.
    """
    own, spoken, usual = act.act.split("-")[0], frozenset(_WORD.findall(said.lower())), caption_of(act, entry)
    both = len(act.agents) == 2 and "{b}" in usual
    usual = next((text for text in entry.caption if act.thing and "{thing}" in text), usual)
    usual = next((text for text in entry.caption if both and "{thing}" not in usual and "{a+b}" in text), usual)
    named = act.patient is not None or bool(_EACH_OTHER.search(said))
    slots = (_slots(usual), _slots(usual) | {"{b}"} if named else _slots(usual) - {"{b}"})
    alike = [text for text in entry.caption if f"[{own}]" in text or _says(text, spoken)]
    things = act.thing and kind_of(act.thing)
    alike = [text for text in alike if _slots(text) in slots and (things or "something" not in text.split())]

    def unlike(text: str) -> tuple[bool | int, ...]:
        words = said_words((text,)) - closed("plain")
        limbs = {vocabulary().named_part(word) for word in words} & closed("limbs")
        alone = named == ("{b}" not in text)
        other_part = (act.part or "") not in text or (not act.part and bool(limbs))
        more = {
            word for word in words - spoken if said and not (act.thing and kind_of(word))
        }  # which the thing replaces
        return other_part, alone, not _says(text, spoken), len(more), text != usual

    alike.sort(key=unlike)
    return next((text for text in alike if act.direction in text.split()), next(iter(alike), usual))


def _says(caption: str, spoken: Set[str]) -> bool:
    """True for a caption one of whose verbs is said, and says more than that something is done."""
    own = (verb for verb in VERB.findall(caption) if verb not in vocabulary().light and verb not in closed("states"))
    return any(not spoken.isdisjoint((verb, singular(verb), gerund(verb), past(verb))) for verb in own)


def _is_other_thing(act: Act, entry: Entry, caption: str) -> bool:
    words = said_words((caption,))
    other = act.thing and "{b}" in caption and not entry.thing and not set(act.thing.split()) & words
    return bool(other) and act.thing not in closed("fillers") and not is_act(act.thing or "")


def _slots(caption: str) -> set[str]:
    return set(_SLOTS.findall(caption.replace("{a+b}", "{a}")))


def _counts(token: Token, parsed: Parse, names: Set[str] = frozenset()) -> bool:
    """True for a word that says something of what is done, and is none of the people's names."""
    lemma, words = _lemma(token, parsed), vocabulary()
    returns = token.lower_ == "back" and token.dep_ in ("conj", "pobj")  # "to the wall and back", "to the back"
    if _is_place(token) or _is_target(token) or token.lower_ == "half" or returns or _joined(token, parsed):
        return True
    about = token.lower_ in closed("about") and not token.n_rights
    if (
        (token.pos_ not in _CONTENT and not about)
        or not token.text[0].isalnum()
        or (len(token.text) < 2 and not token.text.isdigit())
    ):
        return False
    if token.text in (A_NAME, B_NAME) or lemma == "let":
        return False
    if token.pos_ != "VERB" and {lemma, token.lower_} & (closed("fillers") | closed("scenery")):
        return False
    about = has(token, "xcomp", "ccomp", "advcl") or any(c.dep_ == "dobj" and is_act(c.lemma_) for c in token.children)
    about = about and any(lemma in words.verbs[kind] for kind in _KINDS)
    if token.pos_ in ("VERB", "AUX") and (about or lemma in closed("states") or seems(token)):
        return False
    if token.dep_ in ("aux", "auxpass", "neg", "mark") or (token.dep_ == "advmod" and token.head.pos_ == "NUM"):
        return False  # "about three metres": what is measured is only about so much
    named = {words.directions.get(child.lower_) for child in token.children}
    if lemma == "side" and not closed("turns").isdisjoint(named):  # "to the left side"
        return False
    if token.lower_ in words.both:  # "two people", but not "two fingers"
        head = token.head
        return token.dep_ == "nummod" and head.lower_ not in words.both and not words.is_person(_lemma(head, parsed))
    if token.pos_ in ("NOUN", "PROPN") and (words.is_person(lemma) or words.is_person(token.lower_)):
        said = {lemma, token.lower_} & (names | ANYONE) or words.is_person(_lemma(token.head, parsed))
        owned = any(c.tag_ == "PRP$" for c in token.children)  # "with their guards up"
        said = said or (token.tag_ == "NNS" and not owned) or any(c.lower_ in closed("of two") for c in token.children)
        return is_likeness(token) or not said  # "acts like a king", "keeps his guard up"
    if token.pos_ == "PROPN" and not token.text.islower():
        return names.isdisjoint((lemma, token.lower_, token.head.lower_))
    if token.pos_ in ("NUM", "ADJ") and words.is_person(_lemma(token.head, parsed)):
        return not (token.pos_ == "NUM" or words.age(lemma))
    return token.dep_ != "compound" or not words.is_person(_lemma(token.head, parsed))  # "the yoga teacher"


def _read_by(token: Token, start: int, stop: int, plan: Plan, known: Lexicon, parsed: Parse) -> str | None:
    """The id of the act that a word was read for and that does not say it; "" where one says it, None for no act."""
    around = [act.words for act in plan.acts if act.words and act.words.start <= start and stop <= act.words.stop]
    reader = None
    for act in plan.acts:
        entry, own = known.entries.get(act.act), act.words
        near = own is None or any(own.start < span.stop and span.start < own.stop for span in around)
        if entry is not None and near:
            found_by = _is_read(token, act, entry, parsed)
            if _is_said(token, act, entry, plan, parsed) or (found_by and token.dep_ == "prt"):
                return ""
            reader = act.id if found_by and reader is None else reader
    return reader


def _is_said(token: Token, act: Act, entry: Entry, plan: Plan, parsed: Parse) -> bool:
    """True for a word that the verdict on an act says, or that one of its fields stands for."""
    words, lemma, text = vocabulary(), _lemma(token, parsed), token.lower_
    caption = shown_caption(act, entry, plan.text(act.words))
    forms = {lemma, text, words.likeness.get(lemma, ""), *_WORD.findall(text)}
    way = words.directions.get(text) if token.pos_ != "VERB" else None  # and not "left the room"
    if way in closed("turns"):
        return way in (act.direction, act.side, act.part_side)
    if lemma in (act.act.split("-")[0], act.act.replace("-", "")):
        return True
    owned = any(c.dep_ == "poss" for c in token.children) and (not words.part(lemma) or act.part_of == act.patient)
    if owned and act.patient and entry.to != "other" and "{b}" not in caption:
        return False  # "buttons his coat" is not "buttons a coat"
    if joined := _joined(token, parsed):
        return joined in said_words(entry.caption)
    if text == "own":
        return act.patient is None or act.part_of in act.agents
    if _is_target(token) and any(slot in caption for slot in ("{b}", "{a+b}")):
        goes_by = "past {b}" in caption  # "staggers towards him" is not "past him"
        return not goes_by and not any(c.lower_.endswith(("self", "selves")) for c in token.children)
    loose = token.pos_ in ("ADV", "ADP") and not _is_target(token)  # "dances around" is more than "dances"
    said = said_words((caption,) if loose else entry.caption) | set(" ".join(act.manner).split())
    near = (closed(name) for name in ("next to", "past") if text in closed(name))
    around = text in closed("about") and not closed("about").isdisjoint(said)
    if forms & said or around or any(said_words(entry.caption) & each for each in near):
        return True
    if _is_empty(token, parsed) and _is_read(token, act, entry, parsed):
        return True
    verbs = _verbs(entry.caption)
    puts = token.pos_ == "VERB" and lemma in closed("puts") and not closed("puts").isdisjoint(verbs)
    if puts or (token.pos_ in ("VERB", "NOUN") and _alike(lemma, verbs, ())):
        return True
    if act.thing and forms & set(act.thing.split()):  # "plays the violin" is not "plays the guitar"
        shown = with_thing(act, caption)[1]
        others = any(kind_of(word) for word in said_words((shown,)) - forms)
        return "{thing}" in shown or bool(entry.thing and kind_of(act.thing) and not others)
    if (family := words.part(lemma)) and not (lemma in words.metres and act.distance is not None):
        sided = act.side is not None and family in closed("limbs") and any(c.lower_ == act.side for c in token.children)
        handles = token.head.lower_ == "with" and any(isinstance(s, Touch | Gesture | Strike) for s in entry.stage)
        by_hand = handles and lemma == usual_limb(caption)  # "covers his eyes with his hands"
        on_fours = lemma in ("hand", "knee") and "crawls" in act.manner
        return sided or by_hand or on_fours or (act.part is not None and family == words.part(act.part))
    hurries = act.speed != 1.0 or any(isinstance(shape, Go) and shape.speed > 2.0 for shape in entry.stage)
    paced = hurries and words.gaits.get(lemma, 0.0) > _SLOWEST_WALK
    if (
        paced
        or (text in words.speeds and act.speed != 1.0)
        or any(lemma in closed(gait) and gait in act.manner for gait in (ON_TIPTOE, *GAITS))
    ):
        return True
    if (way is not None and way == act.direction) or (text == "both" and act.side == "both"):
        return True
    if text in words.numbers or token.like_num:
        of = _lemma(token.head, parsed)
        measured = (act.seconds is not None and of in words.seconds) or (act.distance and of in words.metres)
        return bool(measured) or text == str(act.times) or (text in words.numbers and words.numbers[text] == act.times)
    far = act.distance is not None and (lemma in words.metres or text in closed("how far"))
    return far or (lemma in words.seconds and act.seconds is not None)


def _is_read(token: Token, act: Act, entry: Entry, parsed: Parse) -> bool:
    """True for a word by which an act was found."""
    lemma = _lemma(token, parsed)
    if token.pos_ != "VERB" and vocabulary().directions.get(token.lower_) in closed("turns"):
        return False
    return bool({lemma, token.lower_, *_WORD.findall(token.lower_)} & said_words(entry.frames)) or (
        token.pos_ in ("VERB", "NOUN")
        and _alike(lemma, tuple(v for f in entry.frames for v in f.split()[1].split("|")), entry.synsets)
    )


@lru_cache(maxsize=1024)
def said_words(texts: tuple[str, ...]) -> frozenset[str]:
    """The words of frames and captions, without the slots of captions."""
    plain = " ".join(_SLOTS.sub("", text.lower()) for text in texts)
    return frozenset((*_WORD.findall(plain), *_WORD.findall(plain.replace("-", ""))))  # "push-up" and "pushup"


@lru_cache(maxsize=1024)
def _verbs(captions: tuple[str, ...]) -> tuple[str, ...]:
    """The verbs of captions, and with what stands behind them where that makes another: "pick_up"."""
    verbs = [verb for text in captions for verb in VERB.findall(text)]
    pairs = (f"{verb}_{word}" for text in captions for verb, word in _PHRASAL.findall(text))
    return tuple(dict.fromkeys([*verbs, *filter(wordnet.senses, pairs)]))


@lru_cache(maxsize=4096)
def _alike(lemma: str, verbs: tuple[str, ...], synsets: tuple[str, ...]) -> bool:
    """True for a verb, or the noun of one, that means what one of these does."""
    theirs = {wordnet.synset(name) for name in synsets}
    for verb in verbs:
        theirs |= set(wordnet.senses(verb)[:2])
    return bool(set(wordnet.senses(lemma)[:2]) & theirs)


def _lemma(token: Token, parsed: Parse) -> str:
    return str(parsed.lemmas.get(token.i, token.lemma_.lower()))


def _is_empty(token: Token, parsed: Parse) -> bool:
    """True for a verb that means what its object names: "takes a bow", but not "takes off"."""
    return token.pos_ == "VERB" and _lemma(token, parsed) in vocabulary().light and not has(token, "prt")


def _joined(token: Token, parsed: Parse) -> str:
    """The part of the body of "arm in arm", which the parser gets as one word; "" for others."""
    written = _WORD.findall(parsed.text.original[slice(*parsed.text.span(token.idx, token.idx + len(token)))].lower())
    return written[0] if token.lower_ == FORMATION and written[0] in closed("joined") else ""


def _is_place(token: Token) -> bool:
    return token.lower_ in closed("where") and any(
        c.dep_ == "pobj" or (c.dep_ == "prep" and c.lower_ != "with") for c in token.children
    )


def _is_target(token: Token) -> bool:
    """True for a preposition before the person to whom something is done: "on each other"."""
    objects = [c for c in token.children if c.dep_ == "pobj"]
    turns = (c for c in objects if vocabulary().directions.get(c.lower_) in closed("of the clock"))
    objects += [c for turn in turns for c in turn.children]  # "around her clockwise"
    return token.lower_ in closed("targets") and any(map(_is_somebody, objects))


def _is_somebody(token: Token) -> bool:
    named = token.text in (A_NAME, B_NAME) or token.lower_ == "other" or vocabulary().is_person(token.lemma_.lower())
    return named or (token.pos_ == "PRON" and token.lower_ not in ("it", "something"))


def _is_other(token: Token, names: Set[str]) -> bool:
    """True for the other person, to whom something is done."""
    itself = token.lower_.endswith(("self", "selves"))
    named = _is_somebody(token) or token.lower_ in names
    return token.dep_ in ("pobj", "dobj", "dative") and named and not itself


def _phrase(token: Token) -> tuple[int, int]:
    """A word with what belongs to it on its left, and its preposition: "against the wall"."""
    first = token
    if _is_place(token) or _is_target(token):
        if token.dep_ == "pobj" and token.head.i == token.i - 1:
            first = token.head  # "in front of him"
        last = max(token.subtree, key=lambda each: each.i) if token.n_rights else token
        return first.idx, last.idx + len(last)
    if token.pos_ in ("NOUN", "PROPN") and token.lower_ not in vocabulary().directions:
        own = [c for c in token.lefts if c.dep_ in ("det", "amod", "compound", "poss", "nummod")]
        first = min((token, *own), key=lambda each: each.i)
        if token.dep_ == "pobj" and 0 < first.i - token.head.i <= 1:
            first = token.head
    return first.idx, token.idx + len(token)
