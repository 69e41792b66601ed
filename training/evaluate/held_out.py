"""Scores networks on held-out scenes: ``python -m training.evaluate.held_out``.

The error of the predicted clean motion (InterGen's eq. 8 with more weight on where people stand, as in training) on
the test split, by timestep, for the same scenes, sentences and noise. It says within minutes whether a training goes
the right way, long before motions can be judged.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import fields, replace
from pathlib import Path

import torch
from torch import Tensor

from models.diffusion import NoiseSchedule
from models.intergen.compact import CompactInterGen
from models.intergen.losses import simple_loss
from models.known import Hold
from models.weights_io import load_network
from motion import InputError
from training.core import checkpoint
from training.core.shell import add_options, exit_code
from training.prepare import Scenes, load
from training.trainers.given import Shares, known_parts
from training.trainers.intergen import condition, new_model
from training.trainers.intergen_data import Data, OneSentence, Settings, seeded, settings_of
from training.trainers.scenes import feature_weights

TIMESTEPS = (200, 500, 800, 900, 950, 980, 999)
NOTHING = Shares(*[0.0] * len(fields(Shares)))
GIVEN = {"nothing": NOTHING} | {
    kind: replace(NOTHING, **{kind: 1.0}) for kind in ("person", "past", "span", "poses", "path", "places")
}


def load_model(path: Path, data: Data) -> CompactInterGen:
    """The network of a weights folder, or the averaged one of a training's folder."""
    if (path / "config.json").exists():
        return load_network(path, CompactInterGen)[0]
    last = path / "last.safetensors"
    model = new_model(settings_of(last), data)
    checkpoint.restore_part(last, "ema", model)
    return model.eval().requires_grad_(False)


@torch.no_grad()
def errors(model: CompactInterGen, data: Data, kind: str, batches: int, std: Tensor) -> Tensor:
    """(timesteps,) mean errors in units of ``std`` (70,), whatever those of the model are.

    ``kind`` is a name of :data:`GIVEN`.
    """
    schedule, layout = NoiseSchedule(), data.scenes.layout
    data.mean, data.std = model.mean, model.std
    weights = feature_weights(Settings().root_weight, layout) * (model.std / std).repeat(layout.knots_per_token)
    total = torch.zeros(len(TIMESTEPS))
    for step in range(batches):
        batch = data.batch(step)
        cond = condition(model, batch)
        frames = batch.frame_mask.sum(1).int().tolist()
        known = known_parts(model.control(batch.x0), frames, [0] * len(frames), layout, GIVEN[kind], seeded(step, 1))
        hold = None if known is None else Hold(known, layout, model.mean, model.std)
        seen = model.shown(None if hold is None else hold.features)
        noise = torch.randn(batch.x0.shape, generator=seeded(step, 2))
        for i, timestep in enumerate(TIMESTEPS):
            t = torch.full((len(batch.x0),), timestep)
            xt = schedule.q_sample(batch.x0, t, noise)
            made = model.denoiser(xt if hold is None else hold(xt), t, cond, batch.mask, seen)
            made = made if hold is None else hold(made)
            people = [x.view(*x.shape[:2], 2, -1) * weights for x in (made, batch.x0)]
            total[i] += simple_loss(*people, batch.mask)
    return total / batches


def of_test_split(scenes: Scenes) -> Scenes:
    """The test split in the place of the training split."""
    rows = [row | {"split": "train", "beats": []} for row in scenes.split("test")]
    return Scenes(scenes.control, rows, scenes.layout)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Compare networks by their errors on scenes of the test split.")
    add_options(parser, "scenes")
    parser.add_argument("--cache", type=Path, required=True, help="folder that keeps the features of sentences")
    parser.add_argument("--models", type=Path, nargs="+", required=True, help="weights folders or runs")
    parser.add_argument("--given", nargs="+", choices=GIVEN, default=["nothing"], help="what is given (nothing)")
    parser.add_argument("--alone", action="store_true", help="read the sentences for each person, too")
    parser.add_argument("--batches", type=int, default=4, help="of 16 scenes (4)")
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    scenes = of_test_split(load(options.scenes))
    settings = Settings(batch=16, cond_drop_prob=0.0, continued=0.0)
    if len(scenes.rows) < settings.batch:
        raise InputError(f"The test split holds {len(scenes.rows)} scenes: build a corpus with 16 or more.")
    data = (Data if options.alone else OneSentence)(scenes, settings, options.cache, "cpu")
    std = data.std
    for path in options.models:
        model = load_model(path, data)
        for kind in options.given:
            by_timestep = errors(model, data, kind, options.batches, std)
            by_step = {str(t): round(float(e), 4) for t, e in zip(TIMESTEPS, by_timestep, strict=True)}
            print(json.dumps({"model": path.name, "given": kind} | by_step), flush=True)


if __name__ == "__main__":
    raise SystemExit(main())
