"""The scene of a sentence: its beats, which share the request's seconds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, replace

import numpy as np

from motion import InputError
from webdemo.inference import methods
from webdemo.inference.actor import FPS
from webdemo.inference.paths import FloorPath
from webdemo.inference.requests import GenerateRequest, SamplingRequest

from .beats import SHORTEST, Beat
from .request import SceneRequest, beat_of
from .scripting import beats_of, told_by, understood
from .told import Told

LEAST_SHARE = 1.25
"""Seconds for each beat of a sentence below which it is made in one."""


def as_scene(request: GenerateRequest, go_on: Callable[[], None] = lambda: None) -> SceneRequest | None:
    """The scene of a sentence with several beats, which share the request's seconds, or of one with a plan or paths.

    None if the sentence is given to the network as it is, as one whose beats would be longer than a prompt. A request
    with a plan has its beats from there. ``go_on`` is called before each sentence; what it raises ends the reading.
    """
    plain = {f.name: getattr(request, f.name) for f in fields(SamplingRequest)}
    if request.plan is not None:
        beats = tuple(beat_of(beat) for beat in request.plan.beats)
        return (
            SceneRequest(
                beats=beats,
                paths=_staying(request.paths, beats),
                planned=request.planned,
                plan=request.plan,
                **plain,
            )
            if beats
            else None
        )
    if not request.split or "scene" not in methods.method(request.model).tasks:
        return None
    try:
        beats = _beats(request, go_on)
        for place, beat in enumerate(beats, 1):
            beat.check(place)
    except InputError:
        go_on()  # may be what raised it
        if request.paths:
            raise
        return None
    if not beats or (
        len(beats) < 2
        and request.acts is None
        and not request.paths
        and not (request.planned and told_by(beats[0]).is_planned)
    ):
        return None
    factor = request.seconds / sum(beat.length for beat in beats)
    edges = np.round(np.cumsum([0.0, *(beat.length * factor for beat in beats)]) * FPS) / FPS
    timed = tuple(
        replace(beat, seconds=round(max(float(s), SHORTEST), 4))
        for beat, s in zip(beats, np.diff(edges), strict=True)
    )
    return SceneRequest(beats=timed, paths=_staying(request.paths, timed), planned=request.planned, **plain)


def _staying(paths: Sequence[FloorPath], beats: Sequence[Beat]) -> tuple[FloorPath, ...]:
    """The timed paths of people, who stay where their path ends unless the words lead them on from there."""
    ends = np.cumsum([beat.length for beat in beats])
    found = []
    for path in paths:
        last = path.points[-1]
        led = any(
            end > (last.seconds or 0.0) and _leads(told_by(beat), path.person)
            for beat, end in zip(beats, ends, strict=True)
        )
        rest = float(ends[-1]) - 1 / FPS
        stays = not led and rest > (last.seconds or 0.0) + 1
        found.append(replace(path, points=(*path.points, replace(last, seconds=rest))) if stays else path)
    return tuple(found)


def _leads(told: Told, person: str) -> bool:
    """True if a person of a beat goes somewhere, or has to do with the other's body."""
    return person in told.going or told.joined or bool(told.contact or told.strike or told.reaching)


def _beats(request: GenerateRequest, go_on: Callable[[], None]) -> tuple[Beat, ...]:
    """The beats of a request: of its acts, or of those that its words are read as.

    A sentence of one beat keeps its words, which the network reads, unless they say what is not done.
    """
    go_on()
    most = request.seconds / LEAST_SHARE
    script = request.acts if request.acts is not None else understood(request.prompt)
    if script is None:
        return (Beat(request.prompt),)
    words = request.prompt if request.acts is None else ""
    beats = beats_of(script, own_words=request.acts is None)
    if not beats or len(beats) > most:
        return (Beat(words, acts=script.acts),)
    told = words and all(act.happens for act in script.acts)  # a network hears no "not"
    return (replace(beats[0], words=words),) if len(beats) == 1 and told else beats
