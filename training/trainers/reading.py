"""An auxiliary task that teaches the text conditioner to read: what does the sentence ask for?

Noise prediction alone teaches words slowly: left and right change few numbers of the motion, late in the
denoising. Linear heads on the condition vector, used in training only, say which family of interaction the
sentence describes, which hand it names for each person, and which actions come first and second.
"""

from __future__ import annotations

from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor, nn

SIDES = ("none", "left", "right", "both")
UNKNOWN = -100
"""The label of a sentence that is not the scene's own."""
_MIRRORED = torch.tensor([0, 2, 1, 3])


class CaptionReader(nn.Module):
    """Heads for family, side of a, side of b, first and second action of a corpus' scenes.

    Args:
        rows: the scenes' rows, see :mod:`training.prepare`; they give the vocabularies.
        width: of the condition vector.
    """

    def __init__(self, rows: list[dict[str, Any]], width: int) -> None:
        super().__init__()
        self.families = sorted({row["family"] for row in rows})
        self.actions = ["none", *sorted({a for row in rows for a in (row["events"] or {}).get("order", ())})]
        sizes = (len(self.families), len(SIDES), len(SIDES), len(self.actions), len(self.actions))
        self.heads = nn.ModuleList(nn.Linear(width, size) for size in sizes)

    def labels(self, row: dict[str, Any], *, mirror: bool) -> Tensor:
        """(5,) what the captions of a scene say, or of its mirror image; :data:`UNKNOWN` leaves one out."""
        events = row["events"] or {}
        sides = torch.tensor([SIDES.index(events.get("side", {}).get(p, "none")) for p in "ab"])
        order = [self.actions.index(a) for a in [*events.get("order", ()), "none", "none"][:2]]
        family = torch.tensor([self.families.index(row["family"])])
        return torch.cat([family, _MIRRORED[sides] if mirror else sides, torch.tensor(order)])

    def forward(self, condition: Tensor, labels: Tensor) -> Tensor:
        """Mean cross-entropy of the heads: condition (B, width), labels (B, 5) → scalar."""
        losses = [
            F.cross_entropy(head(condition.float()), labels[:, i], ignore_index=UNKNOWN, reduction="none")
            for i, head in enumerate(self.heads)
        ]
        return torch.stack(losses).mean()
