"""The player's camera for pictures that are drawn here: ``views.js`` and ``orbit.js`` in Python."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.clip import Clip, Duet, stacked_positions
from motion.errors import InputError
from motion.skeleton import SMPL22
from motion.things import FIXTURES
from motion.transforms import heading
from motion.vectors import Array, heading_of

_PRESETS = {
    "threequarter": (-1.05, 0.24),
    "front": (0.0, 0.16),
    "side": (-np.pi / 2, 0.1),
    "top": (-np.pi / 2, 1.48),
    "a": (np.pi + 0.4, 0.3),
    "b": (-0.4, 0.3),
}
"""Radians from the line between the two, and of elevation, as in ``views.js``."""
VIEWS = tuple(_PRESETS)
FIELD_OF_VIEW = np.pi / 4
"""From the lower edge of the picture to the upper one."""
_AROUND = 0.13
"""Metres about a joint that are in view: palms and the sides of a body."""
_CROWN = 0.24
"""Metres over the joint of a head that are in view."""
_LEAST = 2.6
"""Metres from which a camera looks at least; nearer, one face would fill the picture."""
_INSETS = (0.03, 0.03, 0.08, 0.06)
"""What names and captions take of a picture at its right, left, upper and lower edge, in heights of it."""
_SECONDS = 0.7
"""Seconds before and after a moment whose people are in view at it as well; cameras move as smoothly as that."""
_NEAREST = 0.05
_AT = 1.5
"""Metres from a window or the like within which somebody is at it, so that it is in view."""


@dataclass(frozen=True, eq=False)
class Camera:
    """One place from which a picture is taken. Axes as in motion: metres, Y up.

    Attributes:
        target: (3,) the point in the middle of the picture.
        yaw: radians of the eye about the target on the floor, from +Z towards +X.
        elevation: radians above the floor.
        distance: metres from the target.
        size: width and height in pixels.
    """

    target: Array
    yaw: float
    elevation: float
    distance: float
    size: tuple[int, int]

    @cached_property
    def eye(self) -> Array:
        """(3,) metres, where the camera is."""
        flat = np.cos(self.elevation)
        way = np.array([flat * np.sin(self.yaw), np.sin(self.elevation), flat * np.cos(self.yaw)])
        return self.target + self.distance * way

    @cached_property
    def axes(self) -> Array:
        """(3, 3) rows: right, up and forward of the picture."""
        forward = self.target - self.eye
        forward = forward / np.linalg.norm(forward)
        right = np.array([np.cos(self.yaw), 0.0, -np.sin(self.yaw)])
        return np.stack([right, np.cross(right, forward), forward])

    @property
    def focal(self) -> float:
        """Pixels of a metre at a metre's distance."""
        return self.size[1] / 2 / float(np.tan(FIELD_OF_VIEW / 2))

    def project(self, points: Array) -> tuple[Array, Array]:
        """Pixels (…, 2) from the upper left corner, and depth in metres (…,), of points (…, 3)."""
        seen = (points - self.eye) @ self.axes.T
        depth = np.maximum(seen[..., 2], _NEAREST)
        scale = self.focal / depth
        middle = np.array(self.size) / 2
        return np.stack([seen[..., 0] * scale, -seen[..., 1] * scale], axis=-1) + middle, seen[..., 2]


def cameras(
    panes: Sequence[Clip | Duet],
    *,
    size: tuple[int, int],
    times: Array,
    view: str = "threequarter",
    follow: bool = True,
    around: float = _SECONDS,
    yaw: float | None = None,
    elevation: float | None = None,
) -> list[list[Camera]]:
    """The cameras of each pane, one a picture: all look from one side and from equally far, each at its own people.

    Everybody is in every picture. What a camera has to hold within ``around`` seconds is a set of linear conditions
    on its place (as in ``views.js``), and so the mean of cameras that each hold a moment holds it as well.

    Args:
        panes: the motions that are shown side by side, on one clock.
        size: of one pane in pixels.
        times: (N,) seconds, evenly spaced.
        view: one of :data:`VIEWS`.
        follow: whether the cameras go with the people; otherwise each stands where it sees the whole motion.
        around: seconds over which a camera that goes with people is smoothed; 0 if each moment stands alone.
        yaw, elevation: radians, instead of the preset's.

    Returns:
        N cameras a pane.

    Raises:
        InputError: for an unknown view.
    """
    if view not in VIEWS:
        raise InputError(f"There is no view {view!r:.30}: choose one of {', '.join(VIEWS)}.")
    aside, usual = _PRESETS[view]
    yaw = _heading(panes[0]) + aside if yaw is None else yaw
    elevation = usual if elevation is None else elevation
    axes = Camera(np.zeros(3), yaw, elevation, 1.0, size).axes * [[1.0], [1.0], [-1.0]]
    half = np.array([size[0] / size[1], size[0] / size[1], 1.0, 1.0])
    slopes = np.tan(FIELD_OF_VIEW / 2) * np.maximum(half - 2 * np.array(_INSETS), 0.1)
    reaches, depths = zip(*(_reach(motion, times, axes, slopes, around, follow) for motion in panes), strict=True)
    pairs = np.stack([reach[:, ::2] + reach[:, 1::2] for reach in reaches])
    least = (pairs / (slopes[::2] + slopes[1::2])).max(axis=2) - np.stack(depths)
    distances = least.max(axis=0).clip(min=_LEAST)
    chosen = []
    for reach, depth in zip(reaches, depths, strict=True):
        apart = (slopes[::2] - slopes[1::2]) * (distances + depth)[:, None]
        middle = np.column_stack([(reach[:, ::2] - reach[:, 1::2] - apart) / 2, depth])
        chosen.append(_smooth(np.column_stack([middle @ axes, distances]), times, around if follow else 0.0))
    return [[Camera(way[:3], yaw, elevation, float(way[3]), size) for way in ways] for ways in chosen]


def _reach(
    motion: Clip | Duet, times: Array, axes: Array, slopes: Array, around: float, follow: bool
) -> tuple[Array, Array]:
    """Reach of people to the right, left, top and bottom of a picture (N, 4), and their mean depth (N,).

    A point (x, y, z) in the camera's ``axes`` (right, up, back) lies inside a side of slope s, seen from distance d
    about a centre c, where x - c <= s (d - z): a reach is the largest x + s z of all points.
    """
    people = stacked_positions(motion).astype(np.float64)
    crowns = people[:, :, [SMPL22.index("head")]] + np.array([0.0, _CROWN, 0.0])
    people = np.concatenate([people, crowns], axis=2)
    across, up, back = np.moveaxis(np.concatenate(list(people), axis=1) @ axes.T, -1, 0)  # (T, joints) each
    sides = np.stack([across, -across, up, -up], axis=-1) + slopes * back[..., None] + _AROUND
    reach, depth = sides.max(axis=1), back.mean(axis=1)
    for shown, corners in _used(motion):
        across, up, back = np.moveaxis(corners @ axes.T, -1, 0)
        sides = np.stack([across, -across, up, -up], axis=-1) + slopes * back[..., None] + _AROUND
        reach[shown] = np.maximum(reach[shown], sides.max(axis=0))
    if not follow:
        return np.tile(reach.max(axis=0), (len(times), 1)), np.full(len(times), depth.mean())
    # A moment may lie between two frames, which both count.
    frames = 2 * (int(np.ceil(around * motion.fps)) + 1) + 1
    reach = scipy.ndimage.maximum_filter1d(reach, frames, axis=0, mode="nearest")
    at = np.clip(np.rint(times * motion.fps).astype(int), 0, len(depth) - 1)
    return reach[at], depth[at]


def _used(motion: Clip | Duet) -> Iterator[tuple[NDArray[np.bool_], Array]]:
    """The windows and the like beside a motion: the frames (T,) in which somebody is at one, and its corners (8, 3)."""
    for thing in motion.things if isinstance(motion, Duet) else ():
        if thing.kind not in FIXTURES:
            continue
        pelvises = stacked_positions(motion)[:, :, 0]
        away = np.linalg.norm((pelvises - thing.places[0])[..., [0, 2]], axis=-1).min(axis=0)
        box = np.stack([thing.mesh.vertices.min(axis=0), thing.mesh.vertices.max(axis=0)])
        corners = np.stack(np.meshgrid(*box.T), axis=-1).reshape(-1, 3)
        yield away < _AT, corners @ thing.rotations[0].T + thing.places[0]


def _smooth(values: Array, times: Array, around: float) -> Array:
    """(N, D) the means of values over so many seconds before and after each time."""
    if len(times) < 2 or around <= 0:
        return values
    return scipy.ndimage.uniform_filter1d(values, 2 * int(around / (times[1] - times[0])) + 1, axis=0, mode="nearest")


def sampled(positions: Array, fps: float, times: Array) -> Array:
    """(…, N, J, 3) joints (…, T, J, 3) at times in seconds, between frames by straight lines."""
    frames = np.clip(times * fps, 0, positions.shape[-3] - 1)
    low = np.floor(frames).astype(int)
    high = np.minimum(low + 1, positions.shape[-3] - 1)
    share = (frames - low)[:, None, None]
    first, second = (np.take(positions, index, axis=-3) for index in (low, high))
    return first + share * (second - first)


def _heading(motion: Clip | Duet) -> float:
    """Angle on the floor, from +Z towards +X, from a to b at first; a's heading if there is no b."""
    people = stacked_positions(motion)[:, 0].astype(np.float64)
    way = people[-1, 0] - people[0, 0]
    if np.hypot(way[0], way[2]) > 0.05:
        return float(heading_of(way))
    return float(heading(people[0]))
