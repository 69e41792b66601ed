"""A motion on one page: evenly spaced frames from two sides, for the eye."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from motion.clip import Clip, Duet, stacked_positions

Array = NDArray[np.floating]

# Person a blue, person b orange; left limbs lighter, to distinguish the sides.
_COLOURS = {0: ((31, 95, 168), (120, 175, 232)), 1: ((196, 84, 10), (250, 168, 100))}
_BACKGROUND, _INK, _GROUND = (252, 252, 250), (60, 60, 60), (205, 205, 200)
# One person is drawn from the front and the side, two people from the side.
_YAW_OF_ONE, _YAW_OF_TWO = np.radians(35.0), np.radians(-65.0)
_PITCH = np.radians(10.0)


def contact_sheet(
    motion: Clip | Duet, path: str | Path | None = None, *, frames: int = 8, title: str = "", tile: int = 200
) -> Image.Image:
    """Draws evenly spaced frames, in a row from front and aside and in a row from above.

    Args:
        motion: one person or two.
        path: where to save the PNG; ``None`` only returns it.
        frames: how many frames to show.
        title: a line above; the file's or motion's name.
        tile: width of a picture in pixels.

    Returns:
        the picture. The upper row follows the people: one is seen from the front and a little aside, two from
        the side with person a on the left where a faces b along +Z. In the lower row, which stays in place,
        +Z points down the page and +X to the right. A small triangle shows where each person faces.
    """
    people = stacked_positions(motion).astype(np.float64)
    count = people.shape[1]
    chosen = np.unique(np.linspace(0, count - 1, min(frames, count)).round().astype(int))
    views = [_front(people), _top(people)]
    heights = [int(tile * 1.35), tile]
    head = 26 if title else 4
    sheet = Image.new("RGB", (tile * len(chosen), head + sum(heights) + 16), _BACKGROUND)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(13)
    if title:
        draw.text((6, 5), title, fill=_INK, font=font)
    top = head
    for row, (view, height) in enumerate(zip(views, heights, strict=True)):
        shown = view[:, chosen]
        low, high = shown[..., :2].min(axis=(0, 1, 2)), shown[..., :2].max(axis=(0, 1, 2))
        if row == 0:
            low[1] = min(low[1], 0.0)
        scale = min((tile - 16) / max(high[0] - low[0], 0.5), (height - 20) / max(high[1] - low[1], 0.5))
        for column, frame in enumerate(chosen):
            centre = np.array([tile * (column + 0.5), top + height / 2])
            pixels = (view[:, frame, :, :2] - (low + high) / 2) * scale * np.array([1, -1]) + centre
            if row == 0:
                ground = centre[1] + (low[1] + high[1]) / 2 * scale
                draw.line([(tile * column + 3, ground), (tile * (column + 1) - 3, ground)], fill=_GROUND, width=2)
            # The person who is farther away is drawn first.
            for person in np.argsort(view[:, frame, 0, 2]):
                _draw_person(draw, pixels[person], motion, person)
                if row == 1:
                    _draw_facing(draw, pixels[person], motion)
        top += height
    for column, frame in enumerate(chosen):
        draw.text((tile * column + 6, top), f"{frame / motion.fps:.2f} s", fill=_INK, font=font)
    if path is not None:
        sheet.save(path, format="PNG")
    return sheet


def _front(people: Array) -> Array:
    """(P, T, J, 3) right, up, towards the viewer, around the middle of the people in each frame."""
    people = people - people[:, :, :1].mean(axis=0, keepdims=True) * np.array([1.0, 0.0, 1.0])
    yaw = _YAW_OF_ONE if len(people) == 1 else _YAW_OF_TWO
    cos, sin = np.cos(yaw), np.sin(yaw)
    x, y, z = people[..., 0], people[..., 1], people[..., 2]
    right, depth = x * cos - z * sin, x * sin + z * cos
    # Seen from slightly above: what is nearer sinks.
    return np.stack([right, y * np.cos(_PITCH) - depth * np.sin(_PITCH), depth], axis=-1)


def _top(people: Array) -> Array:
    return np.stack([people[..., 0], -people[..., 2], people[..., 1]], axis=-1)


def _draw_person(draw: ImageDraw.ImageDraw, pixels: Array, motion: Clip | Duet, person: int) -> None:
    skeleton = motion.skeleton
    dark, light = _COLOURS[person]
    for parent, joint in skeleton.bones:
        colour = light if skeleton.joint_names[joint].startswith("left_") else dark
        draw.line([tuple(pixels[parent]), tuple(pixels[joint])], fill=colour, width=3)
    if "head" in skeleton.joint_names:
        x, y = pixels[skeleton.index("head")]
        draw.ellipse([x - 5, y - 5, x + 5, y + 5], fill=dark)


def _draw_facing(draw: ImageDraw.ImageDraw, pixels: Array, motion: Clip | Duet) -> None:
    names = motion.skeleton.joint_names
    if "left_hip" not in names:
        return
    left, right = pixels[names.index("left_hip")], pixels[names.index("right_hip")]
    across = left - right
    forward = np.array([-across[1], across[0]])
    length = np.linalg.norm(forward)
    if length < 1e-3:
        return
    middle = (left + right) / 2
    tip = middle + forward / length * 14
    aside = across / length * 4
    draw.polygon([tuple(tip), tuple(middle + aside), tuple(middle - aside)], fill=_INK)
