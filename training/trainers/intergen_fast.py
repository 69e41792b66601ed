"""Fits the fast mode of a trained InterGen: ``python -m training.trainers.intergen_fast --run DIR --out DIR …``.

Each of :data:`models.intergen.fast.PASSES` passes learns to go where the trained network goes with several DDIM
steps and classifier-free guidance (Salimans & Ho 2022, "Progressive Distillation for Fast Sampling of Diffusion
Models", algorithm 2; the scale is an input as in Meng et al. 2023). The trained network is the averaged one of a run
of :mod:`training.trainers.intergen` and stays as it is. What is given is held, as in that training.
"""

from __future__ import annotations

import argparse
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import torch
from torch import Tensor
from torch.func import functional_call

from models.diffusion import guide, top_timesteps
from models.intergen.fast import PASSES, FastChange
from models.intergen.words import WordDenoiser
from models.known import Hold
from motion import InputError
from training.core import checkpoint
from training.core.precision import mixed_precision
from training.core.shell import add_options, add_run_options, chosen, exit_code
from training.prepare import Scenes, load
from training.trainers.held import Held
from training.trainers.intergen import Trainer, condition, new_model
from training.trainers.intergen_data import Batch, seeded, settings_of


@dataclass(frozen=True)
class FastSettings:
    """The settings of a run, beside those of the run whose network is made fast.

    substeps: DDIM steps of the trained network for one pass.
    lowest, highest: scales of the guidance are drawn between them.
    """

    rank: int = 8
    substeps: int = 3
    lowest: float = 1.0
    highest: float = 6.0
    batch: int = 16
    steps: int = 3000
    learning_rate: float = 1e-3
    warmup: int = 50
    ema: float = 0.995
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("rank", "substeps", "batch", "warmup"):
            if getattr(self, name) < 1:
                raise InputError(f"{name} is {getattr(self, name)}: give 1 or more.")
        if not 1 <= self.lowest <= self.highest:
            raise InputError(
                f"Scales from {self.lowest:g} to {self.highest:g} are none: give 1 or more, in order."
            )


@dataclass
class FastDrawn:
    """All that a step draws besides noise: a batch, which passes (B,), scales (B,), and what is given."""

    batch: Batch
    place: Tensor
    scale: Tensor
    hold: Hold | Held | None


class FastTrainer(Trainer):
    """One run, which resumes from its checkpoint in ``out``.

    Args:
        trained: a checkpoint of :mod:`training.trainers.intergen`.
    """

    def __init__(
        self,
        scenes: Scenes,
        settings: FastSettings,
        trained: Path,
        out: Path,
        *,
        device: str = "cpu",
        cache: Path | None = None,
        workers: int = 0,
    ) -> None:
        taken = ("batch", "steps", "learning_rate", "warmup", "ema", "seed")
        known = settings_of(trained)
        if not known.words:
            raise InputError(f"{trained} holds a network that reads no words: train one with --words.")
        self.set_up(
            scenes, replace(known, **{k: getattr(settings, k) for k in taken}), out, device, cache, workers
        )
        self.fast = settings
        self.model = new_model(self.settings, self.data).to(device)
        checkpoint.restore_part(trained, "ema", self.model)
        self.model.eval().requires_grad_(False)
        self.data.mean, self.data.std = self.model.mean.cpu(), self.model.std.cpu()
        denoiser = self.model.denoiser
        assert isinstance(denoiser, WordDenoiser)
        self.student = WordDenoiser(
            denoiser.config,
            denoiser.known_embed.in_features,
            plan_features=denoiser.plan_features,
            guidance_input=True,
        )
        self.student.to(device).eval()  # without dropout, as the trained network
        self.change, self.ema = (FastChange(denoiser, settings.rank).to(device) for _ in range(2))
        self.ema.load_state_dict(self.change.state_dict())
        self.ema.requires_grad_(False)
        self.optimizer = torch.optim.AdamW(
            self.change.parameters(), lr=settings.learning_rate, weight_decay=0.0, fused=True
        )
        fine = torch.from_numpy(top_timesteps(PASSES * settings.substeps, self.schedule.timesteps))
        self.timesteps = torch.cat([fine, torch.tensor([-1])]).to(device)  # −1: clean
        # A run on another trained network is another run.
        self.restore({"trained": checkpoint.digest(trained)} | asdict(settings))

    def parts(self) -> dict[str, torch.nn.Module | torch.optim.Optimizer]:
        """The contents of a checkpoint, by name."""
        return {"change": self.change, "ema": self.ema, "optimizer": self.optimizer}

    def levels(self, t: Tensor) -> tuple[Tensor, Tensor]:
        """Signal and noise (B, 1, 1) at timesteps (B,), of which −1 is clean."""
        signal = torch.where(t < 0, 1.0, self.schedule.sqrt_alphas_cumprod[t.clamp_min(0)])
        noise = torch.where(t < 0, 0.0, self.schedule.sqrt_one_minus_alphas_cumprod[t.clamp_min(0)])
        return signal[:, None, None], noise[:, None, None]

    @torch.no_grad()
    def target(
        self, x: Tensor, place: Tensor, cond: Tensor, scale: Tensor, mask: Tensor, hold: Hold | Held | None
    ) -> Tensor:
        """The clean motion that one DDIM step must aim at to arrive where the trained network does.

        Args:
            x: (B, tokens, 2F) noised motion at the passes ``place`` (B,).
            cond: (B, 3, R, C); scale (B,).

        Returns:
            (B, tokens, 2F), x̃ of algorithm 2.
        """
        first = x
        nothing = torch.zeros_like(cond)
        known = {} if hold is None else {"known": hold.features.repeat(2, 1, 1)}
        for i in range(self.fast.substeps):
            t, following = (self.timesteps[place * self.fast.substeps + i + k] for k in (0, 1))
            with mixed_precision(self.device):
                both = self.model.denoiser(
                    x.repeat(2, 1, 1), t.repeat(2), torch.cat([cond, nothing]), mask.repeat(2, 1, 1), **known
                )
            x0 = guide(*both.float().chunk(2), scale[:, None, None])
            x0 = x0 if hold is None else hold(x0)
            (signal, noise), (next_signal, next_noise) = self.levels(t), self.levels(following)
            x = next_signal * x0 + next_noise * (x - signal * x0) / noise
            x = x if hold is None else hold(x)
        (signal, noise), (last_signal, last_noise) = (
            self.levels(self.timesteps[(place + k) * self.fast.substeps]) for k in (0, 1)
        )
        ratio = last_noise / noise
        return (x - ratio * first) / (last_signal - ratio * signal)

    def draw(self, step: int) -> FastDrawn:  # type: ignore[override]  # its own steps alone take it
        """All that a step draws, on the CPU; the same for the same seed and step."""
        batch, generator = self.data.batch(step), seeded(self.settings.seed, 3, step)
        size, low = len(batch.x0), self.fast.lowest
        place = torch.randint(PASSES, (size,), generator=generator)
        scale = torch.rand(size, generator=generator) * (self.fast.highest - low) + low
        return FastDrawn(batch, place, scale, self.hold(self.known(batch, generator)))

    def train_step(self) -> dict[str, float]:
        """Takes one optimiser step; returns each loss by name."""
        drawn = self.next_draw()
        terms = self.distilled(drawn.batch, drawn.place, drawn.scale, self.noise(drawn.batch.x0), drawn.hold)
        return self.step_on(terms, self.change)

    def distilled(
        self, batch: Batch, place: Tensor, scale: Tensor, noise: Tensor, hold: Hold | Held | None
    ) -> dict[str, Tensor]:
        """Every loss term of one batch: the passes ``place`` (B,) against :meth:`target`, at scales (B,)."""
        t = self.timesteps[place * self.fast.substeps]
        x = self.schedule.q_sample(batch.x0, t, noise)
        x = x if hold is None else hold(x)
        with torch.no_grad(), mixed_precision(self.device):
            cond = condition(self.model, batch)[0].float()
        target = self.target(x, place, cond, scale, batch.mask, hold)
        known = None if hold is None else hold.features
        with mixed_precision(self.device):
            changed = self.change.tensors(self.model.denoiser)
            made = functional_call(self.student, changed, (x, t, cond, batch.mask, known, scale))
        made = made.float() if hold is None else hold(made.float())
        return self.motion_terms(made, target, t, batch)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Make a trained InterGen fast.")
    parser.add_argument("--run", type=Path, required=True, help="--out of the training of the network")
    add_options(parser, "scenes", "workers", "threads", "device")
    add_run_options(parser, FastSettings)
    options = parser.parse_args(argv)
    if options.threads:
        torch.set_num_threads(options.threads)

    def job() -> None:
        trainer = FastTrainer(
            load(options.scenes),
            chosen(options, FastSettings),
            options.run / "last.safetensors",
            options.out,
            device=options.device,
            cache=options.run,
            workers=options.workers,
        )
        trainer.run_logged(minutes=options.minutes)

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
