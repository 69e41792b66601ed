"""The figures behind predicates, in a few plain words: "hand 34 cm from the shoulder", "they stay 1.8 m apart".

A predicate with a limit is measured by it: the figure is the limit next to which it begins to hold in some frame, so
that what is measured and what is needed have one unit and never disagree.
"""

from __future__ import annotations

import inspect
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from .joints import PREDICATES, Motion
from .paths import WALK
from .touches import NEARBY


def _by_name(table: dict[str, str]) -> dict[str, str]:
    return {name: said for said, names in table.items() for name in names.split()}


_TABLES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
AT_MOST, AT_LEAST, INSTEAD = (_by_name(_TABLES[kind]) for kind in ("at_most", "at_least", "instead"))
"""What is said of predicates by their names, and the predicates by which others are measured."""
_WAYS = {"any": "", "left": "to the left", "right": "to the right", "towards": "towards the other"}
"""The way of a lean in words, where it is not its own."""
_RANGES = _TABLES["ranges"]
"""The least and the largest value of a limit, by its name, and its unit."""
_METRES = (0.0, 16.0, " m")
"""Those of every other limit."""


def figure(name: str, m: Motion, *values: Any, **named: Any) -> tuple[str, str]:
    """What is measured of a predicate, and the limit that it asks for in the same unit; "" where it has none.

    Args:
        name: of the predicate.
        m: the motion.
        values, named: the arguments of the predicate.
    """
    if name in INSTEAD:
        return figure(INSTEAD[name], m, values[0])[0], ""
    asked = _asked(name, m, *values, **named)
    text = (AT_MOST | AT_LEAST).get("runs" if name == "walks" and asked["speed"] > WALK else name, "")
    limit = next((each for each in asked if f"{{{each}}}" in text and each not in ("who", "way", "part")), "")
    if not limit:
        return "", ""
    low, high, unit = _RANGES.get(limit, _METRES)

    def holds(value: float) -> bool:
        return bool(np.any(PREDICATES[name](**{**asked, limit: value})))

    easy, hard = (high, low) if name in AT_MOST else (low, high)
    if not holds(easy):
        if name in AT_MOST:
            return "", ""  # it is not for want of this
        hard = easy
    for _ in range(14):
        middle = (easy + hard) / 2
        easy, hard = (middle, hard) if holds(middle) else (easy, middle)
    if limit == "gap" and abs(easy - NEARBY) < 0.01:
        return "", ""  # a hand is near, and elsewhere on the body
    who, way = asked.get("who", 0), asked.get("way", "")
    said, needed = (_over(each) if limit == "over" else _said(each, unit) for each in (easy, asked[limit]))
    if said == needed:
        said = f"just {'over' if (name in AT_MOST) != holds(asked[limit]) else 'under'} {needed}"
    words = {"who": "AB"[who], "whom": "BA"[who], "part": asked.get("part"), "way": _WAYS.get(way, way), limit: said}
    return " ".join(text.format(**words).split()), needed


def asks(name: str, m: Motion, *values: Any, **named: Any) -> str:
    """What a predicate asks for, in the first words of its docstring and with its values; arguments as above."""
    text = re.split(r"[.;:](?:\s|$)", str(PREDICATES[name].__doc__))[0]
    for key, value in _asked(name, m, *values, **named).items():
        plain = key in ("least", "most") or not isinstance(value, float)
        text = text.replace(f"``{key}``", str(value) if plain else _said(value, _RANGES.get(key, _METRES)[2]))
    return text[:1].lower() + text[1:]


def _asked(name: str, m: Motion, *values: Any, **named: Any) -> dict[str, Any]:
    bound = inspect.signature(PREDICATES[name]).bind(m, *values, **named)
    bound.apply_defaults()
    return dict(bound.arguments)


def _over(metres: float) -> str:
    return f"{_said(abs(metres), ' m')} {'above' if metres > 0 else 'below'}"


def _said(value: float, unit: str) -> str:
    """A value in a readable unit: metres below 1 as centimetres, shares as per cent."""
    if unit == " %" or (unit == " m" and abs(value) < 0.995):
        return f"{100 * value:.0f}{' cm' if unit == ' m' else unit}"
    return f"{value:.{0 if unit == '°' else 1}f}{unit}"
