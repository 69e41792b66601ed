"""Sentences about two people, taken apart into clauses: who does something, and what.

Plain pattern matching on word lists; a sentence that it cannot follow gives clauses without verbs of interest,
and nothing is planned from it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache

from webdemo.inference.requests import MAX_PROMPT

from .beats import is_known_act
from .names import KIND, NAMED, named
from .wording import in_plain_words, in_present, past_forms

LONGEST_READ = 2 * MAX_PROMPT
"""Characters of a sentence that are read: twice the longest prompt, as names and phrases are spelt out."""
_SEX = {
    "m": re.compile(
        r"man|boy|father|son|brother|husband|uncle|king|gentleman|guy|lad|waiter|policeman|grandfather|grandpa|dad|"
        r"prince|actor|he|him|his|himself"
    ),
    "f": re.compile(
        r"woman|girl|mother|daughter|sister|wife|aunt|queen|lady|waitress|policewoman|grandmother|grandma|mum|mom|"
        r"princess|actress|she|her|herself"
    ),
}
_PEOPLE = r"(?:\w{3,}s|men|women|people|children)(?=,? \w+)"
OTHER = rf"(?:person [ab]|him|her|them|(?:the|an?) other(?: person| one)?|(?:the|an?|his|her|another) (?:\w+ )??{KIND})"
"""The other person, as the object of a verb."""
_PLURAL = (
    rf"they|we|both(?: of them| people|(?: \w+)? {_PEOPLE})?|the (?:two|pair|couple)(?: of them| (?:\w+ )?{_PEOPLE})?"
    rf"|(?:the )?(?:(?!two|first|second|other)\w+ )?(?:{KIND}s|children|women|men)(?= (?!\w+s\b)\w+)"
    rf"|two (?:\w+ )??{_PEOPLE}|an? (?:\w+ )?couple|couple(?= \w+ing)|a pair|people|everybody|everyone"
    r"|each(?: of them)?"
)
_HOW = r"(?:old|young|little|small|tall|big|angry|happy|sad|tired|drunk|elderly|nervous|shy|proud)"
_FIRST = rf"(?:the )?(?:first|former)(?: {KIND}| one)?|the actor|one of (?:them|the two)"
_SECOND = (
    rf"(?:the )?(?:second|latter)(?: {KIND}| one)?|the (?:reactor|other)(?: {KIND}| one)?|other (?:{KIND}|one)"
    rf"|another(?: {KIND})?|someone else|somebody else|the partner"
)
_DOES = (
    rf"(?:(?:is|are|was|were|does|do|has|have|can|will|must|would|could|should|may|might|never|won't|\w+n't|doesnt|dont|"
    rf"{'|'.join(past_forms())})\b|(?!his\b|hers\b|as\b|this\b|towards\b|always\b|perhaps\b)\w+(?:s|ing|ed)\b)"
)
"""A verb, as far as its form shows."""
_MANNER = r"(?:(?:then|now|soon|also|just|only|still|\w+ly),? )*+"
"""Adverbs before a verb. No word may match in two ways: n words would then match in 2ⁿ."""
_WHERE = r"(?: (?:on|in|at|by|near|with|from|behind|beside) (?:the|an?|his|her|their) (?:\w+ )??\w+)?"
_NOUN = (
    rf"one {KIND}|one|(?:{_HOW} )?{KIND}|(?!\w+(?:s|ing|ly)\b|and\b|then\b|an?\b|the\b)\w+ {KIND}(?= \w+s\b)"
    rf"|(?:an?|the|his|her|their|some) (?:\w+ ){{0,3}}?\w+(?={_WHERE} {_MANNER}{_DOES})"
    r"|someone|somebody|he|she|it|i|you"
)
_LEADING = re.compile(
    rf"^((?:without|after|following|hearing|holding|having|with|on|at|in|from|upon)\b[^,]*?),? "
    rf"(?=(?:they|both of them|{NAMED}|he|she|one|the (?:first|second|other)) \w+)"
)
_OBJECT = re.compile(
    rf"\b(?:{NAMED}|the (?:first|second|other)(?: person| one)?|(?:the|an?) (?:\w+ )?\w+|him|her)$"
)
_ADVERB = r"(?:(?:first|then|afterwards|next|now|later|meanwhile|halfway|soon|there|also|just|\w+ly),? )*"
"""Adverbs before a subject; as with `_MANNER`, each word matches in one way."""
_ADVERBS = re.compile(rf"^{_ADVERB}")
_SUBJECT = re.compile(
    rf"^{_ADVERB}(?:(?P<many>{_PLURAL})|(?P<named>{NAMED})|(?P<first>{_FIRST})|(?P<second>{_SECOND})"
    rf"|(?P<noun>{_NOUN}))(?=\s|$)\s*"
)
_VERB = re.compile(rf"^(?:{_WHERE[4:-2]} )?{_MANNER}(?:keeps?|starts?|begins?|{_DOES})")
_SOMEBODY = re.compile(rf"(?:an? |the |his |her )?(?:{_HOW} )?{KIND}|i|you")
"""Subjects that need no -s on their verb: "man give flower"."""
_PAIRED = re.compile(
    rf"(?:^|(?<=[,;.] )|(?<=then )|(?<=while )|(?<=as ))"
    rf"(?:{NAMED}|(?:an?|the|his|her) (?:\w+ )??\w+|he|she|someone) and "
    rf"(?:{NAMED}|(?:an?|his|her|the(?! other)) (?:\w+ )??\w+|another \w+|he|she|someone else)(?= (?!\w+s\b)\w+)"
)
_GOING_ON = re.compile(r"^(?!(?:during|anything|something|nothing)\b)\w*[aeiouy]\w*ing\b")
_RELATIVE = re.compile(r"\bwho\b")
_JOIN = re.compile(
    r"(?P<mark>\s*[.;:!?]\s+|\s+[-–—]\s+|,?\s+(?:and|but|yet|so)\s+(?:then\s+)?|,?\s+(?:then|afterwards|finally)\s+"
    r"|,?\s+(?:while|as|whereas|when|until|till|before)\s+|,?\s+who\s+|,\s+)"
)
_AT_ONCE = re.compile(r"\b(?:while|as|whereas|when|who)\b")
_UNTIL = re.compile(r"\b(?:until|till)\b")
_OPENING = re.compile(r"^(?:while|as|when|whereas|whenever|each time|every time)\s+")
_NO_COMMA = re.compile(r"^((?:while|when) \w+ing) (?=(?:he|she|they|person [ab]) \w+)")
_AFTER = re.compile(r"^(?:after|upon|following|once)\s+")


@dataclass(frozen=True)
class Clause:
    """A part of a sentence with one verb.

    Attributes:
        who: "a", "b" or "ab".
        words: what is done, without the subject, in lower case.
        at_once: it goes on at the same time as the clause beside it.
        until: it ends the clause before it ("… until …").
        stated: the sentence names who does it; otherwise it is the subject of the clause before.
        subject: there is one, stated or not.
    """

    who: str
    words: str
    at_once: bool = False
    until: bool = False
    stated: bool = True
    subject: bool = True


@dataclass
class _Cast:
    """The words that a sentence has used for either person so far."""

    words: dict[str, str] = field(default_factory=dict)

    def sex(self, person: str) -> str:
        """The sex of a person, m or f, or "" where the words so far do not say."""
        for word in (word for word, who in self.words.items() if who == person):
            for sex, words in _SEX.items():
                if words.fullmatch(word):
                    return sex
        return ""

    def noun(self, noun: str, last: str) -> str:
        """The person that a noun or a pronoun means; a new noun is the person who was not named yet."""
        head = noun.split()[-1]
        if head in self.words:
            return self.words[head]
        seen = set(self.words.values())
        if head in ("he", "she"):
            sex = "m" if head == "he" else "f"
            fits = [p for p in "ab" if p in seen and self.sex(p) == sex]
            unknown = [p for p in "ab" if p in seen and not self.sex(p)]
            if fits:
                found = fits[0]
            elif unknown:
                found = last if last in unknown else unknown[0]
            else:
                found = "b" if seen == {"a"} else "a"
        else:
            found = "a" if not seen else "b" if seen == {"a"} else "a" if seen == {"b"} else last
        self.words[head] = found
        return found


_NAMES_OF_PAIRS = re.compile(rf"(?:^|(?<=[,;.] )){KIND} and {KIND}(?= (?!\w+s\b)\w+)")
_A_WHILE = re.compile(
    r"\bafter (?:a|some|a few|several) (?:short |little )?(?:moment|while|bit|second|time|minute)s?,? "
)
_PLACED = re.compile(
    r"^(?:after|before|at|on|in|during) (?!the way\b)(?:the |an? )?\w+,? (?=(?:the|an?|two|both|they|person [ab])\b)"
)
"""A time or place before the first subject: "After the match the players …"."""
_RAISED = re.compile(
    rf"\b({KIND}|{NAMED}|(?:the|an?) \w+)'s ((?:(?:left|right) )?(?:arm|hand))s? (?:goes|shoots|flies|comes) up\b"
)
_TO_AND_FRO = re.compile(
    r"\b((?:walk|pac|run|march|stroll|jog|go|stride)\w*) (?:up and down|back and forth|to and fro"
    r"|forwards? and back\w*)"
)
_HAS = re.compile(
    rf"\b(?:has|have|had) (?:just |already |now )?(?=(?:\w+ed|{'|'.join(past_forms())})\b)(?!had\b)"
)
"""The auxiliary of a perfect: who has turned turns."""
_LETS = re.compile(rf"\band lets? ({NAMED}|the other(?: person)?) (\w+)")


def plain(text: str) -> str:
    """The sentence in lower case, people called A and B by their full names, and pairs as "they"."""
    text = re.sub(r"\([^()]*\)", " ", named(text[:LONGEST_READ])[:LONGEST_READ])
    text = re.sub(r"[\"“”][^\"“”]*[\"“”],?", " ", text)
    text = " ".join(text.lower().split()).strip(" .!?;")
    text = _HAS.sub("", _TO_AND_FRO.sub(r"\1 to-and-fro", text))
    text = in_plain_words(_A_WHILE.sub("", text))[:LONGEST_READ]
    text = _RAISED.sub(r"\1 raises his \2", _PLACED.sub("", text))
    text = re.sub(r", (?=(?:side by side|shoulder to shoulder|hand in hand|arm in arm)\b)", " ", text)
    text = _LETS.sub(r"and \1 \2s", text)
    return _PAIRED.sub("they", _NAMES_OF_PAIRS.sub("they", text[:LONGEST_READ]))


class Reader:
    """Reads the sentences of one story, in which "he" and "the visitor" stay who they are."""

    def __init__(self) -> None:
        self._cast = _Cast()
        self._last = ""

    def read(self, sentence: str) -> tuple[Clause, ...]:
        """The clauses of a sentence or of several, in order."""
        found: list[Clause] = []
        mark = ""
        text = plain(sentence)
        text, led = _LEADING.subn(r"\1, ", text)
        text = _NO_COMMA.sub(r"\1, ", text)
        opening = bool(_OPENING.match(text)) or (bool(led) and not _AFTER.match(text))
        text = _AFTER.sub("", _OPENING.sub("", text))
        for i, piece in enumerate(_JOIN.split(text)):
            if i % 2:
                mark = piece
                continue
            piece = piece.strip(" ,;.")
            if not piece:
                continue
            if _RELATIVE.search(mark) and found and (named := _OBJECT.search(found[-1].words)):
                piece = f"{named[0]} {piece}"
            who, words, stated = _who(piece, self._cast, self._last)
            at_once = bool(_AT_ONCE.search(mark)) or (opening and len(found) == 1)
            at_once = at_once or (not stated and bool(found) and bool(_GOING_ON.match(words)))
            subject = stated or bool(self._last)
            words = _from_outside(in_present(words))
            found.append(Clause(who, words, at_once, bool(_UNTIL.search(mark)), stated, subject))
            self._last = who if subject else ""
        return tuple(clause for clause in _without_setting(found) if clause.words)


_OWN_VOICE = {"me": "them", "us": "them", "my": "his", "our": "his", "myself": "himself"}


def _from_outside(words: str) -> str:
    """The words of a clause with those for the narrator as for anybody else: "runs to me" becomes "runs to them"."""
    return " ".join(_OWN_VOICE.get(word, word) for word in words.split(" "))


_DONE = re.compile(
    r"\w+ing\b|(?:with|without|hand in hand|arm in arm|side by side|back[- ]to[- ]back|both)\b"
)
"""Beginnings of clauses that say something of a subject that comes later."""


def _without_setting(found: Sequence[Clause]) -> Sequence[Clause]:
    """The clauses without those at the beginning that have no subject, as "Worn out" or "Sports day"."""
    first = next((i for i, clause in enumerate(found) if clause.stated), 0)
    return [*(c for c in found[:first] if _DONE.match(c.words) or is_known_act(c.words)), *found[first:]]


@lru_cache(maxsize=512)
def clauses(sentence: str) -> tuple[Clause, ...]:
    """The clauses of a sentence or of several, in order."""
    return Reader().read(sentence)


def _who(piece: str, cast: _Cast, last: str) -> tuple[str, str, bool]:
    """The person that a piece is about, the piece without its subject, and whether it has one."""
    match = _SUBJECT.match(piece)
    rest = piece[match.end() :] if match else piece
    person = (
        match is not None and _SOMEBODY.fullmatch(match["noun"] or "") and not re.match(r"[ab]'s\b", rest)
    )
    if match is None or (match["noun"] and rest and not person and not _VERB.match(_ADVERBS.sub("", rest))):
        return last or "ab", piece, False
    if match["many"]:
        return "ab", rest, True
    if match["named"]:
        who = match["named"][-1]
        cast.words[match["named"]] = who
        return who, rest, True
    if match["first"]:
        cast.words["first"] = "a"
        return "a", rest, True
    if match["second"]:
        # "the other" of the two is the person who was not mentioned last
        who = "a" if "other" in match["second"] and last == "b" else "b"
        cast.words[match["second"].split()[-1]] = who
        return who, rest, True
    return cast.noun(match["noun"], last if last in ("a", "b") else "a"), rest, True
