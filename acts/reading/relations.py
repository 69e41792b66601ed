"""Relations in time of a text's acts, each to one that stands before it, beside it or above it in the syntax."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence, Set

from acts.frames import Event
from acts.lexicon import Lexicon, is_fixture
from acts.plan import Act, Relation
from acts.shapes import Figure, Gesture, Go, Hold, Lift, Place, Shape, Strike

BESIDE = frozenset(("gesture", "limb", "words"))
"""Shapes of what a person can do on their way."""
_ARRIVES = frozenset(("to", "behind", "beside", "back", "aside"))
_LASTS = frozenset(("around", "along", "after", "to and fro"))
"""Ways that go on for as long as one likes."""
_KINDS = ("after", "with", "while", "before", "until")
_FOR_THE_OTHER = {"main-after": "after", "main-until": "until"}
"""Joints that say where the act above stands: "as soon as he waves, she bows"."""


def related(
    told: Sequence[Act],
    events: Sequence[Event],
    of: Mapping[int, str],
    beside: Mapping[str, Relation],
    *,
    known: Lexicon,
    repeated: Collection[str],
) -> list[Act]:
    """The acts with their relations.

    Args:
        told: the acts in the order of the text.
        events: of the text.
        of: the id of the act that each event, by its number, has become.
        beside: the relations of acts that are no event's own.
        known: the lexicon of the acts.
        repeated: ids of acts that do again what the one before does.
    """
    number_of = {name: number for number, name in of.items()}
    relations: dict[str, list[Relation]] = {act.id: [] for act in told}
    acts = {act.id: act for act in told}
    ends = {relation.act: name for name, relation in beside.items() if relation.kind == "after"}  # of what is in turn
    for act in told:
        if act.id in beside:
            relations[act.id].append(beside[act.id])
            continue
        kind, above = _joint(number_of[act.id], events, of)
        if above is None or of[above] == act.id:
            continue
        other = acts[ends.get(of[above], of[above])]
        then, kind = kind == "then", "after" if kind == "then" else kind
        act = acts[act.id] = act.model_copy(update={"already": act.already and not then})
        if kind == "who":
            kind = "while" if _goes(other, _LASTS, known) else "after"
        if kind == "after" and (other.already or _waits(other, known)):
            talk = next((r.act for r in relations[other.id] if r.kind == "while"), None)
            # What follows "A talks while B waits" follows the talk.
            other = acts[_last_after(talk, act.id, told, relations, known)] if talk else other
        if other.id == act.id:  # two clauses that the parser hangs on each other
            continue
        if kind in ("conj", "comma"):
            in_turn = act.id in repeated or (kind == "comma" and not _people_of(other) & _people_of(act))
            kind = coordinated(other, act, known, repeats=in_turn)
        if kind == "after" and not then and _answers_blow(other, act, known):
            kind = "with"
        if kind == "after":
            act = acts[act.id] = _turned_to(other, act, known)
            if (carrier := _carrier(act, known)) and carrier == _carrier(other, known):
                on_back = other.act == "ride-back" and act.act == "carry"  # "jumps on his back, and he carries her"
                kind, act = "with", act.model_copy(update={"act": "carry-back" if on_back else act.act})
                acts[act.id] = act
            if _walks_on(other, act, known):
                kind, act = "with", act.model_copy(update={"act": "walk-ahead", "patient": None, "thing": None})
                acts[act.id] = act
        if _shares_load(other, act, known):
            act = acts[act.id] = act.model_copy(update={"act": "carry-thing", "patient": other.patient})
        stands, walks = (act, other) if _is_back_to_back(act, known) else (other, act)
        if _is_back_to_back(stands, known) and _goes(walks, {"along"}, known):  # and not side by side
            acts[walks.id] = walks.model_copy(update={"act": "part"})
            relations[walks.id].append(Relation(kind="after", act=stands.id))
            continue
        apart = not set(other.agents) & set(act.agents)
        waits = _waits(act, known) and not then  # "then she waits" is said of what comes next
        if kind == "after" and apart and (other.already or act.already or waits):
            kind = "while"  # what goes on, goes on
        if kind in _FOR_THE_OTHER:
            relations[other.id].append(Relation(kind=_FOR_THE_OTHER[kind], act=act.id))  # type: ignore[arg-type]
        else:
            relations[act.id].append(Relation(kind=kind if kind in _KINDS else "with", act=other.id))  # type: ignore[arg-type]
    for act in told:  # "walks up and hides when she turns": she turns when he is there
        after = [r for r in relations[act.id] if r.kind == "after"]
        for first in (r.act for r in after if not relations[r.act] and not acts[r.act].already):
            relations[first] = [r for r in after if int(r.act) < int(first)]
    return [acts[act.id].model_copy(update={"order": tuple(relations[act.id])}) for act in told]


def _joint(number: int, events: Sequence[Event], of: Mapping[int, str]) -> tuple[str, int | None]:
    """The joint of an event with the nearest above it that has become an act, and that one's number if there is one."""
    kind, above, seen = events[number].joint, events[number].beside, set[int]()
    while above is not None and above not in of and above not in seen:  # passed over
        seen.add(above)
        inner = (i for i in range(number) if i in of and events[i].beside == above and events[i].joint == "comp")
        if kind != "comp" and (told := next(inner, None)) is not None:  # "A pretends to throw, and B ducks"
            return kind, told
        kind = events[above].joint if kind in ("comp", "") else kind
        above = events[above].beside
    return kind, above if above in of else None


def kinds(stage: Sequence[Shape]) -> set[str]:
    """The kinds of some shapes, of which movements of a limb, the trunk or the head are "limb"."""
    return {"limb" if isinstance(shape, Figure) and shape.of_limb else shape.do for shape in stage}


def _goes(act: Act, ways: Set[str], known: Lexicon) -> bool:
    return any(isinstance(shape, Go) and shape.way in ways for shape in known.entries[act.act].stage)


def _is_back_to_back(act: Act, known: Lexicon) -> bool:
    return any(isinstance(shape, Place) and shape.way == "back to back" for shape in known.entries[act.act].stage)


def _shares_load(first: Act, then: Act, known: Lexicon) -> bool:
    """True for a person who carries what they have lifted with the other: "lifts it with her and carries it out"."""
    lifted = known.entries[first.act].thing == "carries" and first.patient is not None
    return lifted and (then.act, then.agents, then.thing) == ("carry-alone", first.agents, first.thing)


def _waits(act: Act, known: Lexicon) -> bool:
    return {shape.do for shape in known.entries[act.act].stage} == {"stay"}


def _last_after(
    first: str, until: str, told: Sequence[Act], relations: Mapping[str, Sequence[Relation]], known: Lexicon
) -> str:
    """The last of the acts that follow each other from ``first`` on, before the act ``until`` in the text."""
    for act in told:
        if act.id == until:
            break
        follows = any(r.kind == "after" and r.act == first for r in relations[act.id])
        first = act.id if follows and not _waits(act, known) else first
    return first


def _people_of(act: Act) -> set[str]:
    """The people who take part in an act."""
    return {*act.agents, act.patient} - {None}  # type: ignore[return-value]


def _turned_to(first: Act, then: Act, known: Lexicon) -> Act:
    """The act; a person who is touched and turns around turns to the one who touched them."""
    touched = first.patient in then.agents and any(s.do == "touch" for s in known.entries[first.act].stage)
    turns = any(s.do == "turn" and s.way == "around" for s in known.entries[then.act].stage)
    if not touched or not turns or then.patient or then.direction:
        return then
    return then.model_copy(update={"patient": first.agents[0]})


def _walks_on(first: Act, then: Act, known: Lexicon) -> bool:
    """True for a person who carries the other and walks, with them still in the arms or on the back."""
    leaves = then.direction == "away" or (_goes(then, {"away"}, known) and not (then.thing or then.direction))
    same = _carrier(first, known) == "".join(then.agents)
    return same and not leaves and _goes(then, {"past", "away", "ahead"}, known)


def _carrier(act: Act, known: Lexicon) -> str:
    """The person who has the other in the arms or on the back; "" for other acts."""
    lifts = (shape for shape in known.entries[act.act].stage if isinstance(shape, Lift) and shape.carry != "up")
    return next(((act.patient or "") if lift.who == "patient" else act.agents[0] for lift in lifts), "")


def _answers_blow(first: Act, then: Act, known: Lexicon) -> bool:
    """True where somebody ducks under a blow or blocks it, which is staged with the blow."""
    shapes = known.entries[first.act].stage
    strikes = any(isinstance(shape, Strike) and shape.bout in ("fists", "slaps", "weapons") for shape in shapes)
    return strikes and known.entries[then.act].answers and first.agents != then.agents


def coordinated(first: Act, then: Act, known: Lexicon, *, repeats: bool) -> str:
    """The relation of an act to one that stands before it and "and"."""
    if repeats:
        return "after"
    if _answers_blow(first, then, known):
        return "with"
    same = is_fixture(then.thing) and then.thing == first.thing  # "knocks at the door, and he opens it"
    answers = known.entries[then.act].answers or then.thing == "it" or same
    if answers and first.agents != then.agents:
        return "after"
    if first.patient in then.agents and _goes(then, {"away"}, known):
        return "after"  # "A slaps B and B runs away"
    if not _people_of(first) & _people_of(then):
        return "with"
    tugs = first.patient in then.agents and kinds(known.entries[then.act].stage) <= BESIDE
    if tugs and _is_hold(first, known):
        return "with"  # "A holds B's wrist, and B tugs"
    if first.agents == then.agents and (_accompanies(first, then, known) or _linked(first, then, known)):
        return "with"
    return "after"


def _linked(first: Act, then: Act, known: Lexicon) -> bool:
    """True if two people go on, spin or swing their arms hand in hand: "hold hands, walk"; so do arms that swing."""
    shapes = known.entries[then.act].stage
    goes = any(isinstance(s, Go | Hold) for s in shapes)
    if any(_swings(s) for s in known.entries[first.act].stage):
        return goes
    return _is_hold(first, known) and (goes or any(_swings(s) for s in shapes))


def _swings(shape: Shape) -> bool:
    return isinstance(shape, Gesture) and shape.gesture == "swings"


def _is_hold(act: Act, known: Lexicon) -> bool:
    return any(s.do == "link" for s in known.entries[act.act].stage)


def _accompanies(first: Act, then: Act, known: Lexicon) -> bool:
    """True for what a person does on their way or beside a gesture: "walks away and waves", "points and laughs"."""
    one, other = known.entries[first.act], known.entries[then.act]
    shown, later = kinds(one.stage), kinds(other.stage)
    if not first.happens or not then.happens or other.mutual or not later <= BESIDE:
        return False
    on_way = any(isinstance(shape, Go) and shape.way not in _ARRIVES for shape in one.stage)
    if is_fixture(first.thing) and then.thing == first.thing:
        return False  # "goes to the window and opens it"
    if on_way and other.thing in ("lifts", "takes", "puts", "opens", "closes"):
        return False  # "walks forward and picks up a cup"
    jumps = first.act.startswith("jump") and shown == {"figure"} and "gesture" in later
    free = not later & shown and shown <= BESIDE  # whoever points can still laugh with the trunk
    return on_way or jumps or first.already or (free and other.group == "feelings")
