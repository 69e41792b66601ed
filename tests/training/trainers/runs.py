"""A corpus that takes a moment to make, and InterGen's trainer with a network as small as possible."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from safetensors.torch import load_file
from torch import Tensor

from motion import SMPL22
from training import prepare
from training.core.loop import Loop
from training.trainers.intergen import Trainer
from training.trainers.intergen_data import Settings

SETTINGS = Settings(
    latent_dim=32, ff_size=32, num_layers=2, num_heads=2, cond_dim=64, batch=4, steps=6, warmup=2, dropout=0.1
)
SIZES = ("latent_dim", "ff_size", "num_layers", "num_heads", "cond_dim", "batch", "warmup", "dropout")
HANDS_MEET = [{"a": "right_wrist", "b": "right_wrist", "start": 10, "end": 20}]


def write_corpus(folder: Path, scenes: int = 10, edit: Callable[[list[dict[str, Any]]], None] | None = None) -> Path:
    """Two people who sway, for one to two seconds a scene; ``edit`` changes the rows of the index."""
    rng = np.random.default_rng(0)
    rest = SMPL22.rest_positions() + np.array([0, 0.98, 0])
    motions, index, start = [], [], 0
    for i in range(scenes):
        frames = int(rng.integers(40, 60))
        time = np.arange(frames) / 30
        a = rest + 0.05 * np.sin(rng.uniform(2, 6) * time)[:, None, None] * rng.normal(size=(1, 22, 3))
        b = np.broadcast_to(rest * [-1, 1, -1] + [0, 0, 1.5], a.shape)
        motions.append(np.stack([a, b], axis=1))
        captions = ["They shake hands." if i % 2 else "One person waves the left hand."] * 2
        split = "test" if i == 0 else "train"
        index.append(
            {"start": start, "frames": frames, "family": "sway", "captions": captions, "split": split}
            | {"events": {"contact": HANDS_MEET} if i % 2 else {}, "sources": []}
        )
        start += frames
    if edit is not None:
        edit(index)
    folder.mkdir()
    np.save(folder / "motions.npy", np.concatenate(motions).astype(np.float32))
    (folder / "index.json").write_text(json.dumps(index))
    return folder


def prepared(folder: Path, **known: Any) -> Path:
    """The file of prepared scenes of such a corpus, both in ``folder``."""
    out = folder / "scenes.safetensors"
    assert prepare.main(["--corpus", str(write_corpus(folder / "corpus", **known)), "--out", str(out)]) == 0
    return out


def begin(scenes: Path, out: Path, settings: Settings = SETTINGS, **options: Any) -> Trainer:
    return Trainer(prepare.load(scenes), settings, out, **options)


def flags(settings: object, *names: str) -> list[str]:
    """Some settings as the words of a command."""
    return [word for name in names for word in ("--" + name.replace("_", "-"), str(getattr(settings, name)))]


def take(trainer: Loop, steps: int) -> list[dict[str, float]]:
    """Takes some steps, as a run that is stopped then: saved where it stands; the loss terms of each."""
    terms = [trainer.train_step() for _ in range(steps)]
    trainer.save()
    return terms


def resumed(
    begin: Callable[[Path], Loop], folder: Path, steps: int = 4, stops: int = 2
) -> tuple[list[dict[str, float]], dict[str, Tensor]]:
    """A run that ``stops`` goes on as if it never had: the loss terms of its steps, and the tensors that it keeps."""
    whole = take(begin(folder / "whole"), steps)
    parts = take(begin(folder / "parts"), stops)
    again = begin(folder / "parts")
    assert again.step == stops
    assert [*parts, *take(again, steps - stops)] == whole
    one, other = (load_file(folder / name / "last.safetensors") for name in ("whole", "parts"))
    assert one.keys() == other.keys()
    assert [key for key in one if not torch.equal(one[key], other[key])] == []
    return whole, one
