"""The shapes of which an act's score is made: few, typed, and the same in the lexicon, in a plan and over the API.

Each shape is a table with a ``do`` in the lexicon's TOML, as ``{do = "go", way = "to", near = 0.6}``. ``who`` says
which of the act's people it is for: its agents, its patient, both people, or the first of two agents, whose patient
is then the second.
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field
from pydantic_core.core_schema import CoreSchema, literal_schema

Metres = Annotated[float, Field(ge=0, le=20)]
Part = Literal["", "head", "shoulder", "back", "chest", "waist", "arm", "hand", "leg", "foot"]
Way = Literal[
    "to", "away", "past", "around", "behind", "beside", "along", "after", "back", "aside", "ahead", "to and fro"
]

_RECORDED = ("bows", "bows deeply", "dances", "shadow-boxes")
"""Figures that people were recorded in."""


class _Named:
    """One of the names of a file of ``acts/staging``, or of its ``tables``, and of ``more``."""

    def __init__(self, file: str, *more: str, tables: Sequence[str] = ()) -> None:
        named = tomllib.loads((Path(__file__).parent / "staging" / f"{file}.toml").read_text(encoding="utf-8"))
        self.names = [*chain(*([named[table] for table in tables] or [named])), *more]

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return literal_schema(self.names)


_LIMBS = frozenset(_Named("figures", tables=("limbs",)).names)


class _Shape(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)
    who: Literal["agent", "patient", "both", "first"] = "agent"


class Go(_Shape):
    """A way over the floor.

    Attributes:
        way: relative to the other person, or to where one stands.
        speed: metres per second.
        turns: whole turns of a way around the other.
        metres: length of a way ahead or to and fro; 0 for the usual one.
        near: metres between the two pelvises at its end; 0 leaves that to the network.
        backwards: with the face towards where one comes from.
        linked: the two hold each other by the hands or arms.
        stops: it ends early, before what comes next.
        gait: of a person who goes low over the floor, limps, skips, or walks on tiptoe.
    """

    do: Literal["go"] = "go"
    way: Way
    speed: Annotated[float, Field(gt=0, le=4)] = 1.1
    turns: Annotated[float, Field(gt=0, le=5)] = 0.5
    metres: Metres = 0.0
    near: Metres = 0.0
    backwards: bool = False
    linked: bool = False
    stops: bool = False
    gait: Literal["", "crawls", "on the knees", "limps", "on tiptoe", "skips"] = ""


class Turn(_Shape):
    """A turn on the spot: ``to`` the other, ``away`` from them, or ``around`` by so many whole turns."""

    do: Literal["turn"] = "turn"
    way: Literal["around", "to", "away"] = "around"
    turns: Annotated[float, Field(gt=0, le=5)] = 0.5


class Stay(_Shape):
    """Standing by: in place, with the back ``averted`` from the other, or ``frozen`` without any movement."""

    do: Literal["stay"] = "stay"
    averted: bool = False
    frozen: bool = False


class Place(_Shape):
    """The place of the two when a story begins with the act: ``apart`` metres, beside each other, one behind, …."""

    do: Literal["place"] = "place"
    way: Literal["facing", "beside", "back to back", "behind"] = "facing"
    apart: Metres = 0.0


class Posture(_Shape):
    """A way to hold oneself from then on.

    Attributes:
        posture: by its name in ``acts/staging/figures.toml``.
        already: from the start.
        passing: only for a moment, ``times`` over.
        gently: somebody lets themselves down on the floor, and does not fall.
    """

    do: Literal["posture"] = "posture"
    posture: Annotated[str, _Named("figures", tables=("postures",))]
    already: bool = False
    passing: bool = False
    times: Annotated[int, Field(ge=1, le=5)] = 1
    gently: bool = False


class Gesture(_Shape):
    """A gesture of the hands, by its name in :data:`acts.staging.gestures.GESTURES`.

    Attributes:
        times: how many strokes; 0 for as long as the beat lasts.
        late: seconds after which it begins, of a person who answers the other.
    """

    do: Literal["gesture"] = "gesture"
    gesture: Annotated[str, _Named("gestures")]
    sides: Literal["left", "right", "both"] = "right"
    times: Annotated[int, Field(ge=0, le=20)] = 0
    late: Annotated[float, Field(ge=0, le=3)] = 0.0


class Touch(_Shape):
    """Hands on a part of the other's body.

    Attributes:
        part: family of the part; "" for the part that the words name.
        hands: which; "none" for a kiss, which the head gives.
        times: how often a short touch is made; 0 for a hand that stays.
        behind: from behind the other.
        beside: from beside the other, who looks the same way: an arm around them, or a head on their shoulder.
        fells: the other falls from it.
    """

    do: Literal["touch"] = "touch"
    part: Part = ""
    hands: Literal["left", "right", "both", "none"] = "right"
    times: Annotated[int, Field(ge=0, le=20)] = 0
    behind: bool = False
    beside: bool = False
    fells: bool = False


class Hold(_Shape):
    """Both in a hold while they go round: "closed" as in a waltz, a "ring" with both hands joined, or a "twirl".

    Two whose "palms" are against each other's lean in and stay where they are, as those in an "embrace" do; a "couple"
    dances as recorded ones do.
    """

    do: Literal["hold"] = "hold"
    hold: Literal["closed", "ring", "twirl", "palms", "embrace", "couple"]


class Link(_Shape):
    """The two hold each other by the hand, also while they walk."""

    do: Literal["link"] = "link"


class Pull(_Shape):
    """The agent comes to the patient and pulls them up by the hand."""

    do: Literal["pull"] = "pull"


class Lift(_Shape):
    """The agent holds the patient off the floor: "up", in the "arms", on the "back", or "drags" them."""

    do: Literal["lift"] = "lift"
    carry: Literal["up", "arms", "back", "drags"]
    spins: bool = False


class Strike(_Shape):
    """Blows or throws at the distance they need: with fists, flat hands, weapons or rackets, or something thrown."""

    do: Literal["strike"] = "strike"
    bout: Literal["fists", "slaps", "weapons", "rackets", "throws"]
    goes_on: bool = False


class Figure(_Shape):
    """What a body does on the spot, by its name in ``acts/staging/figures.toml``, or as it was recorded.

    Attributes:
        figure: which one. Of a leg, the trunk or the head, it is the one that fits the act's direction.
        times: how often its middle is done where the words give no number; 0 for as long as there is time.
        direction: of a leg, the trunk or the head, where the words name none.
        mirrored: left and right are exchanged.
        meets: it is done to the other, who stands within its reach: the two do not move apart for it.
        late, early: seconds after which it begins, of a person who follows the other, and before the end of the beat
            that it ends, of the one who is followed.
        in_time: two people who do it, do it as one.
    """

    do: Literal["figure"] = "figure"
    figure: Annotated[str, _Named("figures", *_RECORDED, tables=("figures", "limbs"))]
    times: Annotated[int, Field(ge=0, le=20)] = 0
    direction: Literal["", "up", "back", "left", "right"] = ""
    mirrored: bool = False
    meets: bool = False
    late: Annotated[float, Field(ge=0, le=3)] = 0.0
    early: Annotated[float, Field(ge=0, le=3)] = 0.0
    in_time: bool = False

    @property
    def of_limb(self) -> bool:
        """True for a movement of a leg, the trunk or the head, beside which hands are free."""
        return self.figure in _LIMBS


_OnTheFloor = Go | Turn | Stay | Place
_OfOneself = Posture | Gesture | Figure
_WithTheOther = Touch | Hold | Link | Pull | Lift | Strike
Shape = Annotated[_OnTheFloor | _OfOneself | _WithTheOther, Field(discriminator="do")]
