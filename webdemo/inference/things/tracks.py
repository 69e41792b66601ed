"""Tracks of things: from hand to hand, through the air, and at rest."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.easing import smoothstep
from motion.things import Mesh

from .holding import Track, frame_of

Array = NDArray[np.floating]

GRAVITY = 9.81
ROLLS = 2.5
"""Metres a second with which a thing that is rolled sets off."""
BLEND = 0.13
"""Seconds on either side of a moment over which a thing goes from one hand to another."""
_LIES = ("book", "phone", "flower", "sword", "stick", "ring", "guitar", "umbrella", "cigarette")
"""Kinds that lie when they are put down; others stand."""


class Course:
    """A track that follows one track after another.

    Args:
        first: the track that it begins with.
        fps: frames a second.
    """

    def __init__(self, first: Track, fps: float) -> None:
        self.places, self.rotations = first[0].copy(), first[1].copy()
        self.fps = fps

    def then(self, frame: int, track: Track, seconds: float = BLEND) -> None:
        """From a frame on it follows another track; ``seconds`` on either side it is between both."""
        half = max(seconds * self.fps, 0.5)
        share = smoothstep((np.arange(len(self.places)) - frame + half) / (2 * half))
        self.places += share[:, None] * (track[0] - self.places)
        self.rotations = between(self.rotations, track[1], share)

    def cut_to(self, frame: int, track: Track) -> None:
        """From a frame on it follows another track, at once."""
        self.places[frame:], self.rotations[frame:] = track[0][frame:], track[1][frame:]

    @property
    def track(self) -> Track:
        """Places (T, 3) and rotations (T, 3, 3)."""
        return self.places, self.rotations


def between(one: Array, other: Array, share: Array) -> Array:
    """(T, 3, 3) rotations ``share`` (T,) of the way from one track to another, along the shortest turn."""
    turn = Rotation.from_matrix(np.swapaxes(one, 1, 2) @ other).as_rotvec()
    return one @ Rotation.from_rotvec(share[:, None] * turn).as_matrix()


def thrown(course: Course, start: int, stop: int, goal: Array) -> None:
    """Lets a thing fly along a parabola from where it is at ``start`` to ``goal`` (3,) at ``stop``, turning forward."""
    count = len(course.places)
    now = (np.arange(start, min(stop, count - 1) + 1) - start) / course.fps
    seconds = (stop - start) / course.fps
    begin = course.places[start].copy()
    speed = (goal - begin) / seconds + np.array([0.0, GRAVITY * seconds / 2, 0.0])
    way = begin + now[:, None] * speed - np.array([0.0, GRAVITY / 2, 0.0]) * now[:, None] ** 2
    axis = np.cross([0.0, 1.0, 0.0], goal - begin)
    axis = axis / max(float(np.linalg.norm(axis)), 1e-9)
    spin = Rotation.from_rotvec(axis * (2 * np.pi * now / max(seconds, 0.8))[:, None]).as_matrix()
    course.rotations[start : start + len(now)] = spin @ course.rotations[start]
    course.places[start : start + len(now)] = way
    course.places[start + len(now) :] = way[-1]
    course.rotations[start + len(now) :] = course.rotations[start + len(now) - 1]


def rolled(course: Course, start: int, goal: Array, radius: float) -> None:
    """Lets a round thing down where it is at a frame, and roll from there over the floor to below ``goal`` (3,)."""
    begin, count = course.places[start].copy(), len(course.places)
    way = (np.asarray(goal) - begin) * [1, 0, 1]
    length = float(np.linalg.norm(way))
    ahead = way / max(length, 1e-9)
    now = (np.arange(start, count) - start) / course.fps
    share = np.clip(now * ROLLS / (2 * max(length, 0.1)), 0.0, 1.0)
    along = length * (1 - (1 - share) ** 2)  # it slows down evenly
    drop = np.maximum(begin[1] - radius - GRAVITY / 2 * now**2, 0.0)
    course.places[start:] = begin * [1, 0, 1] + along[:, None] * ahead
    course.places[start:, 1] = radius + drop
    axis = np.cross([0.0, 1.0, 0.0], ahead)
    spin = Rotation.from_rotvec(axis * (along / radius)[:, None]).as_matrix()
    course.rotations[start:] = spin @ course.rotations[start]


def bounced(course: Course, under: Array, start: int, stop: int, radius: float) -> None:
    """Lets a ball bounce from a hand that goes up and down.

    It is under the hand on its way down, and on the hand's way up it is on the floor and back.

    Args:
        course: of the ball.
        under: (T, 3) where it is under the hand.
        start, stop: frames of the hand's strokes.
        radius: of the ball.
    """
    height = scipy.ndimage.gaussian_filter1d(under[:, 1], 1.0)
    lows, highs = (
        start + scipy.signal.find_peaks(sign * height[start:stop], prominence=0.04)[0] for sign in (-1.0, 1.0)
    )
    if not len(lows):
        return
    course.then(int(lows[0]), (under, course.rotations), BLEND)
    for low in lows:
        later = highs[highs > low]
        if not len(later):
            break
        now = np.arange(low, later[0] + 1)
        share = (now - low) / (later[0] - low)
        down = np.minimum(2 * share, 2 - 2 * share)  # 0 at the hand, 1 on the floor
        course.places[now] = under[now]
        course.places[now, 1] -= down * (under[now, 1] - radius)


def at_rest(kind: str, mesh: Mesh, place: Array, ahead: Array, frames: int) -> Track:
    """A thing that lies or stands on a support: ``place`` (3,) is the spot on it, ``ahead`` (3,) a level direction."""
    ahead = np.asarray(ahead)[None]
    up = np.array([[0.0, 1.0, 0.0]])
    lies = kind in _LIES
    turned = frame_of(ahead, ahead, up)[0] if lies else frame_of(up, ahead, ahead)[0]
    lift = -(mesh.vertices @ turned.T)[:, 1].min()
    spot = np.asarray(place) + np.array([0.0, lift, 0.0])
    return np.tile(spot, (frames, 1)), np.tile(turned, (frames, 1, 1))


def put(course: Course, frame: int, rest: Track) -> None:
    """Lets a thing go at a frame: it comes down on its rest as fast as it would fall, not slower than 0.2 s."""
    drop = max(float(course.places[frame, 1] - rest[0][frame, 1]), 0.0)
    seconds = max(np.sqrt(2 * drop / GRAVITY), 0.2)
    count = len(course.places)
    now = (np.arange(count) - frame) / course.fps
    share = np.clip(now / seconds, 0.0, 1.0)
    fallen = course.places[frame] * np.ones((count, 1))
    eased = smoothstep(share)
    fallen[:, [0, 2]] += eased[:, None] * (rest[0] - fallen)[:, [0, 2]]
    fallen[:, 1] += share**2 * (rest[0][:, 1] - fallen[:, 1])
    held = np.tile(course.rotations[frame], (count, 1, 1))
    course.cut_to(frame, (fallen, between(held, rest[1], eased)))
