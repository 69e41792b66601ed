"""What the poses and paths of a request give of a window of a scene, and of what is kept around it."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from acts.staging.window import KnownFrames, Part, Window, known_paths
from motion import FPS, InputError
from motion.transforms import MEDIAN_START_DISTANCE, Placement
from motion.vectors import Array
from webdemo.inference.requests.actor import ROLES
from webdemo.inference.requests.paths import MOST_SPEED, FloorPath
from webdemo.inference.story.request import SceneRequest

CATCHING_UP = 3.0
"""Metres a second of people who run to a path that begins elsewhere, where the path itself is no faster."""
ACCELERATION = 4.0
"""Metres a second by which such a run gets faster in a second."""
STROLL = 1.2
"""Metres a second below which the way to a path is left to the network."""
OFTEN = 8
"""Frames between two given places of such a way."""
OFF = 0.25
"""Metres beside a path from which a person is not on it."""
_SLACK = 0.05
"""Metres by which a pose may be farther than a run, as recorded and generated bodies sway."""


@dataclass(frozen=True)
class Fixed:
    """A place of a person that cannot be moved: of the motion around a window, or of a pose.

    Attributes:
        frame: of the scene.
        place: (2,) x and z in metres.
        speed: metres a second there.
    """

    frame: int
    place: Array
    speed: float = 0.0


def wishes(request: SceneRequest, window: Window, scene: Array, placement: Placement) -> tuple[list[Part], list[str]]:
    """The poses and paths that fall into a window, and notes on those that begin elsewhere than their person stands.

    A path that goes on behind the window is also given at the window's last frame.

    Args:
        request: the scene's request.
        window: the window.
        scene: (2, T, 22, 3), whose frames before the window, and those that are kept behind it, are there.
        placement: from the scene's world to the network's frame.

    Raises:
        InputError: if nobody runs as fast as a pose asks for.
    """
    parts: list[Part] = []
    notes: list[str] = []
    for person, role in enumerate(ROLES):
        fixed = _fixed(request, window, scene, person)
        poses = [p for p in request.poses if p.person == role]
        inside = {f: p for p in poses if window.start <= (f := round(p.seconds * FPS)) < window.stop}
        for frame, pose in inside.items():
            positions = placement.to_network(np.asarray(pose.positions)[None])
            parts.append(KnownFrames(person, [frame - window.start + window.past], positions))
        _check_speeds(role, fixed)
        for path in (path for path in request.walks if path.person == role):
            frames, places, headings, said = _walked(path, window, fixed, placement)
            kept = [i for i, frame in enumerate(frames) if frame not in inside]
            at = np.array(frames, dtype=int)[kept] - window.start + window.past
            parts += known_paths(person, at, places[kept], headings[kept], placement)
            notes += said
    return parts, notes


def _fixed(request: SceneRequest, window: Window, scene: Array, person: int) -> list[Fixed]:
    """The fixed places of a person in and around a window, in order."""
    fixed = [
        Fixed(frame, np.asarray(pose.positions)[0, [0, 2]])
        for pose in request.poses
        if pose.person == ROLES[person] and window.start <= (frame := round(pose.seconds * FPS)) < window.stop
    ]
    roots = scene[person, :, 0][:, [0, 2]].astype(np.float64)
    if window.start:
        last = roots[max(window.start - 2, 0) : window.start]
        speed = float(np.linalg.norm(last[-1] - last[0])) * FPS
        fixed.append(Fixed(window.start - 1, last[-1], speed))
    if window.after:
        fixed.append(Fixed(window.stop, roots[0 if request.loop else window.stop]))
    return sorted(fixed, key=lambda each: each.frame)


def _check_speeds(role: str, fixed: list[Fixed]) -> None:
    """Raises InputError if nobody gets from one fixed place to the next in time."""
    for before, after in itertools.pairwise(fixed):
        way, seconds = float(np.linalg.norm(after.place - before.place)), (after.frame - before.frame) / FPS
        if way > MOST_SPEED * seconds + _SLACK:
            raise InputError(
                f"Person {role.upper()} is {way:.1f} m away {seconds:.1f} s before the pose or the kept motion at "
                f"{after.frame / FPS:.1f} s, and nobody runs that fast: move the pose, or give it another time."
            )


def _walked(
    path: FloorPath, window: Window, fixed: list[Fixed], placement: Placement
) -> tuple[list[int], Array, Array, list[str]]:
    """The frames, places (N, 2) and headings (N,) in radians of a path in a window, and a note on its beginning."""
    first, last = (round((path.points[i].seconds or 0.0) * FPS) for i in (0, -1))
    low, high = max(first, window.start), min(last, window.stop - 1)
    if low > high:
        return [], np.zeros((0, 2)), np.zeros(0), []
    turned = {
        round((p.seconds or 0.0) * FPS): math.nan if p.heading is None else math.radians(p.heading) for p in path.points
    }
    frames = {f for f in turned if low <= f <= high} | {high}
    line = np.array([_on_path(path, f) for f in range(low, high + 1)])
    before = next((each for each in reversed(fixed) if each.frame < low), None)
    after = next((each for each in fixed if each.frame > high), None)
    walked, start = _reached(line, low, before, placement, ROLES.index(path.person))
    if after is not None:
        walked = _chased(walked[::-1], Fixed(0, after.place), after.frame - high, len(walked) - 1)[::-1]
    behind = np.linalg.norm(walked[low - start :] - line, axis=1)
    late = np.flatnonzero(behind > 0.01)
    if start < low or len(late):
        until = low + (int(late[-1]) if len(late) else 0)
        frames |= {*range(start, until + 1, OFTEN), min(until + 1, high)}
    ordered = sorted(frames)
    places = walked[np.array(ordered) - start]
    headings = np.array([turned.get(f, math.nan) for f in ordered])
    return ordered, places, headings, _note(path, before, line, behind, low) if low == first else []


def _reached(line: Array, low: int, before: Fixed | None, placement: Placement, person: int) -> tuple[Array, int]:
    """The places (N, 2) of a person who gets to a line, one a frame, and the frame of the first of them."""
    if before is None:  # where they begin is free, and they begin at the path unless they can stroll there
        usual = placement.to_world(np.array([0.0, 0.0, person * MEDIAN_START_DISTANCE]))[[0, 2]]
        near = float(np.linalg.norm(line[0] - usual)) <= STROLL * low / FPS
        return (line, low) if not low or near else (np.concatenate([line[:1].repeat(low, axis=0), line]), 0)
    way = float(np.linalg.norm(line[0] - before.place))
    if way <= STROLL * (low - before.frame) / FPS:
        return line, low
    ahead = low - before.frame - 1
    wanted = np.concatenate([line[:1].repeat(ahead, axis=0), line])
    return _chased(wanted, before, 1, len(wanted)), before.frame + 1


def _chased(wanted: Array, begins: Fixed, gap: int, frames: int) -> Array:
    """Places (N, 2), one a frame, of a person who runs after the wanted ones.

    Args:
        wanted: (N, 2) metres.
        begins: where they are ``gap`` frames before the first of these.
        gap: at least 1.
        frames: over which they may catch up.
    """
    chased, here, speed = wanted.copy(), begins.place, begins.speed
    own = np.linalg.norm(np.diff(wanted, axis=0, prepend=wanted[:1]), axis=1) * FPS
    for i in range(min(frames + 1, len(wanted))):
        since = gap if i == 0 else 1
        most = min(max(CATCHING_UP, float(own[i])), MOST_SPEED)
        reach = min(speed + ACCELERATION * since / FPS, most) * since / FPS
        line = wanted[i] - here
        way = float(np.linalg.norm(line))
        chased[i] = wanted[i] if way <= reach else here + reach / way * line
        speed = float(np.linalg.norm(chased[i] - here)) * FPS / since
        here = chased[i]
    return chased


def _note(path: FloorPath, before: Fixed | None, line: Array, behind: Array, low: int) -> list[str]:
    """A sentence on a path that begins elsewhere than its person stands."""
    if before is None or behind[0] <= OFF:
        return []
    who, way = f"Person {path.person.upper()}", float(np.linalg.norm(line[0] - before.place))
    begins = f"{who}'s path begins {way:.1f} m from where they are at {low / FPS:.1f} s"
    there = np.flatnonzero(behind > OFF)[-1] + 1
    if there == len(line):
        return [f"{begins}, and they cannot be on it in that time: begin it where they are, or give it more time."]
    return [f"{begins}: they run there and are on it from {(low + there) / FPS:.1f} s on."]


def _on_path(path: FloorPath, frame: int) -> tuple[float, float]:
    first, last = ((path.points[i].seconds or 0.0) for i in (0, -1))
    place = path.place(min(max(frame / FPS, first), last))
    assert place is not None
    return place
