"""Puts two composed people on one stage: waiting, acting in time, walking, facing, and the finished scene."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from motion.kinematics import forward_kinematics
from motion.transforms import canonicalize, facing

from .compose import FPS, Array, Motion, facing_at, join, look_at, place, realise, time_warp
from .library import Library, Take, extend, feet_together
from .scene import Scene

Rng = np.random.Generator


def seconds(rng: Rng, low: float, high: float) -> int:
    """A random duration in frames."""
    return int(rng.uniform(low, high) * FPS)


def waiting(rng: Rng, library: Library, frames: int) -> Motion:
    """A person who waits for ``frames`` frames."""
    return library.idle(rng, frames)


def blend_for(first: Motion, second: Motion) -> int:
    """Frames over which to blend so that no joint has to hurry: 10 to 24, by how far the poses are apart."""
    ends = np.stack([first.rotations[-1], second.rotations[0]])
    pose = forward_kinematics(ends * 1.0, np.zeros((2, 3)))
    own = np.linalg.inv(ends[:, 0])
    gap = np.linalg.norm(
        np.einsum("aij,akj->aki", own, pose)[0] - np.einsum("aij,akj->aki", own, pose)[1], axis=-1
    )
    return int(np.clip(8 + 22 * gap.max(), 10, 24))


def act(
    rng: Rng,
    library: Library,
    *parts: tuple[int | None, Motion] | tuple[int | None, Motion, float],
    tail: int = 15,
    idle_after: bool = True,
) -> tuple[Motion, list[int]]:
    """One person's motion in time: waits, does something, waits, …

    Args:
        parts: (start, motion) or (start, motion, aim): ``start`` the frame at which it begins, None directly
            after the part before; ``aim`` radians by which it is turned away while it lasts, so that a
            blow that goes sideways in the source goes forward here.
        tail: frames to wait at the end.
        idle_after: False leaves the person in the last motion.

    Returns:
        the motion, and the frame at which each part begins.
    """
    base = library.idle(
        rng, 40 + max((part[0] or 0) for part in parts) + sum(len(p[1]) for p in parts) + tail
    )
    done: Motion | None = None
    starts, turned_by, cursor = [], 0.0, 0
    for part in parts:
        start, motion, aim = (*part, 0.0)[:3]
        if done is None and (start is None or start < 4):
            done, turned_by = motion, -aim
            starts.append(0)
            continue
        if done is None:
            blend = blend_for(base, motion)
            done = base[: start + blend]
        elif start is not None and start > len(done) + 6:
            done = join(
                done,
                base[cursor : cursor + start - len(done) + 24],
                blend=blend_for(done, base),
                turn=-turned_by,
            )
            turned_by = 0.0
        blend = min(blend_for(done, motion), len(motion) // 2)
        starts.append(len(done) - blend)
        done = join(done, motion, blend=blend, turn=-aim - turned_by)
        turned_by = -aim
        cursor = min(len(done), len(base) - tail - 30)
    assert done is not None
    if idle_after:
        blend = blend_for(done, base)
        done = join(done, base[cursor : cursor + tail + blend], blend=blend, turn=-turned_by)
    return done, starts


def pad(rng: Rng, library: Library, motion: Motion, frames: int) -> Motion:
    """The motion cut to ``frames`` frames, or continued by waiting."""
    if len(motion) >= frames:
        return motion[:frames]
    return join(motion, library.idle(rng, frames - len(motion) + 16), blend=16)[:frames]


def stride(
    rng: Rng,
    library: Library,
    action: str,
    distance: float,
    *,
    style: str | None = None,
    side: str | None = None,
) -> Take:
    """A walk, run, … of about ``distance`` metres, cut where the feet pass each other."""
    take = library.take(rng, action, style=style, side=side, warp=False)
    motion = take.motion
    speed = np.linalg.norm((motion.root[-1] - motion.root[0])[[0, 2]]) / max(len(motion) - 1, 1)
    motion = extend(motion, int(distance / max(speed, 0.005)) + 45)
    passes = feet_together(motion)
    passes = passes[(passes > 6) & (passes < len(motion) - 7)]
    warp = float(np.clip(rng.normal(1.0, 0.07), 0.85, 1.15))
    if len(passes) < 2:
        return Take(time_warp(motion, warp), action, take.style, take.side, speed=warp)
    first = int(passes[rng.integers(min(3, len(passes)))])
    travelled = np.linalg.norm((motion.root - motion.root[first])[:, [0, 2]], axis=-1)
    later = passes[passes > first]
    last = int(later[np.abs(travelled[later] - distance).argmin()]) if len(later) else len(motion) - 7
    steps = time_warp(motion[first - 6 : last + 7], warp)
    return Take(steps, action, take.style, take.side, speed=warp)


def pace(motion: Motion) -> float:
    """Mean speed over the ground in metres a second."""
    return float(np.linalg.norm(np.diff(motion.root[:, [0, 2]], axis=0), axis=-1).mean() * FPS)


def keep_pace(motion: Motion, speed: float) -> Motion:
    """The motion played so that its pace is ``speed``, within what looks natural."""
    return time_warp(motion, float(np.clip(speed / max(pace(motion), 1e-3), 0.8, 1.25)))


def forward(motion: Motion, frame: int) -> tuple[Array, float]:
    """Root position in (x, z) and heading at a frame."""
    return motion.root[frame, [0, 2]], facing_at(motion, frame, window=15)


def oppose(
    rng: Rng,
    a: Motion,
    b: Motion,
    distance: float,
    *,
    frame_a: int = 0,
    frame_b: int = 0,
    aside: float = 0.08,
) -> Motion:
    """``b`` placed so that at its frame it stands ``distance`` in front of a at a's frame, face to face."""
    origin, angle = forward(a, frame_a)
    return beside(
        b, origin, angle, distance, float(rng.normal(0, aside)), np.pi + rng.normal(0, 0.06), frame=frame_b
    )


def beside(
    b: Motion, origin: Array, angle: float, ahead: float, left: float, turn: float, *, frame: int = 0
) -> Motion:
    """``b`` placed ``ahead`` and ``left`` metres of a point that faces ``angle``, turned by ``turn``."""
    axis = np.array([np.sin(angle), np.cos(angle)])
    side = np.array([np.cos(angle), -np.sin(angle)])
    x, z = origin + ahead * axis + left * side
    placed = place(b, 0.0, 0.0, 0.0, frame=frame)
    return place(placed, float(x), float(z), float(angle + turn), frame=frame)


def manner(rng: Rng, library: Library, *actions: str) -> str | None:
    """A style to perform in; normal half of the time, else one in which all the actions exist."""
    if rng.random() < 0.4:
        return "normal"
    common = set(library.styles(actions[0])).intersection(*(library.styles(action) for action in actions[1:]))
    options = sorted(common) or library.styles(actions[0])
    return options[int(rng.integers(len(options)))] if options else None


def finish(
    rng: Rng,
    library: Library,
    family: str,
    a: Motion,
    b: Motion,
    *,
    slots: Mapping[str, Any] | None = None,
    events: Mapping[str, Any] | None = None,
    gaze: tuple[float, float] = (0.8, 0.8),
    most: int = 270,
) -> Scene:
    """The finished scene: same length, eyes on each other, feet planted, canonical.

    Args:
        slots: what is said of it; see :attr:`training.corpus.scene.Scene.said`.
        gaze: how much each looks at the other, 0 to 1.
        most: frames at most.
    """
    frames = min(len(a), len(b), most)
    a, b = a[:frames], b[:frames]
    heads = [m.root + np.array([0.0, 0.65, 0.0]) for m in (a, b)]
    a, b = look_at(a, heads[1], amount=gaze[0]), look_at(b, heads[0], amount=gaze[1])
    positions = canonicalize(np.stack([realise(a), realise(b)]))
    positions[..., 1] -= np.percentile(positions[..., 1].min(axis=2), 10, axis=1)[:, None, None]
    return Scene(
        positions.astype(np.float32),
        family,
        tuple(sorted(set(a.sources + b.sources))),
        library.split,
        verified(positions, events or {}),
        dict(slots or {}),
    )


def verified(positions: Array, events: Mapping[str, Any]) -> dict[str, Any]:
    """The events without what the scene (2, T, 22, 3) does not show, which would mislead a judge."""
    kept = dict(events)
    roots = positions[:, :, 0] * np.array([1.0, 0.0, 1.0])
    gap = np.linalg.norm(roots[0] - roots[1], axis=-1)
    change = gap[-1] - gap[0]
    shown = "approach" if change < -0.4 else "part" if change > 0.4 else "keep" if abs(change) < 0.3 else None
    if kept.get("distance") != shown:
        kept.pop("distance", None)
    middle = len(gap) // 2
    ahead = (roots[1] - roots[0])[middle] / max(gap[middle], 1e-6)
    if min(facing(positions[0])[middle] @ ahead, -facing(positions[1])[middle] @ ahead) < 0.7:
        kept.pop("facing", None)
    return kept


def pace_word(speed: float, *, slow: float = 0.75, fast: float = 1.6) -> str | None:
    """ "slow" or "fast" where a pace in metres a second deserves the word."""
    return "slow" if speed < slow else "fast" if speed > fast else None
