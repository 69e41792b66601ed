"""Training data of the compact ReGenNet: batches of actor, reactor and words, cut from prepared scenes."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import Tensor

from models.intergen.losses import facing
from models.motion_tokens import FEATURES, NUM_CONTACTS, NUM_JOINTS, mirror_control
from models.regennet.compact import LEAD, CompactReGenNet
from motion import SMPL22, InputError
from motion.formats.files import replacing
from training.corpus.grammar import mirror_caption
from training.prepare import ROOT_SCALE, Scenes
from training.trainers.intergen_data import balanced, seeded
from training.trainers.touch import conditions


@dataclass
class Batch:
    """One batch: control points of reactor and actor (B, K, 70) in metres, mask (B, K), words (B, C), whether
    the scene was cropped (B,), and its real rows (B,), these on the CPU."""

    reactor: Tensor
    actor: Tensor
    mask: Tensor
    words: Tensor
    cropped: Tensor
    rows: Tensor


class Conditions:
    """The condition vector of every caption, worked out once and kept beside the run.

    Args:
        captions: unique sentences.
        conditioner: the frozen conditioner.
        cache: the run's folder.
        digest: names the conditioner's weights.
        device: where the encoder runs and the vectors stay.
    """

    def __init__(
        self, captions: list[str], conditioner: torch.nn.Module, cache: Path, digest: str, *, device: str = "cpu"
    ) -> None:
        named = hashlib.sha256("\n".join([digest, *captions]).encode()).hexdigest()[:16]
        path = cache / f"conditions_{named}.safetensors"
        try:
            vectors = load_file(path)["conditions"]
        except (OSError, SafetensorError):
            vectors = conditions(conditioner, captions, device=device).half().cpu()
            with replacing(path) as temporary:
                save_file({"conditions": vectors}, temporary)
        self.vectors = vectors.to(device)

    def batch(self, places: Tensor) -> Tensor:
        """The vectors (B, C) float32 of captions by their places (B,) in the list."""
        return self.vectors[places.to(self.vectors.device)].float()


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


def at_the_origin(people: Tensor) -> Tensor:
    """Control points (…, 2, K, 70) in the frame of the actor's first pose.

    The actor, person 0, stands at the origin of the floor and faces +Z at the first frame.
    """
    first = knot_positions(people[..., 0, :3, :])[..., 0, :, :]
    x, _, z = (facing(first)).unbind(-1)
    zero, one = torch.zeros_like(x), torch.ones_like(x)
    turn = torch.stack([z, zero, -x, zero, one, zero, x, zero, z], dim=-1).unflatten(-1, (3, 3))
    pose, contacts = people.split([FEATURES - NUM_CONTACTS, NUM_CONTACTS], dim=-1)
    root, others = pose.unflatten(-1, (-1, 3)).split([1, NUM_JOINTS - 1], dim=-2)
    origin = first[..., 0, :] * first.new_tensor([1.0, 0.0, 1.0])
    root = root - origin[..., None, None, None, :]
    turned = torch.cat([root, others], dim=-2) @ turn.mT[..., None, None, :, :]
    return torch.cat([turned.flatten(-2), contacts], dim=-1)


class Data:
    """Draws batches of similar lengths; batch ``step`` is the same in every run of the same seed.

    Args:
        scenes: what is drawn from.
        size: scenes in a batch.
        crop: share of scenes that begin somewhere in their first half.
        recorded: how often a recorded pair counts.
        seed: of everything random.
        device: holds all scenes and puts the batches together, so no batch is copied or waited for.
    """

    def __init__(
        self, scenes: Scenes, *, size: int, crop: float, recorded: int, seed: int, device: str = "cpu"
    ) -> None:
        self.scenes, self.size, self.crop, self.seed, self.device = scenes, size, crop, seed, device
        self.rows: list[dict[str, Any]] = [
            row for row in balanced(scenes.split("train")) for _ in range(recorded if is_recorded(row) else 1)
        ]
        if len(self.rows) < size:
            raise InputError(f"{len(self.rows)} training scenes do not fill a batch of {size}.")
        self.knots = torch.tensor([row["tokens"] for row in self.rows]) * scenes.layout.knots_per_token
        self.starts = torch.tensor([row["start"] for row in self.rows])
        self.control = scenes.control.to(device)
        index = {caption: place for place, caption in enumerate(self.captions())}
        captions = [row["captions"] for row in self.rows]
        self.caption_counts = torch.tensor([len(own) for own in captions])
        self.first_captions = self.caption_counts.cumsum(0) - self.caption_counts
        # By place in all rows' captions, one after the other: the caption, and that of the mirror image.
        self.words = torch.tensor([index[c] for own in captions for c in own])
        mirrored = torch.tensor([index[mirror_caption(c)] for c in index])
        self.mirrored_words = mirrored[self.words]
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

    def batch(self, step: int, known: Conditions) -> Batch:
        """The batch of a step; the same for the same seed and step.

        Args:
            known: of :meth:`captions`, in their order.
        """
        chosen = self._rows_of(step)
        knots = self.knots[chosen]
        draw = torch.rand(len(chosen), 4, generator=seeded(self.seed, 2, step))
        mirror, crop = draw[:, 1] < 0.5, draw[:, 2] < self.crop
        left_out = torch.where(crop, 1 + (draw[:, 3] * knots / 2).long(), 0)
        longest = -8 * (-int(knots.max()) // 8)  # few shapes: kernels are made for each
        place = left_out[:, None] + torch.arange(longest)
        mask = (place < knots[:, None]).float()
        where = self.starts[chosen, None] + place.minimum(knots[:, None] - 1)
        caption = self.first_captions[chosen] + (draw[:, 0] * self.caption_counts[chosen]).long()
        words = torch.where(mirror, self.mirrored_words[caption], self.words[caption])

        people = self.control[where.to(self.device)].float().transpose(1, 2)
        flipped, begun = (flag.to(self.device)[:, None, None, None] for flag in (mirror, crop))
        people = torch.where(flipped, mirror_control(people, SMPL22.mirror), people)
        people = torch.where(begun, at_the_origin(people), people)
        actor, reactor = people.unbind(1)
        return Batch(reactor, actor, mask.to(self.device), known.batch(words), crop.to(self.device), knots - left_out)
