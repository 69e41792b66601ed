"""What can be asked of the :class:`~webdemo.inference.engine.Engine`, and what it answers.

These dataclasses import no torch, so the page, the shell and the API build them before any network loads.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import asdict, dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from webdemo.motion import Clip, Duet, InputError

from .actor import ROLES, SECONDS, check_actor

MAX_PROMPT = 500
STEPS = (1, 1000)
SAMPLES = (1, 8)
GUIDANCE = (0.0, 10.0)
DAMPING = (0.0, 1.0)
MAX_SEED = 2**32 - 1
SAMPLERS = ("ddim", "dpm++")
MODES: dict[str, tuple[str, ...]] = {
    "intergen": ("offline",),
    "regennet": ("offline", "online"),
    "interformer": ("offline",),
    "agent": ("offline",),
}
"""How each model can react: in sight of the whole given motion, or of its past alone."""
DEFAULT_STEPS = {"intergen": 50, "regennet": 5, "interformer": 1, "agent": 50}
"""Denoising steps that each model is meant for; InterFormer has none."""


DEFAULT_GUIDANCE = {"bigraphdiff": 1.8}
"""Guidance scales of models for which :class:`SamplingRequest`'s is not the best."""


def _number(name: str, value: Any, low: float, high: float, unit: str = "") -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise InputError(f"{name} must be a number from {low:g} to {high:g}{unit}, not {value!r:.40}.")
    if not low <= value <= high:
        raise InputError(f"{name} must be from {low:g} to {high:g}{unit}, not {value:g}.")
    return float(value)


def _whole(name: str, value: Any, low: int, high: int) -> int:
    number = _number(name, value, low, high)
    if number != int(number):
        raise InputError(f"{name} must be a whole number from {low} to {high}, not {value:g}.")
    return int(number)


def _words(value: Any, *, needed: bool) -> str:
    if not isinstance(value, str) or (needed and not value.strip()):
        raise InputError("The prompt is empty: say in a sentence what the two people do.")
    if len(value) > MAX_PROMPT:
        raise InputError(f"The prompt has {len(value):,} characters: shorten it to {MAX_PROMPT} or fewer.")
    return value


def _choice(name: str, value: Any, known: tuple[str, ...]) -> None:
    if value not in known:
        raise InputError(f"{name} {value!r:.40} is not known: choose one of {', '.join(known)}.")


@dataclass(frozen=True, kw_only=True)
class SamplingRequest:
    """What every job that denoises a motion can be told.

    Attributes:
        seed: the same request with the same seed gives the same motion.
        samples: how many different motions to draw in one pass.
        guidance: scale s of classifier-free guidance, s·conditioned + (1−s)·unconditioned; 1 is none.
        steps: denoising steps.
        damping: t̄ as a fraction of the diffusion's T: while t ≤ t̄·T the predicted motion is corrected by
            the regularisers; 0 is the plain sampler.
        sampler: "ddim" (η = 0) or "dpm++" (DPM-Solver++ multistep).
        model: the name of a generator in the registry.
        cleanup: end in a projection onto constant bones and planted feet.
    """

    seed: int = 0
    samples: int = 1
    guidance: float = 4.3
    steps: int = 50
    damping: float = 0.7
    sampler: str = "ddim"
    model: str = "intergen"
    cleanup: bool = True

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "seed", _whole("Seed", self.seed, 0, MAX_SEED))
        set_(self, "samples", _whole("Samples", self.samples, *SAMPLES))
        set_(self, "guidance", _number("Guidance scale", self.guidance, *GUIDANCE))
        set_(self, "steps", _whole("DDIM steps", self.steps, *STEPS))
        set_(self, "damping", _number("Damping threshold", self.damping, *DAMPING))
        _choice("Sampler", self.sampler, SAMPLERS)


@dataclass(frozen=True, kw_only=True)
class GenerateRequest(SamplingRequest):
    """Two people from one sentence, or from a class by the model bigraphdiff.

    Attributes:
        prompt: what the two people do, in English; for bigraphdiff the name of a class.
        seconds: length of the motion.
    """

    prompt: str
    seconds: float = 5.0

    def __post_init__(self) -> None:
        _words(self.prompt, needed=True)
        object.__setattr__(self, "seconds", _number("Length", self.seconds, *SECONDS, " seconds"))
        super().__post_init__()

    def to_dict(self) -> dict[str, Any]:
        return {"kind": "generate", **asdict(self)}


@dataclass(frozen=True, kw_only=True)
class ReactRequest(SamplingRequest):
    """A second person for a given one: InterGen person to person (section 5.4), ReGenNet, InterFormer or the
    virtual agent.

    ReGenNet samples with DDIM alone. Online, what is to come cannot be corrected: ``damping`` is 0 whatever
    was given.
    InterFormer denoises nothing and takes no words: it heeds ``seed``, ``samples`` and ``cleanup`` alone.
    The virtual agent finds the words itself and has InterGen answer; its given person always acts first.

    Attributes:
        actor: the given person, 1 to 10 seconds on SMPL22's joints. At 30 fps the result holds these very
            positions; a clip of another rate is resampled first.
        prompt: what the two people do, in English; empty for a reaction without a stated intent.
        role: which of the two the given person is: "a" acts first, "b" reacts to a person who is made.
            ReGenNet's and InterFormer's given person always acts first.
        mode: "offline": the other person is made in sight of the whole motion; "online" (ReGenNet): each of
            their frames in sight of the given person's frames so far.
        start: (22, 3) metres, how the person who is made stands at the first frame, in the actor's world;
            open by default. Not for InterGen and the virtual agent.
    """

    actor: Clip
    prompt: str = ""
    role: str = "a"
    mode: str = "offline"
    start: NDArray[np.floating] | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        _words(self.prompt, needed=False)
        _choice("Role", self.role, ROLES)
        _choice("Model", self.model, tuple(MODES))
        if self.mode not in MODES[self.model]:
            raise InputError(
                f"Mode {self.mode!r:.40} is none of {self.model}'s: choose {' or '.join(MODES[self.model])}."
            )
        if self.model == "regennet":
            self._check_regennet()
        if self.model == "interformer":
            self._check_interformer()
        if self.model == "agent" and self.role != "a":
            raise InputError("The virtual agent answers: choose role a, or the model intergen.")
        object.__setattr__(self, "actor", check_actor(self.actor, SECONDS))
        if self.start is not None:
            self._check_start()
        super().__post_init__()

    def _check_start(self) -> None:
        if self.model in ("intergen", "agent"):
            raise InputError("InterGen takes no start pose: leave it out, or choose the model regennet.")
        start = np.asarray(self.start, dtype=np.float64)
        if start.shape != (22, 3) or not np.isfinite(start).all():
            raise InputError(
                "The start pose must be finite and of 22 joints, in metres of the actor's world."
            )
        # One person in one place, checked as an actor of a second would be.
        check_actor(Clip(np.repeat(start[None], 30, axis=0), 30.0), (0.0, 2.0))
        object.__setattr__(self, "start", start.round(5))  # as the manifest keeps it

    def _check_regennet(self) -> None:
        if self.role != "a":
            raise InputError("ReGenNet makes the one who reacts: choose role a, or the model intergen.")
        if self.sampler != "ddim":
            raise InputError(f"ReGenNet samples with ddim, not with {self.sampler!r:.40}: choose ddim.")
        _number("Damping threshold", self.damping, *DAMPING)
        if self.mode == "online":
            object.__setattr__(self, "damping", 0.0)

    def _check_interformer(self) -> None:
        if self.role != "a":
            raise InputError("InterFormer makes the one who reacts: choose role a, or the model intergen.")
        for name, plain in {"steps": 1, "guidance": 1.0, "damping": 0.0, "sampler": "ddim"}.items():
            object.__setattr__(self, name, plain)

    def to_dict(self) -> dict[str, Any]:
        """Everything but the motion, which is named by its SHA-256."""
        plain = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in ("actor", "start")}
        if self.start is not None:
            plain["start"] = np.asarray(self.start).tolist()
        clip = self.actor
        actor = {
            "name": clip.name[:100],
            "frames": clip.num_frames,
            "fps": clip.fps,
            "sha256": hashlib.sha256(np.ascontiguousarray(clip.positions).tobytes()).hexdigest(),
        }
        return {"kind": "react", "actor": actor, **plain}


@dataclass(frozen=True, kw_only=True)
class Progress:
    """One thing that happened on the way to a result.

    Attributes:
        stage: "load", "text", "sample", "finish".
        step: steps of the stage that are done.
        total: steps the stage has.
        elapsed: seconds since the request began.
    """

    stage: str
    step: int = 0
    total: int = 1
    elapsed: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Result:
    """What a request gave.

    Attributes:
        duets: one a sample; a prediction for one person is that person's clip.
        manifest: request, model, weights hash, versions: all that reproduces the result.
        readouts: one dictionary of interaction measures a sample (see :mod:`webdemo.metrics`), each
            measure with its value ``before`` and ``after`` the damping and clean-up where both exist.
        timings: seconds by stage.
        notes: sentences the user should read, such as a prompt far from all training captions.
    """

    duets: tuple[Duet | Clip, ...]
    manifest: dict[str, Any]
    readouts: tuple[dict[str, Any], ...] = ()
    timings: dict[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


class Cancelled(Exception):
    """The run was cancelled by its owner; nothing was written."""
