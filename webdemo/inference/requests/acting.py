"""The plan of acts that a request follows: read once, when its run begins, and kept in the request from then on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, TypeVar

from acts import Plan
from acts.plan import plan_of
from webdemo.inference import methods
from webdemo.inference.story.beats import beat_of, plan_of_beat, plan_of_words
from webdemo.inference.story.request import SceneRequest

from .plans import KeptPlan, kept_plan
from .sampling import GenerateRequest, ReactRequest

Request = TypeVar("Request")


def with_plan(request: Request) -> Request:
    """A request whose words are read; the same one where they are, or where it has none that its method takes."""
    if not isinstance(request, (GenerateRequest, ReactRequest, SceneRequest)):
        return request
    plan = request.plan or KeptPlan()
    if plan.acts or "words" not in methods.method(request.model).takes:
        return request
    if isinstance(request, SceneRequest):
        acts = request.plans
    elif isinstance(request, GenerateRequest) and request.acts is not None:
        acts = (request.acts,)
    else:
        acts = (plan_of_words(request.prompt),)
    return replace(request, plan=replace(plan, acts=acts))


def plans_of(request: Any) -> Iterator[tuple[Plan, int, int | None, int | None]]:
    """The plans of what people do, with the frames of each and the number of its beat, where there are several."""
    if isinstance(request, SceneRequest):
        several, edges = len(request.beats) > 1, request.edges
        for i, plan in enumerate(request.plans):
            if plan.sentence or plan.acts:
                yield plan, edges[i], edges[i + 1], i + 1 if several else None
    elif isinstance(request, GenerateRequest):  # a reaction is not judged by its words
        whole = with_plan(request).plan
        for plan in whole.acts if whole is not None else ():
            if plan.sentence or plan.acts:
                yield plan, 0, None, None


def plans_of_result(manifest: Mapping[str, Any]) -> tuple[Plan, ...]:
    """The plans of a result's words, of each beat where it is of a story; read now, if a version kept none.

    Raises:
        InputError: if they are damaged.
    """
    if (kept := kept_plan(manifest)) is not None and kept.acts:
        return kept.acts
    asked = manifest.get("request") or {}
    if asked.get("acts"):
        return (plan_of(asked["acts"]),)
    if asked.get("beats"):
        return tuple(plan_of_beat(beat_of(beat)) for beat in asked["beats"])
    return (plan_of_words(str(asked.get("prompt") or "")),)
