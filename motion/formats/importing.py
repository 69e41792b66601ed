"""Imports a motion file and reports its joints, up axis, unit and frame rate, each of which can be overridden.

A reader gives everybody as the file has them; here they are brought upright, to metres and onto the floor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from motion.clip import Clip, Duet
from motion.errors import InputError
from motion.guesses import calibration_frames, find_up, places_of, turn_of
from motion.retarget import UNITS, rest_axis, retarget_together, to_smpl, unit_of, up_axis
from motion.rigs import RigMotion, without_beginning
from motion.skeleton import LAYOUTS, SMPL22
from motion.vectors import Array

from .files import check_duration
from .recording import MAX_PEOPLE, ORDERS, Animations, ImportChoices, Recording
from .registry import RIG_FPS, recordings

_NEAR_FLOOR = (-0.05, 0.15)
"""Metres: people whose lowest joint is between these are left at their height."""
_UP_TAKEN = "{}: {} was taken as up, from how the body stands, not {} as is usual: choose the up axis if it is wrong."
_CALIBRATION = "{}: the first {} left out, a calibration pose from which the joints jump."


@dataclass(frozen=True)
class Imported:
    """A motion and how it was interpreted.

    Attributes:
        people: all people in the file, in metres, Y up. Joints that must be fitted, as a Kinect's, are the
            file's own. The two of a pair come first.
        up: what points up in the file, of :data:`motion.guesses.AXES`.
        unit: its unit; "none" if its lengths were scaled to an average person.
        fps: its frames a second.
        joints: number of SMPL22's joints that the file has.
        order: joint order of an array, if several orders have that number of joints.
        animations: those of a .glb file, and which of them this is; None for any other file.
        asks: True if a thing was assumed that nobody said: the frame rate, an unusual up axis, the joints' order.
        beside: what a duet holds beside its people, as :class:`~motion.formats.recording.Recording`.
    """

    people: tuple[Clip, ...]
    up: str
    unit: str
    fps: float
    joints: int
    order: str | None = None
    animations: Animations | None = None
    asks: bool = False
    beside: Mapping[str, Any] = field(default_factory=dict, repr=False)

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on how well the file could be read, and on which animation was taken."""
        return tuple(dict.fromkeys(note for person in self.people for note in person.notes))

    @cached_property
    def motion(self) -> Clip | Duet:
        """The person, or the first two, on SMPL22; fitting takes about 5 ms a frame and person."""
        return to_smpl(Duet(self.people[0], self.people[1], **self.beside) if len(self.people) > 1 else self.people[0])

    def describe(self) -> str:
        """One line, such as "22 joints found; lengths in cm, Z is up, 120 frames a second"."""
        unit = "without a unit, scaled to a person" if self.unit == "none" else f"in {self.unit}"
        order = "" if self.order is None else f" in the order of {ORDERS[self.order]}"
        count = f"{len(self.people)} people, " if len(self.people) > 2 else ""
        found = f"{count}{self.joints} joints found{order}; lengths {unit}"
        return f"{found}, {self.up.upper()} is up, {self.fps:g} frames a second"


def import_motion(
    source: str | Path | bytes, *, name: str | None = None, choices: ImportChoices | None = None
) -> Imported:
    """Reads a motion file and says how.

    Args:
        source: the file, or its bytes, and then ``name`` must end in its suffix.
        name: what to call it in messages.
        choices: what is known of the file.

    Raises:
        InputError: one sentence saying what is wrong with the file or with a choice.
    """
    choices = choices or ImportChoices()
    people, label = recordings(source, name, choices)
    return _imported(people[0] if len(people) == 1 else _together(people), label, choices)


def import_pair(a: str | Path, b: str | Path, *, choices: ImportChoices | None = None) -> Imported:
    """Reads two files of one person each who share one world, as :func:`import_motion` does one."""
    choices = choices or ImportChoices()
    people = [recordings(source, None, choices)[0][0] for source in (a, b)]
    return _imported(_together(people), f"{Path(a).name} and {Path(b).name}", choices)


def _together(people: Sequence[Recording]) -> Recording:
    """Two recordings of one person each as one of two."""
    for recording in people:
        if len(recording.people) != 1:
            raise InputError(f"{recording.people[0].name} already holds two people: give it alone.")
    first, second = (recording.people[0] for recording in people)
    if isinstance(first, RigMotion) and isinstance(second, RigMotion):
        return replace(people[0], people=(first, second))
    if isinstance(first, RigMotion) or isinstance(second, RigMotion):
        alone = [_imported(recording, recording.people[0].name, ImportChoices()).motion for recording in people]
        first, second = (clip for clip in alone if isinstance(clip, Clip))
    frames = min(first.num_frames, second.num_frames)
    return replace(people[0], people=(first.cut(0, frames), second.cut(0, frames)))


def _imported(recording: Recording, label: str, choices: ImportChoices) -> Imported:
    if (count := len(recording.people)) > MAX_PEOPLE:
        raise InputError(f"{label} holds {count} people: give {MAX_PEOPLE} or fewer in a file.")
    people = _without_calibration(recording.people)
    rigs = [person for person in people if isinstance(person, RigMotion)]
    clips = [person for person in people if isinstance(person, Clip)]
    imported = _import_rigs(rigs, label, choices) if rigs else _import_clips(clips, recording, label, choices)
    asks = any(note.endswith((" if it is wrong.", " if it differs.")) for note in imported.notes)
    return replace(imported, animations=recording.animations, beside=recording.beside, asks=asks)


def _without_calibration(people: Sequence[Any]) -> list[Any]:
    """People (clips or rigs' motions) without the frames of a calibration pose at the beginning, of anybody's."""
    seconds = max(calibration_frames(places_of(person), person.fps) / person.fps for person in people)
    counts = [min(round(seconds * person.fps), len(person.positions) - 1) for person in people]
    if not any(counts):
        return list(people)
    left = []
    for person, count in zip(people, counts, strict=True):
        note = _CALIBRATION.format(person.name, "frame was" if count == 1 else f"{count} frames were")
        left.append(replace(person, positions=person.positions[count:], notes=(*person.notes, note)))
    return left


def _with_note(people: Sequence[Any], up: str, usual: str, label: str, choices: ImportChoices) -> list[Any]:
    """People with a sentence on the up axis where that is not the usual one and nobody chose it."""
    if choices.up is not None or up == (usual or up):
        return list(people)
    note = _UP_TAKEN.format(label, up.upper(), usual.upper())
    return [replace(person, notes=(*person.notes, note)) for person in people]


# ---- rigs --------------------------------------------------------------------------------------------


def own_clip(rig: RigMotion) -> Clip | None:
    """A file whose joints are SMPL22's needs no retargeting: it keeps its frame rate, bones and place."""
    names = without_beginning(rig.joint_names)
    if not set(SMPL22.joint_names) <= set(names) or rig.metres_per_unit != 1.0:
        return None
    order = [names.index(name) for name in SMPL22.joint_names]
    return Clip(rig.positions[:, order], rig.fps, name=rig.name, notes=rig.notes)


def _import_rigs(rigs: list[RigMotion], label: str, choices: ImportChoices) -> Imported:
    first = rigs[0]
    check_duration(first.num_frames, first.fps, label)
    own = [own_clip(rig) for rig in rigs]
    up = choices.up or up_axis(*rigs)
    rigs = [replace(rig, up=up) for rig in _with_note(rigs, up, rest_axis(first) or "y", label, choices)]
    if up == "y" and all(own):
        frames = min(clip.num_frames for clip in own if clip is not None)
        people = tuple(clip.cut(0, frames) for clip in own if clip is not None)
    else:
        people = retarget_together(rigs, fps=RIG_FPS)
    unit = next((n for n, metres in UNITS.items() if np.isclose(metres, rigs[0].metres_per_unit)), "none")
    return Imported(people, up, unit, first.fps * first.every, rigs[0].parts.matched)


# ---- clips -------------------------------------------------------------------------------------------


def _import_clips(clips: list[Clip], recording: Recording, label: str, choices: ImportChoices) -> Imported:
    places = [places_of(clip) for clip in clips]
    up = choices.up or find_up(places, recording.usual_up or "y")
    unit = unit_of(places[0]) or "m"
    turn, metres = turn_of(up), UNITS[unit]
    people = [_turned(clip, turn, metres) for clip in _with_note(clips, up, recording.usual_up, label, choices)]
    lowest = min(float(clip.positions[..., 1].min()) for clip in people)
    changed = people[0].positions is not clips[0].positions
    if (recording.on_floor and len(people) == 1) or (
        (recording.on_floor or changed) and not _NEAR_FLOOR[0] <= lowest <= _NEAR_FLOOR[1]
    ):
        down = np.array([0.0, lowest, 0.0], dtype=np.float32)
        people = [replace(clip, positions=clip.positions - down) for clip in people]
    check_duration(people[0].num_frames, people[0].fps, label)
    skeleton = people[0].skeleton
    joints = len(LAYOUTS[skeleton.name].observed)
    order = skeleton.name if skeleton.name in ORDERS else None
    return Imported(tuple(people), up, unit, people[0].fps, joints, order)


def _turned(clip: Clip, turn: Array, metres: float) -> Clip:
    """The clip in metres, Y up; the very same positions where nothing is to be changed."""
    if metres == 1.0 and (turn == np.eye(3)).all():
        return clip
    positions = (clip.positions.astype(np.float64) * metres) @ turn.T
    return replace(clip, positions=positions.astype(np.float32))
