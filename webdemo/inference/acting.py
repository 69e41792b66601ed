"""The plan of acts that a request follows where its words are read by the lexicon."""

from __future__ import annotations

from dataclasses import replace

from acts import Plan, lexicon, read
from acts.own import own_files

from . import methods
from .requests import GenerateRequest


def acted(request: GenerateRequest) -> GenerateRequest:
    """The request with the plan that its words say, if they name an act of the lab's own; otherwise as it is.

    Raises:
        InputError: if the parser is not installed.
    """
    planned = request.split and request.planned and request.acts is None and request.plan is None
    if not planned or "scene" not in methods.method(request.model).tasks:
        return request
    plan = _plan_for(request.prompt)
    return request if plan is None else replace(request, acts=plan)


def _plan_for(prompt: str) -> Plan | None:
    """The plan of a prompt that has an act of the lab's own."""
    if not own_files().files:
        return None
    own = set(lexicon().own)
    plan = read(prompt) if own else Plan()
    return plan if any(act.happens and act.act in own for act in plan.acts) else None
