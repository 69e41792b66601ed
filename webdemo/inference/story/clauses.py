"""Sentences about two people, taken apart into clauses: who does something, and what.

Plain pattern matching on word lists; a sentence that it cannot follow gives clauses without verbs of interest,
and nothing is planned from it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

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
_PEOPLE = r"(?:\w{3,}s|men|women|people|children)(?= \w+)"
_PLURAL = (
    rf"they|both(?: of them| people|(?: \w+)? {_PEOPLE})?|the (?:two|pair|couple)(?: of them| (?:\w+ )?{_PEOPLE})?"
    rf"|two (?:\w+ )??{_PEOPLE}|a couple|a pair|people|everybody|everyone|each(?: of them)?"
)
_NAMED = r"person [ab]"
_KIND = (
    r"(?:man|woman|boy|girl|guy|lady|gentleman|person|child|kid|friend|dancer|fighter|boxer|player|stranger|partner|"
    r"teacher|student|mother|father|mom|mum|dad|daddy|brother|sister|daughter|son|grandpa|grandma|waiter|guest|host|"
    r"visitor|guard|boss|worker|neighbou?r|cop|policeman|thief|soldier|doctor|nurse|patient|coach|king|queen|servant|"
    r"knight|clown|baby|toddler|teenager|colleague|customer|teammate|opponent|couple|stranger|human|character)"
)
_HOW = r"(?:old|young|little|small|tall|big|angry|happy|sad|tired|drunk|elderly|nervous|shy|proud)"
_FIRST = rf"(?:the )?(?:first|former)(?: {_KIND}| one)?|the actor|one of (?:them|the two)"
_SECOND = (
    rf"(?:the )?(?:second|latter)(?: {_KIND}| one)?|the (?:reactor|other)(?: {_KIND}| one)?|other (?:{_KIND}|one)"
    rf"|another(?: {_KIND})?|someone else|somebody else|the partner"
)
_NOUN = (
    rf"one {_KIND}|one|(?:{_HOW} )?{_KIND}|(?:an?|the|his|her|their|some) (?:\w+ ){{0,2}}?\w+(?= \w+)"
    r"|someone|somebody|he|she|it"
)
_LEADING = re.compile(
    rf"^((?:without|after|following|hearing|holding|having|with|on|at|in|from|upon)\b[^,]*?),? "
    rf"(?=(?:they|both of them|{_NAMED}|he|she|one|the (?:first|second|other)) \w+)"
)
_OBJECT = re.compile(rf"\b(?:{_NAMED}|the (?:first|second|other)(?: person| one)?|the \w+|him|her)$")
_ADVERB = (
    r"(?:(?:first|then|finally|afterwards|next|now|later|suddenly|slowly|quickly|eagerly|meanwhile|halfway|soon|eventually|there|also|just|simply|"
    r"carefully|\w+ly),? )*"
)
_SUBJECT = re.compile(
    rf"^{_ADVERB}(?:(?P<many>{_PLURAL})|(?P<named>{_NAMED})|(?P<first>{_FIRST})|(?P<second>{_SECOND})"
    rf"|(?P<noun>{_NOUN}))(?=\s|$)\s*"
)
_VERB = re.compile(r"^(?:is|are|was|does|do|has|have|can|will|keeps?|starts?|begins?|\w+s|\w+ing|\w+ed)\b")
_PAIRED = re.compile(
    rf"(?:^|(?<=[,;.] )|(?<=then )|(?<=while )|(?<=as ))"
    rf"(?:{_NAMED}|(?:an?|the|his|her) (?:\w+ )??\w+|he|she|someone) and "
    rf"(?:{_NAMED}|(?:an?|his|her|the(?! other)) (?:\w+ )??\w+|another \w+|he|she|someone else)(?= (?!\w+s\b)\w+)"
)
_GOING_ON = re.compile(r"^(?!(?:during|anything|something|nothing)\b)\w*[aeiouy]\w*ing\b")
_RELATIVE = re.compile(r"\bwho\b")
_JOIN = re.compile(
    r"(?P<mark>\s*[.;:!?]\s+|,?\s+(?:and|but|yet|so)\s+(?:then\s+)?|,?\s+(?:then|afterwards|finally)\s+"
    r"|,?\s+(?:while|as|whereas|when|until|till|before)\s+|,\s+who\s+|,\s+)"
)
_AT_ONCE = re.compile(r"\b(?:while|as|whereas|when|who)\b")
_UNTIL = re.compile(r"\b(?:until|till)\b")
_OPENING = re.compile(r"^(?:while|as|when|whereas)\s+")
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


_NAMES_OF_PAIRS = re.compile(rf"(?:^|(?<=[,;.] )){_KIND} and {_KIND}(?= (?!\w+s\b)\w+)")
_A_WHILE = re.compile(
    r"\bafter (?:a|some|a few|several) (?:short |little )?(?:moment|while|bit|second|time|minute)s?,? "
)
_NO_NAME = re.compile(
    r"(?:They|He|She|It|One|Two|Both|The|An?|First|Then|Finally|While|As|When|After|Before|Person|Someone|Somebody|Each|"
    r"People|Everyone|Everybody|Another|His|Her|Their|Suddenly|Without|With|Holding|I|We|You)\b"
)


def named(text: str) -> str:
    """The text with people called A and B, 1 and 2, or by a name, called so in a way that clauses understand."""
    if re.search(r"\b[Bb]\b", text) and not re.search(r"\bperson [ab]\b", text, re.IGNORECASE):
        text = re.sub(r"\b[Bb]\b(?=\s+[a-z]|'s\b|[.,;!?]|$)", "person B", text)
        text = re.sub(r"\bA\b(?=,|'s\b|\s+(?:\w+s|\w+ing|\w+ed)\b|[.;!?]|$)", "person A", text)
        text = re.sub(r"\ba(?=[.,;!?]|$)", "person A", text)
        text = re.sub(r"\bA\b(?= (?:and|in|on|at|by|with|to|from|then|is|has|does)\b)", "person A", text)
    text = re.sub(r"\b(?:[Pp]erson (?:one|1)|[Pp]1|[Pp]layer 1)\b", "person A", text)
    text = re.sub(r"\b(?:[Pp]erson (?:two|2)|[Pp]2|[Pp]layer 2)\b", "person B", text)
    return re.sub(
        r"(?<![A-Za-z'])([A-Z][a-z]+)(?= (?:\w+s|\w+ing|and|is|has)\b|'s\b|[.,;]|$)",
        lambda m: m[0] if _is_no_name(m[0]) else f"the {m[0].lower()}",
        text,
    )


_CAPITAL_KIND = re.compile(rf"{_KIND}$", re.IGNORECASE)
_CAPITAL_VERB = re.compile(
    r"\w+(?:ing|ly|es)$|[A-Z]{2}|(?:High|Low|Fist|Hug|Bow|Wave|Walk|Run|Shake|Kick|Push|Race|Dance|Jump)\b"
)


def _is_no_name(word: str) -> bool:
    return any(found.match(word) for found in (_NO_NAME, _CAPITAL_VERB, _CAPITAL_KIND))


def plain(text: str) -> str:
    """The sentence in lower case, people called A and B by their full names, and pairs as "they"."""
    text = named(text)
    text = " ".join(text.lower().split()).strip(" .!?;")
    text = _A_WHILE.sub("", text)
    text = re.sub(r", (?=(?:side by side|shoulder to shoulder|hand in hand|arm in arm)\b)", " ", text)
    text = re.sub(rf"\band lets? ({_NAMED}|the other(?: person)?) (\w+)", r"and \1 \2s", text)
    return _PAIRED.sub("they", _NAMES_OF_PAIRS.sub("they", text))


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
            found.append(Clause(who, words, at_once, bool(_UNTIL.search(mark)), stated, subject))
            self._last = who if subject else ""
        return tuple(clause for clause in found if clause.words)


def clauses(sentence: str) -> tuple[Clause, ...]:
    """The clauses of a sentence or of several, in order."""
    return Reader().read(sentence)


def _who(piece: str, cast: _Cast, last: str) -> tuple[str, str, bool]:
    """The person that a piece is about, the piece without its subject, and whether it has one."""
    match = _SUBJECT.match(piece)
    rest = piece[match.end() :] if match else piece
    if match is None or (match["noun"] and rest and not _VERB.match(re.sub(rf"^{_ADVERB}", "", rest))):
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
        turned = (
            "other" in match["second"] and last == "b"
        )  # the other of the two is the person who was not mentioned last
        who = "a" if turned else "b"
        cast.words[match["second"].split()[-1]] = who
        return who, rest, True
    return cast.noun(match["noun"], last if last in ("a", "b") else "a"), rest, True
