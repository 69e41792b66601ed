"""Letters that name the two people: "A hugs B", beside the article in "A man waves"."""

from __future__ import annotations

import itertools
from collections.abc import Callable

from .people import A_NAME, B_NAME
from .syntax import is_adverb
from .vocabulary import vocabulary


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
    return verb.endswith(("s", "ed")) and is_verb(verb)


def _says_how(word: str) -> bool:
    return is_adverb(word) and not vocabulary().is_person(word)


def _takes_article(words: list[str], i: int) -> bool:
    following = words[i + 1]
    return following.isalpha() and vocabulary().is_person(following.lower()) and i + 2 < len(words)
