"""Acts of a plan in the visitor's language, by ``languages/de/acts.toml`` and ``words.toml``, and what a result shows.

An act without a line there, such as a lab's own, stays English.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any

from acts import Act, lexicon
from acts.captions import TURNS, short
from motion import InputError
from webdemo.inference.acting import plans_of_result
from webdemo.ui.visitor import wanted_language

from .said import Phrases, said, sections_of, words_of

_SLOT = re.compile(r"\{(part|thing|b)(?::([\w-]+))?\}")
_SIDES = (None, "left", "right", "both")
_THEN = ("then", "finally")


def said_act(act: Act) -> str:
    """An act in a few words, without the people who do it, as :func:`acts.captions.short` gives it in English."""
    return _worded(act, "{act}") or short(act, lexicon().entries.get(act.act))


@lru_cache(maxsize=8)
def _lines(language: str) -> Phrases:
    """The lines of all acts, by the names of their entries."""
    return words_of(language, "acts")


def _worded(act: Act, shape: str) -> str:
    """An act in another language, within a shape such as "A {act}"; "" where the language does not have it."""
    language = wanted_language()
    line = _lines(language).get(act.act)
    if line is None:
        return ""
    words = sections_of(language, "words")
    alone, both = line.split(" | ")
    label = both if len(act.agents) == 2 else alone
    text = shape.replace("{act}", _SLOT.sub(lambda slot: _filled(slot, act, words), label))
    text = ", ".join((text, *_details(act, {slot[1] for slot in _SLOT.finditer(label)}, words)))
    for kind in (act.modality, act.polarity):
        text = words["shapes"].get(kind, "{act}").replace("{act}", text)
    return f"{text} ×{act.times}" if act.times is not None and act.times > 1 else text


def _filled(slot: re.Match[str], act: Act, words: Mapping[str, Phrases]) -> str:
    """The words in a slot of an act's line: the other person, a part of the body or a thing."""
    if slot[1] == "b":
        return (act.patient or ("b" if act.agents[0] == "a" else "a")).upper()
    if slot[1] == "thing":
        return words["things"].get(act.thing or slot[2]) or f"„{act.thing}“"
    forms = words["parts"].get(act.part or slot[2], f"„{act.part}“").split(" | ")
    side = _SIDES.index(act.side)
    return forms[side] if side < len(forms) else forms[0]


def _details(act: Act, slots: set[str], words: Mapping[str, Phrases]) -> Iterator[str]:
    """Details of an act beyond its line: nouns without their article, a side, a direction, a manner."""
    if act.part and "part" not in slots:
        yield words["parts"].get(act.part, act.part).split(" | ")[0].rpartition(" ")[2]
    if act.thing and "thing" not in slots:
        yield words["things"].get(act.thing, act.thing).rpartition(" ")[2]
    if act.side and act.side not in ("both", act.direction) and "part" not in slots:
        yield words["ways"][act.side]
    if act.direction and (act.direction in TURNS or _takes_direction(act)):
        yield words["directions"].get(act.direction, act.direction)
    yield from (words["ways"].get(adverb, adverb) for adverb in act.manner[:1] if adverb not in _THEN)


def _takes_direction(act: Act) -> bool:
    entry = lexicon().entries.get(act.act)
    return entry is not None and any("{direction}" in caption for caption in entry.caption)


# ---- results
def phrases_of(manifest: Mapping[str, Any]) -> dict[str, str]:
    """The acts in the notes of a result, as they stand there and as the visitor's language has them."""
    found = {}
    for row, act in _judged(manifest):
        words, measure = str(row.get("words")), row.get("measure")
        found[words] = _clause(act) or words
        if measure:
            found[f"{words} ({measure})"] = f"{found[words]} ({said(measure, found)})"
    return found


def said_told(manifest: Mapping[str, Any]) -> str:
    """The description of a sample for people who cannot see it."""
    told = str(manifest.get("told") or "")
    rows = [(row.get("done"), clause) for row, act in _judged(manifest) if (clause := _happening(act))]
    if not told or not rows:
        return told
    seen = "; ".join(clause for done, clause in rows if done is not False)
    missed = "; ".join(clause for done, clause in rows if done is False)
    return " ".join(([f"{seen}."] if seen else []) + ([_missed(missed)] if missed else []))


def _happening(act: Act) -> str:
    return _clause(act) if act.happens else ""


def _clause(act: Act) -> str:
    shapes = sections_of(wanted_language(), "words").get("shapes", {})
    return _worded(
        act, shapes.get("pair" if len(act.agents) == 2 else "one", "").replace("{who}", act.agents[0].upper())
    )


def _missed(listed: str) -> str:
    return said("Not seen: {acts}.").replace("{acts}", listed)


def _judged(manifest: Mapping[str, Any]) -> Iterator[tuple[Mapping[str, Any], Act]]:
    """The verdicts of a result with their acts; none in English, which needs no plan for them."""
    rows = manifest.get("checked") or ()
    if not rows or not _lines(wanted_language()):
        return
    try:
        plans = plans_of_result(manifest)
    except InputError:
        return
    for row, act in zip(rows, (act for plan in plans for act in plan.acts), strict=False):
        if row.get("act") == act.act:
            yield row, act
