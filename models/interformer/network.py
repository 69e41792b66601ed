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
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

import torch
from torch import Tensor, nn

from models.layers import neighbours
from models.released import Released
from motion.skeleton import SBU15

NETWORK = "InterFormer"
JOINTS, AXES = 15, 3
WIDTH = JOINTS * AXES
DISTANCE_WEIGHT = 2.0
_HIDDEN = -1e9
KeysValues = tuple[Tensor, Tensor]


@dataclass(frozen=True)
class InterFormerConfig:
    """The sizes of an `InterFormer`; the defaults are the released ones.

    max_length: frames of the position table, start and end frames among them.
    """

    num_layers: int = 6
    num_heads: int = 3
    ff_size: int = 2048
    max_length: int = 200


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


class Norm(nn.Module):
    """(x − mean) / (unbiased std + 1e-6) · alpha + bias over the last axis."""

    def __init__(self) -> None:
        super().__init__()
        self.alpha = nn.Parameter(torch.ones(WIDTH))
        self.bias = nn.Parameter(torch.zeros(WIDTH))

    def forward(self, x: Tensor) -> Tensor:
        """x (…, d) → the same shape; (x − mean) / (std + 1e-6) · alpha + bias, with the unbiased std."""
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
        self.pe: Tensor
        self.register_buffer("pe", torch.where(even, angles.sin(), angles.cos())[None])

    def forward(self, x: Tensor, first: int = 0) -> Tensor:
        """x (B, T, 45) times √45, plus the table from position ``first`` on."""
        return x * math.sqrt(WIDTH) + self.pe[:, first : first + x.shape[1]]


class TemporalAttention(nn.Module):
    """Multi-head attention over frames (eq. 3.4, 3.5)."""

    def __init__(self, num_heads: int) -> None:
        super().__init__()
        self.num_heads = num_heads
        self.q_linear, self.v_linear, self.k_linear, self.out = (nn.Linear(WIDTH, WIDTH) for _ in range(4))

    def remember(self, memory: Tensor) -> KeysValues:
        """Keys and values of frames (B, S, 45), each (B, heads, S, 45 / heads)."""
        return self._split(self.k_linear(memory)), self._split(self.v_linear(memory))

    def forward(self, query: Tensor, memory: KeysValues, mask: Tensor | None = None) -> Tensor:
        """query (B, T, 45), mask (B, 1, S) bool, none where all is seen → (B, T, 45)."""
        q, (k, v) = self._split(self.q_linear(query)), memory
        scores = (q @ k.mT / math.sqrt(q.shape[-1])).abs()
        if mask is not None:
            scores = scores.masked_fill(~mask[:, None], _HIDDEN)
        return self.out((scores.softmax(-1) @ v).transpose(1, 2).flatten(2))

    def _split(self, x: Tensor) -> Tensor:
        return x.unflatten(-1, (self.num_heads, -1)).transpose(1, 2)


class SpatialAttention(nn.Module):
    """Attention over the joints of a frame, one head an axis (section 3.3.1)."""

    def __init__(self) -> None:
        super().__init__()
        self.q_linear_sp, self.v_linear_sp, self.k_linear_sp = (nn.Linear(AXES, AXES) for _ in range(3))
        self.out = nn.Linear(WIDTH, WIDTH)

    def remember(self, memory: Tensor) -> KeysValues:
        """Keys and values of frames (B, T, 45), each (B, T, 3, J)."""
        joints = memory.unflatten(-1, (AXES, JOINTS)).mT
        return self.k_linear_sp(joints).mT, self.v_linear_sp(joints).mT

    def forward(
        self, query: Tensor, memory: KeysValues, *, graph: Tensor | None = None, distances: Tensor | None = None
    ) -> Tensor:
        """query (B, T, 45), graph (J, J) bool, distances (B, T, J, J) → (B, T, 45)."""
        made = self.q_linear_sp(query.unflatten(-1, (AXES, JOINTS)).mT).mT
        q, k, v = (x[..., None, :] for x in (made, *memory))  # (B, T, 3, 1, J)
        scores = (q.mT @ k).abs()  # (B, T, 3, J, J), heads of width 1
        if graph is not None:
            scores = scores.masked_fill(~graph, _HIDDEN)
        weights = scores.flatten(-2).softmax(-1).view_as(scores)
        if distances is not None:
            weights = weights + DISTANCE_WEIGHT * distances[:, :, None]
        seen = (weights @ v.mT)[..., 0]  # (B, T, 3, J)
        return self.out(seen.mT.flatten(-2))


def feed_forward(ff_size: int) -> nn.Sequential:
    """Linear, ReLU, Linear: (…, 45) → (…, 45)."""
    first, second = nn.Linear(WIDTH, ff_size), nn.Linear(ff_size, WIDTH)
    return nn.Sequential(OrderedDict(linear_1=first, relu=nn.ReLU(), linear_2=second))


class EncoderLayer(nn.Module):
    """Section 3.3.1."""

    def __init__(self, config: InterFormerConfig) -> None:
        super().__init__()
        self.norm_1, self.norm_space_1, self.norm_2 = Norm(), Norm(), Norm()
        self.attn, self.attn_space = TemporalAttention(config.num_heads), SpatialAttention()
        self.ff = feed_forward(config.ff_size)

    def forward(self, x: Tensor, mask: Tensor, graph: Tensor) -> Tensor:
        """x (B, T, 45), padding mask and skeleton graph (J, J) → (B, T, 45)."""
        y = self.norm_1(x)
        time = x + self.attn(y, self.attn.remember(y), mask)
        space = x + self.attn_space(y, self.attn_space.remember(y), graph=graph)
        return time + space + self.ff(self.norm_2(time) + self.norm_space_1(space))


class DecoderLayer(nn.Module):
    """Section 3.3.2."""

    def __init__(self, config: InterFormerConfig) -> None:
        super().__init__()
        self.norm_1, self.norm_2, self.norm_3 = Norm(), Norm(), Norm()
        self.norm_space_1, self.norm_space_2 = Norm(), Norm()
        self.attn_1, self.attn_2 = (TemporalAttention(config.num_heads) for _ in range(2))
        self.attn_space_1, self.attn_space_2 = SpatialAttention(), SpatialAttention()
        self.ff = feed_forward(config.ff_size)

    def forward(self, x: Tensor, kept: LayerMemory, distances: Tensor, source_mask: Tensor, graph: Tensor) -> Tensor:
        """x (B, T, 45), the frames after those that are kept already, which see these and each other."""
        y = self.norm_1(x)
        joints = tuple(part[:, kept.length : kept.length + x.shape[1]] for part in kept.joints)
        both = self.norm_2(x + self.attn_1(y, kept.extended(self.attn_1.remember(y))))
        both = self.norm_3(both + self.attn_2(both, kept.actor, source_mask))
        space = self.norm_space_1(x + self.attn_space_1(y, self.attn_space_1.remember(y), graph=graph))
        both = both + self.norm_space_2(space + self.attn_space_2(space, joints, distances=distances))
        return both + self.ff(both)


class LayerMemory:
    """The keys and values that a decoder layer keeps while it goes over the target.

    Attributes:
        actor: over time, of all frames of the encoder's output (B, S, 45).
        joints: of the joints of its first T frames, T the target's.
        length: target frames seen so far, of which those over time are kept in room for T.
    """

    def __init__(self, layer: DecoderLayer, memory: Tensor, frames: int) -> None:
        self.actor = layer.attn_2.remember(memory)
        self.joints = layer.attn_space_2.remember(memory[:, :frames])
        self.frames, self.length = frames, 0
        self._room: KeysValues | None = None

    def extended(self, new: KeysValues) -> KeysValues:
        """Keys and values of the target so far, with those of its next frames (B, heads, …, 45 / heads)."""
        begun, self.length = self.length, self.length + new[0].shape[2]
        if self._room is None:
            size, heads, _, width = new[0].shape
            keys, values = new[0].new_empty(2, size, heads, self.frames, width).unbind()
            self._room = keys, values
        for room, part in zip(self._room, new, strict=True):
            room[:, :, begun : self.length] = part
        keys, values = (room[:, :, : self.length] for room in self._room)
        return keys, values


class Encoder(nn.Module):
    """Positions, layers, a last norm."""

    def __init__(self, config: InterFormerConfig) -> None:
        super().__init__()
        self.pe = Positions(config.max_length)
        self.layers = nn.ModuleList(EncoderLayer(config) for _ in range(config.num_layers))
        self.norm = Norm()

    def forward(self, x: Tensor, mask: Tensor, graph: Tensor) -> Tensor:
        """x (B, T, 45), padding mask and skeleton graph (J, J) → (B, T, 45)."""
        x = self.pe(x)
        for layer in self.layers:
            x = layer(x, mask, graph)
        return self.norm(x)


class Decoder(nn.Module):
    """Positions, layers, a last norm."""

    def __init__(self, config: InterFormerConfig) -> None:
        super().__init__()
        self.pe = Positions(config.max_length)
        self.layers = nn.ModuleList(DecoderLayer(config) for _ in range(config.num_layers))
        self.norm = Norm()

    def remember(self, memory: Tensor, frames: int) -> list[LayerMemory]:
        """Each layer's memory of the actor (B, S, 45), for a target of so many frames."""
        return [LayerMemory(cast(DecoderLayer, layer), memory, frames) for layer in self.layers]

    def forward(self, x: Tensor, kept: list[LayerMemory], *others: Tensor) -> Tensor:
        """x (B, T, 45), the target's next frames; the others as in :meth:`DecoderLayer.forward`."""
        x = self.pe(x, kept[0].length)
        for layer, memory in zip(self.layers, kept, strict=True):
            x = layer(x, memory, *others)
        return self.norm(x)


class InterFormer(nn.Module):
    """The network of section 3.3."""

    def __init__(self, config: InterFormerConfig | None = None) -> None:
        super().__init__()
        self.config = config = config or InterFormerConfig()
        self.encoder, self.decoder = Encoder(config), Decoder(config)
        self.out = nn.Linear(WIDTH, WIDTH)
        self.register_buffer("graph", neighbours(SBU15), persistent=False)

    @torch.inference_mode()
    def generate(self, source: Tensor, source_mask: Tensor, first_frame: Tensor, frames: int) -> Tensor:
        """The reaction, a frame at a time, each at one frame's cost.

        Args:
            source: (B, S, 45) the actor.
            source_mask: (B, 1, S) bool, false at padding.
            first_frame: (B, 45) the reactor's first frame.
            frames: T, S or fewer.

        Returns:
            (B, frames, 45): zeros, the first frame, then what the network makes.
        """
        kept = self.decoder.remember(self.encoder(source, source_mask, self.graph), frames)
        made = first_frame.new_zeros(len(first_frame), frames, WIDTH)
        made[:, 1] = first_frame
        begun = 0
        for end in range(2, frames):  # the first two see each other, and each later one all before
            new = made[:, begun:end]
            table = joint_distances(source[:, begun:end], new)
            made[:, end] = self.out(self.decoder(new, kept, table, source_mask, self.graph))[:, -1]
            begun = end
        return made


def from_released(weights: Mapping[str, Tensor], *, num_heads: int = 3) -> InterFormer:
    """The network whose released tensors these are: sizes are read off them; eval mode, float32.

    Raises WeightsError if a tensor is missing, unknown or of another size.
    """
    tensors = Released(weights, NETWORK)
    config = InterFormerConfig(
        num_layers=tensors.layers("encoder.layers."),
        num_heads=num_heads,
        ff_size=tensors.shape("encoder.layers.0.ff.linear_1.weight")[0],
        max_length=tensors.shape("encoder.pe.pe")[1],
    )
    return tensors.loaded(InterFormer(config))
