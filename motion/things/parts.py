"""Parts that the shapes of things are put together from: boxes, rods, tubes and balls with a colour each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import trimesh

from motion.looks import rgb
from motion.vectors import Array

from .thing import Mesh

Part = tuple[trimesh.Trimesh, str]
"""A surface and its colour, "#rrggbb"."""

_SHARP = np.deg2rad(40)
"""Angle between two triangles from which their edge is sharp."""


def box(size: Sequence[float], at: Sequence[float], colour: str, *, lean: float = 0.0) -> Part:
    """A box of ``size`` (3,) with its middle ``at`` (3,), turned about X by ``lean``."""
    made = trimesh.creation.box(size)
    made.apply_transform(trimesh.transformations.rotation_matrix(lean, [1, 0, 0]))
    made.apply_translation(at)
    return made, colour


def rod(start: Sequence[float], stop: Sequence[float], radius: float, colour: str, *, sides: int = 8) -> Part:
    """A round rod from one point to another."""
    return trimesh.creation.cylinder(radius=radius, segment=[start, stop], sections=sides), colour


def ball(
    radius: float, at: Sequence[float], colour: str, *, fine: int = 2, stretch: Sequence[float] = (1, 1, 1)
) -> Part:
    """A ball, or an egg where it is stretched."""
    made = trimesh.creation.icosphere(subdivisions=fine, radius=radius)
    made.apply_scale(np.asarray(stretch, dtype=float))
    made.apply_translation(at)
    return made, colour


def turned(profile: Sequence[Sequence[float]], colour: str, *, sides: int = 16) -> Part:
    """The solid that a lathe makes of a line of (radius, height) pairs, about the Y axis."""
    made = trimesh.creation.revolve(np.asarray(profile, dtype=float), sections=sides)
    made.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0]))
    if made.volume < 0:
        made.invert()
    return made, colour


def hoop(radius: float, thick: float, colour: str, *, arc: float = 2 * np.pi, sides: int = 6, steps: int = 20) -> Part:
    """A ring of round wire about the Z axis, or an arc of it that begins on +X."""
    around = np.linspace(0.0, 2 * np.pi, sides + 1)
    profile = np.stack([radius + thick * np.cos(around), thick * np.sin(around)], axis=1)
    return trimesh.creation.revolve(profile, angle=arc, sections=steps), colour


def slab(outline: Array | Sequence[Sequence[float]], thick: float, colour: str) -> Part:
    """A convex outline in the XY plane as a slab of this thickness about it."""
    flat = np.asarray(outline, dtype=float)
    points = np.concatenate([np.c_[flat, np.full(len(flat), z)] for z in (-thick / 2, thick / 2)])
    return trimesh.Trimesh(points, process=False).convex_hull, colour


def pleated(line: Array, height: float, thick: float, colour: str) -> Part:
    """A sheet of this thickness that stands on the floor along a line (N, 2) of x and z, from -X to +X."""
    count = len(line)
    rows = [np.insert(line + np.array([0.0, z]), 1, y, axis=1) for z in (thick / 2, -thick / 2) for y in (0.0, height)]
    i = np.arange(count - 1)
    front, back = (0, count), (2 * count, 3 * count)  # the first vertices of the lower and the upper row
    loops = [(front[0], front[1]), (back[1], back[0]), (front[1], back[1]), (back[0], front[0])]
    faces = [
        face
        for low, high in loops
        for face in (np.stack([low + i, low + i + 1, high + i + 1], 1), np.stack([low + i, high + i + 1, high + i], 1))
    ]
    last = count - 1
    for j, flip in ((0, True), (last, False)):
        end = np.array([[front[0], back[0], back[1]], [front[0], back[1], front[1]]]) + j
        faces.append(end[:, ::-1] if flip else end)
    return trimesh.Trimesh(np.concatenate(rows), np.concatenate(faces), process=False), colour


def placed(part: Part, at: Sequence[float] = (0, 0, 0), turns: Sequence[tuple[float, str]] = ()) -> Part:
    """A part turned by angles about "x", "y" or "z", one after another, and then moved."""
    made, colour = part[0].copy(), part[1]
    for angle, axis in turns:
        direction = [float(axis == name) for name in "xyz"]
        made.apply_transform(trimesh.transformations.rotation_matrix(angle, direction))
    made.apply_translation(at)
    return made, colour


def upper(part: Part, axis: str, colour: str) -> list[Part]:
    """A part in two colours: the triangles that face along +``axis`` take ``colour``."""
    made, other = part
    facing = made.face_normals[:, "xyz".index(axis)] > 0.9
    rest, top = (trimesh.Trimesh(made.vertices, made.faces[chosen], process=False) for chosen in (~facing, facing))
    return [(rest, other), (top, colour)]


def joined(parts: Sequence[Part]) -> Mesh:
    """Parts as one surface, with the vertices of sharp edges split."""
    vertices, faces, colours, first = [], [], [], 0
    for part, colour in parts:
        made = trimesh.graph.smooth_shade(part, angle=_SHARP)  # the order of triangles may change
        vertices.append(made.vertices)
        faces.append(made.faces + first)
        shade = np.rint(255 * np.array(rgb(colour))).astype(np.uint8)
        colours.append(np.tile(shade, (len(made.faces), 1)))
        first += len(made.vertices)
    return Mesh(np.concatenate(vertices), np.concatenate(faces), np.concatenate(colours))
