"""The page's endpoints for programs."""

from __future__ import annotations

import uuid
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import gradio as gr

from motion import Clip, Duet, InputError
from motion.formats import ImportChoices, read
from webdemo.inference.methods import AUTOMATIC, methods
from webdemo.inference.requests import OWN_STEPS, GenerateRequest, ReactRequest, SamplingRequest
from webdemo.inference.requests.actor import read_actor
from webdemo.inference.requests.predict import LONGEST, PredictRequest, PredictResult
from webdemo.inference.run import Cancelled, Result
from webdemo.ui.components.exports import write_files
from webdemo.ui.text.classes import class_method
from webdemo.ui.text.words import error_line, progress_line

from .context import PageContext
from .places import READING

Answer = tuple[dict[str, Any], list[str]]
Inputs = dict[str, Any]
"""Components for what a job takes, by the names of its arguments."""
RATE = "true frames a second of a file that gives none or a wrong one; 0 for its own or the usual rate of its kind"
UP = "what points up in the file: x, y, z, -x, -y or -z; empty to find it"
ORDER = "order of joints without names, such as h36m17; empty to find it"
WHICH = "of a .glb with several animations, the name or the number (from 1) of one; empty for the first"
PROGRESS = gr.Progress()
"""A default value that makes Gradio report a job's progress in ``job.status()``."""


def reading_choices(animation: str = "", fps: float = 0.0, up: str = "", order: str = "") -> ImportChoices:
    """Facts that a program gives of its file; empty texts and 0 leave a thing to be found."""
    return ImportChoices(up or None, fps or None, order or None, animation or None)


class Endpoint:
    """A job for programs; a subclass publishes its inputs.

    The components of an endpoint are never shown. They are there because they, unlike ``gr.api``, hand files
    over to a client on another machine; their limits are the request's, so that every error is its sentence.

    Args:
        page: what tabs and endpoints share.
    """

    def __init__(self, page: PageContext) -> None:
        self.page = page

    @staticmethod
    def _sampling(guidance: float = SamplingRequest.guidance) -> Inputs:
        """Inputs for the fields of a :class:`SamplingRequest`."""
        return {
            "seed": gr.Number(SamplingRequest.seed, label="0 to 4294967295; the same seed gives the same motion"),
            "samples": gr.Number(SamplingRequest.samples, label="how many motions to generate, 1 to 8"),
            "guidance": gr.Number(guidance, label="scale of classifier-free guidance, 0 to 10; 1 is none"),
            "steps": gr.Number(None, label="denoising steps, 1 to 1000; the model's own if not given (mostly 8)"),
            "damping": gr.Number(SamplingRequest.damping, label="damping threshold as a share of T, 0 to 1; 0 is none"),
            "sampler": gr.Textbox(SamplingRequest.sampler, label="ddim or dpm++"),
        }

    @staticmethod
    def _publish(job: Callable[..., Answer], name: str, inputs: Inputs) -> None:
        """Publishes a job, which gets the inputs by their names; one without a value is named in its signature."""
        outputs = [
            gr.JSON(label="result: manifest, readouts, timings, notes, names of files"),
            gr.File(label="the files", file_count="multiple"),
        ]
        gr.Button().click(
            job,
            inputs_kwargs=inputs,
            outputs=outputs,
            api_name=name,
            concurrency_limit=None,  # runs wait in the line that they share with the page's
        )

    def _answer(
        self,
        make: Callable[[], SamplingRequest | PredictRequest],
        title: str,
        progress: gr.Progress,
        reads: bool = False,
    ) -> Answer:
        """Runs a request and writes its files, called after ``title``; every error is one sentence.

        ``reads`` says that a motion file is read for it, which takes one of the places for that.
        """
        try:
            with READING.place() if reads else nullcontext():
                request = make()
            result = self._run(request, progress)
            files = write_files(result, self.page.shelf.folder(), prompt=title)
        except Cancelled:
            raise gr.Error("The run was cancelled: send the request again.", print_exception=False) from None
        except Exception as error:
            raise gr.Error(error_line(error), print_exception=False) from None
        answer: dict[str, Any] = {
            "manifest": result.manifest,
            "readouts": list(result.readouts),
            "timings": result.timings,
            "notes": [*reading_notes(request), *result.notes],
            "files": {key: [path.name for path in paths] for key, paths in files.items()},
        }
        if isinstance(result, PredictResult):
            answer["prediction"] = {key: list(getattr(result, key)) for key in ("error", "speed", "true_speed")} | {
                "past_frames": result.past_frames
            }
        return answer, [str(path) for paths in files.values() for path in paths]

    def _run(self, request: SamplingRequest | PredictRequest, progress: gr.Progress) -> Result:
        for event in self.page.runs.run(f"api-{uuid.uuid4().hex}", request):
            if isinstance(event, Result):
                return event
            share = (event.step, event.total) if event.stage == "sample" else (0, 1)
            progress(share, desc=progress_line(event), unit=event.unit)
        raise Cancelled("The run ended without a result.")


def reading_notes(request: Any) -> list[str]:
    """Sentences on how well the motion that a request was given could be read."""
    given = getattr(request, "actor", None) or getattr(request, "motion", None)
    people = given.people if isinstance(given, Duet) else (given,) if isinstance(given, Clip) else ()
    return list(dict.fromkeys(note for person in people for note in person.notes))


class GenerateEndpoint(Endpoint):
    """``/generate``: text → motion files."""

    def publish(self) -> None:
        """Adds the endpoint to the page that is being built."""
        models = " or ".join(m.name for m in methods("generate") if "words" in m.takes)
        tries = "tries, 1 to 4: seeds to try until the motion shows all that is said; the best is kept"
        with gr.Row(visible=False):
            inputs: Inputs = {
                "prompt": gr.Textbox(label="what the two people do, in English, up to 500 characters"),
                "seconds": gr.Number(GenerateRequest.seconds, label="length of the motion in seconds, 1 to 10"),
                **self._sampling(),
                "model": gr.Textbox(GenerateRequest.model, label=models),
                "tries": gr.Number(GenerateRequest.tries, label=tries),
            }
            self._publish(self.generate, "generate", inputs)

    def generate(self, prompt: str, steps: int = OWN_STEPS, progress: gr.Progress = PROGRESS, **asked: Any) -> Answer:
        """Two people from one sentence.

        Returns the manifest, read-outs, timings, notes and file names; and the files: for every sample a
        two-person .npz, two .bvh, two .smpl.npz, a .usda (and a .glb where the server writes them), a contact sheet
        .png, and a manifest .json. An error is one sentence that says what to change.
        """
        return self._answer(lambda: GenerateRequest(prompt=prompt, steps=steps, **asked), prompt, progress)


class ClassEndpoint(GenerateEndpoint):
    """``/generate_class``: a class → motion files."""

    def publish(self) -> None:
        """Adds the endpoint to the page that is being built."""
        with gr.Row(visible=False):
            inputs: Inputs = {
                "name": gr.Textbox(label="name of a class, such as: shake hands"),
                "seconds": gr.Number(GenerateRequest.seconds, label="length of the motion in seconds, 1 to 10"),
                **self._sampling(class_method().default("guidance", GenerateRequest.guidance)),
            }
            self._publish(self.generate_class, "generate_class", inputs)

    def generate_class(
        self, name: str, steps: int = OWN_STEPS, progress: gr.Progress = PROGRESS, **asked: Any
    ) -> Answer:
        """Two people from the name of a class, by BiGraphDiff; an unknown one is answered with all names.

        Returns what /generate does.
        """
        return self.generate(name, steps, progress, model=class_method().name, **asked)


class ReactEndpoint(Endpoint):
    """``/react``: one person → motion files of two."""

    def publish(self) -> None:
        """Adds the endpoint to the page that is being built."""
        found = methods("react")
        streaming = " or ".join(m.name for m in found if "online" in m.modes)
        posed = " or ".join(m.name for m in found if "first pose" in m.takes)
        models = " or ".join([AUTOMATIC, *(m.name for m in found)])
        with gr.Row(visible=False):
            inputs: Inputs = {
                "actor": gr.File(label="the given person: .bvh, .glb, .npz, .c3d …, up to 50 MB"),
                "prompt": gr.Textbox("", label="what the two people do, in English; may be empty"),
                "person": gr.Textbox("", label="a to f, if the file holds several people"),
                "start": gr.Number(0, label="start of the part to use, in seconds"),
                "end": gr.Number(0, label="its end, in seconds; 0 is the end of the file"),
                "role": gr.Textbox(ReactRequest.role, label="a: the given person acts first; b: they react"),
                **self._sampling(),
                "model": gr.Textbox(ReactRequest.model, label=models),
                "mode": gr.Textbox(ReactRequest.mode, label=f"offline; or online ({streaming})"),
                "keep_start": gr.Checkbox(
                    False, label=f"start in the first pose of the other person in the file ({posed})"
                ),
                "animation": gr.Textbox("", label=WHICH),
                "fps": gr.Number(0, label=RATE),
                "up": gr.Textbox("", label=UP),
                "order": gr.Textbox("", label=ORDER),
            }
            self._publish(self.react, "react", inputs)

    def react(
        self,
        actor: str,
        prompt: str,
        person: str,
        start: float,
        end: float,
        keep_start: bool,
        animation: str,
        fps: float,
        up: str,
        order: str,
        steps: int = OWN_STEPS,
        progress: gr.Progress = PROGRESS,
        **asked: Any,
    ) -> Answer:
        """A second person for a given one, who stays exactly as they are (at 30 frames a second).

        Returns the manifest, read-outs, timings, notes and file names; and the files: for every sample a
        two-person .npz, two .bvh, two .smpl.npz, a .usda (and a .glb where the server writes them), a contact sheet
        .png, and a manifest .json. An error is one sentence that says what to change.
        """

        def request() -> ReactRequest:
            if not actor:
                raise InputError("There is no actor: send a motion file, such as a .bvh.")
            choices = reading_choices(animation, fps, up, order)
            clip, pose = read_actor(
                actor, person=person or None, start=start, end=end or None, keep_start=keep_start, choices=choices
            )
            return ReactRequest(actor=clip, first_pose=pose, prompt=prompt, steps=steps, **asked)

        title = prompt.strip() or f"Reaction to {Path(actor or '').stem}"
        return self._answer(request, title, progress, reads=True)


class PredictEndpoint(Endpoint):
    """``/predict``: a past → motion files that go on."""

    def publish(self) -> None:
        """Adds the endpoint to the page that is being built."""
        with gr.Row(visible=False):
            inputs: Inputs = {
                "past": gr.File(label="the motion of one person or two: .bvh, .glb, .npz, .c3d …, up to 50 MB"),
                "marker": gr.Number(0, label="the second at which the past ends; 0 is the end of the file"),
                "seconds": gr.Number(PredictRequest.seconds, label="how much to predict in seconds, 0.5 to 4"),
                "model": gr.Textbox(PredictRequest.model, label=" or ".join(m.name for m in methods("predict"))),
                "animation": gr.Textbox("", label=WHICH),
                "fps": gr.Number(0, label=RATE),
                "seed": gr.Number(0, precision=0, label="seed of a method that draws its futures"),
                "up": gr.Textbox("", label=UP),
                "order": gr.Textbox("", label=ORDER),
            }
            self._publish(self.predict, "predict", inputs)

    def predict(
        self,
        past: str,
        marker: float,
        seconds: float,
        model: str,
        animation: str = "",
        fps: float = 0.0,
        seed: int = 0,
        up: str = "",
        order: str = "",
        progress: gr.Progress = PROGRESS,
    ) -> Answer:
        """Predicts what comes after the past of a motion, for one person or two.

        Returns the manifest, timings, notes and file names, and under "prediction" the error (mm) and speed
        (mm a frame) of every predicted frame; and the files, which hold the past and what is predicted. An
        error is one sentence that says what to change.
        """

        def request() -> PredictRequest:
            if not past:
                raise InputError("There is no past: send a motion file, such as a .bvh.")
            return PredictRequest(
                motion=read(Path(past), choices=reading_choices(animation, fps, up, order), longest=LONGEST),
                marker=marker or None,
                seconds=seconds,
                seed=seed,
                model=model,
            )

        return self._answer(request, f"After {Path(past or '').stem}", progress, reads=True)
