"""Reactions by ReGenNet, shipped and as released, offline or online.

*Online*, nothing looks ahead: the first frame gives the actor's place, the network is a causal stream, and bones and
feet are corrected frame by frame. So frame i of the reaction does not depend, to the last bit, on what the actor does
after frame i.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from models.diffusion import SamplingStep, make_scheduler, sample_noise, sample_steps
from models.motion_tokens import FEATURES
from models.regennet.compact import CompactReGenNet, CompactStream
from models.regennet.network import ROW_WIDTH, ReactionStream, ReGenNet
from models.regennet.released import ROWS, decode, encode, load_released
from models.text import MiniLM
from models.weights_io import load_network
from motion import InputError
from motion.transforms import Placement
from motion.vectors import Array
from webdemo.inference.finish.cleanup import FollowingCleanup, clean_person
from webdemo.inference.finish.damping import Beside, Damping
from webdemo.inference.own.entries import Entry
from webdemo.inference.requests import ReactRequest
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer

from .given import reacted, settle

Answer = Callable[[Array], tuple[Array, Array]]
CONVERTED = (
    "The given person's 22 joints became rotations of SMPL-X's 55: jaw, eyes and fingers are at rest, and twists about "
    "the bones are the least that the positions allow. Of the answer, the 22 joints of the body were kept."
)
NO_ACTIONS = "This network was trained without actions: the words were not used."


class ReGenNetPipeline:
    """The compact ReGenNet with its text encoder, loaded from a weights folder.

    Raises WeightsError or TextEncoderError (both InputError) if files are missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        self.model: CompactReGenNet
        self.model, source = load_network(folder, CompactReGenNet)
        self.name, self.digest = folder.name, source.digest

    @cached_property
    def encoder(self) -> MiniLM:
        """The text encoder, loaded at the first prompt; a reaction without text does not need it."""
        return MiniLM()

    def condition(self, prompt: str, samples: int) -> Tensor:
        """(samples, C) text vectors; zeros without text."""
        if not prompt.strip():
            return torch.zeros(samples, self.model.config.cond_dim)
        tokens = self.encoder([prompt])
        with torch.no_grad():
            return self.model.conditioner(tokens.features, tokens.mask).expand(samples, -1)

    def run(self, request: ReactRequest, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`Result` without a manifest.

        Raises:
            Cancelled: within one denoising step, or within one frame online.
        """
        yield timer.progress("text")
        condition = self.condition(request.prompt, request.samples)
        timer.lap("text")
        cancel.raise_if_cancelled()
        if request.mode == "online":
            raw, made = yield from self._online(request, condition, cancel, timer)
        else:
            raw, made = yield from self._offline(request, condition, cancel, timer)
        timer.lap("sample")
        yield timer.progress("finish")
        if not np.isfinite(made).all():
            raise InputError("The motion diverged: lower the guidance scale or take more steps.")
        yield reacted(request, raw, made, self.notes(request))

    def notes(self, request: ReactRequest) -> tuple[str, ...]:
        """Sentences on what the network made of the request."""
        return ()

    def _begin(self, request: ReactRequest, placement: Placement) -> Tensor | None:
        """(samples, 67) the network's input for the reactor's first pose, if one is given."""
        if request.first_pose is None:
            return None
        pose = torch.from_numpy(placement.to_network(request.first_pose)).float()
        return self.model.begin_row(pose).expand(request.samples, -1)

    # ---- offline ---------------------------------------------------------------------------------

    def _offline(
        self, request: ReactRequest, condition: Any, cancel: CancelToken, timer: StageTimer
    ) -> Generator[Progress, None, tuple[Array, Array]]:
        """Returns (before damping and clean-up, shown), each (samples, T, 22, 3) in the actor's world."""
        placement = Placement.of(request.actor, "a", request.prompt)
        steps, decoded = self._denoising(request, condition, placement)
        raw, made = decoded((yield from timer.sampled(steps, cancel)))
        if not np.isfinite(made).all():
            return raw, made
        if request.first_pose is not None:
            first, frames = placement.to_network(request.first_pose), np.arange(request.actor.num_frames)
            raw, made = (one + settle(first - one[:, :1], frames) for one in (raw, made))
        finish = clean_person if request.cleanup else np.asarray
        return placement.to_world(raw), placement.to_world(np.stack([finish(person) for person in made]))

    def _denoising(
        self, request: ReactRequest, condition: Any, placement: Placement
    ) -> tuple[Iterator[SamplingStep], Callable[[Tensor], tuple[Array, Array]]]:
        """The steps of a reaction, and what turns the last one's sample into positions (samples, T, 22, 3).

        These are before damping, and after it, in the network's frame.
        """
        model, frames = self.model, request.actor.num_frames
        given = torch.from_numpy(placement.to_network(request.actor.positions)).float()
        with torch.no_grad():
            seen = model.actor_rows(given[None]).expand(request.samples, -1, -1)
        begin = self._begin(request, placement)
        scheduler = make_scheduler("ddim", request.steps, spacing="top")
        damping = Damping(
            Beside(model, given),
            request.damping,
            frames=frames,
            timesteps=scheduler.timesteps.tolist(),
            touches=model.touches(condition) if request.prompt.strip() else (),
        )
        uncorrected = noise = sample_noise(request.seed, request.samples, (model.num_rows(frames), FEATURES))

        def predict(x: Tensor, t: Tensor) -> Tensor:
            return model.guided(x, t, seen, condition, scale=request.guidance, begin=begin)

        def correct(x0: Tensor, timestep: int) -> Tensor:
            nonlocal uncorrected
            uncorrected = x0
            return damping(x0, timestep)

        def decoded(x: Tensor) -> tuple[Array, Array]:
            with torch.no_grad():
                raw, made = (model.positions(one, frames)[0].double().numpy() for one in (uncorrected, x))
            return raw, made

        return sample_steps(predict, noise, scheduler, correct=correct), decoded

    # ---- online ----------------------------------------------------------------------------------

    def _stream(self, request: ReactRequest, condition: Any, placement: Placement) -> Answer:
        """Answers an actor's pose (22, 3) by poses (samples, 22, 3) and contact scores (samples, 4) of the feet."""
        frames, model = request.actor.num_frames, self.model
        # A last frame on a knot starts an interval that offline sampling does not need.
        noise = sample_noise(request.seed, request.samples, (model.num_rows(frames) + 1, FEATURES))
        rows, begin = iter(noise.transpose(0, 1)), self._begin(request, placement)
        steps, scale = request.steps, request.guidance
        stream = CompactStream(model, condition, steps=steps, scale=scale, max_frames=frames, begin=begin)

        def answer(pose: Array) -> tuple[Array, Array]:
            made, contacts = stream.step(torch.from_numpy(pose).float(), noise=rows)
            return made.double().numpy(), contacts.numpy()

        return answer

    def _online(
        self, request: ReactRequest, condition: Any, cancel: CancelToken, timer: StageTimer
    ) -> Generator[Progress, None, tuple[Array, Array]]:
        """Returns (raw, shown), each (samples, T, 22, 3) in the actor's world; a frame knows no later pose."""
        actor, off = request.actor, np.zeros((22, 3))
        placement = Placement.of(actor.cut(0, 1), "a")  # from the first frame only
        answer = self._stream(request, condition, placement)
        finish = [FollowingCleanup() for _ in range(request.samples)]
        made: list[tuple[Array, Array]] = []
        delays = []
        for index, frame in enumerate(actor.positions):
            began = time.perf_counter()
            raw, contacts = answer(placement.to_network(frame))
            if request.first_pose is not None:
                off = off if index else placement.to_network(request.first_pose) - raw
                raw = raw + settle(off, np.array([index]))[:, 0]
            shown = raw
            if request.cleanup and np.isfinite(raw).all():
                people = zip(finish, raw, contacts, strict=True)
                shown = np.stack([clean(person, standing) for clean, person, standing in people])
            made.append((placement.to_world(raw), placement.to_world(shown)))
            delays.append(time.perf_counter() - began)
            yield timer.progress("sample", index + 1, actor.num_frames, "frame")
            cancel.raise_if_cancelled()
        timer.stages["delay of a frame, mean"] = round(float(np.mean(delays)), 5)
        timer.stages["delay of a frame, longest"] = round(max(delays), 5)
        raw, shown = (np.stack(poses, axis=1) for poses in zip(*made, strict=True))
        return raw, shown


class ReleasedReGenNetPipeline(ReGenNetPipeline):
    """The released ReGenNet of an entry of the settings.

    Raises WeightsError (an InputError) where the file is missing, damaged or another network's.
    """

    def __init__(self, entry: Entry) -> None:
        checkpoint = entry.file("checkpoint")
        self.network: ReGenNet = load_released(checkpoint)
        self.name, self.digest = entry.name, entry.digest("checkpoint")
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

    def notes(self, request: ReactRequest) -> tuple[str, ...]:
        """What the conversion lost, and whether the words were heard."""
        unheard = bool(request.prompt.strip()) and not self.network.config.num_actions
        return (CONVERTED, NO_ACTIONS) if unheard else (CONVERTED,)

    def _denoising(
        self, request: ReactRequest, condition: Any, placement: Placement
    ) -> tuple[Iterator[SamplingStep], Callable[[Tensor], tuple[Array, Array]]]:
        given = encode(placement.to_network(request.actor.positions))
        actor = given.expand(request.samples, -1, -1, -1)
        noise = sample_noise(request.seed, request.samples, (request.actor.num_frames, *given.shape[:2]))

        def predict(x: Tensor, t: Tensor) -> Tensor:
            if condition is None:
                return self.network(x, t, actor)
            return self.network.guided(x, t, actor, condition, scale=request.guidance)

        # A frame's noise does not depend on the length.
        steps = sample_steps(predict, noise.permute(0, 2, 3, 1), make_scheduler("ddim", request.steps))
        return steps, lambda x: (decode(x),) * 2

    def _stream(self, request: ReactRequest, condition: Any, placement: Placement) -> Answer:
        frames = request.actor.num_frames
        noise = iter(sample_noise(request.seed, request.samples, (frames, ROWS, ROW_WIDTH)).transpose(0, 1))
        steps, batch = request.steps, request.samples
        stream = ReactionStream(self.network, steps=steps, batch=batch, action=condition, max_frames=frames)

        def answer(pose: Array) -> tuple[Array, Array]:
            seen = encode(pose[None])[..., 0].expand(request.samples, -1, -1)
            made = decode(stream.step(seen, noise=next(noise))[..., None])[:, 0]
            return made, np.zeros((request.samples, 4))  # the network says nothing of the feet

        return answer
