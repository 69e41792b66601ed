"""The film look: a camera that goes slowly to and fro, a floor that fades into the sky, darker edges.

``static/player/filming.js`` is the same on the page, number for number.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from motion.clip import Clip, Duet

from .camera import Camera, cameras
from .theme import Theme

Array = NDArray[np.floating]

_ARC = 0.25
"""Radians to each side."""
_FASTEST = 0.12
"""Radians a second."""
_AWAY = 0.08
"""By how much of its distance the camera is farther away at both ends of a motion."""
_VIGNETTE = ((0.5, 0.0), (0.75, 0.3), (1.0, 1.0))
"""How dark the edges are, of the darkest: (place, share), places from 0 in the middle to 1 in a corner."""
_SIDES = 9
"""Angles for which cameras are placed; what is between two of them is placed between their cameras."""


def move(shares: Array, seconds: float) -> tuple[Array, Array]:
    """Moves the camera to where it is at shares (N,) of a motion of so many seconds.

    Returns:
        radians aside (N,), and what its distance is multiplied by (N,).
    """
    around = 2 * np.pi * shares
    arc = min(_ARC, _FASTEST * seconds / (2 * np.pi))
    return arc * np.sin(around), 1 + _AWAY * (1 + np.cos(around)) / 2


def moving_cameras(
    panes: Sequence[Clip | Duet],
    *,
    size: tuple[int, int],
    times: Array,
    view: str = "threequarter",
    follow: bool = True,
    yaw: float | None = None,
    elevation: float | None = None,
) -> list[list[Camera]]:
    """The cameras of :func:`~webdemo.view.camera.cameras` with the film look's move about the same view.

    Raises:
        InputError: for an unknown view.
    """
    seconds = max(motion.seconds for motion in panes)
    last = max((motion.num_frames - 1) / motion.fps for motion in panes) or 1.0
    aside, away = move(np.clip(times / last, 0.0, 1.0), seconds)

    def placed(middle: float | None) -> list[list[Camera]]:
        return cameras(panes, size=size, times=times, view=view, follow=follow, yaw=middle, elevation=elevation)

    middle = placed(yaw)[0][0].yaw
    widest = float(np.abs(aside).max()) or 1.0
    angles = np.linspace(-widest, widest, _SIDES)
    ways = [placed(middle + angle) for angle in angles]
    step = (aside + widest) / (2 * widest) * (_SIDES - 1)
    low = np.clip(np.floor(step).astype(int), 0, _SIDES - 2)
    return [
        [
            _between(ways[k][pane][n], ways[k + 1][pane][n], step[n] - k, middle + aside[n], away[n])
            for n, k in enumerate(low.tolist())
        ]
        for pane in range(len(panes))
    ]


def _between(one: Camera, other: Camera, share: float, yaw: float, away: float) -> Camera:
    """A camera between two, at an angle of its own and so many times as far away."""
    target = one.target + share * (other.target - one.target)
    distance = one.distance + share * (other.distance - one.distance)
    return replace(one, target=target, yaw=float(yaw), distance=float(away * distance))


def hazy(theme: Theme) -> Theme:
    """A theme in haze: the floor has gone over into the sky after a few metres."""
    return replace(theme, far=theme.horizon, reach=theme.film_reach)


def darken_edges(picture: NDArray[np.uint8], vignette: float) -> None:
    """Darkens the edges of a picture (height, width, 4) in place."""
    height, width = picture.shape[:2]
    # Opacity goes through as well: what lies in one piece is multiplied several times as fast.
    kept = np.multiply(picture, _kept(width, height, vignette), dtype=np.uint16)
    picture[:] = np.right_shift(kept, 8, out=kept)


@lru_cache(maxsize=2)
def _kept(width: int, height: int, vignette: float) -> NDArray[np.uint16]:
    """(height, width, 4) what is kept of each colour of a pixel, and all of its opacity, in 256ths."""
    x = ((np.arange(width) + 0.5) / width - 0.5) ** 2
    y = ((np.arange(height) + 0.5) / height - 0.5) ** 2
    from_middle = np.sqrt(2 * (y[:, None] + x))
    places, shares = zip(*_VIGNETTE, strict=True)
    dark = vignette * np.interp(from_middle, places, shares)
    kept = np.rint(256 * (1 - dark)).astype(np.uint16)
    return np.stack([kept, kept, kept, np.full_like(kept, 256)], axis=-1)
