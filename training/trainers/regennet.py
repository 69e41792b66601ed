"""Trains the compact ReGenNet: ``python -m training.trainers.regennet --scenes FILE --out DIR``.

ReGenNet (Xu et al., section 3.2): the reactor's clean motion from its noised motion, the actor's, the
timestep and words; x0 prediction and the interaction loss of eq. 3–4. One network learns both settings: most
batches are masked causally (online), the others see all of the actor (offline), see
:mod:`models.regennet.compact`. The words' conditioner is that of a shipped InterGen and stays as it is.

Everything random is drawn from the seed and the step number, so a run that stops goes on as if it had not.
"""

from __future__ import annotations

import argparse
from dataclasses import asdict, dataclass
from pathlib import Path

import torch
from torch import Tensor
from torch.nn.attention import SDPBackend, sdpa_kernel

from models.diffusion import NoiseSchedule
from models.errors import load_strictly
from models.intergen.compact import load_folder as load_intergen
from models.intergen.losses import bone_lengths, facing
from models.motion_tokens import FEATURES, NUM_CONTACTS
from models.regennet.compact import CompactReGenNet, CompactReGenNetConfig, load_folder
from models.weights_io import save_network
from motion import InputError
from motion.skeleton import FEET
from training.core.loop import Loop, adamw
from training.core.precision import mixed_precision
from training.core.shell import add_run_options, chosen, exit_code
from training.prepare import Scenes, load
from training.trainers.intergen import draw_timesteps
from training.trainers.intergen_data import seeded
from training.trainers.regennet_data import Batch, Conditions, Data, knot_positions, seen_rows
from training.trainers.touch import with_touches

SUMMARY = (
    "ReGenNet (Xu et al.) at width 192 over spline control points: the reaction to a given person, "
    "online or offline. Research and non-commercial use only."
)
"""Summary of the weights on the page."""
NEAR = 1.0
"""Metres: the loss on distances counts joints of the two people that are nearer than this."""


@dataclass(frozen=True)
class Settings:
    """The settings of a run; a checkpoint of others is refused.

    offline: share of batches that see the whole actor.
    cond_drop_prob: probability that a scene's words are dropped, for classifier-free guidance.
    jitter: metres of noise on the actor's joints, for robustness to noisy recordings.
    begin: share of scenes whose first reactor pose is given to the network.
    crop: share of scenes that begin at a random frame of their first half; their first pose is always given.
    noisiest: share of samples from the noisiest tenth of the timesteps, see training.trainers.intergen.
    recorded: weight of a recorded pair: there are minutes of recorded and hours of composed motion.
    """

    latent_dim: int = 192
    ff_size: int = 512
    num_layers: int = 6
    num_heads: int = 4
    window: int = 40
    batch: int = 32
    steps: int = 5000
    learning_rate: float = 6e-4
    warmup: int = 150
    weight_decay: float = 1e-3
    ema: float = 0.998
    cond_drop_prob: float = 0.25
    offline: float = 0.3
    jitter: float = 0.005
    begin: float = 0.5
    crop: float = 0.25
    recorded: int = 8
    noisiest: float = 0.3
    root_weight: float = 4.0
    velocity: float = 30.0
    bone_length: float = 30.0
    foot_contact: float = 30.0
    interaction: float = 1.0
    distance: float = 5.0
    t_bar: float = 0.7
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("latent_dim", "ff_size", "num_layers", "num_heads", "window", "batch", "warmup"):
            if getattr(self, name) < 1:
                raise InputError(f"{name} is {getattr(self, name)}: give 1 or more.")
        if self.latent_dim % self.num_heads:
            raise InputError(
                f"latent_dim {self.latent_dim} cannot be shared by {self.num_heads} heads: give a multiple."
            )


def masked_mean(values: Tensor, mask: Tensor) -> Tensor:
    """Mean over the real rows of each sample: values and mask (B, K) → (B,)."""
    return (values * mask).sum(1) / mask.sum(1).clamp_min(1)


def interaction_loss(predicted: Tensor, reactor: Tensor, actor: Tensor, mask: Tensor) -> Tensor:
    """ReGenNet's interaction loss (eq. 3–4): relative pose, orientation and translation → (B,).

    Positions (B, K, 22, 3); the actor is the true one on both sides, so its part falls away in pose and
    translation. The paper's orientation is the root's relative rotation matrix. The motion here is positions
    without rotations, so it is the angle about Y from the actor's facing to the reactor's, as (cos, sin); how
    the pelvis leans enters through the pose alone. The trainer damps the loss, which the paper does not.
    """

    def turned(person: Tensor) -> Tensor:
        a, b = facing(actor), facing(person)
        cos = (a * b).sum(-1)
        return torch.stack([cos, a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]], dim=-1)

    pose = (predicted - predicted[..., :1, :] - reactor + reactor[..., :1, :]).square().sum((-1, -2))
    orientation = (turned(predicted) - turned(reactor)).square().sum(-1)
    translation = (predicted[..., 0, :] - reactor[..., 0, :]).square().sum(-1)
    return masked_mean(pose + orientation + translation, mask)


def distance_loss(predicted: Tensor, reactor: Tensor, actor: Tensor, mask: Tensor) -> Tensor:
    """Squared error of the distances of the two people's joints that are truly near, m² → (B,)."""
    mode = "donot_use_mm_for_euclid_dist"
    true = torch.cdist(actor, reactor, compute_mode=mode)
    error = (torch.cdist(actor, predicted, compute_mode=mode) - true).square() * (true < NEAR)
    return masked_mean(error.sum((-1, -2)) / (true < NEAR).sum((-1, -2)).clamp_min(1), mask)


class Trainer(Loop):
    """One training run, which resumes from its checkpoint.

    Args:
        words: a shipped InterGen's folder, whose text conditioner is taken over.
        init: a shipped ReGenNet's folder, whose weights, normalisers and text conditioner a new run begins
            with; ``words`` then counts nothing.
    """

    def __init__(
        self, scenes: Scenes, settings: Settings, out: Path, *, words: Path, init: Path | None = None
    ) -> None:
        self.settings, self.out = settings, out
        out.mkdir(parents=True, exist_ok=True)
        torch.manual_seed(settings.seed)
        if init is None:
            language, source = load_intergen(words)
            conditioner = language.conditioner
        else:
            shipped, source = load_folder(init)
            conditioner = shipped.conditioner
        sizes = ("latent_dim", "ff_size", "num_layers", "num_heads", "window")
        self.config = CompactReGenNetConfig(
            **{name: getattr(settings, name) for name in sizes},
            cond_dim=conditioner.config.latent_dim,
            text_layers=conditioner.config.num_layers,
            frames_per_knot=scenes.layout.frames_per_knot,
        )
        self.data = Data(
            scenes,
            size=settings.batch,
            crop=settings.crop,
            recorded=settings.recorded,
            seed=settings.seed,
        )
        self.conditions = Conditions(self.data.captions(), conditioner, out, source.digest)
        self.model = CompactReGenNet(self.config)
        if init is None:
            self.model.conditioner.load_state_dict(conditioner.state_dict())
            self.data.normalize(self.model)
        else:
            known = {k: v for k, v in shipped.state_dict().items() if not k.startswith("touch_reader.")}
            load_strictly(self.model, known, network=init.name)
        self.model.conditioner.requires_grad_(False)
        self.ema = CompactReGenNet(self.config).requires_grad_(False)
        self.ema.load_state_dict(self.model.state_dict())
        self.trained = [p for p in self.model.parameters() if p.requires_grad]
        self.averaged = [
            p for p, q in zip(self.ema.parameters(), self.model.parameters(), strict=True) if q.requires_grad
        ]
        self.optimizer = adamw(self.trained, settings)
        self.schedule = NoiseSchedule()
        self.weights = torch.ones(FEATURES)
        self.weights[:3] = settings.root_weight
        self.restore(asdict(settings))

    def terms(self, batch: Batch, generator: torch.Generator) -> dict[str, Tensor]:
        """Every loss term of one batch, weighted."""
        s, model = self.settings, self.model
        size = len(batch.mask)
        t = draw_timesteps(size, self.schedule.timesteps, s.noisiest, generator)
        x0 = (batch.reactor - model.mean) / model.std
        xt = self.schedule.q_sample(x0, t, torch.randn(x0.shape, generator=generator))
        keep = torch.rand(size, 1, generator=generator) >= s.cond_drop_prob
        causal = bool(torch.rand(1, generator=generator) >= s.offline)
        start = torch.randint(150, (size,), generator=generator)
        start = start * (torch.rand(size, generator=generator) < 0.5)
        seen = seen_rows(batch.actor)
        seen = seen + s.jitter * torch.randn(seen.shape, generator=generator)
        seen = (seen - model.actor_mean) / model.actor_std
        given = (torch.rand(size, generator=generator) < s.begin) | batch.cropped
        begin = model.begin_row(knot_positions(batch.reactor[:, :3])[:, 0]) * given[:, None]
        with mixed_precision("cpu"), sdpa_kernel(SDPBackend.MATH):
            predicted = model(xt, t, seen, batch.words * keep, causal=causal, start=start, begin=begin)
        predicted = predicted.float()
        error = ((predicted - x0).square() * self.weights).mean(-1)
        terms = {"simple": masked_mean(error, batch.mask).mean()}

        reactor, actor = knot_positions(batch.reactor), knot_positions(batch.actor)
        moved = predicted * model.std + model.mean
        made = knot_positions(moved)
        mask = batch.mask[:, 2:]
        early = t <= s.t_bar * self.schedule.timesteps
        stands = batch.reactor[:, 2:, -NUM_CONTACTS:] > 0.5
        step = made[:, 1:, list(FEET)] - made[:, :-1, list(FEET)]
        between = mask[:, 1:]
        losses = {
            "velocity": masked_mean(
                (made.diff(dim=1) - reactor.diff(dim=1)).square().mean((-1, -2)), between
            ),
            "bone_length": masked_mean((bone_lengths(made) - bone_lengths(reactor)).square().mean(-1), mask),
            "foot_contact": masked_mean((step.square().sum(-1) * stands[:, 1:]).mean(-1), between),
            "interaction": interaction_loss(made, reactor, actor, mask),
            "distance": distance_loss(made, reactor, actor, mask),
        }
        return terms | {
            name: getattr(s, name) * (value * early).sum() / early.sum().clamp_min(1)
            for name, value in losses.items()
        }

    def train_step(self) -> dict[str, float]:
        """One optimiser step; returns the loss terms."""
        batch = self.data.batch(self.step, self.conditions)
        self.model.train()
        terms = self.terms(batch, seeded(self.settings.seed, 3, self.step))
        total = torch.stack(list(terms.values())).sum()
        self.optimizer_step(total, self.optimizer, self.trained)
        self.ema_update(self.averaged, self.trained)
        return {name: value.item() for name, value in terms.items()} | {"total": total.item()}


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Train the compact ReGenNet on prepared scenes.")
    parser.add_argument("--scenes", type=Path, required=True, help="file of `python -m training.prepare`")
    parser.add_argument(
        "--words", type=Path, default=Path("models/weights/intergen"),
        help="a shipped InterGen, whose text conditioner is taken over",
    )  # fmt: skip
    parser.add_argument("--init", type=Path, help="begin with a shipped ReGenNet, its words and all")
    parser.add_argument("--export", type=Path, help="after that, write the averaged weights to this folder")
    add_run_options(parser, Settings)
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    trainer = Trainer(
        load(options.scenes), chosen(options, Settings), options.out, words=options.words, init=options.init
    )
    trainer.run_logged(minutes=options.minutes)
    if options.export:
        model, reads = with_touches(trainer.ema, trainer.data.scenes)
        print(f"touches read from test captions: {reads:.1%}")
        save_network(options.export, model, card={"summary": SUMMARY}, trained_steps=trainer.step)


if __name__ == "__main__":
    raise SystemExit(main())
