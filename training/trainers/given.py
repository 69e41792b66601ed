"""Draws what is given of a training motion: a person, the past, a span, poses, joints, paths, places; and drafts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import accumulate

import torch
from torch import Tensor

from models.known import FLOOR, Known
from models.motion_tokens import FEATURES, NUM_CONTACTS, NUM_JOINTS, TokenLayout, headings

POSE = FEATURES - NUM_CONTACTS


@dataclass(frozen=True)
class Shares:
    """Probabilities of each kind of given part; otherwise nothing is given.

    Attributes:
        person: all that one person does (InterGen, section 5.4).
        past: up to six tenths of the motion of both, from its beginning.
        span: all but a span, of both or of one.
        poses: one to three single frames, of both or of one.
        path: where one or both are on the floor, at all times or at a few; in half of them the heading, too.
        joints: the pelvis and one to four joints of a person for a while.
        places: where people are and how they face, of both or of one.
        more: of the samples in which something is given, how many have a second kind given.
        drafted: with a draft, whatever else is given.
    """

    person: float = 0.08
    past: float = 0.12
    span: float = 0.03
    poses: float = 0.03
    path: float = 0.08
    joints: float = 0.01
    places: float = 0.35
    more: float = 0.35
    drafted: float = 0.6


class Draw:
    """Draws parts with a generator of its own, so that a step's parts are the same in every run."""

    def __init__(self, generator: torch.Generator) -> None:
        self.generator = generator

    def uniform(self, low: float = 0.0, high: float = 1.0) -> float:
        """A number between ``low`` and ``high``."""
        return low + (high - low) * float(torch.rand((), generator=self.generator))

    def integer(self, low: int, high: int) -> int:
        """From low to high, both included."""
        return int(torch.randint(low, high + 1, (), generator=self.generator))

    def people(self) -> list[int]:
        """a, b or both."""
        return [[0], [1], [0, 1]][self.integer(0, 2)]

    def frames(self, count: int, total: int) -> Tensor:
        """So many different frames of ``total``."""
        return torch.randperm(total, generator=self.generator)[:count]


def known_parts(
    control: Tensor, frames: list[int], past: list[int], layout: TokenLayout, shares: Shares, generator: torch.Generator
) -> Known | None:
    """Draws the parts of each motion of a batch that are given.

    Args:
        control: (B, 2, K, 70) true control points in metres.
        frames: real frames of each motion.
        past: so many frames at the beginning of each motion are given in any case.

    Returns:
        the known part, None if nothing is given in the whole batch.
    """
    draw = Draw(generator)
    basis = layout.basis(control.shape[2] // layout.knots_per_token)
    known = Known.nothing(len(basis), len(control))
    edges = dict(zip(_KINDS, accumulate(getattr(shares, name) for name in _KINDS), strict=True))
    for i, (count, before) in enumerate(zip(frames, past, strict=True)):
        known.mask[i, :, :before] = True
        place = draw.uniform()
        first = next((name for name, edge in edges.items() if place < edge), None)
        if first is None:
            continue
        chosen = {first}
        if draw.uniform() < shares.more:
            chosen.add(("past", "poses", "path")[draw.integer(0, 2)])
        for name in sorted(chosen):
            _KINDS[name](known.mask[i], known.heading_mask[i], count, draw)
    if not known.mask.any() and not known.heading_mask.any():
        return None
    known.rows = basis @ control
    known.heading = headings(known.rows)
    return known


def _person(mask: Tensor, heading: Tensor, frames: int, draw: Draw) -> None:
    mask[draw.integer(0, 1), :frames] = True


def _past(mask: Tensor, heading: Tensor, frames: int, draw: Draw) -> None:
    mask[:, : max(1, round(draw.uniform(0, 0.6) * frames))] = True


def _span(mask: Tensor, heading: Tensor, frames: int, draw: Draw) -> None:
    length = round(draw.uniform(0.15, 0.7) * frames)
    start = draw.integer(0, frames - length)
    for person in draw.people():
        mask[person, :start] = mask[person, start + length : frames] = True


def _poses(mask: Tensor, heading: Tensor, frames: int, draw: Draw) -> None:
    for person in draw.people():
        first = 3 if draw.uniform() < 0.25 else 0  # a pose that may stand anywhere
        mask[person, draw.frames(draw.integer(1, 3), frames), first:POSE] = True


def _path(mask: Tensor, heading: Tensor, frames: int, draw: Draw) -> None:
    turned = draw.uniform() < 0.5
    for person in draw.people():
        times = torch.arange(frames)
        if draw.uniform() < 0.5:
            times = draw.frames(draw.integer(1, 6), frames)
            times[0] = frames - 1  # most who draw a path say where it ends
        for column in FLOOR:
            mask[person, times, column] = True
        if turned:
            heading[person, times] = True


def _joints(mask: Tensor, heading: Tensor, frames: int, draw: Draw) -> None:
    person, start = draw.integer(0, 1), draw.integer(0, frames - 1)
    stop = min(frames, start + draw.integer(1, frames))
    joints = draw.frames(draw.integer(1, 4), NUM_JOINTS - 1) + 1
    _kept(mask[person], torch.arange(start, stop), [0, *joints.tolist()])


_HIPS = (1, 2)
"""Joints of SMPL, as are those below."""
_LEGS = (0, 1, 2, 3, 4, 5, 7, 8, 10, 11)
_REACHING = (3, 6, 9, 12, 15, 13, 14, 16, 17)
_ARMS = ((18, 20), (19, 21), (18, 20, 19, 21))
"""Elbow and wrist of the left arm, of the right one, of both."""


def _places(mask: Tensor, heading: Tensor, frames: int, draw: Draw) -> None:
    for person in draw.people() if draw.uniform() < 0.4 else [0, 1]:
        _way(mask[person], heading[person], frames, draw)


def _way(mask: Tensor, heading: Tensor, frames: int, draw: Draw) -> None:
    """A person's places at times 4 to 30 frames apart, and in most of them where they turn."""
    times = torch.arange(0, frames, draw.integer(4, 30))
    if draw.uniform() < 0.4:
        times = times[draw.integer(0, len(times) - 1) :]
    for column in FLOOR:
        mask[times, column] = True
    turned = times[: draw.integer(1, len(times))] if draw.uniform() < 0.4 else times
    heading[turned] = True
    for hip in _HIPS:
        for axis in FLOOR:
            mask[turned, 3 * hip + axis] = True


def _kept(mask: Tensor, times: Tensor, joints: Iterable[int]) -> None:
    for joint in joints:
        mask[times, 3 * joint : 3 * joint + 3] = True


_DRAFTED = ((0.45, tuple(range(1, NUM_JOINTS))), (0.15, (*range(1, 16), 16, 17, 18, 19, 20, 21)), (0.1, _LEGS[1:]))
"""Joints of a draft with their shares; in the others one arm or both are drafted, with the trunk in two thirds."""


def drafted(control: Tensor, frames: list[int], layout: TokenLayout, share: float, generator: torch.Generator) -> Known:
    """Draws a draft of each motion of a batch: rough poses of some joints for a while, like those that a plan makes.

    Args:
        control: (B, 2, K, 70) true control points in metres.
        frames: real frames of each motion.
        share: of the motions that have a draft.

    Returns:
        the draft as a known part; where there is none, nothing is known.
    """
    draw = Draw(generator)
    basis = layout.basis(control.shape[2] // layout.knots_per_token)
    known = Known.nothing(len(basis), len(control))
    for i, count in enumerate(frames):
        if draw.uniform() >= share:
            continue
        rows = basis @ control[i]
        for person in range(2):
            for _ in range(draw.integer(0, 2)):
                start = draw.integer(0, max(count - 12, 0)) if draw.uniform() < 0.6 else 0
                stop = min(count, start + draw.integer(12, 120)) if draw.uniform() < 0.7 else count
                at = torch.arange(start, stop)
                mask = known.mask[i, person]
                mask[at] = False
                _kept(mask, at, _drafted_joints(draw))
                if draw.uniform() < 0.5:
                    mask[at, 1] = True  # how high the pelvis is
                known.rows[i, person, start:stop] = _roughened(rows[person, :count], start, stop, draw)
    return known


def _drafted_joints(draw: Draw) -> tuple[int, ...]:
    place = draw.uniform()
    for share, joints in _DRAFTED:
        if place < share:
            return joints
        place -= share
    arm = _ARMS[draw.integer(0, 2)]
    return (*_REACHING, *arm) if draw.uniform() < 0.67 else arm


def _roughened(rows: Tensor, start: int, stop: int, draw: Draw) -> Tensor:
    """Rows (T, 70) from ``start`` to ``stop`` as a hand would pose them, eased from key to key.

    The keys are early or late, exaggerated, beside the joints and turned a little.
    """
    frames, generator = stop - start, draw.generator
    spacing = draw.integer(3, 20)
    shift = round(2 * float(torch.randn((), generator=generator)))
    time = torch.arange(frames)
    before = time.div(spacing, rounding_mode="floor") * spacing
    along = (time - before).float() / spacing
    eased = (along * along * (3 - 2 * along))[:, None]
    keys = [(start + shift + key).clamp(0, len(rows) - 1) for key in (before, before + spacing)]
    rough = rows[keys[0]] * (1 - eased) + rows[keys[1]] * eased
    mean = rough.mean(0)
    rough = mean + draw.uniform(0.85, 1.2) * (rough - mean)
    size = draw.uniform(0.0, 0.03)
    rough = rough + size * torch.randn(FEATURES, generator=generator)
    joints = rough[:, 3:POSE].unflatten(-1, (-1, 3))
    angle = 0.07 * torch.randn((), generator=generator)
    sine, cosine = angle.sin(), angle.cos()
    x, y, z = joints.unbind(-1)
    rough[:, 3:POSE] = torch.stack([x * cosine + z * sine, y, z * cosine - x * sine], -1).flatten(-2)
    return rough


_KINDS = {
    "person": _person,
    "past": _past,
    "span": _span,
    "poses": _poses,
    "path": _path,
    "joints": _joints,
    "places": _places,
}
