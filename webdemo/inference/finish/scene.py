"""The finish of a scene: people who hold each other come close, arms go round bodies, and nobody is a statue."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from acts.staging.score import Score
from motion import FPS
from motion.idling import alive
from motion.smoothing import eased_marks, smoothstep
from motion.swings import swinging
from motion.touch.apart import bodies_apart
from motion.touch.arms import arms_apart, embraced
from motion.touch.hands import backs_straight, hands_clasped, palms_met
from webdemo.inference.requests.actor import ROLES
from webdemo.inference.requests.plans import BeatFinish
from webdemo.inference.story.request import SceneRequest

Array = NDArray[np.floating]

EASES = 20
"""Frames over which a finish begins and ends: beside beats without it, and beside frames that are kept."""


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
    marks = np.zeros((6, scene.shape[1]), dtype=bool)  # palms meet, hands held; a and b still; a and b loose
    for beat, finish in enumerate(finishes(request)):
        whose = (who in people for people in (finish.still, finish.loose) for who in ROLES)
        marks[:, request.edges[beat] : request.edges[beat + 1]] = np.array([finish.reaching, finish.held, *whose])[
            :, None
        ]
    shares = np.stack([eased_marks(each, EASES) for each in marks]) * free
    raised, held, loose = shares[0], shares[1], shares[4:]
    rests = free - shares[2:4]
    swung = np.stack([swinging(scene[i], FPS, loose[i], [seed, i]) for i in (0, 1)])
    result = alive(in_touch(swung, free, raised, held), FPS, seed, rests, loose).astype(np.float32)
    result[:, free <= 0] = scene[:, free <= 0]
    return result


def finishes(request: SceneRequest) -> tuple[BeatFinish, ...]:
    """The finish of each beat: as it was kept, or else as the words say."""
    if request.plan is not None and request.plan.finishes:
        return request.plan.finishes[: len(request.beats)]
    return tuple(finish_of(score) for score in (request.scores if request.plans_words else ()))


def finish_of(score: Score) -> BeatFinish:
    """The finish that a beat's words ask for."""
    around = any(gesture.gesture == "around" for gesture in score.gestures.values())
    # a head that is tilted is not turned to the other
    still = {*score.frozen, *score.limbs, *score.figures}
    if (touch := score.touch) is not None and touch.beside:
        still.add(touch.person)
    loose = "".join(sorted(score.loose - score.frozen))
    return BeatFinish(bool(score.reaching), "".join(sorted(still)), score.linked and not around, loose)


def in_touch(scene: Array, free: Array, raised: Array, held: Array) -> Array:
    """Two people (2, T, 22, 3) who embrace closely, whose hands meet, and whose bodies are not in each other.

    Args:
        scene: (2, T, 22, 3) metres.
        free: (T,) how far a frame may be changed, 0 to 1.
        raised: (T,) likewise, where hands that are raised against each other meet.
        held: (T,) likewise, where hands are held.
    """
    result = backs_straight(bodies_apart(embraced(scene, free), FPS, free), raised)
    result = arms_apart(hands_clasped(result, held), np.stack([free, free]))
    return palms_met(result, raised)


def _made(request: SceneRequest, frames: int) -> Array:
    """(T,) 1 where a scene was made, easing to 0 at frames that are kept of a given motion."""
    if request.motion is None:
        return np.ones(frames)
    first, last = request.made
    at = np.arange(frames)
    before = (at - first + 1) / EASES if first else np.ones(frames)
    after = (last - at) / EASES if last < frames else np.ones(frames)
    return np.asarray(smoothstep(np.minimum(before, after) - 1 / EASES))
