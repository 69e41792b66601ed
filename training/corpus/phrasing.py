"""Verb phrases of an act from its entry: its captions, also with verbs of its frames that WordNet calls the same.

A phrase is written as captions are (:mod:`acts.captions`), ``{a+b}`` for what is only said of both.
"""

from __future__ import annotations

import re
import zlib
from collections import Counter
from functools import cache

from acts import Act
from acts.captions import gerund, singular
from acts.frames import Frame
from acts.lexicon import Entry, lexicon
from acts.reading import read, wordnet

from .cues import entry

HELD_OUT = 6
"""Percentage of the phrases and names that are kept for captions of the test split."""
_VERB = re.compile(r"\[([a-z-]+)\]")
_SLOT = re.compile(r"\{([a-z]+)\}")
_LIMBS = ("arm", "hand", "leg", "foot")
_ONE_EACH = re.compile(r"\btheir (head|face|chest|fist|ear|guard|temper)\b")
_LIGHT = ("be", "do", "go", "have", "make", "remain")
"""Verbs that stand in no other's place."""


def held_out(text: str) -> bool:
    """True if a phrase is kept for captions of the test split."""
    return zlib.crc32(text.encode()) % 100 < HELD_OUT


@cache
def phrases(name: str) -> tuple[str, ...]:
    """All phrases of an entry.

    A caption by another verb than its frames, or that other entries share, is left out where there are others: it keeps
    to the words that the network knew, as "turns around" for looking around.
    """
    known = entry(name)
    shared = _shared()
    verbs = {verb.replace("-", "") for frame in known.frames for verb in Frame.parse(frame).verbs}
    own = [text for text in known.caption if _verb(text) in verbs and text not in shared]
    if all(text.startswith("{a+b}") for text in own):
        own += known.caption[:1]
    return tuple(dict.fromkeys([*own, *(other for text in own for other in _reworded(text, known))]))


@cache
def _shared() -> frozenset[str]:
    """Captions of more than one entry."""
    counts = Counter(text for known in lexicon().entries.values() for text in set(known.caption))
    return frozenset(text for text, count in counts.items() if count > 1)


def _verb(phrase: str) -> str:
    return _VERB.findall(phrase)[0].replace("-", "")


def _reworded(phrase: str, known: Entry) -> list[str]:
    """The phrase by other verbs of the entry's frames that have the same first sense in WordNet."""
    verb = _verb(phrase)
    alike: dict[str, None] = {}
    for frame in known.frames:
        verbs = Frame.parse(frame).verbs
        if verb in verbs:
            alike |= dict.fromkeys(sorted(other for other in verbs - {verb} if _same(verb, other)))
    return [_VERB.sub(f"[{other}]", phrase, count=1) for other in alike]


def _same(verb: str, other: str) -> bool:
    return other not in _LIGHT and wordnet.senses(verb)[:1] == wordnet.senses(other)[:1] != ()


@cache
def reads_back(name: str, phrase: str, *, both: bool) -> bool:
    """True if a sentence by this phrase is read as the entry and as nothing else.

    Args:
        both: as it is said of two people at once; else of one.
    """
    act = Act(
        id="1",
        act=name,
        agents=("a", "b") if both else ("a",),
        part="shoulder" if "{part}" in phrase else None,
        direction="forward" if "{direction}" in phrase else None,
        side="left" if names_side(phrase) else None,
    )
    if both:
        text = f"A man jumps, and then they {spoken(act, phrase, 'each other', 'their', 'plural')}."
    else:
        text = f"A man jumps, and then he {spoken(act, phrase, 'the woman', 'his', 's')}."
    return [one.act for one in read(text).acts] == ["jump", name]


def fitting(act: Act, *, sided: bool) -> list[str]:
    """The phrases that fit an act's number of people and what is known of it.

    Args:
        sided: only those that name the act's side, if there are any; else only those that name none.
    """
    both = len(act.agents) == 2
    found = [text for text in phrases(act.act) if both or not text.startswith("{a+b}")]
    if both and entry(act.act).to != "other":
        mutual = [text for text in found if text.startswith("{a+b}") or "{b}" in text]
        found = mutual or found
    found = [text for text in found if reads_back(act.act, text, both=both)] or found
    found = [text for text in found if act.part or "{part}" not in text]
    found = [text for text in found if act.direction or "{direction}" not in text]
    found = [text for text in found if act.thing or "{thing}" not in text] or found
    if both and act.side != "both":  # "they wave with the left hand" has one hand of the two
        found = [text for text in found if "with {limb}" not in text and "{side}" not in text] or found
    with_side = [text for text in found if "{limb}" in text or ("{side}" in text and act.side != "both")]
    if sided and with_side:
        return with_side
    plain = [text for text in found if "{limb}" not in text and "{side}" not in text]
    return plain or found


def spoken(act: Act, phrase: str, other: str, whose: str, form: str) -> str:
    """A phrase as a verb phrase: "waves at the other person with the left hand".

    Args:
        other: name of the other person, or "each other".
        whose: "his", "her" or "their", of the agent.
        form: "s" (waves), "plural" (wave) or "ing" (waving).
    """
    inflected = {"s": singular, "ing": gerund}.get(form, str)
    text = _VERB.sub(lambda match: inflected(match[1]), phrase).partition(" ")[2]
    limb = act.part if act.part in _LIMBS and "{part}" not in phrase else "hand"
    limbs = {"both": f"both {'feet' if limb == 'foot' else f'{limb}s'}", None: f"a {limb}"}
    values = {
        "part": act.part or "",
        "side": act.side if act.side in ("left", "right") else "",
        "limb": limbs.get(act.side, f"the {act.side} {limb}"),
        "thing": act.thing or "something",
        "direction": act.direction or "",
    }
    text = _SLOT.sub(lambda match: values.get(match[1], match[0]), text)
    if form != "s" and len(act.agents) == 2:
        text = _ONE_EACH.sub(lambda match: f"their {match[1]}s", text)
    text = text.replace("{b}", other)
    text = re.sub(r"\btheir\b", whose, text)
    return " ".join(text.split())


def names_side(phrase: str) -> bool:
    """True if a phrase names the side of the act."""
    return "{limb}" in phrase or "{side}" in phrase
