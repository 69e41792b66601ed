"""The plan of a request and of its result: what its words are read as, and what that gives the network.

Words are read once, when a run begins (:mod:`.acting`), and their plan of acts travels in the request. The run adds its
windows and finishes, and the result's manifest keeps the whole. A result that is made again takes its plan from there:
a later version may read its words in another way.

Positions are kept in hundredths of a millimetre. A plan is rounded to them before its first use, so a replayed plan
gives the network the same numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acts.plan import Plan, plan_of
from acts.staging.parts import KnownFrames, KnownPath, Part
from motion import SMPL22, InputError

Array = NDArray[np.floating]

MOST_WINDOWS = 1024
"""Windows of all samples of a result: eight samples of sixty beats make fewer."""
_MOST_FRAMES = 400
"""Frames of a window, with what it sees before and after."""
_MOST_PARTS = 64
"""Parts that are given of one window."""
_UNIT = 1e5
"""Units to a metre, and to a radian."""
_FARTHEST = 1000 * _UNIT
_WRONG = "The plan that was kept with this result is damaged ({}): make the result anew from its words."


@dataclass(frozen=True, eq=False)
class WindowPlan:
    """The plan of one window of a scene.

    Attributes:
        place: x and z in metres of the scene's world, which become the origin of the network's frame, and the
            heading in radians that becomes +Z.
        parts: poses and places in the network's frame, without the frames of windows around it.
        alone: what each person does, as sentences of their own, for a network that reads them.
        notes: sentences on what could not be planned as it was asked for.
    """

    place: tuple[float, float, float]
    parts: tuple[Part, ...] = ()
    alone: tuple[str, str] = ("", "")
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", tuple(_decoded(_encoded(part)) for part in self.parts))

    def to_dict(self) -> dict[str, Any]:
        """As JSON."""
        return {
            "place": list(self.place),
            "alone": list(self.alone),
            "notes": list(self.notes),
            "parts": [_encoded(part) for part in self.parts],
        }

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> WindowPlan:
        """The plan that :meth:`to_dict` gave; raises InputError for anything else."""
        values = _mapping(values)
        place = [_number(value) for value in _list(values.get("place"), 3)]
        parts = _list(values.get("parts"), _MOST_PARTS)
        if len(place) != 3:
            raise InputError(_WRONG.format("a window has no place"))
        return cls(
            (place[0], place[1], place[2]),
            tuple(_decoded(_mapping(part)) for part in parts),
            _pair(values.get("alone")),
            tuple(_text(note) for note in _list(values.get("notes"), 20)),
        )


@dataclass(frozen=True)
class BeatFinish:
    """The finish of a beat of a scene.

    Attributes:
        reaching: whether palms meet what they reach for.
        still: who ("", "a", "b" or "ab") does not look about or shift their weight.
        held: whether the two hold each other by the hand.
        loose: whose ("", "a", "b" or "ab") arms have nothing to do.
    """

    reaching: bool = False
    still: str = ""
    held: bool = False
    loose: str = ""

    def to_dict(self) -> dict[str, Any]:
        """As JSON."""
        return {"reaching": self.reaching, "still": self.still, "held": self.held, "loose": self.loose}

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> BeatFinish:
        """A finish from :meth:`to_dict`; raises InputError for anything else."""
        reaching, held = values.get("reaching"), values.get("held", False)
        still, loose = values.get("still"), values.get("loose", "")
        known = all(who in ("", "a", "b", "ab") for who in (still, loose))
        if not isinstance(reaching, bool) or not isinstance(held, bool) or not known:
            raise InputError(_WRONG.format("the finish of a beat is none"))
        return cls(reaching, str(still), held, str(loose))


@dataclass(frozen=True, eq=False)
class KeptPlan:
    """The plan of a request.

    Attributes:
        acts: what its words are read as, with the looks of the two people and the things: of a sentence one plan, of a
            story one a beat; () where nothing is read yet, or a version kept none.
        of_result: a result was made from it, so its beats, windows and finishes are taken as they are.
        beats: the fields of the beats that a sentence was split into; () where it is given to the network as it is,
            and in the plan of a story, which has its beats itself.
        alone: where there are no windows, as in :class:`WindowPlan`.
        windows: of all samples, one sample after another.
        notes: what was said of the plan.
        finishes: of a scene's beats, or of a sentence that is given as it is; () where a version kept none, and in what
            is made without a plan.
    """

    acts: tuple[Plan, ...] = ()
    of_result: bool = False
    beats: tuple[Mapping[str, Any], ...] = ()
    alone: tuple[str, str] = ("", "")
    windows: tuple[WindowPlan, ...] = ()
    notes: tuple[str, ...] = ()
    finishes: tuple[BeatFinish, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """As JSON."""
        return {
            "acts": [plan.model_dump(mode="json", exclude_defaults=True) for plan in self.acts],
            "beats": [dict(beat) for beat in self.beats],
            "alone": list(self.alone),
            "windows": [window.to_dict() for window in self.windows],
            "notes": list(self.notes),
            "finishes": [each.to_dict() for each in self.finishes],
        }

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> KeptPlan:
        """The plan that :meth:`to_dict` gave.

        Raises:
            InputError: for anything else.
        """
        values = _mapping(values)
        beats = (_mapping(beat) for beat in _list(values.get("beats"), MOST_WINDOWS))
        return cls(
            _acts(values),
            True,
            tuple({name: beat.get(name) for name in ("words", "a", "b", "seconds", "seed", "acts")} for beat in beats),
            _pair(values.get("alone")),
            tuple(WindowPlan.from_dict(window) for window in _list(values.get("windows"), MOST_WINDOWS)),
            tuple(_text(note) for note in _list(values.get("notes"), 20)),
            tuple(BeatFinish.from_dict(_mapping(each)) for each in _list(values.get("finishes") or [], MOST_WINDOWS)),
        )


def kept_plan(manifest: Mapping[str, Any]) -> KeptPlan | None:
    """The plan in a result's manifest; None in those of versions that kept none.

    Raises:
        InputError: if it is damaged.
    """
    return None if manifest.get("plan") is None else KeptPlan.from_dict(manifest["plan"])


def kept_acts(manifest: Mapping[str, Any]) -> tuple[Plan, ...]:
    """The plans of acts of a result, from its manifest; () in those of versions that kept none.

    Raises:
        InputError: if it is damaged.
    """
    return () if manifest.get("plan") is None else _acts(_mapping(manifest["plan"]))


def _acts(values: Mapping[str, Any]) -> tuple[Plan, ...]:
    try:
        return tuple(plan_of(plan) for plan in _list(values.get("acts") or [], MOST_WINDOWS))
    except InputError as error:
        raise InputError(_WRONG.format("its acts are none")) from error


def _encoded(part: Part) -> dict[str, Any]:
    """A part as JSON; a pose that is held for several frames is written once."""
    plain: dict[str, Any] = {"person": part.person, "frames": [int(frame) for frame in part.frames]}
    if isinstance(part, KnownPath):
        headings = None if part.headings is None else _units(part.headings)
        return plain | {"places": _units(part.places), "headings": headings, "turned": part.turned}
    joints, positions = [int(joint) for joint in part.joints], np.asarray(part.positions)
    if joints and 0 not in joints:  # known beside the pelvis, which is not written
        positions = positions - positions[:, :1]
    chosen = positions[:, joints] if joints else positions
    rows, which = _unique(_units(pose) for pose in chosen)
    kept = {"kept": True} if part.kept else {}
    return plain | {"joints": joints, "poses": rows, "which": which} | kept


def _decoded(part: Mapping[str, Any]) -> Part:
    """A part from JSON."""
    frames = _wholes(part.get("frames"), _MOST_FRAMES, _MOST_FRAMES)
    person = part.get("person")
    if person not in (0, 1) or isinstance(person, bool) or not frames or len(set(frames)) != len(frames):
        raise InputError(_WRONG.format("a frame is missing or given twice"))
    if "places" in part:
        headings = part.get("headings")
        angles = None if headings is None else _metres(headings, (len(frames),))
        places = _metres(part["places"], (len(frames), 2))
        return KnownPath(person, frames, places, angles, part.get("turned") is True)
    joints = _wholes(part.get("joints"), SMPL22.num_joints, SMPL22.num_joints)
    rows, which = _list(part.get("poses"), len(frames)), _wholes(part.get("which"), len(frames), len(frames))
    if len(set(joints)) != len(joints) or len(which) != len(frames) or any(i >= len(rows) for i in which):
        raise InputError(_WRONG.format("its poses are not those of its frames"))
    known = joints or list(range(SMPL22.num_joints))
    poses = np.zeros((len(rows), SMPL22.num_joints, 3))
    for pose, row in zip(poses, rows, strict=True):
        pose[known] = _metres(row, (len(known), 3))
    return KnownFrames(person, frames, poses[which], joints, part.get("kept") is True)


def _unique(rows: Iterable[list[int]]) -> tuple[list[list[int]], list[int]]:
    """The different rows, and for each row its place among them."""
    known: dict[tuple[int, ...], int] = {}
    which = [known.setdefault(tuple(row), len(known)) for row in rows]
    return [list(row) for row in known], which


def _units(values: Array) -> list[int]:
    """Metres or radians as whole units, flat."""
    return np.rint(np.asarray(values, dtype=np.float64) * _UNIT).astype(np.int64).ravel().tolist()


def _metres(values: Any, shape: tuple[int, ...]) -> Array:
    """Whole units as metres or radians of a shape."""
    count = int(np.prod(shape))
    found = _list(values, count)
    if len(found) != count or not all(type(value) is int and abs(value) <= _FARTHEST for value in found):
        raise InputError(_WRONG.format("a place is missing or too far away"))
    return np.array(found, dtype=np.float64).reshape(shape) / _UNIT


def _wholes(values: Any, count: int, below: int) -> list[int]:
    found = _list(values, count)
    if not all(type(value) is int and 0 <= value < below for value in found):
        raise InputError(_WRONG.format("a number in it is out of range"))
    return list(found)


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) <= _FARTHEST:
        raise InputError(_WRONG.format("a number in it is out of range"))
    return float(value)


def _text(value: Any) -> str:
    if not isinstance(value, str) or len(value) > 20_000:
        raise InputError(_WRONG.format("a sentence in it is none"))
    return value


def _pair(values: Any) -> tuple[str, str]:
    found = [_text(value) for value in _list(values, 2)]
    if len(found) != 2:
        raise InputError(_WRONG.format("it lacks the sentences of the two people"))
    return found[0], found[1]


def _list(values: Any, most: int) -> Sequence[Any]:
    if not isinstance(values, list) or len(values) > most:
        raise InputError(_WRONG.format("a list in it is missing or too long"))
    return values


def _mapping(values: Any) -> Mapping[str, Any]:
    if not isinstance(values, Mapping):
        raise InputError(_WRONG.format("a part of it is no table"))
    return values
