"""Trains the compact InterFormer: ``python -m training.interformer --data DIR --out DIR``.

Chopin's thesis, section 3.3.4: mean squared error of the next pose (eq. 3.8) and of the first step (eq.
3.9), on the recorded pairs of SBU and K3HI; their published test lists stay out. Ours besides: a loss on
the distances of joints that are near the other person; mirror images, turns, sizes, speeds and noise, since
there are some 350 clips; and, now and then, the network's own reactions as the past that it goes on from.
Of several such reactions to an actor, each of another noise, only the nearest to the recorded one is
learned from, so that a noise comes to stand for a way to react instead of for their mean (Li and Malik
2018, implicit maximum likelihood).

Before the first step the linear part is solved by ridge regression on pasts that go astray, then again on
those that it makes itself (Ross et al. 2011, dataset aggregation), and stays as it is.

Everything random is drawn from the seed and the step number, so a run that stops goes on as if it had not.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from models.compact_interformer import (
    FPS,
    JOINTS_15,
    CompactInterFormer,
    CompactInterFormerConfig,
)
from models.folder import save_network
from models.interformer import JOINTS
from models.interformer_decoding import ReactionDecoder
from training import checkpoint
from training.corpus.pairs import load_pairs
from training.loop import Loop
from training.shell import add_run_options, chosen, exit_code
from webdemo.motion import InputError
from webdemo.motion.skeleton import SBU15
from webdemo.motion.transforms import canonicalize, mirrored, turn

Array = NDArray[np.floating]

RECORDED_FPS = 30.0
NEAR = 1.0
"""Metres: joints of the two people that are nearer than this count in the loss on their distance."""
SHORTEST = 9
"""Frames of a training window at least."""
_IMPORTANCE = {"wrist": 2.0, "elbow": 1.5, "foot": 1.5}


@dataclass(frozen=True)
class Settings:
    """What a run depends on; a checkpoint of other settings is refused.

    own_past: share of batches whose past is the network's own. tries: reactions made to every actor there,
    the nearest of which is learned from. drift: metres by which the others' recorded past goes astray in
    the end. jitter: metres of noise on the actor. crop: share of clips that begin late. turn (degrees), size
    and speed (shares): by how much a scene is changed at most. rounds and ridge: how often the linear part is
    solved, and its penalty. hold: clips kept to be tried on.
    """

    joint_width: int = 8
    encoder_layers: int = 1
    decoder_layers: int = 2
    heads: int = 4
    ff_size: int = 240
    window: int = 48
    dropout: float = 0.1
    batch: int = 32
    steps: int = 600
    learning_rate: float = 1.5e-3
    warmup: int = 20
    weight_decay: float = 0.02
    ema: float = 0.98
    tries: int = 2
    own_past: float = 0.3
    drift: float = 0.1
    jitter: float = 0.01
    crop: float = 0.3
    turn: float = 12.0
    size: float = 0.08
    speed: float = 0.25
    velocity: float = 0.3
    first_frame: float = 1.0
    interaction: float = 0.5
    rounds: int = 3
    ridge: float = 1e-4
    hold: int = 24
    seed: int = 0


@dataclass(frozen=True)
class Batch:
    """actor and reactor (B, T, J, 3) metres, mask (B, T) bool."""

    actor: Tensor
    reactor: Tensor
    mask: Tensor


def varied(people: Array, settings: Settings, rng: np.random.Generator) -> Array:
    """Another scene much like a recorded one, at the network's rate: (2, T, 22, 3) → (2, T', 22, 3)."""
    if rng.random() < 0.5:
        people = mirrored(people)
    first = 0
    latest = people.shape[1] - 2 * SHORTEST
    if latest > 1 and rng.random() < settings.crop:
        first = int(rng.integers(1, latest))
    speed = RECORDED_FPS / FPS * (1 + settings.speed * rng.uniform(-1, 1))
    length = min(settings.window, int((people.shape[1] - 1 - first) / speed) + 1)
    people = _between(people, first + speed * np.arange(length))
    people = canonicalize(people) * (1 + settings.size * rng.uniform(-1, 1))
    return turn(people, math.radians(settings.turn) * rng.uniform(-1, 1), np.zeros(3))


def _between(people: Array, times: Array) -> Array:
    """Frames at fractional times."""
    below = np.minimum(times.astype(int), people.shape[1] - 2)
    share = (times - below)[None, :, None, None]
    return (1 - share) * people[:, below] + share * people[:, below + 1]


def collate(scenes: Sequence[Array]) -> Batch:
    """Scenes (2, T, 22, 3) of the network's rate as a batch of their 15 joints; last poses fill it up."""
    longest = max(scene.shape[1] for scene in scenes)
    padded = np.stack(
        [np.pad(s, ((0, 0), (0, longest - s.shape[1]), (0, 0), (0, 0)), mode="edge") for s in scenes]
    )
    people = torch.from_numpy(padded[..., list(JOINTS_15), :]).float()
    lengths = torch.tensor([scene.shape[1] for scene in scenes])
    return Batch(people[:, 0], people[:, 1], torch.arange(longest) < lengths[:, None])


def masked_mean(values: Tensor, mask: Tensor) -> Tensor:
    """(B,) means of (B, T) over the frames of the mask."""
    return (values * mask).sum(-1) / mask.sum(-1).clamp_min(1)


class Trainer(Loop):
    """One training run; goes on from its checkpoint.

    Args:
        scenes: (2, T, 22, 3) metres each, 30 fps, canonical; the first person acts.
        settings: a checkpoint of others is refused.
        out: folder of ``last.safetensors`` and the log.
    """

    def __init__(self, scenes: Sequence[Array], settings: Settings, out: Path) -> None:
        if len(scenes) <= settings.hold:
            raise InputError(
                f"{len(scenes)} training pairs are too few to keep {settings.hold}: lower --hold."
            )
        self.settings, self.out = settings, out
        out.mkdir(parents=True, exist_ok=True)
        torch.manual_seed(settings.seed)
        order = np.random.default_rng(settings.seed).permutation(len(scenes))
        self.held = [scenes[i] for i in order[: settings.hold]]
        self.scenes = [scenes[i] for i in order[settings.hold :]]
        names = {f.name for f in fields(CompactInterFormerConfig)}
        sizes = {k: v for k, v in asdict(settings).items() if k in names}
        self.model = CompactInterFormer(CompactInterFormerConfig(**sizes))
        self._normalize()
        if not (out / "last.safetensors").exists():
            self._solve()
        self.model.linear.requires_grad_(False)
        self.ema = CompactInterFormer(self.model.config).requires_grad_(False).eval()
        self.ema.load_state_dict(self.model.state_dict())
        self.optimizer = torch.optim.AdamW(
            self.trained(), lr=settings.learning_rate, weight_decay=settings.weight_decay
        )
        weights = [
            next((w for part, w in _IMPORTANCE.items() if part in name), 1.0) for name in SBU15.joint_names
        ]
        self.importance = torch.tensor(weights) / np.mean(weights)
        self.settings_json = json.dumps(asdict(settings), sort_keys=True)
        self.step = checkpoint.restore(out / "last.safetensors", self.parts(), self.settings_json)

    def trained(self) -> list[torch.nn.Parameter]:
        return [p for p in self.model.parameters() if p.requires_grad]

    def parts(self) -> dict[str, torch.nn.Module | torch.optim.Optimizer]:
        return {"model": self.model, "ema": self.ema, "optimizer": self.optimizer}

    def _normalize(self) -> None:
        """Means and deviations of what the network reads and makes, over the training pairs as recorded."""
        every = [collate([scene[:, ::2]]) for scene in self.scenes]
        features: dict[str, list[Tensor]] = {"actor": [], "reactor": []}
        steps = []
        for one in every:
            found = self.model.features(one.actor, one.reactor[:, :-1])
            features["actor"].append(found[0].flatten(0, 1))
            features["reactor"].append(found[1].flatten(0, 1))
            steps.append(one.reactor.diff(dim=1).flatten(0, 1))
        for name, rows in features.items():
            joined = torch.cat(rows)
            getattr(self.model, f"{name}_mean").copy_(joined.mean(0))
            getattr(self.model, f"{name}_std").copy_(joined.std(0).clamp_min(0.02))
        self.model.step_std.copy_(torch.cat(steps).std(0).clamp_min(0.005))
        # A recorded first pose, the one nearest to all others, instead of their mean, which is no pose.
        poses = np.stack([_standing(scene[1, 0]) for scene in self.scenes])
        apart = np.linalg.norm(poses[:, None] - poses[None], axis=-1).sum((1, 2))
        self.model.stance.copy_(torch.from_numpy(poses[int(apart.argmin())]).float())

    @torch.no_grad()
    def _solve(self) -> None:
        """Fits the linear part: next poses after recorded pasts gone astray, then after its own, too."""
        s, model = self.settings, self.model
        rng, generator = np.random.default_rng((s.seed, 2)), torch.Generator().manual_seed(s.seed)
        order = sorted(self.scenes, key=lambda scene: scene.shape[1])
        batches = [
            collate([varied(scene, s, rng) for scene in order[i : i + s.batch]])
            for _ in range(s.rounds)
            for i in range(0, len(order), s.batch)
        ]
        size = model.linear.in_features
        gram = torch.zeros(size, size, dtype=torch.float64)
        right = torch.zeros(size, model.linear.out_features, dtype=torch.float64)
        rows = 0
        model.eval()
        for turn_ in range(s.rounds):
            for batch in batches:
                past = self.astray(batch, generator)
                if turn_:
                    noise = torch.zeros(len(past), model.config.noise)
                    past = ReactionDecoder(model).react(batch.actor, batch.reactor[:, 0], noise, batch.mask)
                past = past[:, :-1]
                seen = batch.mask[:, 1:]
                features = model.linear_features(batch.actor, past)[seen].double()
                steps = ((batch.reactor[:, 1:] - past) / model.step_std).flatten(2)[seen].double()
                gram += features.T @ features
                right += features.T @ steps
                rows += len(features)
            penalty = s.ridge * rows * torch.eye(size, dtype=torch.float64)
            model.linear.weight.copy_(torch.linalg.solve(gram + penalty, right).T)

    def batch(self, rng: np.random.Generator) -> Batch:
        """Scenes of about one length, so that little is padding."""
        s = self.settings
        drawn = rng.choice(len(self.scenes), size=2 * s.batch)
        scenes = sorted((varied(self.scenes[i], s, rng) for i in drawn), key=lambda scene: scene.shape[1])
        first = int(rng.integers(0, s.batch + 1))
        return collate(scenes[first : first + s.batch])

    @torch.no_grad()
    def nearest(self, batch: Batch, actor: Tensor, generator: torch.Generator) -> tuple[Tensor, Tensor]:
        """(noise (B, N), own reaction (B, T, J, 3)): of several, those nearest to the recorded reactions."""
        s, size = self.settings, len(actor)
        noise = torch.randn(s.tries * size, self.model.config.noise, generator=generator)
        actor, mask = actor.repeat(s.tries, 1, 1, 1), batch.mask.repeat(s.tries, 1)
        self.model.eval()
        made = ReactionDecoder(self.model).react(
            actor, batch.reactor[:, 0].repeat(s.tries, 1, 1), noise, mask
        )
        self.model.train()
        made = made.unflatten(0, (s.tries, size))
        error = ((made - batch.reactor).square().sum(-1) * self.importance).mean(-1)
        best = masked_mean(error, batch.mask).argmin(0), torch.arange(size)
        return noise.unflatten(0, (s.tries, size))[best], made[best]

    def astray(self, batch: Batch, generator: torch.Generator) -> Tensor:
        """The recorded reaction going astray little by little, from the true first pose."""
        size, length = batch.mask.shape
        share = torch.linspace(0, 1, length)[None, :, None, None]
        bodies = torch.randn(size, 1, 1, 3, generator=generator) * torch.tensor([1.0, 0.1, 1.0])
        joints = 0.4 * torch.randn(size, 1, JOINTS, 3, generator=generator)
        wobble = 0.005 * torch.randn(batch.reactor.shape, generator=generator)
        wobble[:, 0] = 0
        return batch.reactor + self.settings.drift * share * (bodies + joints) + wobble

    def terms(self, batch: Batch, generator: torch.Generator) -> dict[str, Tensor]:
        """Every loss term of one batch, weighted; squared decimetres."""
        s = self.settings
        actor = batch.actor + s.jitter * torch.randn(batch.actor.shape, generator=generator)
        if torch.rand(1, generator=generator) < s.own_past:
            noise, past = self.nearest(batch, actor, generator)
        else:  # the past tells which reaction it is
            noise, past = torch.zeros(len(actor), self.model.config.noise), self.astray(batch, generator)
        past = past[:, :-1]
        made = self.model(actor, past, noise, batch.mask)
        true, mask = batch.reactor[:, 1:], batch.mask[:, 1:]

        def mean(error: Tensor) -> Tensor:
            return 100 * masked_mean((error * self.importance).mean(-1), mask).mean()

        moved, due = made - past, batch.reactor.diff(dim=1)
        first = ((moved - due)[:, 0].square().sum(-1) * self.importance).mean()
        near = torch.cdist(true, batch.actor[:, 1:])
        gap = (torch.cdist(made, batch.actor[:, 1:]) - near).square() * (near < NEAR)
        gap = gap.sum((-1, -2)) / (near < NEAR).sum((-1, -2)).clamp_min(1)
        return {
            "sequence": mean((made - true).square().sum(-1)),
            "velocity": s.velocity * mean((moved - due).square().sum(-1)),
            "first_frame": 100 * s.first_frame * first,
            "interaction": 100 * s.interaction * masked_mean(gap, mask).mean(),
        }

    def train_step(self) -> dict[str, float]:
        """One optimiser step; returns the loss terms."""
        s = self.settings
        batch = self.batch(np.random.default_rng((s.seed, 1, self.step)))
        torch.manual_seed(s.seed * 1_000_003 + self.step)  # of the dropout
        self.model.train()
        terms = self.terms(batch, torch.Generator().manual_seed(s.seed * 999_983 + self.step))
        total = torch.stack(list(terms.values())).sum()
        self.descend(total, self.optimizer, self.trained())
        self.follow(self.ema.parameters(), self.model.parameters())
        return {name: value.item() for name, value in terms.items()} | {"total": total.item()}

    @torch.no_grad()
    def tried(self) -> dict[str, float]:
        """Reactions to the held-out actors: error over that of standing still, and how much they move.

        ``error`` is the mean distance of joints over zero velocity's, ``best`` that of the best of 8 noises,
        ``moves`` the path of the joints over the recorded one's.
        """
        if not self.held:
            return {}
        batch = collate([scene[:, ::2][:, : self.settings.window] for scene in self.held])
        noise = torch.randn(
            8, len(self.held), self.ema.config.noise, generator=torch.Generator().manual_seed(1)
        )
        decoder = ReactionDecoder(self.ema)
        made = torch.stack(
            [decoder.react(batch.actor, batch.reactor[:, 0], one, batch.mask) for one in noise]
        )
        still = batch.reactor[:, :1].expand_as(batch.reactor)

        def apart(people: Tensor) -> Tensor:
            return masked_mean((people - batch.reactor).norm(dim=-1).mean(-1), batch.mask)

        def path(people: Tensor) -> Tensor:
            return (people.diff(dim=-3).norm(dim=-1).mean(-1) * batch.mask[:, 1:]).sum(-1).mean()

        errors = torch.stack([apart(people) for people in made])
        zero = apart(still).mean()
        return {
            "error": (errors.mean() / zero).item(),
            "best": (errors.amin(0).mean() / zero).item(),
            "moves": (path(made[0]) / path(batch.reactor)).item(),
        }

    def save(self) -> None:
        checkpoint.save(self.out / "last.safetensors", self.parts(), self.step, self.settings_json)


def _standing(pose: Array) -> Array:
    """A pose (22, 3) over the origin, facing +Z."""
    return canonicalize(pose[None, None])[0, 0]


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Train the compact InterFormer on SBU and K3HI.")
    parser.add_argument("--data", type=Path, required=True, help="folder that holds sbu and k3hi")
    parser.add_argument("--cache", type=Path, help="folder of the fitted pairs; --data by default")
    parser.add_argument("--export", type=Path, help="after that, write the averaged weights to this folder")
    add_run_options(parser, Settings)
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    pairs = load_pairs(options.data, options.cache)
    learned = [pair.positions for pair in pairs if pair.split == "train"]
    trainer = Trainer(learned, chosen(options, Settings), options.out)

    def after() -> None:
        if trainer.step % 50 == 0:
            print(json.dumps({k: round(v, 3) for k, v in trainer.tried().items()}), flush=True)

    trainer.run_logged(minutes=options.minutes, every=25, after=after)
    if options.export:
        save_network(options.export, trainer.ema, trained_steps=trainer.step)


if __name__ == "__main__":
    raise SystemExit(main())
