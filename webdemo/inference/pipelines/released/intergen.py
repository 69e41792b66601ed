"""The authors' InterGen: two people from a sentence, or one person's partner."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import torch
from torch import Tensor

from models.intergen.released import ReleasedInterGen, load_released
from models.text.clip import find_vocabulary
from motion import FPS
from motion.placement import Placement
from motion.representation import NUM_FEATURES
from webdemo.inference.own.entries import Entry
from webdemo.inference.pipelines.given import Reaction, Scene
from webdemo.inference.pipelines.two_person import Conditioning, Passes, TwoPersonPipeline
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.requests.actor import ROLES
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer

from .common import Measured, compiled_near, digest, precision_of

CONVERTED = (
    "InterGen's 262 numbers a person and frame became 22 joints: its positions were taken, its own rotations and "
    "foot contacts were dropped."
)
NOT_TUNED = (
    "The paper trains the network further for one given person (section 5.4); a released file that was not may "
    "answer poorly."
)


class ReleasedInterGenPipeline(TwoPersonPipeline[ReleasedInterGen]):
    """The released InterGen of an entry of the settings.

    Raises WeightsError or VocabularyError (both InputError) where a file is missing, damaged or another's.
    """

    spacing = "leading"

    def __init__(self, entry: Entry) -> None:
        vocabulary = entry.file("vocabulary") if "vocabulary" in entry.files else find_vocabulary()
        checkpoint, mean, std = (entry.file(role) for role in ("checkpoint", "mean", "std"))
        self.model = load_released(checkpoint, mean, std, vocabulary)
        self.name, self.digest, self.meta = entry.name, digest((checkpoint, mean, std)), {}
        self.compiled = compiled_near(self.model.denoiser, self.digest, precision_of(entry))

    def condition(self, prompt: str) -> tuple[Tensor, None]:
        """The condition (1, 768) of a prompt."""
        return self.model.condition([prompt]), None

    def conditioning(self, request: GenerateRequest | ReactRequest) -> Conditioning:
        """The text vector; nothing without text."""
        if not request.prompt.strip():
            return Conditioning(self.model.no_condition(), 1.0)
        return Conditioning(self.condition(request.prompt)[0], request.guidance)

    def run(
        self,
        request: GenerateRequest | ReactRequest,
        cancel: CancelToken,
        timer: StageTimer,
        passes: Passes | None = None,
        scene: Scene | None = None,
    ) -> Iterator[Progress | Result]:
        """As :meth:`TwoPersonPipeline.run`; the result's notes say what the conversion lost."""
        measured = Measured(scene or self.scene(request))
        for event in super().run(request, cancel, timer, passes, measured):  # type: ignore[arg-type]
            if isinstance(event, Result):
                notes = [CONVERTED, measured.note(request.cleanup)]
                notes += [NOT_TUNED] if isinstance(request, ReactRequest) else []
                event = replace(event, notes=(*event.notes, *notes))
            yield event

    def scene(self, request: GenerateRequest | ReactRequest) -> Scene:
        """As :meth:`TwoPersonPipeline.scene`, in the paper's representation."""
        if isinstance(request, GenerateRequest):
            return Scene(round(request.seconds * FPS))
        placement = Placement.of(request.actor, request.role, request.prompt)
        place = ROLES.index(request.role)
        numbers = self.model.encode(placement.to_network(request.actor.positions))
        given = GivenPerson(numbers, place)
        return Reaction(
            request.actor.num_frames,
            given,  # type: ignore[arg-type]
            clip=request.actor,
            place=place,
            placement=placement,
        )


class GivenPerson:
    """Writes a given person's numbers into samples, in place of :class:`models.known.Hold`.

    Args:
        numbers: (T − 1, 262) normalised.
        place: 0 if they are person a, 1 if b.
    """

    features = None

    def __init__(self, numbers: Tensor, place: int) -> None:
        self.numbers = numbers
        self.part = slice(place * NUM_FEATURES, (place + 1) * NUM_FEATURES)

    @property
    def frozen(self) -> Tensor:
        """(1, T − 1, 524) true where a number is given."""
        fixed = torch.zeros(1, len(self.numbers), 2 * NUM_FEATURES, dtype=torch.bool)
        fixed[..., self.part] = True
        return fixed

    def __call__(self, x: Tensor) -> Tensor:
        """A sample or prediction (B, T − 1, 524) with the given person in their place."""
        held = x.clone()
        held[..., self.part] = self.numbers
        return held

    bend = __call__  # the whole person is given, so there is nothing to lead up to
