"""Kinds of acts that the stage tells apart, by what they say and by the shapes of their entries."""

from __future__ import annotations

from acts import shapes
from acts.lexicon import Entry
from acts.plan import Act
from acts.reading.vocabulary import vocabulary
from acts.things import is_fixture

from .bodies.figures import Figure
from .contacts import LOW, Region

_NEAR = frozenset(("touch", "fight", "dance", "care"))
"""Groups of the lexicon whose acts two people do within each other's reach."""
_HANDED = frozenset(("things", "handling", "daily"))
"""Groups whose acts with the other person pass something from hand to hand."""
_GENTLE = frozenset(("care", "touch"))
"""Groups of acts that somebody lets be done to them."""
_BODILY = frozenset(("body", "ways", "moves", "stage"))
"""Groups of acts of the whole body."""
_OWN_ARMS = frozenset(("creep-up", "sneak", "sneak-away", "stagger", "skip", "moonwalk", "strut", "stumble", "dive"))
"""Acts of which arms of their own are part."""
_LAYS = frozenset(("lie-down", "sit-ups", "sit-on-floor"))
"""Acts of people who let themselves down on the floor."""
_HANDS_FREE = frozenset(("go", "turn", "stay", "place", "posture", "jump", "bow"))
"""Shapes that need no hands."""
_JOINS = frozenset(("touch", "hold", "link", "lift", "strike"))
"""Shapes that take the other along."""
_REGIONS = {
    "head": Region.HEAD,
    "shoulder": Region.SHOULDER,
    "back": Region.BACK,
    "chest": Region.CHEST,
    "waist": Region.CHEST,
    "arm": Region.ARM,
    "hand": Region.HAND,
    "leg": Region.LEG,
    "knee": Region.LEG,
    "foot": Region.FOOT,
}
"""Families of parts of the body and the region of each."""


def hits(entry: Entry) -> bool:
    """True for a blow or a kick at the other."""
    return any(shape.do == "strike" or getattr(shape, "meets", False) for shape in entry.stage)


def is_attempt(act: Act, entry: Entry) -> bool:
    """True for a blow or a push that is only tried: it is struck past the other, or they push against each other."""
    tried = act.polarity == "done" and act.modality == "tried"
    return tried and any(shape.do in ("strike", "hold") for shape in entry.stage)


def is_deep(act: Act) -> bool:
    """True for an act that is done deeply, such as a low bow."""
    return any(adverb in ("deeply", "low", "deep") for adverb in act.manner)


def only_stays(entry: Entry) -> bool:
    """True for an act of a bystander."""
    shown = {shape.do for shape in entry.stage}
    return "stay" in shown and shown <= {"stay", "place"}


def is_gentle(act: Act) -> bool:
    """True for an act that takes a person down to the floor on purpose: no fall."""
    return act.act in _LAYS


def leaves_hands(act: Act, entry: Entry) -> bool:
    """True for an act of the whole body, with nothing in the hands, that leaves them free."""
    bodily = entry.group in _BODILY and act.act not in _OWN_ARMS and act.part is None
    free = act.thing is None or is_fixture(act.thing)
    return bodily and free and bool(entry.stage) and all(shape.do in _HANDS_FREE for shape in entry.stage)


def walks(entry: Entry) -> bool:
    """True for an act that goes over the floor."""
    return any(shape.do == "go" for shape in entry.stage)


def is_after(shape: shapes.Shape) -> bool:
    """True for a way after the other person."""
    return isinstance(shape, shapes.Go) and shape.way == "after"


def is_near(act: Act, entry: Entry) -> bool:
    """True for an act that two people do within each other's reach."""
    handed = entry.group in _HANDED and (act.patient is not None or entry.mutual) and not walks(entry)
    return handed or (entry.group in _NEAR and reaches(act, entry))


def reaches(act: Act, entry: Entry) -> bool:
    """True for an act that the other takes part in: it touches, holds, lifts or strikes them, or needs an answer."""
    if entry.mutual or any(shape.who != "agent" or shape.do in _JOINS for shape in entry.stage):
        return True
    return act.patient is not None and all(shape.do in ("place", "stay") for shape in entry.stage)


def is_care(entry: Entry) -> bool:
    """True for an act by the hands on the other, who keeps still meanwhile."""
    touches = [shape for shape in entry.stage if isinstance(shape, shapes.Touch) and not shape.fells]
    return entry.group in _GENTLE and not entry.mutual and 0 < len(touches) == len(entry.stage)


def region_of(act: Act, shape: shapes.Touch) -> Region | None:
    """The part of the other's body that an act touches; None for a part that no hand is led to."""
    named = vocabulary().part(act.part or "") or (act.part or "")
    family = named if act.part_of == act.patient and named in _REGIONS else shape.part or named
    return Region.WAIST if family == "waist" and shape.behind else _REGIONS.get(family or "shoulder")


def reaches_low(act: Act, entry: Entry) -> bool:
    """True for an act that touches the other's legs or feet."""
    return any(isinstance(shape, shapes.Touch) and region_of(act, shape) in LOW for shape in entry.stage)


def is_manner(entry: Entry) -> bool:
    """True for moving in unison, in canon or as the other does: another act's manner, or else a phrase of a dance."""
    return any(getattr(shape, "figure", "") == "phrase" for shape in entry.stage)


def figure_of(act: Act, shape: shapes.Figure) -> Figure:
    """The figure of an act: as often as its words say, and with the other leg where they name the left one."""
    mirrored = shape.mirrored ^ (act.side == "left")
    times = act.times or shape.times
    return Figure(shape.figure, times, mirrored, shape.meets, shape.late, shape.early, shape.in_time)
