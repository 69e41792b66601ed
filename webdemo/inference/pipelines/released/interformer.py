"""The authors' InterFormer: one person's reactor, pose after pose, on 15 joints at 15 frames a second."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from models.interformer.compact import FPS as NETWORK_FPS
from models.interformer.compact import JOINTS_15
from models.interformer.network import NETWORK, WIDTH, InterFormer, from_released
from models.released import read_tensors, without_wrapper
from motion import FPS, SMPL22, Clip
from motion.placement import Placement
from motion.transforms import heading_matrix, resample
from webdemo.inference.own.entries import Entry
from webdemo.inference.pipelines.interformer import RECORDED_START_DISTANCE, InterFormerPipeline
from webdemo.inference.requests import ReactRequest
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer

from .common import digest

Array = NDArray[np.floating]

CONVERTED = (
    "Of 22 joints the network saw 15, at 15 frames a second; its answer was fitted onto 22 joints with constant bones "
    "at 30. Toes, collars and the upper spine are the fit's."
)
STARTED = "No first pose was given: the reactor begins in the actor's own, face to face."
ALIKE = "The network draws nothing: all samples are the same."


class ReleasedInterFormerPipeline(InterFormerPipeline):
    """The released InterFormer of an entry of the settings.

    Raises WeightsError (an InputError) where the file is missing, damaged or another network's.
    """

    def __init__(self, entry: Entry) -> None:
        checkpoint = entry.file("checkpoint")
        self.network = load_released(checkpoint)
        self.name, self.digest, self.meta = entry.name, digest([checkpoint]), {}

    def run(self, request: ReactRequest, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """As :meth:`InterFormerPipeline.run`; the result's notes say what the conversion lost."""
        for event in super().run(request, cancel, timer):
            if isinstance(event, Result):
                notes = [CONVERTED]
                notes += [STARTED] if request.first_pose is None else []
                notes += [ALIKE] if request.samples > 1 else []
                event = replace(event, notes=(*event.notes, *notes))
            yield event

    def _first_pose(self, actor: Array) -> Array:
        """(22, 3) the actor's first pose, turned round, in front of them."""
        facing = actor[0] @ heading_matrix(np.pi).T
        return facing + np.array([0.0, 0.0, RECORDED_START_DISTANCE])

    def _sample(
        self, request: ReactRequest, actor: Array, first_pose: Array, cancel: CancelToken, timer: StageTimer
    ) -> Generator[Progress, None, Array]:
        """Returns the network's frames (samples, T', 15, 3), which cover the actor's motion."""
        slow = resample(actor, FPS, NETWORK_FPS)
        reaction = [first_pose[list(JOINTS_15)]]
        total, longest = len(slow) - 1, self.network.config.max_length - 2
        while (begun := len(reaction) - 1) < total:
            cancel.raise_if_cancelled()
            window = slow[begun : begun + longest]
            here = Placement.of(Clip(window, NETWORK_FPS, SMPL22), "a")
            seen = here.to_network(window)[:, list(JOINTS_15)]
            made = self._answer(_numbers(seen), _numbers(here.to_network(reaction[-1])[None])[0])
            poses = made.double().numpy().reshape(-1, 3, len(JOINTS_15)).swapaxes(1, 2)
            reaction += list(here.to_world(poses[1:]))
            yield timer.progress("sample", len(reaction) - 1, total)
        return np.repeat(np.stack(reaction)[None], request.samples, axis=0)

    def _answer(self, source: Tensor, first: Tensor) -> Tensor:
        """The actor (T, 45) and a first pose (45,) → the reaction (T, 45), which begins with that pose."""
        whole = torch.cat([torch.zeros(1, WIDTH), source, torch.ones(1, WIDTH)])[None]
        mask = torch.ones(1, 1, len(source) + 2, dtype=torch.bool)
        mask[..., -1] = False  # the frame of ones at the end is padding to the network
        return self.network.generate(whole, mask, first[None], len(source) + 1)[0, 1:]


def load_released(checkpoint: Path) -> InterFormer:
    """The network of the authors' file; raises WeightsError for any other one."""
    tensors = without_wrapper(read_tensors(checkpoint, network=NETWORK), "encoder.layers.")
    return from_released(tensors).requires_grad_(False)


def _numbers(poses: Array) -> Tensor:
    """(T, 15, 3) → (T, 45), coordinate-major."""
    return torch.from_numpy(np.ascontiguousarray(poses.swapaxes(-1, -2).reshape(len(poses), WIDTH))).float()
