"""The known part of a motion: a person, the past, a span, single poses, joints, or a path on the floor.

All kinds share one form: values and a mask over people, frames and the 70 numbers of a frame
(:func:`models.motion_tokens.feature_rows`), and for a path also headings. A network's motion is a spline, so a known
number of a frame is a linear equation on four control points. :class:`Hold` writes the known part into a noised motion
or a prediction: it moves the control points by the least amount that satisfies the equations (the null-space method of
Wang et al. 2023, "Zero-Shot Image Restoration Using Denoising Diffusion Null-Space Model", eq. 11–13). Where all four
control points are known, this is InterGen's masked noise (section 5.4).

Shapes: B motions, T frames that fill a number of tokens, K knots, 70 numbers a person.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from models.motion_tokens import FEATURES, TokenLayout, feature_rows, foot_contacts, pack, unpack
from motion import SMPL22

FLOOR = (0, 2)
"""Columns of a row that hold the pelvis' place on the floor: x and z."""
JOINT_NUMBERS = 3 * SMPL22.num_joints
"""Of a row, those that say where joints are; the others are contacts of the feet."""
KNOWN_FEATURES = 2 * FEATURES + 3
"""Input features of the known part, per person and knot: values, mask, the heading's sine and cosine, and a 1 if
the heading is known."""
_SOFT = 3e-4
"""Weight of the size of the move against the equations, whose squared coefficients sum to about 0.5. A known number
is met within 0.1 % of the move, and a control point on which a known frame barely depends hardly moves."""

_RETURN = 0.02
"""Weight of a bend's size against its curvature; the bend dies out over (4 / 0.02)^¼ ≈ 4 knots, half a second."""
DIES_OUT = 30
"""Frames from a held heading to where a body faces as it was predicted, unless another frame says how it faces."""
_JOINTS = slice(3, JOINT_NUMBERS)
_LEFT, _RIGHT = SMPL22.index("left_hip"), SMPL22.index("right_hip")
_HIPS = [3 * hip + axis for hip in (_LEFT, _RIGHT) for axis in FLOOR]
_TRUNK = 3 * SMPL22.index("neck")
_CLOSE = 1e-4
"""Metres between the hips on the floor under which a body faces nowhere."""


@dataclass
class Known:
    """The known parts of B motions of both people.

    Attributes:
        rows: (B, 2, T, 70) numbers of frames in metres; anything where they are not known.
        mask: the same shape, true where a number is known.
        heading: (B, 2, T, 2) sine and cosine of the angle from +Z towards +X; anything where it is not known.
        heading_mask: (B, 2, T), true where it is.
    """

    rows: Tensor
    mask: Tensor
    heading: Tensor
    heading_mask: Tensor

    @classmethod
    def nothing(cls, frames: int, batch: int = 1) -> Known:
        """Nothing is known of motions of so many frames."""
        shape = (batch, 2, frames)
        return cls(
            torch.zeros(*shape, FEATURES),
            torch.zeros(*shape, FEATURES, dtype=torch.bool),
            torch.zeros(*shape, 2),
            torch.zeros(shape, dtype=torch.bool),
        )

    def features(self, layout: TokenLayout, mean: Tensor, std: Tensor) -> Tensor:
        """What a network sees of these parts: means over the frames nearest to each knot, masks and headings.

        Args:
            layout: frames a knot and knots a token.
            mean, std: (70,) of the network's normaliser.

        Returns:
            (B, tokens, 2·knots_per_token·:data:`KNOWN_FEATURES`).
        """
        frames, step = self.rows.shape[2], layout.frames_per_knot
        knots = layout.num_tokens(frames) * layout.knots_per_token
        nearest = (torch.arange(frames) + step // 2) // step + 1  # knot k of the spline lies at frame step·(k − 1)
        rows = torch.where(self.mask, (self.rows - mean) / std, 0.0)
        given = self.heading_mask[..., None]
        sums = torch.cat([rows, self.mask, torch.where(given, self.heading, 0.0), given], -1)
        bins = sums.new_zeros(*sums.shape[:2], knots, sums.shape[-1]).index_add(2, nearest, sums)
        values, counts, heading, times = bins.split([FEATURES, FEATURES, 2, 1], -1)
        seen = [values / counts.clamp_min(1), counts > 0, heading / times.clamp_min(1), times > 0]
        return pack(torch.cat([part.to(sums) for part in seen], -1), layout)

    def add_person(self, person: int, positions: Tensor, frames: Iterable[int] | None = None) -> None:
        """Marks a person's poses as known in all motions, at some frames or from the first frame on.

        Args:
            person: 0 for a, 1 for b.
            positions: (N, 22, 3) metres.
            frames: N of them, 0 … N − 1 by default.
        """
        at = torch.tensor(range(len(positions)) if frames is None else list(frames), dtype=torch.long)
        # A single pose does not show whether the feet are planted.
        moving = len(at) > 1 and bool((at.diff() == 1).all())
        contacts = foot_contacts(positions) if moving else positions.new_zeros(len(at), 4)
        self.rows[:, person, at] = feature_rows(positions, contacts)
        self.mask[:, person, at, : FEATURES if moving else FEATURES - 4] = True

    def add_joints(self, person: int, positions: Tensor, frames: Iterable[int], joints: Iterable[int]) -> None:
        """Marks some joints of a person's poses as known in all motions.

        Args:
            person: 0 for a, 1 for b.
            positions: (N, 22, 3) metres.
            frames: N of them.
            joints: which ones; all but the pelvis are known relative to it.
        """
        at = torch.tensor(list(frames), dtype=torch.long)
        for joint in joints:
            own = slice(3 * joint, 3 * joint + 3)
            self.rows[:, person, at, own] = positions[:, joint] - positions[:, 0] if joint else positions[:, 0]
            self.mask[:, person, at, own] = True

    def add_path(
        self,
        person: int,
        frames: Iterable[int],
        places: Tensor,
        headings: Tensor | None = None,
        *,
        turned: bool = False,
    ) -> None:
        """Marks a person's place at some frames, and the heading there, as known in all motions.

        Args:
            person: 0 for a, 1 for b.
            frames: N of them.
            places: (N, 2) x and z of the pelvis in metres.
            headings: (N,) radians from +Z towards +X.
            turned: the places of the hips beside the pelvis are known, too, so that the person faces the headings.
        """
        at = torch.tensor(list(frames), dtype=torch.long)
        columns = dict(zip(FLOOR, places.T, strict=True))
        if headings is not None:
            sine, cosine = headings.sin(), headings.cos()
            self.heading[:, person, at] = torch.stack([sine, cosine], -1)
            self.heading_mask[:, person, at] = True
            for hip in (_LEFT, _RIGHT) if turned else ():
                across, along = (float(SMPL22.offsets[hip, axis]) for axis in FLOOR)
                columns |= {3 * hip: across * cosine + along * sine, 3 * hip + 2: along * cosine - across * sine}
        for column, values in columns.items():
            self.rows[:, person, at, column] = values
            self.mask[:, person, at, column] = True


@dataclass
class Moves:
    """How columns (B·2·70) of K control points are moved: x becomes ``offset + move @ x``.

    A product for each mask would be as fast on a CPU, and hundreds of tiny kernels on a GPU.

    Attributes:
        at: (N,) which columns.
        group: (N,) which move is theirs.
        offset: (N, K).
        moves: (G, K, K), one for each mask; zeros where all frames are known, and nothing of x is left.
    """

    at: Tensor
    group: Tensor
    offset: Tensor
    moves: Tensor

    def __call__(self, columns: Tensor) -> Tensor:
        """Columns (copies, B·2·70, K) with what is known written in."""
        # In float32 also under autocast: what is known must be met.
        with torch.autocast(columns.device.type, enabled=False):
            kept = torch.einsum("nij,cnj->cni", self.moves[self.group], columns[:, self.at].float())
        return columns.index_copy(1, self.at, (self.offset + kept).to(columns))


@dataclass
class Held:
    """A :class:`Hold` as a training carries it: what is seen of the known part, and the moves that write it."""

    features: Tensor
    moves: Moves
    layout: TokenLayout

    def __call__(self, x: Tensor) -> Tensor:
        """x (B, tokens, 2·token_features) with the known part written in."""
        control = unpack(x, self.layout).transpose(2, 3)  # (B, 2, 70, K)
        columns = control.reshape(1, -1, control.shape[-1])
        return pack(self.moves(columns).view_as(control).transpose(2, 3), self.layout)


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


class Hold:
    """Writes the known part of motions into samples, in a network's space.

    Args:
        known: for one motion, or for each of a batch.
        layout: frames a knot and knots a token.
        mean, std: (70,) of the network's normaliser.

    Attributes:
        features: what a network sees of the known part, see :meth:`Known.features`.
        moves: of the columns of control points in which something is known.
        turned: the people whose bodies are turned to held headings.
    """

    def __init__(self, known: Known, layout: TokenLayout, mean: Tensor, std: Tensor) -> None:
        self.layout, self.mean, self.std, self.batch = layout, mean, std, len(known.rows)
        frames = known.rows.shape[2]
        self.tokens = layout.num_tokens(frames)
        self.features = known.features(layout, mean, std)
        self._basis = layout.basis(self.tokens)
        # Where in a sample the control points of each person's numbers are, and the way back.
        shape = (1, self.tokens, 2 * layout.token_features)
        places = unpack(torch.arange(math.prod(shape)).view(shape), layout).transpose(2, 3)
        self._places, self._back = places.flatten(0, 2), places.flatten().argsort()
        self._wanted = torch.where(known.mask, (known.rows - mean) / std, 0.0).transpose(2, 3).reshape(-1, frames)
        masks = known.mask.transpose(2, 3).reshape(-1, frames)
        self._masks = _alike(masks)
        self._whole: Tensor | None = None
        if any(mask.all() for _, mask in self._masks):
            control = torch.stack([layout.fit(self.tokens) @ person for person in known.rows.flatten(0, 1)])
            self._whole = ((control - mean) / std).transpose(1, 2).reshape(len(masks), -1)
        self.moves = self._solved(torch.eye(self._basis.shape[1], dtype=torch.double))
        people = enumerate(zip(known.rows.flatten(0, 1), known.mask.flatten(0, 1), strict=True))
        parts = (_turned(i, rows, mask) for i, (rows, mask) in people)
        self.turned = [turned for turned in parts if turned is not None]

    def _solved(self, cost: Tensor) -> Moves:
        """The moves of least cost that write what is known; columns that are known throughout are replaced."""
        unit, nothing = torch.eye(len(cost), dtype=torch.double), torch.zeros(len(cost), len(cost))
        solved = [(torch.zeros(0, dtype=torch.long), nothing[:0], nothing)]
        for at, mask in self._masks:
            if self._whole is not None and mask.all():
                solved.append((at, self._whole[at], nothing))
                continue
            seen, wanted = self._basis[mask].double(), self._wanted[at][:, mask].double()
            gain = torch.linalg.solve(seen.T @ seen + _SOFT * cost, seen.T)
            solved.append((at, (wanted @ gain.T).float(), (unit - gain @ seen).float()))
        columns, offsets, moves = zip(*solved, strict=True)
        group = torch.arange(len(columns)).repeat_interleave(torch.tensor([len(each) for each in columns]))
        return Moves(torch.cat(columns), group, torch.cat(offsets), torch.stack(moves))

    @property
    def held(self) -> Held:
        """The part of it that a training needs."""
        return Held(self.features, self.moves, self.layout)

    @cached_property
    def _bends(self) -> Moves:
        return self._solved(_stiffness(self._basis.shape[1]))

    @property
    def frozen(self) -> Tensor:
        """(B, tokens, 2·token_features) true where a number is fixed and must not change."""
        whole = torch.zeros(1, self.batch * 2 * FEATURES, self._places.shape[1], dtype=torch.bool)
        whole[:, self.moves.at] = ~self.moves.moves.any((1, 2))[self.moves.group, None]
        return self._sample(whole)

    @property
    def shares(self) -> Tensor:
        """(T,) what share of the places of joints is laid out at each frame, from 0 to 1; the mean of all motions.

        A number counts by how much less it varies with a network's control points, if these are white noise: whole
        where it is known, and nearly so between two known frames, as the spline leads from one to the other.
        """
        free = self._basis.double()
        varies = free.square().sum(1)
        explained = torch.zeros_like(varies)
        of_joints = self.moves.group[self.moves.at % FEATURES < JOINT_NUMBERS]
        for count, move in zip(of_joints.bincount(minlength=len(self.moves.moves)), self.moves.moves, strict=True):
            explained += count * (1 - (free @ move.double()).square().sum(1) / varies)
        return explained / (self.batch * 2 * JOINT_NUMBERS)

    def __call__(self, x: Tensor) -> Tensor:
        """x (B, tokens, 2·token_features) with the known part written in; any B if one motion is known."""
        return self._sample(self.moves(self._columns(x)))

    def bend(self, x: Tensor) -> Tensor:
        """As :meth:`__call__`, with a move that has little curvature and dies out over about half a second.

        A person held by the hips is turned there as a whole.

        Where a network's motion does not arrive at what is known, the least move of the control points leaves a
        jolt beside it. This one spreads the difference in place and speed (Witkin and Popović 1995, "Motion
        Warping"). It is for predictions of x0; what the network is given is held as in training.
        """
        return self._sample(self._bends(self._turn(self._columns(x))))

    def _columns(self, x: Tensor) -> Tensor:
        """The control points of each number of a sample: (…, B·2·70, K)."""
        return x.flatten(1)[:, self._places].view(-1, self.batch * 2 * FEATURES, self._places.shape[1])

    def _sample(self, columns: Tensor) -> Tensor:
        """Inverse of :meth:`_columns`."""
        return columns.reshape(-1, len(self._back))[:, self._back].unflatten(1, (self.tokens, -1))

    def _turn(self, columns: Tensor) -> Tensor:
        """Columns (copies, B·2·70, K) with the bodies turned to the headings at which their hips are held.

        A held heading is a place of both hips, and the least move would turn the pelvis alone: so the whole body is
        turned about its pelvis first, by an angle that changes linearly from one held frame to the next.
        """
        if not self.turned:
            return columns
        mean, std = self.mean[:, None], self.std[:, None]
        people = columns.unflatten(1, (-1, FEATURES)) * std + mean
        for turned in self.turned:
            body = people[:, turned.row]
            angles = self._angles(turned, body)[:, None]  # (copies, 1, K)
            ahead, up, along = body[:, _JOINTS].unflatten(1, (-1, 3)).unbind(2)
            sine, cosine = angles.sin(), angles.cos()
            there = torch.stack([ahead * cosine + along * sine, up, along * cosine - ahead * sine], 2)
            people[:, turned.row, _JOINTS] = there.flatten(1, 2)
        return ((people - mean) / std).view_as(columns)

    def _angles(self, turned: Turned, body: Tensor) -> Tensor:
        """(copies, K) radians by which control points (copies, 70, K) are turned."""
        hips = self._basis[torch.from_numpy(turned.frames)] @ body[:, _HIPS].mT
        apart = np.exp(1j * (turned.across - _across(hips.double().numpy())))
        first, last = turned.frames[0] - DIES_OUT, turned.frames[-1] + DIES_OUT
        frames = np.concatenate([[first], turned.frames, [last]])
        knots = self.layout.frames_per_knot * (np.arange(body.shape[2]) - 1)
        angles = [np.interp(knots, frames, np.pad(each, 1)) for each in np.unwrap(np.angle(apart))]
        return torch.from_numpy(np.stack(angles)).to(body)


def _stiffness(knots: int) -> Tensor:
    """(K, K) the cost of a move: its squared curvature, and a little of its squared size."""
    curvature = torch.eye(knots, dtype=torch.double).diff(n=2, dim=0)
    return curvature.T @ curvature + _RETURN * torch.eye(knots, dtype=torch.double)


def _alike(masks: Tensor) -> list[tuple[Tensor, Tensor]]:
    """Rows of masks (N, T) that are alike and not empty: (their indices, the mask)."""
    alike: dict[bytes, list[int]] = {}
    for i, packed in enumerate(np.packbits(masks.numpy(), axis=1)):
        alike.setdefault(packed.tobytes(), []).append(i)
    return [(torch.tensor(at), masks[at[0]]) for at in alike.values() if masks[at[0]].any()]


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
