"""Draws a picture of the player's scene without a display: floor, shadows, bodies, skeletons, names.

Matplotlib's Agg renderer fills the triangles and strokes the lines; it needs no window and no graphics card.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from motion.body import Body, load_body, skin
from motion.clip import Clip, Duet, stacked_positions
from motion.errors import InputError
from motion.looks import UNSAID
from motion.skeleton import SMPL22
from motion.smoothing import smoothstep
from motion.things.thing import Thing
from motion.vectors import Array

from .camera import Camera, sampled
from .theme import REACH, THEMES, Colour, Shadow, Theme, lit
from .things import divided, hands_of, shadow_spots

LOOKS = ("bodies", "skeletons", "both")
_GRID = 9
_COARSE = 2
"""The floor and the sky are computed at every second pixel, lines and people at every pixel."""
_GRID_STEPS = 10
_BLOCK = 32
"""Frames whose bodies are posed at once."""
_TRANSLUCENT = 0.42
_ABOVE_HEAD = 0.26
_BONES = np.array(SMPL22.bones)
_SIDES = [name.startswith("left_") + 2 * name.startswith("right_") for name in SMPL22.joint_names]
"""Index of each joint's colour in the theme: 0 middle, 1 left, 2 right."""


@dataclass(frozen=True)
class Pane:
    """One motion of a picture.

    Attributes:
        motion: one person or two.
        caption: distinguishes it from the pane beside it.
        ghost: a second motion drawn pale, such as what really followed.
        past_until: the first predicted frame; people are greyer before it.
    """

    motion: Clip | Duet
    caption: str = ""
    ghost: Clip | Duet | None = None
    past_until: int = 0


@dataclass(frozen=True)
class Style:
    """Drawing style of people.

    Attributes:
        look: "bodies", "skeletons" or "both".
        names: whether roles stand above the heads.
        theme: "light" or "dark".

    Raises:
        InputError: for another look or theme.
    """

    look: str = "bodies"
    names: bool = True
    theme: str = "light"

    def __post_init__(self) -> None:
        if self.look not in LOOKS:
            raise InputError(f"There is no look {self.look!r:.30}: choose one of {', '.join(LOOKS)}.")
        if self.theme not in THEMES:
            raise InputError(f"There is no theme {self.theme!r:.30}: choose one of {', '.join(THEMES)}.")

    @property
    def colours(self) -> Theme:
        """The colours of its theme."""
        return THEMES[self.theme]


@dataclass
class Stage:
    """Draws a pane at any moment.

    Args:
        pane: what is shown.
        style: how.
        size: width and height in pixels.
    """

    pane: Pane
    style: Style
    size: tuple[int, int]
    people: Array = field(init=False, repr=False)
    bodies: tuple[Body, ...] = field(init=False, repr=False)
    things: tuple[Thing, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        motion = self.pane.motion
        self.people = stacked_positions(motion).astype(np.float64)
        # Most of a small picture's triangles would be smaller than its pixels.
        small = self.size[1] < 400
        looks = motion.looks if isinstance(motion, Duet) else UNSAID[:1]
        self.bodies = tuple(load_body(look, small=small) for look in looks if self.style.look != "skeletons")
        things = motion.things if isinstance(motion, Duet) else ()
        self.things = tuple(replace(thing, mesh=divided(thing.mesh)) for thing in things)  # to be sorted by depth

    def pictures(self, times: Array, cameras: Sequence[Camera]) -> Iterator[Image.Image]:
        """The pictures at moments in seconds, without captions, each from its camera."""
        for start in range(0, len(times), _BLOCK):
            block = times[start : start + _BLOCK]
            poses = sampled(self.people, self.pane.motion.fps, block)
            frames = block * self.pane.motion.fps
            surfaces = [
                skin(body, way, hands_of(self.pane.motion, person, frames))
                for person, (body, way) in enumerate(zip(self.bodies, poses, strict=False))
            ]
            for i, seconds in enumerate(block):
                worn = [surface[i].astype(np.float64) for surface in surfaces]
                yield self._draw(float(seconds), poses[:, i], worn, cameras[start + i])

    def _draw(self, seconds: float, pose: Array, surfaces: Sequence[Array], camera: Camera) -> Image.Image:
        from matplotlib.backends.backend_agg import RendererAgg

        motion, theme = self.pane.motion, self.style.colours
        given = seconds * motion.fps < self.pane.past_until
        renderer = RendererAgg(*self.size, 72)
        canvas = np.asarray(renderer.buffer_rgba())
        frame = seconds * motion.fps
        shadow = Shadow(pose, surfaces, shadow_spots(self.things, frame))
        canvas[..., :3], canvas[..., 3] = _ground(camera, theme, shadow), 255
        pen = _Pen(renderer, camera)
        pen.grid(theme)
        if self.pane.ghost is not None:
            for points in sampled(stacked_positions(self.pane.ghost), motion.fps, np.array([seconds]))[:, 0]:
                pen.lines(points[_BONES], [theme.ghost] * len(_BONES), 2.5)
        worn = theme.given_bodies if given else theme.bodies
        alpha = _TRANSLUCENT if self.style.look == "both" else 1.0
        solid = []
        for body, surface, colours in zip(self.bodies, surfaces, worn, strict=False):
            palette = np.array([colours.get(zone, colours["top"]) for zone in body.zones])
            shades = lit(surface, body.faces, palette[body.face_zones], body.sky, theme.lamps, camera)
            solid.append((body.faces, surface, shades, alpha))
        for thing in self.things:
            mesh, surface = thing.mesh, thing.at(frame)
            shades = lit(surface, mesh.faces, mesh.colours / 255, np.ones(len(surface)), theme.lamps, camera)
            solid.append((mesh.faces, surface, shades, 1.0))
        pen.surfaces(solid)
        if self.style.look != "bodies":
            limbs = theme.given if given else theme.people
            order = np.argsort(-pen.camera.project(pose[:, 0])[1])
            for person in order:
                pen.skeleton(pose[person], limbs[person])
        picture = Image.fromarray(canvas).convert("RGB")
        if self.style.names:
            self._names(picture, pose, camera, limbs=theme.people)
        return picture

    def _names(self, picture: Image.Image, pose: Array, camera: Camera, *, limbs: Sequence) -> None:
        motion = self.pane.motion
        roles = motion.roles if isinstance(motion, Duet) else (motion.name or "a",)
        for person, points in enumerate(pose):
            top = points[points[:, 1].argmax()] + np.array([0.0, _ABOVE_HEAD, 0.0])
            (x, y), depth = camera.project(top)
            if depth > 0:
                role = roles[person]
                label = _label(role.upper() if len(role) == 1 else role, limbs[person][0], self.size[1])
                picture.paste(label, (round(x - label.width / 2), round(max(y - label.height / 2, 2))), label)


class _Pen:
    """Strokes and fills in metres."""

    def __init__(self, renderer, camera: Camera) -> None:
        from matplotlib.transforms import IdentityTransform

        self.renderer, self.camera = renderer, camera
        self.height = camera.size[1]
        self.nowhere = IdentityTransform()

    def grid(self, theme: Theme) -> None:
        """A one-metre grid that fades out around the camera's target."""
        middle = np.round(self.camera.target[[0, 2]])
        steps = np.arange(-_GRID, _GRID + 1)
        along = np.stack(np.meshgrid(steps[:-1], steps), axis=-1).reshape(-1, 2).astype(float)
        for first, second in ((0, 1), (1, 0)):
            lines = np.zeros((len(along), 2, 3))
            lines[:, 0, [0, 2]] = along[:, [first, second]]
            lines[:, 1, [0, 2]] = (along + np.array([1.0, 0.0]))[:, [first, second]]
            lines[..., [0, 2]] += middle
            away = np.linalg.norm(lines.mean(axis=1)[:, [0, 2]] - middle, axis=1)
            strength = np.round(_GRID_STEPS * (1 - smoothstep(away, 0, _GRID)))
            strong = (along[:, 1] + middle[1 - first]) % 5 == 0
            pixels, seen = self._placed(lines)
            for is_strong in (False, True):
                colour = theme.grid_strong if is_strong else theme.grid
                width = (1.6 if is_strong else 1.1) * self.height / 720
                for step in range(1, _GRID_STEPS + 1):
                    chosen = seen & (strong == is_strong) & (strength == step)
                    if chosen.any():
                        self._stroke(pixels[chosen], colour, width, step / _GRID_STEPS)

    def lines(self, ends: Array, colours: Sequence[Colour], widths: Array | float) -> None:
        """Straight lines (N, 2, 3), each with its colour and width in pixels."""
        pixels, seen = self._placed(ends)
        widths = np.broadcast_to(widths, len(ends))
        for i in np.flatnonzero(seen).tolist():
            self._stroke(pixels[i], colours[i], float(widths[i]))

    def _placed(self, ends: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Pixels (N, 2, 2) of lines (N, 2, 3), and a mask of those in front of the camera."""
        pixels, depth = self.camera.project(ends)
        return self._up(pixels), np.all(depth > 0.1, axis=1)

    def _stroke(self, pixels: Array, colour: Colour, width: float, alpha: float = 1.0) -> None:
        from matplotlib.path import Path

        pen = self.renderer.new_gc()
        pen.set_foreground((*colour, alpha), isRGBA=True)
        pen.set_linewidth(width)
        pen.set_capstyle("round")
        ends = pixels.reshape(-1, 2)
        codes = np.tile(np.array([Path.MOVETO, Path.LINETO], dtype=Path.code_type), len(ends) // 2)
        self.renderer.draw_path(pen, Path(ends, codes), self.nowhere)

    def skeleton(self, points: Array, limbs: tuple[Colour, Colour, Colour]) -> None:
        """Thin bones with round joints, left lighter and right darker."""
        far = self.camera.project(points[_BONES].mean(axis=1))[1]
        widths = np.maximum(0.022 * self.camera.focal / np.maximum(far, 0.1), 1.5)
        order = np.argsort(-far)
        self.lines(points[_BONES][order], [limbs[_SIDES[_BONES[i, 1]]] for i in order], widths[order])
        depth = self.camera.project(points)[1]
        dots = np.maximum(0.044 * self.camera.focal / np.maximum(depth, 0.1), 3.0)
        self.lines(
            np.repeat(points[:, None], 2, axis=1) + np.array([[0, 0, 0], [1e-4, 0, 0]]),
            [limbs[side] for side in _SIDES],
            dots,
        )

    def surfaces(self, solid: Sequence[tuple[NDArray[np.integer], Array, Array, float]]) -> None:
        """Smooth triangles of surfaces as (faces, vertices, colours, alpha), the farthest first."""
        triangles, depths, colours = [], [], []
        for faces, surface, shades, alpha in solid:
            pixels, depth = self.camera.project(surface)
            corners = pixels[faces]
            one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
            far = depth[faces]
            seen = (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0] < 0) & (far.min(axis=1) > 0.1)
            triangles.append(corners[seen])
            depths.append(far[seen].mean(axis=1))
            filled = np.full((int(seen.sum()), 3, 4), alpha)
            filled[..., :3] = shades[seen]
            colours.append(filled)
        if not triangles:
            return
        order = np.argsort(-np.concatenate(depths))
        plain = self.renderer.new_gc()
        self.renderer.draw_gouraud_triangles(
            plain, self._up(np.concatenate(triangles)[order]), np.concatenate(colours)[order], self.nowhere
        )

    def _up(self, pixels: Array) -> Array:
        """Agg's origin is the lower left corner."""
        return pixels * np.array([1.0, -1.0]) + np.array([0.0, self.height])


def _ground(camera: Camera, theme: Theme, shadow: Shadow) -> NDArray[np.uint8]:
    """(height, width, 3) floor, horizon and sky with the shadow."""
    width, height = (-(-side // _COARSE) for side in camera.size)
    right, up, forward = camera.axes.astype(np.float32)
    x = (((np.arange(width) + 0.5) * _COARSE - camera.size[0] / 2) / camera.focal).astype(np.float32)
    y = ((camera.size[1] / 2 - (np.arange(height) + 0.5) * _COARSE) / camera.focal).astype(np.float32)
    rows = forward + y[:, None] * up  # the camera never leans, so that a row has one slope
    slope = rows[:, 1]
    first = int(np.searchsorted(-slope, 1e-4))  # of the rows that show floor
    picture = np.empty((height, width, 3), dtype=np.float32)
    rise = np.arctan(slope[:first] / np.hypot(rows[:first, 0], rows[:first, 2]))
    picture[:first] = _mixed(theme.horizon, theme.sky, smoothstep(rise, 0.0, 0.55)[:, None])
    if first < height:
        reach = (camera.eye[1] / -slope[first:])[:, None].astype(np.float32)
        # Metres from what the camera looks at, along X and Z.
        east = reach * (rows[first:, :1] + x * right[0]) + np.float32(camera.eye[0] - camera.target[0])
        south = reach * (rows[first:, 2:] + x * right[2]) + np.float32(camera.eye[2] - camera.target[2])
        away = np.sqrt(east * east + south * south)
        picture[first:] = _mixed(theme.floor, theme.far, smoothstep(away / np.float32(REACH)))
        dark, hidden = shadow.at(east + np.float32(camera.target[0]), south + np.float32(camera.target[2]))
        lost = (1 - np.array(theme.shade)).astype(np.float32)
        picture[first:].reshape(-1, 3)[hidden] *= 1 - dark[:, None].astype(np.float32) * lost
    pixels = (255 * picture + 0.5).astype(np.uint8)
    return pixels.repeat(_COARSE, axis=0).repeat(_COARSE, axis=1)[: camera.size[1], : camera.size[0]]


def _mixed(first: Colour, second: Colour, share: Array) -> Array:
    """(…, 3) from one colour to another by shares (…)."""
    one, other = (np.array(colour, dtype=np.float32) for colour in (first, second))
    return one + share[..., None].astype(np.float32) * (other - one)


@lru_cache(maxsize=64)
def font(pixels: int) -> ImageFont.FreeTypeFont:
    """DejaVu Sans, which comes with matplotlib."""
    from matplotlib import get_data_path

    return ImageFont.truetype(f"{get_data_path()}/fonts/ttf/DejaVuSans.ttf", pixels)


@lru_cache(maxsize=64)
def _label(text: str, colour: Colour, height: int) -> Image.Image:
    """White text on a pill of a person's colour."""
    pixels = max(round(height / 50), 9)
    fine = 4
    left, _, right, _ = font(fine * pixels).getbbox(text)
    size = (round(right - left + 1.4 * fine * pixels), round(1.8 * fine * pixels))
    pill = Image.new("RGBA", size, (0, 0, 0, 0))
    pen = ImageDraw.Draw(pill)
    pen.rounded_rectangle((0, 0, size[0] - 1, size[1] - 1), size[1] / 2, fill=in_pixels(colour))
    pen.text((size[0] / 2, size[1] / 2), text, font=font(fine * pixels), fill="white", anchor="mm")
    return pill.resize((size[0] // fine, size[1] // fine), Image.Resampling.LANCZOS)


def write(picture: Image.Image, place: tuple[float, float], text: str, colour: Colour, pixels: int, at: str) -> None:
    """Writes a line of text into a picture; ``at`` says which of its points is at the place, as Pillow's anchors do."""
    ImageDraw.Draw(picture).text(place, text, font=font(pixels), fill=in_pixels(colour), anchor=at)


def in_pixels(colour: Colour) -> tuple[int, ...]:
    """A colour as three whole numbers up to 255."""
    return tuple(round(255 * part) for part in colour)
