"""The common part of the predictors' trainers: windows of recorded motion, past and future in one, and the command."""

from __future__ import annotations

import argparse
from abc import ABC, abstractmethod
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from models.predictors import save_predictor
from motion import SMPL22, InputError
from motion.transforms import mirrored
from training.core.loop import Loop
from training.core.shell import add_options, add_run_options, chosen
from training.corpus import cmu
from training.prepare import load_corpus
from webdemo.inference.pipelines.predictor import to_last_pose

Array = NDArray[np.floating]


class Windows(ABC):
    """Windows of one data set.

    Args:
        past: frames that are given.
        future: frames that follow.

    Attributes:
        bones: (parent, child) places among the joints.
        joints: how many.
        fps: frames a second, as the data set's users call it.
    """

    bones: list[tuple[int, int]]
    joints: int
    fps: float

    def __init__(self, past: int, future: int) -> None:
        self.past, self.future = past, future
        self.length = past + future

    @abstractmethod
    def draw(self, count: int, rng: np.random.Generator) -> Array:
        """Windows (count, past + future, joints, 3) in metres, drawn at random."""

    def batch(self, size: int, seed: tuple[int, ...]) -> Tensor:
        """:meth:`draw` as float32; the same seed gives the same windows."""
        return torch.from_numpy(self.draw(size, np.random.default_rng(seed)).astype(np.float32))


class CmuWindows(Windows):
    """CMU's training clips, both phases of every second frame, half of the windows mirrored, all at a pace of
    their own. Actions with few clips are drawn more often than their share.

    Args:
        folder: see :mod:`training.corpus.cmu`.
        paces: slowest and fastest, as multiples of the recorded one.
        mixed: share of windows whose legs come from another window. Legs and the rest hang from the same
            joint, which stands still here, so that any two go together.
    """

    fps = 25.0
    joints = 17

    def __init__(
        self,
        folder: Path,
        past: int = 25,
        future: int = 25,
        *,
        paces: tuple[float, float] = (0.8, 1.25),
        mixed: float = 0.0,
    ) -> None:
        super().__init__(past, future)
        self.paces, self.mixed = paces, mixed
        self.bones = cmu.CmuSkeleton.read(folder / "skeleton.json").bones
        clips, starts, room, chances = [], [], [], []
        end = 0
        for found in cmu.read_actions(folder, "train", phases=True).values():
            kept = [clip for clip in found if len(clip) >= self.length]
            places = [np.arange(len(clip) - self.length + 1) for clip in kept]
            for clip, place in zip(kept, places, strict=True):
                starts.append(end + place)
                room.append(len(clip) - 1 - place)
                chances.append(np.full(len(place), sum(map(len, places)) ** -0.5))
                clips.append(clip)
                end += len(clip)
        if not clips:
            raise InputError(f"{folder} has no training clip of {self.length} frames.")
        self.frames, self.starts, self.room = (np.concatenate(x) for x in (clips, starts, room))
        self.chances = np.cumsum(np.concatenate(chances))

    def draw(self, count: int, rng: np.random.Generator) -> Array:
        """(count, length, J, 3) metres: windows at random places and paces."""
        drawn = np.searchsorted(self.chances, rng.random(count) * self.chances[-1])
        pace = np.minimum(rng.uniform(*self.paces, size=count), self.room[drawn] / (self.length - 1))
        offsets = pace[:, None] * np.arange(self.length)
        whole = np.minimum(offsets.astype(int), self.room[drawn][:, None] - 1)
        places = self.starts[drawn][:, None] + whole
        share = (offsets - whole)[..., None, None].astype(np.float32)
        found = (1 - share) * self.frames[places] + share * self.frames[places + 1]
        mirror = rng.random(count) < 0.5
        found[mirror] = cmu.mirrored(found[mirror])
        if self.mixed:
            mixed = rng.random(count) < self.mixed
            found[mixed, :, cmu.LEGS] = np.roll(found, 1, axis=0)[mixed, :, cmu.LEGS]
        return found


class CorpusWindows(Windows):
    """People of a corpus of two-person scenes, in the frame of the last pose of their past.

    Args:
        folder: of ``python -m training.corpus``.
        split: only scenes of this split are seen.

    Raises:
        InputError: if the folder is no such corpus.
    """

    fps = 30.0
    joints = 22

    def __init__(self, folder: Path, past: int = 30, future: int = 30, *, split: str = "train") -> None:
        super().__init__(past, future)
        self.bones = [(int(a), int(b)) for a, b in SMPL22.bones]
        self.motions, rows = load_corpus(folder)
        kept = [row for row in rows if row["split"] == split and row["frames"] >= self.length]
        if not kept:
            raise InputError(f"{folder} has no scenes of the {split} split with {self.length} frames.")
        self.starts = np.concatenate([row["start"] + np.arange(row["frames"] - self.length + 1) for row in kept])

    def draw(self, count: int, rng: np.random.Generator) -> Array:
        """(count, length, 22, 3) metres: windows at random places, half of them mirrored."""
        starts = np.sort(rng.choice(self.starts, size=count))  # in the file's order, which is faster
        people = rng.integers(2, size=count)
        found = self.motions[starts[:, None] + np.arange(self.length), people[:, None]]
        mirror = rng.random(count) < 0.5
        found[mirror] = mirrored(found[mirror])
        return to_last_pose(found, self.past - 1)[0]


def open_windows(kind: str, folder: Path, past: int, future: int) -> Windows:
    """Windows by the name of their data set: "cmu", "cmu-mixed" (a third with others' legs) or "corpus"."""
    kinds = {"cmu": CmuWindows, "cmu-mixed": partial(CmuWindows, mixed=1 / 3), "corpus": CorpusWindows}
    if kind not in kinds:
        raise InputError(f"Windows {kind!r} are not known: choose one of {', '.join(kinds)}.")
    return kinds[kind](folder, past, future)


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
    """Kind of the predictor, as :func:`models.predictors.save_predictor` takes it."""

    def __init__(self, windows: Windows, settings: Any, out: Path, *, device: str = "cpu") -> None:
        self.windows, self.settings, self.out, self.device = windows, settings, out, device
        torch.manual_seed(settings.seed)
        self.build()
        self.restore(asdict(settings))

    @abstractmethod
    def build(self) -> None:
        """Makes networks and optimisers; runs once, under the run's seed."""

    def batch(self, part: int = 0) -> Tensor:
        """The windows (B, past + future, J, 3) of this step."""
        return self.windows.batch(self.settings.batch, (self.settings.seed, self.step, part)).to(self.device)

    def export(self, folder: Path) -> None:
        """Writes the averaged network as a predictor's folder."""
        training = {**asdict(self.settings), "steps": self.step}
        windows = self.windows
        save_predictor(folder, self.ema, kind=self.kind, fps=windows.fps, bones=windows.bones, training=training)


def add_predictor_options(parser: argparse.ArgumentParser, settings: type) -> None:
    """Options that every training of a predictor takes: data, folders, minutes and each setting."""
    parser.add_argument("--data", type=Path, required=True, help="folder of the data set")
    add_options(parser, "device", "export")
    add_run_options(parser, settings)


def train(trainer: type, settings: type, options: argparse.Namespace) -> None:
    """Runs what :func:`add_predictor_options` understood."""
    asked = chosen(options, settings)
    windows = open_windows(asked.windows, options.data, asked.past, asked.future)
    run = trainer(windows, asked, options.out, device=options.device)
    run.run_logged(minutes=options.minutes)
    if options.export:
        run.export(options.export)
