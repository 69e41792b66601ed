"""The trained InterFormer: spatial and temporal attention over 15 joints, at 15 frames a second.

It shares with :mod:`models.interformer` (Chopin's thesis, chapter 3):

- an encoder of the actor's motion, and a causal decoder of the reactor's motion from a given first pose;
- decoder layers that attend over time and, in parallel, over the joints of a frame;
- spatial self-attention masked to the skeleton's graph;
- the softmax of negative joint distances, added to the spatial cross-attention after its softmax;
- noise on the encoder's input, for variety.

It differs, because it learns from a few hundred clips only:

- a joint has 8 features instead of 3, so a frame is 120 wide;
- layers are pre-norm, with plain dot products and one softmax a row;
- the decoder's input at a frame sees the encoder's output for the frame to be predicted;
- the network predicts the step to the next pose instead of the pose;
- a linear part, solved in closed form (:mod:`training.trainers.interformer`), gives a first estimate of that step,
  which the attention corrects.

A reaction is made frame by frame (:meth:`CompactInterFormer.poses_after`).

Shapes: B batch, T frames, J = 15 joints in the order of SBU's files, W numbers a joint, D = J · W.
Positions are in metres in the actor's frame: the actor at the origin at the start, facing +Z, floor at 0.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from models.interformer.network import JOINTS
from models.layers import FeedForward, neighbours, sinusoids
from motion.skeleton import LAYOUTS, SBU15

FPS = 15.0
JOINTS_15 = LAYOUTS["sbu15"].joints
"""The SMPL22 joint of each of SBU's 15."""
ROOT = 2
"""The torso, whose position stands for the body's."""
_ACTOR_FEATURES, _REACTOR_FEATURES = 9, 12
_AROUND = (-8, -4, 0, 4, 8)
"""Frames of the actor that the linear part sees, relative to the frame to be predicted."""
LINEAR_FEATURES = len(_AROUND) * 3 * (JOINTS + 1) + 3 * 3 * JOINTS + 4
LARGEST = 30.0
"""Upper bound of a spatial score, so that its exponential stays finite."""


@dataclass(frozen=True)
class CompactInterFormerConfig:
    """Sizes of a :class:`CompactInterFormer`.

    joint_width: numbers a joint; spatial_heads and heads divide it and the whole frame's width.
    window: frames of a sub-sequence; longer motions are processed window by window.
    noise: width of the noise vector.
    """

    joint_width: int = 8
    encoder_layers: int = 1
    decoder_layers: int = 2
    heads: int = 4
    spatial_heads: int = 2
    ff_size: int = 240
    window: int = 48
    noise: int = 16
    dropout: float = 0.1

    @property
    def width(self) -> int:
        """Numbers of one frame's embedding."""
        return JOINTS * self.joint_width


def _split(x: Tensor, heads: int) -> Tensor:
    """(…, T, D) → (…, heads, T, D / heads)."""
    return x.unflatten(-1, (heads, -1)).transpose(-2, -3)


class TemporalAttention(nn.Module):
    """Attention over frames, of the frames themselves or of another sequence."""

    def __init__(self, config: CompactInterFormerConfig) -> None:
        super().__init__()
        d = config.width
        self.heads = config.heads
        self.query, self.memory, self.out = nn.Linear(d, d), nn.Linear(d, 2 * d), nn.Linear(d, d)

    def forward(self, x: Tensor, source: Tensor, mask: Tensor | None) -> Tensor:
        """x (B, T, D), source (B, S, D) of keys and values; mask (…, T, S) bool, true where seen → (B, T, D)."""
        keys, values = (_split(part, self.heads) for part in self.memory(source).chunk(2, dim=-1))
        seen = F.scaled_dot_product_attention(_split(self.query(x), self.heads), keys, values, mask)
        return self.out(seen.transpose(1, 2).flatten(2))


class SpatialAttention(nn.Module):
    """Attention over the joints of a frame, of the person's own or of the other's."""

    def __init__(self, config: CompactInterFormerConfig) -> None:
        super().__init__()
        w = config.joint_width
        self.width, self.heads = w, config.spatial_heads
        self.scale = (w // config.spatial_heads) ** -0.5
        self.query, self.memory = nn.Linear(w, w), nn.Linear(w, 2 * w)
        self.out = nn.Linear(config.width, config.width)

    def forward(
        self, x: Tensor, source: Tensor, *, graph: Tensor | None = None, distances: Tensor | None = None
    ) -> Tensor:
        """x and source (B, T, D), graph (J, J) of 0 and 1, distances (B, T, 1, J, J) → (B, T, D)."""
        parts = self.memory(source.unflatten(-1, (JOINTS, self.width))).chunk(2, dim=-1)
        keys, values = (_split(part, self.heads) for part in parts)
        query = _split(self.query(x.unflatten(-1, (JOINTS, self.width))), self.heads)
        # A softmax written out: PyTorch's takes several times as long for rows as short as a skeleton.
        weights = ((query * self.scale) @ keys.mT).clamp(max=LARGEST).exp()
        weights = weights if graph is None else weights * graph
        weights = weights / weights.sum(-1, keepdim=True)
        if distances is not None:
            weights = weights + distances
        return self.out((weights @ values).transpose(-2, -3).flatten(-3))


class EncoderLayer(nn.Module):
    """Attention over time and over the joints, side by side, and a feed-forward part; norms before each."""

    def __init__(self, config: CompactInterFormerConfig) -> None:
        super().__init__()
        d = config.width
        self.norm_1, self.norm_2 = nn.LayerNorm(d), nn.LayerNorm(d)
        self.time, self.space = TemporalAttention(config), SpatialAttention(config)
        self.ff = FeedForward(d, config.ff_size, dropout=config.dropout)
        self.drop = nn.Dropout(config.dropout)

    def forward(self, x: Tensor, mask: Tensor, graph: Tensor) -> Tensor:
        """x (B, T, D), mask (…, T, T) bool, graph (J, J) of 0 and 1 → (B, T, D)."""
        y = self.norm_1(x)
        x = x + self.drop(self.time(y, y, mask) + self.space(y, y, graph=graph))
        return x + self.drop(self.ff(self.norm_2(x)))


class DecoderLayer(nn.Module):
    """An :class:`EncoderLayer` over the reactor so far, with the same two attentions to the actor."""

    def __init__(self, config: CompactInterFormerConfig) -> None:
        super().__init__()
        d = config.width
        self.norm_1, self.norm_2, self.norm_3 = (nn.LayerNorm(d) for _ in range(3))
        self.time, self.other_time = TemporalAttention(config), TemporalAttention(config)
        self.space, self.other_space = SpatialAttention(config), SpatialAttention(config)
        self.ff = FeedForward(d, config.ff_size, dropout=config.dropout)
        self.drop = nn.Dropout(config.dropout)

    def forward(
        self, x: Tensor, encoded: Tensor, causal: Tensor, mask: Tensor, graph: Tensor, distances: Tensor
    ) -> Tensor:
        """x (B, T, D), encoded (B, S, D) with S > T: frame t sees the joints of the actor's frame t + 1."""
        y = self.norm_1(x)
        x = x + self.drop(self.time(y, y, causal) + self.space(y, y, graph=graph))
        y = self.norm_2(x)
        coming = encoded[:, 1 : x.shape[1] + 1]
        x = x + self.drop(self.other_time(y, encoded, mask) + self.other_space(y, coming, distances=distances))
        return x + self.drop(self.ff(self.norm_3(x)))


def _actor_features(actor: Tensor) -> Tensor:
    velocity = F.pad(actor.diff(dim=1), (0, 0, 0, 0, 1, 0))
    return torch.cat([actor, actor - actor[:, :, ROOT, None], velocity], dim=-1)


def _reactor_features(reactor: Tensor, previous: Tensor, actor: Tensor) -> Tensor:
    own, other = reactor[:, :, ROOT, None], actor[:, :, ROOT, None]
    return torch.cat([reactor, reactor - own, reactor - other, reactor - previous], dim=-1)


def frames_around(actor: Tensor) -> Tensor:
    """(B, T, J, 3) → (B, T, …) the actor's poses around each frame and their ways to that frame's."""
    length = actor.shape[1]
    frames = torch.arange(length)[:, None] + torch.tensor(_AROUND)
    seen = actor[:, frames.clamp(0, length - 1)]  # (B, T, 5, J, 3)
    own = seen[..., ROOT, None, :]
    ways = own - actor[:, :, None, ROOT, None]
    return torch.cat([seen - own, ways], dim=-2).flatten(2)


def linear_input(reactor: Tensor, previous: Tensor, first: Tensor, actor: Tensor, around: Tensor) -> Tensor:
    """(B, T, F) inputs of the linear part, from reactor, previous and actor (B, T, J, 3), first (B, J, 3)."""
    own = reactor[:, :, ROOT, None]
    parts = [reactor - own, reactor - previous, (first[:, None] - own).expand_as(reactor)]
    flat = [part.flatten(2) for part in parts]
    apart = reactor[:, :, ROOT] - actor[:, :, ROOT]
    return torch.cat([around, *flat, apart, torch.ones_like(apart[..., :1])], dim=-1)


class CompactInterFormer(nn.Module):
    """Encoder, decoder, normalisers and the reactor's default first pose.

    Buffers: ``actor_mean`` and ``actor_std`` (J, 9), ``reactor_mean`` and ``reactor_std`` (J, 12) of the
    input features; ``step_std`` (J, 3), metres between two frames; ``stance`` (22, 3), a standing person facing +Z.
    """

    sizes = CompactInterFormerConfig
    actor_mean: Tensor
    actor_std: Tensor
    reactor_mean: Tensor
    reactor_std: Tensor
    step_std: Tensor
    stance: Tensor
    graph: Tensor
    positions: Tensor

    def __init__(self, config: CompactInterFormerConfig) -> None:
        super().__init__()
        self.config = config
        d, w = config.width, config.joint_width
        for name, features in (("actor", _ACTOR_FEATURES), ("reactor", _REACTOR_FEATURES)):
            self.register_buffer(f"{name}_mean", torch.zeros(JOINTS, features))
            self.register_buffer(f"{name}_std", torch.ones(JOINTS, features))
        self.register_buffer("step_std", torch.ones(JOINTS, 3))
        self.register_buffer("stance", torch.zeros(22, 3))
        self.register_buffer("graph", neighbours(SBU15).float(), persistent=False)
        self.register_buffer("positions", sinusoids(config.window, d), persistent=False)
        self.embed_actor, self.embed_reactor = nn.Linear(_ACTOR_FEATURES, w), nn.Linear(_REACTOR_FEATURES, w)
        self.joints = nn.Parameter(0.5 * torch.randn(2, d))
        self.embed_noise, self.align = nn.Linear(config.noise, d, bias=False), nn.Linear(d, d)
        self.encoder = nn.ModuleList(EncoderLayer(config) for _ in range(config.encoder_layers))
        self.decoder = nn.ModuleList(DecoderLayer(config) for _ in range(config.decoder_layers))
        self.encoder_norm, self.out_norm = nn.LayerNorm(d), nn.LayerNorm(d)
        self.linear = nn.Linear(LINEAR_FEATURES, JOINTS * 3, bias=False)
        self.out = nn.Linear(d, JOINTS * 3)
        for layer in (self.linear, self.out):  # an untrained network predicts no movement
            nn.init.zeros_(layer.weight)
        nn.init.zeros_(self.out.bias)
        self.reach = nn.Parameter(torch.ones(()))

    @staticmethod
    def features(actor: Tensor, reactor: Tensor) -> tuple[Tensor, Tensor]:
        """Features of the actor (B, T, J, 3) and of the reactor's frames except the last, not normalised."""
        previous = torch.cat([reactor[:, :1], reactor[:, :-1]], dim=1)
        return _actor_features(actor), _reactor_features(reactor, previous, actor[:, 1:])

    def encode(self, actor: Tensor, noise: Tensor, mask: Tensor) -> Tensor:
        """The actor's whole motion.

        Args:
            actor: (B, T, J, 3) metres, T ≤ window.
            noise: (B, noise) standard normal, another one for another reaction.
            mask: (B, T) bool, false at padding.

        Returns:
            (B, T, D)
        """
        features = _actor_features(actor)
        x = self.embed_actor((features - self.actor_mean) / self.actor_std).flatten(-2) + self.joints[0]
        x = x + self.positions[: x.shape[1]] + self.embed_noise(noise)[:, None]
        for layer in self.encoder:
            x = layer(x, mask[:, None, None, :], self.graph)
        return self.encoder_norm(x)

    def embed(self, reactor: Tensor, previous: Tensor, actor: Tensor, encoded: Tensor) -> Tensor:
        """The decoder's input, each frame with the actor's frame to come: (B, T, D)."""
        features = _reactor_features(reactor, previous, actor)
        x = self.embed_reactor((features - self.reactor_mean) / self.reactor_std).flatten(-2)
        x = x + (self.joints[1] + self.positions[: x.shape[1]])
        return x + self.align(encoded)

    def distances(self, reactor: Tensor, actor: Tensor) -> Tensor:
        """(B, T, 1, J, J) softmax over the table of −distance (eq. 3.7), times what was learned."""
        table = -torch.cdist(reactor, actor, compute_mode="donot_use_mm_for_euclid_dist")
        near = table.exp()
        return (self.reach * near / near.sum((-1, -2), keepdim=True))[:, :, None]

    def forward(self, actor: Tensor, reactor: Tensor, noise: Tensor, mask: Tensor) -> Tensor:
        """The next pose after every frame of the reactor.

        Args:
            actor: (B, T, J, 3) metres.
            reactor: (B, T − 1, J, 3) metres, all frames but the last.
            noise: (B, noise).
            mask: (B, T) bool, false at padding.

        Returns:
            (B, T − 1, J, 3) metres; frame t is the pose at t + 1.
        """
        return self.decode(actor, self.encode(actor, noise, mask), reactor, mask)

    def decode(self, actor: Tensor, encoded: Tensor, reactor: Tensor, mask: Tensor) -> Tensor:
        """:meth:`forward` from the encoder's output on; fewer frames of the reactor may be given."""
        length = reactor.shape[1]
        coming, previous = actor[:, 1 : length + 1], torch.cat([reactor[:, :1], reactor[:, :-1]], dim=1)
        x = self.embed(reactor, previous, coming, encoded[:, 1 : length + 1])
        causal = torch.ones(length, length, dtype=torch.bool, device=x.device).tril()
        distances = self.distances(reactor, coming)
        for layer in self.decoder:
            x = layer(x, encoded, causal, mask[:, None, None, :], self.graph, distances)
        return reactor + self.step(x, self.linear_features(actor, reactor))

    @torch.no_grad()
    def poses_after(self, actor: Tensor, first: Tensor, noise: Tensor, mask: Tensor | None = None) -> Iterator[Tensor]:
        """The poses (B, J, 3) after the first one, T − 1 of them, each as soon as it is made.

        Args:
            actor: (B, T, J, 3) metres, T ≤ window.
            first: (B, J, 3) metres.
            noise: (B, noise).
            mask: (B, T) bool, false at padding.
        """
        mask = torch.ones(actor.shape[:2], dtype=torch.bool) if mask is None else mask
        encoded, made = self.encode(actor, noise, mask), first[:, None]
        for _ in range(actor.shape[1] - 1):
            made = torch.cat([made, self.decode(actor, encoded, made, mask)[:, -1:]], dim=1)
            yield made[:, -1]

    def react(self, actor: Tensor, first: Tensor, noise: Tensor, mask: Tensor | None = None) -> Tensor:
        """The reaction (B, T, J, 3) to a window of the actor; arguments as in :meth:`poses_after`."""
        return torch.stack([first, *self.poses_after(actor, first, noise, mask)], dim=1)

    @staticmethod
    def linear_features(actor: Tensor, reactor: Tensor) -> Tensor:
        """(B, T − 1, F) what the linear part sees of all frames, shapes as in :meth:`decode`."""
        coming = slice(1, reactor.shape[1] + 1)
        previous = torch.cat([reactor[:, :1], reactor[:, :-1]], dim=1)
        around = frames_around(actor)[:, coming]
        return linear_input(reactor, previous, reactor[:, 0], actor[:, coming], around)

    def step(self, x: Tensor, features: Tensor) -> Tensor:
        """(B, T, D) and (B, T, F) → (B, T, J, 3) metres to the next pose."""
        steps = self.linear(features) + self.out(self.out_norm(x))
        return steps.unflatten(-1, (JOINTS, 3)) * self.step_std
