"""The order of acts that stand side by side in a text: one after the other, or at once."""

from __future__ import annotations

from acts.lexicon import Lexicon
from acts.plan import Act
from acts.shapes import Go, Strike

BESIDE = frozenset(("gesture", "limb", "words"))
"""Shapes of what a person can do on their way."""
_ARRIVES = frozenset(("to", "behind", "back", "aside"))


def people_of(act: Act) -> set[str]:
    """The people who take part in an act."""
    return {*act.agents, act.patient} - {None}  # type: ignore[return-value]


def turned_to(first: Act, then: Act, known: Lexicon) -> Act:
    """The act; a person who is touched and turns around turns to the one who touched them."""
    touched = first.patient in then.agents and any(s.do == "touch" for s in known.entries[first.act].stage)
    turns = any(s.do == "turn" and s.way == "around" for s in known.entries[then.act].stage)
    if not touched or not turns or then.patient or then.direction:
        return then
    return then.model_copy(update={"patient": first.agents[0]})


def answers_blow(first: Act, then: Act, known: Lexicon) -> bool:
    """True for who ducks under a blow or blocks it, which is staged with the blow."""
    shapes = known.entries[first.act].stage
    strikes = any(isinstance(shape, Strike) and shape.bout in ("fists", "weapons") for shape in shapes)
    return strikes and known.entries[then.act].answers and first.agents != then.agents


def coordinated(first: Act, then: Act, known: Lexicon, *, repeats: bool) -> str:
    """The relation of an act to one that stands before it and "and"."""
    if repeats:
        return "after"
    if answers_blow(first, then, known):
        return "with"
    answers = known.entries[then.act].answers or then.thing == "it"  # "knocks at the door, and he opens it"
    if answers and first.agents != then.agents:
        return "after"
    if not people_of(first) & people_of(then):
        return "with"
    if first.agents == then.agents and (_accompanies(first, then, known) or _linked(first, then, known)):
        return "with"
    return "after"


def _linked(first: Act, then: Act, known: Lexicon) -> bool:
    """True if two people go on hand in hand: "hold hands, walk"."""
    held = any(s.do == "link" for s in known.entries[first.act].stage)
    return held and any(isinstance(s, Go) for s in known.entries[then.act].stage)


def _accompanies(first: Act, then: Act, known: Lexicon) -> bool:
    """True for what a person does on their way or beside a gesture: "walks away and waves", "points and laughs"."""
    one, other = known.entries[first.act], known.entries[then.act]
    shown, later = {shape.do for shape in one.stage}, {shape.do for shape in other.stage}
    if not first.happens or not then.happens or other.mutual or not later <= BESIDE:
        return False
    on_way = any(isinstance(shape, Go) and shape.way not in _ARRIVES for shape in one.stage)
    jumps = shown == {"jump"} and "gesture" in later
    return on_way or jumps or first.already or (not later and shown <= BESIDE and other.group == "feelings")
