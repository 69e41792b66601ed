"""The description of a method: one object with everything that the rest of the product needs to know about it.

The page, the shell, the API, the queue, the history and the benchmark read these objects through
:mod:`webdemo.inference.methods` and keep no list of their own. Importing this module imports no torch.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, Protocol

from .run import CancelToken, Progress, Result, StageTimer

Task = Literal["generate", "react", "predict", "scene"]
DEFAULT_STEPS = 8
"""Denoising steps where neither the request nor the method names any: on the page, in the shell, the API, stories and
Python. With the shipped InterGen the rules obeyed at 8 and at 25 steps differ by no more than chance (docs/scores.md).
"""
SECONDS = (1.0, 10.0)
"""The shortest and the longest motion that the networks take."""
WEIGHTS = Path(__file__).resolve().parents[2] / "models" / "weights"
"""The folder of all shipped weights."""
Input = Literal["words", "class", "actor", "first pose", "either role", "past", "two people"]


class Pipeline(Protocol):
    """A loaded network with the steps around it.

    Attributes:
        name: of its method.
        digest: one SHA-256 for all its weights, "" where it has none.
    """

    name: str
    digest: str

    def run(self, request: Any, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """Yields progress events, then exactly one result, whose manifest holds a plan or nothing; the engine fills it.

        Raises:
            InputError: one sentence on what is wrong and what to do.
            Cancelled: within one sampling step of ``cancel.cancel()``.
        """
        ...


def load_pipeline(place: str, *parts: Any) -> Pipeline:
    """The pipeline of a method that is shipped; imports torch.

    Requests read the registry of methods, and pipelines read requests, so the registry names a pipeline and imports
    none; the engine asks for it.

    Args:
        place: its module in :mod:`webdemo.inference.pipelines` and its class, "intergen.InterGenPipeline".
        parts: what :attr:`Method.load` is called with.
    """
    module, _, name = place.partition(".")
    pipeline: Pipeline = getattr(importlib.import_module(f"webdemo.inference.pipelines.{module}"), name)(*parts)
    return pipeline


@dataclass(frozen=True, kw_only=True)
class Method:
    """A way of making motion.

    Attributes:
        name: in requests, manifests and on the command line.
        label: what people call it.
        summary: one sentence that is shown where the method is chosen.
        tasks: what it can be asked for.
        takes: what a request may give it. "either role": the given person may act or react; "two people": the past
            must be of both.
        load: (weights folder, *the pipelines of ``needs``) → a :class:`Pipeline`. Imports torch when called, not
            before.
        modes: mode → label, for reactions. "offline" sees the whole given motion; "online" sees the frames so
            far and can stream.
        defaults: fields of a request for which this method's best value differs from the request's default.
        fixed: fields of a request that mean nothing to this method, with the value that they are set to.
        samplers: names of the samplers that it can use.
        seconds: (shortest, longest) motion in seconds.
        weights: name of its folder under ``models/weights``; None for a method without weights.
        needs: names of the methods whose pipelines it is built on.
    """

    name: str
    label: str
    summary: str
    tasks: tuple[Task, ...]
    takes: frozenset[Input]
    load: Callable[..., Pipeline]
    modes: Mapping[str, str] = field(default_factory=dict)
    defaults: Mapping[str, Any] = field(default_factory=dict)
    fixed: Mapping[str, Any] = field(default_factory=dict)
    samplers: tuple[str, ...] = ("ddim", "dpm++")
    seconds: tuple[float, float] = SECONDS
    weights: str | None = None
    needs: tuple[str, ...] = ()

    @property
    def steps(self) -> int:
        """Denoising steps of a request that names none."""
        return int(self.defaults.get("steps", DEFAULT_STEPS))

    def installed(self, weights: Path) -> bool:
        """True if its weights are in the folder of all weights; nothing is loaded."""
        return self.weights is None or (weights / self.weights / "config.json").is_file()

    @property
    def variants(self) -> tuple[Variant, ...]:
        """The method in each of its modes."""
        modes = self.modes or {"offline": self.label}
        return tuple(
            Variant(self.name if i == 0 else f"{self.name}-{mode}", label, self, mode)
            for i, (mode, label) in enumerate(modes.items())
        )


@dataclass(frozen=True)
class Variant:
    """A method in one of its modes, as it is chosen on the page.

    Attributes:
        key: the method's name, followed by the mode where it is not the first.
        label: what people call it.
        method: the method.
        mode: of a reaction.
    """

    key: str
    label: str
    method: Method
    mode: str
