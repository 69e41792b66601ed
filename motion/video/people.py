"""From landmarks to clips: pose by inverse kinematics, path from the picture, feet on the floor.

The network's points are good to two or three centimetres across the line of sight and to about ten along it, so the
fit trusts a point's place in the picture and lets the bones' lengths correct its depth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from motion.cleaning import foot_contacts, plant_feet
from motion.clip import FPS, Clip, Duet
from motion.errors import InputError
from motion.ik import fit_skeleton
from motion.kinematics import project_to_skeleton
from motion.skeleton import SMPL22, Layout
from motion.transforms import resample

from .landmarks import INDEX, LENS, Landmarks
from .place import body_tilt, centred, focal_length, level, smooth, steady_path, towards, translation, upright
from .tracks import Track, tracks_of

Array = NDArray[np.floating]

TILTS = (-45.0, 60.0)
"""Degrees by which a camera may look down, at least and at most."""
LENSES = (40.0, 130.0)
"""Degrees from corner to corner of the picture."""
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
    "left_hip": "left_hip",
    "left_knee": "left_knee",
    "left_ankle": "left_ankle",
    "left_foot": "left_foot_index",
    "left_shoulder": "left_shoulder",
    "left_elbow": "left_elbow",
    "left_wrist": "left_wrist",
}
POINT_OF |= {ours.replace("left", "right"): its.replace("left", "right") for ours, its in POINT_OF.items()}


def _layout() -> Layout:
    """The body as the network sees one: wide hips, shoulders further out, ears instead of the skull's base."""
    offsets = SMPL22.offsets.copy()
    for name, offset in _SEEN_BODY.items():
        offsets[SMPL22.index(name)] = offset
        if name.startswith("left"):
            offsets[SMPL22.index(name.replace("left", "right"))] = np.array(offset) * [-1, 1, 1]
    names = [*POINT_OF, "head"]
    return Layout("mediapipe", tuple(SMPL22.index(name) for name in names), offsets, variety=0.15)


_SEEN_BODY = {"left_hip": (0.09, -0.06, -0.01), "head": (0.0, 0.15, 0.03), "left_foot": (0.045, -0.065, 0.16)}
"""Metres from the parent."""
LAYOUT = _layout()


@dataclass(frozen=True, eq=False)
class Filmed:
    """The people of a film.

    Attributes:
        people: one clip or two, in one world: metres, Y up, floor at 0, +Z towards the camera.
        confidence: (people, T) 0 to 1: how much of each person was seen in each frame; 0 in a gap.
        gaps: (start, end) seconds in which somebody was not found; their motion is made up there.
        tilt: degrees by which the camera looked down, found or given.
        notes: sentences about what should have been filmed better.
    """

    people: tuple[Clip, ...]
    confidence: Array = field(repr=False)
    gaps: tuple[tuple[float, float], ...] = ()
    tilt: float = 0.0
    notes: tuple[str, ...] = ()

    @property
    def motion(self) -> Clip | Duet:
        """The person, or both."""
        return Duet(*self.people) if len(self.people) == 2 else self.people[0]


def people_of(landmarks: Landmarks, *, lens: float = LENS, tilt: float | None = None, name: str = "Film") -> Filmed:
    """The people in a film on SMPL22 at 30 frames a second.

    Args:
        landmarks: of its pictures.
        lens: degrees that the camera sees from corner to corner; scales motion towards the camera.
        tilt: degrees by which it looks down; found from the people by default.
        name: of the clips.

    Raises:
        InputError: where nobody can be followed, or not enough of them is seen.
    """
    check_camera(lens, tilt)
    tracks = tracks_of(landmarks)
    if len(tracks[0]) / tracks[0].fps < SHORTEST:
        raise InputError("The film shows somebody for less than half a second: film for longer.")
    for track in tracks:
        _check_seen(track, landmarks)
    focal = focal_length(landmarks.width, landmarks.height, lens)
    seen = [_in_camera(track, landmarks, focal) for track in tracks]
    fitted = [_fit(points, track) for points, track in zip(seen, tracks, strict=True)]
    if tilt is None:
        lean = [body_tilt(points, track.seen) for points, track in zip(seen, tracks, strict=True)]
        tilt = float(np.clip(np.degrees(level(fitted, lean, fps=tracks[0].fps)), *TILTS))
    turned = [positions @ _flipped(np.radians(tilt)).T for positions in fitted]
    fps = tracks[0].fps
    people = [_finished(positions, fps) for positions in turned]
    frames = min(map(len, people))
    middle = np.mean([person[0, 0] for person in people], axis=0) * [1, 0, 1]
    confidence = np.stack([_confidence(track, frames) for track in tracks])
    return Filmed(
        tuple(Clip(person[:frames] - middle, FPS, name=name) for person in people),
        confidence,
        _gaps(confidence),
        tilt,
        _notes(tracks, landmarks),
    )


def check_camera(lens: float, tilt: float | None) -> None:
    """Raises InputError for a lens or a tilt, in degrees, that is not possible."""
    if not LENSES[0] <= lens <= LENSES[1]:
        raise InputError(f"A lens of {lens:g}° is not possible: give {LENSES[0]:g} to {LENSES[1]:g}.")
    if tilt is not None and not TILTS[0] <= tilt <= TILTS[1]:
        raise InputError(f"A tilt of {tilt:g}° is not possible: give {TILTS[0]:g} to {TILTS[1]:g}.")


def _check_seen(track: Track, landmarks: Landmarks) -> None:
    """Raises InputError for people who lie on their side, or whose legs are hardly ever in the picture."""
    found = track.found
    ends = np.nanmedian(
        track.pixels[found][:, [INDEX["left_shoulder"], INDEX["right_shoulder"]]].mean(axis=1)
        - track.pixels[found][:, [INDEX["left_hip"], INDEX["right_hip"]]].mean(axis=1),
        axis=0,
    )
    if abs(ends[0]) > 2 * abs(ends[1]):
        raise InputError("The film lies on its side: turn it upright and choose it again.")
    if ends[1] > 0:
        raise InputError("The film stands on its head: turn it upright and choose it again.")
    if _legs_seen(track, landmarks)[found].mean() < 0.25:
        raise InputError("The legs are not in the picture: step back so that the whole body is seen.")


def _legs_seen(track: Track, landmarks: Landmarks) -> NDArray[np.bool_]:
    """(T,) whether one leg is seen from knee to ankle, inside the picture: from the side it hides the other."""
    points = np.nan_to_num(track.pixels[:, _LEGS], nan=-1.0)
    inside = ((points >= 0) & (points <= [landmarks.width, landmarks.height])).all(axis=-1)
    return np.any(np.all(inside & (track.seen[:, _LEGS] > _SEEN), axis=2), axis=1)


def _in_camera(track: Track, landmarks: Landmarks, focal: float) -> Array:
    """(T, 33, 3) points in metres along the camera's axes: their place in the picture, at the depth of the body."""
    pixels = centred(track, landmarks.width, landmarks.height)
    found = track.found
    world = np.full(track.world.shape, np.nan)
    world[found] = np.einsum("tij,tpj->tpi", towards(pixels[found], focal), track.world[found])
    path = np.full((len(track), 3), np.nan)
    path[found] = translation(world[found], pixels[found], track.seen[found], focal)
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


def _flipped(tilt: float) -> Array:
    """(3, 3) from the axes of :func:`_fit` to the world's."""
    return upright(tilt) @ np.diag([1.0, -1.0, -1.0])


def _finished(positions: Array, fps: float) -> Array:
    """At 30 frames a second, on the floor, with feet that stand."""
    moved = steady_path(resample(positions, fps, FPS), FPS)
    moved, _ = project_to_skeleton(moved)
    return plant_feet(moved, foot_contacts(moved, FPS, speed=_STANDS))


def _confidence(track: Track, frames: int) -> Array:
    """(frames,) how much of the body was seen, at 30 frames a second."""
    shown = track.seen[:, [INDEX[name] for name in POINT_OF.values()]].mean(axis=1)
    return np.interp(np.arange(frames) / FPS, np.arange(len(track)) / track.fps, shown)


def _gaps(confidence: Array) -> tuple[tuple[float, float], ...]:
    lost = (confidence < 0.05).any(axis=0).astype(np.int8)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], lost, [0]])))
    return tuple((float(start) / FPS, float(stop) / FPS) for start, stop in edges.reshape(-1, 2))


def _notes(tracks: Sequence[Track], landmarks: Landmarks) -> tuple[str, ...]:
    notes = []
    hidden = max(1 - _legs_seen(track, landmarks)[track.found].mean() for track in tracks)
    if hidden > 0.2:
        notes.append(f"The legs are hidden or out of the picture for {100 * hidden:.0f} % of the time: step back.")
    lost = max(1 - track.found.mean() for track in tracks)
    if lost > 0.05:
        notes.append(f"Nobody was found for {100 * lost:.0f} % of the time: the motion is made up there.")
    return tuple(notes)
