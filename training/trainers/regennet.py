"""Trains the compact ReGenNet: ``python -m training.trainers.regennet --scenes FILE --out DIR``.

ReGenNet (Xu et al., section 3.2): the reactor's clean motion from its noised motion, the actor's, the
timestep and words; x0 prediction and the interaction loss of eq. 3–4. One network learns both settings: most
batches are masked causally (online), the others see all of the actor (offline), see
:mod:`models.regennet.compact`. The words' conditioner is that of a shipped InterGen and stays as it is.

Online, a share of the scenes is learned after the network's own past instead of the recorded one, from some step on:
see :mod:`training.trainers.regennet_data`.
"""

from __future__ import annotations

import argparse
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

import torch
from torch import Tensor
from torch.nn.attention import SDPBackend, sdpa_kernel

from models.diffusion import NoiseSchedule
from models.intergen.compact import CompactInterGen
from models.intergen.losses import bone_lengths, facing, joint_distances, masked_mean
from models.motion_tokens import FEATURES, NUM_CONTACTS
from models.regennet.compact import CompactReGenNet, CompactReGenNetConfig
from models.weights_io import common, load_network, save_network
from motion.skeleton import FEET
from training.core.loop import mixed_precision
from training.core.shell import at_least, train
from training.prepare import Scenes, load
from training.trainers.intergen_data import Batch, seeded
from training.trainers.regennet_data import Data, Past, knot_positions, make_past, plan, seen_rows
from training.trainers.scenes import Drawn, SceneTrainer
from training.trainers.touch import with_touches, without_touches

SUMMARY = (
    "ReGenNet (Xu et al.) at width 192 over spline control points: the reaction to a given person, "
    "online or offline. Research and non-commercial use only."
)
"""Summary of the weights on the page."""
APART = 0.45
"""Metres between the pelvises of two people who hug; the loss on walking through one another counts below it."""
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
    own: share of the online scenes whose past the network made itself, from ``own_after`` steps on, growing over
        ``own_growth`` steps.
    rollout: denoising steps of that past at most; sampler: those of the sampler that is imitated.
    apart: weight of the loss on pelvises that come nearer to each other than the recorded ones.
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
    apart: float = 10.0
    own: float = 0.5
    own_after: int = 2000
    own_growth: int = 1000
    rollout: int = 4
    sampler: int = 5
    t_bar: float = 0.7
    seed: int = 0

    def __post_init__(self) -> None:
        sizes = ("latent_dim", "ff_size", "num_layers", "num_heads", "window", "batch", "warmup")
        at_least(self, **dict.fromkeys((*sizes, "own_growth", "rollout"), 1), sampler=2)


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
    true = joint_distances(actor, reactor)
    error = (joint_distances(actor, predicted) - true).square() * (true < NEAR)
    return masked_mean(error.sum((-1, -2)) / (true < NEAR).sum((-1, -2)).clamp_min(1), mask)


def motion_losses(predicted: Tensor, wanted: Tensor, actor: Tensor, mask: Tensor, stands: Tensor) -> dict[str, Tensor]:
    """The losses on positions, not weighted, each (B,).

    Args:
        predicted, wanted: (B, K, 70) control points in metres.
        actor: (B, K − 2, 22, 3) positions at the knots.
        mask: (B, K − 2), 1 at knots that count.
        stands: (B, K − 2, 4), true where the reactor's feet stand.
    """
    made, reactor = knot_positions(predicted), knot_positions(wanted)
    step = made[:, 1:, list(FEET)] - made[:, :-1, list(FEET)]
    between = mask[:, 1:]
    return {
        "velocity": masked_mean((made.diff(dim=1) - reactor.diff(dim=1)).square().mean((-1, -2)), between),
        "bone_length": masked_mean((bone_lengths(made) - bone_lengths(reactor)).square().mean(-1), mask),
        "foot_contact": masked_mean((step.square().sum(-1) * stands[:, 1:]).mean(-1), between),
        "interaction": interaction_loss(made, reactor, actor, mask),
        "distance": distance_loss(made, reactor, actor, mask),
        "apart": apart_loss(made, reactor, actor, mask),
    }


def apart_loss(predicted: Tensor, reactor: Tensor, actor: Tensor, mask: Tensor) -> Tensor:
    """Squared metres by which the pelvises come nearer on the floor than :data:`APART` or, where the recorded ones
    are nearer still, than those: positions (B, K, 22, 3) → (B,)."""

    def gap(person: Tensor) -> Tensor:
        return (person[..., 0, ::2] - actor[..., 0, ::2]).square().sum(-1).add(1e-8).sqrt()

    return masked_mean((gap(reactor).clamp_max(APART) - gap(predicted)).clamp_min(0).square(), mask)


class Trainer(SceneTrainer):
    """One training run, which resumes from its checkpoint.

    Args:
        words: a shipped InterGen's folder, whose text conditioner is taken over.
        init: a shipped ReGenNet's folder, whose weights, normalisers and text conditioner a new run begins
            with; ``words`` then counts nothing.
        workers: processes that draw batches ahead; 0 draws each when it is needed.
    """

    data: Data
    model: CompactReGenNet

    def __init__(
        self,
        scenes: Scenes,
        settings: Settings,
        out: Path,
        *,
        words: Path,
        init: Path | None = None,
        device: str = "cpu",
        workers: int = 0,
    ) -> None:
        self.settings, self.out, self.device, self.workers = settings, out, device, workers
        torch.manual_seed(settings.seed)
        shipped = load_network(init, CompactReGenNet)[0] if init else None
        conditioner = shipped.conditioner if shipped else load_network(words, CompactInterGen)[0].conditioner
        self.config = CompactReGenNetConfig(
            **common(settings, CompactReGenNetConfig),
            cond_dim=conditioner.config.latent_dim,
            text_layers=conditioner.config.num_layers,
            frames_per_knot=scenes.layout.frames_per_knot,
        )
        self.data = Data(scenes, settings, out, device)
        model = CompactReGenNet(self.config)
        if shipped is None:
            model.conditioner.load_state_dict(conditioner.state_dict())
            self.data.normalize(model)
        else:
            without_touches(shipped).loaded(model)
        model.conditioner.requires_grad_(False)
        self.schedule = NoiseSchedule(device=device)
        self.weights = torch.ones(FEATURES, device=device)
        self.weights[:3] = settings.root_weight
        self.used = torch.zeros(())
        self.start(model, device)

    def own_share(self) -> float:
        """The share of online scenes whose past the network makes itself, at this step."""
        s = self.settings
        return s.own * min(max((self.step - s.own_after + 1) / s.own_growth, 0.0), 1.0)

    def network_input(
        self, batch: Batch, actor: Tensor, reactor: Tensor, generator: torch.Generator
    ) -> dict[str, Tensor]:
        """All that the network sees of a batch beside the noised reaction and its timestep, by argument."""
        s, model, size = self.settings, self.model, len(batch.past)
        start = torch.randint(150, (size,), generator=generator)
        start = start * (torch.rand(size, generator=generator) < 0.5)
        given = torch.rand(size, generator=generator) < s.begin
        given = given.to(self.device) | (batch.past > 0)
        seen = seen_rows(actor)
        seen = seen + s.jitter * self.normal(seen, 6)
        return {
            "actor": (seen - model.actor_mean) / model.actor_std,
            "condition": model.conditioner(batch.text, batch.text_mask) * batch.read[:, :1],
            "start": start.to(self.device),
            "begin": model.begin_row(knot_positions(reactor[:, :3])[:, 0]) * given[:, None],
        }

    def predict(self, x: Tensor, t: Tensor, seen: dict[str, Tensor], *, causal: bool) -> Tensor:
        """The network's clean reaction (B, K, 70) in float32; ``seen`` of :meth:`network_input`."""
        # Under a mask, the CPU's fused attention is slower than the plain one.
        plain = sdpa_kernel(SDPBackend.MATH) if self.device == "cpu" else nullcontext()
        with mixed_precision(self.device), plain:
            made: Tensor = self.model(x, t, causal=causal, **seen)
        return made.float()

    def past(
        self, x0: Tensor, t: Tensor, mask: Tensor, seen: dict[str, Tensor], share: float, generator: torch.Generator
    ) -> Past:
        """The noised motion of a batch, with a past of the network's own for a share of the scenes."""
        s = self.settings
        xt = self.schedule.q_sample(x0, t, self.normal(x0, 7))
        if not share:
            none = torch.zeros(len(x0), dtype=torch.bool, device=self.device)
            return Past(xt, t, x0, x0, torch.ones_like(mask, dtype=torch.bool), none)
        rows = mask.sum(1).long().cpu()
        planned = plan(rows, share=share, steps=s.sampler, rollout=s.rollout, generator=generator)

        def predict(x: Tensor, t: Tensor, places: Tensor) -> Tensor:
            return self.predict(x, t, {name: value[places] for name, value in seen.items()}, causal=True)

        noise, std = self.normal(x0, 8), self.model.std
        return make_past(predict, planned, x0, (xt, t), self.schedule, std, steps=s.sampler, noise=noise)

    def terms(self, drawn: Drawn, noise: Tensor) -> dict[str, Tensor]:
        """Every loss term of what was drawn, weighted; ``used`` becomes the share of scenes with a past of its own."""
        s, model, generator = self.settings, self.model, seeded(self.settings.seed, 9, self.step)
        batch, t = drawn.batch, drawn.t
        actor, reactor, mask = self.data.people(batch)
        x0 = (reactor - model.mean) / model.std
        causal = bool(torch.rand(1, generator=generator) >= s.offline)
        seen = self.network_input(batch, actor, reactor, generator)
        past = self.past(x0, t, mask, seen, self.own_share() if causal else 0.0, generator)
        self.used = past.used.float().mean()
        predicted = self.predict(past.x, past.t, seen, causal=causal)
        learned = mask * past.learned
        error = ((predicted - past.wanted).square() * self.weights).mean(-1)
        terms = {"simple": masked_mean(error, learned).mean()}

        # A knot is where three control points meet: of those that are past, it takes the network's own.
        rows = past.learned[..., None]
        full, wanted = (torch.where(rows, x, past.past) * model.std + model.mean for x in (predicted, past.wanted))
        early = past.t <= s.t_bar * self.schedule.timesteps
        stands = reactor[:, 2:, -NUM_CONTACTS:] > 0.5
        losses = motion_losses(full, wanted, knot_positions(actor), learned[:, 2:], stands)
        return terms | {
            name: getattr(s, name) * (value * early).sum() / early.sum().clamp_min(1) for name, value in losses.items()
        }

    def train_step(self) -> dict[str, float]:
        """One optimiser step; returns the loss terms, and the share of scenes with a past of the network's own."""
        return super().train_step() | {"own": self.used.item()}

    def export(self, folder: Path) -> None:
        """Writes the averaged network as it is shipped, with a reader of touches."""
        model = with_touches(self.ema.cpu(), self.data.scenes)
        save_network(folder, model, card={"summary": SUMMARY}, trained_steps=self.step)


def _begin(options: argparse.Namespace, settings: Settings) -> Trainer:
    given = {name: getattr(options, name) for name in ("words", "init", "device", "workers")}
    return Trainer(load(options.scenes), settings, options.out, **given)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    names = ("scenes", "threads", "device", "workers", "export", "words", "init")
    return train(argv, __doc__, Settings, _begin, *names)


if __name__ == "__main__":
    raise SystemExit(main())
