"""Turns the bodies of a prediction to the headings at which their hips are held.

A held heading is a place of both hips, and the least move of :class:`models.known.Hold` would turn the pelvis alone: so
the whole body is turned about its pelvis first, by an angle that changes linearly from one held frame to the next.

Shapes: B motions, T frames that fill a number of tokens, K knots, 70 numbers a person.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from models.motion_tokens import NUM_JOINTS, TokenLayout, pack, unpack
from motion import SMPL22
from motion.vectors import wrapped

DIES_OUT = 30
"""Frames from a held heading to where a body faces as it was predicted, unless another frame says how it faces."""
_JOINTS = slice(3, 3 * NUM_JOINTS)
_HIPS = [3 * SMPL22.index(hip) + axis for hip in ("left_hip", "right_hip") for axis in (0, 2)]
_TRUNK = 3 * SMPL22.index("neck")
_CLOSE = 1e-4
"""Metres between the hips on the floor under which a body faces nowhere."""


class Turned(NamedTuple):
    """One person's held headings.

    Attributes:
        row: the person, of the motions' people in a row (B·2).
        frames: (N,) in order, at which it is known how they face, also those whose whole pose is given.
        across: (N,) angles of the line between the hips as given.
    """

    row: int
    frames: NDArray[np.integer]
    across: NDArray[np.floating]


class Turning:
    """Turns people to the headings at which their hips are held.

    Args:
        rows: (B, 2, T, 70) what is known, in metres.
        mask: the same shape, true where a number is known.
        layout: frames a knot and knots a token.
        mean, std: (70,) of the network's normaliser.
    """

    def __init__(self, rows: Tensor, mask: Tensor, layout: TokenLayout, mean: Tensor, std: Tensor) -> None:
        self.layout, self.mean, self.std = layout, mean, std
        self.batch = len(rows)
        self.basis = layout.basis(layout.num_tokens(rows.shape[2]))
        self.people = [
            turned
            for i, (values, known) in enumerate(zip(rows.flatten(0, 1), mask.flatten(0, 1), strict=True))
            if (turned := _turned(i, values, known)) is not None
        ]

    def __call__(self, x: Tensor) -> Tensor:
        """x (B, tokens, 2·token_features) with the bodies turned; any B if one motion is known."""
        if not self.people:
            return x
        control = unpack(x, self.layout)  # (B, 2, K, 70)
        people = (control.reshape(-1, self.batch * 2, *control.shape[2:]) * self.std + self.mean).clone()
        for turned in self.people:
            body = people[:, turned.row]
            angles = self._angles(turned, body)  # (copies, K)
            sine, cosine = angles.sin()[..., None], angles.cos()[..., None]
            joints = body[..., _JOINTS].unflatten(-1, (-1, 3))
            ahead, up, along = joints.unbind(-1)
            there = torch.stack([ahead * cosine + along * sine, up, along * cosine - ahead * sine], -1)
            people[:, turned.row, :, _JOINTS] = there.flatten(-2)
        return pack(((people - self.mean) / self.std).view(control.shape), self.layout)

    def _angles(self, turned: Turned, body: Tensor) -> Tensor:
        """(copies, K) radians by which control points (copies, K, 70) are turned."""
        at = self.basis[torch.from_numpy(turned.frames)]
        across = _across((at @ body[..., _HIPS]).double().numpy())
        apart = np.unwrap(wrapped(turned.across - across))
        first, last = turned.frames[0] - DIES_OUT, turned.frames[-1] + DIES_OUT
        frames = np.concatenate([[first], turned.frames, [last]])
        knots = self.layout.frames_per_knot * (np.arange(body.shape[1]) - 1)
        found = [np.interp(knots, frames, np.pad(each, 1)) for each in apart]
        return torch.from_numpy(np.stack(found)).to(body)


def _turned(row: int, values: Tensor, known: Tensor) -> Turned | None:
    """The held headings of a person with rows (T, 70); None where none is held."""
    hips = known[:, _HIPS].all(-1)
    if not (hips & ~known[:, _TRUNK]).any():
        return None
    frames = hips.nonzero()[:, 0].numpy()
    return Turned(row, frames, _across(values[frames][:, _HIPS].double().numpy()))


def _across(hips: NDArray[np.floating]) -> NDArray[np.floating]:
    """(…) radians of the line from the right to the left hip, of (…, 4) places on the floor; turns with the heading."""
    line = hips[..., :2] - hips[..., 2:]
    length = np.hypot(line[..., 0], line[..., 1])
    angle = np.arctan2(line[..., 0], line[..., 1])
    return np.where(length > _CLOSE, angle, 0.0)
