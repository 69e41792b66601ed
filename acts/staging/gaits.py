"""Gaits that no caption of the training data shows: people crawl, walk on their knees, limp, skip, or sneak on tiptoe.

The whole body is given. Of people on hands and knees it is one pose a place, its phase the way that was gone. Of people
on two feet, footprints are laid along the way, each in the middle of the time for which its foot carries the body; the
other foot swings to its next one meanwhile, and two-bone IK gives the knees.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy  # its parts are loaded with their first use

from motion import FPS, SMPL22
from motion.limbs import solve_two_bones
from motion.skeleton import LEGS
from motion.smoothing import minimum_jerk
from motion.transforms import heading_matrix
from motion.vectors import Array

from .poses import BOTH_SIDES, HANDS, JOINT, SOLE, STANDS, Turns, about, all_but, poses_of
from .score import Score
from .window import OFTEN, SETTLES, Part, Stretch

GETS_DOWN = 40
"""Frames in which somebody gets down on hands and knees."""
CYCLE = 0.46
"""Metres of two steps, so that a knee stays where it was set down while the other one moves."""
_SWING, _LIFT = 0.3, 0.12
"""Radians of a thigh or an arm to either side of the vertical, and by which a knee is bent more as it comes forward."""
_LEVEL, _TALL = 1.35, 0.08
"""Radians by which the trunk of a person leans who crawls, and who walks on the knees."""


def low_gait(gait: str, places: Array, headings: Array) -> Array:
    """A person who goes low over the floor.

    Args:
        gait: a name of :data:`GAITS`.
        places: (N, 2) x and z of the pelvis in metres, one after another.
        headings: (N,) radians from +Z towards +X.

    Returns:
        (N, 22, 3) metres, on the floor.
    """
    steps = np.linalg.norm(np.diff(places, axis=0, prepend=places[:1]), axis=1)
    phase = 2 * math.pi * np.cumsum(steps) / CYCLE
    poses = poses_of(GAITS[gait](phase, headings), len(places))
    poses += np.insert(places, 1, SOLE - poses[..., 1].min(axis=1), axis=1)[:, None]
    return poses


def on_all_fours(place: Array, angle: float) -> Array:
    """Somebody on hands and knees, the pelvis over a place (x, z) and the face to a heading: (22, 3) metres."""
    return low_gait("crawls", np.asarray(place, dtype=float)[None], np.array([angle]))[0]


def _crawls(phase: Array, headings: Array) -> Turns:
    """On hands and knees; a hand and the knee of the other side move together."""
    turns: Turns = _on_knees(phase, headings, _LEVEL) | {"neck": about(0, -0.5)}
    for side, sign in BOTH_SIDES:
        arm = about(0, math.pi / 2 - _LEVEL + _SWING * np.sin(phase + (math.pi if sign > 0 else 0.0)))
        turns[f"{side}_shoulder"] = arm @ heading_matrix(-sign * 1.5)
    return turns


def _kneels(phase: Array, headings: Array) -> Turns:
    """On the knees, the trunk upright and the arms hanging."""
    turns: Turns = _on_knees(phase, headings, _TALL)
    for side, sign in BOTH_SIDES:
        turns[f"{side}_shoulder"] = about(2, -sign * 1.35)
        turns[f"{side}_elbow"] = heading_matrix(-sign * 0.4)
    return turns


def _on_knees(phase: Array, headings: Array, lean: float) -> Turns:
    """Thighs that swing about the vertical and shins that lie on the floor."""
    turns: Turns = {"pelvis": heading_matrix(headings) @ about(0, lean)}
    for side, sign in BOTH_SIDES:
        own = phase + (0.0 if sign > 0 else math.pi)
        swing, lift = _SWING * np.sin(own), _LIFT * np.maximum(-np.cos(own), 0.0)
        turns[f"{side}_hip"] = about(0, swing - lift - lean)
        turns[f"{side}_knee"] = about(0, math.pi / 2 - swing + lift)
        turns[f"{side}_ankle"] = about(0, 0.95)
    return turns


GAITS: Mapping[str, Callable[[Array, Array], Turns]] = {"crawls": _crawls, "on the knees": _kneels}
"""The gaits: rotations of joints, of the phase (N,) in radians and of the heading (N,)."""


def low_gait_parts(gait: str, person: int, down: Collection[int], stretch: Stretch) -> list[Part]:
    """The poses of a person who crawls or walks on the knees along a way.

    Args:
        gait: of :data:`GAITS`.
        person: 0 for a, 1 for b.
        down: the people who are down already when the beat begins; the others get down first.
        stretch: the beat.
    """
    course = stretch.course(person)
    poses = low_gait(gait, course.places, course.headings)
    first = GETS_DOWN if stretch.start and person not in down else 0
    frames = np.union1d(np.arange(first, stretch.frames, OFTEN), [stretch.frames - 1])
    frames = stretch.shown(frames)
    return [stretch.known(person, frames, poses[frames])] if len(frames) else []


_SWINGS = 0.43
"""Share of a cycle in which a foot swings."""
_TURNED = 0.2
"""Metres that are walked on the spot for each radian of a turn."""
_TAKES = 0.64
"""Seconds of a step, at least: who goes faster takes longer steps."""
_FLIGHT = 0.24
"""Share of a step from the middle of a hop to its end: as long as a body in free fall takes."""
_LAST = 0.12
"""Share of a cycle by which the last footprint of a foot may be behind the other one."""
_AHEAD = 0.33
"""Share of a cycle by which it may land before the body."""
_WIDE = 0.1
"""Metres of a foot beside the line that is walked."""
_REACH = 0.985
"""Share of a leg's length that is used at most."""
_ROUND = 5.0
"""Frames over which a way that is given now and then is rounded."""
_EVEN = 4.0
"""Frames over which the height of the hips is evened out."""
_TOE = SMPL22.offsets[JOINT["left_foot"]]
_LEG = float(SMPL22.bone_lengths[JOINT["left_knee"]] + SMPL22.bone_lengths[JOINT["left_ankle"]])


@dataclass(frozen=True)
class Gait:
    """A gait on two feet.

    Attributes:
        length: metres of a step.
        lift: metres by which a foot is raised (left, right).
        heels: radians by which the heels are up.
        sinks: metres by which the hips are lower than legs would let them be.
        pitch, arms: radians by which the trunk leans ahead and the elbows are bent.
        lurch: radians by which the trunk leans over the right leg while that carries the body.
        short: metres by which the left foot falls short of its step, as the right leg carries the body only briefly.
        hops: metres by which the body leaves the floor on each leg while the other one swings.
    """

    length: float
    lift: tuple[float, float]
    heels: float = 0.0
    sinks: float = 0.02
    pitch: float = 0.04
    arms: float = 0.3
    lurch: float = 0.0
    short: float = 0.0
    hops: float = 0.0


STEPS: Mapping[str, Gait] = {
    "limps": Gait(0.44, (0.05, 0.025), sinks=0.03, pitch=0.12, arms=0.45, lurch=0.16, short=0.14),
    "on tiptoe": Gait(0.4, (0.1, 0.1), heels=0.75, sinks=0.05, pitch=0.16, arms=0.9),
    "skips": Gait(0.6, (0.3, 0.3), heels=0.3, sinks=0.05, arms=0.6, hops=0.13),
}
"""The gaits by their names in the lexicon."""


def stepped(gait: str, places: Array, headings: Array) -> Array:
    """A person who walks with a gait.

    Args:
        gait: a name of :data:`STEPS`.
        places: (N, 2) x and z of the pelvis in metres, one a frame.
        headings: (N,) radians from +Z towards +X.

    Returns:
        (N, 22, 3) metres, on the floor.
    """
    steps = STEPS[gait]
    places, headings = (
        scipy.ndimage.gaussian_filter1d(values, _ROUND, axis=0, mode="nearest")
        for values in (np.asarray(places, dtype=float), np.unwrap(headings))
    )
    gone = np.linalg.norm(np.diff(places, axis=0, prepend=places[:1]), axis=1)
    steps = replace(steps, length=max(steps.length, _TAKES * float(np.percentile(gone, 80)) * FPS))
    gone = np.cumsum(gone + _TURNED * np.abs(np.diff(headings, prepend=headings[:1])))
    cycles = max(round(float(gone[-1]) / steps.length), 1) / 2 if gone[-1] > steps.length / 2 else 0.0
    phase = cycles * gone / max(float(gone[-1]), 1e-6)
    feet = [_foot(steps, side, phase, cycles, places, headings) for side in range(2)]
    poses = poses_of(_trunk(steps, phase, headings), len(places))
    ankles = [_ankle(steps, toe, sign, headings) for toe, (_, sign) in zip(feet, BOTH_SIDES, strict=True)]
    poses += np.insert(places, 1, _height(steps, poses, places, ankles), axis=1)[:, None]
    ahead = np.stack([np.sin(headings), np.zeros(len(headings)), np.cos(headings)], axis=1)
    for (hip, knee, ankle, toe), goal, foot in zip(LEGS, ankles, feet, strict=True):
        sole = foot - goal
        poses[:, knee], poses[:, ankle] = solve_two_bones(
            poses[:, hip], poses[:, knee], poses[:, ankle], goal, ahead, soft=0.01
        )
        poses[:, toe] = poses[:, ankle] + sole
    hop = (2 * phase - _SWINGS + 0.5) % 1.0 - 0.5  # of a step, from the middle of a swing
    poses[..., 1] += steps.hops * np.maximum(1 - (hop / _FLIGHT) ** 2, 0.0)[:, None]
    return poses


def _foot(steps: Gait, side: int, phase: Array, cycles: float, places: Array, headings: Array) -> Array:
    """The way (N, 3) of a toe from footprint to footprint."""
    sign, ahead = BOTH_SIDES[side][1], side / 2  # the right foot is half a cycle ahead
    own = phase + ahead
    number, share = np.floor(own + 1e-9), own - np.floor(own + 1e-9)
    late = steps.short / (2 * steps.length) if sign > 0 else 0.0
    time = np.arange(len(phase))

    def print_of(count: Array) -> Array:
        """(N, 3) the footprint of the stance of a cycle: where the body is in the middle of it, or begins, or ends."""
        middle = count + (1 + _SWINGS) / 2 - ahead - late
        last = count + 1 - ahead >= cycles - 1e-6
        nearer = np.maximum(middle, np.minimum(cycles - _LAST, count - ahead + _SWINGS + _AHEAD))
        middle = np.clip(np.where(last, nearer, middle), 0.0, cycles)
        at = np.interp(middle, phase + 1e-9 * time, time)
        place = np.stack([np.interp(at, time, places[:, i]) for i in (0, 1)], axis=1)
        angle = np.interp(at, time, np.unwrap(headings))
        across = np.stack([np.cos(angle), -np.sin(angle)], axis=1)
        line = np.stack([np.sin(angle), np.cos(angle)], axis=1)
        return np.insert(place + sign * _WIDE * across + float(_TOE[2]) * line, 1, SOLE, axis=1)

    swung = minimum_jerk(share / _SWINGS)[:, None]
    way = print_of(number - 1) + swung * (print_of(number) - print_of(number - 1))
    up = np.clip(share / _SWINGS, 0.0, 1.0)
    way[:, 1] += steps.lift[side] * (4 * up * (1 - up)) ** 3
    return way


def _ankle(steps: Gait, toe: Array, sign: float, headings: Array) -> Array:
    """(N, 3) the ankle over a toe whose heel is up."""
    sole = about(0, steps.heels) @ (_TOE * [sign, 1.0, 1.0])
    return toe - heading_matrix(headings) @ sole


def _height(steps: Gait, poses: Array, places: Array, ankles: list[Array]) -> Array:
    """(N,) metres of the pelvis from which both feet are within reach."""
    heights = []
    for (hip, *_), ankle in zip(LEGS, ankles, strict=True):
        offset = poses[:, hip]
        apart = np.linalg.norm(ankle[:, [0, 2]] - places - offset[:, [0, 2]], axis=1)
        reach = np.sqrt(np.maximum((_REACH * _LEG) ** 2 - apart**2, 0.01))
        heights.append(ankle[:, 1] + reach - offset[:, 1])
    lowest = scipy.ndimage.minimum_filter1d(np.minimum(*heights), 5)
    return np.asarray(scipy.ndimage.gaussian_filter1d(lowest, _EVEN, mode="nearest") - steps.sinks)


def _trunk(steps: Gait, phase: Array, headings: Array) -> Turns:
    """A trunk that leans over the leg that hurts, and arms that swing a little."""
    cycle = 2 * np.pi * phase
    over = 0.5 + 0.5 * np.cos(cycle - np.pi * _SWINGS)  # 1 while the left foot swings
    over *= minimum_jerk(np.arange(len(phase)) / 12)
    lean = about(0, steps.pitch / 2) @ about(2, steps.lurch * over / 2)
    neck = about(2, -0.5 * steps.lurch * over)
    turns: Turns = {"pelvis": heading_matrix(headings), "spine1": lean, "spine2": lean, "neck": neck}
    for side, sign in BOTH_SIDES:
        turns[f"{side}_shoulder"] = about(0, 0.12 * sign * np.sin(cycle)) @ about(2, -sign * STANDS["shoulder"])
        turns[f"{side}_elbow"] = heading_matrix(-sign * steps.arms)
        turns[f"{side}_hip"] = about(0, -0.2)
        turns[f"{side}_knee"] = about(0, 0.4)
    return turns


def step_parts(gait: str, person: int, score: Score, beat: Stretch) -> list[Part]:
    """The body of a person who limps, skips or walks on tiptoe along a way, as far as it falls into a window."""
    course = beat.course(person)
    poses = stepped(gait, course.places, course.headings)
    if not len(frames := beat.every(OFTEN, SETTLES // 2 if beat.start else 0)):
        return []
    joints = all_but(HANDS if "ab"[person] in score.gestures else ())
    return [beat.known(person, frames, poses[frames], joints, kept=True)]
