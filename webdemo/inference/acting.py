"""The plan of acts that a request follows where its words are read by the lexicon or a director."""

from __future__ import annotations

from dataclasses import replace

from acts import Plan, lexicon, read
from acts.config import director_settings
from acts.own import own_files
from acts.reading.director import directed
from motion import InputError

from . import methods
from .requests import GenerateRequest


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
