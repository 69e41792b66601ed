"""Training data of the compact ReGenNet: scenes of an actor and a reactor, some of which begin late."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch
from torch import Tensor

from models.motion_tokens import FEATURES, NUM_CONTACTS, canonical_control, mirror_control
from models.regennet.compact import LEAD, CompactReGenNet
from motion import SMPL22
from training.prepare import ROOT_SCALE
from training.trainers import intergen_data
from training.trainers.intergen_data import Batch, balanced


def knot_positions(control: Tensor) -> Tensor:
    """Control points (…, K, 70) → positions at the knots (…, K − 2, 22, 3)."""
    knots = (control[..., :-2, :] + 4 * control[..., 1:-1, :] + control[..., 2:, :]) / 6
    root, others, _ = knots.split([3, FEATURES - 3 - NUM_CONTACTS, NUM_CONTACTS], dim=-1)
    others = others.unflatten(-1, (-1, 3)) + root[..., None, :]
    return torch.cat([root[..., None, :], others], dim=-2)


def seen_rows(control: Tensor) -> Tensor:
    """The actor as each row sees it, not normalised: control points (B, K, 70) → (B, K, 132)."""
    knots = (control[..., :-2, :] + 4 * control[..., 1:-1, :] + control[..., 2:, :]) / 6
    pose = knots[..., : FEATURES - NUM_CONTACTS]
    place = torch.arange(control.shape[1]) - LEAD
    now, before = pose[:, place.clamp_min(0)], pose[:, (place - 1).clamp_min(0)]
    return torch.cat([now, now - before], dim=-1)


def is_recorded(row: dict[str, Any]) -> bool:
    """True if a scene was recorded with both people, and not composed of two recordings."""
    return any(str(source).startswith(("sbu", "k3hi")) for source in row["sources"])


class Data(intergen_data.Data):
    """Batches as :mod:`training.trainers.intergen` draws them, with these differences.

    Recorded pairs count ``recorded`` times. Of the words, only those for both people are read. Half of the scenes are
    shown mirrored, since an actor may lead with either hand. A share ``crop`` begins somewhere in their first half;
    ``past`` is 1 for these, as the reactor's first pose is given.
    """

    def weighted(self, rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
        """The rows, each as often as it is drawn."""
        return [row for row in balanced(rows) for _ in range(self.settings.recorded if is_recorded(row) else 1)]

    def known_captions(self) -> set[str]:
        """All captions that a batch may have, but for their mirror images."""
        return {caption for row in self.rows for caption in row["captions"]}

    def sentences(self, row: dict[str, Any], draw: Sequence[float]) -> tuple[list[str], list[bool]]:
        """A scene's sentence, and whether it is read."""
        caption = row["captions"][int(draw[2] * len(row["captions"]))]
        return [caption, "", ""], [draw[0] >= self.settings.cond_drop_prob, False, False]

    def mirrors(self, row: dict[str, Any], text: str, draw: float) -> bool:
        """Whether a scene is shown mirrored."""
        return draw < 0.5

    def continued(self, row: dict[str, Any], draw: Sequence[float]) -> tuple[Tensor, int, str] | None:
        """A scene (2, K, 70) from a knot of its first half on, in the frame of the actor's first pose there."""
        if draw[0] >= self.settings.crop:
            return None
        tokens, per_token = row["tokens"], self.scenes.layout.knots_per_token
        left_out = 1 + int(draw[1] * tokens / 2)
        late = self.scenes.scene(row)[:, left_out * per_token :]
        return canonical_control(late), 1, row["captions"][int(draw[2] * len(row["captions"]))]

    def people(self, batch: Batch) -> tuple[Tensor, Tensor, Tensor]:
        """Actor and reactor (B, K, 70) in metres, each with its last control point held, and mask (B, K)."""
        mask = batch.mask[..., 0].repeat_interleave(self.scenes.layout.knots_per_token, dim=1)
        control = self.control(batch.x0)
        place = torch.arange(mask.shape[1], device=mask.device).minimum(mask.sum(1, keepdim=True).long() - 1)
        actor, reactor = control.gather(2, place[:, None, :, None].expand_as(control)).unbind(1)
        return actor, reactor, mask

    def normalize(self, model: CompactReGenNet) -> None:
        """Sets a model's normalisers to those of the training scenes and their mirror images."""
        reactor, actor = [], []
        for row in self.scenes.split("train"):
            a, b = self.scenes.scene(row)
            for one in (a, mirror_control(a, SMPL22.mirror)):
                actor.append(seen_rows(one[None])[0])
            reactor += [b, mirror_control(b, SMPL22.mirror)]
        for name, values in (("", torch.cat(reactor)), ("actor_", torch.cat(actor))):
            scale = values.std(0).clamp_min(0.01)
            scale[[0, 2]] = scale[[0, 2]].clamp_max(ROOT_SCALE)
            getattr(model, f"{name}mean").copy_(values.mean(0))
            getattr(model, f"{name}std").copy_(scale)
