"""InterGen's denoiser grown: it reads words, one sentence for both people and one for each, and sees what is known.

The parts of :class:`models.intergen.InterGenDenoiser` stay as they are. New are a vector for each person, attention to
the words' features in every block, the vectors of each person's own sentence in AdaLN, and an embedding of the known
part of the motion (:mod:`models.known`) and of a draft: poses that the motion should follow without being held to them.
The parts that read begin at zero.

Shapes: B batch, T tokens in time, F features a person and token, R rows a sentence (its vector, then a word each),
C text width, d latent width; the text of a motion is (B, 3, R, C): the sentence for both people, for a, for b.
A row of zeros is padding, and a sentence of zeros is missing.
"""

from __future__ import annotations

import math

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from models.diffusion import classifier_free
from models.known import KNOWN_FEATURES
from models.motion_tokens import FEATURES

from .network import Block, InterGenConfig, InterGenDenoiser, attend, padding


class WordAttention(nn.Module):
    """Attention of each person's tokens to rows of text; nothing at the start of training."""

    def __init__(self, config: InterGenConfig) -> None:
        super().__init__()
        d = config.latent_dim
        self.num_heads, self.dropout = config.num_heads, config.dropout
        self.norm = nn.LayerNorm(d)
        self.query = nn.Linear(d, d)
        self.source = nn.Linear(config.cond_dim, 2 * d)
        self.out = nn.Linear(d, d)
        nn.init.zeros_(self.out.weight)
        nn.init.zeros_(self.out.bias)

    def forward(self, h: Tensor, text: Tensor, keep: Tensor) -> Tensor:
        """h (2, B, T, d), text (2B, S, C), keep (2B, S) bool, true where a row is real → (2, B, T, d)."""
        q = self.query(self.norm(h)).flatten(0, 1)
        k, v = self.source(text).chunk(2, dim=-1)
        dropout = self.dropout if self.training else 0.0
        return self.out(attend(q, k, v, keep, num_heads=self.num_heads, dropout=dropout)).view_as(h)


class WordBlock(Block):
    """InterGen's block with attention to the words between self-attention and mutual attention."""

    def __init__(self, config: InterGenConfig) -> None:
        super().__init__(config)
        self.words = WordAttention(config)

    def heard(self, h: Tensor, *text: Tensor) -> Tensor:
        """As `Block.heard`, of the text (2B, S, C) and its real rows (2B, S)."""
        return h + self.words(h, *text)


class Draft(nn.Module):
    """The way of a draft into the network: into the first states, and past all blocks into the prediction.

    The second way is opened by the timestep: the noisier the motion, the more of the draft is worth keeping. Both ways
    give nothing at the start of training.

    Args:
        features: numbers a person and token, as of what is known.
        config: sizes of the network.
    """

    def __init__(self, features: int, config: InterGenConfig) -> None:
        super().__init__()
        d = config.latent_dim
        self.read = nn.Linear(2 * features, d)
        self.near = nn.Conv1d(d, d, 3, padding=1)
        self.into = nn.Linear(d, d, bias=False)
        self.past = nn.Linear(d, config.input_features, bias=False)
        self.gate = nn.Linear(d, config.input_features)
        nn.init.zeros_(self.into.weight)
        nn.init.zeros_(self.past.weight)
        nn.init.zeros_(self.gate.weight)
        nn.init.ones_(self.gate.bias)

    def forward(self, people: Tensor, emb: Tensor) -> tuple[Tensor, Tensor]:
        """Both people's drafts (2, B, T, features) and emb (2, B, d) → what is added to states and prediction."""
        own = F.gelu(self.read(torch.cat([people, people.flip(0)], -1)))
        near = self.near(own.flatten(0, 1).transpose(1, 2)).transpose(1, 2).view_as(own)
        seen = (own + F.gelu(near)) * (people != 0).flatten(2).any(-1).any(0)[:, None, None]
        return self.into(seen), self.past(seen) * self.gate(emb)[:, :, None]


class WordDenoiser(InterGenDenoiser):
    """The grown denoiser.

    Args:
        config: sizes; its text width is that of a row of text.
        known_features: numbers a person and token by which the network sees what is known, and as many of a draft.
    """

    def __init__(self, config: InterGenConfig, known_features: int) -> None:
        super().__init__(config)
        d = config.latent_dim
        # What tells the actor from the reactor: a vector of each, and a part of the text with opposite signs.
        self.role_embedding = nn.Parameter(torch.randn(2, d) / math.sqrt(d))
        self.role_text = nn.Linear(config.cond_dim, d, bias=False)
        nn.init.zeros_(self.role_text.weight)
        self.blocks = nn.ModuleList(WordBlock(config) for _ in range(config.num_layers))
        self.sentence_kinds = nn.Parameter(0.02 * torch.randn(3, config.cond_dim))  # both, own, the other's
        self.person_text = nn.Linear(2 * config.cond_dim, d, bias=False)
        self.known_embed = nn.Linear(known_features, d, bias=False)
        nn.init.zeros_(self.person_text.weight)
        nn.init.zeros_(self.known_embed.weight)
        self.draft = Draft(known_features, config)
        self.seen_features = 2 * known_features

    def forward(
        self, x: Tensor, t: Tensor, cond: Tensor, mask: Tensor | None = None, known: Tensor | None = None
    ) -> Tensor:
        """The predicted clean motion.

        Args:
            x: (B, T, 2F) noised motion of both people, ``[a | b]``; what is known is clean in it.
            t: (B,) int64 timesteps.
            cond: (B, 3, R, C) text; zeros for the unconditional prediction.
            mask: (B, T, 2), nonzero where a person's token is real; padding is not attended to.
            known: (B, T, 2·seen_features), for each person :meth:`models.known.Known.features` of what is known and of
                the draft; None if there is neither.

        Returns:
            (B, T, 2F); what stands at padded tokens means nothing.
        """
        b, length, _ = x.shape
        emb = self.embed(t, cond)
        h = self.embed_motion(x.view(b, length, 2, -1).permute(2, 0, 1, 3))
        followed: Tensor | float = 0.0
        if known is not None:
            seen = known.view(b, length, 2, -1).permute(2, 0, 1, 3)
            width = self.known_embed.in_features
            into, followed = self.draft(seen[..., width:], emb)
            h = h + self.known_embed(seen[..., :width]) + into
        text = self.text_of_each(cond)
        keep, keep_other = padding(mask)
        for block in self.blocks:
            h = block(h, emb, keep, keep_other, *text)
        return (self.out(h) + followed).permute(1, 2, 0, 3).reshape(b, length, -1)

    def guided(self, x: Tensor, t: Tensor, cond: Tensor, known: Tensor | None = None, *, scale: float = 3.5) -> Tensor:
        """As `TwoPersonDenoiser.guided`, and less on what a draft says; ``known`` may have one row."""
        if known is None:
            return super().guided(x, t, cond, scale=scale)
        known = known.expand(len(x), -1, -1)
        width = self.known_embed.in_features
        draft = known.unflatten(-1, (2, -1))[..., width:].unflatten(-1, (-1, KNOWN_FEATURES))
        drafted = (draft[..., FEATURES : 2 * FEATURES] > 0).flatten(2)  # the masks, see Known.features

        def predict(x: Tensor, t: Tensor, known: Tensor, cond: Tensor) -> Tensor:
            return self(x, t, cond, known=known)

        return classifier_free(predict, x, t, known, cond=cond, scale=scale, drafted=drafted)

    @property
    def varying(self) -> dict[str, tuple[int, ...]]:
        """See :class:`models.diffusion.TwoPersonDenoiser`."""
        return super().varying | {"cond": (0, 2), "known": (0, 1)}

    def filled(
        self, x: Tensor, t: Tensor, cond: Tensor, mask: Tensor | None = None, known: Tensor | None = None
    ) -> tuple[Tensor, ...]:
        """See :class:`models.diffusion.TwoPersonDenoiser`; zeros say that nothing is known."""
        real = torch.ones(*x.shape[:2], 2, dtype=torch.bool) if mask is None else mask != 0
        return x, t, cond, real, x.new_zeros(*x.shape[:2], 2 * self.seen_features) if known is None else known

    def example(self) -> tuple[Tensor, ...]:
        """See :class:`models.diffusion.TwoPersonDenoiser`: the second motion has no words for each and less known."""
        x, t, cond, mask = super().example()
        draw = torch.Generator().manual_seed(1)
        cond = torch.randn(2, 3, 4, cond.shape[1], generator=draw)
        cond[1, 1:] = 0
        known = torch.randn(2, x.shape[1], 2 * self.seen_features, generator=draw)
        known[1, 3:] = 0
        return x, t, cond, mask, known

    def embed(self, t: Tensor, cond: Tensor) -> Tensor:
        """The embedding for AdaLN of timesteps (B,) and the sentences' vectors in text (B, 3, R, C): (2, B, d)."""
        both, a, b = cond[:, :, 0].unbind(1)
        emb, role = super().embed(t, both), self.role_text(both)
        own = self.person_text(torch.stack([torch.cat([a, b], -1), torch.cat([b, a], -1)]))
        return torch.stack([emb + role, emb - role]) + own

    def embed_motion(self, people: Tensor) -> Tensor:
        """See `InterGenDenoiser.embed_motion`."""
        return super().embed_motion(people) + self.role_embedding[:, None, None]

    def text_of_each(self, cond: Tensor) -> tuple[Tensor, Tensor]:
        """Text (B, 3, R, C) as a and as b reads it, (2B, S, C), and which of the S rows are real, (2B, S).

        S is 3R. In training it is the most that a motion has, so that missing sentences cost nothing.
        """
        real = (cond != 0).any(-1).flatten(1)
        kinds = torch.stack([self.sentence_kinds, self.sentence_kinds[[0, 2, 1]]])  # (2, 3, C)
        text = (cond[None] + kinds[:, None, :, None]).flatten(2, 3)
        if self.training:
            first = real.float().argsort(dim=1, descending=True, stable=True)[:, : max(1, int(real.sum(1).max()))]
            text = text.gather(2, first[None, :, :, None].expand(2, -1, -1, text.shape[-1]))
            real = real.gather(1, first)
        return text.flatten(0, 1), real.repeat(2, 1)
