"""Imports a motion file and reports its joints, up axis, unit and frame rate, each of which can be overridden.

:func:`motion.formats.read` finds these automatically; here they are reported, and given ones take precedence.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion import SKELETONS, SMPL22, Clip, Duet, InputError
from motion.layouts import LAYOUTS
from motion.retarget import retarget, retarget_duet, to_smpl, up_axis
from motion.rigs import RigMotion, matched_names

from . import NO_ANIMATIONS, RIGS, own_clip, read_everyone, read_rigs
from .arrays import says_no_rate
from .crowd import clips_of
from .files import MAX_SECONDS
from .glb_animations import Animation, Animations, check_animation
from .glb_motion import read_glb

Array = NDArray[np.floating]

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "inch": 0.0254}
"""Metres of each unit."""
AXES = ("x", "y", "z")
RATES = (1.0, 1000.0)
ORDERS = {"sbu15": "SBU", "k3hi15": "K3HI"}
"""Display names of joint orders that share a number of joints."""
_FPS = 30.0
# Metres from ankles to head: the smallest and the tallest person.
_TALL = (0.9, 2.0)


@dataclass(frozen=True)
class ImportChoices:
    """Known facts about a file; a field that is None is found from its contents.

    Attributes:
        up: the axis that points up: "x", "y" or "z".
        unit: "m", "cm", "mm" or "inch".
        fps: frames a second; overrides the file.
        order: order of joints without names: a key of :data:`~motion.SKELETONS`, such as
            "sbu15" or "k3hi15".
        animation: the name or the number, from 1, of the one to read of a .glb with several.
    """

    up: str | None = None
    unit: str | None = None
    fps: float | None = None
    order: str | None = None
    animation: Animation | None = None

    def __post_init__(self) -> None:
        check_animation(self.animation)
        if self.up is not None and self.up not in AXES:
            raise InputError(f"Up axis {self.up!r:.20} is not known: choose x, y or z.")
        if self.unit is not None and self.unit not in UNITS:
            raise InputError(f"Unit {self.unit!r:.20} is not known: choose one of {', '.join(UNITS)}.")
        if self.fps is not None and not RATES[0] <= self.fps <= RATES[1]:
            raise InputError(f"A frame rate of {self.fps:g} is not possible: give {RATES[0]:g} to 1,000.")
        if self.order is not None and self.order not in SKELETONS:
            raise InputError(
                f"Joint order {self.order!r:.20} is not known: choose one of {', '.join(SKELETONS)}."
            )


@dataclass(frozen=True)
class Imported:
    """A motion and how it was interpreted.

    Attributes:
        people: all people in the file, in metres, Y up. Joints that must be fitted, as a Kinect's, are the
            file's own. The two of a pair come first.
        up: the file's axis that points up.
        unit: its unit; "none" if its lengths were scaled to an average person.
        fps: its frames a second.
        joints: (joint of the file, joint of SMPL22).
        order: joint order of an array, if several orders have that number of joints.
        animations: those of a .glb file, and which of them this is; None for any other file.
        asks_rate: True if the file does not give its frame rate, and nobody did.
    """

    people: tuple[Clip, ...]
    up: str
    unit: str
    fps: float
    joints: tuple[tuple[str, str], ...] = field(repr=False)
    order: str | None = None
    animations: Animations | None = None
    asks_rate: bool = False

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on how well the file could be read, and on which animation was taken."""
        chosen = (self.animations.note,) if self.animations and self.animations.note else ()
        return (*chosen, *dict.fromkeys(note for person in self.people for note in person.notes))

    @cached_property
    def motion(self) -> Clip | Duet:
        """The person, or the first two, on SMPL22; fitting takes about 5 ms a frame and person."""
        return to_smpl(Duet(self.people[0], self.people[1]) if len(self.people) > 1 else self.people[0])

    def describe(self) -> str:
        """One line, such as "22 joints matched, cm, Z up, 120 frames a second"."""
        unit = "no unit (scaled to a person)" if self.unit == "none" else self.unit
        order = "" if self.order is None else f" in the order of {ORDERS[self.order]}"
        count = f"{len(self.people)} people, " if len(self.people) > 2 else ""
        return (
            f"{count}{len(self.joints)} joints matched{order}, {unit}, {self.up.upper()} up, "
            f"{self.fps:g} frames a second"
        )


def import_motion(
    source: str | Path | bytes, *, name: str | None = None, choices: ImportChoices | None = None
) -> Imported:
    """Reads a motion file as :func:`motion.formats.read` does, and says how.

    Args:
        source: the file, or its bytes; then ``name`` must end in its suffix.
        name: what to call it in messages.
        choices: what is known of the file.

    Raises:
        InputError: one sentence saying what is wrong with the file or with a choice.
    """
    choices = choices or ImportChoices()
    label = name or Path(str(source)).name
    if Path(label).suffix.lower() == ".glb":
        people_in, animations = read_glb(source, name=name, animation=choices.animation)
        return replace(_import_rigs(people_in, choices), animations=animations)
    if choices.animation is not None:
        raise InputError(NO_ANIMATIONS.format(label))
    if Path(label).suffix.lower() in RIGS:
        rigs = read_rigs(source, name=name, fps=_FPS, file_fps=choices.fps)
        return _import_rigs(rigs, choices)
    people = tuple(
        _ordered(clip, choices.order, label) for clip in clips_of(read_everyone(source, name=name))
    )
    if choices.fps is not None:
        people = tuple(_without_rate_note(clip) for clip in people)
    asks_rate = any(says_no_rate(note) for clip in people for note in clip.notes)
    up = choices.up or _up_of(people[0])
    unit = choices.unit or _unit_of(people[0], "xyz".index(up))
    people = tuple(_upright(clip, up, UNITS[unit], choices.fps or clip.fps) for clip in people)
    _check_length(people[0], label)
    skeleton = people[0].skeleton
    layout = LAYOUTS[skeleton.name]
    joints = tuple(
        (theirs, SMPL22.joint_names[ours])
        for theirs, ours in zip(skeleton.joint_names, layout.joints, strict=True)
        if ours >= 0
    )
    order = skeleton.name if skeleton.name in ORDERS else None
    return Imported(people, up, unit, people[0].fps, joints, order, asks_rate=asks_rate)


def _without_rate_note(clip: Clip) -> Clip:
    return replace(clip, notes=tuple(note for note in clip.notes if not says_no_rate(note)))


def _ordered(clip: Clip, order: str | None, label: str) -> Clip:
    """The clip with its joints taken in the order that is known of them."""
    if order is None or order == clip.skeleton.name:
        return clip
    wanted = SKELETONS[order]
    if wanted.num_joints != clip.skeleton.num_joints:
        raise InputError(
            f"{label} has {clip.skeleton.num_joints} joints a frame, but the order of "
            f"{ORDERS.get(order, order)} has {wanted.num_joints}: leave the order on automatic."
        )
    return replace(clip, skeleton=wanted)


def _import_rigs(rigs: tuple[RigMotion, ...], choices: ImportChoices) -> Imported:
    found = [_import_rig(rig, choices) for rig in rigs]
    if len(rigs) > 1 and not any(own_clip(rig) for rig in rigs):
        known = [_with_choices(rig, choices) for rig in rigs]
        pair = retarget_duet(known[0], known[1])
        return replace(found[0], people=(*pair.people, *(one.people[0] for one in found[2:])))
    return replace(found[0], people=tuple(one.people[0] for one in found))


def _import_rig(rig: RigMotion, choices: ImportChoices) -> Imported:
    own = own_clip(rig)
    rig = _with_choices(rig, choices)
    _check_length(rig, rig.name)
    joints = tuple(matched_names(rig))
    unit = next((n for n, metres in UNITS.items() if np.isclose(metres, rig.metres_per_unit)), "none")
    keep = own is not None and (choices.up, choices.unit, choices.fps) == (None, None, None)
    clip = own if keep and own else retarget(rig, fps=_FPS)
    return Imported((clip,), up_axis(rig), unit, rig.fps * rig.every, joints)


def _with_choices(rig: RigMotion, choices: ImportChoices) -> RigMotion:
    if choices.unit is not None:
        scale = UNITS[choices.unit] / rig.metres_per_unit
        rig = replace(
            rig,
            positions=rig.positions * scale,
            offsets=rig.offsets * scale,
            metres_per_unit=UNITS[choices.unit],
        )
    return replace(rig, up=choices.up, fps=choices.fps / rig.every if choices.fps else rig.fps)


def _check_length(motion: Clip | RigMotion, label: str) -> None:
    seconds = motion.num_frames / motion.fps
    if seconds > MAX_SECONDS:
        raise InputError(
            f"At {motion.fps:g} frames a second {label} lasts {seconds:.0f} s, more than {MAX_SECONDS:.0f} s "
            "allowed: cut it or give its true rate."
        )


def _tall(clip: Clip) -> Array:
    """(3,) the median way from the ankles to the head, in the file's axes and unit."""
    layout = LAYOUTS[clip.skeleton.name]
    column = {SMPL22.joint_names[ours]: theirs for theirs, ours in enumerate(layout.joints) if ours >= 0}
    ankles = [column["left_ankle"], column["right_ankle"]]
    return np.median(clip.positions[:, column["head"]] - clip.positions[:, ankles].mean(axis=1), axis=0)


def _up_of(clip: Clip) -> str:
    """The axis along which people are tall, if it is clear; arrays are Y up by our own contract."""
    tall = np.abs(_tall(clip))
    axis = int(np.argmax(tall))
    return "xyz"[axis] if tall[axis] > 0.9 * np.linalg.norm(tall) else "y"


def _unit_of(clip: Clip, axis: int) -> str:
    """The unit in which a standing person is as tall as people are; metres where none fits."""
    tall = abs(float(_tall(clip)[axis]))
    return next((unit for unit, metres in UNITS.items() if _TALL[0] <= tall * metres <= _TALL[1]), "m")


def _upright(clip: Clip, up: str, metres: float, fps: float) -> Clip:
    """The clip in metres, Y up; the very same positions where nothing is to be changed."""
    if up == "y" and metres == 1.0:
        return clip if fps == clip.fps else replace(clip, fps=fps)
    positions = clip.positions.astype(np.float64) * metres
    if up == "z":
        positions = positions[..., [0, 2, 1]] * np.array([1.0, 1.0, -1.0])
    elif up == "x":
        positions = positions[..., [1, 0, 2]] * np.array([-1.0, 1.0, 1.0])
    return Clip(positions.astype(np.float32), fps, clip.skeleton, name=clip.name, notes=clip.notes)
