"""Tries with further seeds until a motion shows all that its words say, or the best of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from webdemo.inference.requests.limits import MAX_SEED
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer

from .verdicts import Judged, judged, note


def run_tries(
    request: Any, run: Callable[[Any], Iterator[Progress | Result]], cancel: CancelToken, timer: StageTimer
) -> Iterator[Progress | Result]:
    """The progress of up to ``request.tries`` runs and the result of the first that does all that was said.

    Where none does all, it is the one with the largest share of acts done, of equals the first. The tries have the
    seeds that follow the request's. One with the plan of a result has one try: the plan belongs to its seed. So has
    one of whose words nothing can be judged.

    Args:
        request: what is asked for; every try is this request with ``tries=1`` and its own seed.
        run: makes one try.
        cancel: ends the tries, also between two.
        timer: of all tries together.
    """
    plan = getattr(request, "plan", None)
    asked = 1 if plan is not None and plan.of_result else getattr(request, "tries", 1)
    best: Judged | None = None
    made, won = 0, 1
    while made < asked and (best is None or best.share < 1.0):
        cancel.raise_if_cancelled()
        one = request if asked == 1 else replace(request, seed=_seed(request.seed, made), tries=1)
        made += 1
        for event in run(one):
            if not isinstance(event, Result):
                yield event if asked == 1 else replace(event, attempt=made, attempts=asked)
                continue
            found = judged(one, event)
            if best is None or found.share > best.share:
                best, won = found, made
    assert best is not None
    yield _finished(best, request, timer, None if asked == 1 else {"asked": asked, "made": made, "won": won})


def _seed(first: int, number: int) -> int:
    return (first + number) % (MAX_SEED + 1)


def _finished(best: Judged, request: Any, timer: StageTimer, tries: dict[str, Any] | None) -> Result:
    result = best.result
    if tries is not None:
        tries["seed"] = _seed(request.seed, tries["won"] - 1)
        timings = {**result.timings, **timer.stages, "total": round(timer.elapsed, 4)}
        result = replace(result, manifest={**result.manifest, "tries": tries}, timings=timings)
    said = note(best.rows, tries, best.unread)
    return replace(result, notes=(said, *result.notes)) if said else result


def replayed(request: Mapping[str, Any], manifest: Mapping[str, Any]) -> dict[str, Any]:
    """The fields of a kept request that make its result at once: the seed of the try that was kept, and one try."""
    tries = manifest.get("tries")
    if not isinstance(tries, Mapping) or "seed" not in tries:
        return dict(request)
    return {**request, "seed": tries["seed"], "tries": 1}
