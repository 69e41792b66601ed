"""Trains ReGenNet as published: ``python -m training.trainers.regennet_published --motions FILE --out DIR``.

The network of :mod:`models.regennet` over SMPL-X' rotations, under the losses of Xu et al. (eq. 2–4), on motions of
:mod:`training.corpus.interx`. ``--export`` writes the weights under the released names, so that the page takes them as
it takes the authors' (docs/own-model.md). Without action labels: the paper's unconstrained setting.

Forward kinematics uses the bones of SMPL22; fingers, jaw and eyes have no bones there, so the interaction loss sees the
body's 22 joints, and their rotations are learned by eq. 2 alone. All sums are over a frame's numbers, all means over
frames; eq. 2 is also divided by the number of frames, as eq. 4 is.

Everything random is drawn from the seed and the step number, so a run that stops goes on as if it had not.
"""

from __future__ import annotations

import argparse
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from safetensors.torch import save_file
from torch import Tensor

from models.diffusion import NoiseSchedule
from models.regennet import ReGenNet, ReGenNetConfig
from models.regennet.released import BODY
from motion import SMPL22, InputError
from motion.formats.files import replacing
from training.core.loop import Loop, adamw
from training.core.shell import add_options, add_run_options, chosen, exit_code
from training.corpus.interx import Pairs, load_pairs
from training.trainers.intergen_data import seeded


@dataclass(frozen=True)
class Settings:
    """The settings of a run; a checkpoint of others is refused.

    Sizes as in :class:`models.regennet.ReGenNetConfig`. online: a causal decoder, or an encoder that sees the whole
    actor. window: frames that are learned at a time. interaction: weight of eq. 4. The paper gives sizes, batch, steps
    and weight; the rest is ours.
    """

    latent_dim: int = 512
    ff_size: int = 1024
    num_layers: int = 8
    num_heads: int = 4
    online: bool = True
    dropout: float = 0.1
    window: int = 60
    batch: int = 64
    steps: int = 500_000
    learning_rate: float = 1e-4
    warmup: int = 1000
    weight_decay: float = 0.0
    ema: float = 0.999
    interaction: float = 1.0
    seed: int = 0


def rotations_of(rows: Tensor) -> Tensor:
    """(…, 6) numbers, a matrix' first two rows, → (…, 3, 3) rotations, by Gram–Schmidt."""
    x = F.normalize(rows[..., :3], dim=-1)
    y = rows[..., 3:] - (x * rows[..., 3:]).sum(-1, keepdim=True) * x
    y = F.normalize(y, dim=-1)
    return torch.stack([x, y, torch.linalg.cross(x, y)], dim=-2)


def body_joints(rotations: Tensor) -> Tensor:
    """Joints (…, 22, 3) against the root from rotations against the parents (…, 22, 3, 3)."""
    offsets = torch.as_tensor(SMPL22.offsets, dtype=rotations.dtype, device=rotations.device)
    world, places = {0: rotations[..., 0, :, :]}, [torch.zeros_like(rotations[..., 0, :, 0])]
    for parent, joint in SMPL22.bones:
        places.append(places[parent] + world[parent] @ offsets[joint])
        world[joint] = world[parent] @ rotations[..., joint, :, :]
    return torch.stack(places, dim=-2)


def interaction_loss(predicted: Tensor, reactor: Tensor) -> Tensor:
    """Eq. 3–4 for each frame: (…, 56, 6) rows of the predicted and the true reactor → (…).

    The actor is the true one on both sides. So their joints and place fall away in the differences, and their
    orientation does in the norm, which a rotation does not change.
    """
    made, true = (rotations_of(rows[..., :BODY, :]) for rows in (predicted, reactor))
    pose = (body_joints(made) - body_joints(true)).square().sum((-1, -2))
    orientation = (made[..., 0, :, :] - true[..., 0, :, :]).square().sum((-1, -2))
    translation = (predicted[..., -1, :3] - reactor[..., -1, :3]).square().sum(-1)
    return pose + orientation + translation


class Trainer(Loop):
    """One training run, which resumes from its checkpoint in ``out``."""

    def __init__(self, pairs: Pairs, settings: Settings, out: Path, *, device: str = "cpu") -> None:
        self.pairs, self.settings, self.out, self.device = pairs, settings, out, device
        torch.manual_seed(settings.seed)
        names = {f.name for f in fields(ReGenNetConfig)}
        config = ReGenNetConfig(**{k: v for k, v in asdict(settings).items() if k in names})
        self.model, self.ema = ReGenNet(config).to(device), ReGenNet(config).to(device)
        self.ema.load_state_dict(self.model.state_dict())
        self.ema.requires_grad_(False).eval()
        self.optimizer = adamw(self.model.parameters(), settings)
        self.schedule = NoiseSchedule(device=device)
        self.restore(asdict(settings))

    def batch(self) -> tuple[Tensor, Tensor]:
        """Windows of motions drawn at random: (B, T, 2, 56, 6), and (B, T) true where a frame is real.

        A motion that is shorter than a window holds its last frame.
        """
        s, rng = self.settings, np.random.default_rng((self.settings.seed, 1, self.step))
        windows, real = [], []
        for number in rng.choice(len(self.pairs), size=s.batch):
            motion = self.pairs[number]
            first = int(rng.integers(max(len(motion) - s.window, 0) + 1))
            places = torch.arange(first, first + s.window)
            windows.append(motion[places.clamp_max(len(motion) - 1)])
            real.append(places < len(motion))
        return torch.stack(windows).float().to(self.device), torch.stack(real).to(self.device)

    def train_step(self) -> dict[str, float]:
        """One optimiser step; returns the loss terms."""
        windows, real = self.batch()
        actor, reactor = (person.permute(0, 2, 3, 1) for person in windows.unbind(2))  # (B, 56, 6, T)
        generator = seeded(self.settings.seed, 2, self.step)
        t = torch.randint(self.schedule.timesteps, (len(reactor),), generator=generator).to(self.device)
        noise = torch.randn(reactor.shape, generator=generator).to(self.device)
        self.model.train()
        torch.manual_seed(generator.initial_seed())  # of the dropout
        made = self.model(self.schedule.q_sample(reactor, t, noise), t, actor)
        made, true = (rows.permute(0, 3, 1, 2) for rows in (made, reactor))  # (B, T, 56, 6)
        frames = {
            "diffusion": (made - true).square().sum((-1, -2)),
            "interaction": self.settings.interaction * interaction_loss(made, true),
        }
        terms = {name: value[real].mean() for name, value in frames.items()}
        self.optimizer_step(torch.stack(list(terms.values())).sum(), self.optimizer, self.model.parameters())
        self.ema_update(self.ema.parameters(), self.model.parameters())
        return {name: value.item() for name, value in terms.items()}

    def export(self, path: Path) -> None:
        """Writes the averaged weights under the released names."""
        tensors = {name: value.cpu().contiguous() for name, value in self.ema.state_dict().items()}
        with replacing(path) as temporary:
            save_file(tensors, temporary)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.trainers.regennet_published")
    parser.add_argument(
        "--motions", type=Path, required=True, help="file of `python -m training.corpus.interx`"
    )
    parser.add_argument("--export", type=Path, help="after that, write the averaged weights (.safetensors)")
    add_options(parser, "device")
    add_run_options(parser, Settings)
    options = parser.parse_args(argv)
    if options.export and options.export.suffix != ".safetensors":
        parser.error("--export takes a name that ends in .safetensors")

    def job() -> None:
        pairs, settings = load_pairs(options.motions), chosen(options, Settings)
        if settings.latent_dim % settings.num_heads:
            raise InputError(
                f"latent_dim {settings.latent_dim} cannot be shared by {settings.num_heads} heads: give a multiple."
            )
        trainer = Trainer(pairs, settings, options.out, device=options.device)
        trainer.run_logged(minutes=options.minutes)
        if options.export:
            trainer.export(options.export)

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
