"""A second person for a given one by the compact ReGenNet, in sight of the whole motion or as it comes.

*Online*, nothing looks ahead: the actor's place is taken from the first frame, the network is a causal
stream, and bones and feet are corrected frame by frame. So the reaction's frame i is the same to the last bit
whatever the actor does after it.
"""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator
from functools import cached_property
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from models.compact_regennet import CompactReGenNet, load_folder
from models.diffusion import TRAIN_TIMESTEPS, make_scheduler, sample_steps
from models.motion_tokens import FEATURES
from models.text import MiniLM
from webdemo.metrics import compare
from webdemo.motion import SMPL22, Clip, Duet, InputError

from .actor import FPS, Placement
from .cancel import CancelToken
from .cleanup import clean_person
from .damping import Beside, Damping
from .following import FollowingCleanup
from .generator import Clock, sample_noise
from .live import LiveFrame, LiveProgress, LiveRequest, paced
from .requests import GenerateRequest, Progress, ReactRequest, Result

Array = NDArray[np.floating]
SETTLE = 0.5
"""Seconds over which the difference between a given first pose and the network's dies away."""
NAMES = ("actor", "reactor")


class Reactor:
    """The compact ReGenNet with its text encoder, loaded from a weights folder.

    Raises WeightsError or TextEncoderError (both InputError) where files are missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        self.model: CompactReGenNet
        self.model, source = load_folder(folder)
        self.name, self.digest, self.meta = folder.name, source.digest, source.meta

    @cached_property
    def encoder(self) -> MiniLM:
        """The text encoder, loaded with the first words; a reaction without words needs none."""
        return MiniLM()

    def condition(self, prompt: str, samples: int) -> Tensor:
        """(samples, C) what the words say; zeros where there are none."""
        if not prompt.strip():
            return torch.zeros(samples, self.model.config.cond_dim)
        tokens = self.encoder([prompt])
        with torch.no_grad():
            return self.model.conditioner(tokens.features, tokens.mask).expand(samples, -1)

    def run(
        self, request: GenerateRequest | ReactRequest, cancel: CancelToken, clock: Clock
    ) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`Result` without a manifest.

        Raises:
            InputError: for a request without a given person.
            Cancelled: within one denoising step, or one frame where online.
        """
        if not isinstance(request, ReactRequest):
            raise InputError(f"{self.name} answers a given person: give it an actor, or choose intergen.")
        now = time.perf_counter()
        yield clock.progress("text")
        condition = self.condition(request.prompt, request.samples)
        now = clock.lap("text", now)
        cancel.raise_if_cancelled()
        if request.mode == "online":
            raw, made = yield from self._online(request, condition, cancel, clock)
        else:
            raw, made = yield from self._offline(request, condition, cancel, clock)
        now = clock.lap("sample", now)
        yield clock.progress("finish")
        if not np.isfinite(made).all():
            raise InputError("The motion ran away to infinity: lower the guidance scale or take more steps.")
        duets = [duet_of(request, person) for person in made]
        readouts = tuple(
            compare(duet_of(request, before), duet) for before, duet in zip(raw, duets, strict=True)
        )
        clock.lap("finish", now)
        yield Result(
            duets=tuple(duets),
            manifest={},
            readouts=readouts,
            timings={**clock.stages, "total": round(clock.elapsed, 4)},
        )

    def _begin(self, request: ReactRequest, placement: Placement) -> Tensor | None:
        """(samples, 67) what the network is told of the reactor's first pose, if one is given."""
        if request.start is None:
            return None
        pose = torch.from_numpy(placement.to_network(request.start)).float()
        return self.model.begin_row(pose).expand(request.samples, -1)

    # ---- offline ---------------------------------------------------------------------------------

    def _offline(
        self, request: ReactRequest, condition: Tensor, cancel: CancelToken, clock: Clock
    ) -> Generator[Progress, None, tuple[Array, Array]]:
        """Returns (before damping and clean-up, shown), each (samples, T, 22, 3) in the actor's world."""
        model, placement = self.model, Placement.of(request.actor, "a", request.prompt)
        frames = request.actor.num_frames
        given = torch.from_numpy(placement.to_network(request.actor.positions)).float()
        with torch.no_grad():
            seen = model.actor_rows(given[None]).expand(request.samples, -1, -1)
        begin = self._begin(request, placement)
        scheduler = make_scheduler("ddim", request.steps, spacing="top")
        damping = Damping(
            Beside(model, given),
            request.damping,
            frames=frames,
            timesteps=TRAIN_TIMESTEPS,
            final_timestep=int(scheduler.timesteps[-1]),
            touches=model.touches(condition) if request.prompt.strip() else (),
        )
        noise = sample_noise(request.seed, request.samples, (model.num_rows(frames), FEATURES))

        def predict(x: Tensor, t: Tensor) -> Tensor:
            return model.guided(x, t, seen, condition, scale=request.guidance, begin=begin)

        uncorrected = noise

        def correct(x0: Tensor, timestep: int) -> Tensor:
            nonlocal uncorrected
            uncorrected = x0
            return damping(x0, timestep)

        x = noise
        for step in sample_steps(predict, noise, scheduler, correct=correct):
            x = step.sample
            yield clock.progress("sample", step.step, step.total)
            cancel.raise_if_cancelled()
        with torch.no_grad():
            raw, made = (model.positions(one, frames)[0].double().numpy() for one in (uncorrected, x))
        if not np.isfinite(made).all():
            return raw, made
        if request.start is not None:
            first, place = placement.to_network(request.start), np.arange(frames)
            raw, made = (one + settle(first - one[:, :1], place) for one in (raw, made))
        finish = clean_person if request.cleanup else np.asarray
        return placement.to_world(raw), placement.to_world(np.stack([finish(person) for person in made]))

    # ---- online ----------------------------------------------------------------------------------

    def live(self, request: ReactRequest) -> Iterator[LiveFrame]:
        """The reaction's frames as the actor's come: each is given before the actor's next is looked at."""
        condition = self.condition(request.prompt, request.samples)
        return self._live(request, condition)

    def _live(self, request: ReactRequest, condition: Tensor) -> Iterator[LiveFrame]:
        frames, model = request.actor.num_frames, self.model
        # A last frame on a knot begins an interval that sampling the whole at once does not need.
        rows = model.num_rows(frames) + 1
        noise = iter(sample_noise(request.seed, request.samples, (rows, FEATURES)).transpose(0, 1))
        stream, off = None, 0.0
        finish = [FollowingCleanup() for _ in range(request.samples)]
        placement: Placement | None = None
        for index, frame in enumerate(request.actor.positions):
            began = time.perf_counter()
            if placement is None:  # from the first frame alone
                placement = Placement.of(Clip(frame[None], FPS, request.actor.skeleton), "a")
                stream = model.stream(
                    condition,
                    steps=request.steps,
                    scale=request.guidance,
                    max_frames=frames,
                    begin=self._begin(request, placement),
                )
            assert stream is not None  # opened with the first frame
            given = torch.from_numpy(placement.to_network(frame)).float()
            made, contacts = stream.step(given, noise=noise)
            raw = made.double().numpy()
            if request.start is not None:
                if index == 0:
                    off = placement.to_network(request.start) - raw
                raw = raw + settle(off, np.array([index]))[:, 0]
            shown = raw
            if request.cleanup and np.isfinite(raw).all():
                people = zip(finish, raw, contacts.numpy(), strict=True)
                shown = np.stack([clean(person, standing) for clean, person, standing in people])
            raw, shown = placement.to_world(raw), placement.to_world(shown)
            yield LiveFrame(index, raw, shown, time.perf_counter() - began)

    def _online(
        self, request: ReactRequest, condition: Tensor, cancel: CancelToken, clock: Clock
    ) -> Generator[Progress, None, tuple[Array, Array]]:
        """Returns (raw, shown), each (samples, T, 22, 3) in the actor's world."""
        total = request.actor.num_frames
        live = []
        plays = isinstance(request, LiveRequest)
        frames = self._live(request, condition)
        for frame in paced(frames) if plays else frames:
            live.append(frame)
            done = {"stage": "sample", "step": frame.index + 1, "total": total, "elapsed": clock.elapsed}
            yield LiveProgress(frame=frame, **done) if plays else Progress(**done)
            cancel.raise_if_cancelled()
        delays = [frame.seconds for frame in live]
        clock.stages["delay of a frame, median"] = round(float(np.median(delays)), 4)
        clock.stages["delay of a frame, longest"] = round(max(delays), 4)
        raw, shown = (np.stack([getattr(f, name) for f in live], axis=1) for name in ("raw", "positions"))
        return raw, shown


def settle(off: Array, frames: Array) -> Array:
    """What is left of a difference at the first frame, so that a motion begins where it should.

    Args:
        off: (samples, 1, 22, 3) or (samples, 22, 3) metres.
        frames: (T,) numbers of frames.

    Returns:
        (samples, T, 22, 3), all of ``off`` at frame 0 and nothing from :data:`SETTLE` seconds on.
    """
    share = np.clip(1 - frames / (SETTLE * FPS), 0, 1)
    return off.reshape(-1, 1, *off.shape[-2:]) * (share**2 * (3 - 2 * share))[:, None, None]


def duet_of(request: ReactRequest, person: Array) -> Duet:
    """The given person, exactly as given, and one who was made."""
    return Duet(request.actor, Clip(person, FPS, SMPL22, name=NAMES[1]), NAMES)
