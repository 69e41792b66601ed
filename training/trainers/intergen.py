"""Trains the compact InterGen: ``python -m training.trainers.intergen --scenes FILE --out DIR``.

InterGen (Liang et al., section 4): both people's clean motion from their noised motion, the timestep and a
text vector; x0 prediction, eq. 8, the regularisers of eq. 11–14 and the damping of eq. 15. The motion is
the control points of :mod:`models.motion_tokens`; the regularisers see positions at 30 fps.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import torch
from torch import Tensor

from models.intergen.compact import CompactConfig, CompactInterGen, load_folder
from models.known import Hold, Known
from training.core import checkpoint
from training.core.loop import mixed_precision
from training.core.shell import train
from training.prepare import Scenes, load
from training.trainers.given import AS_PLACES, AS_STAGED, Held, drafted, known_parts
from training.trainers.intergen_data import Batch, Data, Settings, seeded
from training.trainers.scenes import Drawn, DuetTrainer, draw_timesteps

SIZES = ("latent_dim", "ff_size", "num_layers", "num_heads", "cond_dim", "dropout", "words", "drafts")
"""Settings that the network's configuration has as well."""


def new_model(settings: Settings, data: Data) -> CompactInterGen:
    """An untrained network of the run's sizes that carries the data's normaliser."""
    model = CompactInterGen(
        CompactConfig(**{name: getattr(settings, name) for name in SIZES}, role_text=True, layout=data.scenes.layout)
    )
    model.mean.copy_(data.mean)
    model.std.copy_(data.std)
    return model


def condition(model: CompactInterGen, batch: Batch) -> Tensor:
    """The condition of the sentences that are read."""
    size = len(batch.x0)
    if not model.config.words:
        vectors = model.conditioner(batch.text[:size], batch.text_mask[:size])
        return vectors * batch.read[:, :1]
    rows = model.conditioner.rows(batch.text, batch.text_mask)
    text = rows.new_zeros(3 * size, *rows.shape[1:]).index_copy(0, batch.places, rows)
    return text.view(size, 3, *rows.shape[1:]) * batch.read[:, :, None, None]


class Trainer(DuetTrainer):
    """One training run, which resumes from its checkpoint.

    Args:
        init: whose weights and normaliser a new run begins with: a checkpoint of another run (its average),
            or a folder that was shipped.
        cache: where features of captions are kept, ``out`` by default; runs on the same scenes can share it.
        workers: processes that draw batches ahead; 0 draws each when it is needed.
    """

    def __init__(
        self,
        scenes: Scenes,
        settings: Settings,
        out: Path,
        *,
        init: Path | None = None,
        device: str = "cpu",
        cache: Path | None = None,
        workers: int = 0,
    ) -> None:
        out.mkdir(parents=True, exist_ok=True)
        torch.manual_seed(settings.seed)
        self.begin(settings, out, Data(scenes, settings, cache or out, device), device, workers)
        model = new_model(settings, self.data)
        if init is not None and init.is_dir():
            model.grow_from(load_folder(init)[0])
        elif init is not None:
            checkpoint.restore_part(init, "ema", model)
        self.start(model, device)
        self.data.mean, self.data.std = self.model.mean.cpu(), self.model.std.cpu()

    def known(self, batch: Batch, generator: torch.Generator) -> Known | None:
        """The given parts of each motion, drawn by the settings' shares."""
        frames = batch.frame_mask.sum(1).int().tolist()
        control, layout = self.data.control(batch.x0), self.data.scenes.layout
        return known_parts(control, frames, batch.past.tolist(), layout, self.settings.given, generator)

    def hold(self, known: Known | None) -> Hold | Held | None:
        """The given parts, to be written into motions, in the form that suits the device."""
        if known is None:
            return None
        hold = Hold(known, self.data.scenes.layout, self.data.mean, self.data.std)
        return hold if self.device == "cpu" else Held.of(hold)

    def draw(self, step: int) -> Drawn:
        """All that a step draws, on the CPU; the same for the same seed and step."""
        batch, generator = self.data.batch(step), seeded(self.settings.seed, 3, step)
        t = draw_timesteps(len(batch.x0), self.schedule.timesteps, self.settings.noisiest, generator)
        return Drawn(batch, t, self.hold(self.known(batch, generator)), self.draft(batch, generator))

    def draft(self, batch: Batch, generator: torch.Generator) -> Tensor | None:
        """The drafts of a batch as the network sees them."""
        if not self.settings.drafts:
            return None
        frames = batch.frame_mask.sum(1).int().tolist()
        layout = self.data.scenes.layout
        draft = drafted(self.data.control(batch.x0), frames, layout, generator)
        return draft.features(layout, self.data.mean, self.data.std)

    def terms(self, drawn: Drawn, noise: Tensor) -> dict[str, Tensor]:
        """Every loss term of what was drawn, weighted."""
        batch, t, hold, draft = drawn.batch, drawn.t, drawn.hold, drawn.draft
        xt = self.schedule.q_sample(batch.x0, t, noise)
        if hold is not None:
            xt = hold(xt)
        known = None if hold is None or not self.settings.words else hold.features.to(xt)
        shown = self.model.shown(known, None if draft is None else draft.to(xt))
        seen = {} if shown is None else {"known": shown}
        with mixed_precision(self.device):
            cond = condition(self.model, batch)
            predicted = self.model.denoiser(xt, t, cond, batch.mask, **seen)
        predicted = predicted.float() if hold is None else hold(predicted.float())
        return self.motion_terms(predicted, batch.x0, t, batch)


def _begin(options: argparse.Namespace, settings: Settings) -> Trainer:
    if settings.staged or settings.drafts:
        settings = replace(settings, given=AS_PLACES if settings.drafts else AS_STAGED)
    given = {name: getattr(options, name) for name in ("init", "device", "workers")}
    trainer = Trainer(load(options.scenes), settings, options.out, **given)
    if options.compile:
        trainer.model.denoiser.compile(dynamic=True)
    return trainer


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    names = ("scenes", "threads", "device", "workers", "init", "compile")
    return train(argv, __doc__, Settings, _begin, *names, leave_out=("weights", "given"))


if __name__ == "__main__":
    raise SystemExit(main())
