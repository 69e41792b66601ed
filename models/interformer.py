"""InterFormer: the reaction of one person to another, frame by frame, by temporal and spatial attention.

Chopin's thesis, section 3.3, figure 3.6; Chopin et al., "Interaction Transformer for Human Reaction
Generation" (IEEE TMM 2023). Encoder and decoder of a Transformer whose layers attend over time (whole frames)
and over space (the joints of one frame) side by side.

Shapes: B batch, S source frames, T target frames, J = 15 joints. A frame is 45 numbers, coordinate-major
(15 x, 15 y, 15 z). A sequence is a frame of zeros, the motion, a frame of ones, and padding of ones.

What the released weights depend on, and the text leaves open:

- :class:`Norm` divides by the unbiased standard deviation plus 1e-6.
- Scores are made absolute before every softmax; the spatial softmax runs over a frame's whole J × J table.
- Spatial self-attention reads what the temporal one reads: the frame after ``norm_1``.
- The encoder's feed-forward reads the two branches' norms, summed, and is added to the branches' own sum.
- The decoder's branches are normalised after each attention (temporal by ``norm_2`` and ``norm_3``, spatial
  by ``norm_space_1`` and ``norm_space_2``) and go on from there; their sum goes through the feed-forward as
  it is.
- The distance table is added to the spatial cross-attention after the softmax, times 2.
- The first target frame, zeros, sees the second, the given pose.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from models.errors import as_tensors, count_layers, load_strictly, shape_of
from webdemo.motion.skeleton import SBU15

NETWORK = "InterFormer"
JOINTS, AXES = 15, 3
WIDTH = JOINTS * AXES
DISTANCE_WEIGHT = 2.0
_HIDDEN = -1e9


@dataclass(frozen=True)
class InterFormerConfig:
    """The sizes of an `InterFormer`; the defaults are the released ones.

    max_length: frames of the position table, start and end frames among them.
    """

    num_layers: int = 6
    num_heads: int = 3
    ff_size: int = 2048
    max_length: int = 200


def skeleton_mask() -> Tensor:
    """(J, J) bool: each joint with itself and the joints it hangs on (eq. 3.6: I + In + Out)."""
    mask = torch.eye(JOINTS, dtype=torch.bool)
    for parent, child in SBU15.bones:
        mask[parent, child] = mask[child, parent] = True
    return mask


def joint_distances(source: Tensor, target: Tensor) -> Tensor:
    """The interaction distance module's table (eq. 3.7): softmax of −‖target joint i − source joint j‖.

    Args:
        source, target: (B, T, 45) frames of the same times.

    Returns:
        (B, T, J, J); each table sums to 1.
    """
    one, other = (frames.unflatten(-1, (AXES, JOINTS)).transpose(-1, -2) for frames in (source, target))
    table = -(other[..., :, None, :] - one[..., None, :, :]).norm(dim=-1)
    return table.flatten(-2).softmax(-1).view_as(table)


def target_mask(frames: int, *, device: torch.device | str = "cpu") -> Tensor:
    """(1, T, T) bool: no frame sees a later one, but the first sees the given pose after it."""
    mask = torch.ones(frames, frames, dtype=torch.bool, device=device).tril()
    mask[0, :2] = True
    return mask[None]


class Norm(nn.Module):
    """(x − mean) / (unbiased std + 1e-6) · alpha + bias over the last axis."""

    def __init__(self) -> None:
        super().__init__()
        self.alpha = nn.Parameter(torch.ones(WIDTH))
        self.bias = nn.Parameter(torch.zeros(WIDTH))

    def forward(self, x: Tensor) -> Tensor:
        centred = x - x.mean(-1, keepdim=True)
        return self.alpha * centred / (x.std(-1, keepdim=True) + 1e-6) + self.bias


class Positions(nn.Module):
    """x · √45 plus a table: sin(pos / 10000^(2i / 45)) at even i, cos(pos / 10000^(2(i + 1) / 45)) next."""

    def __init__(self, max_length: int) -> None:
        super().__init__()
        i = torch.arange(0, WIDTH, 2)
        exponents = torch.stack([2 * i, 2 * (i + 1)], dim=-1).flatten()[:WIDTH] / WIDTH
        angles = torch.arange(max_length)[:, None] / 10000.0**exponents
        even = torch.arange(WIDTH) % 2 == 0
        self.register_buffer("pe", torch.where(even, angles.sin(), angles.cos())[None])

    def forward(self, x: Tensor) -> Tensor:
        return x * math.sqrt(WIDTH) + self.pe[:, : x.shape[1]]


class TemporalAttention(nn.Module):
    """Multi-head attention over frames (eq. 3.4, 3.5)."""

    def __init__(self, num_heads: int) -> None:
        super().__init__()
        self.num_heads = num_heads
        self.q_linear, self.v_linear, self.k_linear, self.out = (nn.Linear(WIDTH, WIDTH) for _ in range(4))

    def forward(self, query: Tensor, memory: Tensor, mask: Tensor) -> Tensor:
        """query (B, T, 45), memory (B, S, 45), mask (B or 1, T or 1, S) bool → (B, T, 45)."""
        q, k, v = (
            linear(x).unflatten(-1, (self.num_heads, -1)).transpose(1, 2)
            for linear, x in ((self.q_linear, query), (self.k_linear, memory), (self.v_linear, memory))
        )
        scores = (q @ k.mT / math.sqrt(q.shape[-1])).abs().masked_fill(~mask[:, None], _HIDDEN)
        return self.out((scores.softmax(-1) @ v).transpose(1, 2).flatten(2))


class SpatialAttention(nn.Module):
    """Attention over the joints of a frame, one head an axis (section 3.3.1)."""

    def __init__(self) -> None:
        super().__init__()
        self.q_linear_sp, self.v_linear_sp, self.k_linear_sp = (nn.Linear(AXES, AXES) for _ in range(3))
        self.out = nn.Linear(WIDTH, WIDTH)

    def forward(
        self, query: Tensor, memory: Tensor, *, graph: Tensor | None = None, distances: Tensor | None = None
    ) -> Tensor:
        """query, memory (B, T, 45), graph (J, J) bool, distances (B, T, J, J) → (B, T, 45)."""
        q, k, v = (
            linear(x.unflatten(-1, (AXES, JOINTS)).mT).mT
            for linear, x in (
                (self.q_linear_sp, query), (self.k_linear_sp, memory), (self.v_linear_sp, memory)
            )
        )  # fmt: skip
        scores = (q[..., :, None] * k[..., None, :]).abs()  # heads are of width 1: (B, T, 3, J, J)
        if graph is not None:
            scores = scores.masked_fill(~graph, _HIDDEN)
        weights = scores.flatten(-2).softmax(-1).view_as(scores)
        if distances is not None:
            weights = weights + DISTANCE_WEIGHT * distances[:, :, None]
        seen = (weights @ v[..., None])[..., 0]
        return self.out(seen.mT.flatten(-2))


class PositionwiseFeedForward(nn.Module):
    """Linear, ReLU, Linear."""

    def __init__(self, ff_size: int) -> None:
        super().__init__()
        self.linear_1, self.linear_2 = nn.Linear(WIDTH, ff_size), nn.Linear(ff_size, WIDTH)

    def forward(self, x: Tensor) -> Tensor:
        return self.linear_2(F.relu(self.linear_1(x)))


class EncoderLayer(nn.Module):
    """Section 3.3.1."""

    def __init__(self, config: InterFormerConfig) -> None:
        super().__init__()
        self.norm_1, self.norm_space_1, self.norm_2 = Norm(), Norm(), Norm()
        self.attn, self.attn_space = TemporalAttention(config.num_heads), SpatialAttention()
        self.ff = PositionwiseFeedForward(config.ff_size)

    def forward(self, x: Tensor, mask: Tensor, graph: Tensor) -> Tensor:
        y = self.norm_1(x)
        time = x + self.attn(y, y, mask)
        space = x + self.attn_space(y, y, graph=graph)
        return time + space + self.ff(self.norm_2(time) + self.norm_space_1(space))


class DecoderLayer(nn.Module):
    """Section 3.3.2."""

    def __init__(self, config: InterFormerConfig) -> None:
        super().__init__()
        self.norm_1, self.norm_2, self.norm_3 = Norm(), Norm(), Norm()
        self.norm_space_1, self.norm_space_2 = Norm(), Norm()
        self.attn_1, self.attn_2 = (TemporalAttention(config.num_heads) for _ in range(2))
        self.attn_space_1, self.attn_space_2 = SpatialAttention(), SpatialAttention()
        self.ff = PositionwiseFeedForward(config.ff_size)

    def forward(
        self, x: Tensor, memory: Tensor, distances: Tensor, source_mask: Tensor, mask: Tensor, graph: Tensor
    ) -> Tensor:
        y = self.norm_1(x)
        time = self.norm_2(x + self.attn_1(y, y, mask))
        space = self.norm_space_1(x + self.attn_space_1(y, y, graph=graph))
        time = self.norm_3(time + self.attn_2(time, memory, source_mask))
        at_once = memory[:, : x.shape[1]]
        space = self.norm_space_2(space + self.attn_space_2(space, at_once, distances=distances))
        both = time + space
        return both + self.ff(both)


class Stack(nn.Module):
    """Positions, layers, a last norm."""

    def __init__(self, layer: type[EncoderLayer] | type[DecoderLayer], config: InterFormerConfig) -> None:
        super().__init__()
        self.pe = Positions(config.max_length)
        self.layers = nn.ModuleList(layer(config) for _ in range(config.num_layers))
        self.norm = Norm()

    def forward(self, x: Tensor, *others: Tensor) -> Tensor:
        x = self.pe(x)
        for layer in self.layers:
            x = layer(x, *others)
        return self.norm(x)


class InterFormer(nn.Module):
    """The network of section 3.3."""

    def __init__(self, config: InterFormerConfig | None = None) -> None:
        super().__init__()
        self.config = config = config or InterFormerConfig()
        self.encoder, self.decoder = Stack(EncoderLayer, config), Stack(DecoderLayer, config)
        self.out = nn.Linear(WIDTH, WIDTH)
        self.register_buffer("graph", skeleton_mask(), persistent=False)

    def forward(
        self,
        source: Tensor,
        target_input: Tensor,
        distances: Tensor,
        source_mask: Tensor,
        target_mask: Tensor,
    ) -> Tensor:
        """The next frame at every target frame.

        Args:
            source: (B, S, 45) the actor.
            target_input: (B, T, 45) the reactor so far, T ≤ S.
            distances: (B, T, J, J) of :func:`joint_distances`.
            source_mask: (B, 1, S) bool, false at padding.
            target_mask: (B or 1, T, T) bool, see :func:`target_mask`.

        Returns:
            (B, T, 45)
        """
        memory = self.encoder(source, source_mask, self.graph)
        return self.decode(memory, target_input, distances, source_mask, target_mask)

    def decode(
        self, memory: Tensor, target_input: Tensor, distances: Tensor, source_mask: Tensor, mask: Tensor
    ) -> Tensor:
        """:meth:`forward` from the encoder's output (B, S, 45) on."""
        return self.out(self.decoder(target_input, memory, distances, source_mask, mask, self.graph))

    @torch.no_grad()
    def generate(self, source: Tensor, source_mask: Tensor, first_frame: Tensor, frames: int) -> Tensor:
        """The reaction, a frame at a time from the given first one (B, 45).

        Returns:
            (B, frames, 45): zeros, the first frame, then what the network makes.
        """
        memory = self.encoder(source, source_mask, self.graph)
        made = torch.stack([torch.zeros_like(first_frame), first_frame], dim=1)
        while (length := made.shape[1]) < frames:
            table = joint_distances(source[:, :length], made)
            mask = target_mask(length, device=source.device)
            made = torch.cat([made, self.decode(memory, made, table, source_mask, mask)[:, -1:]], dim=1)
        return made


def from_released(weights: Mapping[str, Tensor], *, num_heads: int = 3) -> InterFormer:
    """The network whose released tensors these are: sizes are read off them; eval mode, float32.

    Raises WeightsError where a tensor is missing, unknown or of another size.
    """
    tensors = as_tensors(weights)
    network = InterFormer(
        InterFormerConfig(
            num_layers=count_layers(tensors, "encoder.layers."),
            num_heads=num_heads,
            ff_size=shape_of(tensors, "encoder.layers.0.ff.linear_1.weight", network=NETWORK)[0],
            max_length=shape_of(tensors, "encoder.pe.pe", network=NETWORK)[1],
        )
    )
    load_strictly(network, tensors, network=NETWORK)
    return network
