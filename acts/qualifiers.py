"""The qualifiers of acts, such as how often and which side, that no rule measures: a verdict names them.

Where an act goes somewhere, its way, speed and distance bring rules of their own.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from motion.metrics.sentences.touches import BODY, has_sides

from .accounting import said_words, shown_caption
from .captions import plural, usual_limb
from .lexicon import Entry
from .plan import FROM_BEHIND, GAITS, ON_TIPTOE, Act
from .reading.vocabulary import closed, vocabulary
from .shapes import Figure, Gesture, Go, Touch, Turn

_BOTH = re.compile(r"\bboth (?:\w+ )?(hands|arms|palms|fists|feet|legs|knees|elbows|shoulders|cheeks)\b", re.IGNORECASE)

_OF_BOTH = "claps palms_strike both_hands_on hands_high hands_ahead hands_on_hips arms_wide arms_crossed arms_down"
_GAITS = {
    "limps": "happens(limps({who}))",
    "skips": "happens(both(walks({who}, 0.6), hops({who}, 0.08)))",
    "crawls": "happens(both(low({who}), walks({who}, 0.4, 0.12)))",
}
"""Rules of gaits."""
_OF_THE_CLOCK = {"clockwise": "right", "counterclockwise": "left"}
"""Directions as seen from above, and those that a rule asks for."""
_TWO_HANDED = frozenset((*_OF_BOTH.split(), "holds_in_front"))
"""Predicates that hold of both hands or arms at once."""


def qualifiers(
    act: Act, entry: Entry, who: str, mask: str, said: str, *, to_other: bool = False
) -> Iterator[tuple[str, str]]:
    """Qualifiers of an act that no rule of its entry measures: each kind of qualifier, and a rule that does, or "".

    Args:
        act: told, and of this entry.
        entry: of the lexicon.
        who: one of its agents.
        mask: the predicate by which it is seen; "" where it has none.
        said: the act's own words in the sentence.
        to_other: they name the person to whom it is done.
    """
    rules = " ".join(entry.rule)
    names = set(re.findall(r"\w+", rules))
    caption = shown_caption(act, entry, said)
    words = said_words((caption,))
    goes = next((shape for shape in entry.stage if isinstance(shape, Go)), None)
    if act.times is not None and not names & {"n", "several"}:
        steps = goes and act.distance is not None
        yield ("how many steps", "") if steps else ("how often", _so_often(act, entry, who))
    if act.side in ("left", "right") and act.side != act.direction and not names & {"side", "hands"}:
        yield "which side", ""
    if act.part_side and not ("part" in names and has_sides(body_part(act))):
        yield "which side", _on_side(act, entry, who)
    both = _BOTH.search(said) if act.side == "both" else None
    if both and not names & {"side", "hands"} and "'both'" not in rules and not names & _TWO_HANDED:
        yield "on both sides" if both[1] in ("feet", "legs", "knees") else "with both hands", ""
    leaves = names & {"backs", "turns_away"} and act.direction in ("away", "back")  # "backs away"
    known = said_words((*entry.frames, *entry.caption))
    ways = {word for word in said_words((said,)) if vocabulary().directions.get(word) == act.direction}
    leaves = leaves or ("back" in ways and not goes and "{b}" in caption)  # "hits back": in return
    named = {word for word in known if vocabulary().directions.get(word) == act.direction}
    own = bool(named & (ways or named)) and act.direction in ("up", "down", "out")
    own = own or (act.direction == "away" and re.search(r"\boff\b", said) is not None)  # "takes off his shoes"
    if act.direction is not None and act.direction not in words and "way" not in names and not (own or leaves):
        yield "which way", _goes_way(act, who) if travels(entry) else ""
    if abs(act.speed - 1.0) > 0.3:  # who strolls walks
        yield "how fast", _at_speed(act.speed, goes, who, mask) if goes else ""
    if act.distance is not None:
        least, most = 0.65 * act.distance, 1.3 * act.distance + 0.3
        between = f"happens(both(near({most:.2f}), apart({least:.2f})), 0.5)"
        yield "how far", f"happens(goes_metres({who}, {least:.2f}, {most:.2f}))" if is_length(goes) else between
    if act.seconds is not None:
        yield "how long", ""
    if to_other and entry.to == "other" and mask and all(isinstance(shape, Gesture) for shape in entry.stage):
        yield "to whom", f"happens(both({mask}, faces({who}, 75)))"
    if FROM_BEHIND in act.manner:
        yield "from where", f"happens(both({mask}, behind({who})))" if mask else ""
    if ON_TIPTOE in act.manner:
        yield "in which manner", f"happens(both(heels_up({who}, 0.03), walks({who}, 0.3, 0.1)), 0.5)"
    for gait in GAITS.keys() & act.manner:
        yield "in which manner", _GAITS.get(gait, "").format(who=who)
    told = {FROM_BEHIND, ON_TIPTOE, *GAITS, *closed("fillers"), *vocabulary().speeds}
    if not told.issuperset(act.manner):
        yield "in which manner", ""
    own = act.part_of in act.agents and act.part == usual_limb(caption)  # who waves with a hand
    seen = {"part", vocabulary().part(act.part or "")} & names | {act.part, plural(act.part or "")} & words
    if act.part and not (own or seen or "{part}" in caption or "{limb}" in caption):
        yield "where on the body", ""


def is_length(goes: Go | None) -> bool:
    """True for a way that is so long; the two who take another, or none, are so far from each other."""
    return goes is not None and goes.way != "around"


def side_of(act: Act) -> str:
    """Where an act goes, as rules name it; "any" where its words leave that open."""
    way = _OF_THE_CLOCK.get(act.direction or "", act.direction)
    return way if way in ("forward", "back", "left", "right") else "any"


def travels(entry: Entry) -> bool:
    """True for an act by which somebody gets somewhere: a way over the floor or a jump."""
    return any(isinstance(s, Go) or (isinstance(s, Figure) and s.figure == "jumps") for s in entry.stage)


def plain(act: Act, kinds: frozenset[str]) -> Act:
    """An act without the qualifiers of these kinds."""
    left: dict[str, dict[str, object]] = {
        "how often": {"times": None},
        "how many steps": {"times": None},
        "which side": {"side": None, "part_side": None},
        "with both hands": {"side": None},
        "on both sides": {"side": None},
        "which way": {"direction": None, "side": None if act.side == act.direction else act.side},
        "how far": {"distance": None},
        "how fast": {"manner": (), "speed": 1.0},
        "in which manner": {"manner": ()},
        "from where": {"manner": ()},
    }
    return act.model_copy(update={name: value for kind in kinds for name, value in left.get(kind, {}).items()})


def _on_side(act: Act, entry: Entry, who: str) -> str:
    """A hand is on that side of the other's body, where it is an act of the hands; else ""."""
    by_hand = any(isinstance(shape, Touch) and shape.hands != "none" for shape in entry.stage)
    part = body_part(act)
    return f"happens(hand_on({who}, '{act.part_side} {part}', gap=0.25))" * (by_hand and has_sides(part))


def body_part(act: Act) -> str:
    """The part of the body that an act names, as rules name it; "" where it names none."""
    return next((name for name in (act.part or "", vocabulary().part(act.part or "")) if name in BODY), "")


def _so_often(act: Act, entry: Entry, who: str) -> str:
    """Whole turns around the other, or around oneself, where it is one of these; else ""."""
    times, way = act.times or 1, side_of(act)
    if any(isinstance(shape, Go) and shape.way == "around" for shape in entry.stage):
        return f"happens(orbits({who}, {360 * times - 90}, {way!r}))"
    turns = any(isinstance(shape, Turn) and shape.way == "around" for shape in entry.stage)
    return f"happens(revolves({who}, {times}, {way!r}))" * turns


def _goes_way(act: Act, who: str) -> str:
    ahead = {"forward": f"happens(goes_ahead({who}, 0.3))", "back": f"happens(backs({who}, 0.2))"}
    if act.direction in ("left", "right"):
        return f"happens(goes_way({who}, '{act.direction}'))"
    return ahead.get(act.direction or "", "")


def _at_speed(factor: float, goes: Go, who: str, mask: str) -> str:
    """Faster, or nowhere as fast, as half way between the usual speed and the one asked for, while the act is seen."""
    between = goes.speed * (1.0 + factor) / 2.0
    if factor > 1.0:
        return f"happens(walks({who}, 0.4, {between:.2f}))"
    slow = f"walks({who}, 0.7, {max(between, 0.6):.2f})"  # a single stride may be as fast
    return f"never(both({slow}, {mask}), 0.5)" if mask else f"never({slow})"
