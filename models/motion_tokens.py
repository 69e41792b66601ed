"""Tokens of the compact generator: cubic B-spline control points in time.

InterGen diffuses one 262-number row a frame. Human motion holds next to nothing above 4 Hz, so the compact
generator diffuses the control points of a uniform cubic B-spline with a knot every ``frames_per_knot``
frames instead (4 at 30 fps: 3.75 Hz) and packs ``knots_per_token`` of them into a token. Eight times fewer
tokens, no jitter by construction, and the decoder is one matrix product, so every InterGen loss is still
computed on positions at 30 fps.

A person's control point has 70 numbers: world position of the pelvis (3) | the other 21 joints relative to
the pelvis (63) | contact of left ankle, left toe, right ankle, right toe with the floor (4). This is a linear
map of InterGen's global positions, chosen so that noise of one size does not drown the pose in the path.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import torch
from torch import Tensor, nn

from motion.skeleton import FEET, SMPL22

NUM_JOINTS = 22
NUM_CONTACTS = 4
FEATURES = 3 + 3 * (NUM_JOINTS - 1) + NUM_CONTACTS
CONTACT_HEIGHTS = (0.12, 0.08, 0.12, 0.08)
"""Metres under which left ankle, left toe, right ankle and right toe can stand."""
CONTACT_SPEED = 0.35
"""Metres a second under which they do."""
_HIPS = (SMPL22.index("left_hip"), SMPL22.index("right_hip"))
_SPLINE_SPAN = 3  # a cubic spline over n intervals has n + 3 control points


@dataclass(frozen=True)
class TokenLayout:
    """The mapping from frames to tokens."""

    frames_per_knot: int = 4
    knots_per_token: int = 2

    @property
    def token_features(self) -> int:
        """Numbers in one person's token."""
        return FEATURES * self.knots_per_token

    def num_tokens(self, frames: int) -> int:
        """Tokens that cover ``frames`` frames."""
        knots = -(-(max(frames, 2) - 1) // self.frames_per_knot) + _SPLINE_SPAN
        return -(-knots // self.knots_per_token)

    def num_frames(self, tokens: int) -> int:
        """The most frames that ``tokens`` tokens can decode to."""
        return (tokens * self.knots_per_token - _SPLINE_SPAN) * self.frames_per_knot + 1

    def filled_tokens(self, frames: int) -> int:
        """Tokens that ``frames`` frames fill, where what is over at the end is left out."""
        tokens = self.num_tokens(frames)
        return tokens - (self.num_frames(tokens) > frames)

    def basis(self, tokens: int) -> Tensor:
        """(frames, knots) float32 spline basis: frames = basis @ control points."""
        return _basis(self.num_frames(tokens), self.frames_per_knot)

    def fit(self, tokens: int) -> Tensor:
        """(knots, frames) float32 least-squares inverse of :meth:`basis`."""
        return _fit(self.num_frames(tokens), self.frames_per_knot)


@lru_cache(maxsize=64)
def _basis(frames: int, frames_per_knot: int) -> Tensor:
    """The four cubics of a uniform B-spline by hand: ``scipy.interpolate`` gives the same and takes 37 MB."""
    intervals = (frames - 1) // frames_per_knot
    time = np.arange(frames) / frames_per_knot
    first = np.minimum(time.astype(int), intervals - 1)  # the knot from which a frame's four are counted
    u = time - first
    weights = np.stack([(1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4, 3 * (u + u**2 - u**3) + 1, u**3], axis=1) / 6
    basis = np.zeros((frames, intervals + _SPLINE_SPAN))
    np.put_along_axis(basis, first[:, None] + np.arange(_SPLINE_SPAN + 1), weights, axis=1)
    return torch.from_numpy(basis).float()


@lru_cache(maxsize=64)
def _fit(frames: int, frames_per_knot: int) -> Tensor:
    basis = _basis(frames, frames_per_knot).double().numpy()
    # The outermost control points are hardly seen by the data; a whisper of smoothness holds them.
    curvature = np.diff(np.eye(basis.shape[1]), n=2, axis=0)
    normal = basis.T @ basis + 1e-3 * curvature.T @ curvature
    return torch.from_numpy(np.linalg.solve(normal, basis.T)).float()


@lru_cache(maxsize=1)
def _absolute() -> Tensor:
    """(70, 70) float32: control points @ this = the same with the pelvis added to the other joints."""
    matrix = torch.eye(FEATURES)
    matrix[:3, 3 : 3 * NUM_JOINTS] = torch.eye(3).repeat(1, NUM_JOINTS - 1)
    return matrix


def foot_contacts(positions: Tensor, fps: float = 30.0) -> Tensor:
    """(…, T, 4) 1 where an ankle or toe is low and slow: the contact of a control point.

    Args:
        positions: (…, T, 22, 3) metres.
    """
    feet = positions[..., list(FEET), :]
    velocity = torch.linalg.vector_norm(feet.diff(dim=-3), dim=-1) * fps
    speed = torch.cat([velocity[..., :1, :], velocity], dim=-2)
    low = feet[..., 1] < positions.new_tensor(CONTACT_HEIGHTS)
    return (low & (speed < CONTACT_SPEED)).to(positions.dtype)


def feature_rows(positions: Tensor, contacts: Tensor) -> Tensor:
    """The 70 numbers of every frame: positions (…, T, 22, 3) in metres, contacts (…, T, 4) → (…, T, 70)."""
    return torch.cat([pose_rows(positions), contacts], dim=-1)


def pose_rows(positions: Tensor) -> Tensor:
    """(…, 22, 3) → (…, 66): the pelvis, and the other joints relative to it."""
    root = positions[..., :1, :]
    return torch.cat([root, positions[..., 1:, :] - root], dim=-2).flatten(-2)


def encode(positions: Tensor, contacts: Tensor, layout: TokenLayout) -> Tensor:
    """Control points of one or more people.

    Args:
        positions: (…, T, 22, 3) metres, T a length that :meth:`TokenLayout.num_frames` gives.
        contacts: (…, T, 4) 0 or 1.

    Returns:
        (…, knots, 70) control points, not normalised.
    """
    rows = feature_rows(positions, contacts)
    tokens = layout.num_tokens(positions.shape[-3])
    if layout.num_frames(tokens) != positions.shape[-3]:
        raise ValueError(f"{positions.shape[-3]} frames do not fill {tokens} tokens; pad to num_frames first.")
    return layout.fit(tokens).to(rows) @ rows


def decode(control: Tensor, layout: TokenLayout) -> tuple[Tensor, Tensor]:
    """Positions (…, T, 22, 3) in metres and contact scores (…, T, 4) from control points (…, knots, 70)."""
    tokens = control.shape[-2] // layout.knots_per_token
    # The pelvis is added to the joints before there are frames, of which there are four times as many.
    rows = layout.basis(tokens).to(control) @ (control @ _absolute().to(control))
    positions, contacts = rows.split([3 * NUM_JOINTS, NUM_CONTACTS], dim=-1)
    return positions.unflatten(-1, (NUM_JOINTS, 3)), contacts


def pack(control: Tensor, layout: TokenLayout) -> Tensor:
    """Two people's control points (B, 2, knots, 70) as network input (B, tokens, 2 · token_features)."""
    batch, _, knots, _ = control.shape
    tokens = knots // layout.knots_per_token
    return control.reshape(batch, 2, tokens, -1).transpose(1, 2).reshape(batch, tokens, -1)


def unpack(x: Tensor, layout: TokenLayout) -> Tensor:
    """Inverse of :func:`pack`."""
    batch, tokens, _ = x.shape
    people = x.reshape(batch, tokens, 2, layout.knots_per_token, FEATURES)
    return people.transpose(1, 2).reshape(batch, 2, tokens * layout.knots_per_token, FEATURES)


class DuetSpace(nn.Module):
    """The space in which two people's tokens are diffused, and the way back to metres.

    ``mean`` and ``std`` (70,) are those of one person's control point.
    """

    mean: Tensor
    std: Tensor
    reads_known = False
    """Whether the denoiser takes ``known``, the features of what is known and of a draft (:meth:`Known.features
    <models.known.Known.features>`)."""

    def __init__(self, layout: TokenLayout) -> None:
        super().__init__()
        self.layout = layout
        self.register_buffer("mean", torch.zeros(FEATURES))
        self.register_buffer("std", torch.ones(FEATURES))

    @property
    def scale(self) -> Tensor:
        """(2·token_features,) metres to a unit of network space."""
        return self.std.repeat(2 * self.layout.knots_per_token)

    def control(self, x: Tensor) -> Tensor:
        """Network space (B, tokens, 2·token_features) → control points (B, 2, knots, 70) in metres."""
        return unpack(x, self.layout) * self.std + self.mean

    def positions(self, x: Tensor) -> tuple[Tensor, Tensor]:
        """Network space → positions (B, 2, T, 22, 3) in metres and contact scores (B, 2, T, 4)."""
        return decode(self.control(x), self.layout)


def canonical_control(control: Tensor) -> Tensor:
    """Two people's control points (2, K, 70) in metres, moved and turned as a whole: at the first frame person a
    stands at the origin and faces +Z."""
    first = (control[0, 0] + 4 * control[0, 1] + control[0, 2]) / 6  # the spline at frame 0
    sine, cosine = headings(first)
    turn = torch.stack([cosine, 0 * sine, sine, 0 * sine, 1 + 0 * sine, 0 * sine, -sine, 0 * sine, cosine]).view(3, 3)
    root, relative, contacts = control.split([3, 3 * (NUM_JOINTS - 1), NUM_CONTACTS], dim=-1)
    root = (root - first[:3] * first.new_tensor([1.0, 0.0, 1.0])) @ turn
    relative = relative.unflatten(-1, (NUM_JOINTS - 1, 3)) @ turn
    return torch.cat([root, relative.flatten(-2), contacts], dim=-1)


def headings(rows: Tensor) -> Tensor:
    """(…, 2) sine and cosine of the angle from +Z towards +X that people face, from rows (…, 70)."""
    relative = rows[..., 3 : FEATURES - NUM_CONTACTS].unflatten(-1, (NUM_JOINTS - 1, 3))
    across = relative[..., _HIPS[0] - 1, :] - relative[..., _HIPS[1] - 1, :]
    return torch.nn.functional.normalize(torch.stack([-across[..., 2], across[..., 0]], -1), dim=-1)


def mirror_control(control: Tensor, joint_mirror: tuple[int, ...]) -> Tensor:
    """Control points (…, 70) of the motion seen in a mirror: X negated, left and right exchanged."""
    root, relative, contacts = control.split([3, 3 * (NUM_JOINTS - 1), NUM_CONTACTS], dim=-1)
    flip = control.new_tensor([-1.0, 1.0, 1.0])
    order = [joint - 1 for joint in joint_mirror[1:]]
    relative = relative.unflatten(-1, (NUM_JOINTS - 1, 3))[..., order, :] * flip
    return torch.cat([root * flip, relative.flatten(-2), contacts[..., [2, 3, 0, 1]]], dim=-1)
