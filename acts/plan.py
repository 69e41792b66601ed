"""The plan of a scene: what two people do, to whom, in which order, and what of a text was not understood.

A plan is what is shown, edited, stored with a result and sent over the API; reopening a result takes its plan and
never reads the words again. ``Plan.model_json_schema()`` is the contract.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError, model_validator

from motion import InputError

Who = Literal["a", "b"]
Side = Literal["left", "right", "both"]
Name = Annotated[str, StringConstraints(max_length=60)]
Text = Annotated[str, StringConstraints(max_length=2000)]

MOST_ACTS = 60
"""Acts of a plan, at most: what sixty beats of one act each need."""
FROM_BEHIND = "from behind"
"""Manner of an act that is done to the other from behind them."""
ON_TIPTOE = "on tiptoe"
"""The manner of going somewhere without a sound."""
GAITS = {"limps": "limp", "skips": "skip", "crawls": "crawl", "staggers": "stagger"}
"""Manners of going, and the verb of each."""


def other_of(who: str | None) -> str:
    """The other of two people; "" for both."""
    return {"a": "b", "b": "a"}.get(who or "", "")


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Span(_Model):
    """A part of the text, as character offsets ``start`` (first) and ``stop`` (behind the last)."""

    start: Annotated[int, Field(ge=0)]
    stop: Annotated[int, Field(ge=0)]


class Person(_Model):
    """One of the two people.

    Attributes:
        id: "a" is the person named first.
        words: how the text calls them.
        sex: "m" or "f" where the words say so.
        age: "child" or "old" where the words say so.
    """

    id: Who
    words: tuple[Name, ...] = ()
    sex: Literal["", "m", "f"] = ""
    age: Literal["", "child", "old"] = ""


class Relation(_Model):
    """The place of an act in time beside another: after it, with it, while it goes on, until it, or before it."""

    kind: Literal["after", "with", "while", "until", "before"]
    act: Annotated[str, StringConstraints(max_length=8)]


class Act(_Model):
    """One act of one person or of both.

    Attributes:
        id: unique in its plan.
        act: name of the entry in the lexicon.
        agents: the people who do it.
        patient: the person to whom it is done, if it is done to one.
        thing: the object that it is done with, as a noun.
        part: the part of the body that it is about, and ``part_of`` whose it is.
        polarity: "not" for what is said not to happen.
        modality: only what is told happens; an attempt, an offer, a pretence and a wish have shapes of their own.
        order: relations to other acts.
        already: it goes on when its beat begins, as "is sitting" and "keeps walking" say; others begin in it.
        seconds: length in seconds, where the words give one.
        side: of the agent's body, or of the turn.
        part_side: of a part of the other's body, as in "B's left shoulder".
        times: how often, where the words give a number.
        manner: adverbs, in the text's order.
        speed: factor beside the act's usual speed.
        direction: where it goes: "forward", "back", "left", "right", "up", "down", "clockwise", ….
        distance: metres, where the words give any.
        words: where it stands in the text; None if a person added it.
    """

    id: Annotated[str, StringConstraints(min_length=1, max_length=8)]
    act: Name
    agents: Annotated[tuple[Who, ...], Field(min_length=1, max_length=2)]
    patient: Who | None = None
    thing: Name | None = None
    part: Name | None = None
    part_of: Who | None = None
    part_side: Literal["left", "right"] | None = None
    polarity: Literal["done", "not"] = "done"
    modality: Literal["told", "tried", "offered", "pretended", "wished"] = "told"
    order: Annotated[tuple[Relation, ...], Field(max_length=8)] = ()
    already: bool = False
    seconds: Annotated[float, Field(gt=0, le=600)] | None = None
    side: Side | None = None
    times: Annotated[int, Field(ge=1, le=100)] | None = None
    manner: Annotated[tuple[Name, ...], Field(max_length=8)] = ()
    speed: Annotated[float, Field(gt=0, le=10)] = 1.0
    direction: Name | None = None
    distance: Annotated[float, Field(ge=0, le=100)] | None = None
    words: Span | None = None

    @model_validator(mode="after")
    def _check(self) -> Act:
        if len(set(self.agents)) != len(self.agents):
            raise ValueError("name each agent once")
        if self.patient is not None and self.patient in self.agents:
            raise ValueError("the patient must not be an agent: use {self} entries for what people do to themselves")
        return self

    @property
    def happens(self) -> bool:
        """True if the act is told and not denied."""
        return self.polarity == "done" and self.modality == "told"


class Unread(_Model):
    """Words that were not understood.

    Attributes:
        words: where they stand in the text.
        why: one sentence.
        nearest: names of acts that come nearest, the best first.
    """

    words: Span
    why: Text
    nearest: Annotated[tuple[Name, ...], Field(max_length=8)] = ()


class Plan(_Model):
    """The plan of what two people do.

    Attributes:
        sentence: the text that was read; "" for a plan written by hand.
        people: a and b.
        things: nouns of the objects that take part.
        acts: in the order of the text.
        unread: what was not understood.
        doubts: what another parse of the text takes for another act, with the names of what it would be.
        notes: sentences on the text as a whole, such as its language.
        reader: who read the text, "lexicon", or wrote the plan, "hand" or "corpus".
    """

    sentence: Text = ""
    people: tuple[Person, Person] = (Person(id="a"), Person(id="b"))
    things: Annotated[tuple[Name, ...], Field(max_length=20)] = ()
    acts: Annotated[tuple[Act, ...], Field(max_length=MOST_ACTS)] = ()
    unread: Annotated[tuple[Unread, ...], Field(max_length=60)] = ()
    doubts: Annotated[tuple[Unread, ...], Field(max_length=8)] = ()
    notes: Annotated[tuple[Text, ...], Field(max_length=20)] = ()
    reader: Name = "lexicon"

    @model_validator(mode="after")
    def _check(self) -> Plan:
        ids = [act.id for act in self.acts]
        if len(set(ids)) != len(ids):
            raise ValueError("two acts have the same id")
        for act in self.acts:
            for relation in act.order:
                if relation.act not in ids or relation.act == act.id:
                    raise ValueError(f"act {act.id} is ordered beside {relation.act}, which is no other act")
        if [person.id for person in self.people] != ["a", "b"]:
            raise ValueError("people are a and b, in this order")
        return self

    def text(self, span: Span | None) -> str:
        """The words of a span; "" for none."""
        return self.sentence[span.start : span.stop] if span is not None else ""

    def beats(self) -> list[list[Act]]:
        """The acts in groups that happen one after another, each group at the same time; see :func:`beats`."""
        return beats(self.acts)


PlanFrames = tuple[Plan, int, int | None, int | None]
"""A plan, its first and last frame (None for the end), and the number of its beat, where there are several."""


def plan_of(values: Any) -> Plan:
    """A plan from JSON; a plan stays as it is.

    Raises:
        InputError: for anything else, with a sentence on the first thing that is wrong.
    """
    if isinstance(values, Plan):
        return values
    try:
        return Plan.model_validate(values)
    except ValidationError as error:
        raise InputError(f"This is not a plan of acts: {problem(error)}") from None


def problem(error: ValidationError) -> str:
    """The first thing that is wrong, as "acts.0.agents: Field required."."""
    first = error.errors()[0]
    where = ".".join(str(part) for part in first["loc"])
    said = first["msg"].removeprefix("Value error, ").rstrip(".")
    known = first.get("ctx", {})
    if expected := known.get("expected_tags") or known.get("expected"):
        said = f"{known.get('tag', first['input'])!r:.60} is not known: use one of {expected}"
    return f"{where}: {said}." if where else f"{said[:1].upper()}{said[1:]}."


def beats(acts: Sequence[Act]) -> list[list[Act]]:
    """Acts in groups that happen one after another, each group at the same time.

    An act that is "after" others comes a group later than the last of them, one that is "before" another or goes on
    "until" another pushes that one back, and one "with" or "while" another shares its group. Contradictory orders are
    broken in the order of the text, relations to acts that are not there are passed over, and every act appears
    exactly once.
    """
    level = {act.id: 0 for act in acts}
    listed = [each for each in _relations(acts) if each[0] in level and each[2] in level]
    for _ in range(len(acts)):
        moved = False
        for later, kind, other in listed:
            least = level[other] + (kind == "after")
            if level[later] < least < len(acts) + 1:
                level[later], moved = least, True
        if not moved:
            break
    groups: dict[int, list[Act]] = {}
    for act in acts:
        groups.setdefault(level[act.id], []).append(act)
    return [groups[key] for key in sorted(groups)]


def merged(spans: Iterable[tuple[int, int]], text: str) -> list[tuple[int, int]]:
    """Spans (start, stop) of a text in order, of which those that overlap or touch are one."""
    joined: list[tuple[int, int]] = []
    for start, stop in sorted(spans):
        if joined and (start <= joined[-1][1] or not text[joined[-1][1] : start].strip()):
            joined[-1] = joined[-1][0], max(joined[-1][1], stop)
        else:
            joined.append((start, stop))
    return joined


def _relations(acts: Sequence[Act]) -> Iterator[tuple[str, str, str]]:
    """Each relation as (later or equal act, kind, other act)."""
    for act in acts:
        for relation in act.order:
            if relation.kind in ("before", "until"):
                yield relation.act, "after", act.id
            elif relation.kind == "after":
                yield act.id, "after", relation.act
            else:
                yield act.id, "with", relation.act
                yield relation.act, "with", act.id
