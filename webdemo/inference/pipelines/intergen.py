"""The shipped InterGen: generates two people from a sentence, or one for a given other (section 5.4)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from acts.staging.stage import staged
from models.intergen.compact import CaptionBank, CompactInterGen, load_captions, load_folder
from models.text import MiniLM
from motion import Clip, Duet
from webdemo.inference.finish.scene import finish_of, in_touch
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.requests.acting import with_plan
from webdemo.inference.requests.plans import BeatFinish, KeptPlan
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer
from webdemo.inference.story import understood
from webdemo.inference.story.prompted import as_scene
from webdemo.inference.story.request import SceneRequest

from .given import Scene
from .scene import SceneMaker
from .two_person import Conditioning, Passes, TwoPersonPipeline


class InterGenPipeline(TwoPersonPipeline[CompactInterGen]):
    """The compact InterGen with its text encoder, loaded from a weights folder.

    Raises WeightsError or TextEncoderError (both InputError) where files are missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        model, source = load_folder(folder)
        super().__init__(source, model)
        self.bank: CaptionBank = load_captions(source)
        self.encoder = MiniLM()
        self.scenes = SceneMaker(self)

    def run(
        self,
        request: GenerateRequest | ReactRequest | SceneRequest,
        cancel: CancelToken,
        timer: StageTimer,
        passes: Passes | None = None,
        scene: Scene | None = None,
    ) -> Iterator[Progress | Result]:
        """As :meth:`TwoPersonPipeline.run`; a scene, or a sentence of several beats, is made window by window."""
        if isinstance(request, SceneRequest):
            return self.scenes.run(request, cancel, timer, passes)
        if isinstance(request, GenerateRequest) and scene is None:
            return self._generate(with_plan(request), cancel, timer, passes)
        return super().run(with_plan(request), cancel, timer, passes, scene)

    def _generate(
        self, request: GenerateRequest, cancel: CancelToken, timer: StageTimer, passes: Passes | None
    ) -> Iterator[Progress | Result]:
        """A sentence, made as a scene where it has several beats or a plan."""
        assert request.plan is not None
        split, plan = as_scene(request, cancel.raise_if_cancelled), request.plan
        if split is None:
            plan = plan if plan.of_result else _unsplit(plan, request.planned)
            events = super().run(replace(request, plan=plan), cancel, timer, passes)
        else:
            plan = replace(plan, beats=tuple(beat.to_dict() for beat in split.beats))
            notes = [
                f"This was made as {len(split.beats)} beats, one after another; the tab Scene lets you change them."
            ]
            events = self.scenes.run(split, cancel, timer, passes, notes=notes if len(split.beats) > 1 else ())
        for event in events:
            if isinstance(event, Result):
                if split is None:
                    event = replace(event, readouts=tuple({**r, "planned": 0.0} for r in event.readouts))
                    if request.cleanup:
                        finish = plan.finishes[0] if plan.finishes else BeatFinish()
                        event = replace(event, duets=tuple(_in_touch(duet, finish) for duet in event.duets))
                own, said = plan.to_dict(), plan.acts[0].notes
                whole = {name: own[name] for name in ("acts", "beats")}
                kept = own | event.manifest.get("plan", {}) | whole
                event = replace(event, notes=tuple(dict.fromkeys((*said, *event.notes))), manifest={"plan": kept})
            yield event

    def condition(self, prompt: str, alone: tuple[str, str] = ("", "")) -> tuple[Tensor, Tensor]:
        """The condition (1, …) of a prompt and its unit sentence vector (384,).

        Args:
            prompt: what both do.
            alone: what a and b do, in a sentence each, or "". Only a network with ``words`` reads it.
        """
        tokens = self.encoder([prompt])
        parts = [tokens]
        if self.model.config.words and any(alone):
            parts += [self.encoder([sentence]) if sentence else tokens.missing() for sentence in alone]
        with torch.no_grad():
            return self.model.condition(*parts), tokens.pooled()[0]

    def notes(self, plan: KeptPlan, vector: Tensor) -> tuple[str, ...]:
        """Warns the user of a prompt in which no act is known, far from all that was trained on."""
        near = self.bank.nearest(vector)
        if near[0][0] >= self.bank.far or plan.acts[0].acts:
            return ()
        return (
            "This sentence is far from anything the model was trained on, so the motion may not match it. "
            f"The nearest thing it knows: “{near[0][1]}”.",
        )

    def conditioning(self, request: GenerateRequest | ReactRequest) -> Conditioning:
        """The text vector and the touches that the text asks for; nothing without text."""
        if not request.prompt.strip():  # without an intent both halves of the guidance are the same
            return Conditioning(self.model.no_condition(), 1.0)
        plan = with_plan(request).plan
        assert plan is not None
        alone = plan.alone if isinstance(request, GenerateRequest) else understood.of_each(plan.acts[0])
        condition, vector = self.condition(request.prompt, alone)
        (touch,) = self.model.touches(condition)
        return Conditioning(condition, request.guidance, touch, self.notes(plan, vector))


def _unsplit(plan: KeptPlan, planned: bool) -> KeptPlan:
    """The plan of a sentence that is given to the network as it is."""
    finishes = (finish_of(staged(plan.acts[0].acts)),) if planned else ()
    return replace(plan, alone=understood.of_each(plan.acts[0]), finishes=finishes)


def _in_touch(duet: Duet | Clip, finish: BeatFinish) -> Duet | Clip:
    """A duet whose hands meet, and whose bodies are not in each other."""
    if not isinstance(duet, Duet):
        return duet
    every = np.ones(duet.num_frames)
    return duet.with_positions(in_touch(duet.positions, every, every * finish.reaching, every * finish.held))
