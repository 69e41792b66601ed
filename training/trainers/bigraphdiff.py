"""Trains the compact BiGraphDiff: ``python -m training.trainers.bigraphdiff --scenes FILE --out DIR``.

Chopin's thesis, chapter 4, on the scenes of :mod:`training.prepare`: what a scene shows by its label
is its class. The loss is that of :mod:`training.trainers.intergen` (x0 prediction and InterGen's damped regularisers),
where the thesis has the noise's alone (eq. 4.12). A scene in which one hand leads is shown right-handed, as a
class names no side; the others are mirrored half of the time.

Everything random is drawn from the seed and the step number, so a run that stops goes on as if it had not.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from models.bigraphdiff.compact import CompactBiGraphDiff, CompactBiGraphDiffConfig
from models.diffusion import NoiseSchedule
from models.intergen.compact import Touch
from models.intergen.losses import InterGenLoss, LossWeights, simple_loss
from models.motion_tokens import FEATURES
from models.weights_io import save_network
from motion import InputError
from training.core.ahead import moved
from training.core.loop import Loop, adamw
from training.core.precision import mixed_precision
from training.core.shell import add_options, add_run_options, chosen, exit_code
from training.corpus.cues import class_of
from training.prepare import Scenes, load
from training.trainers import intergen_data
from training.trainers.intergen import draw_timesteps
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
    """The settings of a run; a checkpoint of others is refused. Named as in training.trainers.intergen.

    graph: see :class:`models.bigraphdiff.BiGraphDiffConfig`. diffusion: if false, the network makes the motion from
    its class alone and in one pass, S1 of the thesis' Table 4.6.
    """

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
    graph: str = "bipartite"
    diffusion: bool = True
    seed: int = 0
    weights: LossWeights = field(default_factory=lambda: intergen_data.Settings().weights)

    def __post_init__(self) -> None:
        if self.latent_dim % 16 or self.latent_dim % self.num_heads:
            raise InputError(f"latent_dim {self.latent_dim} must be a multiple of 16 and of {self.num_heads} heads.")
        if self.graph not in ("bipartite", "simple", "none"):
            raise InputError(f"graph is {self.graph!r:.40}: give bipartite, simple or none.")


def of_classes(scenes: Scenes) -> Scenes:
    """The scenes that are of one class: labelled, with one beat at most, transitions not counted.

    Raises:
        InputError: if there are none.
    """
    rows = [
        row
        for row in scenes.rows
        if (row.get("label") or row.get("class")) and sum(not beat["minor"] for beat in row.get("beats") or ()) <= 1
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


class Data(intergen_data.Data):
    """Batches as :mod:`training.trainers.intergen` draws them, conditioned on their class."""

    def __init__(self, scenes: Scenes, settings: Settings, device: str) -> None:
        super().__init__(scenes, settings, Path(), device, captions=False)  # type: ignore[arg-type]  # of the same names
        self.names, self.touches = labels_of(scenes)

    def sentences(self, row: dict[str, Any], draw: Sequence[float]) -> tuple[list[str], list[bool]]:
        """The class as the joint condition, nothing for each person alone, and which of them are given."""
        return [class_of(row), "", ""], [True, False, False]

    def continued(self, row: dict[str, Any], draw: Sequence[float]) -> None:
        """No scene is cut: its class is that of the whole."""

    def features(self, captions: list[str]) -> tuple[Tensor, Tensor]:
        """(B,) places of the classes; all count."""
        places = torch.tensor([self.names.index(caption) for caption in captions])
        return places, torch.ones_like(places)


class Trainer(Loop):
    """One training run, which resumes from its checkpoint in ``out``."""

    def __init__(self, scenes: Scenes, settings: Settings, out: Path, *, device: str = "cpu") -> None:
        self.settings, self.out, self.device = settings, out, device
        torch.manual_seed(settings.seed)
        self.data = Data(of_classes(scenes), settings, device)
        config = CompactBiGraphDiffConfig(
            self.data.names,
            self.data.touches,
            settings.latent_dim,
            settings.ff_size,
            settings.num_layers,
            settings.num_heads,
            settings.embed_dim,
            settings.cond_dim,
            graph=settings.graph,
            layout=scenes.layout,
        )
        self.model, self.ema = (CompactBiGraphDiff(config).to(device) for _ in range(2))
        self.model.mean.copy_(self.data.mean)
        self.model.std.copy_(self.data.std)
        self.ema.load_state_dict(self.model.state_dict())
        self.ema.eval().requires_grad_(False)
        self.optimizer = adamw(self.model.parameters(), settings)
        self.schedule = NoiseSchedule(device=device)
        self.loss = InterGenLoss(
            settings.weights, t_bar=round(settings.t_bar * self.schedule.timesteps), near_by="truth"
        )
        # Three of 70 numbers say where a person stands; they count more than their share.
        self.feature_weights = torch.ones(FEATURES, device=device)
        self.feature_weights[:3] = settings.root_weight**0.5
        self.feature_weights = self.feature_weights.repeat(scenes.layout.knots_per_token)
        self.restore(asdict(settings))

    def terms(self, batch: intergen_data.Batch, t: Tensor, noise: Tensor, keep: Tensor) -> dict[str, Tensor]:
        """Every loss term of one batch, weighted."""
        people = (*batch.x0.shape[:2], 2, -1)
        if self.settings.diffusion:
            xt = self.schedule.q_sample(batch.x0, t, noise)
        else:
            xt, t = torch.zeros_like(batch.x0), torch.zeros_like(t)
        with mixed_precision(self.device):
            cond = self.model.classes(batch.text) * keep[:, None]
            predicted = self.model.denoiser(xt, t, cond, batch.mask)
        predicted = predicted.float()
        weighted = [x.view(people) * self.feature_weights for x in (predicted, batch.x0)]
        positions = [self.model.positions(x)[0].transpose(1, 2) for x in (predicted, batch.x0)]
        terms = {"simple": simple_loss(*weighted, batch.mask)}
        return terms | self.loss.regularizers(*positions, t, batch.frame_mask)

    def train_step(self) -> dict[str, float]:
        """One optimiser step; returns the loss terms."""
        s, batch = self.settings, moved(self.data.batch(self.step), self.device)
        generator = intergen_data.seeded(s.seed, 3, self.step)
        size = len(batch.x0)
        t = draw_timesteps(size, self.schedule.timesteps, s.noisiest, generator).to(self.device)
        noise = torch.randn(batch.x0.shape, generator=generator).to(self.device)
        keep = (torch.rand(size, generator=generator) >= s.cond_drop_prob).float().to(self.device)
        self.model.train()
        terms = self.terms(batch, t, noise, keep)
        total = torch.stack(list(terms.values())).sum()
        self.optimizer_step(total, self.optimizer, self.model.parameters())
        kept = [self.ema.state_dict(), self.model.state_dict()]  # with what the batch norms have seen
        self.ema_update(*([v for v in state.values() if v.is_floating_point()] for state in kept))
        return {name: value.item() for name, value in terms.items()} | {"total": total.item()}

    def export(self, folder: Path) -> None:
        """Writes the averaged network as the folder that is shipped."""
        save_network(folder, self.ema, card={"summary": SUMMARY}, trained_steps=self.step)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Train the compact BiGraphDiff on prepared scenes.")
    add_options(parser, "scenes", "device")
    parser.add_argument("--export", type=Path, help="also write the trained network to this folder")
    add_run_options(parser, Settings, leave_out=("weights",))
    options = parser.parse_args(argv)

    def job() -> None:
        trainer = Trainer(load(options.scenes), chosen(options, Settings), options.out, device=options.device)
        trainer.run_logged(minutes=options.minutes)
        if options.export:
            trainer.export(options.export)

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
