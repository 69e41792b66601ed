"""Trains the compact InterGen: ``python -m training.trainers.intergen --scenes FILE --out DIR``.

InterGen (Liang et al., section 4): both people's clean motion from their noised motion, the timestep and a
text vector; x0 prediction, eq. 8, the regularisers of eq. 11–14 and the damping of eq. 15. The motion is
the control points of :mod:`models.motion_tokens`; the regularisers see positions at 30 fps.
"""

from __future__ import annotations

import argparse
import copy
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import torch
from torch import Tensor, nn

from models.intergen.compact import CompactConfig, CompactInterGen, load_captions, save_folder
from models.known import Held, Hold, Known
from models.weights_io import common, load_network
from motion import InputError
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


def shallower(model: CompactInterGen, blocks: Sequence[int]) -> CompactInterGen:
    """A copy of a network with some of its blocks; raises InputError where it has no such block."""
    if not blocks or not set(blocks) <= set(range(model.config.num_layers)):
        raise InputError(f"Blocks {list(blocks)} are not in the teacher, which has {model.config.num_layers}.")
    result = copy.deepcopy(model)
    result.config = replace(model.config, num_layers=len(blocks))
    result.denoiser.blocks = nn.ModuleList(copy.deepcopy(model.denoiser.blocks[i]) for i in blocks)
    return result


class Trainer(DuetTrainer):
    """One training run, which resumes from its checkpoint.

    Args:
        init: whose weights and normaliser a new run begins with: a checkpoint of another run (its average),
            or a folder that was shipped.
        share: the run's own share in the weights that are exported; the rest is of those that it began with.
        teacher: a shipped folder that a run begins with and also learns from: the difference from its predictions is
            one more loss (Kim et al. 2024, "BK-SDM"). Its text side stays as it is.
        blocks: those of the teacher that the network has.
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
        teacher: Path | None = None,
        blocks: Sequence[int] = (),
        device: str = "cpu",
        cache: Path | None = None,
        workers: int = 0,
    ) -> None:
        torch.manual_seed(settings.seed)
        self.share, self.teacher, model = share, None, None
        if teacher is not None:
            self.teacher, folder = load_network(teacher, CompactInterGen)
            self.bank = load_captions(folder)
            model = shallower(self.teacher, blocks or range(self.teacher.config.num_layers))
            settings = replace(settings, **common(model.config, Settings))
            model.denoiser.requires_grad_()
            self.teacher.to(device)
        self.begin(settings, out, Data(scenes, settings, cache or out, device), device, workers)
        if model is None:
            model = new_model(settings, self.data)
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
        draft = drafted(self.data.control(batch.x0), frames, layout, self.settings.given.drafted, generator)
        return draft.features(layout, self.data.mean, self.data.std)

    def terms(self, drawn: Drawn, noise: Tensor) -> dict[str, Tensor]:
        """Every loss term of what was drawn, weighted."""
        batch, t, hold, draft = drawn.batch, drawn.t, drawn.hold, drawn.draft
        xt = self.schedule.q_sample(batch.x0, t, noise)
        if hold is not None:
            xt = hold(xt)
        known = None if hold is None else hold.features.to(xt)
        shown = self.model.shown(known, None if draft is None else draft.to(xt))
        if self.teacher is not None:
            self.model.conditioner.eval()
        with mixed_precision(self.device):
            inputs = (xt, t, condition(self.model, batch), batch.mask, shown)
            predicted = self.model.denoiser(*inputs).float()
            with torch.no_grad():
                wanted = None if self.teacher is None else self.teacher.denoiser(*inputs).float()
        predicted = predicted if hold is None else hold(predicted)
        terms = self.motion_terms(predicted, batch.x0, t, batch)
        if wanted is None:
            return terms
        return terms | {"taught": self.simple(predicted, wanted if hold is None else hold(wanted), batch)}

    def export(self, folder: Path) -> None:
        """Writes the averaged network as it is shipped, with a reader of touches and a bank of training captions."""
        scenes, model = self.data.scenes, self.ema.cpu()
        if self.teacher is None:
            average(model, self.began, self.share)
            model, self.bank = with_touches(model, scenes), caption_bank(scenes)
        save_folder(folder, model, self.bank, card={"summary": SUMMARY}, trained_steps=self.step)


def _begin(options: argparse.Namespace, settings: Settings) -> Trainer:
    given = {name: getattr(options, name) for name in ("init", "share", "teacher", "blocks", "device", "workers")}
    scenes = load(options.scenes)
    if options.export is not None and options.teacher is None and not scenes.split("test"):
        raise InputError("The scenes have no test split, by which what is exported is set: prepare a corpus with both.")
    trainer = Trainer(scenes, settings, options.out, **given)
    if options.compile:
        trainer.model.denoiser.compile(dynamic=True)
    return trainer


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    names = ("scenes", "threads", "device", "workers", "init", "share", "teacher", "blocks", "export", "compile")
    return train(argv, __doc__, Settings, _begin, *names, leave_out=("weights", "given"))


if __name__ == "__main__":
    raise SystemExit(main())
