"""From the landmarks of a film to a clip of one person: pose by inverse kinematics, path from the picture, feet on the
floor.

The network's points are good to two or three centimetres across the line of sight and to about ten along it, so the
fit trusts a point's place in the picture and lets the bones' lengths correct its depth.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from motion.cleaning import foot_contacts, plant_feet
from motion.clip import FPS, Clip
from motion.errors import InputError
from motion.ik import fit_skeleton
from motion.kinematics import project_to_skeleton
from motion.skeleton import SMPL22, Layout, offsets_of
from motion.transforms import resample
from motion.vectors import FLAT, Array

from .landmarks import INDEX, Landmarks
from .place import body_tilt, focal_length, level, smooth, steady_path, towards, translation, upright

TILTS = (-45.0, 60.0)
"""Degrees by which a camera may look down, at least and at most."""
SHORTEST = 0.5
"""Seconds."""
_NOISE = 0.03
"""Metres by which a point is off across the line of sight."""
_DEPTH_TRUST = 0.1
"""Trust in a point's depth against its place in the picture: (3 cm / 9.5 cm) squared."""
_STANDS = 0.8
"""m/s below which a low foot stands: a walker's feet glide where the path is uncertain."""
_SEEN = 0.5
"""A point that is seen less surely than this counts as hidden."""
_LEGS = [[INDEX[f"{side}_{part}"] for part in ("knee", "ankle")] for side in ("left", "right")]

POINT_OF = {
    f"{side}_{part}": f"{side}_{part}{'_index' * (part == 'foot')}"
    for side in ("left", "right")
    for part in ("hip", "knee", "ankle", "foot", "shoulder", "elbow", "wrist")
}
"""The network's point of each joint."""


def _layout() -> Layout:
    """The body as the network sees one: wide hips, shoulders further out, ears instead of the skull's base."""
    joints = tuple(SMPL22.index(name) for name in (*POINT_OF, "head"))
    return Layout("mediapipe", joints, offsets_of(_SEEN_BODY), variety=0.15)


_SEEN_BODY = {"left_hip": (0.09, -0.06, -0.01), "head": (0.0, 0.15, 0.03), "left_foot": (0.045, -0.065, 0.16)}
"""Metres from the parent."""
LAYOUT = _layout()


@dataclass(frozen=True, eq=False)
class Filmed:
    """The person of a film.

    Attributes:
        person: metres, Y up, floor at 0, +Z towards the camera.
        confidence: (T,) 0 to 1: how much of the person was seen in each frame; 0 in a gap.
        tilt: degrees by which the camera looked down.
        notes: sentences about what should have been filmed better.
    """

    person: Clip
    confidence: Array = field(repr=False)
    tilt: float = 0.0
    notes: tuple[str, ...] = ()


def person_of(landmarks: Landmarks, *, name: str = "Film") -> Filmed:
    """The person in a film on SMPL22 at 30 frames a second.

    Args:
        landmarks: of its pictures.
        name: of the clip.

    Raises:
        InputError: where nobody can be followed, or not enough of them is seen.
    """
    track = track_of(landmarks)
    if len(track) / track.fps < SHORTEST:
        raise InputError("The video shows somebody for less than half a second: record for longer.")
    _check_seen(track, landmarks)
    points = in_camera(track, landmarks)
    fitted = _fit(points, track)
    lean = body_tilt(points, track.seen)
    tilt = float(np.clip(np.degrees(level(fitted, lean, fps=track.fps)), *TILTS))
    turn = upright(np.radians(tilt)) @ np.diag([1.0, -1.0, -1.0])  # from the axes of the fit to the world's
    positions = _finished(fitted @ turn.T, track.fps)
    clip = Clip(positions - positions[0, 0] * FLAT, FPS, name=name)
    return Filmed(clip, _confidence(track, len(positions)), tilt, _notes(track, landmarks))


def _check_seen(track: Track, landmarks: Landmarks) -> None:
    """Raises InputError for people who lie on their side, or whose legs are hardly ever in the picture."""
    seen = track.found
    ends = np.nanmedian(
        track.pixels[seen][:, [INDEX["left_shoulder"], INDEX["right_shoulder"]]].mean(axis=1)
        - track.pixels[seen][:, [INDEX["left_hip"], INDEX["right_hip"]]].mean(axis=1),
        axis=0,
    )
    if abs(ends[0]) > 2 * abs(ends[1]):
        raise InputError("The video lies on its side: turn it upright and choose it again.")
    if ends[1] > 0:
        raise InputError("The video is upside down: turn it upright and choose it again.")
    if _legs_seen(track, landmarks)[seen].mean() < 0.25:
        raise InputError("The legs are not in the picture: step back so that the whole body is seen.")


def _legs_seen(track: Track, landmarks: Landmarks) -> NDArray[np.bool_]:
    """(T,) whether one leg is seen from knee to ankle, inside the picture: from the side it hides the other."""
    points = np.nan_to_num(track.pixels[:, _LEGS], nan=-1.0)
    inside = ((points >= 0) & (points <= [landmarks.width, landmarks.height])).all(axis=-1)
    return np.any(np.all(inside & (track.seen[:, _LEGS] > _SEEN), axis=2), axis=1)


def in_camera(track: Track, landmarks: Landmarks) -> Array:
    """(T, 33, 3) points in metres along the camera's axes: their place in the picture, at the depth of the body."""
    focal = focal_length(landmarks.width, landmarks.height)
    pixels = track.pixels - np.array([landmarks.width, landmarks.height]) / 2
    seen = track.found
    world = np.full(track.world.shape, np.nan)
    world[seen] = np.einsum("tij,tpj->tpi", towards(pixels[seen], focal), track.world[seen])
    path = np.full((len(track), 3), np.nan)
    path[seen] = translation(world[seen], pixels[seen], track.seen[seen], focal)
    depth = smooth(path[:, 2:], track.fps, seconds=0.5)
    z = np.maximum(world[..., 2] + depth, 0.2)
    return np.concatenate([pixels * z[..., None] / focal, z[..., None]], axis=-1)


def layout_points(points: Array, seen: Array) -> tuple[Array, Array]:
    """(T, 15, 3) the points of :data:`LAYOUT` along the axes right, up and towards the camera, and (T, 15) seen.

    Args:
        points: (T, 33, 3) metres along the camera's axes.
        seen: (T, 33) weights.
    """
    columns = [INDEX[name] for name in POINT_OF.values()]
    ears = [INDEX["left_ear"], INDEX["right_ear"]]
    chosen, trust = (
        np.concatenate([values[:, columns], values[:, ears].mean(axis=1, keepdims=True)], axis=1)
        for values in (points, seen)
    )
    return chosen * np.array([1.0, -1.0, -1.0]), trust


def _fit(points: Array, track: Track) -> Array:
    """(T, 22, 3) the pose on SMPL22's bones, along the axes: right, up, towards the camera."""
    chosen, seen = layout_points(points, track.seen)
    trust = np.clip(seen, 0.02, 1.0)[..., None] ** 2 * np.array([1.0, 1.0, _DEPTH_TRUST])
    trust[~track.found] = 0.0
    fit = fit_skeleton(chosen, LAYOUT, weights=trust, fps=track.fps, noise=_NOISE)
    return fit.positions


def _finished(positions: Array, fps: float) -> Array:
    """At 30 frames a second, on the floor, with feet that stand."""
    moved = steady_path(resample(positions, fps, FPS), FPS)
    moved, _ = project_to_skeleton(moved)
    return plant_feet(moved, foot_contacts(moved, FPS, speed=_STANDS))


def _confidence(track: Track, frames: int) -> Array:
    """(frames,) how much of the body was seen, at 30 frames a second."""
    shown = track.seen[:, [INDEX[name] for name in POINT_OF.values()]].mean(axis=1)
    return np.interp(np.arange(frames) / FPS, np.arange(len(track)) / track.fps, shown)


def _notes(track: Track, landmarks: Landmarks) -> tuple[str, ...]:
    notes = []
    hidden = 1 - _legs_seen(track, landmarks)[track.found].mean()
    if hidden > 0.2:
        notes.append(f"The legs are hidden or out of the picture for {100 * hidden:.0f} % of the time: step back.")
    lost = 1 - track.found.mean()
    if lost > 0.05:
        notes.append(f"Nobody was found for {100 * lost:.0f} % of the time: the motion is made up there.")
    return tuple(notes)


# ---- From picture to picture at even steps ------------------------------------------------------------------------
RATES = (5.0, 30.0)
"""Frames a second that a track may have."""
_NOBODY = "Nobody was found in the video: film one person from head to feet, in good light."


@dataclass(frozen=True, eq=False)
class Track:
    """One person over a film, at even steps of time; NaN where they were not found.

    Attributes:
        fps: frames a second.
        world: (T, 33, 3) as in :class:`Landmarks`.
        pixels: (T, 33, 2) from the upper left corner.
        seen: (T, 33) 0 to 1; 0 where the person was not found.
    """

    fps: float
    world: Array = field(repr=False)
    pixels: Array = field(repr=False)
    seen: Array = field(repr=False)

    def __len__(self) -> int:
        return len(self.world)

    @property
    def found(self) -> NDArray[np.bool_]:
        """(T,) whether the person was found."""
        return np.isfinite(self.pixels[:, 0, 0])


def track_of(landmarks: Landmarks) -> Track:
    """The person of a film at even steps of time from where they were first to where they were last found: between
    pictures by straight lines, but not across gaps.

    Raises:
        InputError: where nobody was found, or for too short a time.
    """
    if len(landmarks.frames) < 2:
        raise InputError(_NOBODY)
    step = float(np.median(np.diff(landmarks.times)))
    fps = float(np.clip(round(1 / step), *RATES))
    known = landmarks.times[landmarks.frames]
    grid = known[0] + np.arange(max(2, int(np.floor((known[-1] - known[0]) * fps + 1e-6)) + 1)) / fps
    after = np.clip(np.searchsorted(known, grid - 1e-9), 0, len(known) - 1)
    before = np.clip(after - (known[after] > grid + 1e-9), 0, None)
    gap = known[after] - known[before]
    share = np.where(gap > 0, (grid - known[before]) / np.where(gap > 0, gap, 1.0), 0.0)
    away = np.where(gap > 0, gap > 2.5 * max(step, 1 / fps), np.abs(known[after] - grid) > 1.5 / fps)

    def between(values: Array) -> Array:
        weight = share.reshape(-1, *[1] * (values.ndim - 1))
        mixed = values[before] * (1 - weight) + values[after] * weight
        mixed[away] = np.nan
        return mixed

    seen = np.nan_to_num(between(landmarks.seen))
    return Track(fps, between(landmarks.world), between(landmarks.pixels), seen)
