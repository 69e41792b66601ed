"""The virtual agent of Chopin's thesis (chapter 5): foretells what somebody does, names it, and answers.

Every half second the agent looks at the second before, has a predictor continue it for two, and a recogniser
name the gesture in the three (section 5.5.6). What the looks say is multiplied, where the thesis goes by the
last one. As soon as the agent is sure, or at the end of the clip, InterGen answers with the sentence of that
gesture, where the thesis plays a prerecorded motion; the face of the person, which decides there whether an
answer is due, is not seen.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from models.recogniser import FORETOLD, KNOWN, load_folder, sampled
from webdemo.motion import InputError

from .actor import FPS
from .cancel import CancelToken
from .generator import Clock, DuetGenerator
from .predict import MotionPredictor
from .predict_frame import to_last_pose
from .requests import GenerateRequest, Progress, ReactRequest, Result

Array = NDArray[np.floating]

SURE = 0.9
"""Probability from which on a gesture is answered without looking on."""
LEAST = 0.5
"""Looks in which something is done that must have been for a gesture to be answered at all."""
WEIGHT = 0.5
"""Of a look in the sum of logarithms: a second shares half its frames with the next."""
FLOOR = 1e-3
"""Probability that no look takes from a gesture altogether."""
FIRST, BETWEEN = 45, 15
"""Frame at which the agent first looks, where there is one, and frames between two looks."""
_NO_WORDS = "The virtual agent finds the words itself, so yours were not used."


@dataclass(frozen=True)
class Look:
    """What the agent made of a person at one moment.

    Attributes:
        frame: how many frames of them it had seen.
        chances: (gestures,) probabilities.
    """

    frame: int
    chances: Array


class Eye:
    """Names what a person does, from what they have done so far.

    Args:
        folder: of the recogniser's weights.
        predictor: foretells two seconds.

    Raises WeightsError (an InputError) where files are missing or altered.
    """

    def __init__(self, folder: Path, predictor: MotionPredictor) -> None:
        self.recogniser, source = load_folder(folder)
        self.predictor, self.digest, self.meta = predictor, source.digest, source.meta

    def looks(self, positions: Array) -> list[Look]:
        """Every moment at which the agent looks at a person (T, 22, 3), in metres at 30 fps; T is 30 or more.

        A look depends on the second before it and on nothing after.
        """
        frames = list(range(FIRST, len(positions) + 1, BETWEEN)) or [len(positions)]
        seen = np.stack([positions[frame - KNOWN : frame] for frame in frames]).astype(np.float64)
        foretold = self.predictor.predict(seen, FORETOLD)
        local = to_last_pose(np.concatenate([seen, foretold], axis=1), KNOWN - 1)[0]
        with torch.no_grad():
            chances = self.recogniser(sampled(torch.from_numpy(local).float())).softmax(-1)
        return [Look(frame, row) for frame, row in zip(frames, chances.double().numpy(), strict=True)]

    def decide(self, looks: list[Look]) -> tuple[Look, int | None]:
        """What all looks together say when the agent stops looking, and the place of the gesture to answer.

        A look counts by the probability that somebody does something in it. The agent stops at the first
        look, but not the very first, after which it is sure of a gesture; where all looks together hold less
        than half of one in which something is done, there is none.

        Returns:
            a look with the probabilities of all gestures so far, and a place among them; None for none.
        """
        evidence, done = np.zeros(len(looks[0].chances) - 1), 0.0
        for i, look in enumerate(looks):
            busy = 1 - look.chances[0]
            evidence += WEIGHT * busy * np.log(look.chances[1:] / max(busy, FLOOR) + FLOOR)
            done += busy
            chances = np.exp(evidence - evidence.max())
            chances /= chances.sum()
            if i and done > LEAST and chances.max() >= SURE:
                break
        found = Look(look.frame, np.concatenate([[0.0], chances]))
        return found, 1 + int(chances.argmax()) if done > LEAST else None

    def note(self, look: Look, place: int | None) -> str:
        """What :meth:`decide` came to, in a sentence."""
        if place is None:
            return (
                "The agent saw no gesture that asks for an answer, so the other person is made without words."
            )
        config, rest = self.recogniser.config, look.chances.copy()
        rest[place] = 0
        second = int(rest.argmax())
        return (
            f"After {look.frame / FPS:.1f} s the agent took it for “{config.labels[place]}” "
            f"({look.chances[place]:.0%}; “{config.labels[second]}” {rest[second]:.0%}) and answers: "
            f"“{config.sentences[place]}”"
        )


class Agent:
    """Has InterGen answer what an :class:`Eye` sees.

    Args:
        folder: of the recogniser's weights.
        predictor: foretells two seconds.
        answers: makes the second person.

    Raises WeightsError (an InputError) where files are missing or altered.
    """

    def __init__(self, folder: Path, predictor: MotionPredictor, answers: DuetGenerator) -> None:
        self.eye, self.answers = Eye(folder, predictor), answers
        self.name, self.meta = folder.name, self.eye.meta
        parts = (self.eye.digest, predictor.digest, answers.digest)
        self.digest = hashlib.sha256(" ".join(parts).encode()).hexdigest()

    def run(
        self, request: GenerateRequest | ReactRequest, cancel: CancelToken, clock: Clock
    ) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`Result` without a manifest, whose first note says what was seen.

        Raises:
            InputError: for a request without a given person.
            Cancelled: within one denoising step.
        """
        if not isinstance(request, ReactRequest):
            raise InputError(
                "The virtual agent answers a given person: give it an actor, or choose intergen."
            )
        yield clock.progress("text")
        look, place = self.eye.decide(self.eye.looks(request.actor.positions))
        notes = [self.eye.note(look, place)] + [_NO_WORDS] * bool(request.prompt.strip())
        words = "" if place is None else self.eye.recogniser.config.sentences[place]
        for event in self.answers.run(replace(request, model=self.answers.name, prompt=words), cancel, clock):
            yield replace(event, notes=(*notes, *event.notes)) if isinstance(event, Result) else event
