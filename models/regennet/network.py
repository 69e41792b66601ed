"""ReGenNet: the reaction of one person to another, denoised with or without sight of the future.

Xu et al., "ReGenNet: Towards Human Action-Reaction Synthesis" (CVPR 2024), section 3.2, figure 2. Predicts the
clean reaction x0 from the noised reaction, the actor's motion, the timestep and, where trained with it, an
action label.

Shapes: B batch, T frames, R rows, d latent width. Motion is (B, R, 6, T); the released networks have R = 56,
the 6D rotations of 55 SMPL-X joints and one row that holds the root translation in its first 3 numbers.

The *online* network is a causal decoder: frame i sees actor frames ≤ i only. The *offline* network is an
encoder that sees all frames.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from models.diffusion import Scheduler, classifier_free, denoise, make_scheduler
from models.layers import TimestepEmbedding, sinusoids
from models.released import Released
from motion.errors import InputError

NETWORK = "ReGenNet"
ROW_WIDTH = 6
POSITIONS = "sequence_pos_encoder.pe"


class StreamError(InputError):
    """A stream was fed more frames than it was opened for."""


@dataclass(frozen=True)
class ReGenNetConfig:
    """The sizes of a `ReGenNet`; the defaults are the released ones.

    rows: rows of 6 numbers a frame; actor_rows: those of the actor's frame, as many by default.
    num_actions: action labels, 0 for a network without them.
    online: causal decoder (true) or encoder over all frames (false).
    """

    rows: int = 56
    actor_rows: int | None = None
    latent_dim: int = 512
    ff_size: int = 1024
    num_layers: int = 8
    num_heads: int = 4
    num_actions: int = 0
    online: bool = True
    dropout: float = 0.1


class ReGenNet(nn.Module):
    """The denoiser of section 3.2."""

    def __init__(self, config: ReGenNetConfig | None = None) -> None:
        super().__init__()
        self.config = config = config or ReGenNetConfig()
        features, d = config.rows * ROW_WIDTH, config.latent_dim
        self.input_process = nn.Sequential(OrderedDict(poseEmbedding=nn.Linear(features, d)))
        actor_features = (config.actor_rows or config.rows) * ROW_WIDTH
        self.cmo_process = nn.Sequential(OrderedDict(poseEmbedding=nn.Linear(actor_features, d)))
        self.fuse_process = nn.Linear(2 * d, d)
        sizes: dict[str, Any] = {"dropout": config.dropout, "activation": "gelu", "batch_first": True}
        if config.online:
            layer = nn.TransformerDecoderLayer(d, config.num_heads, config.ff_size, **sizes)
            self.seqTransDecoder = nn.TransformerDecoder(layer, config.num_layers)
        else:
            encoder = nn.TransformerEncoderLayer(d, config.num_heads, config.ff_size, **sizes)
            self.seqTransEncoder = nn.TransformerEncoder(encoder, config.num_layers, enable_nested_tensor=False)
        self.embed_timestep = TimestepEmbedding(d)
        if config.num_actions:
            self.embed_action = nn.ParameterDict({"action_embedding": torch.randn(config.num_actions, d)})
        self.output_process = nn.Sequential(OrderedDict(poseFinal=nn.Linear(d, features)))

    def embed(self, t: Tensor, action: Tensor | None, unconditional: bool | Tensor) -> Tensor:
        """The condition of a pass, (B, d): timestep plus action, the action left out where unconditional."""
        emb = self.embed_timestep(t)
        if self.config.num_actions and action is not None:
            keep = ~torch.as_tensor(unconditional, device=t.device).expand(t.shape[0])
            emb = emb + keep[:, None] * self.embed_action["action_embedding"][action.flatten()]
        return emb

    def fuse(self, x: Tensor, actor: Tensor) -> Tensor:
        """Both people's frames (B, T, 6R) to one sequence (B, T, d), without positions."""
        return self.fuse_process(torch.cat([self.input_process(x), self.cmo_process(actor)], dim=-1))

    def forward(
        self, x: Tensor, t: Tensor, actor: Tensor, action: Tensor | None = None, unconditional: bool | Tensor = False
    ) -> Tensor:
        """The predicted clean reaction.

        Args:
            x: (B, R, 6, T) noised reaction.
            t: (B,) int64 timesteps.
            actor: (B, R, 6, T) the actor's clean motion.
            action: (B,) or (B, 1) int64 labels; None means unconditional.
            unconditional: leave the label out, for all samples or, as a (B,) bool tensor, for some.

        Returns:
            (B, R, 6, T)
        """
        b, rows, width, length = x.shape
        emb = self.embed(t, action, unconditional)
        h = self.fuse(x.flatten(1, 2).mT, actor.flatten(1, 2).mT)
        d = self.config.latent_dim
        if self.config.online:
            h = h + sinusoids(length, d, device=x.device)
            causal = torch.ones(length, length, dtype=torch.bool, device=x.device).triu(1)
            h = self.seqTransDecoder(h, emb[:, None], tgt_mask=causal)
        else:
            h = torch.cat([emb[:, None], h], dim=1) + sinusoids(length + 1, d, device=x.device)
            h = self.seqTransEncoder(h)[:, 1:]
        return self.output_process(h).mT.reshape(b, rows, width, length)

    def guided(self, x: Tensor, t: Tensor, actor: Tensor, action: Tensor, *, scale: float) -> Tensor:
        """:func:`models.diffusion.classifier_free` on the action; shapes as in `forward`."""
        given = torch.zeros(x.shape[0], dtype=torch.bool, device=x.device)  # which samples leave the action out
        return classifier_free(self, x, t, actor, action, cond=given, nothing=~given, scale=scale)


Attend = Callable[[Tensor, Tensor, Tensor], Tensor]
"""Queries, keys and values (B, heads, T, d / heads) → what the queries see, in the shape of the queries."""


def decoder_layer(layer: nn.TransformerDecoderLayer, h: Tensor, memory: Tensor, attend: Attend) -> Tensor:
    """One layer of the online network, without dropout: h (B, T, d) → (B, T, d).

    The memory is a single token, so attention to it is the same vector for every frame: ``memory`` (B, 1, d),
    see :func:`attend_to_one`.
    """
    attention = layer.self_attn
    parts = F.linear(h, attention.in_proj_weight, attention.in_proj_bias).chunk(3, dim=-1)
    q, k, v = (part.unflatten(-1, (attention.num_heads, -1)).transpose(1, 2) for part in parts)
    seen = attend(q, k, v).transpose(1, 2).flatten(2)
    h = layer.norm1(h + attention.out_proj(seen))
    h = layer.norm2(h + memory)
    return layer.norm3(h + layer.linear2(F.gelu(layer.linear1(h))))


class CausalPass:
    """One denoising pass of an online network at a fixed timestep, a frame at a time.

    Keys and values of past frames are kept, so a frame costs one token through the layers, plus attention
    over the frames so far, or over the last ``window`` of them.

    Args:
        network: an online network.
        emb: (B, d) the condition of the pass, as :meth:`ReGenNet.embed` gives it.
        max_frames: how many frames there can be.
        window: how many frames a frame sees, itself among them; all of the past by default.
    """

    def __init__(self, network: ReGenNet, emb: Tensor, max_frames: int, *, window: int | None = None) -> None:
        config, b = network.config, emb.shape[0]
        self.network, self.length, self.max_frames = network, 0, max_frames
        self.window = window or max_frames
        self.layers = network.seqTransDecoder.layers
        heads, width = config.num_heads, config.latent_dim // config.num_heads
        self.cache = emb.new_zeros(len(self.layers), 2, b, heads, max_frames, width)
        self.positions = sinusoids(max_frames, config.latent_dim, device=emb.device)
        self.from_memory = [attend_to_one(layer.multihead_attn, emb)[:, None] for layer in self.layers]

    @torch.no_grad()
    def step(self, x: Tensor, actor: Tensor) -> Tensor:
        """The next noised and actor frame (B, 6R) → the predicted clean frame (B, 6R)."""
        i = self.length
        first = max(0, i + 1 - self.window)
        h = self.network.fuse(x, actor)[:, None] + self.positions[i]
        for layer, cache, memory in zip(self.layers, self.cache, self.from_memory, strict=True):

            def attend(q: Tensor, k: Tensor, v: Tensor, cache: Tensor = cache) -> Tensor:
                keys, values = cache
                keys[:, :, i : i + 1], values[:, :, i : i + 1] = k, v
                return F.scaled_dot_product_attention(q, keys[:, :, first : i + 1], values[:, :, first : i + 1])

            h = decoder_layer(layer, h, memory, attend)
        self.length += 1
        return self.network.output_process(h[:, 0])


def attend_to_one(attention: nn.MultiheadAttention, token: Tensor) -> Tensor:
    """Attention to a single key is its value: (B, d) → (B, d)."""
    d = token.shape[-1]
    value = F.linear(token, attention.in_proj_weight[2 * d :], attention.in_proj_bias[2 * d :])
    return attention.out_proj(value)


class Stream:
    """DDIM sampling of a reaction while the actor moves, for which every step keeps its own :class:`CausalPass`.

    Args:
        network: an online network.
        embed: gives the condition (B, d) of a pass at a timestep.
        scheduler: of the steps.
        max_frames: how many frames there can be.
        rows: how many the passes are of.
        window: see :class:`CausalPass`.

    Attributes:
        length: frames so far.
    """

    def __init__(
        self,
        network: ReGenNet,
        embed: Callable[[Tensor], Tensor],
        scheduler: Scheduler,
        *,
        max_frames: int,
        rows: int,
        window: int | None = None,
    ) -> None:
        self.scheduler, self.max_frames, self.length = scheduler, max_frames, 0
        with torch.no_grad():
            self.passes = {int(t): CausalPass(network, embed(t), rows, window=window) for t in scheduler.timesteps}

    def count(self) -> int:
        """Counts a frame and gives its number, from 0; raises StreamError after ``max_frames`` frames."""
        if self.length == self.max_frames:
            raise StreamError(f"The stream was opened for {self.max_frames} frames: open another.")
        self.length += 1
        return self.length - 1


class ReactionStream(Stream):
    """One actor frame in, one reaction frame out, of an online network.

    Since no frame looks ahead, the frames equal those of sampling the whole motion at once from the same noise. A
    frame costs `steps` one-token passes whatever came before; only the attention over past frames, the smaller part,
    grows with their number.
    """

    def __init__(self, network: ReGenNet, *, steps: int, batch: int, action: Tensor | None, max_frames: int) -> None:
        if not network.config.online:
            raise StreamError("An offline ReGenNet needs the whole motion: choose online weights to stream.")
        scheduler = make_scheduler("ddim", steps, device=network.fuse_process.weight.device)
        super().__init__(
            network,
            lambda t: network.embed(t.expand(batch), action, False),
            scheduler,
            max_frames=max_frames,
            rows=max_frames,
        )

    @torch.no_grad()
    def step(self, actor: Tensor, *, noise: Tensor) -> Tensor:
        """The reaction's next frame.

        Args:
            actor: (B, R, 6) the actor's frame.
            noise: (B, R, 6) what the frame is denoised from.

        Returns:
            (B, R, 6). Raises StreamError after `max_frames` frames.
        """
        self.count()
        seen = actor.flatten(1)

        def predict(x: Tensor, t: Tensor) -> Tensor:
            return self.passes[int(t[0])].step(x, seen)

        return denoise(predict, noise.flatten(1), self.scheduler).view_as(actor)


def from_released(weights: Mapping[str, Tensor], *, num_heads: int) -> ReGenNet:
    """The network whose released tensors these are: sizes and kind are read off them; eval mode, float32.

    The release stores its sinusoid table under ``sequence_pos_encoder.pe`` (and again inside
    ``embed_timestep``); it is computed here, so these are left out.

    Raises WeightsError if a tensor is missing, unknown or of another size.
    """
    kept = {name: value for name, value in weights.items() if not name.endswith(POSITIONS)}
    tensors = Released(kept, NETWORK)
    latent_dim, features = tensors.shape("input_process.poseEmbedding.weight")
    online = any(name.startswith("seqTransDecoder.") for name in tensors)
    layers = "seqTransDecoder.layers." if online else "seqTransEncoder.layers."
    actions = tensors.get("embed_action.action_embedding")
    config = ReGenNetConfig(
        rows=features // ROW_WIDTH,
        latent_dim=latent_dim,
        ff_size=tensors.shape(f"{layers}0.linear1.weight")[0],
        num_layers=tensors.layers(layers),
        num_heads=num_heads,
        num_actions=0 if actions is None else len(actions),
        online=online,
    )
    return tensors.loaded(ReGenNet(config))
