"""BiGraphDiff: two people from the name of a class, by the shipped network, or from a sentence, by the released one."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from models.bigraphdiff.compact import CompactBiGraphDiff
from models.bigraphdiff.released import JOINTS, load_released
from models.diffusion import (
    TRAIN_TIMESTEPS,
    SamplerName,
    Scheduler,
    cosine_betas,
    make_scheduler,
    sample_noise,
    sample_steps,
)
from models.intergen.released import read_normaliser
from models.text.clip import find_vocabulary
from models.weights_io import load_network
from motion import FPS, Duet, InputError
from motion.metrics import compare
from motion.retarget import to_smpl
from motion.skeleton import LAYOUTS, NTU25
from webdemo.inference.finish.cleanup import clean_person
from webdemo.inference.own.entries import Entry
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer

from .given import NAMES
from .two_person import Conditioning, TwoPersonPipeline

LINEAR_BETAS = (1e-4, 0.02)
"""First and last noise variance of the linear schedule, Ho et al. 2020, as in MotionDiffuse."""


class BiGraphDiffPipeline(TwoPersonPipeline[CompactBiGraphDiff]):
    """The compact BiGraphDiff, for which a request's prompt is the name of a class.

    Raises WeightsError (an InputError) if files are missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        model, source = load_network(folder, CompactBiGraphDiff)
        super().__init__(source, model)

    def conditioning(self, request: GenerateRequest | ReactRequest) -> Conditioning:
        """The class' vector and touch; raises InputError for a class that is not known."""
        labels = self.model.config.labels
        known = {label.casefold(): label for label in labels}
        label = known.get(" ".join(request.prompt.split()).casefold())
        if label is None:
            raise InputError(f"There is no class {request.prompt.strip()!r:.60}: choose one of: {'; '.join(labels)}.")
        with torch.no_grad():
            condition = self.model.condition([label])
        return Conditioning(condition, request.guidance, self.model.touches(label))


class ReleasedBiGraphDiffPipeline:
    """The released BiGraphDiff of an entry of the settings.

    Raises WeightsError or VocabularyError (both InputError) where a file is missing, damaged or another's.
    """

    def __init__(self, entry: Entry) -> None:
        vocabulary = entry.file("vocabulary") if "vocabulary" in entry.files else find_vocabulary()
        paths = [entry.file(role) for role in ("checkpoint", "mean", "std") if role in entry.files]
        self.model = load_released(paths[0], vocabulary)
        self.mean, self.std = torch.zeros(1), torch.ones(1)
        if len(paths) > 1:
            self.mean, self.std = read_normaliser(entry.file("mean"), entry.file("std"), 6 * JOINTS)
        self.name, self.digest = entry.name, entry.digest("checkpoint", "mean", "std")
        self.betas = cosine_betas() if entry.schedule == "cosine" else np.linspace(*LINEAR_BETAS, TRAIN_TIMESTEPS)

    def run(self, request: GenerateRequest, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`Result` without a manifest; raises Cancelled within one step."""
        frames, longest = round(request.seconds * FPS), self.model.network.config.max_frames
        if frames > longest:
            raise InputError(f"{self.name} makes at most {longest / FPS:g} seconds: ask for fewer.")
        yield timer.progress("text")
        text, vector = (
            part.expand(request.samples, *part.shape[1:]) for part in self.model.condition([request.prompt])
        )
        timer.lap("text")

        def predict(x: Tensor, t: Tensor) -> Tensor:
            return self.model.network(x, t, text, vector)

        noise = sample_noise(request.seed, request.samples, (frames, 6 * JOINTS))
        draw = torch.Generator().manual_seed(request.seed)
        x = yield from timer.sampled(sample_steps(predict, noise, self._scheduler(request), generator=draw), cancel)
        yield timer.progress("finish")
        people = (x * self.std + self.mean).double().numpy().reshape(len(x), frames, 2, JOINTS, 3)
        if not np.isfinite(people).all():
            raise InputError("The motion diverged: take more steps.")
        kinect = [Duet.from_positions(np.moveaxis(pair, 1, 0), fps=FPS, skeleton=NTU25, roles=NAMES) for pair in people]
        fitted = [to_smpl(duet) for duet in kinect]
        finish = clean_person if request.cleanup else np.asarray
        shown = [duet.with_positions([finish(p.positions) for p in duet.people]) for duet in fitted]
        yield Result(
            duets=tuple(shown),
            readouts=tuple(compare(raw, duet) for raw, duet in zip(fitted, shown, strict=True)),
            notes=(_loss(kinect, shown),),
        )

    def _scheduler(self, request: GenerateRequest) -> Scheduler:
        """Ancestral sampling, as in the paper, where all timesteps are asked for; otherwise the request's sampler."""
        name: SamplerName = "dpm++" if request.sampler == "dpm++" else "ddim"
        if request.steps == TRAIN_TIMESTEPS:
            name = "ddpm"
        return make_scheduler(name, request.steps, betas=self.betas, prediction="epsilon")


def _loss(kinect: list[Duet], shown: list[Duet]) -> str:
    """Says in a sentence how far the joints lie from the network's, relative to the pelvis."""
    layout = LAYOUTS[NTU25.name]
    gaps = []
    for before, after in zip(kinect, shown, strict=True):
        seen = before.positions[:, :, layout.columns] - before.positions[:, :, :1]
        made = after.positions[:, :, layout.observed] - after.positions[:, :, :1]
        gaps.append(np.linalg.norm(seen - made, axis=-1).mean())
    away = 100 * float(np.mean(gaps))
    return (
        f"{JOINTS} joints of a Kinect became 22 on SMPL's bones: hand tips, thumbs and the size of the bodies were "
        f"dropped. Relative to the pelvis the joints lie {away:.1f} cm from the network's on average."
    )
