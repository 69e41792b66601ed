"""Texts made from a regular expression's own parse tree, on which a careless one takes polynomial or exponential time.

A pattern is slow where a part of it can match the same text in many ways. So each part that repeats, and each
beginning of the pattern, is repeated up to the longest text that the pattern may see, and ends with what cannot match.

Run as a program, it takes a pattern as Python writes it and the longest text, and prints what :func:`slow` finds.
"""

from __future__ import annotations

import ast
import functools
import re
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from re import _parser as parser  # type: ignore[attr-defined]
from types import FrameType
from typing import Any

SLOWEST = 0.05
"""Seconds of processor time that a pattern may take on its longest text, on a machine of the usual pace."""
_YARDSTICK = (re.compile(r"[a-z]{80}!"), "a" * 200_000, 0.02)
"""A pattern, a text and the seconds that the two take at the usual pace."""
_GIVES_UP = 0.5
"""Seconds of processor time after which a match is stopped."""
_MOST = 40
"""Variants of one part."""
_LETTERS = "abt1 ,.;-'\"\n\t\0(é\u3000_AZ/:[={}#!"
"""Characters of which one is in almost every set of characters."""
_COMMON = (
    " ",
    "a",
    "a ",
    "as ",
    "the ",
    ",",
    ", ",
    ". ",
    "\n",
    "(",
    '"',
    "A ",
    "B. ",
    "a's ",
    "aly ",
    "slowly ",
    "and ",
    "person a ",
    "the other person ",
    "is ",
    "aing ",
    "1",
    "1 ",
    "\t\n",
    "[[a]]\n",
    "-",
    "é",
)
_ENDS = ("", "\0", "!", " \n")


def attacks(pattern: re.Pattern[Any], longest: int) -> Iterator[str]:
    """Texts of at most ``longest`` characters, made to be slow to match or to refuse."""
    tree = parser.parse(_text(pattern.pattern), pattern.flags & ~re.DEBUG)
    made = {("", pump) for pump in _COMMON}
    for before, pumps in _repeats(tree, ""):
        for pump in pumps:
            made |= {(before, pump), ("", before + pump)}
    made |= {("", _sample(tree[:i])) for i in range(1, len(tree) + 1)}
    for before, pump in sorted(made):
        count = (longest - len(before)) // max(len(pump), 1)
        if pump and count > 1:
            for end in _ENDS:
                yield (before + pump * count)[: longest - len(end)] + end


def slow(pattern: re.Pattern[Any], longest: int) -> str | None:
    """The attack on which a pattern takes longer than :data:`SLOWEST`, in a few words; None if there is none."""
    for text in attacks(pattern, longest):
        if all(seconds(pattern, text) > SLOWEST * pace() for _ in range(2)):  # not for another reason, once
            return f"{text[:80]!r} … {text[-12:]!r} ({len(text)} characters)"
    return None


@functools.cache
def pace() -> float:
    """How many times as long as usual this machine takes to match a pattern, and at least 1."""
    pattern, text, usual = _YARDSTICK
    return max(1.0, min(seconds(pattern, text) for _ in range(5)) / usual)


def seconds(pattern: re.Pattern[Any], text: str) -> float:
    """Processor seconds in which a pattern is looked for throughout a text, and held against the whole of it."""
    given: Any = text if isinstance(pattern.pattern, str) else text.encode()
    signal.signal(signal.SIGPROF, _stop)
    signal.setitimer(signal.ITIMER_PROF, _GIVES_UP)
    began = time.process_time()
    try:
        for _ in pattern.finditer(given):
            pass
        pattern.fullmatch(given)
    except _TooLong:
        return _GIVES_UP
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    return time.process_time() - began


class _TooLong(Exception):
    pass


def _stop(number: int, frame: FrameType | None) -> None:
    raise _TooLong


def _text(pattern: str | bytes) -> str:
    return pattern if isinstance(pattern, str) else pattern.decode("latin-1")


def _repeats(tree: Sequence[Any], before: str) -> Iterator[tuple[str, list[str]]]:
    """A text that leads to each part that repeats, and texts that it repeats."""
    for i, (kind, value) in enumerate(tree):
        led = before + _sample(tree[:i])
        name = str(kind)
        if name in ("MAX_REPEAT", "MIN_REPEAT", "POSSESSIVE_REPEAT"):
            _, most, body = value
            if most > 3:
                yield led, _variants(body)
        for part in _inside(name, value):
            yield from _repeats(part, led)


def _inside(name: str, value: Any) -> Iterator[Sequence[Any]]:
    """The parts that a node holds."""
    if name == "BRANCH":
        yield from value[1]
    elif name in ("MAX_REPEAT", "MIN_REPEAT", "POSSESSIVE_REPEAT"):
        yield value[2]
    elif name == "SUBPATTERN":
        yield value[3]
    elif name in ("ASSERT", "ASSERT_NOT"):
        yield value[1]
    elif name == "ATOMIC_GROUP":
        yield value
    elif name == "GROUPREF_EXISTS":
        yield from (part for part in value[1:] if part)


def _sample(tree: Sequence[Any]) -> str:
    return _variants(tree)[0] if tree else ""


def _variants(tree: Sequence[Any]) -> list[str]:
    """Texts that a sequence matches, the first of which takes the first of all choices."""
    choices = [_choices(str(kind), value) for kind, value in tree]
    first = [options[0] for options in choices]
    found = ["".join(first)]
    for i, options in enumerate(choices):
        found += ["".join([*first[:i], other, *first[i + 1 :]]) for other in options[1:]]
    return list(dict.fromkeys(found))[:_MOST]


def _choices(name: str, value: Any) -> list[str]:
    """Texts that a node matches."""
    if name == "LITERAL":
        return [chr(value)]
    if name in ("NOT_LITERAL", "ANY", "IN", "CATEGORY"):
        items = [("NOT_LITERAL", value)] if name == "NOT_LITERAL" else [] if name == "ANY" else value
        fits = [c for c in _LETTERS if name == "ANY" or _is_in(c, items)]
        return fits[:3] or ([chr(items[0][1])] if str(items[0][0]) == "LITERAL" else ["a"])
    if name in ("MAX_REPEAT", "MIN_REPEAT", "POSSESSIVE_REPEAT"):
        least, most, body = value
        once = [text * max(least, 1) for text in _variants(body)] if most else []
        return ([*once, ""] if not least else once)[:_MOST] or [""]
    if name in ("BRANCH", "SUBPATTERN", "ATOMIC_GROUP", "GROUPREF_EXISTS"):
        parts = [_variants(part) for part in _inside(name, value)]
        heads, rest = [part[0] for part in parts if part], [text for part in parts for text in part[1:]]
        return list(dict.fromkeys([*heads, *rest]))[:_MOST] or [""]
    return [""]  # places, looks around and references take no room


def _is_in(char: str, items: Sequence[Any]) -> bool:
    """Whether a character is in a set of characters."""
    negated, found = False, False
    for kind, value in items:
        name = str(kind)
        if name == "NEGATE":
            negated = True
        elif name == "LITERAL":
            found |= ord(char) == value
        elif name == "NOT_LITERAL":
            found |= ord(char) != value
        elif name == "RANGE":
            found |= value[0] <= ord(char) <= value[1]
        elif name == "CATEGORY":
            letter = {"DIGIT": r"\d", "SPACE": r"\s", "WORD": r"\w"}
            kind_of = str(value).rsplit("_", 1)[-1]
            inside = bool(re.match(letter.get(kind_of, "."), char))
            found |= inside != ("NOT" in str(value))
    return found != negated


if __name__ == "__main__":
    print(slow(re.compile(ast.literal_eval(sys.argv[1])), int(sys.argv[2])) or "")
