"""The engine behind the queue: imported when first needed, several requests in one pass."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from webdemo.inference.cancel import CancelToken
from webdemo.inference.requests import GenerateRequest, Progress, ReactRequest, Result
from webdemo.ui.lazy import LazyEngine

TOGETHER = ("intergen", "bigraphdiff")
"""Models whose requests may share passes."""
NEARBY = 1.25
"""The longest motion of a pass is at most this many times as long as the shortest: the rest is padding."""


class SharedEngine(LazyEngine):
    """A :class:`LazyEngine` that runs requests together; also the queue's batcher."""

    def key(self, request: Any) -> tuple[Any, ...] | None:
        """Requests of one model, sampler and number of steps may share a pass; others run alone."""
        if type(request) not in (GenerateRequest, ReactRequest) or request.model not in TOGETHER:
            return None
        return request.model, request.sampler, request.steps

    def fits(self, requests: Sequence[Any], other: Any) -> bool:
        """Whether the lengths are near each other."""
        lengths = [_seconds(request) for request in (*requests, other)]
        return max(lengths) <= NEARBY * min(lengths)

    def run_together(
        self, items: Sequence[tuple[Any, CancelToken]]
    ) -> Iterator[tuple[int, Progress | Result | Exception]]:
        """(which request, what happened to it); each ends in a Result or an Exception.

        A result's manifest says how many shared its pass, since they change it by rounding.
        """
        from webdemo.inference.batch import run_batch

        for i, event in run_batch(self._made(), items):
            if isinstance(event, Result) and len(items) > 1:
                event = replace(event, manifest={**event.manifest, "runs_in_pass": len(items)})
            yield i, event


def _seconds(request: GenerateRequest | ReactRequest) -> float:
    return request.seconds if isinstance(request, GenerateRequest) else request.actor.seconds
