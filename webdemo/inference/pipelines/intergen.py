"""InterGen, shipped and as released: generates two people from a sentence, or one for a given other (section 5.4)."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import scipy.ndimage
import torch
from torch import Tensor, nn

from acts import Plan, lexicon
from acts.captions import of_each
from acts.staging.stage import score_of
from models.compiled import Precision, compile_network, has_bfloat16
from models.intergen.compact import CaptionBank, CompactInterGen, load_captions
from models.intergen.released import ReleasedInterGen, load_released
from models.text import MiniLM
from models.text.clip import find_vocabulary
from models.weights_io import load_network
from motion import FPS, Duet, stacked_positions
from motion.metrics import compare
from motion.vectors import Array
from webdemo.inference.finish.cleanup import clean_person, finish_of, in_touch
from webdemo.inference.own.entries import Entry
from webdemo.inference.requests import GenerateRequest, ReactRequest, SamplingRequest
from webdemo.inference.requests.plans import BeatFinish, KeptPlan
from webdemo.inference.requests.predict import PredictRequest, predicted
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer
from webdemo.inference.story import Beat
from webdemo.inference.story.beats import SHORTEST
from webdemo.inference.story.request import SceneProgress, SceneRequest
from webdemo.inference.story.sentences import as_scene

from .given import GivenPerson, Scene
from .predictor import PredictorPipeline
from .scene import SceneMaker
from .two_person import Conditioning, TwoPersonPipeline

SMOOTHING = 1.0
"""Frames: σ of the Gaussian by which InterGen's release smooths its positions."""
_FAR = (
    "This sentence is far from anything the model was trained on, so the motion may not match it. "
    "The nearest thing it knows is “{}”."
)
CONVERTED = (
    "InterGen's 262 numbers a person and frame became 22 joints: its positions were taken, its own rotations and "
    "foot contacts were dropped."
)
NOT_TUNED = (
    "The paper trains the network further for one given person (section 5.4); a released file that was not may "
    "answer poorly."
)


class InterGenPipeline(TwoPersonPipeline[CompactInterGen]):
    """The compact InterGen with its text encoder, loaded from a weights folder.

    Raises WeightsError or TextEncoderError (both InputError) where files are missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        model, source = load_network(folder, CompactInterGen)
        super().__init__(source, model)
        self.bank: CaptionBank = load_captions(source)
        self.encoder = MiniLM()
        self.scenes = SceneMaker(self, self.words)

    def run(
        self,
        request: GenerateRequest | ReactRequest | SceneRequest,
        cancel: CancelToken,
        timer: StageTimer,
        scene: Scene | None = None,
    ) -> Iterator[Progress | Result]:
        """As :meth:`TwoPersonPipeline.run`; a scene, or a sentence of several beats, is made window by window."""
        if isinstance(request, SceneRequest):
            return self.scenes.run(request, cancel, timer)
        if isinstance(request, GenerateRequest) and scene is None:
            return self._generate(request.with_plan(), cancel, timer)
        return super().run(request.with_plan(), cancel, timer, scene)

    def _generate(
        self, request: GenerateRequest, cancel: CancelToken, timer: StageTimer
    ) -> Iterator[Progress | Result]:
        """A sentence, made as a scene where it has several beats or a plan."""
        assert request.plan is not None
        split, plan = as_scene(request), request.plan
        if split is None:
            plan = plan if plan.of_result else _unsplit(plan, request.planned)
            events = super().run(replace(request, plan=plan), cancel, timer)
        else:
            plan = replace(plan, beats=tuple(beat.to_dict() for beat in split.beats))
            notes = [
                f"This was made as {len(split.beats)} beats, one after another; the tab Scene lets you change them."
            ]
            events = self.scenes.run(split, cancel, timer, notes=notes if len(split.beats) > 1 else ())
        for event in events:
            if isinstance(event, Result):
                if split is None:
                    event = replace(event, readouts=tuple({**r, "planned": 0.0} for r in event.readouts))
                    if request.cleanup:
                        finish = plan.finishes[0] if plan.finishes else BeatFinish()
                        event = _in_touch(event, finish)
                own, said = plan.to_dict(), plan.acts[0].notes
                whole = {name: own[name] for name in ("acts", "beats")}
                kept = own | event.manifest.get("plan", {}) | whole
                event = replace(event, notes=tuple(dict.fromkeys((*said, *event.notes))), manifest={"plan": kept})
            yield event

    def condition(self, prompt: str, alone: tuple[str, str] = ("", "")) -> tuple[Tensor, Tensor]:
        """The condition (1, …) of a prompt and its unit sentence vector (384,).

        Args:
            prompt: what both do.
            alone: what a and b do, in a sentence each, or "".
        """
        tokens = self.encoder([prompt])
        parts = [tokens]
        if any(alone):
            parts += [self.encoder([sentence]) if sentence else tokens.missing() for sentence in alone]
        with torch.no_grad():
            return self.model.condition(*parts), tokens.pooled()[0]

    def conditioning(self, request: GenerateRequest | ReactRequest) -> Conditioning:
        """The text vector and the touches that the text asks for; nothing without text."""
        if not request.prompt.strip():
            return self.words("", Plan(), ("", ""), request.guidance)
        kept = request.with_plan().plan
        assert kept is not None
        plan = kept.acts[0]
        alone = kept.alone if isinstance(request, GenerateRequest) else of_each(plan.acts, lexicon())
        return self.words(request.prompt, plan, alone, request.guidance)

    def words(self, prompt: str, plan: Plan, alone: tuple[str, str], guidance: float) -> Conditioning:
        """What a sentence gives the network.

        Args:
            prompt: what both do; without it nothing is given.
            plan: of the sentence; one without acts is warned of where it is far from all that was trained on.
            alone: as of :meth:`condition`.
            guidance: scale of the guidance.
        """
        if not prompt.strip():  # without an intent both halves of the guidance are the same
            return Conditioning(self.model.no_condition(), 1.0)
        condition, vector = self.condition(prompt, alone)
        (touch,) = self.model.touches(condition)
        cosine, nearest = self.bank.nearest(vector)
        far = cosine < self.bank.far and not plan.acts
        return Conditioning(condition, guidance, touch, (_FAR.format(nearest.rstrip(".")),) if far else ())


def _unsplit(plan: KeptPlan, planned: bool) -> KeptPlan:
    """The plan of a sentence that is given to the network as it is."""
    finishes = (finish_of(score_of(plan.acts[0].acts)),) if planned else ()
    return replace(plan, alone=of_each(plan.acts[0].acts, lexicon()), finishes=finishes)


def _in_touch(result: Result, finish: BeatFinish) -> Result:
    """Duets whose hands meet, and whose bodies are not in each other, and what is measured of them."""
    duets, readouts = list(result.duets), list(result.readouts)
    for i, duet in enumerate(result.duets):
        if isinstance(duet, Duet):
            every = np.ones(duet.num_frames)
            met = in_touch(duet.positions, every, every * finish.reaching, every * finish.held)
            duets[i] = moved = duet.with_positions(met)
            readouts[i] = {**readouts[i], **compare(None, moved), "before": readouts[i]["before"]}
    return replace(result, duets=tuple(duets), readouts=tuple(readouts))


class ReleasedInterGenPipeline(TwoPersonPipeline[ReleasedInterGen]):
    """The released InterGen of an entry of the settings.

    Raises WeightsError or VocabularyError (both InputError) where a file is missing, damaged or another's.
    """

    spacing = "leading"

    def __init__(self, entry: Entry) -> None:
        vocabulary = entry.file("vocabulary") if "vocabulary" in entry.files else find_vocabulary()
        checkpoint, mean, std = (entry.file(role) for role in ("checkpoint", "mean", "std"))
        self.model = load_released(checkpoint, mean, std, vocabulary)
        self.name, self.digest = entry.name, entry.digest("checkpoint", "mean", "std")
        self.compiled = compiled_near(self.model.denoiser, self.digest, precision_of(entry))

    def conditioning(self, request: GenerateRequest | ReactRequest) -> Conditioning:
        """The text vector; nothing without text."""
        if not request.prompt.strip():
            return Conditioning(self.model.no_condition(), 1.0)
        return Conditioning(self.model.condition([request.prompt]), request.guidance)

    def given(self, positions: Array, place: int) -> GivenPerson:
        """As :meth:`TwoPersonPipeline.given`, in the paper's representation."""
        return GivenPerson(self.model.encode(positions), place)

    def cleaned(self, person: Array) -> Array:
        """A person after the release's smoothing, too."""
        return clean_person(scipy.ndimage.gaussian_filter1d(person, SMOOTHING, axis=0, mode="nearest"))

    def lost(self, settings: SamplingRequest, before: Sequence[Duet], after: Sequence[Duet]) -> tuple[str, ...]:
        """What the conversion lost, and by how much the joints moved on their way onto constant bones."""
        said = "The positions are as the network gave them."
        if settings.cleanup:
            pairs = [(old.positions, new.positions) for old, new in zip(before, after, strict=True)]
            moved = np.concatenate([np.linalg.norm(new - old, axis=-1).mean((1, 2)) for old, new in pairs])
            said = (
                f"Smoothing (σ = {SMOOTHING:g} frame), constant bones and planted feet moved the joints by "
                f"{100 * moved[moved > 0].mean():.1f} cm on average."
            )
        return (CONVERTED, said, *([NOT_TUNED] if isinstance(settings, ReactRequest) else []))


def precision_of(entry: Entry) -> Precision:
    """The numbers of the matrix products: bfloat16 where it is asked for, or the processor has it."""
    if entry.precision == "auto":
        return "bf16" if has_bfloat16() else "f32"
    named: dict[str, Precision] = {"float32": "f32", "bfloat16": "bf16"}
    return named[entry.precision]


def compiled_near(network: nn.Module, key: str, precision: Precision) -> bool:
    """Lets OpenVINO run a network with coarser numbers if its outputs stay near, in float32 otherwise.

    Returns:
        whether it is compiled, as :func:`models.compiled.compile_network`.
    """
    if precision != "f32" and compile_network(network, f"{key} {precision}", precision=precision):
        return True
    return compile_network(network, f"{key} f32")


# ---- both people at once -------------------------------------------------------------------------
# Futures of two people who know of each other, drawn beside their past (InterGen, section 5.4). The first moments are
# the predictor's, which is surer of them (docs/scenes.md, *Futures*): InterGen goes on from there.


_SEEN = 10.0
"""Seconds of the past that are given to the scene; a window sees less of it."""
_LEAD, _LEAD_SHARE = 15, 0.25
"""Frames that the predictor makes, at most, and its share of short futures."""


class TogetherPipeline:
    """Continues two people as a scene without words.

    Args:
        folder: of InterGen's weights.
        intergen: the pipeline that makes scenes.
        predictor: continues each person alone.
    """

    def __init__(self, folder: Path, intergen: InterGenPipeline, predictor: PredictorPipeline) -> None:
        self.name = "intergen-together"
        self.digest = hashlib.sha256(f"{intergen.digest}{predictor.digest}".encode()).hexdigest()
        self.intergen, self.predictor = intergen, predictor

    def run(self, request: PredictRequest, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`PredictResult` of as many futures as are asked for, without a manifest."""
        past = request.past
        assert isinstance(past, Duet)  # the request sees to it
        frames = round(request.seconds * FPS)
        lead = min(_LEAD, round(_LEAD_SHARE * frames))
        begun = np.concatenate([past.positions, self.predictor.predict(past.positions, lead)], axis=1)
        seen = Duet.from_positions(begun[:, -round(_SEEN * FPS) :], fps=FPS)
        beats = (Beat("", seconds=max((frames - lead) / FPS, SHORTEST)),)
        asked = SceneRequest(beats=beats, motion=seen, samples=request.samples, seed=request.seed)
        made: tuple[Duet, ...] = ()
        for event in self.intergen.scenes.run(asked, cancel, timer):
            if isinstance(event, Result):
                made = tuple(duet for duet in event.duets if isinstance(duet, Duet))
            elif not isinstance(event, SceneProgress):
                yield event
        ahead = slice(seen.num_frames - lead, seen.num_frames - lead + frames)
        futures = [stacked_positions(duet)[:, ahead].astype(np.float64) for duet in made]
        yield predicted(request, futures)
