"""The hands of people whose way or posture the words of a beat give, as the network is given them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22
from motion.transforms import heading_matrix
from webdemo.inference.actor import FPS
from webdemo.inference.known_parts import KnownFrames
from webdemo.inference.story.floor import Way2D
from webdemo.inference.story.gestures import Gesture, Hand, wrist
from webdemo.inference.story.moves import Move
from webdemo.inference.story.told import Told
from webdemo.inference.story.ways import Way

from .scene_stretch import Frames, Stretch

Array = NDArray[np.floating]

BEGINS = 15
"""Frames of a beat before a hand is given."""
OFTEN = 4
"""Frames between two given places of a hand."""
ARRIVED = 0.15
"""Metres from where a person stays, at most, at which their hands begin with a thing."""


def hands(
    told: Told, moves: Sequence[Move], posed: Mapping[int, Array], stretch: Stretch
) -> dict[int, tuple[Gesture, Frames, Array]]:
    """The gestures of those whose way or posture is given.

    Args:
        told: by the beat.
        moves: of the beat, where they were changed since.
        posed: a pose (22, 3) of those whose posture is given, by person.
        stretch: the beat.

    Returns:
        By person the gesture, the frames of the beat (N,) and the wrists' places beside the pelvis in the scene's
        world, (N, sides, 3) metres.
    """
    found = dict(told.gestures)
    if {move.way for move in moves if move.linked} == {Way.ALONG}:
        around = {who for who, gesture in found.items() if gesture.hand is Hand.AROUND}
        for who, side in _inner(stretch.ways).items():
            if who in around or not around:
                found[who] = Gesture(Hand.AROUND if around else Hand.LINKED, (side,))
    courses = [stretch.course(person) for person in (0, 1)]
    always = np.arange(BEGINS, stretch.frames, OFTEN)
    ways = {("ab".index(move.person), move.way) for move in moves}
    made: dict[int, tuple[Gesture, Frames, Array]] = {}
    for person in (0, 1):
        gesture = found.get("ab"[person])
        if gesture is None or not (person in stretch.ways or person in posed) or not len(always):
            continue  # the network makes the gesture
        own, other = courses[person], courses[1 - person]
        at = _there(own.places, always) if (person, Way.THING) in ways else always
        turns = np.stack([heading_matrix(angle) for angle in own.headings[at]])
        line = np.insert(other.places[at] - own.places[at], 1, 0.0, axis=1)
        line /= np.linalg.norm(line, axis=1, keepdims=True).clip(min=1e-6)
        towards = np.einsum("nji,nj->ni", turns, line)
        wrists = np.stack([wrist(gesture, side, at / FPS, towards) for side in gesture.sides], axis=1)
        made[person] = (gesture, at, np.einsum("nij,nsj->nsi", turns, wrists))
    return made


def _there(places: Array, frames: Frames) -> Frames:
    """Those of some frames at which a person has come to where they stay; the last one, if they are never there."""
    short = np.linalg.norm(places[frames] - places[-1], axis=1)
    return frames[short < ARRIVED] if (short < ARRIVED).any() else frames[-1:]


def known_hands(
    person: int, gesture: Gesture, frames: Frames, wrists: Array, stretch: Stretch
) -> KnownFrames:
    """The wrists (N, sides, 3) of a person at some frames of a beat, as the network is given them."""
    joints = [SMPL22.index(f"{side}_wrist") for side in gesture.sides]
    poses = np.zeros((len(frames), SMPL22.num_joints, 3))
    poses[:, joints] = wrists
    return stretch.given(person, frames, poses, joints)


def _inner(ways: Mapping[int, Way2D]) -> dict[str, str]:
    """The hand of each of two people side by side that is next to the other."""
    if len(ways) < 2 or any(way.headings is None for way in ways.values()):
        return {}
    line = ways[1].places[-1] - ways[0].places[-1]
    angle = float(np.nan_to_num(np.asarray(ways[0].headings)[-1]))
    left = line @ np.array([np.cos(angle), -np.sin(angle)]) > 0
    return {"a": "left", "b": "right"} if left else {"a": "right", "b": "left"}
