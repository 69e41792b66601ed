"""Ablations of InterGen's parts: ``python -m training.evaluate.ablations --scenes F --extractor F --out DIR``.

The paper's Tables 3 and 4 on our corpus: the damping threshold t̄ of the regularisers, the distance-map and
relative-orientation losses, weight sharing, and mutual attention against concatenation. Every variant is a
smaller network trained from the same seed for the same number of steps, sampled without damping and judged by
the same rules and features. ``--out`` keeps a run and its scores for each variant, so a run that is stopped
goes on where it was; the table shows the variants that are done.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn

from models.intergen import Block, InterGenConfig, InterGenDenoiser
from models.intergen.compact import CompactInterGen
from models.layers import sinusoids
from models.text import MiniLM
from motion import Duet, InputError
from motion.formats.files import write_text
from training.core import checkpoint
from training.core.shell import add_options, exit_code
from training.evaluate.extractor import load_extractor
from training.evaluate.judge import retrieval
from training.evaluate.judge.draw import Sampling, draw
from training.evaluate.judge.prompts import choose
from training.evaluate.judge.report import score
from training.evaluate.judge.rules import CHECKS, Task
from training.prepare import Scenes, load
from training.trainers.given import Shares
from training.trainers.intergen import Trainer, new_model
from training.trainers.intergen_data import Data, Settings

SMALL = Settings(
    latent_dim=192,
    ff_size=512,
    num_layers=4,
    num_heads=4,
    cond_dim=192,
    warmup=100,
    ema=0.995,
    words=False,
    given=Shares(span=0.0, poses=0.0, path=0.0, joints=0.0, more=0.0),
    weights=replace(Settings().weights, distance_map=5.0, contact=0.0),
)


class ConcatDenoiser(InterGenDenoiser):
    """Table 3, concat-conditioning: each person's input is joined by the other's; no mutual attention."""

    def __init__(self, config: InterGenConfig) -> None:
        super().__init__(config)
        self.motion_embed = nn.Linear(2 * config.input_features, config.latent_dim)
        for block in self.blocks:
            del block.ca_block

    def forward(self, x: Tensor, t: Tensor, cond: Tensor, mask: Tensor | None = None) -> Tensor:
        """As :meth:`models.intergen.InterGenDenoiser.forward`."""
        b, length, _ = x.shape
        people = x.view(b, length, 2, -1).permute(2, 0, 1, 3)
        emb = self.embed(t, cond)
        h = self.motion_embed(torch.cat([people, people.flip(0)], dim=-1))
        h = h + sinusoids(length, self.config.latent_dim, device=x.device)
        h = h + self.role_embedding[:, None, None]
        keep = None if mask is None else (mask != 0).permute(2, 0, 1).flatten(0, 1)
        for block in self.blocks:
            h = h + block.sa_block(h, emb, keep)
            h = h + block.ffn(h, emb)
        return self.out(h).permute(1, 2, 0, 3).reshape(b, length, -1)


class _Pair(nn.Module):
    """A layer for each person; both see the states of both."""

    def __init__(self, config: InterGenConfig) -> None:
        super().__init__()
        self.people = nn.ModuleList(Block(config) for _ in range(2))

    def forward(self, h: Tensor, emb: Tensor, keep: Tensor | None, keep_other: Tensor | None) -> Tensor:
        return torch.stack([block(h, emb, keep, keep_other)[i] for i, block in enumerate(self.people)])


class UnsharedDenoiser(InterGenDenoiser):
    """Table 3, w/o weights sharing: the two people's layers have weights of their own."""

    def __init__(self, config: InterGenConfig) -> None:
        super().__init__(config)
        self.blocks = nn.ModuleList(_Pair(config) for _ in range(config.num_layers))


@dataclass(frozen=True)
class Variant:
    """A row of the table: the one thing that differs from the whole network, or from another variant, ``base``."""

    label: str
    changes: dict[str, Any]
    denoiser: type[InterGenDenoiser] = InterGenDenoiser
    base: str = ""

    def settings(self, whole: Settings) -> Settings:
        """The settings of its training, from those of the whole network."""
        return replace(VARIANTS[self.base].settings(whole) if self.base else whole, **self.changes)


def _without(term: str) -> dict[str, Any]:
    return {"weights": replace(SMALL.weights, **{term: 0.0})}


VARIANTS: dict[str, Variant] = {
    "whole": Variant("whole, t̄ = 0.7", {}),
    # Of the whole network's timesteps a share is drawn from the noisiest tenth, which t̄ = 0.7 leaves out and
    # t̄ = 1 takes in. t̄ alone is therefore compared under even draws, and the draw alone at t̄ = 0.7.
    "even": Variant("timesteps drawn evenly, t̄ = 0.7", {"noisiest": 0.0}),
    "even_t_bar_0": Variant("drawn evenly, t̄ = 0 (no regularisers)", {"t_bar": 0.0}, base="even"),
    "even_t_bar_0.3": Variant("drawn evenly, t̄ = 0.3", {"t_bar": 0.3}, base="even"),
    "even_t_bar_1": Variant("drawn evenly, t̄ = 1", {"t_bar": 1.0}, base="even"),
    "t_bar_0": Variant("t̄ = 0 (no regularisers)", {"t_bar": 0.0}),
    "t_bar_0.3": Variant("t̄ = 0.3", {"t_bar": 0.3}),
    "t_bar_1": Variant("t̄ = 1", {"t_bar": 1.0}),
    "no_distance_map": Variant("without distance-map loss", _without("distance_map")),
    "no_orientation": Variant("without relative-orientation loss", _without("relative_orientation")),
    "unshared": Variant("without weight sharing", {}, UnsharedDenoiser),
    "concat": Variant("concatenation for mutual attention", {}, ConcatDenoiser),
}


def builder(variant: Variant) -> Callable[[Settings, Data], CompactInterGen]:
    """Makes a variant's untrained network, as :func:`training.trainers.intergen.new_model` does the whole one."""

    def build(settings: Settings, data: Data) -> CompactInterGen:
        model = new_model(settings, data)
        if variant.denoiser is not InterGenDenoiser:
            model.denoiser = variant.denoiser(model.denoiser.config)
        return model

    return build


class _Generator:
    """A generator for :func:`training.evaluate.judge.draw.draw` around a network in memory."""

    def __init__(self, model: CompactInterGen, encoder: MiniLM) -> None:
        self.model, self.encoder = model, encoder

    @torch.no_grad()
    def condition(self, prompt: str) -> tuple[Tensor, Tensor]:
        tokens = self.encoder([prompt])
        return self.model.condition(tokens), tokens.pooled()[0]


def judge_variant(
    scenes: Scenes, model: CompactInterGen, options: argparse.Namespace, encoder: MiniLM
) -> dict[str, Any]:
    """Shares of checks that pass, physical measures and InterGen's measures of one trained variant."""
    generator = _Generator(model.cpu().eval(), encoder)
    tasks = [task for task, _ in choose(scenes, options.prompts)]
    sampling = Sampling(steps=options.sampling_steps, guidance=3.0, damping=0.0)

    def drawn(tasks: Sequence[Task], seed: int) -> Iterator[tuple[int, Duet]]:
        return draw(generator, tasks, replace(sampling, seed=seed))

    found = dict(drawn(tasks, 0))
    scores = score([found[i] for i in range(len(tasks))], tasks)
    features = retrieval.measure(
        scenes, load_extractor(options.extractor), drawn, prompts=options.prompts, repeats=options.repeats
    )
    return {"checks": scores["checks"], "physical": scores["physical"], "features": features}


def table(found: dict[str, dict[str, Any]]) -> str:
    """One row a variant that is done, in the order of :data:`VARIANTS`."""
    head = ["R-precision top 3", "FID", "MM distance", *CHECKS, "foot skate, cm/s", "jerk, m/s³"]
    lines = [f"| Variant | {' | '.join(head)} |", "|---" * (len(head) + 1) + "|"]
    if found:
        real = next(iter(found.values()))["features"]["real"]
        cells = [f"{real[key][0]:.3f}" for key in ("top 3", "FID", "MM distance")]
        lines.append(f"| real motion | {' | '.join(cells)} |{' – |' * (len(head) - 3)}")
    for name, variant in VARIANTS.items():
        if name not in found:
            continue
        scores = found[name]
        made = scores["features"]["generated"]
        cells = [f"{made[k][0]:.3f} ± {made[k][1]:.3f}" for k in ("top 3", "FID", "MM distance")]
        for check in CHECKS:
            counted = scores["checks"][check]
            share = f"{100 * counted['passed'] / counted['count']:.0f} %" if counted["count"] else "–"
            cells.append(share)
        cells += [f"{scores['physical'][key]:.1f}" for key in ("foot_skate", "jerk")]
        lines.append(f"| {variant.label} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Train and judge InterGen's ablations on prepared scenes.")
    add_options(parser, "scenes", "table", "device")
    parser.add_argument("--extractor", type=Path, required=True, help="file of training.evaluate.extractor")
    parser.add_argument("--out", type=Path, required=True, help="folder of the runs and scores")
    parser.add_argument("--variants", nargs="+", choices=VARIANTS, default=list(VARIANTS))
    parser.add_argument("--steps", type=int, default=2000, help="training steps of each (2000)")
    parser.add_argument("--prompts", type=int, default=200, help="test captions (200)")
    parser.add_argument("--repeats", type=int, default=2, help="of the measures by features (2)")
    parser.add_argument("--sampling-steps", type=int, default=25, help="DDIM steps (25)")
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace, small: Settings = SMALL) -> None:
    scenes, encoder = load(options.scenes), MiniLM()
    for name in options.variants:
        path = options.out / name / "scores.json"
        if path.exists():
            continue
        variant = VARIANTS[name]
        settings = variant.settings(replace(small, steps=options.steps))
        trainer = Trainer(
            scenes, settings, options.out / name, device=options.device, cache=options.out,
            build=builder(variant),
        )  # fmt: skip
        for _ in trainer.run(minutes=1e9):
            if trainer.step % 200 == 0:
                print(f"{name}: step {trainer.step} of {settings.steps}", flush=True)
        scores = judge_variant(scenes, trainer.ema, options, encoder)
        write_text(path, json.dumps(scores, indent=1) + "\n")
    found = {}
    for name in VARIANTS:
        if (path := options.out / name / "scores.json").exists():
            try:
                found[name] = json.loads(path.read_text())
            except ValueError as error:
                raise InputError(f"{path} is damaged ({error}): delete it to judge {name} again.") from error
    meta = checkpoint.metadata(options.out / options.variants[0] / "last.safetensors")
    shown = (
        f"Each variant: {meta['step']} steps of {small.batch}, width {small.latent_dim}, {small.num_layers} "
        f"layers; {options.prompts} test captions, DDIM-{options.sampling_steps}, guidance 3, no damping; "
        f"means of {options.repeats} repeats with 95 % intervals.\n\n{table(found)}"
    )
    if options.table:
        write_text(options.table, shown)
    print(shown)


if __name__ == "__main__":
    raise SystemExit(main())
