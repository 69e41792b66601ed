"""The scene of a sentence: its beats, which share the request's seconds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, replace

import numpy as np

from acts import Plan
from acts.staging.score import Score
from acts.staging.stage import score_of
from motion import FPS, InputError
from webdemo.inference import methods
from webdemo.inference.requests import GenerateRequest, SamplingRequest
from webdemo.inference.requests.acting import with_plan
from webdemo.inference.requests.paths import FloorPath

from .beats import SHORTEST, Beat, beat_of, plan_of_beat, seconds_of_acts
from .request import SceneRequest
from .sentences import beats_of

LEAST_SHARE = 1.25
"""Seconds for each beat of a sentence below which it is made in one."""


def as_scene(request: GenerateRequest, go_on: Callable[[], None] = lambda: None) -> SceneRequest | None:
    """The scene of a sentence with several beats, which share the request's seconds, or of one with a plan or paths.

    None if the sentence is given to the network as it is, as one whose beats would be longer than a prompt. A request
    with the plan of a result has its beats from there. ``go_on`` is called before the sentence is read; what it raises
    ends the reading.
    """
    if not request.split or "scene" not in methods.method(request.model).tasks:
        return None
    go_on()
    request = with_plan(request)
    assert request.plan is not None
    whole, replays = request.plan.acts[0], request.plan.of_result
    beats = tuple(beat_of(beat) for beat in request.plan.beats) if replays else _beats(request, whole)
    try:
        for place, beat in enumerate(beats, 1):
            beat.check(place)
    except InputError:
        if request.paths:
            raise
        return None
    plans = tuple(plan_of_beat(beat) if beat.acts else whole for beat in beats)
    as_it_is = len(beats) == 1 and request.acts is None and not request.paths and not replays
    if not beats or (as_it_is and not (request.planned and score_of(plans[0].acts).is_planned)):
        return None
    if not replays:
        beats = _filling(request.seconds, beats, plans)
    return SceneRequest(
        beats=beats,
        paths=_staying(request.paths, beats),
        planned=request.planned,
        plan=replace(request.plan, acts=plans),
        **{f.name: getattr(request, f.name) for f in fields(SamplingRequest)},
    )


def _filling(seconds: float, beats: Sequence[Beat], plans: Sequence[Plan]) -> tuple[Beat, ...]:
    """Beats that share some seconds by the lengths of their acts, in whole frames."""
    lengths = [seconds_of_acts(beat.acts or plan.acts) for beat, plan in zip(beats, plans, strict=True)]
    factor = seconds / sum(lengths)
    edges = np.round(np.cumsum([0.0, *(length * factor for length in lengths)]) * FPS) / FPS
    return tuple(
        replace(beat, seconds=round(max(float(s), SHORTEST), 4)) for beat, s in zip(beats, np.diff(edges), strict=True)
    )


def _staying(paths: Sequence[FloorPath], beats: Sequence[Beat]) -> tuple[FloorPath, ...]:
    """The timed paths of people, who stay where their path ends unless the words lead them on from there."""
    ends = np.cumsum([beat.length for beat in beats])
    staying = []
    for path in paths:
        last = path.points[-1]
        led = any(
            end > (last.seconds or 0.0) and _leads(score_of(beat.acts), path.person)
            for beat, end in zip(beats, ends, strict=True)
        )
        rest = float(ends[-1]) - 1 / FPS
        stays = not led and rest > (last.seconds or 0.0) + 1
        staying.append(replace(path, points=(*path.points, replace(last, seconds=rest))) if stays else path)
    return tuple(staying)


def _leads(score: Score, person: str) -> bool:
    """True if a person of a beat goes somewhere, or has to do with the other's body."""
    return person in score.going or score.joined or bool(score.touch or score.strike or score.reaching)


def _beats(request: GenerateRequest, script: Plan) -> tuple[Beat, ...]:
    """The beats of a request's plan.

    A sentence of one beat keeps its words, which the network reads, unless they say what is not done.
    """
    most = request.seconds / LEAST_SHARE
    if request.acts is None and not script.acts:
        return (Beat(request.prompt),)
    words = request.prompt if request.acts is None else ""
    beats = beats_of(script, own_words=request.acts is None)
    if not beats or len(beats) > most:
        return (Beat(words, acts=script.acts),)
    score = words and all(act.happens for act in script.acts)  # a network hears no "not"
    return (replace(beats[0], words=words),) if len(beats) == 1 and score else beats
