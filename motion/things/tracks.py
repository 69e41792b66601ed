"""Tracks of things: in hands, from hand to hand, through the air, and at rest."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use

from motion.smoothing import smoothstep
from motion.vectors import FLAT, Array, left_of, rotations_by, slerp, square_frame, unit

from .hands import Hands, level, smoothed
from .thing import Mesh

Track = tuple[Array, Array]
"""Places (T, 3) and rotations (T, 3, 3)."""

GRAVITY = 9.81
ROLLS = 2.5
"""Metres a second with which a thing that is rolled sets off."""
BLEND = 0.13
"""Seconds on either side of a moment over which a thing goes from one hand to another."""
BEFORE_BODY = 0.17
"""Metres from the pelvis to the surface of the belly, and a little more."""
_LIES = ("book", "phone", "flower", "sword", "stick", "ring", "guitar", "umbrella", "cigarette")
"""Kinds that lie when they are put down; others stand."""
_UP = np.array([0.0, 1.0, 0.0])


# ---- in hands --------------------------------------------------------------------------------------------
def held(hands: Hands, person: int, side: int, kind: str, mesh: Mesh) -> Track:
    """The track of a thing in a person's hand, or before their trunk if it takes two hands."""
    if kind == "guitar":
        return _played(hands, person)
    if takes_both_hands(kind, mesh):
        return _before(hands, person, mesh)
    palm, out = hands.palms[person, side], hands.out[person, side]
    fingers, thumbs = hands.fingers[person, side], hands.thumbs[person, side]
    if kind == "ball":
        both = np.linalg.norm(hands.palms[person, 0] - hands.palms[person, 1], axis=-1) < 0.42
        one = palm + (mesh.size[0] / 2 - 0.005) * out
        two = hands.palms[person].mean(axis=0)
        share = smoothed(both.astype(float), 7)[:, None]
        return (1 - share) * one + share * two, square_frame(fingers, thumbs)
    if kind in ("sword", "stick"):
        return palm, square_frame(0.75 * fingers + 0.65 * thumbs, out)
    if kind in ("phone", "book"):
        return palm + 0.004 * out, facing_frame(fingers, out)
    if kind in ("flower", "ring"):
        return palm + 0.01 * out, square_frame(thumbs + 0.6 * _UP, fingers)
    if kind == "bag":
        return palm + 0.01 * out, upright_frame(fingers)
    # What has an upright stays upright, beside the palm that holds it.
    aside = 0.04 if kind == "cup" else 0.0
    return palm + aside * level(out), upright_frame(-out)


def takes_both_hands(kind: str, mesh: Mesh) -> bool:
    """True for a guitar and for what is held before the body."""
    return kind in ("guitar", "box") or float(mesh.size.max()) > 1.3


def _before(hands: Hands, person: int, mesh: Mesh) -> Track:
    """Between both hands, never inside the trunk."""
    ahead = hands.ahead[person]
    middle = hands.palms[person].mean(axis=0)
    pelvis = hands.joint(person, "pelvis")
    least = BEFORE_BODY + mesh.size[2] / 2
    out = np.einsum("ti,ti->t", middle - pelvis, ahead)
    aside = (middle - pelvis - out[:, None] * ahead) * FLAT
    place = middle + np.maximum(least - out, 0.0)[:, None] * ahead - 0.5 * aside
    return place, upright_frame(left_of(ahead))


def _played(hands: Hands, person: int) -> Track:
    """A guitar before the belly, its neck towards the left hand."""
    ahead = hands.ahead[person]
    left = left_of(ahead)
    belly = hands.joint(person, "spine1") + 0.19 * ahead - 0.1 * left
    neck = hands.palms[person, 0] - belly
    neck = neck - np.einsum("ti,ti->t", neck, ahead)[:, None] * ahead
    return belly, facing_frame(unit(neck) + 1.2 * left + 0.3 * _UP, ahead)


def facing_frame(up: Array, front: Array) -> Array:
    """(T, 3, 3) rotations whose Y column is along ``up`` and whose Z column is ``front`` made square to it."""
    return square_frame(up, np.cross(up, front))


def upright_frame(across: Array) -> Array:
    """(T, 3, 3) rotations about the vertical whose X column is along ``across`` (T, 3)."""
    return square_frame(np.broadcast_to(_UP, across.shape), level(across))


# ---- what becomes of them --------------------------------------------------------------------------------
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
        self.rotations = slerp(self.rotations, track[1], share)

    def throw(self, start: int, stop: int, goal: Array) -> None:
        """It flies along a parabola from where it is at ``start`` to ``goal`` (3,) at ``stop``, turning forward."""
        count = len(self.places)
        now = (np.arange(start, min(stop, count - 1) + 1) - start) / self.fps
        seconds = (stop - start) / self.fps
        begin = self.places[start].copy()
        speed = (goal - begin) / seconds + np.array([0.0, GRAVITY * seconds / 2, 0.0])
        way = begin + now[:, None] * speed - np.array([0.0, GRAVITY / 2, 0.0]) * now[:, None] ** 2
        axis = unit(left_of(goal - begin))
        spin = rotations_by(axis * (2 * np.pi * now / max(seconds, 0.8))[:, None])
        self.rotations[start : start + len(now)] = spin @ self.rotations[start]
        self.places[start : start + len(now)] = way
        self.places[start + len(now) :] = way[-1]
        self.rotations[start + len(now) :] = self.rotations[start + len(now) - 1]

    def roll(self, start: int, goal: Array, radius: float) -> None:
        """It comes down where it is at a frame, and rolls over the floor to below ``goal`` (3,); ``radius`` metres."""
        begin = self.places[start].copy()
        way = (np.asarray(goal) - begin) * FLAT
        length = float(np.linalg.norm(way))
        ahead = unit(way)
        now = np.arange(len(self.places) - start) / self.fps
        share = np.clip(now * ROLLS / (2 * max(length, 0.1)), 0.0, 1.0)
        along = length * (1 - (1 - share) ** 2)  # it slows down evenly
        drop = np.maximum(begin[1] - radius - GRAVITY / 2 * now**2, 0.0)
        self.places[start:] = begin * FLAT + along[:, None] * ahead
        self.places[start:, 1] = radius + drop
        spin = rotations_by(left_of(ahead) * (along / radius)[:, None])
        self.rotations[start:] = spin @ self.rotations[start]

    def bounce(self, under: Array, start: int, stop: int, radius: float) -> None:
        """It bounces from a hand that goes up and down.

        It is under the hand on its way down, and on the hand's way up it is on the floor and back.

        Args:
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
        self.then(int(lows[0]), (under, self.rotations), BLEND)
        for low in lows:
            later = highs[highs > low]
            if not len(later):
                break
            now = np.arange(low, later[0] + 1)
            share = (now - low) / (later[0] - low)
            down = np.minimum(2 * share, 2 - 2 * share)  # 0 at the hand, 1 on the floor
            self.places[now] = under[now]
            self.places[now, 1] -= down * (under[now, 1] - radius)

    def put(self, frame: int, rest: Track) -> None:
        """It is let go at a frame, and comes down on its rest as fast as it would fall, not slower than 0.2 s."""
        drop = max(float(self.places[frame, 1] - rest[0][frame, 1]), 0.0)
        seconds = max(np.sqrt(2 * drop / GRAVITY), 0.2)
        count = len(self.places)
        now = (np.arange(count) - frame) / self.fps
        share = np.clip(now / seconds, 0.0, 1.0)
        fallen = self.places[frame] * np.ones((count, 1))
        eased = smoothstep(share)
        fallen += eased[:, None] * (rest[0] - fallen) * FLAT
        fallen[:, 1] += share**2 * (rest[0][:, 1] - fallen[:, 1])
        held = np.tile(self.rotations[frame], (count, 1, 1))
        self.places[frame:] = fallen[frame:]
        self.rotations[frame:] = slerp(held, rest[1], eased)[frame:]


def at_rest(kind: str, mesh: Mesh, place: Array, ahead: Array, frames: int) -> Track:
    """A thing that lies or stands on a support: ``place`` (3,) is the spot on it, ``ahead`` (3,) a level direction."""
    turned = facing_frame(ahead, _UP) if kind in _LIES else facing_frame(_UP, ahead)
    spot = place - (mesh.vertices @ turned.T)[:, 1].min() * _UP
    return np.tile(spot, (frames, 1)), np.tile(turned, (frames, 1, 1))
