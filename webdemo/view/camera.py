"""The player's camera for pictures that are drawn here: ``views.js`` and ``orbit.js`` in Python."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from motion.clip import Clip, Duet, stacked_positions
from motion.errors import InputError

Array = NDArray[np.floating]

VIEWS = ("threequarter", "front", "side", "top", "a", "b")
FIELD_OF_VIEW = np.pi / 4
"""From the lower edge of the picture to the upper one."""
_BODY_HEIGHT = 2.45
_SIDE_ROOM = 1.5
_WIDEST = 8.0
_LOOK_AT = (0.92, 0.74)
_FOLLOW_SECONDS, _FRAME_SECONDS = 0.3, 0.8
_NEAREST = 0.05


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

    def ground_lines(self, metres: int = 4) -> Array:
        """(N, 2, 2) pixels of the lines of a grid of metres on the floor, around what the camera looks at."""
        middle = np.round(self.target[[0, 2]])
        steps = np.arange(-metres, metres + 1, dtype=float)
        along = np.stack(np.meshgrid(steps[:-1], steps), axis=-1).reshape(-1, 2)
        ends = np.stack([along, along + np.array([1.0, 0.0])], axis=1)
        ends = np.concatenate([ends, ends[..., ::-1]]) + middle
        lines = np.insert(ends, 1, 0.0, axis=-1)
        pixels, depth = self.project(lines)
        return pixels[(depth > 0.3).all(axis=1)]


def project_shadow(points: Array) -> Array:
    """Projects points (…, 3) onto the floor from a lamp overhead and slightly to the side."""
    slant = np.array([-0.25, 0.0, -0.35])
    height = np.maximum(points[..., 1:2], 0.0)
    return points * np.array([1.0, 0.0, 1.0]) + height * slant


def cameras(
    panes: Sequence[Clip | Duet],
    *,
    size: tuple[int, int],
    times: Array,
    view: str = "threequarter",
    follow: bool = True,
    yaw: float | None = None,
    elevation: float | None = None,
) -> list[list[Camera]]:
    """The cameras of each pane, one a picture: all look from one side and from equally far, each at its own people.

    Args:
        panes: the motions that are shown side by side, on one clock.
        size: of one pane in pixels.
        times: (N,) seconds.
        view: one of :data:`VIEWS`.
        follow: whether the cameras go with the people and take in how far apart they are; otherwise each
            stands where it sees the whole motion.
        yaw, elevation: radians, instead of the preset's.

    Returns:
        N cameras a pane.

    Raises:
        InputError: for an unknown view.
    """
    if view not in VIEWS:
        raise InputError(f"There is no view {view!r:.30}: choose one of {', '.join(VIEWS)}.")
    aspect = size[0] / size[1]
    targets, across = zip(*(_people(motion, times, follow) for motion in panes), strict=True)
    look_at = _LOOK_AT[1] if aspect < 1.1 else _LOOK_AT[0]
    found_yaw, found_elevation, _ = _preset(view, _heading(panes[0]), across[0][0], aspect)
    yaw, elevation = found_yaw if yaw is None else yaw, found_elevation if elevation is None else elevation
    distances = np.array([_preset(view, 0.0, wide, aspect)[2] for wide in np.max(across, axis=0)])
    if follow:
        steps = np.diff(times, prepend=times[0])
        targets = tuple(_followed(target, 1 - np.exp(-steps / _FOLLOW_SECONDS)) for target in targets)
        distances = _followed(distances[:, None], 1 - np.exp(-steps / _FRAME_SECONDS))[:, 0]
    return [
        [
            Camera(np.array([x, look_at, z]), yaw, elevation, float(metres), size)
            for (x, z), metres in zip(target, distances, strict=True)
        ]
        for target in targets
    ]


def _people(motion: Clip | Duet, times: Array, follow: bool) -> tuple[Array, Array]:
    """The place (N, 2) on the floor amidst a pane's people, and the width (N,) in metres that they take up.

    Where nothing follows them, both are those of the whole motion.
    """
    spots = _roots(motion, times)[..., [0, 2]]
    low, high = spots.min(axis=0), spots.max(axis=0)
    if not follow:
        low, high = (np.broadcast_to(each, low.shape) for each in (low.min(axis=0), high.max(axis=0)))
    across = np.linalg.norm(high - low, axis=-1)
    return (low + high) / 2, across.clip(max=_WIDEST) if follow else across


def _followed(wanted: Array, shares: Array) -> Array:
    """(N, D) values that go a share of the way to what is wanted at each step."""
    found = wanted.copy()
    for i in range(1, len(wanted)):
        found[i] = found[i - 1] + shares[i] * (wanted[i] - found[i - 1])
    return found


def sampled(positions: Array, fps: float, times: Array) -> Array:
    """(…, N, J, 3) joints (…, T, J, 3) at times in seconds, between frames by straight lines."""
    frames = np.clip(times * fps, 0, positions.shape[-3] - 1)
    low = np.floor(frames).astype(int)
    high = np.minimum(low + 1, positions.shape[-3] - 1)
    share = (frames - low)[:, None, None]
    first, second = (np.take(positions, index, axis=-3) for index in (low, high))
    return first + share * (second - first)


def _roots(motion: Clip | Duet, times: Array) -> Array:
    return sampled(stacked_positions(motion).astype(np.float64), motion.fps, times)[:, :, 0]


def _heading(motion: Clip | Duet) -> float:
    """Angle on the floor, from +Z towards +X, from a to b at first; a's heading if there is no b."""
    people = stacked_positions(motion)[:, 0].astype(np.float64)
    way = people[-1, 0] - people[0, 0]
    if np.hypot(way[0], way[2]) > 0.05:
        return float(np.arctan2(way[0], way[2]))
    names = motion.skeleton.joint_names
    if "left_hip" not in names:
        return 0.0
    left = people[0, names.index("left_hip")] - people[0, names.index("right_hip")]
    return float(np.arctan2(left[0], left[2]) - np.pi / 2)


def _preset(name: str, along: float, gap: float, aspect: float) -> tuple[float, float, float]:
    """Yaw, elevation and distance, as ``preset`` in views.js."""
    tangent = 2 * np.tan(FIELD_OF_VIEW / 2)

    def fit(across: float) -> float:
        high, wide = _BODY_HEIGHT / tangent, (across + _SIDE_ROOM) / (tangent * aspect)
        return float(max(high, wide) + across / 6)

    if name == "front":
        return along, 0.16, float(_BODY_HEIGHT / tangent + gap / 2 + 0.6)
    if name == "side":
        return along - np.pi / 2, 0.1, fit(gap)
    if name == "top":
        return along - np.pi / 2, 1.48, max(fit(gap), 4.0) + 0.5
    if name in ("a", "b"):
        yaw = along + np.pi + 0.4 if name == "a" else along - 0.4
        return yaw, 0.3, gap / 2 + 2.7
    return along - 1.05, 0.24, fit(gap * 0.9)
