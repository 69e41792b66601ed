"""The common part of the predictors' trainers: windows of recorded motion, past and future in one, and the command."""

from __future__ import annotations

import argparse
from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from models.weights_io import save_network
from motion import FPS, SMPL22, InputError
from motion.transforms import mirrored
from motion.vectors import Array
from training.core import shell
from training.core.loop import Loop
from training.prepare import load_corpus
from webdemo.inference.pipelines.predictor import to_last_pose


class Windows:
    """People of a corpus of two-person scenes, in the frame of the last pose of their past.

    Args:
        folder: of ``python -m training.corpus``.
        past: frames that are given.
        future: frames that follow.
        split: only scenes of this split are seen.

    Raises:
        InputError: if the folder is no such corpus.
    """

    def __init__(self, folder: Path, past: int = 30, future: int = 30, *, split: str = "train") -> None:
        self.past, self.length = past, past + future
        self.motions, rows = load_corpus(folder)
        kept = [row for row in rows if row["split"] == split and row["frames"] >= self.length]
        if not kept:
            raise InputError(f"{folder} has no scenes of the {split} split with {self.length} frames.")
        self.starts = np.concatenate([row["start"] + np.arange(row["frames"] - self.length + 1) for row in kept])

    def draw(self, count: int, rng: np.random.Generator) -> Array:
        """(count, length, 22, 3) metres: windows at random places, half of them mirrored."""
        starts = np.sort(rng.choice(self.starts, size=count))  # in the file's order, which is faster
        people = rng.integers(2, size=count)
        windows = self.motions[starts[:, None] + np.arange(self.length), people[:, None]]
        mirror = rng.random(count) < 0.5
        windows[mirror] = mirrored(windows[mirror])
        return to_last_pose(windows, self.past - 1)[0]

    def batch(self, size: int, seed: tuple[int, ...]) -> Tensor:
        """:meth:`draw` as float32; the same seed gives the same windows."""
        return torch.from_numpy(self.draw(size, np.random.default_rng(seed)).astype(np.float32))


class PredictionTrainer(Loop):
    """One training run, which resumes from its checkpoint.

    Everything random is drawn from the seed and the step number, so a run that stops and is started again
    with the same command goes on exactly as if it had never stopped.

    Args:
        windows: of the training data.
        settings: a dataclass with ``past``, ``future``, ``steps``, ``batch``, ``seed`` and ``ema``; a checkpoint of
            other settings is refused.
        out: folder of the checkpoint ``last.safetensors``.
        device: "cpu" or "cuda".
    """

    kind: str
    """Kind of the predictor, as :func:`webdemo.inference.pipelines.predictor.load_predictor` knows it."""

    def __init__(self, windows: Windows, settings: Any, out: Path, *, device: str = "cpu") -> None:
        self.windows, self.settings, self.out, self.device = windows, settings, out, device
        torch.manual_seed(settings.seed)
        self.start(self.network(), device)

    @abstractmethod
    def network(self) -> nn.Module:
        """The network as a run begins, under the run's seed; a predictor with more parts makes them here."""

    def batch(self, part: int = 0) -> Tensor:
        """The windows (B, past + future, J, 3) of this step."""
        return self.windows.batch(self.settings.batch, (self.settings.seed, self.step, part)).to(self.device)

    def export(self, folder: Path) -> None:
        """Writes the averaged network as a predictor's folder."""
        training = {**asdict(self.settings), "steps": self.step}
        save_network(folder, self.ema, kind=self.kind, fps=FPS, bones=SMPL22.bones, training=training)


def train(
    argv: list[str] | None,
    description: str,
    settings: type,
    trainer: Callable[..., PredictionTrainer],
    *,
    lean: Mapping[str, Any] | None = None,
) -> int:
    """The command of a predictor's trainer; see :func:`training.core.shell.train`."""

    def begin(options: argparse.Namespace, asked: Any) -> PredictionTrainer:
        windows = Windows(options.data, asked.past, asked.future)
        return trainer(windows, asked, options.out, device=options.device)

    return shell.train(argv, description, settings, begin, "corpus", "device", "export", lean=lean)
