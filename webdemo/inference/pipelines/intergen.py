"""The shipped InterGen: generates two people from a sentence, or one for a given other (section 5.4)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import torch
from torch import Tensor

from models.compiled import compile_network
from models.intergen.compact import CaptionBank, CompactInterGen, load_captions, load_folder
from models.text import MiniLM
from webdemo.inference.cancel import CancelToken
from webdemo.inference.requests import GenerateRequest, Progress, ReactRequest, Result
from webdemo.inference.scenes import Scene
from webdemo.inference.story.request import SceneRequest, as_scene
from webdemo.inference.story.roles import of_each
from webdemo.inference.timer import StageTimer

from .scene import SceneMaker, WindowRequest
from .two_person import Conditioning, Passes, TwoPersonPipeline


class InterGenPipeline(TwoPersonPipeline[CompactInterGen]):
    """The compact InterGen with its text encoder, loaded from a weights folder.

    Raises WeightsError or TextEncoderError (both InputError) where files are missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        model, source = load_folder(folder)
        fast = model.fast_denoiser  # before the network's own weights are let go
        super().__init__(source, model)
        if fast is not None:
            compile_network(fast, f"{source.digest} fast")
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
        split = as_scene(request) if isinstance(request, GenerateRequest) and scene is None else None
        if split is not None:
            notes = [
                f"This was made as {len(split.beats)} beats, one after another; the tab Scene lets you change them."
            ]
            return self.scenes.run(split, cancel, timer, passes, notes=notes if len(split.beats) > 1 else ())
        return super().run(request, cancel, timer, passes, scene)

    def condition(self, prompt: str, alone: tuple[str, str] = ("", "")) -> tuple[Tensor, Tensor]:
        """The condition (1, …) of a prompt and its unit sentence vector (384,).

        Args:
            alone: what a and b do, in a sentence each. By default it is taken from the prompt, where that says it by
                their names. Only a network with ``words`` reads it.
        """
        tokens = self.encoder([prompt])
        parts = [tokens]
        if self.model.config.words and any(own := alone if any(alone) else of_each(prompt)):
            parts += [self.encoder([sentence]) if sentence else tokens.missing() for sentence in own]
        with torch.no_grad():
            return self.model.condition(*parts), tokens.pooled()[0]

    def notes(self, vector: Tensor) -> tuple[str, ...]:
        """Warns the user of a prompt that is far from all that was trained on."""
        near = self.bank.nearest(vector)
        if near[0][0] >= self.bank.far:
            return ()
        return (
            "This sentence is far from anything the model was trained on, so the motion may not match it. "
            f"The nearest thing it knows: “{near[0][1]}”.",
        )

    def conditioning(self, request: GenerateRequest | ReactRequest) -> Conditioning:
        """The text vector and the touches that the text asks for; nothing without text."""
        if not request.prompt.strip():  # without an intent both halves of the guidance are the same
            return Conditioning(self.model.no_condition(), 1.0)
        alone = request.alone if isinstance(request, WindowRequest) else ("", "")
        condition, vector = self.condition(request.prompt, alone)
        (touch,) = self.model.touches(condition)
        return Conditioning(condition, request.guidance, touch, self.notes(vector))
