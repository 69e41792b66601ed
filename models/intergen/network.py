"""InterGen's denoiser: two cooperative transformers of shared weights.

Liang et al., "InterGen: Diffusion-based Multi-human Motion Generation under Complex Interactions",
section 4.2, eq. 8–10. Predicts the clean motion x0 of both people from their noised motion, the
timestep and a text vector.

Shapes: B batch, T tokens in time, F features a person and token, C text width, d latent width.
``x`` (B, T, 2F) is ``[a | b]``; inside, states are (2, B, T, d), so both people go through every layer
as one batch and the counterpart of each is a flip of the first axis.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from models.diffusion import TwoPersonDenoiser
from models.layers import FeedForward, TimestepEmbedding, sinusoids
from models.released import Released

NETWORK = "InterGen"
RELEASED_HEADS = 8


@dataclass(frozen=True)
class InterGenConfig:
    """The sizes of an `InterGenDenoiser`; the defaults are the released ones.

    input_features: numbers a person and token (262 in the paper's representation).
    cond_dim: width of the text vector.
    dropout: applied in attention and the feed-forward layers while training; the released weights were
        trained with 0.1, and it holds no weights.
    """

    input_features: int = 262
    latent_dim: int = 1024
    ff_size: int = 2048
    num_layers: int = 8
    num_heads: int = 8
    cond_dim: int = 768
    dropout: float = 0.0


class AdaLayerNorm(nn.Module):
    """LayerNorm whose scale and shift come from the timestep and text embedding; identity at the start."""

    def __init__(self, latent_dim: int) -> None:
        super().__init__()
        linear = nn.Linear(latent_dim, 2 * latent_dim)
        nn.init.zeros_(linear.weight)
        nn.init.zeros_(linear.bias)
        self.emb_layers = nn.Sequential(nn.SiLU(), linear)

    def forward(self, h: Tensor, emb: Tensor) -> Tensor:
        """h (2, B, T, d), emb (B, d) or, one for each person, (2, B, d) → (2, B, T, d)."""
        scale, shift = self.emb_layers(emb)[..., None, :].chunk(2, dim=-1)
        return F.layer_norm(h, h.shape[-1:], eps=1e-6) * (1 + scale) + shift


def attend(q: Tensor, k: Tensor, v: Tensor, keep: Tensor | None, *, num_heads: int, dropout: float = 0.0) -> Tensor:
    """Attention of several heads in which a query may attend to nothing: one all-zero key and value is appended.

    Args:
        q: (N, T, d) queries.
        k, v: (N, S, d) keys and values.
        keep: (N, S) bool, true where a key may be attended to; None for all.

    Returns:
        (N, T, d), the heads side by side.
    """
    n, _, d = q.shape
    # Under autocast a CPU would attend in bfloat16, which takes longer for sequences this short.
    with torch.autocast("cpu", enabled=False):
        if q.is_cpu:
            q, k, v = q.float(), k.float(), v.float()
        k, v = F.pad(k, (0, 0, 0, 1)), F.pad(v, (0, 0, 0, 1))
        q, k, v = (x.view(n, -1, num_heads, d // num_heads).transpose(1, 2) for x in (q, k, v))
        mask = None if keep is None else F.pad(keep, (0, 1), value=True)[:, None, None]
        out = F.scaled_dot_product_attention(q, k, v, attn_mask=mask, dropout_p=dropout)
    return out.transpose(1, 2).reshape(n, -1, d)


class ZeroAttention(nn.MultiheadAttention):
    """`nn.MultiheadAttention(add_zero_attn=True)` by its weights, run by :func:`attend`."""

    def __init__(self, latent_dim: int, num_heads: int, dropout: float) -> None:
        super().__init__(latent_dim, num_heads, dropout=dropout, batch_first=True, add_zero_attn=True)

    def forward(  # type: ignore[override]  # its weights, asked for less
        self, query: Tensor, source: Tensor, keep: Tensor | None
    ) -> Tensor:
        """query (N, T, d), source (N, S, d) for keys and values, keep (N, S) bool or None → (N, T, d)."""
        d = query.shape[-1]
        if query is source:
            q, k, v = F.linear(query, self.in_proj_weight, self.in_proj_bias).chunk(3, dim=-1)
        else:
            q = F.linear(query, self.in_proj_weight[:d], self.in_proj_bias[:d])
            k, v = F.linear(source, self.in_proj_weight[d:], self.in_proj_bias[d:]).chunk(2, dim=-1)
        dropout = self.dropout if self.training else 0.0
        return self.out_proj(attend(q, k, v, keep, num_heads=self.num_heads, dropout=dropout))


class AttentionBlock(nn.Module):
    """Attention of each person to themselves (eq. 9) or, if mutual, to the other's states a layer before (eq. 10)."""

    def __init__(self, config: InterGenConfig, *, mutual: bool = False) -> None:
        super().__init__()
        self.norm = AdaLayerNorm(config.latent_dim)
        if mutual:
            self.xf_norm = AdaLayerNorm(config.latent_dim)
        self.attention = ZeroAttention(config.latent_dim, config.num_heads, config.dropout)

    def forward(self, h: Tensor, emb: Tensor, keep: Tensor | None, previous: Tensor | None = None) -> Tensor:
        """Both people's states h (2, B, T, d), conditioned on emb; ``keep`` masks padding. Same shape out.

        With ``previous``, states of the same shape, each person attends to the other's.
        """
        query = self.norm(h, emb).flatten(0, 1)
        source = query if previous is None else self.xf_norm(previous.flip(0), emb).flatten(0, 1)
        return self.attention(query, source, keep).view_as(h)


class AdaFeedForward(FeedForward):
    """The feed-forward layer behind its own AdaLN; zero at the start of training."""

    def __init__(self, config: InterGenConfig) -> None:
        super().__init__(config.latent_dim, config.ff_size, dropout=config.dropout)
        self.norm = AdaLayerNorm(config.latent_dim)
        nn.init.zeros_(self.linear2.weight)
        nn.init.zeros_(self.linear2.bias)

    def forward(self, h: Tensor, emb: Tensor) -> Tensor:  # type: ignore[override]  # one more input
        """h (2, B, T, d), conditioned on emb → the same shape."""
        return super().forward(self.norm(h, emb))


class Block(nn.Module):
    """Self-attention, mutual attention, feed-forward, each with a residual."""

    def __init__(self, config: InterGenConfig) -> None:
        super().__init__()
        self.sa_block = AttentionBlock(config)
        self.ca_block = AttentionBlock(config, mutual=True)
        self.ffn = AdaFeedForward(config)

    def heard(self, h: Tensor, *text: Tensor) -> Tensor:
        """States h (2, B, T, d) behind self-attention, with what the block reads of a text; this one reads none."""
        return h

    def forward(self, h: Tensor, emb: Tensor, keep: Tensor | None, keep_other: Tensor | None, *text: Tensor) -> Tensor:
        """h (2, B, T, d) → the same shape; ``keep`` masks a person's padding, ``keep_other`` the other's."""
        attended = self.heard(h + self.sa_block(h, emb, keep), *text)
        attended = attended + self.ca_block(attended, emb, keep_other, h)
        return attended + self.ffn(attended, emb)


def padding(mask: Tensor | None) -> tuple[Tensor | None, Tensor | None]:
    """The tokens that each person's own and the other's queries attend to: (B, T, 2) → (2B, T) bool, twice."""
    if mask is None:
        return None, None
    real = (mask != 0).permute(2, 0, 1)  # (2, B, T)
    return real.flatten(0, 1), real.flip(0).flatten(0, 1)


class InterGenDenoiser(TwoPersonDenoiser):
    """D_θ of eq. 8 for both people at once. It is symmetric: swapping the people swaps the outputs (eq. 5)."""

    def __init__(self, config: InterGenConfig) -> None:
        super().__init__()
        self.config = config
        d = config.latent_dim
        self.embed_timestep = TimestepEmbedding(d)
        self.motion_embed = nn.Linear(config.input_features, d)
        self.text_embed = nn.Linear(config.cond_dim, d)
        self.blocks = nn.ModuleList(Block(config) for _ in range(config.num_layers))
        linear = nn.Linear(d, config.input_features)  # back to the features, zero at the start of training
        nn.init.zeros_(linear.weight)
        nn.init.zeros_(linear.bias)
        self.out = nn.Sequential(OrderedDict(linear=linear))

    def embed(self, t: Tensor, cond: Tensor) -> Tensor:
        """The embedding for AdaLN of timesteps (B,) and text (B, C): (B, d)."""
        return self.embed_timestep(t) + self.text_embed(cond)

    def embed_motion(self, people: Tensor) -> Tensor:
        """States of both people's tokens before the first block: (2, B, T, F) → (2, B, T, d)."""
        return self.motion_embed(people) + sinusoids(people.shape[2], self.config.latent_dim, device=people.device)

    def forward(self, x: Tensor, t: Tensor, cond: Tensor, mask: Tensor | None = None) -> Tensor:
        """The predicted clean motion.

        Args:
            x: (B, T, 2F) noised motion of both people, ``[a | b]``.
            t: (B,) int64 timesteps.
            cond: (B, C) text vectors; zeros for the unconditional prediction.
            mask: (B, T, 2), nonzero where a person's token is real; padding is not attended to.

        Returns:
            (B, T, 2F); what stands at padded tokens means nothing.
        """
        b, length, _ = x.shape
        people = x.view(b, length, 2, -1).permute(2, 0, 1, 3)  # (2, B, T, F)
        emb = self.embed(t, cond)
        h = self.embed_motion(people)
        keep, keep_other = padding(mask)
        for block in self.blocks:
            h = block(h, emb, keep, keep_other)
        return self.out(h).permute(1, 2, 0, 3).reshape(b, length, -1)

    @property
    def widths(self) -> tuple[int, int]:
        """Widths of x and of the text vector, see :class:`models.diffusion.TwoPersonDenoiser`."""
        return 2 * self.config.input_features, self.config.cond_dim


def from_released(weights: Mapping[str, Tensor], *, num_heads: int) -> InterGenDenoiser:
    """The network whose released tensors these are: sizes are read off the shapes; eval mode, float32.

    Raises WeightsError if a tensor is missing, unknown or of another size.
    """
    tensors = Released(weights, NETWORK)
    latent_dim, input_features = tensors.shape("motion_embed.weight")
    config = InterGenConfig(
        input_features=input_features,
        latent_dim=latent_dim,
        ff_size=tensors.shape("blocks.0.ffn.linear1.weight")[0],
        num_layers=tensors.layers("blocks."),
        num_heads=num_heads,
        cond_dim=tensors.shape("text_embed.weight")[1],
    )
    return tensors.loaded(InterGenDenoiser(config))
