"""The outline of a TOML text: how many tables, how deep, how long its keys, found before anything in it is parsed.

`tomllib` takes quadratic time for a key of many parts and none of these limits, so a stranger's text is looked
through once, in linear time, and refused where no story would be so.
"""

from __future__ import annotations

import re
from functools import cached_property

from motion import InputError

MOST_DEEP = 8
"""Lists and tables in each other; a story has three."""
MOST_PARTS = 8
"""Parts of a dotted key; a story's keys have one."""
LONGEST_WORD = 100
"""Characters of a number or a bare key."""
_TOKEN = re.compile(
    r'(?P<text>"""(?:[^"\\]|\\.|"(?!""))*+"{3,5}'
    r"|'''(?:[^']|'(?!''))*+'{3,5}"
    r'|"(?:[^"\\\n]|\\[^\n])*+"'
    r"|'[^'\n]*+')"
    r"|(?P<comment>#[^\n]*+)|(?P<space>[ \t\r]++)|(?P<word>[\w+-]++)|(?P<sign>.)",
    re.DOTALL,
)
_HEADER = re.compile(r"^\s*\[\[?\s*\"?([\w-]+)\"?\s*\]\]?")
_KEY = re.compile(r"^\s*(?:\"([^\"]*)\"|'([^']*)'|([\w-]+))\s*[.=]")


def check_outline(text: str, most_tables: int) -> None:
    """Raises InputError for a text with more tables, or keys and lists in each other, than a story can have.

    Args:
        text: TOML, valid or not.
        most_tables: table headers, as ``[[beat]]``.
    """
    line, tables, depth, dots, begins = 1, 0, 0, 0, True
    for token in _TOKEN.finditer(text):
        kind, found = token.lastgroup, token[0]
        line += found.count("\n") if kind in ("text", "sign") else 0
        if kind == "word" and len(found) > LONGEST_WORD:
            raise InputError(f"Line {line}: {found[:20]!r} … is longer than any key or number: shorten it.")
        if kind == "sign" and found == ".":
            dots += 1
            if dots >= MOST_PARTS:
                raise InputError(f"Line {line}: a key has {dots + 1} parts or more: a story's keys have one.")
        elif kind == "sign":
            dots = 0
        if kind == "sign" and found in "[{":
            tables += found == "[" and begins
            depth += 1
            if tables > most_tables:
                raise InputError(f"The story has more than {most_tables} tables, more than any scene can: shorten it.")
            if depth > MOST_DEEP:
                raise InputError("The story is no valid TOML: its lists are nested too deeply.")
        elif kind == "sign" and found in "]}":
            depth = max(depth - 1, 0)
        if kind not in ("space", "comment"):
            begins = found == "\n" and not depth


class Lines:
    """The lines of a text's keys.

    Args:
        text: valid TOML.
    """

    def __init__(self, text: str) -> None:
        self.text = text

    def where(self, table: str, index: int, key: str) -> str:
        """``"Line 4: "`` for a key of the table's ``index``-th entry; "" if it is not found."""
        line = self._found.get((table, index, key))
        return f"Line {line}: " if line else ""

    @cached_property
    def _found(self) -> dict[tuple[str, int, str], int]:
        """The first line of each (table, index of its entry, key); a table's own name is a key of the text."""
        found: dict[tuple[str, int, str], int] = {}
        current, counts = "", {"": 0}
        for number, line in enumerate(self.text.splitlines(), 1):
            if header := _HEADER.match(line):
                current = header[1]
                counts[current] = counts.get(current, -1) + 1
                found.setdefault(("", 0, current), number)
            elif key := _KEY.match(line):
                found.setdefault((current, counts[current], key[1] or key[2] or key[3] or ""), number)
        return found
