"""The finish of a scene: people who hold each other come close, arms go round bodies, and nobody is a statue."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion.arms import arms_apart
from motion.easing import smoothstep
from motion.embraces import embraced
from motion.idling import alive
from motion.palms import palms_met
from webdemo.inference.actor import FPS
from webdemo.inference.plans import BeatFinish
from webdemo.inference.story.request import SceneRequest

Array = NDArray[np.floating]

EASES = 20
"""Frames over which a finish begins beside frames that are kept of a given motion."""


def finished(request: SceneRequest, scene: Array, seed: int) -> Array:
    """A scene as it is shown.

    Args:
        request: the scene's request.
        scene: (2, T, 22, 3) metres, its windows joined; frames that are kept of a given motion stay as they are.
        seed: draws how people rest.

    Returns:
        (2, T, 22, 3) float32.
    """
    free = _made(request, scene.shape[1])
    result = arms_apart(embraced(scene, free), np.stack([free, free]))
    rests, touches = np.stack([free, free]), np.zeros_like(free)
    for beat, finish in enumerate(finishes(request)):
        start, stop = request.edges[beat], request.edges[beat + 1]
        if finish.reaching:
            touches[start:stop] = free[start:stop]
        for who in finish.still:
            rests["ab".index(who), start:stop] = 0.0
    result = alive(palms_met(result, touches), FPS, seed, rests).astype(np.float32)
    result[:, free <= 0] = scene[:, free <= 0]
    return result


def finishes(request: SceneRequest) -> tuple[BeatFinish, ...]:
    """The finish of each beat: as it was kept, or else as the words say."""
    if request.plan is not None and request.plan.finishes:
        return request.plan.finishes[: len(request.beats)]
    return tuple(
        # a head that is tilted is not turned to the other
        BeatFinish(bool(told.reaching), "".join(sorted({*told.frozen, *told.limbs})))
        for told in (request.told if request.planned else ())
    )


def _made(request: SceneRequest, frames: int) -> Array:
    """(T,) 1 where a scene was made, easing to 0 at frames that are kept of a given motion."""
    if request.motion is None:
        return np.ones(frames)
    first, last = request.made
    at = np.arange(frames)
    before = (at - first + 1) / EASES if first else np.ones(frames)
    after = (last - at) / EASES if last < frames else np.ones(frames)
    return np.asarray(smoothstep(np.minimum(before, after) - 1 / EASES))
