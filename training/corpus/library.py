"""The source clips as a library to draw from, by action, manner and side, one library a split."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import find_peaks

from motion import FPS
from motion.kinematics import forward_kinematics
from motion.skeleton import LEGS, OTHER_SIDE, SMPL22
from motion.transforms import leading_wrist
from motion.vectors import FLAT, wrapped

from .compose import Motion, join, looped, mirror, motion_from_positions, time_warp
from .cues import SourceClip

ONE_HANDED = ("bye", "guide", "respond")
STRIKES = {"punch": ("wrist", 12, 14), "kick": ("ankle", 30, 30), "slash": ("wrist", 32, 26)}
"""Actions whose clips hold several blows: the joint that strikes, and frames kept before and after a blow."""


@dataclass(frozen=True, eq=False)
class Take:
    """One drawn performance of an action.

    Attributes:
        motion: where and how the person moves, starting anywhere.
        action, style: as in the source clip.
        side: the hand, foot or turn as performed (after mirroring).
        peaks: the frames at which blows reach furthest; none where the action is no blow.
        aim: heading of the first blow against the motion's first heading, radians.
    """

    motion: Motion
    action: str
    style: str
    side: str | None = None
    peaks: tuple[int, ...] = ()
    aim: float = 0.0

    def __len__(self) -> int:
        return len(self.motion)


class Library:
    """Source clips of one split, as motions that are converted once and kept.

    Args:
        clips: the source clips; those of the other split are left out, those of ``both`` are not.
        split: "train" or "test".
    """

    def __init__(self, clips: Iterable[SourceClip], split: str) -> None:
        self.split = split
        self._clips: dict[str, list[SourceClip]] = defaultdict(list)
        for clip in clips:
            if clip.split in (split, "both"):
                self._clips[clip.action].append(clip)
        self._load = cache(self._load_action)

    def has(self, *actions: str) -> bool:
        """True if there is at least one clip of each action."""
        return all(self._clips.get(action) for action in actions)

    def styles(self, action: str) -> list[str]:
        """The manners in which an action is performed."""
        return sorted({clip.style for clip in self._clips.get(action, ())})

    def take(
        self,
        rng: np.random.Generator,
        action: str,
        *,
        style: str | None = None,
        side: str | None = None,
        frames: tuple[int, int] = (1, 10_000),
        blows: int = 2,
        warp: bool = True,
    ) -> Take:
        """Draws a performance of an action, mirrored half of the time, played up to 15 % off its speed.

        Args:
            style: wanted manner; where no clip has it, any manner is taken.
            side: wanted hand, foot or turn; a clip of the other side is mirrored.
            frames: (at least, at most) so many frames; a longer clip is shortened, a shorter one not drawn
                unless there is none else.
            blows: at most so many, of an action that is one.

        Raises:
            LookupError: where the split has no such clip.
        """
        takes = self._load(action)
        if side is not None:
            takes = [take for take in takes if take.side in (side, OTHER_SIDE.get(side, side))]
        if not takes:
            raise LookupError(f"The {self.split} sources hold no {action!r} with side {side!r}.")
        wanted = [take for take in takes if style is None or take.style == style] or takes
        wanted = [take for take in wanted if len(take) >= frames[0] and len(take.peaks) <= blows] or wanted
        chosen = pick(rng, wanted)
        flip = chosen.side != side if side in ("left", "right") else bool(rng.random() < 0.5)
        motion = mirror(chosen.motion) if flip else chosen.motion
        speed = _tempo(rng) if warp else 1.0
        if not chosen.peaks and len(motion) / speed > frames[1]:
            motion = shorten(motion, int(frames[1] * speed))
        if warp:
            motion = time_warp(motion, speed)
        return replace(
            chosen,
            motion=motion,
            side=OTHER_SIDE.get(chosen.side, chosen.side) if flip else chosen.side,
            peaks=tuple(round(peak / speed) for peak in chosen.peaks),
            aim=-chosen.aim if flip else chosen.aim,
        )

    def idle(self, rng: np.random.Generator, frames: int) -> Motion:
        """``frames`` frames of a real person who stands and waits; nine of ten let their arms hang."""
        takes = self._load("idle") or self._load("wave")
        if rng.random() < 0.9:
            takes = [take for take in takes if take.style == "at ease"] or takes
        motion = pick(rng, takes).motion
        if rng.random() < 0.5:
            motion = mirror(motion)
        motion = looped(motion, motion, frames + 2, blend=20)
        start = int(rng.integers(0, len(motion) - frames))
        return motion[start : start + frames]

    def _load_action(self, action: str) -> list[Take]:
        takes = []
        for clip in self._clips.get(action, ()):
            if len(clip.positions) < 16:
                continue
            motion = motion_from_positions(clip.positions, sources=(clip.source,))
            if action in STRIKES:
                takes += blows_of(motion, clip)
            elif action == "idle":
                takes += [Take(part, action, "at ease" if hanging(part) else "busy") for part in calm(motion)]
            else:
                side = clip.side or (leading_wrist(clip.positions) if action in ONE_HANDED else None)
                takes.append(Take(motion, action, clip.style, side))
        return takes


def _tempo(rng: np.random.Generator) -> float:
    """How fast a clip is played."""
    return float(np.clip(rng.normal(1.0, 0.07), 0.85, 1.15))


def pick(rng: np.random.Generator, items):
    """One item, each as likely; works on lists of anything."""
    return items[int(rng.integers(len(items)))]


def calm(motion: Motion) -> list[Motion]:
    """Pieces of an idle clip in which the person stays within 35 cm of one place, and hardly turns."""
    pieces = [motion[start : start + 300] for start in range(0, max(len(motion) - 150, 1), 150)]
    flat = [piece.root[:, [0, 2]] - piece.root[:, [0, 2]].mean(axis=0) for piece in pieces]
    far = [np.linalg.norm(own, axis=-1).max() > 0.35 for own in flat]
    return [one for one, away in zip(pieces, far, strict=True) if not away and np.ptp(one.headings) < 0.7]


def hanging(motion: Motion) -> bool:
    """True if both arms hang down all the time."""
    positions = forward_kinematics(motion.rotations, motion.root)
    wrists = positions[:, [SMPL22.index("left_wrist"), SMPL22.index("right_wrist")]]
    return bool((wrists[..., 1] - positions[:, :1, 1]).max() < 0.12)


def blows_of(motion: Motion, clip: SourceClip) -> list[Take]:
    """A clip of punches, kicks or sword cuts as takes of one blow or two in a row, with peaks and aim."""
    joint, before, after = STRIKES[clip.action]
    sword = clip.action == "slash"  # held with both hands; the right one tells
    takes = []
    for side in ("right",) if sword else ("left", "right"):
        tip = clip.positions[:, SMPL22.index(f"{side}_{joint}")]
        if sword:
            speed = np.linalg.norm(np.gradient(tip - clip.positions[:, 0], axis=0), axis=-1) * FPS
            peaks, _ = find_peaks(speed, height=3.0, distance=40)
        elif clip.action == "kick":
            peaks, _ = find_peaks(tip[:, 1], height=0.7, prominence=0.3)
        else:
            reach = np.linalg.norm(tip - clip.positions[:, SMPL22.index(f"{side}_shoulder")], axis=-1)
            peaks, _ = find_peaks(reach, height=0.42, prominence=0.12)
        for first, last in combinations_with_replacement(range(len(peaks)), 2):
            if last - first < 2:
                start = max(int(peaks[first]) - before, 0)
                part = motion[start : int(peaks[last]) + after]
                reach = tip[peaks[first]] - clip.positions[peaks[first], 0]
                aim = 0.0 if sword else wrapped(float(np.arctan2(reach[0], reach[2]) - motion.headings[start]))
                own = tuple(int(peak) - start for peak in peaks[first : last + 1])
                takes.append(Take(part, clip.action, clip.style, None if sword else side, own, aim))
    return takes


KEPT = 0.9
"""Share of a clip's furthest departure from its first pose that a shortened clip must keep."""
QUICKEST = 1.5
"""How much faster a clip is played at most where its middle must not be cut."""


def _moments(motion: Motion) -> np.ndarray:
    """(T, F) poses and speeds of a person, by which two moments look alike; the height counts, the place does not."""
    local = forward_kinematics(motion.rotations, motion.root * (1 - FLAT))
    return np.concatenate([local, 4 * np.gradient(local, axis=0)], axis=-1).reshape(len(motion), -1)


def shorten(motion: Motion, frames: int) -> Motion:
    """About ``frames`` frames: the middle is left out, between two moments that look most alike.

    Two moments look most alike where a person stands before and after what the clip shows. A cut that would
    leave out the bow of a bow, or the raised hand of a wave, is not made; the clip is played faster instead,
    :data:`QUICKEST` times at most.
    """
    surplus = len(motion) - frames
    if surplus <= 0 or frames < 40:
        return motion
    feature = _moments(motion)
    poses = feature.reshape(len(motion), -1, 6)[..., :3]
    away = np.linalg.norm(poses - poses[0], axis=-1).max(axis=-1)
    before, after = np.maximum.accumulate(away), np.maximum.accumulate(away[::-1])[::-1]
    best = (2.0, 0, 0)
    for skip in range(surplus, min(surplus + 20, len(motion) - 30)):
        low, high = 15, len(motion) - skip - 15
        cost = np.linalg.norm(feature[low:high] - feature[low + skip : high + skip], axis=-1)
        kept = np.maximum(before[low:high], after[low + skip : high + skip]) >= KEPT * away.max()
        best = min([best, *((float(cost[k]), low + k, low + k + skip) for k in np.flatnonzero(kept))])
    _, leave, enter = best
    if not enter:
        return time_warp(motion, min(len(motion) / frames, QUICKEST))
    return join(motion[: leave + 5], motion[enter - 5 :], blend=10)


def feet_together(motion: Motion) -> np.ndarray:
    """Frames of a walk at which one foot passes the other: where a person can start or stop walking."""
    toes = forward_kinematics(motion.rotations, motion.root)[:, [LEGS[0][2], LEGS[1][2]]]
    gap = np.linalg.norm((toes[:, 0] - toes[:, 1])[:, [0, 2]], axis=-1)
    valleys, _ = find_peaks(-gaussian_filter1d(gap, 2.0), distance=6)
    return valleys if len(valleys) else np.array([len(motion) // 2])


def extend(motion: Motion, frames: int) -> Motion:
    """At least ``frames`` frames of a walk or run: its end leads back into an earlier, alike moment."""
    if len(motion) >= frames:
        return motion
    feature, half = _moments(motion), min(5, len(motion) // 8)
    early = np.arange(half, max(len(motion) // 2, half + 1))
    late = np.arange(max(len(motion) - 12, len(motion) // 2 + half), len(motion) - half)
    cost = np.linalg.norm(feature[early][:, None] - feature[late][None], axis=-1)
    enter, leave = np.unravel_index(int(cost.argmin()), cost.shape)
    again = slice(int(early[enter]) - half, int(late[leave]) + half)
    return looped(motion[: again.stop], motion[again], frames, blend=2 * half)


def stride(rng: np.random.Generator, library: Library, action: str, distance: float, **wanted: Any) -> Take:
    """A walk, run, … of about ``distance`` metres, cut where the feet pass each other; in a ``wanted`` style."""
    take = library.take(rng, action, warp=False, **wanted)
    motion = take.motion
    speed = np.linalg.norm((motion.root[-1] - motion.root[0])[[0, 2]]) / max(len(motion) - 1, 1)
    motion = extend(motion, int(distance / max(speed, 0.005)) + 45)
    passes = feet_together(motion)
    passes = passes[(passes > 6) & (passes < len(motion) - 7)]
    if len(passes) >= 2:
        first = int(passes[rng.integers(min(3, len(passes)))])
        travelled = np.linalg.norm((motion.root - motion.root[first])[:, [0, 2]], axis=-1)
        later = passes[passes > first]
        last = int(later[np.abs(travelled[later] - distance).argmin()]) if len(later) else len(motion) - 7
        motion = motion[first - 6 : last + 7]
    return replace(take, motion=time_warp(motion, _tempo(rng)))
