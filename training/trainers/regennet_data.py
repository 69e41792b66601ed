"""Training data of the compact ReGenNet: batches of actor, reactor and words, cut from prepared scenes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import Tensor

from models.intergen.losses import facing
from models.motion_tokens import FEATURES, NUM_CONTACTS, mirror_control
from models.regennet.compact import LEAD, CompactReGenNet
from motion import SMPL22, InputError
from motion.formats.files import replacing
from training.core.precision import mixed_precision
from training.core.text_features import CaptionFeatures
from training.corpus.grammar import mirror_caption
from training.prepare import ROOT_SCALE, Scenes
from training.trainers.intergen_data import balanced, seeded


@dataclass
class Batch:
    """One batch: control points of reactor and actor (B, K, 70) in metres, mask (B, K), words (B, C), and
    whether the scene was cropped (B,)."""

    reactor: Tensor
    actor: Tensor
    mask: Tensor
    words: Tensor
    cropped: Tensor


class Conditions:
    """The condition vector of every caption, worked out once and kept beside the run.

    Args:
        captions: unique sentences.
        conditioner: the frozen conditioner.
        cache: the run's folder.
        digest: names the conditioner's weights.
    """

    def __init__(self, captions: list[str], conditioner: torch.nn.Module, cache: Path, digest: str) -> None:
        self.index = {caption: row for row, caption in enumerate(captions)}
        path = cache / f"conditions_{len(captions)}_{digest[:12]}.safetensors"
        try:
            self.vectors = load_file(path)["conditions"]
        except (OSError, SafetensorError):
            features = CaptionFeatures(captions, cache)
            order = sorted(range(len(captions)), key=lambda row: int(features.lengths[row]))
            self.vectors = torch.zeros(len(captions), conditioner.config.latent_dim, dtype=torch.half)
            with torch.no_grad(), mixed_precision("cpu"):
                for start in range(0, len(order), 256):
                    rows = order[start : start + 256]
                    self.vectors[rows] = conditioner(*features.batch([captions[r] for r in rows])).half()
            with replacing(path) as temporary:
                save_file({"conditions": self.vectors}, temporary)

    def batch(self, captions: list[str]) -> Tensor:
        """(B, C) float32."""
        return self.vectors[[self.index[caption] for caption in captions]].float()


def knot_positions(control: Tensor) -> Tensor:
    """Control points (B, K, 70) → positions at the knots (B, K − 2, 22, 3)."""
    knots = (control[:, :-2] + 4 * control[:, 1:-1] + control[:, 2:]) / 6
    root, others, _ = knots.split([3, FEATURES - 3 - NUM_CONTACTS, NUM_CONTACTS], dim=-1)
    others = others.unflatten(-1, (-1, 3)) + root[..., None, :]
    return torch.cat([root[..., None, :], others], dim=-2)


def seen_rows(control: Tensor) -> Tensor:
    """The actor as each row sees it, not normalised: control points (B, K, 70) → (B, K, 132)."""
    knots = (control[:, :-2] + 4 * control[:, 1:-1] + control[:, 2:]) / 6
    pose = knots[..., : FEATURES - NUM_CONTACTS]
    place = torch.arange(control.shape[1]) - LEAD
    now, before = pose[:, place.clamp_min(0)], pose[:, (place - 1).clamp_min(0)]
    return torch.cat([now, now - before], dim=-1)


def is_recorded(row: dict[str, Any]) -> bool:
    """True if a scene was recorded with both people, and not composed of two recordings."""
    return any(str(source).startswith(("sbu", "k3hi")) for source in row["sources"])


def cropped(people: Tensor, knots: int) -> Tensor:
    """Control points (2, K, 70) without their first ``knots``, in the frame of the actor's new first pose.

    The actor, person 0, stands at the origin of the floor and faces +Z at the first frame.
    """
    people = people[:, knots:]
    first = knot_positions(people[:1, :3])[0, 0]
    ahead = facing(first[None])[0]
    x, z = (ahead / ahead.norm().clamp_min(1e-6))[[0, 2]]
    zero, one = torch.zeros_like(x), torch.ones_like(x)
    turn = torch.stack([z, zero, -x, zero, one, zero, x, zero, z]).view(3, 3)
    pose, contacts = people.split([FEATURES - NUM_CONTACTS, NUM_CONTACTS], dim=-1)
    pose = pose.unflatten(-1, (-1, 3)).clone()
    pose[..., 0, :] -= first[0] * torch.tensor([1.0, 0.0, 1.0])
    return torch.cat([(pose @ turn.T).flatten(-2), contacts], dim=-1)


class Data:
    """Draws batches of similar lengths; batch ``step`` is the same in every run of the same seed.

    Args:
        scenes: what is drawn from.
        size: scenes in a batch.
        crop: share of scenes that begin somewhere in their first half.
        recorded: how often a recorded pair counts.
        seed: of everything random.
    """

    def __init__(self, scenes: Scenes, *, size: int, crop: float, recorded: int, seed: int) -> None:
        self.scenes, self.size, self.crop, self.seed = scenes, size, crop, seed
        self.rows: list[dict[str, Any]] = [
            row for row in balanced(scenes.split("train")) for _ in range(recorded if is_recorded(row) else 1)
        ]
        if len(self.rows) < size:
            raise InputError(f"{len(self.rows)} training scenes do not fill a batch of {size}.")
        self.knots = torch.tensor([row["tokens"] for row in self.rows]) * scenes.layout.knots_per_token
        self.batches_an_epoch = len(self.rows) // size
        self._epoch, self._order = -1, torch.empty(0)

    def captions(self) -> list[str]:
        """All captions that a batch can hold, mirrored ones included, sorted."""
        known = {c for row in self.rows for c in row["captions"]}
        return sorted(known | {mirror_caption(c) for c in known})

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

    def _rows_of(self, step: int) -> Tensor:
        epoch, place = divmod(step, self.batches_an_epoch)
        if epoch != self._epoch:
            generator = seeded(self.seed, 1, epoch)
            by_length = (self.knots + torch.rand(len(self.rows), generator=generator) * 8).argsort()
            spare = len(by_length) % self.size
            keep = torch.randperm(len(by_length), generator=generator)[spare:].sort().values
            groups = by_length[keep].view(self.batches_an_epoch, -1)
            self._order = groups[torch.randperm(len(groups), generator=generator)]
            self._epoch = epoch
        return self._order[place]

    def batch(self, step: int, conditions: Conditions) -> Batch:
        """The batch of a step; the same for the same seed and step."""
        rows = [self.rows[i] for i in self._rows_of(step)]
        draw = torch.rand(len(rows), 4, generator=seeded(self.seed, 2, step))
        longest = max(row["tokens"] for row in rows) * self.scenes.layout.knots_per_token
        longest = -8 * (-longest // 8)  # few shapes: kernels are made for each
        people = torch.zeros(2, len(rows), longest, FEATURES)
        mask = torch.zeros(len(rows), longest)
        captions = []
        for i, row in enumerate(rows):
            one, caption = self.scenes.scene(row), row["captions"][int(draw[i, 0] * len(row["captions"]))]
            if draw[i, 1] < 0.5:
                one, caption = mirror_control(one, SMPL22.mirror), mirror_caption(caption)
            if draw[i, 2] < self.crop:
                one = cropped(one, 1 + int(draw[i, 3] * one.shape[1] / 2))
            people[:, i, : one.shape[1]] = one
            people[:, i, one.shape[1] :] = one[:, -1:]
            mask[i, : one.shape[1]] = 1
            captions.append(caption)
        actor, reactor = people
        crop = draw[:, 2] < self.crop
        return Batch(reactor, actor, mask, conditions.batch(captions), crop)
