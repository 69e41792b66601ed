"""Trains the compact InterGen: ``python -m training.trainers.intergen --scenes FILE --out DIR``.

InterGen (Liang et al., section 4): both people's clean motion from their noised motion, the timestep and a
text vector; x0 prediction, eq. 8, the regularisers of eq. 11–14 and the damping of eq. 15. The motion is
the control points of :mod:`models.motion_tokens`; the regularisers see positions at 30 fps.

Everything random is drawn from the seed and the step number, so a run that stops (``--minutes``, Ctrl+C) and
is started again with the same command goes on exactly as if it had never stopped.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from models.diffusion import NoiseSchedule
from models.intergen.compact import CompactConfig, CompactInterGen, load_folder
from models.intergen.losses import InterGenLoss, simple_loss
from models.known import Hold, Known
from models.motion_tokens import FEATURES
from training.core import checkpoint
from training.core.ahead import drawn_ahead, moved
from training.core.loop import Loop, adamw
from training.core.precision import mixed_precision
from training.core.samples import write_sheet
from training.core.shell import add_options, add_run_options, chosen, exit_code
from training.prepare import Scenes, load
from training.trainers.given import AS_STAGED, known_parts
from training.trainers.held import Held
from training.trainers.intergen_data import Batch, Data, Settings, seeded


def draw_timesteps(size: int, timesteps: int, noisiest: float, generator: torch.Generator) -> Tensor:
    """(size,) timesteps: a share ``noisiest`` from the last tenth, the others from all.

    A motion's tokens say much the same, so its outline shines through all but the strongest noise: at
    t = 0.95 T a network without words already sees which gesture a scene holds. What the words decide is
    learned above, which is 5 % of uniform draws.
    """
    t = torch.randint(timesteps, (size,), generator=generator)
    late = timesteps - 1 - torch.randint(max(timesteps // 10, 1), (size,), generator=generator)
    return torch.where(torch.rand(size, generator=generator) < noisiest, late, t)


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


@dataclass
class Drawn:
    """All that a step draws besides noise and dropout: a batch, timesteps (B,), and what is given."""

    batch: Batch
    t: Tensor
    hold: Hold | Held | None


class Trainer(Loop):
    """One training run, which resumes from its checkpoint.

    Args:
        init: whose weights and normaliser a new run begins with: a checkpoint of another run (its average),
            or a folder that was shipped.
        cache: where features of captions are kept, ``out`` by default; runs on the same scenes can share it.
        build: makes the untrained network.
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
        build: Callable[[Settings, Data], CompactInterGen] = new_model,
        workers: int = 0,
    ) -> None:
        self.set_up(scenes, settings, out, device, cache, workers)
        self.model = build(settings, self.data).to(device)
        if init is not None:
            if init.is_dir():
                self.model.grow_from(load_folder(init)[0])
            else:
                checkpoint.restore_part(init, "ema", self.model)
        self.ema = build(settings, self.data).to(device).requires_grad_(False)
        self.ema.load_state_dict(self.model.state_dict())
        self.optimizer = adamw(self.model.parameters(), settings)
        self.restore(asdict(settings))
        self.data.mean, self.data.std = self.model.mean.cpu(), self.model.std.cpu()

    def set_up(
        self, scenes: Scenes, settings: Settings, out: Path, device: str, cache: Path | None, workers: int
    ) -> None:
        """Prepares data, noise schedule and losses."""
        self.scenes, self.settings, self.out, self.device = scenes, settings, out, device
        self.workers = workers
        self._ahead: Iterator[Any] | None = None
        out.mkdir(parents=True, exist_ok=True)
        torch.manual_seed(settings.seed)
        self.data = Data(scenes, settings, cache or out, device)
        self.schedule = NoiseSchedule(device=device)
        self.loss = InterGenLoss(
            settings.weights, t_bar=round(settings.t_bar * self.schedule.timesteps), near_by="truth"
        )
        # Three of 70 numbers say where a person stands; they count more than their share.
        self.feature_weights = torch.ones(FEATURES, device=device)
        self.feature_weights[:3] = settings.root_weight**0.5
        self.feature_weights = self.feature_weights.repeat(scenes.layout.knots_per_token)

    def known(self, batch: Batch, generator: torch.Generator) -> Known | None:
        """The given parts of each motion, drawn by the settings' shares."""
        control = self.data.control(batch.x0)
        frames = batch.frame_mask.sum(1).int().tolist()
        return known_parts(control, frames, batch.past.tolist(), self.scenes.layout, self.settings.given, generator)

    def hold(self, known: Known | None) -> Hold | Held | None:
        """The given parts, to be written into motions, in the form that suits the device."""
        if known is None:
            return None
        hold = Hold(known, self.scenes.layout, self.data.mean, self.data.std)
        return hold if self.device == "cpu" else Held.of(hold)

    def draw(self, step: int) -> Drawn:
        """All that a step draws, on the CPU; the same for the same seed and step."""
        batch, generator = self.data.batch(step), seeded(self.settings.seed, 3, step)
        t = draw_timesteps(len(batch.x0), self.schedule.timesteps, self.settings.noisiest, generator)
        return Drawn(batch, t, self.hold(self.known(batch, generator)))

    def next_draw(self) -> Any:
        """The draw of this step, on the device."""
        if self.workers and self._ahead is None:
            steps = range(self.step, self.settings.steps)
            self._ahead = drawn_ahead(self.draw, steps, self.workers, self.device)
        drawn = moved(self.draw(self.step), self.device) if self._ahead is None else next(self._ahead)
        return replace(drawn, batch=self.data.on_device(drawn.batch))

    def terms(self, batch: Batch, t: Tensor, noise: Tensor, hold: Hold | Held | None) -> dict[str, Tensor]:
        """Every loss term of one batch, weighted."""
        xt = self.schedule.q_sample(batch.x0, t, noise)
        if hold is not None:
            xt = hold(xt)
        seen = {} if hold is None or not self.settings.words else {"known": hold.features.to(xt)}
        with mixed_precision(self.device):
            cond = condition(self.model, batch)
            predicted = self.model.denoiser(xt, t, cond, batch.mask, **seen)
        predicted = predicted.float() if hold is None else hold(predicted.float())
        return self.motion_terms(predicted, batch.x0, t, batch)

    def motion_terms(self, made: Tensor, wanted: Tensor, t: Tensor, batch: Batch) -> dict[str, Tensor]:
        """The losses of clean motions (B, tokens, 2F) against those that are wanted, weighted and damped."""
        weighted = [x.view(*x.shape[:2], 2, -1) * self.feature_weights for x in (made, wanted)]
        terms = {"simple": simple_loss(*weighted, batch.mask)}
        # Motions above the threshold have no part in the regularisers; one keeps the terms there, at zero.
        chosen = (t <= self.loss.t_bar).nonzero()[:, 0] if (t <= self.loss.t_bar).any() else t.argmin()[None]
        positions = [self.model.positions(x[chosen])[0].transpose(1, 2) for x in (made, wanted)]
        return terms | self.loss.regularizers(*positions, t[chosen], batch.frame_mask[chosen])

    def train_step(self) -> dict[str, float]:
        """One optimiser step; returns the loss terms."""
        drawn = self.next_draw()
        torch.manual_seed(seeded(self.settings.seed, 4, self.step).initial_seed())  # dropout
        self.model.train()
        noise = self.noise(drawn.batch.x0)
        return self.step_on(self.terms(drawn.batch, drawn.t, noise, drawn.hold), self.model)

    def noise(self, x0: Tensor) -> Tensor:
        """Gaussian noise like x0, drawn on the device."""
        seed = seeded(self.settings.seed, 5, self.step).initial_seed()
        generator = torch.Generator(self.device).manual_seed(seed)
        return torch.randn(x0.shape, generator=generator, device=self.device)

    def step_on(self, terms: dict[str, Tensor], trained: torch.nn.Module) -> dict[str, float]:
        """Takes a step that lowers the sum of these terms; returns them and the sum."""
        values = torch.stack(list(terms.values()))
        total = values.sum()
        self.optimizer_step(total, self.optimizer, trained.parameters())
        self.ema_update(self.ema.parameters(), trained.parameters())
        numbers = torch.cat([values, total[None]]).tolist()  # the GPU is waited for once
        return dict(zip([*terms, "total"], numbers, strict=True))


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Train the compact InterGen on prepared scenes.")
    add_options(parser, "scenes", "threads", "device", "workers")
    parser.add_argument("--init", type=Path, help="begin with another run's last.safetensors, or a shipped folder")
    parser.add_argument(
        "--sheets", type=float, default=20.0, help="minutes between contact sheets of samples; 0: none (20)"
    )
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
    trainer = Trainer(
        load(options.scenes), settings, options.out, init=options.init, device=options.device, workers=options.workers
    )
    if options.compile:
        trainer.model.denoiser.compile(dynamic=True)
    drawn = time.monotonic()

    def draw() -> None:
        nonlocal drawn
        if options.sheets and time.monotonic() - drawn > options.sheets * 60:
            write_sheet(trainer.ema.eval(), options.out / "samples" / f"{trainer.step:07d}.png")
            drawn = time.monotonic()

    trainer.run_logged(minutes=options.minutes, after=draw)


if __name__ == "__main__":
    raise SystemExit(main())
