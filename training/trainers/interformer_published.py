"""Trains InterFormer as published: ``python -m training.trainers.interformer_published --data DIR --out DIR``.

The network of :mod:`models.interformer` under the thesis' losses (eq. 3.8 and 3.9), on the clips of
:mod:`training.corpus.strict_pairs` at 15 frames a second. Settings switch the parts that Tables 3.4 to 3.7 leave out.
Ours: the scenes are varied as in :mod:`training.trainers.interformer`, and the reactor's past gets noise, as some
hundred clips would otherwise be learned by heart.

Everything random is drawn from the seed and the step number, so a run that stops goes on as if it had not.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from models.interformer import InterFormer, InterFormerConfig, joint_distances, target_mask
from models.interformer.compact import JOINTS_15
from motion import InputError
from training.core.loop import Loop, adamw
from training.core.shell import add_options, add_run_options, chosen, exit_code
from training.corpus.strict_pairs import strict_pairs
from training.trainers.interformer import Batch, collate, masked_mean, varied

Array = NDArray[np.floating]

STRIDE = 2
"""Frames of the recordings, 30 a second, for one of the network."""


@dataclass(frozen=True)
class Settings:
    """The settings of a run; a checkpoint of others is refused.

    Sizes and switches as in :class:`models.interformer.InterFormerConfig`, augmentation as in
    :class:`training.trainers.interformer.Settings`. jitter: metres of noise on the reactor's past.
    """

    num_layers: int = 2
    num_heads: int = 3
    spatial_heads: int = 3
    spatial: bool = True
    adjacency: bool = True
    interaction: bool = True
    ff_size: int = 256
    window: int = 48
    batch: int = 32
    steps: int = 600
    learning_rate: float = 1e-3
    warmup: int = 50
    weight_decay: float = 0.0
    ema: float = 0.98
    jitter: float = 0.02
    crop: float = 0.3
    turn: float = 12.0
    size: float = 0.08
    speed: float = 0.25
    first_frame: float = 1.0
    seed: int = 0


def flat(people: Tensor) -> Tensor:
    """(…, T, J, 3) → (…, T, 45), all x first, then all y, then all z."""
    return people.mT.flatten(-2)


def source_of(actor: Tensor, mask: Tensor) -> tuple[Tensor, Tensor]:
    """The encoder's input: a start frame of zeros, the actor, then ones.

    Args:
        actor: (B, T, J, 3) metres.
        mask: (B, T) bool, true where a frame is real.

    Returns:
        (B, T + 2, 45), and (B, 1, T + 2) bool: true at the start, the real frames and the end.
    """
    ones = actor.new_ones(len(actor), 1, 45)
    shown = torch.where(mask[..., None], flat(actor), 1.0)
    seen = torch.cat([torch.ones_like(mask[:, :2]), mask], dim=1)
    return torch.cat([torch.zeros_like(ones), shown, ones], dim=1), seen[:, None]


class Trainer(Loop):
    """One training run, which resumes from its checkpoint in ``out``.

    Args:
        scenes: (2, T, 22, 3) metres each, 30 fps, canonical; the first person acts.
    """

    def __init__(self, scenes: Sequence[Array], settings: Settings, out: Path) -> None:
        if not scenes:
            raise InputError("There is no training pair: give the folder that holds sbu and k3hi.")
        self.scenes, self.settings, self.out = scenes, settings, out
        torch.manual_seed(settings.seed)
        names = {f.name for f in fields(InterFormerConfig)}
        config = InterFormerConfig(**{k: v for k, v in asdict(settings).items() if k in names})
        self.model, self.ema = InterFormer(config), InterFormer(config).requires_grad_(False).eval()
        self.ema.load_state_dict(self.model.state_dict())
        self.optimizer = adamw(self.model.parameters(), settings)
        self.restore(asdict(settings))

    def batch(self, rng: np.random.Generator) -> Batch:
        """Scenes drawn at random, each in another variation."""
        s = self.settings
        drawn = rng.choice(len(self.scenes), size=s.batch)
        return collate([varied(self.scenes[i], s, rng) for i in drawn])  # type: ignore[arg-type]  # same names

    def terms(self, batch: Batch, generator: torch.Generator) -> dict[str, Tensor]:
        """Both losses of a batch, in squared decimetres."""
        source, seen = source_of(batch.actor, batch.mask)
        true = flat(batch.reactor)
        past = true[:, :-1] + self.settings.jitter * torch.randn(true[:, :-1].shape, generator=generator)
        past[:, 0] = true[:, 0]  # the given pose
        shown = torch.cat([torch.zeros_like(true[:, :1]), past], dim=1)
        frames = shown.shape[1]
        made = self.model(
            source, shown, joint_distances(source[:, :frames], shown), seen, target_mask(frames)
        )
        sequence = masked_mean((made - true).square().sum(-1), batch.mask).mean() / 15
        first = (made[:, 1] - made[:, 0] - true[:, 1] + true[:, 0]).square().sum(-1).mean() / 15
        return {"sequence": 100 * sequence, "first_frame": 100 * self.settings.first_frame * first}

    def train_step(self) -> dict[str, float]:
        """One optimiser step; returns the loss terms."""
        seed = self.settings.seed
        batch = self.batch(np.random.default_rng((seed, 1, self.step)))
        self.model.train()
        terms = self.terms(batch, torch.Generator().manual_seed(seed * 999_983 + self.step))
        total = torch.stack(list(terms.values())).sum()
        self.optimizer_step(total, self.optimizer, self.model.parameters())
        self.ema_update(self.ema.parameters(), self.model.parameters())
        return {name: value.item() for name, value in terms.items()}

    def react(self, pairs: Sequence[Array]) -> list[Array]:
        """Reactions (T / 2, 15, 3) to the actors of recorded pairs (2, T, 22, 3), from the reactors' first poses."""
        batch = collate([pair[:, ::STRIDE] for pair in pairs])
        source, seen = source_of(batch.actor, batch.mask)
        made = self.ema.generate(source, seen, flat(batch.reactor[:, 0]), batch.mask.shape[1] + 1)[:, 1:]
        people = made.unflatten(-1, (3, 15)).mT.numpy()
        lengths = batch.mask.sum(1).tolist()
        return [person[:length] for person, length in zip(people, lengths, strict=True)]


def fifteen_joints(person: Array) -> Array:
    """A recorded person (T, 22, 3) as :meth:`Trainer.react` makes them: (T / 2, 15, 3)."""
    return person[::STRIDE][:, list(JOINTS_15)]


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.trainers.interformer_published")
    add_options(parser, "pairs", "cache")
    add_run_options(parser, Settings)
    options = parser.parse_args(argv)

    def job() -> None:
        pairs = [pair for pair in strict_pairs(options.data, options.cache) if not pair.test]
        trainer = Trainer([pair.positions for pair in pairs], chosen(options, Settings), options.out)
        trainer.run_logged(minutes=options.minutes)

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
