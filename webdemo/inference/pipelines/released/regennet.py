"""The authors' ReGenNet: one person's reactor, with sight of the whole motion or frame by frame."""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from models.diffusion import make_scheduler, sample_noise, sample_steps
from models.regennet.network import ROW_WIDTH, ReGenNet
from models.regennet.released import ROWS, decode, encode, load_released
from motion import FPS, Clip, InputError
from motion.placement import Placement
from motion.skeleton import SMPL22
from webdemo.inference.finish.cleanup import clean_person
from webdemo.inference.finish.following import FollowingCleanup
from webdemo.inference.own.entries import Entry
from webdemo.inference.pipelines.regennet import ReGenNetPipeline
from webdemo.inference.requests import ReactRequest
from webdemo.inference.requests.live import LiveFrame
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer

from .common import digest

Array = NDArray[np.floating]

CONVERTED = (
    "The given person's 22 joints became rotations of SMPL-X's 55: jaw, eyes and fingers are at rest, and twists about "
    "the bones are the least that the positions allow. Of the answer, the 22 joints of the body were kept."
)
NO_ACTIONS = "This network was trained without actions: the words were not used."


class ReleasedReGenNetPipeline(ReGenNetPipeline):
    """The released ReGenNet of an entry of the settings.

    Raises WeightsError (an InputError) where the file is missing, damaged or another network's.
    """

    def __init__(self, entry: Entry) -> None:
        checkpoint = entry.file("checkpoint")
        self.network: ReGenNet = load_released(checkpoint)
        self.name, self.digest, self.meta = entry.name, digest([checkpoint]), {}
        self.labels = entry.labels
        actions = self.network.config.num_actions
        if self.labels and len(self.labels) != actions:
            raise InputError(
                f"The checkpoint of {entry.name} knows {actions} actions and `labels` names {len(self.labels)}: name "
                "each of them once, in the order of the training set."
            )

    def condition(self, prompt: str, samples: int) -> Any:
        """(samples,) the action that a prompt names, by its label or its number; None without a prompt.

        Raises:
            InputError: if the network has no such action.
        """
        words, actions = " ".join(prompt.split()).casefold(), self.network.config.num_actions
        if not words or not actions:
            return None
        known = {label.casefold(): i for i, label in enumerate(self.labels)}
        number = int(words) if words.isdecimal() else known.get(words, actions)
        if number >= actions:
            named = "; ".join(self.labels) or f"a number from 0 to {actions - 1}"
            raise InputError(f"{self.name} has no action {prompt.strip()!r:.60}: choose one of: {named}.")
        return torch.full((samples,), number)

    def run(self, request: ReactRequest, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """As :meth:`ReGenNetPipeline.run`; the result's notes say what the conversion lost."""
        for event in super().run(request, cancel, timer):
            if isinstance(event, Result):
                unheard = bool(request.prompt.strip()) and not self.network.config.num_actions
                notes = (CONVERTED, NO_ACTIONS) if unheard else (CONVERTED,)
                event = replace(event, notes=(*event.notes, *notes))
            yield event

    def _offline(
        self, request: ReactRequest, condition: Any, cancel: CancelToken, timer: StageTimer
    ) -> Generator[Progress, None, tuple[Array, Array]]:
        """Returns (before the clean-up, shown), each (samples, T, 22, 3) in the actor's world."""
        placement = Placement.of(request.actor, "a", request.prompt)
        given = encode(placement.to_network(request.actor.positions))
        actor = given.expand(request.samples, -1, -1, -1)
        noise = sample_noise(request.seed, request.samples, (request.actor.num_frames, *given.shape[:2]))
        scheduler = make_scheduler("ddim", request.steps)

        def predict(x: Tensor, t: Tensor) -> Tensor:
            if condition is None:
                return self.network(x, t, actor)
            return self.network.guided(x, t, actor, condition, scale=request.guidance)

        x = noise.permute(0, 2, 3, 1)  # a frame's noise does not depend on the length
        for step in sample_steps(predict, x, scheduler):
            x = step.sample
            yield timer.progress("sample", step.step, step.total)
            cancel.raise_if_cancelled()
        raw = decode(x)
        finish = clean_person if request.cleanup else np.asarray
        shown = np.stack([finish(person) for person in raw])
        return placement.to_world(raw), placement.to_world(shown)

    def _live(self, request: ReactRequest, condition: Any) -> Iterator[LiveFrame]:
        frames = request.actor.num_frames
        noise = sample_noise(request.seed, request.samples, (frames, ROWS, ROW_WIDTH))
        stream = self.network.stream(steps=request.steps, batch=request.samples, action=condition, max_frames=frames)
        finish = [FollowingCleanup() for _ in range(request.samples)]
        placement: Placement | None = None
        for index, frame in enumerate(request.actor.positions):
            began = time.perf_counter()
            if placement is None:  # from the first frame only
                placement = Placement.of(Clip(frame[None], FPS, SMPL22), "a")
            seen = encode(placement.to_network(frame[None]))[..., 0].expand(request.samples, -1, -1)
            raw = decode(stream.step(seen, noise=noise[:, index])[..., None])[:, 0]
            shown = raw
            if request.cleanup and np.isfinite(raw).all():
                standing = np.zeros(4)  # the network says nothing of the feet
                shown = np.stack([clean(person, standing) for clean, person in zip(finish, raw, strict=True)])
            raw, shown = placement.to_world(raw), placement.to_world(shown)
            yield LiveFrame(index, raw, shown, time.perf_counter() - began)
