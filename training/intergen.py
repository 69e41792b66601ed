"""Trains the compact InterGen: ``python -m training.intergen --scenes FILE --out DIR``.

InterGen (Liang et al., section 4): both people's clean motion from their noised motion, the timestep and a
text vector; x0 prediction, eq. 8, the regularisers of eq. 11–14 and the damping of eq. 15. The motion is
the control points of :mod:`models.motion_tokens`; the regularisers see positions at 30 fps.

Everything random is drawn from the seed and the step number, so a run that stops (``--minutes``, Ctrl+C) and
is started again with the same command goes on exactly as if it had never stopped.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.nn.attention import SDPBackend, sdpa_kernel

from models.compact import CompactConfig, CompactInterGen, WeightsFolder
from models.diffusion import NoiseSchedule
from models.intergen_losses import InterGenLoss, LossWeights, simple_loss
from models.motion_tokens import FEATURES, mirror_control, pack
from training import checkpoint
from training.corpus.captions import mirror_caption
from training.handedness import mirrored
from training.loop import Loop
from training.prepare import Scenes, load, normalizer
from training.reading import CaptionReader
from training.samples import write_sheet
from training.shell import add_run_options, chosen, exit_code
from training.text_features import CaptionFeatures
from webdemo.motion import SMPL22, InputError


@dataclass(frozen=True)
class Settings:
    """What a run depends on; a checkpoint of other settings is refused.

    noisiest: share of samples whose timestep is drawn from the noisiest tenth, where it is decided what
        happens, see :func:`draw_timesteps`.
    """

    latent_dim: int = 320
    ff_size: int = 1024
    num_layers: int = 6
    num_heads: int = 5
    cond_dim: int = 256
    dropout: float = 0.0
    batch: int = 32
    steps: int = 20_000
    learning_rate: float = 4e-4
    warmup: int = 300
    weight_decay: float = 2e-5
    ema: float = 0.9985
    unconditional: float = 0.1
    freeze_person: float = 0.12
    freeze_past: float = 0.08
    root_weight: float = 4.0
    reading_weight: float = 0.1
    t_bar: float = 0.7
    noisiest: float = 0.4
    seed: int = 0
    weights: LossWeights = field(
        default_factory=lambda: LossWeights(
            velocity=300.0,
            foot_contact=300.0,
            bone_length=30.0,
            distance_map=5.0,
            joint_affinity=1.0,
            relative_orientation=0.02,
        )
    )

    def __post_init__(self) -> None:
        for name in ("latent_dim", "ff_size", "num_layers", "num_heads", "cond_dim", "batch", "warmup"):
            if getattr(self, name) < 1:
                raise InputError(f"{name} is {getattr(self, name)}: give 1 or more.")
        if self.latent_dim % self.num_heads:
            raise InputError(
                f"latent_dim {self.latent_dim} cannot be shared by {self.num_heads} heads: give a multiple."
            )


def seeded(*words: int) -> torch.Generator:
    """A generator that depends on all the given numbers, the same on every machine."""
    return torch.Generator().manual_seed(int(np.random.SeedSequence(words).generate_state(1)[0]))


def draw_timesteps(size: int, timesteps: int, noisiest: float, generator: torch.Generator) -> Tensor:
    """(size,) timesteps: a share ``noisiest`` from the last tenth, the others from all.

    A motion's tokens say much the same, so its outline shines through all but the strongest noise: at
    t = 0.95 T a network without words already sees which gesture a scene holds. What the words decide is
    learned above, which is 5 % of uniform draws.
    """
    t = torch.randint(timesteps, (size,), generator=generator)
    late = timesteps - 1 - torch.randint(max(timesteps // 10, 1), (size,), generator=generator)
    return torch.where(torch.rand(size, generator=generator) < noisiest, late, t)


@dataclass
class Batch:
    """x0 (B, tokens, 2·F) normalised, mask (B, tokens, 2), frame_mask (B, T), text features and mask, and
    what the captions say (B, 5), see :mod:`training.reading`."""

    x0: Tensor
    mask: Tensor
    frame_mask: Tensor
    text: Tensor
    text_mask: Tensor
    labels: Tensor


def balanced(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The rows, those of rare families up to three times, so that long scenes do not make a family rare."""
    counts = Counter(row["family"] for row in rows)
    usual = float(np.quantile(list(counts.values()), 0.75))
    return [row for row in rows for _ in range(min(max(round(usual / counts[row["family"]]), 1), 3))]


class Data:
    """Draws batches of similar lengths; batch ``step`` is the same in every run of the same seed."""

    def __init__(
        self, scenes: Scenes, settings: Settings, cache: Path, device: str, *, captions: bool = True
    ) -> None:
        self.scenes, self.settings, self.device = scenes, settings, device
        self.rows = balanced(scenes.split("train"))
        if len(self.rows) < settings.batch:
            raise InputError(f"{len(self.rows)} training scenes do not fill a batch of {settings.batch}.")
        if captions:
            known = {c for row in self.rows for c in row["captions"]}
            known |= {mirror_caption(c) for c in known}
            self.captions = CaptionFeatures(sorted(known), cache, device=device)
        self.mean, self.std = normalizer(scenes, SMPL22.mirror)
        self.tokens = torch.tensor([row["tokens"] for row in self.rows])
        self.reader = CaptionReader(scenes.rows, settings.cond_dim)
        self.batches_an_epoch = len(self.rows) // settings.batch
        self._epoch, self._order = -1, torch.empty(0)

    def _rows_of(self, step: int) -> Tensor:
        epoch, place = divmod(step, self.batches_an_epoch)
        if epoch != self._epoch:
            generator = seeded(self.settings.seed, 1, epoch)
            jitter = torch.rand(len(self.rows), generator=generator) * 6
            by_length = (self.tokens + jitter).argsort()
            spare = len(by_length) % self.settings.batch
            keep = torch.randperm(len(by_length), generator=generator)[spare:].sort().values
            groups = by_length[keep].view(self.batches_an_epoch, -1)
            self._order = groups[torch.randperm(len(groups), generator=generator)]
            self._epoch = epoch
        return self._order[place]

    def caption(self, row: dict[str, Any], draw: float) -> str:
        """What a scene is told by; ``draw`` is uniform in [0, 1)."""
        return row["captions"][int(draw * len(row["captions"]))]

    def features(self, captions: list[str]) -> tuple[Tensor, Tensor]:
        """What the network sees of captions: features (B, …) and their mask."""
        return self.captions.batch(captions)

    def batch(self, step: int) -> Batch:
        settings, layout = self.settings, self.scenes.layout
        rows = [self.rows[i] for i in self._rows_of(step)]
        generator = seeded(settings.seed, 2, step)
        draw = torch.rand(len(rows), 2, generator=generator)
        tokens = -4 * (-max(row["tokens"] for row in rows) // 4)  # few shapes: kernels are made for each
        control = self.mean.expand(len(rows), 2, tokens * layout.knots_per_token, -1).clone()
        mask = torch.zeros(len(rows), tokens, 2)
        frame_mask = torch.zeros(len(rows), layout.num_frames(tokens))
        captions, labels = [], []
        for i, row in enumerate(rows):
            one, caption = self.scenes.scene(row), self.caption(row, float(draw[i, 0]))
            mirror = mirrored(caption, row.get("hand"), float(draw[i, 1]))
            labels.append(self.reader.labels(row, mirror=mirror))
            if mirror:
                one, caption = mirror_control(one, SMPL22.mirror), mirror_caption(caption)
            control[i, :, : one.shape[1]] = one
            mask[i, : row["tokens"]] = 1
            frame_mask[i, : layout.num_frames(row["tokens"])] = 1
            captions.append(caption)
        text, text_mask = self.features(captions)
        x0 = pack((control - self.mean) / self.std, layout)
        return Batch(
            *(x.to(self.device) for x in (x0, mask, frame_mask, text, text_mask, torch.stack(labels)))
        )


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
            layout=data.scenes.layout,
        )
    )
    model.mean.copy_(data.mean)
    model.std.copy_(data.std)
    return model


class Trainer(Loop):
    """One training run: :meth:`run` goes on from wherever its checkpoint stands.

    Args:
        init: whose weights and normaliser a new run begins with: a checkpoint of another run (its average),
            or a folder that was shipped.
        cache: where features of captions are kept, ``out`` by default; runs on the same scenes can share it.
        build: makes the untrained network.
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
    ) -> None:
        self.scenes, self.settings, self.out, self.device = scenes, settings, out, device
        torch.manual_seed(settings.seed)
        self.data = Data(scenes, settings, cache or out, device)
        self.model = build(settings, self.data).to(device)
        if init is not None:
            if init.is_dir():
                shipped = WeightsFolder(init).model()
                shipped.touch_reader = None  # `training.touch` fits a new one to what will be trained here
                self.model.load_state_dict(shipped.state_dict())
            else:
                checkpoint.restore_part(init, "ema", self.model)
        self.ema = build(settings, self.data).to(device).requires_grad_(False)
        self.ema.load_state_dict(self.model.state_dict())
        self.reader = self.data.reader.to(device)
        self.optimizer = torch.optim.AdamW(
            [*self.model.parameters(), *self.reader.parameters()],
            lr=settings.learning_rate,
            weight_decay=settings.weight_decay,
            fused=True,
        )
        self.schedule = NoiseSchedule(device=device)
        self.loss = InterGenLoss(
            settings.weights, t_bar=round(settings.t_bar * self.schedule.timesteps), near_by="truth"
        )
        # Three of 70 numbers say where a person stands; they count more than their share.
        self.feature_weights = torch.ones(FEATURES, device=device)
        self.feature_weights[:3] = settings.root_weight**0.5
        self.feature_weights = self.feature_weights.repeat(scenes.layout.knots_per_token)
        self.settings_json = json.dumps(asdict(settings), sort_keys=True)
        self.step = checkpoint.restore(self.out / "last.safetensors", self.parts(), self.settings_json)
        self.data.mean, self.data.std = self.model.mean.cpu(), self.model.std.cpu()

    def parts(self) -> dict[str, torch.nn.Module | torch.optim.Optimizer]:
        return {"model": self.model, "ema": self.ema, "reader": self.reader, "optimizer": self.optimizer}

    def frozen(self, mask: Tensor, generator: torch.Generator) -> Tensor:
        """(B, tokens, 2) true where a token is given clean: a whole person, or the past of both.

        InterGen, section 5.4: with the noise of one person masked the network learns to answer a given
        person; with that of the past, to go on from it.
        """
        size, tokens, _ = mask.shape
        draw, share = torch.rand(size, generator=generator), torch.rand(size, generator=generator)
        person = torch.randint(2, (size, 1, 1), generator=generator)
        given_person = (draw < self.settings.freeze_person)[:, None, None] & (torch.arange(2) == person)
        past = torch.arange(tokens)[None, :, None] < (0.6 * share * mask[:, :, 0].sum(1).cpu())[:, None, None]
        given_past = (draw > 1 - self.settings.freeze_past)[:, None, None] & past
        return (given_person | given_past).to(mask.device)

    def terms(
        self, batch: Batch, t: Tensor, noise: Tensor, keep: Tensor, frozen: Tensor
    ) -> dict[str, Tensor]:
        """Every loss term of one batch, weighted."""
        people = (*batch.x0.shape[:2], 2, -1)
        xt = self.schedule.q_sample(batch.x0, t, noise)
        xt = torch.where(frozen[..., None], batch.x0.view(people), xt.view(people)).view_as(xt)
        # The fused attention kernel's backward pass is slow for sequences this short.
        with torch.autocast(self.device, torch.bfloat16), sdpa_kernel(SDPBackend.MATH):
            cond = self.model.conditioner(batch.text, batch.text_mask)
            predicted = self.model.denoiser(xt, t, cond * keep[:, None], batch.mask)
        predicted = predicted.float()
        asked = batch.mask * ~frozen
        weighted = [x.view(people) * self.feature_weights for x in (predicted, batch.x0)]
        terms = {
            "simple": simple_loss(*weighted, asked),
            "reading": self.settings.reading_weight * self.reader(cond, batch.labels),
        }
        positions = [self.model.positions(x)[0].transpose(1, 2) for x in (predicted, batch.x0)]
        return terms | self.loss.regularizers(*positions, t, batch.frame_mask)

    def train_step(self) -> dict[str, float]:
        """One optimiser step; returns the loss terms."""
        batch = self.data.batch(self.step)
        generator = seeded(self.settings.seed, 3, self.step)
        size = len(batch.x0)
        t = draw_timesteps(size, self.schedule.timesteps, self.settings.noisiest, generator).to(self.device)
        noise = torch.randn(batch.x0.shape, generator=generator).to(self.device)
        keep = (torch.rand(size, generator=generator) >= self.settings.unconditional).float().to(self.device)
        frozen = self.frozen(batch.mask, generator)
        torch.manual_seed(seeded(self.settings.seed, 4, self.step).initial_seed())  # dropout
        self.model.train()
        terms = self.terms(batch, t, noise, keep, frozen)
        total = torch.stack(list(terms.values())).sum()
        self.descend(total, self.optimizer, self.model.parameters())
        self.follow(self.ema.parameters(), self.model.parameters())
        return {name: value.item() for name, value in terms.items()} | {"total": total.item()}

    def save(self) -> None:
        checkpoint.save(self.out / "last.safetensors", self.parts(), self.step, self.settings_json)


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Train the compact InterGen on prepared scenes.")
    parser.add_argument("--scenes", type=Path, required=True, help="file of `python -m training.prepare`")
    parser.add_argument(
        "--init", type=Path, help="begin with another run's last.safetensors, or a shipped folder"
    )
    parser.add_argument(
        "--sheets", type=float, default=20.0, help="minutes between contact sheets of samples; 0: none (20)"
    )
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    add_run_options(parser, Settings, leave_out=("weights",))
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    settings = chosen(options, Settings)
    trainer = Trainer(load(options.scenes), settings, options.out, init=options.init, device=options.device)
    drawn = time.monotonic()

    def draw() -> None:
        nonlocal drawn
        if options.sheets and time.monotonic() - drawn > options.sheets * 60:
            write_sheet(trainer.ema.eval(), options.out / "samples" / f"{trainer.step:07d}.png")
            drawn = time.monotonic()

    trainer.run_logged(minutes=options.minutes, after=draw)


if __name__ == "__main__":
    raise SystemExit(main())
