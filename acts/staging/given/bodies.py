"""Whole bodies on the spot, as the network is given them: single limbs that move, bows, and figures."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from motion import FPS, SMPL22
from motion.skeleton import ARMS

from ..bodies.figures import figured
from ..bodies.limbs import WITH_ARMS, Limb, limbed
from ..bodies.poses import HANDS, bowed, standing
from ..bodies.steps import stepped
from ..floor import Standing
from ..parts import KnownFrames, Part
from ..postures import Change, Posture
from ..told import Told
from ..track import HALT
from .hands import SHORT, late_by
from .postures import BOWED, DEEP, RISING, Pose, led, postures
from .stretch import Stretch

Array = NDArray[np.floating]

LIMBED = 3
"""Frames between two poses of a person who moves single limbs or does a figure."""
SETTLES = 24
"""Frames that changing to another stance takes."""
DOWN = 0.35
"""Height in metres of the pelvis of a person on the ground, who has to get up before a figure."""
SHORTEST = 20
"""Frames for which a figure is begun, at least."""
_SEEN = 6
"""Frames between two poses of a figure that are looked at for the room that it needs."""


def given_bow(person: int, told: Told, beat: Stretch, seed: int) -> list[Part]:
    """The body of a person who bows on the spot, as far as it falls into a window."""
    times, deep = told.bows["ab"[person]]
    frames = beat.every(LIMBED, SETTLES // 2 if beat.start else 0)
    if not len(frames):  # of a beat of which only the way to the next one is in the window
        return []
    angle, seconds = float(beat.stand.headings[person]), (frames + beat.start) / FPS
    stands = standing(halted(person, beat), angle, seconds, seed=seed + person)
    late, lean = late_by(seed, person), DEEP if deep else BOWED
    poses = bowed(stands, angle, frames / FPS - late, beat.frames / FPS - late, times, lean)
    return [beat.given(person, frames, poses, all_but(()))]


def given_limbs(limbs: Sequence[Limb], person: int, told: Told, beat: Stretch, seed: int) -> list[Part]:
    """The body of a person who moves single limbs, as far as it falls into a window.

    Their arms hang, unless their hands have something else to do: a network that is free there crosses them.
    """
    frames = beat.every(LIMBED, SETTLES // 2 if beat.start else 0)
    if not len(frames):
        return []
    angle, seconds = float(beat.stand.headings[person]), beat.frames / FPS
    poses = limbed(limbs, halted(person, beat), angle, frames / FPS, seconds)
    if not any(limb.does in WITH_ARMS for limb in limbs):
        stands = standing(halted(person, beat), angle, (frames + beat.start) / FPS, seed=seed + person)
        for shoulder, *arm in ARMS:
            poses[:, arm] = poses[:, [shoulder]] + stands[:, arm] - stands[:, [shoulder]]
    busy = "ab"[person] in told.gestures or told.contact is not None
    free = HANDS if busy and not any(limb.does in WITH_ARMS for limb in limbs) else ()
    return [replace(beat.given(person, frames, poses, all_but(free)), kept=True)]


def given_steps(gait: str, person: int, told: Told, beat: Stretch) -> list[Part]:
    """The body of a person who limps or walks on tiptoe along a way, as far as it falls into a window."""
    course = beat.course(person)
    poses = stepped(gait, course.places, course.headings)
    if not len(frames := beat.every(LIMBED, SETTLES // 2 if beat.start else 0)):
        return []
    joints = all_but(HANDS if "ab"[person] in told.gestures else ())
    return [replace(beat.given(person, frames, poses[frames], joints), kept=True)]


def given_figure(story: Sequence[Told], person: int, beat: Stretch, last: Array | None, seed: int) -> list[Part]:
    """The body of a person who does a figure, as far as it falls into a window; one who is down gets up before.

    Args:
        story: what all beats tell.
        person: 0 for a, 1 for b.
        beat: the beat.
        last: (22, 3) the person before it; None in a first beat.
        seed: draws how late they are, and how they waver.
    """
    parts: list[Part] = []
    first = SETTLES // 2 if beat.start else 0
    if last is not None and last[0, 1] <= DOWN:
        first = min(RISING, beat.frames)
        rising = _getting_up(story, person, beat, last)
        for joints, at, known in led(rising, beat.window.start, beat.window.stop):
            parts.append(beat.given(person, np.asarray(at) - beat.start, known, joints))
    frames, poses = _figure(story[beat.window.beat], person, beat, first, seed)
    if len(shown := np.isin(frames, beat.shown(frames)).nonzero()[0]):
        given: KnownFrames = beat.given(person, frames[shown], poses[shown], all_but(()))
        parts.append(replace(given, kept=True))
    return parts


def figure_poses(told: Told, person: int, beat: Stretch, seed: int) -> list[Pose]:
    """Some poses of a figure, with their frames of the scene, that show the room it needs."""
    frames, poses = _figure(told, person, beat, 0, seed)
    return [(int(frame) + beat.start, pose) for frame, pose in zip(frames, poses, strict=True)][:: _SEEN // LIMBED]


def _figure(told: Told, person: int, beat: Stretch, first: int, seed: int) -> tuple[NDArray[np.integer], Array]:
    """Frames (N,) of a beat and the poses (N, 22, 3) of a figure that begins with its ``first`` frame, or later."""
    figure, angle = told.figures["ab"[person]], float(beat.stand.headings[person])
    together = figure.meets or figure.in_time
    late = 0.0 if together else late_by(seed, person) * min(1.0, beat.frames / SHORT)
    count = beat.frames - first
    if count < SHORTEST:
        return np.zeros(0, dtype=int), np.zeros((0, SMPL22.num_joints, 3))
    figure = replace(figure, late=figure.late + late)
    poses = figured(figure, halted(person, beat), angle, count, seed + person)
    frames = np.union1d(np.arange(0, count, LIMBED), [count - 1])
    return frames + first, poses[frames]


def _getting_up(story: Sequence[Told], person: int, beat: Stretch, last: Array) -> list[Pose]:
    """The poses of a person who gets up before a figure."""
    number = beat.window.beat
    up = replace(story[number], figures={}, changes={"ab"[person]: (Change(Posture.STANDS),)})
    told = [*story[:number], up, *story[number + 1 :]]
    found = postures(told, number, person, beat.start, beat.stop, beat.stand, last)
    return [pose for pose in found if pose[0] < beat.start + min(RISING, beat.frames)]


def halted(person: int, beat: Stretch) -> Array:
    """The place (x, z) at which a person comes to a halt."""
    stand: Standing = beat.stand
    return np.asarray(stand.places[person] + (HALT * stand.speeds[person] if beat.start else 0.0))


def all_but(free: Collection[int]) -> list[int]:
    """All joints of a body but some."""
    return [joint for joint in range(SMPL22.num_joints) if joint not in free]
