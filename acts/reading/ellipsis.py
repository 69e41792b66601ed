"""Verbs that a text leaves out: "(do) two lunges forward", and how a part of the body is held: "with arms crossed".

Stage directions and training plans name what is done by a noun. The parser finds no clause in them, so each such
stretch between two marks gets the verb that it lacks. Phrases that say how a part of the body is held have no verb
with a tense either, and the parser hangs them on whatever is near: they are found by how they stand.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from acts.frames import PREPOSITIONS

from .people import is_somebody
from .syntax import has, is_adverb
from .vocabulary import closed, vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

    from .spelling import Speller

_ENDS = frozenset(("", ",", ";", ":", ".", "!", "?", "-", "then", "and"))
_JOINS = frozenset((",", "and", "then"))
PERFORM = "perform"
"""The verb of a noun that has none, which the parser takes for nothing else."""
_LONGEST = 5
"""Words of a noun phrase, at most."""


class Ellipsis:
    """Finds the verbs that a text lacks.

    Args:
        lower: gives the words of a text by their number, in small letters; "" beyond its ends.
        speller: knows the forms of verbs and the nouns of what people do.
    """

    def __init__(self, lower: Callable[[int], str], speller: Speller) -> None:
        self._lower, self._is_deed, self._forms = lower, speller.is_deed, speller.forms
        self._words = vocabulary()
        self.last = ""
        """The last verb of the sentence, also one that was supplied."""
        self._behind = 0
        """The number of the word behind it."""

    def before(self, i: int) -> str:
        """The verb to supply before the word ``i``; "" for none. Asked for each word in order."""
        if self._lower(i - 1) in ("", ".", "!", "?", ";"):
            self.last = ""
        verb = self._listed_side(i) or self._deed(i) or self._being(i)
        if verb:
            self.last, self._behind = verb.partition(" ")[0], i
        else:
            self.passed(i)
        return verb

    def passed(self, i: int) -> None:
        """Takes note of a word that may be the sentence's last verb."""
        if self._acts(i):
            self.last, self._behind = self._lower(i), i + 1

    def _being(self, i: int) -> str:
        """The verb of "two kids (are) playing, one falls", which the parser takes for one clause."""
        noun, ends, at = self._lower(i - 1), ("", ".", "!", "?", ";"), i
        if self.last or self._ending(self._lower(i)) != "ing" or not is_somebody(noun):
            return ""
        while (word := self._lower(at)) not in ends and (self._ending(word) != "s" or self._words.named_part(word)):
            at += 1
        first = at - 1
        while self._lower(first - 1) in closed("determiners"):
            first -= 1
        own = word not in ends and is_somebody(self._lower(at - 1)) and self._lower(first - 1) in (",", "and")
        if not own or {"is", "are"} & {self._lower(k) for k in range(i - _LONGEST, i)}:
            return ""
        return "are" if noun.endswith("s") or noun in self._words.both else "is"

    def _deed(self, i: int) -> str:
        """The verb that a noun of a deed lacks: "(do) two hops, then (do) a bow"."""
        count, listed = self._count(i), self._lower(i - 1) in _ENDS
        if self._lower(i - 1) == "and":  # "throws a jab and a hook" has its verb
            listed = self.last.startswith(PERFORM)
        if not count and self._is_headline(i):
            return PERFORM
        if not count or not listed:
            return ""
        at = i + 1
        while at < i + _LONGEST and self._inside(at):
            at += 1
        at += count > 1 and self._ending(self._lower(at)) == "s"
        noun = self._lower(at - 1)
        if at - 1 == i or noun in PREPOSITIONS or noun in self._words.directions or self.has_verb(at):
            return ""
        one = noun if count == 1 else noun.removesuffix("s")
        before = [self._lower(k) for k in range(i + 1, at - 1)]
        plural = any(word.endswith("s") or word in self._words.both for word in before)
        if plural or any(map(self._words.is_person, (*before, one))):
            return ""  # "two boxers throw punches", "two people do jumping jacks"
        if (count > 1) == (one == noun) or not (self._is_deed(one) or self._is_deed(one.removesuffix("e"))):
            return ""
        return self._form("take" if one in ("step", "pace") else PERFORM)

    def _is_headline(self, i: int) -> bool:
        """True for a sentence that is only a noun of several deeds: "push-ups", "synchronized jumping jacks"."""
        outside = PREPOSITIONS | _ENDS | closed("owners") | closed("clause begins")
        outside |= closed("one of many") | closed("others")
        at = i
        while at < i + _LONGEST and self._lower(at) not in outside:
            at += 1
        if at == i or self._lower(i - 1) not in ("", ".", "!", "?") or self._lower(at) not in ("", ".", "!", "?"):
            return False
        *before, noun = [self._lower(k) for k in range(i, at)]
        one = noun.removesuffix("s")
        people = any(word.endswith("s") for word in before) or any(map(is_somebody, (*before, one)))
        alone = noun in self._forms and not before  # "jumps" is a verb
        alone = alone or any(self._ending(word) in ("", "s") for word in before)  # "do jumps"
        return noun != one and not people and not alone and self._is_deed(one)

    def _count(self, i: int) -> int:
        """The number that a word is, 1 for an article; 0 for other words."""
        word = self._lower(i)
        if word.isdecimal() and len(word) < 4:
            return int(word)
        word = self._lower(i + 1) if self._lower(i + 1) in ("few", "couple") else word  # "a few steps"
        return 1 if word in closed("one of many") else self._words.numbers.get(word, 0)

    def _ending(self, word: str) -> str | None:
        """The ending of a verb's form, as "s" of "waves"; None for other words."""
        return self._forms[word][1] if word in self._forms else None

    def _form(self, verb: str) -> str:
        """A verb in the form of the sentence's last one."""
        ending = "s" if self.last == "is" else self._ending(self.last)
        if ending == "ing":
            return verb.removesuffix("e") + ending
        return verb + "s" if ending == "s" else verb

    def _inside(self, i: int) -> bool:
        """True for a word that may stand within a noun phrase."""
        word = self._lower(i)
        outside = word in PREPOSITIONS | _ENDS | closed("owners") | closed("clause begins") | closed("one of many")
        outside = outside or word in self._words.directions or self._ending(word) == "s"
        return word.isalpha() and (not outside or word in ("left", "right", "high", "low", "back"))

    def _acts(self, i: int) -> bool:
        """True for a word that is a verb where it stands."""
        word, before = self._lower(i), self._lower(i - 1)
        ending = self._ending(word)
        if ending is None or self._words.named_part(word) or self._forms[word][0] in self._words.verbs["seems"]:
            return False
        if before in closed("owners") | closed("one of many") | PREPOSITIONS or before in self._words.numbers:
            return False
        if ending in ("s", "ed", "ing"):
            return True
        return before in _ENDS | closed("clause begins")

    def has_verb(self, i: int) -> bool:
        """True if a verb, or another clause, stands between a word and the next mark."""
        at = i
        while self._lower(at).isalnum() or "'" in self._lower(at):
            if self._lower(at) in ("and", "then") and at > i:
                return False
            if self._lower(at) in ("is", "are", "was", "were", "he", "she", "they") or self._acts(at):
                return True
            at += 1
        return False

    def _listed_side(self, i: int) -> str:
        """The verb done again to another side: "throws left, (throws) right", "with the right leg, then the left"."""
        if not self.last or self._lower(i - 1) not in _JOINS:
            return ""
        at = i - 1
        while self._lower(at) in _JOINS or self._lower(at) == "first":
            at -= 1
        noun = self._lower(at) not in closed("to sides")
        first = at - noun
        if self._lower(first) not in closed("to sides") or (noun and not self._is_sided(at)):
            return ""
        own = self._lower(i) in closed("before sides")
        side = i + own + (self._lower(i + own) in closed("owners"))
        last = side + (self._lower(side) in closed("to sides"))
        more = noun and self._is_sided(last)
        behind = self._lower(last + more)
        ends = behind in _ENDS | closed("clause begins") | {"again", "side"} or is_adverb(behind)
        if last == side or not ends:
            return ""
        end = first - 1 - (self._lower(first - 1) in closed("owners"))
        before = self._lower(end)
        object_ = range(self._behind, end + (before not in closed("before sides")))
        said = [self.last]
        if 0 < len(object_) < 4 and self._is_sided(object_[-1]):  # "turns the head left, then (turns the head) right"
            said += map(self._lower, object_)
        if before in closed("before sides") and not own and (more or self._lower(i) in closed("owners")):
            said.append(before)
        return " ".join(said)

    def _is_sided(self, i: int) -> bool:
        """True for a part of the body of which there are two, or a side."""
        word = self._lower(i)
        return bool(self._words.named_part(word)) or word in ("side", "direction")


# ---- parts of the body ---------------------------------------------------------------------------------
_WITHIN = frozenset(("DET", "PRON", "NUM", "ADJ"))
_PARTICIPLES = {"outstretched": "extend", "outspread": "spread", "upraised": "raise", "uplifted": "raise"}
"""Participles that are no verbs, and the verb of what they show."""
_BEFORE = frozenset((",", ";", ":", "-", "", "and"))
_BEFORE_PART = 4
"""Words before the part of the body, at most."""


@dataclass(frozen=True)
class Absolute:
    """One such phrase.

    Attributes:
        preposition: the word "with".
        part: the noun.
        verb: the lemma of what is done with the part, "" for the lemma of ``state``.
        state: the participle, adverb or preposition that says how it is held.
    """

    preposition: Token
    part: Token
    verb: str
    state: Token

    def placed(self) -> Iterator[Token]:
        """The preposition right behind it of where the part is, if the parser hung it on another word.

        As in "walks with the arms out to the sides".
        """
        last = max(self.part, self.state, key=lambda token: token.i)
        after = last.doc[last.i + 1] if last.i + 1 < len(last.doc) else last
        parts = (c for c in after.children if c.dep_ == "pobj" and vocabulary().part(c.lemma_.lower()))
        if after.dep_ == "prep" and after.head != self.state and any(parts):
            yield after


def absolutes(doc: Doc) -> Iterator[Absolute]:
    """The phrases of a text, in its order."""
    for token in doc:
        if token.lower_ == "with" and (behind := _behind(token)) is not None:
            yield behind


def _behind(preposition: Token) -> Absolute | None:
    words, doc = vocabulary(), preposition.doc
    at = preposition.i + 1
    before: Token | None = None
    while at < len(doc) and not words.part(doc[at].lemma_.lower()):
        if at - preposition.i >= _BEFORE_PART or not (
            doc[at].pos_ in _WITHIN or doc[at].tag_ == "VBN" or doc[at].lower_ == "both"
        ):
            return None
        held = doc[at].tag_ == "VBN" and doc[at].lower_ not in words.directions
        before = doc[at] if held or doc[at].lower_ in _PARTICIPLES else before
        at += 1
    if at == len(doc):
        return None
    part = doc[at]
    straight = at + 1 < len(doc) and doc[at + 1].lower_ in closed("held so")
    if words.part(part.lemma_.lower()) == "back" and not straight:  # "with her back to him" is a way to stand
        return None
    if before is not None:
        return Absolute(preposition, part, _PARTICIPLES.get(before.lower_, ""), before)
    after = doc[at + 1] if at + 1 < len(doc) else None
    if after is None:
        return None
    if after.lower_ in _PARTICIPLES:
        return Absolute(preposition, part, _PARTICIPLES[after.lower_], after)
    if after.lower_ in closed("held so"):
        return Absolute(preposition, part, "hold", after)
    if after.tag_ in ("VBN", "VBD", "VBG"):
        return Absolute(preposition, part, "", after)
    direction = words.directions.get(after.lower_)
    ends = at + 2 == len(doc) or doc[at + 2].pos_ in ("PUNCT", "CCONJ", "SCONJ", "ADV", "ADP")
    if direction and ends:
        verb = {"up": "raise", "down": "lower"}.get(direction, "extend")
        return Absolute(preposition, part, verb, after)
    if after.lower_ == "in" and any(t.lower_ == "air" for t in doc[at + 2 : at + 4]):
        return Absolute(preposition, part, "raise", after)
    alone = after.lower_ == "behind" or _acts_alone(preposition)
    laid = after.lower_ != "to" or any(t.lemma_ == "side" for t in doc[at + 2 : at + 4])
    if after.lower_ in PREPOSITIONS - {"of"} and laid and alone and not ends:
        return Absolute(preposition, part, "put", after)
    return None


def _acts_alone(preposition: Token) -> bool:
    """True if the verb has no object: what touches somebody "with a hand on the back" touches the back."""
    verb = next((t for t in preposition.ancestors if t.pos_ in ("VERB", "AUX")), None)
    return verb is None or not has(verb, "dobj", "nsubjpass")


def stands_absolutely(lower: Callable[[int], str], has_verb: Callable[[int], bool], i: int) -> bool:
    """True if the words from ``i`` on are such a phrase without its "with": "…, hands up, …", "…, her head down".

    Args:
        lower: gives the words of a text by their number, in small letters; "" beyond its ends.
        has_verb: tells whether a verb stands between a word and the next mark.
        i: the first word.
    """
    words = vocabulary()
    if lower(i - 1) not in _BEFORE:  # "cuffs the thief hands behind his back"
        behind = lower(i + 3) if lower(i + 2) in closed("before parts") else lower(i + 2)
        own = lower(i + 1) in closed("laid") and words.part(lower(i).removesuffix("s")) and words.part(behind)
        return bool(own) and words.is_person(lower(i - 1)) and lower(i).endswith("s")
    at = i
    while lower(at) in closed("before parts") and at < i + 3:
        at += 1
    if not words.named_part(lower(at)) or (lower(i - 1) in ("", "and") and at > i and lower(i) == "the"):
        return False
    after, behind = lower(at + 1), lower(at + 2)
    if lower(i - 1) == "and" and at == i:
        return False
    held = after in _PARTICIPLES or after in words.verbs["held"]
    ends = not behind.isalpha() or behind in ("and", "while", "as", "then")
    placed = after in PREPOSITIONS - {"of", "to", "with"} and behind.isalpha() and after not in words.directions
    if placed and at == i and lower(i).endswith("s"):  # "hands over a parcel" is an act
        placed = any(words.part(lower(k).removesuffix("s")) for k in range(at + 2, at + 5))
    return (
        held
        or ((after in words.directions or after in closed("held so")) and ends)
        or (placed and not has_verb(at + 1))
    )
