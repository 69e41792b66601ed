"""The known parts of a batch, written in one product: :class:`models.known.Hold` for a GPU."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from models.known import Hold
from models.motion_tokens import FEATURES, TokenLayout, pack, unpack


@dataclass
class Held:
    """The moves of a hold for N columns of control points, as tensors of one size.

    A batch of training holds hundreds of different masks. A product for each is right on a CPU, and hundreds of
    tiny kernels on a GPU.

    Attributes:
        features: see :attr:`models.known.Hold.features`; float16.
        at: (N,) the columns, of B·2·70.
        group: (N,) which move is theirs.
        offset: (N, K).
        moves: (G, K, K); zeros where nothing is left of a column.
        layout: frames a knot and knots a token.
    """

    features: Tensor
    at: Tensor
    group: Tensor
    offset: Tensor
    moves: Tensor
    layout: TokenLayout

    @classmethod
    def of(cls, hold: Hold) -> Held:
        """The same as a hold that knows something."""
        knots = hold.groups[0].offset.shape[1]
        return cls(
            hold.features.half(),
            torch.cat([group.at for group in hold.groups]),
            torch.cat([torch.full_like(group.at, i) for i, group in enumerate(hold.groups)]),
            torch.cat([group.offset for group in hold.groups]),
            torch.stack([torch.zeros(knots, knots) if g.move is None else g.move for g in hold.groups]),
            hold.layout,
        )

    def __call__(self, x: Tensor) -> Tensor:
        """x (B, tokens, 2·token_features) with the known part written in."""
        control = unpack(x, self.layout).transpose(2, 3)  # (B, 2, 70, K)
        columns = control.reshape(-1, control.shape[-1])
        # In float32 also under autocast: what is known must be met.
        with torch.autocast(x.device.type, enabled=False):
            kept = torch.bmm(self.moves[self.group], columns[self.at].float()[..., None])[..., 0]
        held = columns.index_copy(0, self.at, (self.offset + kept).to(columns))
        return pack(held.view(-1, 2, FEATURES, control.shape[-1]).transpose(2, 3), self.layout)
