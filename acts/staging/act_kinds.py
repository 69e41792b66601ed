"""Kinds of acts that the stage tells apart, and the roles of people in a beat: who strikes, stands by or gestures."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import get_args

from acts import shapes
from acts.lexicon import Entry, Lexicon, is_fixture
from acts.plan import Act, other_of
from acts.reading.vocabulary import vocabulary
from motion.skeleton import SIDES

from .figures import JUMPS, LIMBS
from .holds import COUPLE
from .score import LOW, Move, Strike, leaving

_NEAR = frozenset(("touch", "fight", "dance", "care"))
"""Groups of the lexicon whose acts two people do within each other's reach."""
_HANDED = frozenset(("things", "handling", "daily"))
"""Groups whose acts with the other person pass something from hand to hand."""
_GENTLE = frozenset(("care", "touch"))
"""Groups of acts that somebody lets be done to them."""
_BODILY = frozenset(("body", "ways", "moves", "stage"))
"""Groups of acts of the whole body."""
_OWN_ARMS = frozenset(("sneak", "stagger", "skip", "moonwalk", "strut", "stumble", "dive"))
"""Acts of which arms of their own are part."""
_HANDS_FREE = frozenset(("go", "turn", "stay", "place", "posture"))
"""Shapes that need no hands."""
_JOINS = frozenset(("touch", "hold", "link", "lift", "strike"))
"""Shapes that take the other along."""
_PARTS: Mapping[str, shapes.Part] = {
    **{part: part for part in get_args(shapes.Part) if part},
    "waist": "chest",
    "knee": "leg",
}
"""Families of parts of the body, and the part of each that hands are led to from the front."""
Done = Sequence[tuple[Act, Entry]]
"""Acts that happen, each with its entry of the lexicon."""
Blows = Sequence[tuple[tuple[str, ...], shapes.Strike, Act]]
"""Who strikes, how, and the act that says so."""


def hits(entry: Entry) -> bool:
    """True for a blow or a kick at the other."""
    return any(shape.do == "strike" or getattr(shape, "meets", False) for shape in entry.stage)


def is_attempt(act: Act, entry: Entry) -> bool:
    """True for a blow or a push that is only tried: it is struck past the other, or they push against each other."""
    tried = act.polarity == "done" and act.modality == "tried"
    return tried and any(shape.do in ("strike", "hold") for shape in entry.stage)


def only_stays(entry: Entry) -> bool:
    """True for an act of a bystander."""
    shown = {shape.do for shape in entry.stage}
    return "stay" in shown and shown <= {"stay", "place"}


def leaves_hands(act: Act, entry: Entry) -> bool:
    """True for an act of the whole body, with nothing in the hands, that leaves them free."""
    bodily = entry.group in _BODILY and act.act not in _OWN_ARMS and act.part is None
    free = act.thing is None or is_fixture(act.thing)
    return bodily and free and bool(entry.stage) and all(shape.do in _HANDS_FREE for shape in entry.stage)


def walks(entry: Entry) -> bool:
    """True for an act that goes over the floor."""
    return any(shape.do == "go" for shape in entry.stage)


def is_near(act: Act, entry: Entry) -> bool:
    """True for an act that two people do within each other's reach."""
    handed = entry.group in _HANDED and (act.patient is not None or entry.mutual) and not walks(entry)
    return handed or (entry.group in _NEAR and reaches(act, entry))


def reaches(act: Act, entry: Entry) -> bool:
    """True for an act that the other takes part in: it touches, holds, lifts or strikes them, or needs an answer.

    So does what is done to them without anybody's going anywhere, also where nothing is given of it.
    """
    if len(act.agents) == 1 and act.patient is None and any(getattr(s, "hold", "") == COUPLE for s in entry.stage):
        return False  # they dance with nobody
    if entry.mutual or any(shape.who != "agent" or shape.do in _JOINS for shape in entry.stage):
        return True
    return act.patient is not None and all(shape.do in ("place", "stay") for shape in entry.stage)


def is_care(entry: Entry) -> bool:
    """True for an act by the hands on the other, who keeps still meanwhile."""
    touches = [shape for shape in entry.stage if isinstance(shape, shapes.Touch) and not shape.fells]
    return entry.group in _GENTLE and not entry.mutual and 0 < len(touches) == len(entry.stage)


def part_of(act: Act, shape: shapes.Touch) -> shapes.Part:
    """The part of the other's body that an act touches; "" for a part that no hand is led to."""
    named = vocabulary().part(act.part or "") or (act.part or "")
    family = named if act.part_of == act.patient and named in _PARTS else shape.part or named
    return "waist" if family == "waist" and shape.behind else _PARTS.get(family or "shoulder", "")


def reaches_low(act: Act, entry: Entry) -> bool:
    """True for an act that touches the other's legs or feet."""
    return any(isinstance(shape, shapes.Touch) and part_of(act, shape) in LOW for shape in entry.stage)


def is_manner(entry: Entry) -> bool:
    """True for moving in unison, in canon or as the other does: another act's manner, or else a phrase of a dance."""
    return any(getattr(shape, "figure", "") == "dances" for shape in entry.stage)


def figure_of(act: Act, shape: shapes.Figure) -> shapes.Figure:
    """The figure of an act: as often, as deep, on the side and in the direction that its words say."""
    if shape.figure == "bows" and any(adverb in ("deeply", "low", "deep") for adverb in act.manner):
        shape = shape.model_copy(update={"figure": "bows deeply"})
    side, direction = act.side or "", act.direction or shape.direction
    aside = direction in (*SIDES, "out")
    ways = (direction, "aside" if aside or side in SIDES else "", "out" if aside else "")
    name = next((each for way in ways if (each := f"{shape.figure} {way}") in LIMBS), shape.figure)
    left = "left" in (direction if name.endswith("aside") and direction in SIDES else side)
    times = act.times or (0 if act.already and shape.figure == JUMPS else shape.times)
    return shape.model_copy(update={"figure": name, "times": times, "mirrored": shape.mirrored ^ left, "direction": ""})


def strike_of(blows: Blows, done: Done, *, late: bool) -> Strike | None:
    """The blows of a beat, in the order of the words; None where there are none.

    Args:
        blows: of the beat.
        done: all that is done in it.
        late: the first blow comes after what somebody does until then.
    """
    if not blows:
        return None
    people, shape, act = blows[0]
    bout = shape.bout
    if len(people) == 2:
        return Strike(bout, "ab")
    counted = any(each.times for _, _, each in blows)
    turns = "".join(who[0] * min(each.times or 1, 5) for who, _, each in blows)
    if len(blows) > 1 and not counted:
        turns = "".join(dict.fromkeys(turns))
    hit = other_of(people[0])
    answered = any(hit in other.agents and shape.do in ("posture", "go") for other, e in done for shape in e.stage)
    fight = len(blows) > 1 and not (counted or answered) and bout != "throws"
    hands = tuple(each.side or "" for _, _, each in blows for _ in range(min(each.times or 1, 5)))
    if len(set(turns)) == 1 and any(hand in SIDES for hand in hands):  # "two jabs with the left and a cross"
        return Strike(bout, turns[0] * len(hands), False, answered, late, hands)
    return Strike(bout, turns, shape.goes_on or fight, answered, late, up=act.direction == "up")


def standing_by(acts: Sequence[Act], done: Done, busy: Collection[str], known: Lexicon) -> frozenset[str]:
    """The people who stand by: nothing is told that they do, while the other does something alone.

    Args:
        acts: of the beat.
        done: those that happen.
        busy: who gestures, goes somewhere or stands before something.
        known: the lexicon.
    """
    people = set()
    for who in {*"ab"} - {*busy}:
        own = [(act, e) for act, e in done if who in act.agents]
        theirs = [(act, e) for act, e in done if other_of(who) in act.agents and who not in act.agents]
        refused = [known.entries.get(act.act) for act in acts if who in act.agents and not act.happens]
        denied = any(entry is None or not only_stays(entry) for entry in refused)
        waits = bool(own) and all(only_stays(e) for _, e in own)
        touched = any(reaches(act, e) and not is_care(e) and act.direction != "up" for act, e in theirs)
        if touched or (own and not waits):
            continue
        if waits or denied or any(not walks(e) for _, e in theirs):
            people.add(who)
    return frozenset(people)


def loose(done: Done, idle: Collection[str]) -> frozenset[str]:
    """The people whose hands have nothing to do, and whom the other does not touch."""
    people = set()
    for who in "ab":
        own = [(act, e) for act, e in done if who in act.agents]
        touched = any(reaches(act, e) for act, e in done if who not in act.agents)
        free = who in idle or all(leaves_hands(act, e) for act, e in own)
        if free and not touched:
            people.add(who)
    return frozenset(people)


def gesturing(gestures: Mapping[str, shapes.Gesture], moves: Sequence[Move], done: Done) -> frozenset[str]:
    """The people who gesture on the spot and do nothing else."""
    gone = leaving(moves)
    own = {who: sum(who in act.agents and not only_stays(e) for act, e in done) for who in "ab"}
    return frozenset(who for who in gestures if own[who] < 2 and who not in gone)
