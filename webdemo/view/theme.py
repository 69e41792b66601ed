"""The player's colours, lamps and light for pictures that are drawn here, as ``static/player/palette.js`` has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.body import vertex_normals
from motion.looks import Colour, rgb, themes
from motion.skeleton import SMPL22
from motion.smoothing import smoothstep
from motion.vectors import FLAT, Array, unit

from .camera import Camera

Worn = Mapping[str, Colour]

REACH = 18.0
"""Metres from the camera's target after which the floor is as dim as it gets."""


@dataclass(frozen=True)
class Lamps:
    """Light (red, green, blue) of each lamp, and how strong highlights are."""

    key: Colour
    sky: Colour
    ground: Colour
    rim: Colour
    shine: float


@dataclass(frozen=True)
class Theme:
    """Colours from 0 to 1.

    Attributes:
        sky, horizon: of the sky high up and right above the floor.
        floor, far: of the floor at the camera's target and in the distance.
        grid, grid_strong: of the lines on it.
        shade: what full shadow multiplies the floor by.
        ghost, ink: of a pale figure, and of captions.
        lamps: the light on bodies.
        bodies, given_bodies: by zone, a's and b's; greyer while a motion is given.
        people, given: middle, left and right limbs of skeletons, a's and b's.
    """

    sky: Colour
    horizon: Colour
    far: Colour
    floor: Colour
    grid: Colour
    grid_strong: Colour
    shade: Colour
    ghost: Colour
    ink: Colour
    lamps: Lamps
    bodies: tuple[Worn, Worn]
    people: tuple[tuple[Colour, Colour, Colour], ...]
    given: tuple[tuple[Colour, Colour, Colour], ...]

    @property
    def given_bodies(self) -> tuple[Worn, Worn]:
        """The colours of people who are given, greyer than those who are made."""
        return _greyer(self.bodies[0]), _greyer(self.bodies[1])


def _greyer(zones: Worn) -> Worn:
    greys = {}
    for zone, colour in zones.items():
        grey = 0.75 * (0.3 * colour[0] + 0.55 * colour[1] + 0.15 * colour[2]) + 0.14
        red, green, blue = (part + 0.72 * (grey - part) for part in colour)
        greys[zone] = (red, green, blue)
    return greys


def _coloured(stored: Any) -> Any:
    """Parts of a theme as the file has them, with numbers for each "#rrggbb" and tuples for lists."""
    if isinstance(stored, str):
        return rgb(stored)
    if isinstance(stored, dict):
        return {key: _coloured(each) for key, each in stored.items()}
    return tuple(map(_coloured, stored)) if isinstance(stored, list) else stored


def _theme(stored: Mapping[str, Any]) -> Theme:
    colours = _coloured({**stored, "grid_strong": stored["gridStrong"]}) | {
        "lamps": Lamps(**_coloured(stored["lamps"]))
    }
    return Theme(**{part.name: colours[part.name] for part in fields(Theme)})


THEMES = {name: _theme(stored) for name, stored in themes().items()}


# ---- Light on surfaces and their shadow on the floor, as in the player (``body.js``, ``ground.js``) ------------------
_GAMMA = 2.2
SHADOW_SIZE = 192
"""Pixels of the shadow's picture, each way."""
_LEAST_SPAN = 5.0
_HIGHEST = 1.8
_SAMPLES = 3
THING_SHADE = 0.3
"""Darkness of a thing's shadow for each square metre of its surface, of which a floor sees a quarter or more."""
_RADII = {"head": 0.09, "spine1": 0.11, "spine2": 0.11, "spine3": 0.11, "hip": 0.09, "knee": 0.07}
_BONES = np.array(SMPL22.bones)
_BONE_RADII = np.array([_RADII.get(SMPL22.joint_names[joint].rpartition("_")[2], 0.05) for _, joint in SMPL22.bones])


def lit(
    vertices: Array, faces: NDArray[np.integer], colours: Array, opened: Array, lamps: Lamps, camera: Camera
) -> Array:
    """Colours (F, 3, 3) of the corners of any surface's triangles, under lamps that move with the camera.

    Args:
        vertices: (V, 3) where they are, metres.
        faces: (F, 3) vertex indices.
        colours: (F, 3) sRGB of the triangles, 0 to 1.
        opened: (V,) ambient light that reaches each vertex, 0 to 1.
        lamps: of the theme.
        camera: from which it is seen.
    """
    normals = vertex_normals(vertices, faces)
    right, _, forward = camera.axes
    flat = forward * FLAT
    key = unit(-0.75 * flat - 0.75 * right + np.array([0.0, 0.95, 0.0]))
    rim = unit(0.8 * flat + 0.9 * right + np.array([0.0, 0.55, 0.0]))
    to_eye = unit(camera.eye - vertices)
    above = 0.5 + 0.5 * normals[:, 1]
    front = np.maximum((normals @ key + 0.25) / 1.25, 0.0) * (0.35 + 0.65 * opened)
    edge = 1 - np.maximum(np.einsum("vi,vi->v", normals, to_eye), 0.0)
    behind = np.maximum(normals @ rim, 0.0) * edge * edge * opened
    shine = np.maximum(np.einsum("vi,vi->v", unit(to_eye + key), normals), 0.0) ** 22
    grounded = 0.4 + 0.6 * smoothstep(vertices[:, 1], -0.05, 0.5)
    shares = np.stack(
        [(1 - above) * grounded * opened**2, above * opened**2, front, behind], axis=1
    )  # of ground, sky, key and rim
    light = shares @ np.array([lamps.ground, lamps.sky, lamps.key, lamps.rim])
    glow = (lamps.shine * shine * opened)[faces, None]
    bright = (colours**_GAMMA)[:, None] * light[faces] + glow
    return np.clip(bright, 0.0, 1.0) ** (1 / _GAMMA)


class Shadow:
    """Ambient shadow: how much of the sky is hidden from each place on the floor.

    Attributes:
        dark: (S, S) from 0, open, to 1, hidden; rows along X and columns along Z.
        origin: (2,) X and Z of the first pixel's corner, metres.
        span: metres across the picture.
    """

    def __init__(self, poses: Array, surfaces: Sequence[Array], spots: Array | None = None) -> None:
        """Shades the floor under poses (people, 22, 3); the soles of surfaces (V, 3) darken it at contact.

        ``spots`` (N, 4) are places of things in the world and the square metres about each.
        """
        floor = poses[..., [0, 2]].reshape(-1, 2)
        low, high = floor.min(axis=0) - 0.9, floor.max(axis=0) + 0.9
        self.span = max(float(np.ceil((high - low).max())), _LEAST_SPAN)
        pixel = self.span / SHADOW_SIZE
        self.origin = np.round(((low + high) / 2 - self.span / 2) / pixel) * pixel
        starts, ends = poses[:, _BONES[:, 0]], poses[:, _BONES[:, 1]]
        along = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
        points = starts[:, :, None] + along[:, None] * (ends - starts)[:, :, None]
        height = points[..., 1]
        length = np.linalg.norm(ends - starts, axis=-1)[..., None] / _SAMPLES
        fade = np.maximum(1 - height / _HIGHEST, 0.0)
        amount = 6 * _BONE_RADII[:, None] * length * fade**2
        field = self._splats(points.reshape(-1, 3), 0.05 + 0.17 * np.maximum(height, 0).ravel(), amount.ravel())
        if spots is not None and len(spots):
            height = np.maximum(spots[:, 1], 0.0)
            amount = THING_SHADE * spots[:, 3] * np.maximum(1 - height / _HIGHEST, 0.0) ** 2
            field += self._splats(spots[:, :3], 0.05 + 0.17 * height, amount)
        soles = [surface[surface[:, 1] < 0.07] for surface in surfaces]
        if soles and sum(map(len, soles)):
            near = np.concatenate(soles)
            pressed = 0.0011 * np.minimum(np.exp(-near[:, 1] / 0.02), 1.2)
            field += self._splats(near, np.full(len(near), 0.026), pressed)
        self.dark = 1 - np.exp(-field)
        self.dark[[0, -1]] = self.dark[:, [0, -1]] = 0.0

    def _splats(self, points: Array, sigma: Array, amount: Array) -> Array:
        """(S, S) the sum of round Gaussians, which are products of one along each axis."""
        pixel = self.span / SHADOW_SIZE
        places = ((np.arange(SHADOW_SIZE) + 0.5) * pixel).astype(np.float32)
        away = (points[:, [0, 2]] - self.origin).astype(np.float32)[:, :, None] - places
        away *= np.sqrt(0.5).astype(np.float32) / sigma.astype(np.float32)[:, None, None]
        bells = np.exp(-np.square(away, out=away), out=away)
        peak = (amount / (2 * np.pi * sigma**2)).astype(np.float32)
        return (bells[:, 0] * peak[:, None]).T @ bells[:, 1]

    def at(self, x: Array, z: Array) -> tuple[Array, NDArray[np.intp]]:
        """Darkness of the floor's shadow at places (any shape, metres).

        Returns:
            (N,) from 0 to 1, and the indices of these places where all are counted in a row.
        """
        scale = np.float32(SHADOW_SIZE / self.span)
        row = (x.ravel() - np.float32(self.origin[0])) * scale - np.float32(0.5)
        column = (z.ravel() - np.float32(self.origin[1])) * scale - np.float32(0.5)
        last = SHADOW_SIZE - 1
        inside = np.flatnonzero((row >= 0) & (column >= 0) & (row < last) & (column < last))
        return scipy.ndimage.map_coordinates(self.dark, [row[inside], column[inside]], order=1), inside
