"""A text in pieces: as it was written and as it is parsed, with the offsets of one in the other."""

from __future__ import annotations

import bisect
import itertools
import re
from collections.abc import Callable, Collection, Iterator, Mapping

from .people import A_NAME, B_NAME
from .syntax import is_adverb
from .vocabulary import closed, vocabulary

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

    def formations(self, start: int, stop: int) -> Iterator[str]:
        """The ways to stand or move together, as "side by side", that a stretch of the original names."""
        known = vocabulary().formations
        for _, first, last in self._pieces:
            if start <= first and last <= stop and (name := known.get(_words_of(self.original[first:last]))):
                yield name

    def left_out(self) -> Iterator[tuple[int, int]]:
        """Stretches of the original that are not parsed, such as what is said in quotation marks, with their words."""
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


def _words_of(text: str) -> tuple[str, ...]:
    return tuple(word.lower() for word, _, _ in tokens(text))


def tokens(text: str) -> list[tuple[str, int, int]]:
    """The words, numbers and marks of a text, with plain quotes, and their offsets in it."""
    found = _TOKEN.finditer(text)
    return [("".join(_QUOTES.get(c, c) for c in match[0]), match.start(), match.end()) for match in found]


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
    found = {}
    upper_b = any(word in ("B", "B's") for word in words)
    for i, word in enumerate(words):
        if word in ("A's", "B's"):
            found[i] = f"{A_NAME if word[0] == 'A' else B_NAME}'s"
        elif word in ("P1", "P2", "p1", "p2"):
            found[i] = A_NAME if word[1] == "1" else B_NAME
        elif word == "B":
            found[i] = B_NAME
        elif word == "A" and (
            (upper_b and (i + 1 == len(words) or not _takes_article(words, i))) or _verb_follows(words, i, is_verb)
        ):
            found[i] = A_NAME
    return found


def _verb_follows(words: list[str], i: int, is_verb: Callable[[str], bool]) -> bool:
    """True for a name before what it does: "A waves", "A slowly and sadly walks"."""
    following = itertools.islice(words, i + 1, i + 6)
    verb = next((word for word in following if word not in ("and", ",") and not _says_how(word)), "")
    return verb in closed("auxiliaries") or (verb.endswith(("s", "ed")) and is_verb(verb))


def _says_how(word: str) -> bool:
    return is_adverb(word) and not vocabulary().is_person(word)


def _takes_article(words: list[str], i: int) -> bool:
    following = words[i + 1]
    return following.isalpha() and vocabulary().is_person(following.lower()) and i + 2 < len(words)
