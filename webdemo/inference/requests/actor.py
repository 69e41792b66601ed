"""The given person of a reaction: chosen from a file, and seen in the frame that the network knows.

No torch here: the page and the shell choose and trim before any network loads.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np

from motion import FPS, SMPL22, Clip, Duet, InputError, stacked_positions
from motion.formats import ImportChoices
from motion.formats.files import check_smpl
from motion.formats.importing import import_motion
from motion.kinematics import bone_lengths
from motion.retarget import to_smpl
from motion.transforms import resample
from motion.vectors import Array
from webdemo.inference.method import SECONDS

ROLES = ("a", "b")
LETTERS = "abcdef"
"""Names of the people in a file."""
_COUNTS = ("no", "one", "two", "three", "four", "five", "six")
# Accepted ratio of an actor's bone lengths to an adult's; outside, the file is in another unit.
_BODY_SIZES = (0.5, 1.6)
# Metres; farther away, 32-bit positions are not exact to a tenth of a millimetre.
_FARTHEST = 1000.0


def finite(value: Any) -> TypeGuard[float]:
    """True for a number that a float can hold; JSON may have whole ones of any length."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= sys.float_info.max


def choose_person(people: Sequence[Clip], person: str | None, name: str) -> int:
    """The index of a person in a file, from their letter.

    Args:
        people: all people in the file, at least one.
        person: "a", "b" … up to the number of people; may be None if there is only one.
        name: of the file, for messages.

    Raises:
        InputError: if the choice is open or there is no such person.
    """
    known = LETTERS[: len(people)]
    listed = " or ".join(part for part in (", ".join(known[:-1]), known[-1]) if part)
    if len(people) == 1 and person not in (None, "a"):
        raise InputError(f"{name} holds one person only: leave the choice of a person out.")
    if len(people) > 1 and person is None:
        raise InputError(f"{name} holds {_COUNTS[len(people)]} people: choose person {listed}.")
    if person is not None and (len(person) != 1 or person not in known):
        raise InputError(f"Person {person!r:.40} is not known: {name} has {listed}.")
    return 0 if person is None else LETTERS.index(person)


def choose_actor(
    people: Sequence[Clip],
    *,
    person: str | None = None,
    start: float = 0.0,
    end: float | None = None,
    name: str = "The file",
) -> Clip:
    """One of a file's people, trimmed, at 30 fps, with the joints of the file.

    Args:
        people: everybody.
        person: as in :func:`choose_person`.
        start, end: seconds in the file; to the end by default.
        name: of the file, for messages.

    Raises:
        InputError: if the choice is open, or the times do not lie in the motion.
    """
    clip = people[choose_person(people, person, name)]
    if not finite(start) or not finite(end or 0.0):
        raise InputError(f"Start and end must be seconds with 0 ≤ start < end, not {start!r:.20} and {end!r:.20}.")
    if start >= clip.seconds:
        raise InputError(f"The start, {start:g} s, is after the end of the motion, which lasts {clip.seconds:.1f} s.")
    stop = clip.seconds if end is None else end
    if not 0 <= start < stop:
        raise InputError(f"Start and end must be seconds with 0 ≤ start < end, not {start:g} and {stop:g}.")
    first, last = round(start * clip.fps), round(min(stop, clip.seconds) * clip.fps)
    return at_30_fps(clip.cut(first, max(last, first + 1)))


def other_pose(people: Sequence[Clip], *, person: str | None, start: float = 0.0, name: str = "The file") -> Array:
    """Pose of the other person at the first frame of the actor's part: (22, 3) metres.

    Args:
        people: everybody; of the one a single frame is fitted.
        person: the actor.
        start: seconds in the file.
        name: of the file, for messages.

    Raises:
        InputError: if the file does not hold two people, or the start lies behind its end.
    """
    if len(people) != 2:
        raise InputError(f"{name} does not hold two people, so there is no second first pose to start from.")
    other = LETTERS[1 - choose_person(people, person, name)]
    part = choose_actor(people, person=other, start=start, name=name)
    return np.asarray(to_smpl(part.cut(0, 1)).positions[0])


def read_actor(
    path: str | Path,
    *,
    person: str | None = None,
    start: float = 0.0,
    end: float | None = None,
    keep_start: bool = False,
    choices: ImportChoices | None = None,
    seconds: tuple[float, float] = SECONDS,
) -> tuple[Clip, Array | None]:
    """One person of a motion file, trimmed, on SMPL22 and at 30 fps; only what is used is fitted.

    Args:
        path: the file, after which the clip is called.
        person, start, end: as in :func:`choose_actor`.
        keep_start: also give :func:`other_pose`, else None.
        choices: what is known of the file.
        seconds: the shortest and the longest part that the method takes.

    Raises:
        InputError: if the file or a choice is wrong, or the part shorter or longer than that.
    """
    name = Path(path).name
    people = import_motion(Path(path), name=name, choices=choices).people
    clip = choose_actor(people, person=person, start=start, end=end, name=name)
    pose = other_pose(people, person=person, start=start, name=name) if keep_start else None
    check_length(clip, seconds)
    return replace(to_smpl(clip), name=name), pose


def at_30_fps(clip: Clip) -> Clip:
    """The clip at the networks' rate, without rotations; its positions are the same array if it has it."""
    positions = clip.positions if clip.fps == FPS else resample(clip.positions, clip.fps, FPS)
    return Clip(positions, FPS, clip.skeleton, name=clip.name, notes=clip.notes)


def check_actor(clip: Any, seconds: tuple[float, float]) -> Clip:
    """Checks an actor and resamples it for the networks (:func:`at_30_fps`).

    Args:
        clip: the given motion.
        seconds: the shortest and the longest motion.

    Raises:
        InputError: one sentence that says what is wrong and what to do.
    """
    if not isinstance(clip, Clip):
        raise InputError("The actor must be one person's clip: of two people, choose person a or b.")
    check_smpl(clip, "A reaction")
    check_length(clip, seconds)
    actor = at_30_fps(clip)
    size = float(bone_lengths(actor.positions).sum(-1).mean() / SMPL22.bone_lengths.sum())
    if not _BODY_SIZES[0] <= size <= _BODY_SIZES[1]:
        raise InputError(f"The actor's bones are {size:.3g} times as long as an adult's: give positions in metres.")
    if np.abs(actor.positions).max() > _FARTHEST:
        raise InputError(f"The actor is more than {_FARTHEST:g} m from the origin: move the motion there.")
    return actor


def motion_facts(motion: Clip | Duet) -> dict[str, Any]:
    """A motion in a manifest: its name, length and the SHA-256 that represents its positions."""
    positions = np.ascontiguousarray(stacked_positions(motion))
    digest = hashlib.sha256(positions.tobytes()).hexdigest()
    return {"name": motion.people[0].name[:100], "frames": motion.num_frames, "fps": motion.fps, "sha256": digest}


def check_pose(pose: Any, what: str) -> Array:
    """(22, 3) a pose of an adult in metres, checked like an actor who holds it for a second; ``what`` names it.

    Raises:
        InputError: one sentence that says what is wrong and what to do.
    """
    joints = np.asarray(pose, dtype=np.float64)
    if joints.shape != (SMPL22.num_joints, 3) or not np.isfinite(joints).all():
        raise InputError(f"{what} needs the positions of SMPL's 22 joints as finite numbers, in metres.")
    check_actor(Clip(np.repeat(joints[None], 30, axis=0), FPS), (0.0, 2.0))
    return joints


def check_length(clip: Clip, seconds: tuple[float, float]) -> None:
    """Raises InputError if a motion is shorter or longer than what the networks take."""
    shortest, longest = seconds
    if clip.seconds < shortest:
        raise InputError(f"The actor's motion lasts {clip.seconds:.2f} s: give {shortest:g} s or more of it.")
    # From the first frame to the last: ten seconds at 30 fps are often stored as 301 frames.
    if (clip.num_frames - 1) / clip.fps > longest:
        raise InputError(
            f"The actor's motion lasts {clip.seconds:.1f} s: trim it to {longest:g} s or less by its start and end."
        )
