"""The shapes of which an act's score is made: few, typed, and the same in the lexicon, in a plan and over the API.

Each shape is a table with a ``do`` in the lexicon's TOML, as ``{do = "go", way = "to", near = 0.6}``. ``who`` says
which of the act's people it is for: its agents, its patient, both people, or the first of two agents, whose patient
is then the second.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field
from pydantic_core.core_schema import CoreSchema, literal_schema

Metres = Annotated[float, Field(ge=0, le=20)]
Part = Literal["", "head", "shoulder", "back", "chest", "waist", "arm", "hand", "leg", "foot"]
Way = Literal[
    "to", "away", "past", "around", "behind", "beside", "along", "after", "back", "aside", "ahead", "to and fro"
]


class _Named:
    """One of the names of a file of ``acts/staging``, or of its table, and of ``more``."""

    def __init__(self, file: str, *more: str, table: str = "") -> None:
        names = tomllib.loads((Path(__file__).parent / "staging" / f"{file}.toml").read_text(encoding="utf-8"))
        self.names = [*(names[table] if table else names), *more]

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return literal_schema(self.names)


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
    """Standing by: in place, facing the other, or with the back to them; ``frozen`` without any movement.

    Where a story begins with it, the two are ``apart`` metres from each other; 0 leaves that free.
    """

    do: Literal["stay"] = "stay"
    apart: Metres = 0.0
    facing: Literal["", "other", "away"] = ""
    frozen: bool = False


class Place(_Shape):
    """The place of the two when a story begins with the act: ``apart`` metres, beside each other, one behind, …."""

    do: Literal["place"] = "place"
    way: Literal["facing", "beside", "back to back", "behind"] = "facing"
    apart: Metres = 0.0


class Posture(_Shape):
    """A way to hold oneself from then on.

    Attributes:
        posture: which.
        already: from the start.
        passing: only for a moment, ``times`` over.
        gently: somebody lets themselves down on the floor, and does not fall.
    """

    do: Literal["posture"] = "posture"
    posture: Literal["stands", "sits", "kneels", "sits on the ground", "crouches", "bends down", "lies", "on all fours"]
    already: bool = False
    passing: bool = False
    times: Annotated[int, Field(ge=1, le=5)] = 1
    gently: bool = False


class Jump(_Shape):
    """Jumps on the spot, so many where the words give no number."""

    do: Literal["jump"] = "jump"
    times: Annotated[int, Field(ge=1, le=5)] = 1


class Gesture(_Shape):
    """A gesture of the hands, by its name in :data:`acts.staging.gestures.GESTURES`.

    Attributes:
        times: how many strokes; 0 for as long as the beat lasts.
    """

    do: Literal["gesture"] = "gesture"
    gesture: Annotated[str, _Named("gestures")]
    sides: Literal["left", "right", "both"] = "right"
    times: Annotated[int, Field(ge=0, le=20)] = 0


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

    Two whose "palms" are against each other's lean in and stay where they are; a "couple" dances as recorded ones do.
    """

    do: Literal["hold"] = "hold"
    hold: Literal["closed", "ring", "twirl", "palms", "couple"]


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


class Limb(_Shape):
    """Legs, trunk or head that move by themselves, as in ``limbs.toml``; the act names side, direction and number.

    Attributes:
        does: which movement.
        side: of the leg, where the words name none; trunk and head go to it only where the direction is "out".
        direction: of leg, trunk or head, where the words name none. A trunk without one leans forward.
        times: how often, of what is repeated; 0 for as long as the beat lasts.
    """

    do: Literal["limb"] = "limb"
    does: Annotated[str, _Named("limbs")]
    side: Literal["left", "right", "both"] = "right"
    direction: Literal["", "up", "down", "forward", "back", "out", "left", "right"] = ""
    times: Annotated[int, Field(ge=0, le=20)] = 0


class Figure(_Shape):
    """A figure of the whole body on the spot, by its name in ``acts/staging/figures.toml``, or one that was recorded.

    Attributes:
        figure: which one.
        times: how often its middle is done where the words give no number; 0 for as long as there is time.
        mirrored: left and right are exchanged.
        meets: it is done to the other, who stands within its reach: the two do not move apart for it.
        late, early: seconds after which it begins, of a person who follows the other, and before the end of the beat
            that it ends, of the one who is followed.
        in_time: two people who do it, do it as one.
    """

    do: Literal["figure"] = "figure"
    figure: Annotated[str, _Named("figures", "bows", "bows deeply", "dances", "shadow-boxes", table="figures")]
    times: Annotated[int, Field(ge=0, le=20)] = 0
    mirrored: bool = False
    meets: bool = False
    late: Annotated[float, Field(ge=0, le=3)] = 0.0
    early: Annotated[float, Field(ge=0, le=3)] = 0.0
    in_time: bool = False


class Words(_Shape):
    """Nothing is given: the network makes the act from its caption, which it was trained on."""

    do: Literal["words"] = "words"


_OnTheFloor = Go | Turn | Stay | Place
_OfOneself = Posture | Jump | Gesture | Limb | Figure | Words
_WithTheOther = Touch | Hold | Link | Pull | Lift | Strike
Shape = Annotated[_OnTheFloor | _OfOneself | _WithTheOther, Field(discriminator="do")]
