"""Preparation of a text for the parser: letters become names, missing articles are supplied, spelling is mended.

Each change keeps the offsets, so that what was understood can be shown in the text as it was written.
"""

from __future__ import annotations

import bisect
import re
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from acts.plan import Span

from .ellipsis import Ellipsis, stands_absolutely
from .people import A_NAME, B_NAME
from .syntax import adverb_of, is_adverb
from .vocabulary import closed, vocabulary

if TYPE_CHECKING:
    from .spelling import Speller

_NUMBERED = {"a": True, "1": True, "one": True, "b": False, "2": False, "two": False}
"""Letters and numbers behind "person" or "dancer", and whether they name the first."""


def prepared(text: str, speller: Speller) -> Text:
    """The text as it is parsed.

    Args:
        text: as it was written.
        speller: knows the forms of verbs, and mends misspelt ones.
    """
    return _Preparation(text, speller).text()


class _Preparation:
    """Goes through the words of a text once."""

    def __init__(self, text: str, speller: Speller) -> None:
        self._text, self._mended, self._is_verb = text, speller.mended, speller.forms.__contains__
        self._is_deed, self._forms = speller.is_deed, speller.forms
        self._words = vocabulary()
        self._tokens = without_request(without_speech(tokens(text)))
        self._letters = names([word for word, _, _ in self._tokens], self._is_verb)
        small = [word.lower() for word, _, _ in self._tokens]
        self._lower = defaultdict(str, enumerate(small)).__getitem__
        """The words by their number, in small letters; "" beyond the ends."""
        named = (self._letters.get(i, word).lower() for i, word in enumerate(small))
        self._ellipsis = Ellipsis(defaultdict(str, enumerate(named)).__getitem__, speller)
        self._pieces: list[tuple[str, int, int]] = []

    def text(self) -> Text:
        """The prepared text."""
        i = 0
        while i < len(self._tokens):
            if verb := self._ellipsis.before(i):
                self._supply(verb, i)
            if self._named_again(i):
                self._pieces.append((",", self._tokens[i][1], self._tokens[i][1]))
            taken = self._phrase(i) or self._pair(i) or self._single(i)
            for within in range(i + 1, i + taken):
                self._ellipsis.passed(within)
            i += taken
        return Text(self._text, self._pieces)

    def _named_again(self, i: int) -> bool:
        """True for the "and" of "A hits B and B cries": nobody stands beside themselves, so a clause begins there."""
        last = self._lower(i - 1)
        if self._lower(i) != "and" or not (i - 1 in self._letters or self._words.is_person(last)):
            return False
        known = self._lower(i + 1) in ("the", "this", "that", *closed("lettered"))  # "a woman and a woman" are two
        return last == self._lower(i + 1 + known)

    def _supply(self, verb: str, i: int) -> None:
        """Puts a verb that the text leaves out before a token; what it joins by a comma becomes a clause."""
        start = self._tokens[i][1]
        if self._lower(i - 1) == "," and not verb.startswith(("is", "are")):
            _, first, last = self._pieces.pop()
            self._pieces.append(("and" if verb.split()[0].endswith("s") else ".", first, last))
        self._pieces.append((verb, start, start))

    def _phrase(self, i: int) -> int:
        """Several words that join clauses as one does, as "as soon as"; how many they were, or 0."""
        swung = next((words for words in self._words.to_sides if self._stand_at(i, words)), ())
        if swung and self._words.named_part(self._lower(i - 1)):
            return self._as_one("sideways", i, len(swung))  # "shakes his head left and right"
        if swung and any(self._forms.get(self._lower(k), "-")[0] in closed("looks") for k in range(i - 4, i)):
            return self._as_one("around", i, len(swung))  # "looks left and right for her"
        for phrase, word in self._words.phrases.get(self._lower(i), ()):
            if self._stand_at(i, phrase):
                return self._as_one(word, i, len(phrase))
        if mimed := self._mimed(i):
            return mimed
        if self._stand_at(i, ("in", "front")) and self._lower(i + 2) != "of":
            return self._as_one("ahead", i, 2)
        ends = not self._lower(i + 1).isalpha() or self._lower(i + 1) in ("and", "then", "while", "until")
        ends = (ends and self._is_verb(self._lower(i - 1))) or self._lower(i - 1) in ("him", "her")
        if self._lower(i) == "round" and ends:
            return self._as_one("around", i, 1)  # the adverb, and no noun: "and spin round"
        owned = self._lower(i - 1) in ("lower", "upper") or self._lower(i - 1).endswith("'s")
        owned = owned and self._lower(i - 1) not in ("he's", "she's", "it's")
        laid = self._lower(i - 2) == "on" and self._lower(i - 3).startswith(tuple(closed("lies")))
        rubbed = self._lower(i - 2).startswith(tuple(closed("strokes")))
        turned = self._lower(i - 1) == "her" and (self._lower(i + 1) in closed("behind back") or laid or rubbed)
        if self._lower(i) == "back" and (owned or turned):
            return self._as_one("spine", i, 1)  # the noun, and no adverb
        pointed = self._lower(i) in ("the", "these", "those") and self._lower(i + 1) == "two"
        if pointed and self._is_verb(self._lower(i + 2)):
            return self._as_one("they", i, 2)  # "the two circle round"
        return 0

    def _as_one(self, word: str, i: int, count: int) -> int:
        """Puts a word in the place of several tokens, of which it gives the number."""
        self._pieces.append((word, self._tokens[i][1], self._tokens[i + count - 1][2]))
        return count

    def _mimed(self, i: int) -> int:
        """How many words "makes a throwing motion", "in a chopping motion" or "does the motion of digging" begin with.

        In their place stands what they mean, "pretends to throw" and "as if to chop"; 0 for other words.
        """
        verb, ending = self._forms.get(self._lower(i), ("", ""))
        makes = verb in self._words.verbs["light"]
        if not makes and self._lower(i) not in ("in", "with"):
            return 0
        at = next((k for k in range(i, i + 5) if self._lower(k + 1) in closed("motions")), i)
        last = at + (3 if makes and self._lower(at + 2) == "of" else 1)
        lemma, going = self._forms.get(self._lower(last if last > at + 1 else at), ("", ""))
        if going != "ing" or last == i + 1:
            return 0
        said = f"pretend{ending.removeprefix('e')} to {lemma}" if makes else f"as if to {lemma}"
        within = [word for k in range(i + 1, at) if (word := self._lower(k)) not in closed("determiners")]
        said += "".join(f" {adverb_of(word)}" for word in within[-1:])  # "a vertical waving motion"
        return self._as_one(said, i, last + 1 - i)

    def _stand_at(self, i: int, words: Sequence[str]) -> bool:
        return all(self._lower(i + k) == word for k, word in enumerate(words))

    def _pair(self, i: int) -> int:
        """Two tokens that are one word, as "person A" and "high five"; 2 if they were, else 0."""
        lower, following = self._lower(i), self._lower(i + 1)
        word, owner = "", "'s" * following.endswith("'s")
        letter = following.removesuffix("'s")
        if (
            (lower in closed("lettered") or self._is_numbered(i))
            and letter in _NUMBERED
            and self._lower(i + 2) != "times"
            and (owner or _ends_name(self._tokens, i + 2, self._tokens[i + 1][0]))
        ):
            word = (A_NAME if _NUMBERED[letter] else B_NAME) + owner
        elif following in ("height", "level") and self._words.part(lower) and lower != "eye":
            word = following  # "to shoulder height", where nobody shoulders anything
        elif lower in ("right", "way") and following in closed("intensified") and not self._keeps(i):
            word = "around" if following == "round" else following  # "walks right past him", "way up"
        elif following.isalpha() and lower not in self._words.numbers and self._is_verb(lower + following):
            word = lower + following
        return self._as_one(word, i, 2) if word else 0

    def _is_numbered(self, i: int) -> bool:
        """True for a noun of a person that begins a clause, where a verb follows its number: "boxer two ducks"."""
        begins = self._lower(i - 1) in ("", ",", ".", ";", "and", "then", "while")
        return begins and self._words.is_person(self._lower(i)) and self._is_verb(self._lower(i + 2))

    def _keeps(self, i: int) -> bool:
        """True for a direction, and for a noun: "turn right past her", "the way up"."""
        before = self._lower(i - 1)
        return before.startswith("turn") if self._lower(i) == "right" else before in closed("determiners")

    def _single(self, i: int) -> int:
        """One token; always 1."""
        word, start, stop = self._tokens[i]
        if word == ":" and i - 1 in self._letters:  # "A: waves"
            return 1
        if word == "," and self._words.directions.get(self._lower(i + 1), "").endswith("clockwise"):
            return 1  # "in a circle, clockwise"
        if stands_absolutely(self._lower, self._ellipsis.has_verb, i):
            self._pieces.append(("with", start, start))
        if self._pieces and self._pieces[-1][2] == start and word.istitle() and i not in self._letters:
            word = word.lower()  # a verb or "with" was supplied before it
        self._pieces += self._supplied(i)
        self._pieces.append((self._letters.get(i) or self._worded(i, word), start, stop))
        return 1

    def _supplied(self, i: int) -> list[tuple[str, int, int]]:
        """The article that a bare noun of a person lacks."""
        word, start, _ = self._tokens[i]
        goes = self._lower(i - 1) in closed("before sides") or self._words.named_part(self._lower(i + 1))
        sided = self._lower(i) in ("left", "right") and goes
        begun = self._pieces[-1:] and self._pieces[-1][1:] == (start, start)  # a verb was supplied
        within = closed("determiners") | {"left", "right", "and", "or", "with"}
        owned = self._lower(i - 2).endswith("'s")  # "under her partner's raised left arm"
        if sided and (begun or (self._lower(i - 1) not in within and not owned)):
            return [("the", start, start)]  # "drags left leg", where nobody leaves
        bare = i not in self._letters and word.islower() and not word.endswith("s") and word not in ("one", "person")
        if not bare or not _begins(self._lower(i - 1)) or not self._is_bare_person(i) or self._lower(i + 1) == "'":
            return []
        before_it, before = (self._lower(k) in closed("determiners") for k in (i - 2, i - 1))
        return [] if before_it and not before else [("the", start, start)]  # not in "an unconscious man"

    def _is_bare_person(self, i: int) -> bool:
        """True for a usual noun of a person, and for a rarer one before its verb or behind a preposition."""
        word, following = self._lower(i), self._lower(i + 1)
        if self._words.is_usual_person(word):
            return True
        if not self._words.is_person(word) or self._is_verb(word):
            return False
        acts = following.endswith("s") and self._is_verb(following)
        return acts or self._lower(i - 1) in closed("towards")

    def _worded(self, i: int, word: str) -> str:
        lower, following = word.lower(), self._lower(i + 1)
        if lower in self._words.shorthand:
            return self._words.shorthand[lower]
        if lower == "using" and self._ellipsis.last and self._lower(i - 1) not in closed("going"):
            return "with"  # "kicks using the left leg"
        supplied = self._pieces[-1][0].partition(" ")[0] if self._pieces else ""  # with its object, where it has one
        moved = self._is_verb(self._lower(i - 1)) or self._is_verb(supplied)
        if lower in ("left", "right") and moved and not self._words.named_part(following):
            return f"to the {lower}"  # "turn left": no past of "leave"
        if word.islower() and word.isalpha() and len(word) > 3 and (right := self._mended(lower)) is not None:
            return right
        joined = lower.replace("-", "")
        known = self._is_verb(joined) or self._is_deed(joined.removesuffix("s"))
        if joined != lower and known:  # "high-five", "push-ups"
            return joined
        return lower if word.isupper() and len(word) > 1 else word


def begins_with_subject(text: str) -> bool:
    """True if a clause names who acts, as "she waves" and "the man waves" do, and not "waves"."""
    words = [word for word, _, _ in tokens(text.lower())][:2]
    if not words:
        return False
    known = vocabulary()
    alone = words[0] in closed("subjects") or words[0] in known.both or known.is_usual_person(words[0])
    return alone or words[0] in closed("determiners")


def _begins(before: str) -> bool:
    """True if a noun after this word has no article: at the beginning, after punctuation or a verb."""
    if not before or not before.isalpha():
        return before != "'" and before != "-"
    words = vocabulary()
    return (
        before not in closed("determiners")
        and not words.is_person(before)
        and (before.endswith(("s", "ing", "ed")) or before in closed("towards") | {"while", "then", "and"})
    )


def _ends_name(tokens: list[tuple[str, int, int]], i: int, letter: str) -> bool:
    """True if "person a" at this place is a name, and not "… person a hug"."""
    if letter.isupper() or letter.isdigit() or letter in ("b", "one", "two"):
        return True
    return i >= len(tokens) or not tokens[i][0].isalpha() or tokens[i][0].endswith(("s", "ing", "ed"))


# ---- pieces of a text ---------------------------------------------------------------------------------
_TOKEN = re.compile(r"[Pp][12]\b|[^\W\d_]+(?:['’-][^\W\d_]+)*|\d+(?:[.,]\d+)?|[^\w\s]|_")
_QUOTES = {"’": "'", "‘": "'", "`": "'", "“": '"', "”": '"', "–": "-", "—": "-"}


class Text:
    """A text and the form in which it is parsed.

    Attributes:
        original: as it was written.
        parsed: as the parser gets it.
    """

    def __init__(self, original: str, pieces: list[tuple[str, int, int]]) -> None:
        self.original = original
        self._pieces = pieces
        self._starts: list[int] = []
        words = ""
        for word, _, _ in pieces:
            words += " " if words else ""
            self._starts.append(len(words))
            words += word
        self.parsed = words

    def replaced(self, words: Mapping[int, str]) -> Text:
        """The same text, parsed with other words in the place of those that begin at these offsets."""
        pieces = [
            (words.get(at, word), start, stop)
            for at, (word, start, stop) in zip(self._starts, self._pieces, strict=True)
        ]
        return Text(self.original, pieces)

    def broken(self, numbers: Collection[int]) -> Text:
        """The same text with a stop before the words of these numbers."""
        pieces: list[tuple[str, int, int]] = []
        for i, piece in enumerate(self._pieces):
            stop = "," if piece[0] == "and" else ";"
            pieces += [(stop, piece[1], piece[1]), piece] if i in numbers else [piece]
        return Text(self.original, pieces)

    def number(self, at: int) -> int:
        """The number of the word that begins at this offset of what is parsed."""
        return bisect.bisect_right(self._starts, at) - 1

    def word(self, at: int) -> str:
        """The word at this offset of what is parsed."""
        return self._pieces[self.number(at)][0]

    def ended(self) -> Text | None:
        """The same text with the full stop that it lacks, without which the parser errs more; None if it has one."""
        if not self._pieces or not self._pieces[-1][0][-1].isalnum():
            return None
        end = len(self.original)
        return Text(self.original, [*self._pieces, (".", end, end)])

    def formations(self, start: int, stop: int) -> Iterator[tuple[str, Span]]:
        """The ways to stand or move together, as "side by side", that a stretch of the original names, and where."""
        known = vocabulary().formations
        for _, first, last in self._pieces:
            words = tuple(word.lower() for word, _, _ in tokens(self.original[first:last]))
            if start <= first and last <= stop and (name := known.get(words)):
                yield name, Span(start=first, stop=last)

    def left_out(self) -> Iterator[tuple[int, int]]:
        """Stretches of the original that are not parsed, such as what is said in quotation marks, with their words.

        Where somebody is who is "the person on the left" is one.
        """
        yield from ((i, j) for word, i, j in self._pieces if word.startswith(("the first ", "the second ")))
        stops = [stop for _, _, stop in self._pieces]
        starts = [start for _, start, _ in self._pieces[1:]]
        for stop, start in zip(stops, [*starts, len(self.original)], strict=True):
            if words := re.search(r"\w(?:.*\w)?", self.original[stop:start], re.DOTALL):
                yield stop + words.start(), stop + words.end()

    def span(self, first: int, last: int) -> tuple[int, int]:
        """The offsets in the original of a stretch of what was parsed."""
        i = max(bisect.bisect_right(self._starts, first) - 1, 0)
        j = max(bisect.bisect_left(self._starts, last) - 1, i)
        while j + 1 < len(self._pieces) and self._pieces[j][2] <= self._pieces[i][1]:
            j += 1  # a verb that was supplied stands for the word behind it
        return self._pieces[i][1], self._pieces[j][2]


def tokens(text: str) -> list[tuple[str, int, int]]:
    """The words, numbers and marks of a text, with plain quotes, and their offsets in it."""
    matches = _TOKEN.finditer(text)
    return [("".join(_QUOTES.get(c, c) for c in match[0]), match.start(), match.end()) for match in matches]


def without_speech(tokens: list[tuple[str, int, int]]) -> list[tuple[str, int, int]]:
    """The tokens without what is said in quotation marks or stands in brackets; all if nothing else is told."""
    marks = [i for i, (word, _, _) in enumerate(tokens) if word == '"']
    spoken = {i for first, last in zip(marks[::2], marks[1::2], strict=False) for i in range(first, last + 1)}
    opened = -1
    for i, (word, _, _) in enumerate(tokens):
        opened = i if word == "(" else opened
        if word == ")" and opened >= 0:
            spoken.update(range(opened, i + 1))
            opened = -1
    told = [token for i, token in enumerate(tokens) if i not in spoken]
    return told if sum(word.isalpha() for word, _, _ in told) > 1 else tokens


def without_request(tokens: list[tuple[str, int, int]]) -> list[tuple[str, int, int]]:
    """The tokens without what asks for a motion: "show me two people dancing", "i want to see them hug"."""
    words = [word.lower() for word, _, _ in tokens]
    for request in vocabulary().requests:
        if tuple(words[: len(request)]) == request and len(words) > len(request) + 1:
            return tokens[len(request) :]
    return tokens


# ---- letters -------------------------------------------------------------------------------------------
def names(words: list[str], is_verb: Callable[[str], bool]) -> dict[int, str]:
    """The letters A and B, and P1 and P2, that are names: their numbers among the words → the name for the parser.

    Args:
        words: of the text, as written.
        is_verb: says whether a word is a form of a verb.
    """
    letters = {}
    if not {"b", "b's"}.isdisjoint(words) and {"A", "B"}.isdisjoint(words):  # "a sneaks up on b"
        ends = [not word.isalpha() or word in ("and", "then") for word in (*words[1:], ".")]
        named = (
            w in ("b", "b's", "a's") or (w == "a" and (ends[i] or _verb_follows(words, i, is_verb)))
            for i, w in enumerate(words)
        )
        words = [word.capitalize() if name else word for word, name in zip(words, list(named), strict=True)]
    upper_b = any(word in ("B", "B's") for word in words)
    for i, word in enumerate(words):
        if word in ("A's", "B's"):
            letters[i] = f"{A_NAME if word[0] == 'A' else B_NAME}'s"
        elif word in ("P1", "P2", "p1", "p2"):
            letters[i] = A_NAME if word[1] == "1" else B_NAME
        elif word == "B":
            letters[i] = B_NAME
        elif word == "A" and (
            (upper_b and (i + 1 == len(words) or not _takes_article(words, i))) or _verb_follows(words, i, is_verb)
        ):
            letters[i] = A_NAME
    return letters


def _verb_follows(words: list[str], i: int, is_verb: Callable[[str], bool]) -> bool:
    """True for a name before what it does: "A waves", "A slowly and sadly walks"."""
    said = (word for word in words[i + 1 : i + 6] if not is_adverb(word) or vocabulary().is_person(word))
    verb = next((word for word in said if word not in ("and", ",")), "")
    return verb in closed("auxiliaries") or (verb.endswith(("s", "ed")) and is_verb(verb))


def _takes_article(words: list[str], i: int) -> bool:
    following = words[i + 1]
    return following.isalpha() and vocabulary().is_person(following.lower()) and i + 2 < len(words)
