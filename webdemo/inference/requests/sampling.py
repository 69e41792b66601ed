"""Requests for motion that a network samples: two people from a sentence, or one person's partner."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from acts.captions import in_words
from acts.plan import Plan, PlanFrames, plan_of
from motion import Clip, InputError
from webdemo.inference import methods
from webdemo.inference.method import Method

from .actor import ROLES, check_actor, check_pose, finite, motion_facts
from .paths import FloorPath, path_of, timed_paths
from .plans import KeptPlan, plan_of_words


def _others(needed: str) -> str:
    """Names the models with a capability that another one lacks, for a message."""
    return "the model " + " or ".join(m.name for m in methods.methods("react") if needed in m.takes)


OWN_STEPS: Any = None
"""In place of steps: those of the model."""


@dataclass(frozen=True, kw_only=True)
class SamplingRequest:
    """The settings of every job that denoises a motion.

    Attributes:
        seed: the same request with the same seed gives the same motion.
        samples: number of different motions to generate.
        guidance: scale s of classifier-free guidance, s·conditioned + (1−s)·unconditioned; 1 is none.
        steps: denoising steps; by default the model's own (:attr:`Method.steps`), which is filled in here.
        damping: t̄ as a fraction of the diffusion's T: sets at which timesteps the regularisers correct the predicted
            motion, and by how much (:func:`.damping.shares`); 0 turns the correction off.
        sampler: "ddim" (η = 0) or "dpm++" (DPM-Solver++ multistep).
        model: the name of a generator in the registry.
        cleanup: project the result onto constant bones and planted feet.
        tries: of a sentence or a story, the seeds from ``seed`` on that are tried until a motion shows all that is
            said; the best is kept (:func:`.tries.run_tries`).
        plan: of the words, or of an earlier result of this request; by default the words are read when the run begins.
    """

    seed: int = 0
    samples: int = 1
    guidance: float = 4.3
    steps: int = OWN_STEPS
    damping: float = 0.7
    sampler: str = "ddim"
    model: str = "intergen"
    cleanup: bool = True
    tries: int = 1
    plan: KeptPlan | None = field(default=None, compare=False, repr=False)

    @property
    def sampling(self) -> dict[str, Any]:
        """The settings by their names, without the plan."""
        return {name: getattr(self, name) for name in SETTINGS}

    def with_plan(self) -> Self:
        """The request with its words read; the same one where they are, or where its method takes none."""
        plan = self.plan or KeptPlan()
        if plan.acts or "words" not in methods.method(self.model).takes:
            return self
        return replace(self, plan=replace(plan, acts=self._read()))

    def spans(self) -> Iterator[PlanFrames]:
        """The plans of what people do by which a result is judged, with the frames of each and the number of its beat.

        Of what is said in one beat there is no number. A reaction is not judged by its words.
        """
        return iter(())

    def _read(self) -> tuple[Plan, ...]:
        """The plans of the words."""
        return ()

    def _check(self, method: Method) -> None:
        if self.steps is None:
            object.__setattr__(self, "steps", method.steps)
        for name, value in method.fixed.items():
            object.__setattr__(self, name, value)
        check_settings(self)
        if self.sampler not in method.samplers:
            raise InputError(
                f"{method.label} does not sample with {self.sampler}: choose {' or '.join(method.samplers)}."
            )


SETTINGS = tuple(f.name for f in fields(SamplingRequest) if f.name != "plan")
"""The names of the settings of every job that denoises a motion."""


@dataclass(frozen=True, kw_only=True)
class GenerateRequest(SamplingRequest):
    """Two people from one sentence, or from a class by the model bigraphdiff.

    Attributes:
        prompt: what the two people do, in English; for bigraphdiff the name of a class.
        seconds: length of the motion.
        split: a sentence of several beats ("first …, then …") is made beat by beat, each in its share of the
            seconds, by a model that makes scenes. Off, the whole sentence is given to the network at once.
        planned: as in a scene: where the words send people, how these hold themselves and which of them stands by
            is read and given. Only with ``split``.
        strictness: the share of the steps, from the first one on, in which the network is held to the poses of the
            plan; in the others they are a draft. A network that reads no drafts is held in all of them.
        acts: what the two do, as a plan that was written or edited by hand; the words are then read by nobody. Where
            there are no words, they follow from the acts. Only with ``split`` and ``planned``.
        paths: on the floor, one for a person at most; only with ``split``, by a model that makes scenes.
    """

    prompt: str = ""
    seconds: float = 5.0
    split: bool = True
    planned: bool = True
    strictness: float = 0.7
    acts: Plan | None = None
    paths: tuple[FloorPath, ...] = ()

    def __post_init__(self) -> None:
        method = methods.method(self.model, "generate")
        if self.acts is not None:
            object.__setattr__(self, "acts", plan_of(self.acts))
            if not self.prompt.strip():
                object.__setattr__(self, "prompt", in_words(self.acts))
        if self.acts is not None and not (self.split and self.planned and "scene" in method.tasks):
            raise InputError(
                "A plan of acts is only followed in beats: leave the plan out, or split and plan the words."
            )
        prompt_of(self.prompt, needed=True)
        object.__setattr__(self, "seconds", number("Length", self.seconds, *method.seconds, " seconds"))
        self._check(method)
        if self.paths:
            self._check_paths(method)

    def _check_paths(self, method: Method) -> None:
        if not self.split or "scene" not in method.tasks:
            raise InputError(f"{method.label} cannot follow a path: remove the paths, or ask with a sentence.")
        given = (path if isinstance(path, FloorPath) else path_of(path) for path in self.paths)
        object.__setattr__(self, "paths", timed_paths(tuple(given), self.seconds))

    def to_dict(self) -> dict[str, Any]:
        """All fields but the plan, and the kind of the request; acts and paths only where there are some."""
        own = ("prompt", "seconds", "split", "planned", "strictness")
        plain = self.sampling | {name: getattr(self, name) for name in own}
        paths = {"paths": [asdict(path) for path in self.paths]} if self.paths else {}
        acts = {} if self.acts is None else {"acts": self.acts.model_dump(mode="json", exclude_defaults=True)}
        return {"kind": "generate", **plain, **acts, **paths}

    def spans(self) -> Iterator[PlanFrames]:
        """One plan, of all frames, where its method takes words and these say something."""
        whole = self.with_plan().plan
        for plan in whole.acts if whole is not None else ():
            if plan.sentence or plan.acts:
                yield plan, 0, None, None

    def _read(self) -> tuple[Plan, ...]:
        return (plan_of_words(self.prompt) if self.acts is None else self.acts,)


@dataclass(frozen=True, kw_only=True)
class ReactRequest(SamplingRequest):
    """Generates a second person for a given one.

    The methods are InterGen person to person (section 5.4), ReGenNet, InterFormer and the virtual agent. The model
    "automatic" becomes the one that :func:`~webdemo.inference.methods.automatic` chooses.
    ReGenNet samples with DDIM only. Online, frames cannot be corrected after they are shown, so ``damping`` is
    set to 0.
    InterFormer neither denoises nor takes text: it uses only ``seed``, ``samples`` and ``cleanup``.
    The virtual agent chooses the prompt itself and InterGen generates the response; its given person acts first.

    Attributes:
        actor: the given person, 1 to 10 seconds on SMPL22's joints, 1 to 60 for InterFormer. At 30 fps the result
            holds these very positions; a clip of another rate is resampled first.
        prompt: what the two people do, in English; empty for a reaction without a stated intent.
        role: role of the given person: "a" acts first, "b" reacts to the generated person.
            ReGenNet's and InterFormer's given person always acts first.
        mode: "offline": the network sees the given person's whole motion; "online" (ReGenNet): each frame
            depends only on the given person's frames so far.
        first_pose: (22, 3) metres, the generated person's first pose in the actor's world; free by default. Not for
            InterGen and the virtual agent.
    """

    actor: Clip
    model: str = methods.AUTOMATIC
    prompt: str = ""
    role: str = "a"
    mode: str = "offline"
    first_pose: NDArray[np.floating] | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        prompt_of(self.prompt, needed=False)
        choice("Role", self.role, ROLES)
        method = methods.reactor(self.model, self.prompt, self.role, self.mode)
        object.__setattr__(self, "model", method.name)
        modes = [variant.mode for variant in method.variants]
        if self.mode not in modes:
            raise InputError(f"{method.label} has no mode {self.mode!r:.40}: choose {' or '.join(modes)}.")
        if self.role != "a" and "either role" not in method.takes:
            raise InputError(f"{method.label} makes the person who reacts: choose role a, or {_others('either role')}.")
        object.__setattr__(self, "actor", check_actor(self.actor, method.seconds))
        if self.first_pose is not None:
            self._check_first_pose(method)
        self._check(method)
        object.__setattr__(self, "tries", 1)  # a reaction is not judged by its words
        if self.mode == "online":  # a frame that was already sent cannot be corrected
            object.__setattr__(self, "damping", 0.0)

    def _read(self) -> tuple[Plan, ...]:
        return (plan_of_words(self.prompt),)

    def _check_first_pose(self, method: Method) -> None:
        if "first pose" not in method.takes:
            raise InputError(f"{method.label} takes no first pose: leave it out, or choose {_others('first pose')}.")
        pose = check_pose(self.first_pose, "The first pose")
        object.__setattr__(self, "first_pose", pose.round(5))  # as in the manifest

    def to_dict(self) -> dict[str, Any]:
        """All fields except the motion, which its SHA-256 represents."""
        plain = self.sampling | {"prompt": self.prompt, "role": self.role, "mode": self.mode}
        del plain["tries"]  # a reaction is not judged by its words
        if self.first_pose is not None:
            plain["first_pose"] = np.asarray(self.first_pose).tolist()
        return {"kind": "react", "actor": motion_facts(self.actor), **plain}


# ---- limits: the numbers, and the checks that say in a sentence what is wrong and what to do -----------------
MAX_PROMPT = 500
STEPS = (1, 1000)
SAMPLES = (1, 8)
TRIES = (1, 4)
GUIDANCE = (0.0, 10.0)
DAMPING = (0.0, 1.0)
STRICTNESS = (0.0, 1.0)
MAX_SEED = 2**32 - 1
SAMPLERS = ("ddim", "dpm++")
_NUMBERS: dict[str, tuple[str, float, float]] = {
    "guidance": ("Guidance scale", *GUIDANCE),
    "damping": ("Damping threshold", *DAMPING),
    "strictness": ("Strictness", *STRICTNESS),
}
_WHOLE: dict[str, tuple[str, int, int]] = {
    "seed": ("Seed", 0, MAX_SEED),
    "samples": ("Samples", *SAMPLES),
    "tries": ("Tries", *TRIES),
    "steps": ("DDIM steps", *STEPS),
}
"""Fields of requests that are numbers, and whole ones, with what messages call them and their limits."""


def check_settings(request: object) -> None:
    """Sets those of a request's fields that are numbers to numbers, and checks its sampler.

    Raises:
        InputError: one sentence on a value that is none, or outside of its limits.
    """
    for name, limits in _WHOLE.items():
        if hasattr(request, name):
            object.__setattr__(request, name, whole(limits[0], getattr(request, name), *limits[1:]))
    for name, bounds in _NUMBERS.items():
        if hasattr(request, name):
            object.__setattr__(request, name, number(bounds[0], getattr(request, name), *bounds[1:]))
    choice("Sampler", getattr(request, "sampler", SAMPLERS[0]), SAMPLERS)


def number(name: str, value: Any, low: float, high: float, unit: str = "") -> float:
    """The value if it is a finite number from ``low`` to ``high``; raises InputError, a sentence, if it is not."""
    if not finite(value):
        raise InputError(f"{name} must be a number from {_plain(low)} to {_plain(high)}{unit}, not {value!r:.40}.")
    if not low <= value <= high:
        raise InputError(f"{name} must be from {_plain(low)} to {_plain(high)}{unit}, not {_plain(value)}.")
    return float(value)


def _plain(value: float) -> str:
    """A number as people write it: 4,294,967,295 rather than 4.29497e+09."""
    return f"{int(value):,}" if 1e4 <= abs(value) < 1e15 and value == int(value) else f"{value:g}"


def whole(name: str, value: Any, low: int, high: int) -> int:
    """As :func:`number`, for a whole one."""
    given = number(name, value, low, high)
    if given != int(given):
        raise InputError(f"{name} must be a whole number from {_plain(low)} to {_plain(high)}, not {value:g}.")
    return int(given)


def prompt_of(value: Any, *, needed: bool) -> str:
    """The value if it is a prompt; raises InputError where it is too long, or empty though ``needed``."""
    if not isinstance(value, str) or (needed and not value.strip()):
        raise InputError("The prompt is empty: say in a sentence what the two people do.")
    if len(value) > MAX_PROMPT:
        raise InputError(f"The prompt has {len(value):,} characters: shorten it to {MAX_PROMPT} or fewer.")
    return value


def choice(name: str, value: Any, known: tuple[str, ...]) -> None:
    """Raises InputError for a value that is not among those known."""
    if value not in known:
        raise InputError(f"{name} {value!r:.40} is not known: choose one of {', '.join(known)}.")
