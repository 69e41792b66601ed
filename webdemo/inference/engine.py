"""The shared inference layer: a request in, progress events and one result out.

::

    from webdemo.inference import Engine, GenerateRequest

    for event in Engine().run(GenerateRequest(prompt="Two people shake hands.")):
        ...  # Progress, Progress, …, Result
"""

from __future__ import annotations

import platform
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from webdemo.motion import Duet, InputError

from .agent import Agent
from .cancel import CancelToken
from .generator import ClassGenerator, Clock, DuetGenerator
from .interformer import InterFormerReactor
from .live import LiveFrame
from .predict import MotionPredictor
from .predict_request import PredictRequest
from .reactor import Reactor
from .requests import GenerateRequest, Progress, ReactRequest, Result

WEIGHTS = Path(__file__).resolve().parents[2] / "models" / "weights"
Runner = DuetGenerator | ClassGenerator | Reactor | InterFormerReactor | MotionPredictor | Agent
GENERATORS: dict[str, Callable[[Path], Runner]] = {
    "intergen": DuetGenerator,
    "bigraphdiff": ClassGenerator,
    "regennet": Reactor,
    "interformer": InterFormerReactor,
    "motion-mlp": MotionPredictor,
    "mawgan": MotionPredictor,
    "still": lambda _: MotionPredictor(None),
}
"""What runs requests, by name; the folder of its weights has the same name."""
COMPOSED: dict[str, tuple[Callable[..., Runner], tuple[str, ...]]] = {
    "agent": (Agent, ("motion-mlp", "intergen"))
}
"""What also needs others, which come after the folder: by name, with the others' names."""


class Engine:
    """Runs requests on networks that are loaded once, on first use.

    Safe to share between threads: loading happens once, and a run keeps its state to itself.

    Args:
        weights: folder that holds a folder a model; the shipped one by default.
    """

    def __init__(self, weights: Path = WEIGHTS) -> None:
        self.weights = weights
        self._lock = threading.Lock()
        self._generators: dict[str, Runner] = {}

    @property
    def ready(self) -> bool:
        """Whether the default network is in memory."""
        return "intergen" in self._generators

    def warm_up(self) -> None:
        """Loads the default network and takes one step with it, so that the first request is fast."""
        generator = self._generator("intergen")
        request = GenerateRequest(prompt="Two people wave.", seconds=2.0, steps=1, damping=0.0)
        for _ in generator.run(request, CancelToken(), Clock.start()):
            pass

    def info(self) -> dict[str, Any]:
        """Name, summary and figures of the default model, as its folder tells them; loads no network."""
        from models.compact import WeightsFolder

        meta = WeightsFolder(self.weights / "intergen").meta
        return {"name": "intergen", "ready": self.ready, **meta.get("card", {})}

    def run(
        self, request: GenerateRequest | ReactRequest | PredictRequest, cancel: CancelToken | None = None
    ) -> Iterator[Progress | Result]:
        """Yields :class:`Progress` events, then exactly one :class:`Result`.

        The same request on the same machine gives the same bytes.

        Raises:
            InputError: one sentence on what is wrong and what to do.
            Cancelled: within one sampling step of ``cancel.cancel()``.
        """
        cancel = cancel or CancelToken()
        clock = Clock.start()
        yield clock.progress("load")
        generator = self._generator(request.model)
        clock.lap("load", clock.began)
        cancel.raise_if_cancelled()
        for event in generator.run(request, cancel, clock):
            if isinstance(event, Result):
                manifest = _manifest(request, generator)
                duets = tuple(
                    replace(duet, manifest=manifest | {"sample": i}) if isinstance(duet, Duet) else duet
                    for i, duet in enumerate(event.duets)
                )
                event = replace(event, duets=duets, manifest=manifest)
            yield event

    def live(self, request: ReactRequest) -> Iterator[LiveFrame]:
        """The frames of an online reaction, each given as soon as the actor's frame has come.

        Raises:
            InputError: for a request that is not online.
        """
        if request.mode != "online":
            raise InputError("Only an online reaction can be streamed: choose model regennet, mode online.")
        reactor = self._generator(request.model)
        assert isinstance(reactor, Reactor)  # no other model has the mode
        return reactor.live(request)

    def _generator(self, name: str) -> Any:
        known = [*GENERATORS, *COMPOSED]
        if name not in known:
            raise InputError(f"There is no model {name!r:.40}: choose one of {', '.join(known)}.")
        with self._lock:
            return self._loaded(name)

    def _loaded(self, name: str) -> Any:
        """What runs a model's requests, loaded where it is not; under the lock."""
        if name not in self._generators:
            make, parts = COMPOSED.get(name) or (GENERATORS[name], ())
            self._generators[name] = make(self.weights / name, *map(self._loaded, parts))
        return self._generators[name]


def _manifest(request: Any, generator: Runner) -> dict[str, Any]:
    """Everything that reproduces a result."""
    return {
        "product": "Pas de Deux",
        "request": request.to_dict(),
        "model": generator.name,
        "weights_sha256": generator.digest,
        "versions": {name: _version(name) for name in ("torch", "diffusers", "numpy")}
        | {"python": platform.python_version()},
    }


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"
