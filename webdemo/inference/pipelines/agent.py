"""The virtual agent of Chopin's thesis (chapter 5): predicts what a person does, recognises it, and responds.

Every half second the agent takes the last second of the person's motion, predicts the next two, and classifies
the gesture in these three seconds (section 5.5.6). It multiplies the probabilities of all looks, while the thesis
uses the last look only. Until it is sure, it stands and faces the place where the person began. Then InterGen
generates the response from the sentence of that gesture, where the thesis plays a prerecorded motion. As in the
thesis, the response is planned once. InterGen receives what both people have done so far and generates the
person's next movements itself, so no frame of the agent depends on a later frame of the person. The agent does not
see the person's face, which in the thesis decides whether to respond; live it sees where a face points.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch

from acts.staging.window import KnownFrames, KnownPath
from models.agent.recogniser import OBSERVED, PREDICTED, Recogniser, sampled
from models.weights_io import load_network
from motion import FPS
from motion.transforms import MEDIAN_START_DISTANCE, Placement
from motion.vectors import Array
from webdemo.inference.requests import ReactRequest
from webdemo.inference.requests.plans import KeptPlan, plan_of_words
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer, until_result

from .given import Reaction, hold_of
from .intergen import InterGenPipeline
from .predictor import PredictorPipeline, to_last_pose

SURE = 0.9
"""The agent responds to a gesture from this probability on."""
LEAST = 0.5
"""The agent responds only if the probabilities of any gesture, summed over its looks, exceed this."""
WEIGHT = 0.5
"""Weight of a look in the sum of log-probabilities: successive looks share half of their frames."""
FLOOR = 1e-3
"""Added to each probability, so that one look cannot rule a gesture out."""
FIRST, BETWEEN = 45, 15
"""Frame of the agent's first look (the last frame of a shorter motion), and frames between two looks."""
_NO_WORDS = "The virtual agent finds the words itself, so yours were not used."


@dataclass(frozen=True)
class Look:
    """The agent's classification of a person at one moment.

    Attributes:
        frame: number of the person's frames seen so far.
        chances: (gestures,) probabilities.
    """

    frame: int
    chances: Array


@dataclass(frozen=True)
class Decision:
    """The result of :meth:`Eye.decide`.

    Attributes:
        look: the last look, with the probabilities of all gestures given all looks so far.
        place: index of the likeliest gesture in the recogniser's list; None if there was no gesture.
        sure: whether the agent responds, from the look's frame on.
    """

    look: Look
    place: int | None
    sure: bool


class Eye:
    """Recognises a person's gesture from their motion so far.

    Args:
        folder: of the recogniser's weights.
        predictor: predicts two seconds.

    Raises WeightsError (an InputError) if files are missing or altered.
    """

    def __init__(self, folder: Path, predictor: PredictorPipeline) -> None:
        self.recogniser, source = load_network(folder, Recogniser)
        self.predictor, self.digest = predictor, source.digest

    def looks(self, positions: Array) -> list[Look]:
        """Every moment at which the agent looks at a person (T, 22, 3), in metres at 30 fps.

        A look depends on the second before it and on nothing after; of less than a second the first frame is held.
        """
        missing = max(OBSERVED - len(positions), 0)
        positions = np.pad(positions, ((missing, 0), (0, 0), (0, 0)), mode="edge")
        frames = list(range(FIRST, len(positions) + 1, BETWEEN)) or [len(positions)]
        seen = np.stack([positions[frame - OBSERVED : frame] for frame in frames]).astype(np.float64)
        predicted = self.predictor.predict(seen, PREDICTED)
        local = to_last_pose(np.concatenate([seen, predicted], axis=1), OBSERVED - 1)[0]
        with torch.no_grad():
            chances = self.recogniser(sampled(torch.from_numpy(local).float())).softmax(-1)
        return [Look(frame - missing, row) for frame, row in zip(frames, chances.double().numpy(), strict=True)]

    def decide(self, looks: list[Look]) -> Decision:
        """Combines looks until the agent is sure.

        A look is weighted by its probability of any gesture. The agent is sure, and stops, as soon as one gesture
        reaches the probability :data:`SURE`, after two looks at the earliest. If the weights of all looks sum to
        :data:`LEAST` or less, there is no gesture.
        """
        evidence, done = np.zeros(len(looks[0].chances) - 1), 0.0
        for i, look in enumerate(looks):
            busy = 1 - look.chances[0]
            evidence += WEIGHT * busy * np.log(look.chances[1:] / max(busy, FLOOR) + FLOOR)
            done += busy
            chances = np.exp(evidence - evidence.max())
            chances /= chances.sum()
            sure = bool(i and done > LEAST and chances.max() >= SURE)
            if sure:
                break
        place = 1 + int(chances.argmax()) if done > LEAST else None
        return Decision(Look(look.frame, np.concatenate([[0.0], chances])), place, sure)

    def note(self, decision: Decision) -> str:
        """The result of :meth:`decide` as a sentence."""
        look, place = decision.look, decision.place
        if place is None:
            return "The agent saw no gesture that asks for an answer, so it stands and waits."
        config, rest = self.recogniser.config, look.chances.copy()
        rest[place] = 0
        second = int(rest.argmax())
        seen = f"“{config.labels[place]}” ({look.chances[place]:.0%}; “{config.labels[second]}” {rest[second]:.0%})"
        if not decision.sure:
            return f"The agent was not sure of a gesture, so it stands and waits. The likeliest was {seen}."
        return (
            f"After {look.frame / FPS:.1f} s the agent took it for {seen} and answers from then on: "
            f"“{config.sentences[place]}”"
        )


class AgentPipeline:
    """Lets InterGen respond to what an :class:`Eye` recognises.

    Args:
        folder: of the recogniser's weights.
        predictor: predicts two seconds.
        answers: generates the response.

    Raises WeightsError (an InputError) if files are missing or altered.
    """

    def __init__(self, folder: Path, predictor: PredictorPipeline, answers: InterGenPipeline) -> None:
        self.eye, self.answers = Eye(folder, predictor), answers
        self.name = folder.name
        parts = (self.eye.digest, predictor.digest, answers.digest)
        self.digest = hashlib.sha256(" ".join(parts).encode()).hexdigest()

    def run(self, request: ReactRequest, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`Result`, whose first note says what was recognised.

        Raises:
            Cancelled: within one denoising step.
        """
        yield timer.progress("text")
        decision = self.eye.decide(self.eye.looks(request.actor.positions))
        notes = [self.eye.note(decision)] + [_NO_WORDS] * bool(request.prompt.strip())
        sentences, frame = self.eye.recogniser.config.sentences, decision.look.frame
        answers = decision.sure and frame < request.actor.num_frames
        said = [sentences[0], *([sentences[decision.place or 0]] if answers else ())]
        plans = (request.plan and request.plan.acts) or tuple(map(plan_of_words, said))
        asked = replace(request, model=self.answers.name, prompt=said[0], plan=KeptPlan(plans[:1]))
        if answers:  # all samples continue the same past
            first = replace(asked, samples=1)
            waits = yield from until_result(self.answers.run(first, cancel, timer, self._attending(first)))
            past = np.asarray(waits.duets[0].b.positions)[:frame]  # type: ignore[union-attr]
            asked = replace(asked, prompt=said[1], plan=KeptPlan(plans[1:]))
            scene = self._answering(asked, past)
        else:
            scene = self._attending(asked)
        result = yield from until_result(self.answers.run(asked, cancel, timer, scene))
        plan = {"plan": KeptPlan(plans).to_dict()}
        yield replace(result, notes=(*notes, *result.notes), manifest=plan)

    def _attending(self, request: ReactRequest) -> Reaction:
        """A person who stands in front of the other and faces the place where they began.

        Known are one frame of the other person, and the place of the agent's pelvis and the direction of its hips.
        """
        clip = request.actor
        placement, frames = Placement.of(clip.cut(0, 1), "a"), range(clip.num_frames)
        places = np.tile([0.0, MEDIAN_START_DISTANCE], (len(frames), 1))
        stand = KnownPath(1, frames, places, np.full(len(frames), np.pi), turned=True)
        seen = KnownFrames(0, [0], placement.to_network(clip.positions[:1]))
        given = hold_of(self.answers.model, clip.num_frames, [seen, stand])
        return Reaction(clip.num_frames, given, clip=clip, place=0, placement=placement)

    def _answering(self, request: ReactRequest, past: Array) -> Reaction:
        """A response to what the person did while the agent waited."""
        clip, model, seen = request.actor, self.answers.model, len(past)
        placement = Placement.of(clip.cut(0, seen), "a", request.prompt)
        both = (clip.positions[:seen], past)
        parts = [KnownFrames(i, range(seen), placement.to_network(person)) for i, person in enumerate(both)]
        given = hold_of(model, clip.num_frames, parts)
        return Reaction(clip.num_frames, given, parts=parts, clip=clip, place=0, placement=placement)
