"""The plans of acts that a request follows: of its words, read by the lexicon or a director, or of its beats."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from acts import Act, Plan, lexicon, read
from acts.config import director_settings
from acts.own import own_files
from acts.reading.director import directed
from motion import InputError

from . import methods
from .requests import GenerateRequest
from .story.request import SceneRequest


def acted(request: GenerateRequest) -> GenerateRequest:
    """The request with the plan of its words, if a director reads them or they name an act of the lab's own.

    Raises:
        InputError: if the parser is not installed.
    """
    planned = request.split and request.planned and request.acts is None and request.plan is None
    if not planned or "scene" not in methods.method(request.model).tasks:
        return request
    plan = _plan_for(request.prompt)
    return request if plan is None else replace(request, acts=plan)


def _plan_for(prompt: str) -> Plan | None:
    """The plan of a prompt that a director read, or that has an act of the lab's own."""
    if _has_director():
        plan = directed(prompt)
        if plan.reader != "lexicon" and any(act.happens for act in plan.acts):
            return plan
    if not own_files().files:
        return None
    own = set(lexicon().own)
    plan = read(prompt) if own else Plan()
    return plan if any(act.happens and act.act in own for act in plan.acts) else None


def _has_director() -> bool:
    try:
        return director_settings() is not None
    except InputError:  # `read` and `/read` say what is wrong with it
        return False


def plans_of(request: Any) -> Iterator[tuple[Plan, int, int | None, int | None]]:
    """The plans of a request's words, with the frames of each and the number of its beat, where there are several."""
    if isinstance(request, SceneRequest):
        edges = request.edges
        several = len(request.beats) > 1
        for i, beat in enumerate(request.beats):
            plan = _of_acts(beat.acts) if beat.acts else _read(beat.sentence)
            if plan is not None:
                yield plan, edges[i], edges[i + 1], i + 1 if several else None
        return
    if isinstance(request, GenerateRequest) and "words" in methods.method(request.model).takes:
        plan = _read(request.prompt) if request.acts is None else request.acts
        if plan is not None:
            yield plan, 0, None, None


def _of_acts(acts: Sequence[Act]) -> Plan:
    """The plan of a beat's acts alone, without their relations to acts of other beats."""
    here = {act.id for act in acts}
    kept = [act.model_copy(update={"order": tuple(r for r in act.order if r.act in here)}) for act in acts]
    return Plan(acts=tuple(kept))


def _read(sentence: str) -> Plan | None:
    """The plan of a sentence; None without words, or where no parser is installed."""
    try:
        return read(sentence) if sentence.strip() else None
    except InputError:
        return None
