"""The engine behind the queue: imported on first use, and able to run several requests in one pass."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from motion import FPS
from webdemo.inference.methods import method
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.run import CancelToken, Progress, Result
from webdemo.inference.story.request import SceneRequest, windows
from webdemo.ui.lazy import LazyEngine

NEARBY = 1.25
"""Largest ratio of the longest to the shortest motion in a pass, which limits padding."""


class SharedEngine(LazyEngine):
    """A :class:`LazyEngine` that runs requests together; also the queue's batcher."""

    def key(self, request: Any) -> tuple[Any, ...] | None:
        """Requests of one model, sampler and number of steps may share a pass; others run alone."""
        if (
            type(request) not in (GenerateRequest, ReactRequest, SceneRequest)
            or not method(request.model).shares_passes
        ):
            return None
        return request.model, request.sampler, request.steps

    def fits(self, requests: Sequence[Any], other: Any) -> bool:
        """True if the lengths are similar enough to share a pass."""
        lengths = [_seconds(request) for request in (*requests, other)]
        return max(lengths) <= NEARBY * min(lengths)

    def run_together(
        self, items: Sequence[tuple[Any, CancelToken]]
    ) -> Iterator[tuple[int, Progress | Result | Exception]]:
        """(index of a request, its event); each request ends in a Result or an Exception.

        A result's manifest records how many requests shared its pass, since that affects rounding.
        """
        from webdemo.inference.engine.batch import run_batch

        for i, event in run_batch(self._made(), items):
            if isinstance(event, Result) and len(items) > 1:
                event = replace(event, manifest={**event.manifest, "runs_in_pass": len(items)})
            yield i, event


def _seconds(request: GenerateRequest | ReactRequest | SceneRequest) -> float:
    """The longest motion that it passes through the network at once."""
    if isinstance(request, SceneRequest):
        return max(window.past + window.stop - window.start + window.after for window in windows(request)) / FPS
    return request.seconds if isinstance(request, GenerateRequest) else request.actor.seconds
