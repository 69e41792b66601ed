"""The compact BiGraphDiff: two people from a class, over spline tokens.

The network of :mod:`models.bigraphdiff` (thesis, chapter 4) at a small size. What differs from the paper: a
row is not a frame but a token of :mod:`models.motion_tokens`; it predicts the clean motion, so that the
regularisers of InterGen can be trained and damped with it, instead of the noise (eq. 4.12); and a class is
a learned vector, which enters where the paper has a text and its only token.

Shapes: B batch, L tokens, F features of a person's token, C condition width.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import torch
from torch import Tensor, nn

from models.bigraphdiff import BiGraphDiff, BiGraphDiffConfig
from models.diffusion import TwoPersonDenoiser
from models.intergen.compact import Touch
from models.motion_tokens import DuetSpace, TokenLayout
from models.weights_io import common


@dataclass(frozen=True)
class CompactBiGraphDiffConfig:
    """Sizes of a :class:`CompactBiGraphDiff`, its classes, and what touches in each.

    labels: names of the classes.
    touches: of each class, the joints that come together; () where nothing does, or () for all.
    max_tokens: of a motion.
    """

    labels: tuple[str, ...] = ()
    touches: tuple[Touch, ...] = ()
    latent_dim: int = 192
    ff_size: int = 512
    num_layers: int = 5
    num_heads: int = 6
    embed_dim: int = 192
    cond_dim: int = 128
    max_tokens: int = 48
    layout: TokenLayout = field(default_factory=TokenLayout)


class LabelDenoiser(TwoPersonDenoiser):
    """BiGraphDiff with one vector for the class, called as InterGen's denoiser is."""

    def __init__(self, config: BiGraphDiffConfig) -> None:
        super().__init__()
        self.network = BiGraphDiff(config)

    def forward(self, x: Tensor, t: Tensor, cond: Tensor, mask: Tensor | None = None) -> Tensor:
        """The predicted clean motion.

        Args:
            x: (B, L, 2F) noised motion of both people.
            t: (B,) int64 timesteps.
            cond: (B, C) vector of the class; zeros leave it out.
            mask: (B, L, 2), nonzero where a token is real.

        Returns:
            (B, L, 2F)
        """
        return self.network(x, t, cond[:, None], cond, None if mask is None else mask[..., 0])

    @property
    def widths(self) -> tuple[int, int]:
        """Widths of x and of a class' vector, see :class:`models.diffusion.TwoPersonDenoiser`."""
        return 2 * self.network.config.input_features, self.network.config.text_dim


class CompactBiGraphDiff(DuetSpace):
    """Denoiser, vectors of the classes and the normaliser of control points."""

    sizes = CompactBiGraphDiffConfig

    def __init__(self, config: CompactBiGraphDiffConfig) -> None:
        super().__init__(config.layout)
        self.config = config
        self.denoiser = LabelDenoiser(
            BiGraphDiffConfig(
                input_features=config.layout.token_features,
                text_dim=config.cond_dim,
                max_frames=config.max_tokens,
                **common(config, BiGraphDiffConfig),
            )
        )
        self.classes = nn.Embedding(len(config.labels), config.cond_dim)

    def condition(self, labels: Sequence[str]) -> Tensor:
        """(N, C) vectors of classes by name; ValueError if one is not known."""
        places = [self.config.labels.index(label) for label in labels]
        return self.classes(torch.tensor(places, device=self.mean.device))

    def touches(self, label: str) -> Touch:
        """The touch of a class; () if nothing touches."""
        return self.config.touches[self.config.labels.index(label)] if self.config.touches else ()
