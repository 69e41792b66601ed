"""The plan of a request and of its result: what its words are read as, and what that gives the network.

Words are read once, when a run begins (:meth:`.sampling.SamplingRequest.with_plan`), and their plan of acts travels in
the request. The run adds its windows and finishes, and the result's manifest keeps the whole. A result that is made
again takes its plan from there: a later version may read its words in another way.

Positions are kept in hundredths of a millimetre. A plan is rounded to them before its first use, so a replayed plan
gives the network the same numbers.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, PlainSerializer, PlainValidator, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from acts import read
from acts.plan import Plan, plan_of, problem
from acts.staging.window import KnownFrames, KnownPath, Part
from motion import SMPL22, InputError
from motion.vectors import Array

MOST_WINDOWS = 1024
"""Windows of all samples of a result: eight samples of sixty beats make fewer."""
_UNIT = 1e5
"""Units to a metre, and to a radian."""
_FARTHEST = 100_000_000
"""Units of a number at most, a kilometre."""
_BEAT = ("words", "a", "b", "seconds", "seed", "acts")
_STRICT = ConfigDict(strict=True, arbitrary_types_allowed=True)

Whole = Annotated[int, Field(ge=-_FARTHEST, le=_FARTHEST)]
Number = Annotated[float, Field(ge=-_FARTHEST, le=_FARTHEST)]
Text = Annotated[str, Field(max_length=20_000)]
Notes = Annotated[tuple[Text, ...], Field(max_length=20)]
Frames = Annotated[list[Annotated[int, Field(ge=0, lt=400)]], Field(min_length=1, max_length=400)]
"""Frames of a window, with what it sees before and after."""
Joints = Annotated[list[Annotated[int, Field(ge=0, lt=SMPL22.num_joints)]], Field(max_length=SMPL22.num_joints)]


class _Poses(BaseModel):
    """Given frames as JSON: a pose that is held for several of them is written once, and ``which`` names it."""

    model_config = _STRICT
    person: Literal[0, 1]
    frames: Frames
    joints: Joints
    poses: list[list[Whole]]
    which: list[Annotated[int, Field(ge=0)]]
    kept: bool = False
    soft: bool = False
    free: bool = False

    def part(self) -> KnownFrames:
        """The frames; raises ValueError where the lists do not fit together."""
        known = self.joints or list(range(SMPL22.num_joints))
        poses = np.zeros((len(self.poses), SMPL22.num_joints, 3))
        poses[:, known] = np.array(self.poses, dtype=np.float64).reshape(len(poses), len(known), 3) / _UNIT
        fits = len(self.which) == len(self.frames) and max(self.which) < len(poses)
        if not fits or len(set(known)) < len(known) or len(set(self.frames)) < len(self.frames):
            raise ValueError("its poses are not those of its frames")
        return KnownFrames(self.person, self.frames, poses[self.which], self.joints, self.kept, self.soft, self.free)


class _Path(BaseModel):
    """A given path as JSON."""

    model_config = _STRICT
    person: Literal[0, 1]
    frames: Frames
    places: list[Whole]
    headings: list[Whole] | None = None
    turned: bool = False

    def part(self) -> KnownPath:
        """The path; raises ValueError where the lists do not fit together."""
        count = len(self.frames)
        places = np.array(self.places, dtype=np.float64).reshape(count, 2) / _UNIT
        headings = None if self.headings is None else np.array(self.headings).reshape(count) / _UNIT
        if len(set(self.frames)) < count:
            raise ValueError("a frame is given twice")
        return KnownPath(self.person, self.frames, places, headings, self.turned)


def _written(part: Part) -> dict[str, Any]:
    """A part as JSON."""
    plain: dict[str, Any] = {"person": part.person, "frames": [int(frame) for frame in part.frames]}
    if isinstance(part, KnownPath):
        headings = None if part.headings is None else _units(part.headings)
        return plain | {"places": _units(part.places), "headings": headings, "turned": part.turned}
    joints, positions = [int(joint) for joint in part.joints], np.asarray(part.positions)
    if joints and 0 not in joints:  # known beside the pelvis, which is not written
        positions = positions - positions[:, :1]
    chosen = positions[:, joints] if joints else positions
    rows, which = _unique(_units(pose) for pose in chosen)
    marks = {name: True for name in ("kept", "soft", "free") if getattr(part, name)}
    return plain | {"joints": joints, "poses": rows, "which": which} | marks


def _rounded(part: Any) -> Part:
    """A part from JSON, or one that is rounded as in JSON."""
    values = _written(part) if isinstance(part, (KnownFrames, KnownPath)) else _mapping(part)
    kind: type[_Path | _Poses] = _Path if "places" in values else _Poses
    return kind.model_validate(values).part()


def _mapping(value: Any) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise ValueError("a part of it is no table")
    return value


def _unique(rows: Iterable[list[int]]) -> tuple[list[list[int]], list[int]]:
    """The different rows, and for each row its place among them."""
    known: dict[tuple[int, ...], int] = {}
    which = [known.setdefault(tuple(row), len(known)) for row in rows]
    return [list(row) for row in known], which


def _units(values: Array) -> list[int]:
    """Metres or radians as whole units, flat."""
    return np.rint(np.asarray(values, dtype=np.float64) * _UNIT).astype(np.int64).ravel().tolist()


KeptPart = Annotated[Part, PlainValidator(_rounded), PlainSerializer(_written)]
KeptActs = Annotated[
    Plan, PlainValidator(plan_of), PlainSerializer(lambda plan: plan.model_dump(mode="json", exclude_defaults=True))
]
KeptBeat = Annotated[Mapping[str, Any], PlainValidator(lambda beat: {name: _mapping(beat).get(name) for name in _BEAT})]


@dataclass(frozen=True, eq=False, config=_STRICT)
class WindowPlan:
    """The plan of one window of a scene.

    Attributes:
        place: x and z in metres of the scene's world, which become the origin of the network's frame, and the
            heading in radians that becomes +Z.
        parts: poses and places in the network's frame, without the frames of windows around it.
        alone: what each person does, as sentences of their own, for a network that reads them.
        notes: sentences on what could not be planned as it was asked for.
    """

    place: tuple[Number, Number, Number]
    parts: Annotated[tuple[KeptPart, ...], Field(max_length=64)] = ()
    alone: tuple[Text, Text] = ("", "")
    notes: Notes = ()


@dataclass(frozen=True, config=_STRICT)
class BeatFinish:
    """The finish of a beat of a scene.

    Attributes:
        reaching: whether palms meet what they reach for.
        held: whether the two hold each other by the hand.
    """

    reaching: bool = False
    held: bool = False


@dataclass(frozen=True, eq=False, config=_STRICT)
class KeptPlan:
    """The plan of a request.

    Attributes:
        acts: what its words are read as, with the looks of the two people and the things: of a sentence one plan, of a
            story one a beat; () where nothing is read yet.
        of_result: a result was made from it, so its beats, windows and finishes are taken as they are.
        beats: the fields of the beats that a sentence was split into; () where it is given to the network as it is,
            and in the plan of a story, which has its beats itself.
        alone: where there are no windows, as in :class:`WindowPlan`.
        windows: of all samples, one sample after another.
        notes: what was said of the plan.
        finishes: of a scene's beats, or of a sentence that is given as it is; () in what is made without a plan.
    """

    acts: Annotated[tuple[KeptActs, ...], Field(max_length=MOST_WINDOWS)] = ()
    of_result: bool = Field(default=False, exclude=True)
    beats: Annotated[tuple[KeptBeat, ...], Field(max_length=MOST_WINDOWS)] = ()
    alone: tuple[Text, Text] = ("", "")
    windows: Annotated[tuple[WindowPlan, ...], Field(max_length=MOST_WINDOWS)] = ()
    notes: Notes = ()
    finishes: Annotated[tuple[BeatFinish, ...], Field(max_length=MOST_WINDOWS)] = ()

    def to_dict(self) -> dict[str, Any]:
        """As JSON."""
        row: dict[str, Any] = _JSON.dump_python(self, mode="json")
        return row

    @classmethod
    def from_dict(cls, values: Any) -> KeptPlan:
        """The plan of a result, as :meth:`to_dict` gave it.

        Raises:
            InputError: for anything else.
        """
        try:
            return replace(_JSON.validate_json(json.dumps(values)), of_result=True)
        except ValidationError as error:
            raise InputError(
                f"The plan that was kept with this result is damaged ({problem(error).rstrip('.')}): make the result "
                "anew from its words."
            ) from None


_JSON = TypeAdapter(KeptPlan)


def plan_of_words(text: str) -> Plan:
    """The plan of a text; an empty one where it says nothing, is too long, or no parser is installed."""
    try:
        return read(text) if text.strip() else Plan()
    except InputError:
        return Plan()


def kept_plan(manifest: Mapping[str, Any]) -> KeptPlan | None:
    """The plan in a result's manifest; None in that of a method that takes no words.

    Raises:
        InputError: if it is damaged.
    """
    return None if manifest.get("plan") is None else KeptPlan.from_dict(manifest["plan"])
