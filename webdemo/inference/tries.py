"""Tries: further seeds until a motion shows all that its words say, or the best of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from webdemo.inference.finish.cleanup import standing_clear
from webdemo.inference.finish.looks import as_given, furnished
from webdemo.inference.requests import ReactRequest
from webdemo.inference.requests.sampling import MAX_SEED
from webdemo.inference.run import CancelToken, Progress, Result
from webdemo.inference.verdicts import Judged, judged, note, plans_of


def run_tries(
    request: Any, run: Callable[[Any], Iterator[Progress | Result]], cancel: CancelToken
) -> Iterator[Progress | Result]:
    """The progress of up to ``request.tries`` runs and the result of the first that does all that was said.

    Where none does all, it is the one with the largest share of acts done, of equals the first. The tries have the
    seeds that follow the request's. One with the plan of a result has one try: the plan belongs to its seed. So has
    one of whose words nothing can be judged.

    Args:
        request: what is asked for; every try is this request with ``tries=1`` and its own seed.
        run: makes one try.
        cancel: ends the tries, also between two.
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
            attempt = judged(one, _finished(one, event))
            if best is None or attempt.share > best.share:
                best, won = attempt, made
    assert best is not None
    yield _told(best, request, None if asked == 1 else {"asked": asked, "made": made, "won": won})


def _seed(first: int, number: int) -> int:
    return (first + number) % (MAX_SEED + 1)


def _finished(request: Any, result: Result) -> Result:
    """A result whose people have their own sizes and looks, and the things of the request's words."""
    if isinstance(request, ReactRequest):
        result = standing_clear(result, request)
    given = getattr(request, "motion", None) is not None
    return furnished(as_given(result, request), plans_of(request), given=given)


def _told(best: Judged, request: Any, tries: dict[str, Any] | None) -> Result:
    """A result with the note on what it shows."""
    result = best.result
    if tries is not None:
        tries["seed"] = _seed(request.seed, tries["won"] - 1)
        result = replace(result, manifest={**result.manifest, "tries": tries})
    said = note(best.rows, tries, best.unread)
    return replace(result, notes=(said, *result.notes)) if said else result
