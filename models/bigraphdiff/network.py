"""BiGraphDiff: two people from a label or a text, tied by a bipartite graph between their features.

Chopin, "New approaches for predicting and generating human motions from 3D skeletons: application to non-verbal
social interactions in virtual reality" (thesis, 2023), section 4.3; Chopin, Tang & Daoudi 2023. Two
streams of unshared weights; in each layer every stream attends to itself and to the text at linear cost
(eq. 4.16), then both pass the bipartite graph unit together (eq. 4.17–4.19), then a feed-forward. Predicts
the noise ε (eq. 4.12), so sample it with ``make_scheduler("ddpm", 1000, prediction="epsilon")``.

Positions, text and timestep enter as in MotionDiffuse (Zhang et al. 2022), which the paper builds on.
:func:`from_released` takes the names and widths of the released file; the whole network equals the released
one on reference inputs.

Shapes: B batch, T frames, F features a person and frame, L text tokens, C text width, d latent width,
E embedding width.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from models import layers
from models.layers import encoder_layer
from models.released import Released

NETWORK = "BiGraphDiff"
NODE_GRID = 4  # a frame's d features are d/16 channels over a 4 × 4 grid in the bipartite unit


def timestep_embedding(t: Tensor, width: int) -> Tensor:
    """Cosines, then sines, of t at `width`/2 frequencies, base 10000: (B,) → (B, width)."""
    half = width // 2
    frequencies = torch.exp(-math.log(10000.0) * torch.arange(half, device=t.device) / half)
    angles = t[:, None].float() * frequencies
    return torch.cat([angles.cos(), angles.sin()], dim=-1)


class StylizationBlock(nn.Module):
    """The end of every block: a LayerNorm scaled and shifted by the embedding, SiLU, Linear."""

    def __init__(self, latent_dim: int, embed_dim: int) -> None:
        super().__init__()
        self.emb_layers = nn.Sequential(nn.SiLU(), nn.Linear(embed_dim, 2 * latent_dim))
        self.norm = nn.LayerNorm(latent_dim)
        last = nn.Linear(latent_dim, latent_dim)
        self.out_layers = nn.Sequential(nn.SiLU(), nn.Identity(), last)  # dropout, in the release
        nn.init.zeros_(last.weight)
        nn.init.zeros_(last.bias)

    def forward(self, h: Tensor, emb: Tensor) -> Tensor:
        """h (B, T, d), emb (B, E) → (B, T, d)."""
        scale, shift = self.emb_layers(emb)[:, None].chunk(2, dim=-1)
        return self.out_layers(self.norm(h) * (1 + scale) + shift)


def efficient_attention(query: Tensor, key: Tensor, value: Tensor, num_heads: int) -> Tensor:
    """Attention of linear cost (eq. 4.16): softmax over channels of the query, over time of the key.

    query (B, T, d), key and value (B, S, d) → (B, T, d).
    """
    q = query.unflatten(-1, (num_heads, -1)).softmax(-1)
    k = key.unflatten(-1, (num_heads, -1)).softmax(1)
    v = value.unflatten(-1, (num_heads, -1))
    features = torch.einsum("bshd,bshe->bhde", k, v)
    return torch.einsum("bthd,bhde->bthe", q, features).flatten(2)


class Attention(nn.Module):
    """A stream's attention to rows of some width, stylised."""

    def __init__(self, latent_dim: int, width: int, num_heads: int, embed_dim: int) -> None:
        super().__init__()
        self.num_heads = num_heads
        self.norm = nn.LayerNorm(latent_dim)
        self.query = nn.Linear(latent_dim, latent_dim)
        self.key, self.value = nn.Linear(width, latent_dim), nn.Linear(width, latent_dim)
        self.proj_out = StylizationBlock(latent_dim, embed_dim)


class SelfAttention(Attention):
    """A stream's attention to itself."""

    def forward(self, x: Tensor, emb: Tensor, mask: Tensor) -> Tensor:
        """x (B, T, d), emb (B, E), mask (B, T, 1), 1 where a frame is real → (B, T, d)."""
        normed = self.norm(x)
        key = self.key(normed).masked_fill(mask == 0, -1e6)
        out = efficient_attention(self.query(normed), key, self.value(normed) * mask, self.num_heads)
        return x + self.proj_out(out, emb)


class CrossAttention(Attention):
    """A stream's attention to the text tokens."""

    def __init__(self, latent_dim: int, width: int, num_heads: int, embed_dim: int) -> None:
        super().__init__(latent_dim, width, num_heads, embed_dim)
        self.text_norm = nn.LayerNorm(width)

    def forward(self, x: Tensor, text: Tensor, emb: Tensor) -> Tensor:
        """x (B, T, d), text (B, L, C), emb (B, E) → (B, T, d)."""
        tokens = self.text_norm(text)
        query = self.query(self.norm(x))
        return x + self.proj_out(efficient_attention(query, self.key(tokens), self.value(tokens), self.num_heads), emb)


class FeedForward(layers.FeedForward):
    """Linear, GELU, Linear, stylised."""

    def __init__(self, latent_dim: int, ff_size: int, embed_dim: int) -> None:
        super().__init__(latent_dim, ff_size)
        self.proj_out = StylizationBlock(latent_dim, embed_dim)

    def forward(self, x: Tensor, emb: Tensor) -> Tensor:  # type: ignore[override]  # one more input
        """x (B, T, d), emb (B, E) → (B, T, d)."""
        return x + self.proj_out(super().forward(x), emb)


class GraphConvolution(nn.Module):
    """(I + A) V W with a learned, fully connected A (eq. 4.18): ReLU between the two."""

    def __init__(self, num_states: int, num_nodes: int) -> None:
        super().__init__()
        self.conv1 = nn.Conv1d(num_nodes, num_nodes, 1)
        self.conv2 = nn.Conv1d(num_states, num_states, 1, bias=False)

    def forward(self, v: Tensor) -> Tensor:
        """(N, states, nodes) → the same."""
        return self.conv2(F.relu(v + self.conv1(v.transpose(-1, -2)).transpose(-1, -2)))


class BipartiteGraph(nn.Module):
    """Both streams' features reasoned over as one bipartite graph (eq. 4.17–4.19).

    Each stream's states are gathered to nodes by the *other* stream's projection, passed through a graph
    convolution of its own, scattered back by the same projection, batch-normalised and added.
    """

    def __init__(self, channels: int, num_nodes: int) -> None:
        super().__init__()
        states = 2 * num_nodes
        self.conv_state = nn.Conv2d(channels, states, 1)
        self.conv_proj = nn.Conv2d(channels, num_nodes, 1)
        self.gcn1 = GraphConvolution(states, num_nodes)
        self.gcn2 = GraphConvolution(states, num_nodes)
        self.conv_extend = nn.Conv2d(states, channels, 1, bias=False)
        self.blocker = nn.BatchNorm2d(channels, eps=1e-4)

    def forward(self, x: Tensor) -> Tensor:
        """(N, 2·channels, H, W), the streams stacked along channels → the same."""
        first, second = x.chunk(2, dim=1)
        updated = self._update(first, second, self.gcn1), self._update(second, first, self.gcn2)
        return torch.cat(updated, dim=1)

    def _update(self, own: Tensor, other: Tensor, gcn: GraphConvolution) -> Tensor:
        projection = self.conv_proj(other).flatten(2)  # (N, nodes, HW)
        nodes = gcn(self.conv_state(own).flatten(2) @ projection.transpose(-1, -2))
        back = (nodes @ projection).unflatten(-1, own.shape[2:])
        return own + self.blocker(self.conv_extend(back))


@dataclass(frozen=True)
class BiGraphDiffConfig:
    """Sizes; the defaults are the paper's, with 25 joints of NTU a person.

    embed_dim: width of the embedding that styles every block; 0: four times `latent_dim`, as in the paper.
    """

    input_features: int = 75
    latent_dim: int = 512
    ff_size: int = 1024
    num_layers: int = 8
    num_heads: int = 8
    text_dim: int = 256
    max_frames: int = 300
    num_nodes: int = 16
    embed_dim: int = 0

    @property
    def embedding(self) -> int:
        """E, the embedding's width."""
        return self.embed_dim or 4 * self.latent_dim


class Layer(nn.Module):
    """One layer of the motion decoder, both streams."""

    def __init__(self, config: BiGraphDiffConfig) -> None:
        super().__init__()
        d, heads, wide, text = config.latent_dim, config.num_heads, config.embedding, config.text_dim
        self.sa_block_1, self.sa_block_2 = (SelfAttention(d, d, heads, wide) for _ in range(2))
        self.ca_block_1, self.ca_block_2 = (CrossAttention(d, text, heads, wide) for _ in range(2))
        self.bipartite_graph = BipartiteGraph(d // NODE_GRID**2, config.num_nodes)
        self.ffn_1, self.ffn_2 = (FeedForward(d, config.ff_size, wide) for _ in range(2))

    def forward(self, a: Tensor, b: Tensor, text: Tensor, emb: Tensor, mask: Tensor) -> tuple[Tensor, Tensor]:
        """a and b (B, T, d), text (B, L, C), emb (B, E), mask (B, T, 1) → a and b."""
        a = self.ca_block_1(self.sa_block_1(a, emb, mask), text, emb)
        b = self.ca_block_2(self.sa_block_2(b, emb, mask), text, emb)
        grid = (a.shape[-1] // NODE_GRID**2, NODE_GRID, NODE_GRID)
        frames = torch.cat([s.flatten(0, 1).unflatten(-1, grid) for s in (a, b)], dim=1)
        a, b = (s.reshape(a.shape) for s in self.bipartite_graph(frames).chunk(2, dim=1))
        return self.ffn_1(a, emb), self.ffn_2(b, emb)


class TextSide(nn.Module):
    """The trained layers between frozen CLIP tokens and the decoder, as in MotionDiffuse.

    Args:
        clip_dim: width of CLIP's token features, 512 for ViT-B/32.
        text_dim: C.
        ff_size, num_layers, num_heads: of the transformer.
    """

    def __init__(self, clip_dim: int, text_dim: int, ff_size: int, num_layers: int, num_heads: int) -> None:
        super().__init__()
        self.text_pre_proj = nn.Linear(clip_dim, text_dim)
        layer = encoder_layer(text_dim, num_heads, ff_size, norm_first=False)
        self.textTransEncoder = nn.TransformerEncoder(layer, num_layers, enable_nested_tensor=False)
        self.text_ln = nn.LayerNorm(text_dim)

    def forward(self, features: Tensor, end: Tensor) -> tuple[Tensor, Tensor]:
        """Encodes a text for :class:`BiGraphDiff`.

        Args:
            features: (B, L, clip_dim) CLIP's token features after its last norm.
            end: (B,) int64 place of the end-of-text token.

        Returns:
            (B, L, C) features of the tokens and (B, C) that of the end-of-text token.
        """
        text = self.text_ln(self.textTransEncoder(self.text_pre_proj(features)))
        return text, text[torch.arange(len(text), device=text.device), end]


class BiGraphDiff(nn.Module):
    """The Bipartite Graph Interaction Transformer of section 4.3.3.

    `text_side` is there where released weights that hold one were read; `forward` takes what it gives.
    """

    def __init__(self, config: BiGraphDiffConfig | None = None, *, text_side: TextSide | None = None) -> None:
        super().__init__()
        self.config = config = config or BiGraphDiffConfig()
        d = config.latent_dim
        self.sequence_embedding = nn.Parameter(torch.randn(config.max_frames, d))
        self.joint_embed_1 = nn.Linear(config.input_features, d)
        self.joint_embed_2 = nn.Linear(config.input_features, d)
        wide = config.embedding
        self.time_embed = nn.Sequential(nn.Linear(d, wide), nn.SiLU(), nn.Linear(wide, wide))
        self.text_proj = nn.Linear(config.text_dim, wide)
        self.temporal_decoder_blocks = nn.ModuleList(Layer(config) for _ in range(config.num_layers))
        self.out = nn.Linear(2 * d, 2 * config.input_features)
        self.text_side = text_side

    def forward(self, x: Tensor, t: Tensor, text: Tensor, text_vector: Tensor, mask: Tensor | None = None) -> Tensor:
        """The predicted noise.

        Args:
            x: (B, T, 2F) noised motion of both people, ``[a | b]``, T at most `max_frames`.
            t: (B,) int64 timesteps.
            text: (B, L, C) features of the text tokens.
            text_vector: (B, C) feature of the whole text, which joins the timestep.
            mask: (B, T), nonzero where a frame is real.

        Returns:
            (B, T, 2F)
        """
        mask = torch.ones_like(x[..., :1]) if mask is None else (mask != 0)[..., None].to(x.dtype)
        emb = self.time_embed(timestep_embedding(t, self.config.latent_dim)) + self.text_proj(text_vector)
        first, second = x.chunk(2, dim=-1)
        positions = self.sequence_embedding[: x.shape[1]]
        a, b = self.joint_embed_1(first) + positions, self.joint_embed_2(second) + positions
        for layer in self.temporal_decoder_blocks:
            a, b = layer(a, b, text, emb, mask)
        return self.out(torch.cat([a, b], dim=-1))


TEXT_SIDE = ("text_pre_proj.", "textTransEncoder.", "text_ln.")
TEXT_HEADS = 4
"""Heads of the released text side, as in MotionDiffuse; no shape shows them."""


def _own_names(weights: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Released tensors by the names of :class:`BiGraphDiff`.

    Left out are the frozen CLIP ViT-B/32 (``clip.*``), whose token features :class:`TextSide` takes, and the
    feed-forward of both streams that every released layer holds and never uses (``ffn``).
    """
    names = {}
    for name, tensor in weights.items():
        if name.startswith("clip.") or ".ffn." in name:
            continue
        if name.startswith(TEXT_SIDE):
            name = f"text_side.{name}"
        names[name.replace(".ga.", ".bipartite_graph.").replace("text_proj.0.", "text_proj.")] = tensor
    return names


def from_released(weights: Mapping[str, Tensor], *, num_heads: int) -> BiGraphDiff:
    """The network whose released tensors these are: sizes are read off the shapes; eval mode, float32.

    Raises WeightsError if a tensor is missing, unknown or of another size.
    """
    tensors = Released(_own_names(weights), NETWORK)
    block = "temporal_decoder_blocks.0."
    latent_dim, features = tensors.shape("joint_embed_1.weight")
    embed_dim, text_dim = tensors.shape("text_proj.weight")
    config = BiGraphDiffConfig(
        input_features=features,
        latent_dim=latent_dim,
        ff_size=tensors.shape(f"{block}ffn_1.linear1.weight")[0],
        num_layers=tensors.layers("temporal_decoder_blocks."),
        num_heads=num_heads,
        text_dim=text_dim,
        max_frames=tensors.shape("sequence_embedding")[0],
        num_nodes=tensors.shape(f"{block}bipartite_graph.conv_proj.weight")[0],
        embed_dim=0 if embed_dim == 4 * latent_dim else embed_dim,
    )
    text_side = None
    if any(name.startswith("text_side.") for name in tensors):
        layers = "text_side.textTransEncoder.layers."
        text_side = TextSide(
            clip_dim=tensors.shape("text_side.text_pre_proj.weight")[1],
            text_dim=text_dim,
            ff_size=tensors.shape(f"{layers}0.linear1.weight")[0],
            num_layers=tensors.layers(layers),
            num_heads=TEXT_HEADS,
        )
    return tensors.loaded(BiGraphDiff(config, text_side=text_side))
