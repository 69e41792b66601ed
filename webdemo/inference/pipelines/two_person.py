"""Two people denoised together: what the pipelines of InterGen and BiGraphDiff share."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar, cast

import numpy as np
import torch
from torch import Tensor

from acts.staging.window import KnownFrames
from models.bigraphdiff.compact import CompactBiGraphDiff
from models.compiled import compile_network
from models.diffusion import SamplerName, Spacing, make_scheduler, sample_noise, sample_steps
from models.intergen.compact import CompactInterGen, Touch
from models.intergen.released import ReleasedInterGen
from models.motion_tokens import DuetSpace
from models.weights_io import WeightsFolder
from motion import FPS, Duet, InputError
from motion.metrics import compare
from motion.transforms import Placement
from motion.vectors import Array
from webdemo.inference.finish.cleanup import clean_person
from webdemo.inference.finish.damping import Damping
from webdemo.inference.requests import GenerateRequest, ReactRequest, SamplingRequest
from webdemo.inference.requests.actor import ROLES
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer

from .given import Finish, Given, Reaction, Scene, hold_of

Network = TypeVar("Network", CompactInterGen, CompactBiGraphDiff, ReleasedInterGen)


@dataclass(frozen=True)
class Conditioning:
    """The condition of a network, and the strength of its guidance.

    Attributes:
        condition: (1, …) as the denoiser takes it; zeros are no condition.
        guidance: scale of classifier-free guidance.
        touch: which joints should come together.
        notes: sentences the user should read.
    """

    condition: Tensor
    guidance: float
    touch: Touch = ()
    notes: tuple[str, ...] = ()


class TwoPersonPipeline(ABC, Generic[Network]):
    """Denoises two people by the network of a weights folder; a subclass says what it conditions on.

    Args:
        source: the folder.
        model: its network.
    """

    spacing: Spacing = "top"
    """How the timesteps are spread, see :func:`models.diffusion.make_scheduler`."""

    def __init__(self, source: WeightsFolder, model: Network) -> None:
        self.name, self.digest = source.folder.name, source.digest
        self.model: Network = model
        self.compiled = compile_network(model.denoiser, source.digest)

    def scene(self, request: GenerateRequest | ReactRequest) -> Scene:
        """The known part of the motion that a request asks for, and how samples become duets."""
        if isinstance(request, GenerateRequest):
            return Scene(round(request.seconds * FPS))
        actor, place = request.actor, ROLES.index(request.role)
        placement = Placement.of(actor, request.role, request.prompt)
        given = self.given(placement.to_network(actor.positions), place)
        return Reaction(actor.num_frames, given, clip=actor, place=place, placement=placement)

    def given(self, positions: Array, place: int) -> Given:
        """The known part for a person (T, 22, 3) in the network's frame, 0 for a or 1 for b, given at every frame."""
        layout = cast(DuetSpace, self.model).layout
        frames = layout.num_frames(layout.num_tokens(len(positions)))
        # The last token extends up to seven frames beyond the motion; there the last pose is held.
        whole = np.pad(positions, ((0, frames - len(positions)), (0, 0), (0, 0)), mode="edge")
        return hold_of(cast(DuetSpace, self.model), frames, [KnownFrames(place, range(frames), whole)])

    def cleaned(self, person: Array) -> Array:
        """A generated person (T, 22, 3) after the clean-up."""
        return clean_person(person)

    def lost(self, settings: SamplingRequest, before: Sequence[Duet], after: Sequence[Duet]) -> tuple[str, ...]:
        """Sentences on what became of the network's own numbers, from the motion before and after the clean-up."""
        return ()

    @abstractmethod
    def conditioning(self, request: GenerateRequest | ReactRequest) -> Conditioning:
        """The conditioning of a request."""

    def run(
        self,
        request: GenerateRequest | ReactRequest,
        cancel: CancelToken,
        timer: StageTimer,
        scene: Scene | None = None,
    ) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`Result` without a manifest; raises Cancelled within one step.

        Args:
            request: what is asked for.
            cancel: looked at before every step.
            timer: of the run.
            scene: what is known of the motion, and how samples become duets; by default what the request says.
        """
        yield timer.progress("text")
        conditioning = self.conditioning(request)
        timer.lap("text")
        scene, noise = scene or self.scene(request), (request.seed, request.samples)
        yield from self.sample(request, conditioning, scene, noise, cancel, timer)

    def sample(
        self,
        settings: SamplingRequest,
        conditioning: Conditioning,
        scene: Scene,
        noise: tuple[int, int],
        cancel: CancelToken,
        timer: StageTimer,
        *,
        measured: bool = True,
    ) -> Iterator[Progress | Result]:
        """Samples of a scene, denoised: progress events, then one result.

        Args:
            settings: steps, sampler, damping and clean-up are taken from there.
            conditioning: of the network.
            scene: what is known of the motion, and how samples become duets.
            noise: the seed, and the number of samples.
            cancel, timer: as in :meth:`run`.
            measured: the read-outs compare its duets with what they were; all say what damping moved, as ``damped``.
        """
        layout = self.model.layout
        x = sample_noise(*noise, (layout.num_tokens(scene.frames), 2 * layout.token_features))
        scheduler = make_scheduler(cast(SamplerName, settings.sampler), settings.steps, spacing=self.spacing)
        damping = Damping(
            self.model,
            settings.damping,
            frames=scene.frames,
            timesteps=scheduler.timesteps.tolist(),
            frozen=None if scene.given is None else scene.given.frozen[0],
            touches=(conditioning.touch,) * len(x),
        )
        condition = conditioning.condition.expand(len(x), *conditioning.condition.shape[1:])
        uncorrected, done = x, 0
        # What is known is clean at every timestep, as in training (InterGen, section 5.4), and shown to a network that
        # reads it.
        held = scene.held(settings.steps)
        seen = {given: self._seen(given, scene) for given in dict.fromkeys(held)}

        def predict(x: Tensor, t: Tensor) -> Tensor:
            given = held[done]
            x = given(x) if given else x
            return self.model.denoiser.guided(x, t, condition, scale=conditioning.guidance, **seen[given])

        def correct(x0: Tensor, timestep: int) -> Tensor:
            nonlocal uncorrected, done
            given = held[done]
            uncorrected, done = given.bend(x0) if given else x0, done + 1
            damped = damping(uncorrected, timestep)
            return given(damped) if given else damped

        x = yield from timer.sampled(sample_steps(predict, x, scheduler, correct=correct), cancel)
        yield timer.progress("finish")
        duets: tuple[Duet, ...] = self._duets(x, scene, self.cleaned if settings.cleanup else np.asarray)
        moved = [0.0] * len(duets) if damping.moved is None else damping.moved.tolist()
        readouts: list[dict[str, Any]] = [{"damped": metres} for metres in moved]
        notes: list[str] = list(conditioning.notes)
        if measured:
            before: tuple[Duet, ...] = self._duets(uncorrected, scene, np.asarray)
            readouts = [compare(*pair) | each for *pair, each in zip(before, duets, readouts, strict=True)]
            notes += self.lost(settings, before, duets)
        timer.lap("finish")
        yield Result(duets=duets, readouts=tuple(readouts), notes=tuple(notes))

    def _seen(self, given: Given | None, scene: Scene) -> dict[str, Tensor]:
        """The denoiser's input on what is known of a scene, where it reads any."""
        if not self.model.reads_known:
            return {}
        known = cast(Any, self.model).shown(None if given is None else given.features, scene.draft)
        return {} if known is None else {"known": known}

    def _duets(self, x: Tensor, scene: Scene, finish: Finish) -> tuple[Duet, ...]:
        with torch.no_grad():
            positions = self.model.positions(x)[0][:, :, : scene.frames].numpy()
        if not np.isfinite(positions).all():
            raise InputError("The motion diverged: lower the guidance scale or take more steps.")
        return tuple(scene.duet(pair, finish) for pair in positions)
