"""A corpus that takes a moment to make, and InterGen's trainer with a network as small as possible."""

import json
from pathlib import Path

import numpy as np

from motion import SMPL22
from training import prepare
from training.trainers.intergen import Trainer
from training.trainers.intergen_data import Settings

SETTINGS = Settings(
    latent_dim=32, ff_size=32, num_layers=2, num_heads=2, cond_dim=64, batch=4, steps=6, warmup=2, dropout=0.1
)
HANDS_MEET = [{"a": "right_wrist", "b": "right_wrist", "start": 10, "end": 20}]


def write_corpus(folder: Path, scenes: int = 10) -> Path:
    """Two people who sway, for one to two seconds a scene."""
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
    folder.mkdir()
    np.save(folder / "motions.npy", np.concatenate(motions).astype(np.float32))
    (folder / "index.json").write_text(json.dumps(index))
    return folder


def prepared(folder: Path) -> Path:
    """The file of prepared scenes of such a corpus, both in ``folder``."""
    out = folder / "scenes.safetensors"
    assert prepare.main(["--corpus", str(write_corpus(folder / "corpus")), "--out", str(out)]) == 0
    return out


def begin(scenes: Path, out: Path, settings: Settings = SETTINGS, **options: Path) -> Trainer:
    return Trainer(prepare.load(scenes), settings, out, **options)


def take(trainer: Trainer, steps: int) -> Trainer:
    """Takes some steps, as a run that is stopped then: saved where it stands."""
    for _ in range(steps):
        trainer.train_step()
    trainer.save()
    return trainer
