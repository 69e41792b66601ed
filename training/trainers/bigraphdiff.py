"""Trains the compact BiGraphDiff: ``python -m training.trainers.bigraphdiff --scenes FILE --out DIR``.

Chopin's thesis, chapter 4, on the scenes of :mod:`training.prepare`: what a scene shows by its label
is its class. The loss is that of :mod:`training.trainers.intergen` (x0 prediction and InterGen's damped regularisers),
where the thesis has the noise's alone (eq. 4.12). A scene in which one hand leads is shown right-handed, as a
class names no side; the others are mirrored half of the time.
"""

from __future__ import annotations

import argparse
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from models.bigraphdiff.compact import CompactBiGraphDiff, CompactBiGraphDiffConfig
from models.intergen.compact import Touch
from models.intergen.losses import LossWeights
from models.weights_io import common, save_network
from motion import InputError
from training.core.loop import mixed_precision
from training.core.shell import train
from training.corpus.cues import class_of
from training.prepare import Scenes, load
from training.trainers.intergen_data import OneSentence
from training.trainers.intergen_data import Settings as InterGenSettings
from training.trainers.scenes import Drawn, DuetTrainer
from training.trainers.touch import touch_of

SUMMARY = (
    "BiGraphDiff (Chopin et al.) at width 192 over spline tokens: two people from a class. Research and "
    "non-commercial use only."
)
"""Summary of the weights on the page."""
COMMON = 0.4
"""Share of a class's scenes in which a touch must occur to be the class's."""


@dataclass(frozen=True)
class Settings:
    """The settings of a run; a checkpoint of others is refused. Named as in training.trainers.intergen_data."""

    latent_dim: int = 192
    ff_size: int = 512
    num_layers: int = 5
    num_heads: int = 6
    embed_dim: int = 192
    cond_dim: int = 128
    batch: int = 32
    steps: int = 8000
    learning_rate: float = 6e-4
    warmup: int = 200
    weight_decay: float = 1e-4
    ema: float = 0.998
    cond_drop_prob: float = 0.1
    root_weight: float = 4.0
    t_bar: float = 0.7
    noisiest: float = 0.4
    seed: int = 0
    weights: LossWeights = field(default_factory=lambda: InterGenSettings().weights)

    def __post_init__(self) -> None:
        if self.latent_dim % 16 or self.latent_dim % self.num_heads:
            raise InputError(f"latent_dim {self.latent_dim} must be a multiple of 16 and of {self.num_heads} heads.")


def of_classes(scenes: Scenes) -> Scenes:
    """The scenes that are of one class: labelled, with one beat at most, transitions not counted.

    Raises:
        InputError: if there are none.
    """
    rows = [
        row
        for row in scenes.rows
        if row.get("label") and sum(not beat["minor"] for beat in row.get("beats") or ()) <= 1
    ]
    if not rows:
        raise InputError(
            "No scene has a label of one class (those of InterHuman and of older corpora have none): build the "
            "corpus anew with `python -m training.corpus`."
        )
    return Scenes(scenes.control, rows, scenes.layout)


def labels_of(scenes: Scenes) -> tuple[tuple[str, ...], tuple[Touch, ...]]:
    """Names of the classes in the training split, in alphabetical order, and the touch of each."""
    counts: dict[str, Counter[Touch]] = {}
    for row in scenes.split("train"):
        touch = touch_of(row, mirror=row.get("hand") == "left")
        counts.setdefault(class_of(row), Counter())[touch] += 1
    touches = []
    for name in sorted(counts):
        touch, count = counts[name].most_common(1)[0]
        touches.append(touch if count >= COMMON * counts[name].total() else ())
    return tuple(sorted(counts)), tuple(touches)


class Data(OneSentence):
    """Batches as :mod:`training.trainers.intergen` draws them, conditioned on their class."""

    def __init__(self, scenes: Scenes, settings: Settings, device: str) -> None:
        super().__init__(scenes, settings, Path(), device, captions=False)
        self.names, self.touches = labels_of(scenes)

    def caption(self, row: dict[str, Any], draw: float) -> str:
        """The class as the joint condition."""
        return class_of(row)

    def features(self, captions: list[str]) -> tuple[Tensor, Tensor]:
        """(B,) places of the classes; all count."""
        places = torch.tensor([self.names.index(caption) for caption in captions])
        return places, torch.ones_like(places)


class Trainer(DuetTrainer):
    """One training run, which resumes from its checkpoint in ``out``."""

    def __init__(self, scenes: Scenes, settings: Settings, out: Path, *, device: str = "cpu") -> None:
        torch.manual_seed(settings.seed)
        data = Data(of_classes(scenes), settings, device)
        self.begin(settings, out, data, device)
        sizes = common(settings, CompactBiGraphDiffConfig)
        config = CompactBiGraphDiffConfig(data.names, data.touches, **sizes, layout=scenes.layout)
        model = CompactBiGraphDiff(config)
        model.mean.copy_(data.mean)
        model.std.copy_(data.std)
        self.start(model, device)

    def terms(self, drawn: Drawn, noise: Tensor) -> dict[str, Tensor]:
        """Every loss term of what was drawn, weighted."""
        batch, t = drawn.batch, drawn.t
        xt = self.schedule.q_sample(batch.x0, t, noise)
        with mixed_precision(self.device):
            predicted = self.model.denoiser(xt, t, self.model.classes(batch.text) * batch.read[:, :1], batch.mask)
        return self.motion_terms(predicted.float(), batch.x0, t, batch)

    def export(self, folder: Path) -> None:
        """Writes the averaged network as it is shipped."""
        save_network(folder, self.ema, card={"summary": SUMMARY}, trained_steps=self.step)


def _begin(options: argparse.Namespace, settings: Settings) -> Trainer:
    return Trainer(load(options.scenes), settings, options.out, device=options.device)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    return train(argv, __doc__, Settings, _begin, "scenes", "device", "export", leave_out=("weights",))


if __name__ == "__main__":
    raise SystemExit(main())
