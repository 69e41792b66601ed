"""``/scene``: a story → motion files, for programs."""

from __future__ import annotations

from pathlib import Path

import gradio as gr

from motion import Duet, InputError
from motion.formats import ImportChoices, read
from motion.retarget import to_smpl
from webdemo.inference.story import SceneRequest, in_time, read_words
from webdemo.inference.story.request import MOST_SECONDS

from .api import ORDER, PROGRESS, RATE, UP, WHICH, Answer, Endpoint, Inputs, reading_choices


class SceneEndpoint(Endpoint):
    """``/scene``: a story, alone or as a part of a motion."""

    def publish(self) -> None:
        """Adds the endpoint to the page that is being built."""
        with gr.Row(visible=False):
            inputs: Inputs = {
                "story": gr.Textbox(label="the story: TOML (docs/scenes.md), or sentences, which are split into beats"),
                "motion": gr.File(
                    label="a motion of two people that the story goes on from, up to 50 MB; may be empty"
                ),
                "start": gr.Number(
                    0, label="with a motion: the second at which the story begins; 0 is the motion's end"
                ),
                "end": gr.Number(0, label="with a motion: the second at which it goes on unchanged; 0: it does not"),
                "samples": gr.Number(None, label="how many scenes or futures, 1 to 8; the story's own by default"),
                "seed": gr.Number(None, label="seed; the story's own by default"),
                "animation": gr.Textbox("", label=WHICH),
                "fps": gr.Number(0, label=RATE),
                "up": gr.Textbox("", label=UP),
                "order": gr.Textbox("", label=ORDER),
            }
            self._publish(self.scene, "scene", inputs)

    def scene(
        self,
        story: str,
        motion: str | None = None,
        start: float = 0,
        end: float = 0,
        samples: float | None = None,
        seed: float | None = None,
        animation: str = "",
        fps: float = 0.0,
        up: str = "",
        order: str = "",
        progress: gr.Progress = PROGRESS,
    ) -> Answer:
        """A scene of several beats, or a span or a continuation of a given motion.

        Returns the manifest, read-outs, timings, notes and file names; and the files: for every sample a
        two-person .npz, two .bvh, a .usda (and a .glb where the server writes them), a contact sheet .png, and a
        manifest .json. An error is one sentence that says what to change.
        """

        def request() -> SceneRequest:
            fields = read_words(story, in_time())
            fields |= {key: value for key, value in (("samples", samples), ("seed", seed)) if value is not None}
            given = _two_people(motion, reading_choices(animation, fps, up, order)) if motion else None
            return SceneRequest(**fields, motion=given, start=start or None, end=end or None)

        return self._answer(request, story.split("\n", 1)[0][:80] or "A scene", progress, reads=bool(motion))


def _two_people(path: str, choices: ImportChoices) -> Duet:
    found = read(Path(path), longest=MOST_SECONDS, choices=choices)
    if not isinstance(found, Duet):
        raise InputError(f"{Path(path).name} holds one person: a scene goes on from a motion of two.")
    return to_smpl(found)
