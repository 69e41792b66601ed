"""The shared inference layer: a request in, progress events and one result out.

::

    from webdemo.inference import Engine, GenerateRequest

    for event in Engine().run(GenerateRequest(prompt="Two people shake hands.")):
        ...  # Progress, Progress, …, Result
"""

from __future__ import annotations

import platform
import threading
from collections.abc import Iterator
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any, cast

from motion import Duet
from webdemo.inference import methods
from webdemo.inference.finish.looks import enlarged
from webdemo.inference.method import Pipeline
from webdemo.inference.methods import WEIGHTS
from webdemo.inference.requests import GenerateRequest, ReactRequest, SamplingRequest
from webdemo.inference.requests.live import LivePartner, LiveTake, check_partner
from webdemo.inference.requests.predict import PredictRequest
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer
from webdemo.inference.story.request import SceneRequest
from webdemo.inference.tries import run_tries
from webdemo.inference.verdicts import kept_rows

Request = GenerateRequest | ReactRequest | PredictRequest | SceneRequest | LiveTake


class Engine:
    """Runs requests on networks that are loaded once, on first use.

    Safe to share between threads: loading happens once, and a run keeps its state to itself.

    Args:
        weights: folder that holds a folder a model; the shipped one by default.
    """

    def __init__(self, weights: Path = WEIGHTS) -> None:
        self.weights = weights
        self._lock = threading.Lock()
        self._loading: dict[str, threading.RLock] = {}
        self._pipelines: dict[str, Pipeline] = {}
        self._warm: set[str] = set()
        self._warming = threading.Lock()

    @property
    def ready(self) -> bool:
        """True if the default network is in memory."""
        return SamplingRequest.model in self._pipelines

    def warm_up(self) -> None:
        """Loads the default network and runs one step, which makes the first request fast; once."""
        with self._warming:
            if SamplingRequest.model not in self._warm:
                for _ in self.run(GenerateRequest(prompt="Two people wave.", seconds=2.0, steps=1, damping=0.0)):
                    pass
                self._warm.add(SamplingRequest.model)

    def info(self) -> dict[str, Any]:
        """Name, summary and figures of the default model, read from its folder; loads no network."""
        from models.weights_io import WeightsFolder

        name = SamplingRequest.model
        meta = WeightsFolder(self.weights / name).meta
        return {"name": name, "ready": self.ready, **meta.get("card", {})}

    def run(self, request: Request, cancel: CancelToken | None = None) -> Iterator[Progress | Result]:
        """Yields :class:`Progress` events, then exactly one :class:`Result`.

        The same request on the same machine gives the same bytes.

        Args:
            request: what is asked for.
            cancel: stops the run.

        Raises:
            InputError: one sentence on what is wrong and what to do.
            Cancelled: within one sampling step of ``cancel.cancel()``.
        """
        cancel = cancel or CancelToken()
        timer = StageTimer()
        yield timer.progress("load")
        pipeline = self.pipeline(request.model)
        _take_threads(pipeline)
        if isinstance(request, SamplingRequest):
            request = request.with_plan()
        timer.lap("load")
        cancel.raise_if_cancelled()

        def run(one: Request) -> Iterator[Progress | Result]:
            if isinstance(one, LiveTake):  # its motion is there
                return one.results(timer)
            return pipeline.run(enlarged(one), cancel, timer)

        for event in run_tries(request, run, cancel):
            if isinstance(event, Result):
                timer.lap("finish")
                manifest = _manifest(request, pipeline) | event.manifest
                duets = tuple(
                    replace(duet, manifest=manifest | kept_rows(duet) | {"sample": i})
                    if isinstance(duet, Duet)
                    else duet
                    for i, duet in enumerate(event.duets)
                )
                event = replace(event, duets=duets, manifest=manifest, timings=event.timings or timer.timings)
            yield event

    def partner(self, name: str, *, seed: int = 0) -> LivePartner:
        """A partner who answers a stream of poses, one of :data:`webdemo.inference.requests.live.PARTNERS`.

        Raises:
            InputError: if there is no such partner, or its weights are missing or altered.
        """
        check_partner(name)
        from webdemo.inference.live.agent import LiveAgent
        from webdemo.inference.live.partner_pipeline import ReactingPartner, warm_up

        reacting: Any = self.pipeline("regennet")
        eye = None if name == "regennet" else cast(Any, self.pipeline("agent")).eye

        def made() -> LivePartner:
            partner = ReactingPartner(reacting, seed=seed)
            return partner if eye is None else LiveAgent(eye, partner)

        if name not in self._warm:  # PyTorch's first passes take a second
            warm_up(made())
            self._warm.add(name)
        return made()

    def pipeline(self, name: str) -> Pipeline:
        """The pipeline that runs the requests of a method; loads it first if necessary.

        Raises:
            InputError: if there is no such method, or its weights are missing or altered.
        """
        described = methods.method(name)
        with self._lock:
            loading = self._loading.setdefault(name, threading.RLock())
        with loading:  # of this method alone: no model waits for another one's loading
            if name not in self._pipelines:
                parts = [self.pipeline(needed) for needed in described.needs]
                _take_threads()
                self._pipelines[name] = described.load(self.weights / (described.weights or name), *parts)
            return self._pipelines[name]


def _take_threads(pipeline: Pipeline | None = None) -> None:
    """Sets PyTorch's threads for a run that begins in this thread, or for loading."""
    from models.compiled import take_threads  # needs PyTorch, which the engine itself does not

    take_threads(plain_denoiser=not getattr(pipeline, "compiled", True))


def _manifest(request: Any, pipeline: Pipeline) -> dict[str, Any]:
    """Everything that reproduces a result."""
    plan = getattr(request, "plan", None)
    return ({} if plan is None else {"plan": plan.to_dict()}) | {
        "product": "Pas de Deux",
        "request": request.to_dict(),
        "model": pipeline.name,
        "weights_sha256": pipeline.digest,
        "versions": {name: version(name) for name in ("torch", "diffusers", "numpy")}
        | {"python": platform.python_version()},
    }
