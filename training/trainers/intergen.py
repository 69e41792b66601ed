"""Trains the compact InterGen: ``python -m training.trainers.intergen --scenes FILE --out DIR``.

InterGen (Liang et al., section 4): both people's clean motion from their noised motion, the timestep and a
text vector; x0 prediction, eq. 8, the regularisers of eq. 11–14 and the damping of eq. 15. The motion is
the control points of :mod:`models.motion_tokens`; the regularisers see positions at 30 fps.
"""

from __future__ import annotations

import argparse
import copy
from pathlib import Path

import torch
from torch import Tensor

from models.intergen.compact import CompactConfig, CompactInterGen, save_folder
from models.known import Held, Hold, Known
from models.weights_io import common, load_network
from training.core import checkpoint
from training.core.loop import mixed_precision
from training.core.shell import train
from training.export import average, caption_bank
from training.prepare import Scenes, load
from training.trainers.given import drafted, known_parts
from training.trainers.intergen_data import Batch, Data, Settings, seeded
from training.trainers.scenes import Drawn, DuetTrainer, draw_timesteps
from training.trainers.touch import with_touches, without_touches

SUMMARY = (
    "InterGen's network (Liang et al.) over spline tokens, grown to read words and drafts: two people from a text. "
    "Research and non-commercial use only."
)
"""Summary of the weights on the page."""


def new_model(settings: Settings, data: Data) -> CompactInterGen:
    """An untrained network of the run's sizes that carries the data's normaliser."""
    model = CompactInterGen(CompactConfig(**common(settings, CompactConfig), layout=data.scenes.layout))
    model.mean.copy_(data.mean)
    model.std.copy_(data.std)
    return model


def condition(model: CompactInterGen, batch: Batch) -> Tensor:
    """The condition of the sentences that are read."""
    size = len(batch.x0)
    rows = model.conditioner.rows(batch.text, batch.text_mask)
    text = rows.new_zeros(3 * size, *rows.shape[1:]).index_copy(0, batch.places, rows)
    return text.view(size, 3, *rows.shape[1:]) * batch.read[:, :, None, None]


class Trainer(DuetTrainer):
    """One training run, which resumes from its checkpoint.

    Args:
        init: whose weights and normaliser a new run begins with: a checkpoint of another run (its average),
            or a folder that was shipped.
        share: the run's own share in the weights that are exported; the rest is of those that it began with.
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
        share: float = 1.0,
        device: str = "cpu",
        cache: Path | None = None,
        workers: int = 0,
    ) -> None:
        torch.manual_seed(settings.seed)
        self.begin(settings, out, Data(scenes, settings, cache or out, device), device, workers)
        model, self.share = new_model(settings, self.data), share
        if init is not None and init.is_dir():
            without_touches(load_network(init, CompactInterGen)[0]).loaded(model)
        elif init is not None:
            checkpoint.restore_part(init, "ema", model)
        self.began = copy.deepcopy(model)
        self.start(model, device)
        self.data.mean, self.data.std = self.model.mean.cpu(), self.model.std.cpu()

    def known(self, batch: Batch, generator: torch.Generator) -> Known | None:
        """The given parts of each motion, drawn by the settings' shares."""
        frames = batch.frame_mask.sum(1).int().tolist()
        control, layout = self.data.control(batch.x0), self.data.scenes.layout
        return known_parts(control, frames, batch.past.tolist(), layout, self.settings.given, generator)

    def hold(self, known: Known | None) -> Held | None:
        """The given parts, to be written into motions."""
        return None if known is None else Hold(known, self.data.scenes.layout, self.data.mean, self.data.std).held

    def draw(self, step: int) -> Drawn:
        """All that a step draws, on the CPU; the same for the same seed and step."""
        batch, generator = self.data.batch(step), seeded(self.settings.seed, 3, step)
        t = draw_timesteps(len(batch.x0), self.schedule.timesteps, self.settings.noisiest, generator)
        return Drawn(batch, t, self.hold(self.known(batch, generator)), self.draft(batch, generator))

    def draft(self, batch: Batch, generator: torch.Generator) -> Tensor:
        """The drafts of a batch as the network sees them."""
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
        known = None if hold is None else hold.features.to(xt)
        shown = self.model.shown(known, None if draft is None else draft.to(xt))
        with mixed_precision(self.device):
            cond = condition(self.model, batch)
            predicted = self.model.denoiser(xt, t, cond, batch.mask, shown)
        predicted = predicted.float() if hold is None else hold(predicted.float())
        return self.motion_terms(predicted, batch.x0, t, batch)

    def export(self, folder: Path) -> None:
        """Writes the averaged network as it is shipped, with a reader of touches and a bank of training captions."""
        scenes, model = self.data.scenes, self.ema.cpu()
        average(model, self.began, self.share)
        model = with_touches(model, scenes)
        save_folder(folder, model, caption_bank(scenes), card={"summary": SUMMARY}, trained_steps=self.step)


def _begin(options: argparse.Namespace, settings: Settings) -> Trainer:
    given = {name: getattr(options, name) for name in ("init", "share", "device", "workers")}
    trainer = Trainer(load(options.scenes), settings, options.out, **given)
    if options.compile:
        trainer.model.denoiser.compile(dynamic=True)
    return trainer


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    names = ("scenes", "threads", "device", "workers", "init", "share", "export", "compile")
    return train(argv, __doc__, Settings, _begin, *names, leave_out=("weights", "given"))


if __name__ == "__main__":
    raise SystemExit(main())
