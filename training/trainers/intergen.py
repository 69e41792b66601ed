"""Trains the compact InterGen: ``python -m training.trainers.intergen --scenes FILE --out DIR``.

InterGen (Liang et al., section 4): both people's clean motion from their noised motion, the timestep and a
text vector; x0 prediction, eq. 8, the regularisers of eq. 11–14 and the damping of eq. 15. The motion is
the control points of :mod:`models.motion_tokens`; the regularisers see positions at 30 fps.
"""

from __future__ import annotations

import argparse
from dataclasses import asdict, replace
from pathlib import Path

import torch
from torch import Tensor

from models.intergen.compact import CompactConfig, CompactInterGen, load_folder
from models.known import Hold, Known
from training.core import checkpoint
from training.core.loop import adamw, mixed_precision
from training.core.shell import add_options, add_run_options, chosen, exit_code
from training.prepare import Scenes, load
from training.trainers.given import AS_PLACES, AS_STAGED, Held, drafted, known_parts
from training.trainers.intergen_data import Batch, Data, Settings, seeded
from training.trainers.scenes import Drawn, DuetTrainer, draw_timesteps


def new_model(settings: Settings, data: Data) -> CompactInterGen:
    """An untrained network of the run's sizes that carries the data's normaliser."""
    model = CompactInterGen(
        CompactConfig(
            latent_dim=settings.latent_dim,
            ff_size=settings.ff_size,
            num_layers=settings.num_layers,
            num_heads=settings.num_heads,
            cond_dim=settings.cond_dim,
            dropout=settings.dropout,
            role_text=True,
            words=settings.words,
            drafts=settings.drafts,
            layout=data.scenes.layout,
        )
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
        self.model = new_model(settings, self.data).to(device)
        if init is not None:
            if init.is_dir():
                self.model.grow_from(load_folder(init)[0])
            else:
                checkpoint.restore_part(init, "ema", self.model)
        self.ema = new_model(settings, self.data).to(device).requires_grad_(False)
        self.ema.load_state_dict(self.model.state_dict())
        self.optimizer = adamw(self.model.parameters(), settings)
        self.restore(asdict(settings))
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

    def terms(
        self, batch: Batch, t: Tensor, noise: Tensor, hold: Hold | Held | None, draft: Tensor | None = None
    ) -> dict[str, Tensor]:
        """Every loss term of one batch, weighted."""
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


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Train the compact InterGen on prepared scenes.")
    add_options(parser, "scenes", "threads", "device", "workers")
    parser.add_argument("--init", type=Path, help="begin with another run's last.safetensors, or a shipped folder")
    parser.add_argument("--compile", action="store_true", help="compile the network (needs a C++ compiler)")
    add_run_options(parser, Settings, leave_out=("weights", "given"))
    options = parser.parse_args(argv)
    if options.threads:
        torch.set_num_threads(options.threads)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    settings = chosen(options, Settings)
    if settings.staged:
        settings = replace(settings, given=AS_STAGED)
    if settings.drafts:
        settings = replace(settings, given=AS_PLACES)
    trainer = Trainer(
        load(options.scenes), settings, options.out, init=options.init, device=options.device, workers=options.workers
    )
    if options.compile:
        trainer.model.denoiser.compile(dynamic=True)
    trainer.run_logged(minutes=options.minutes)


if __name__ == "__main__":
    raise SystemExit(main())
