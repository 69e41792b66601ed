"""The page's endpoints for programs."""

from __future__ import annotations

import inspect
import uuid
from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any, ClassVar

import gradio as gr

import acts
from motion import InputError
from motion.formats import ImportChoices, read
from webdemo.inference.methods import AUTOMATIC, by_class, methods, reactor
from webdemo.inference.requests import GenerateRequest, ReactRequest, SamplingRequest
from webdemo.inference.requests.actor import read_actor
from webdemo.inference.requests.predict import LONGEST, PredictRequest, PredictResult
from webdemo.inference.requests.sampling import OWN_STEPS
from webdemo.inference.run import Cancelled, Result
from webdemo.inference.story import SceneRequest, in_time, read_words
from webdemo.inference.story.request import read_motion
from webdemo.ui.components import film as films
from webdemo.ui.components.exports import file_name, without_place, write_files
from webdemo.ui.components.reading import READERS, READING_EVENTS
from webdemo.ui.text.words import error_line, progress_line
from webdemo.view import film, plotly_figure
from webdemo.view.camera import VIEWS
from webdemo.view.sheet import SUFFIXES as SHEETS
from webdemo.view.sheet import write_sheet
from webdemo.view.stage import LOOKS, Pane, Style

from .context import PageContext
from .places import FILMS, READING

Answer = tuple[dict[str, Any], list[str]]
Inputs = dict[str, Any]
"""Components for what a job takes, by the names of its arguments."""
RATE = "true frames a second of a file that gives none or a wrong one; 0 for its own or the usual rate of its kind"
UP = "what points up in the file: x, y, z, -x, -y or -z; empty to find it"
ORDER = "order of joints without names, such as h36m17; empty to find it"
WHICH = "of a .glb with several animations, the name or the number (from 1) of one; empty for the first"
PROGRESS = gr.Progress()
"""A default value that makes Gradio report a job's progress in ``job.status()``."""


def file_facts(fps: str = "fps") -> Inputs:
    """Inputs for the facts that a program may give of its file; ``fps`` is what its rate is called."""
    return {
        "animation": gr.Textbox("", label=WHICH),
        fps: gr.Number(0, label=RATE),
        "up": gr.Textbox("", label=UP),
        "order": gr.Textbox("", label=ORDER),
    }


def reading_choices(asked: Inputs) -> ImportChoices:
    """Takes the values of :func:`file_facts` out of what was asked; empty texts and 0 leave a thing to be found."""
    return ImportChoices(**{name: asked.pop(name, None) or None for name in ("up", "fps", "order", "animation")})


class Endpoint(ABC):
    """A job for programs: the method called like the endpoint, whose docstring programs read, and its inputs.

    The components of an endpoint are never shown. They are there because they, unlike ``gr.api``, hand files
    over to a client on another machine; their limits are the request's, so that every error is its sentence.

    Args:
        page: what tabs and endpoints share.
    """

    name: ClassVar[str]
    returns: ClassVar[str] = (
        "Returns the manifest, read-outs, timings, notes and file names; and the files: for every sample a two-person "
        ".npz, two .bvh, two .smpl.npz, a .usda (and a .glb where the server writes them), a contact sheet .png, and a "
        "manifest .json. "
    )
    """Follows the job's docstring in what programs read."""
    options: ClassVar[dict[str, Any]] = {"concurrency_limit": None}
    """Of its event: by default runs wait in the line that they share with the page's."""

    def __init__(self, page: PageContext) -> None:
        self.page = page

    @abstractmethod
    def inputs(self) -> Inputs:
        """Makes the inputs, which the job gets by their names; one without a value is named in its signature."""

    def outputs(self) -> list[gr.Component]:
        """Makes the outputs."""
        return [
            gr.JSON(label="result: manifest, readouts, timings, notes, names of files"),
            gr.File(label="the files", file_count="multiple"),
        ]

    def publish(self) -> None:
        """Adds the endpoint to the page that is being built."""
        with gr.Row(visible=False):
            job, inputs = getattr(self, self.name), self.inputs()
            said = f"{inspect.getdoc(job)} {self.returns}An error is one sentence that says what to change."
            named: dict[str, Any] = {"api_name": self.name, "api_description": said}
            gr.Button().click(job, inputs_kwargs=inputs, outputs=self.outputs(), **named, **self.options)

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
            result = self._made(request, progress)
            files = write_files(result, self.page.shelf.folder(), prompt=title)
        except Cancelled:
            raise gr.Error("The run was cancelled: send the request again.", print_exception=False) from None
        except Exception as error:
            raise gr.Error(error_line(error), print_exception=False) from None
        given = getattr(request, "actor", None) or getattr(request, "motion", None)
        of_reading = dict.fromkeys(note for person in getattr(given, "people", ()) for note in person.notes)
        answer: dict[str, Any] = {
            "manifest": result.manifest,
            "readouts": list(result.readouts),
            "timings": result.timings,
            "notes": [*of_reading, *result.notes],
            "files": {key: [path.name for path in paths] for key, paths in files.items()},
        }
        if isinstance(result, PredictResult):
            answer["prediction"] = {key: list(getattr(result, key)) for key in ("error", "speed", "true_speed")} | {
                "past_frames": result.past_frames
            }
        return answer, [str(path) for paths in files.values() for path in paths]

    def _made(self, request: SamplingRequest | PredictRequest, progress: gr.Progress) -> Result:
        for event in self.page.runs.run(f"api-{uuid.uuid4().hex}", request):
            if isinstance(event, Result):
                return event
            share = (event.step, event.total) if event.stage == "sample" else (0, 1)
            progress(share, desc=progress_line(event), unit=event.unit)
        raise Cancelled("The run ended without a result.")


class GenerateEndpoint(Endpoint):
    """``/generate``: text → motion files."""

    name = "generate"

    def inputs(self) -> Inputs:
        """See :meth:`Endpoint.inputs`."""
        models = " or ".join(m.name for m in methods("generate") if "words" in m.takes)
        tries = "tries, 1 to 4: seeds to try until the motion shows all that is said; the best is kept"
        return {
            "prompt": gr.Textbox(label="what the two people do, in English, up to 500 characters"),
            "seconds": gr.Number(GenerateRequest.seconds, label="length of the motion in seconds, 1 to 10"),
            **self._sampling(),
            "model": gr.Textbox(GenerateRequest.model, label=models),
            "tries": gr.Number(GenerateRequest.tries, label=tries),
        }

    def generate(self, prompt: str, steps: int = OWN_STEPS, progress: gr.Progress = PROGRESS, **asked: Any) -> Answer:
        """Two people from one sentence."""
        return self._answer(lambda: GenerateRequest(prompt=prompt, steps=steps, **asked), prompt, progress)


class ClassEndpoint(GenerateEndpoint):
    """``/generate_class``: a class → motion files."""

    name = "generate_class"

    def inputs(self) -> Inputs:
        """See :meth:`Endpoint.inputs`."""
        return {
            "name": gr.Textbox(label="name of a class, such as: shake hands"),
            "seconds": gr.Number(GenerateRequest.seconds, label="length of the motion in seconds, 1 to 10"),
            **self._sampling(by_class().defaults.get("guidance", GenerateRequest.guidance)),
        }

    def generate_class(
        self, name: str, steps: int = OWN_STEPS, progress: gr.Progress = PROGRESS, **asked: Any
    ) -> Answer:
        """Two people from the name of a class, by BiGraphDiff; an unknown one is answered with all names."""
        return self.generate(name, steps, progress, model=by_class().name, **asked)


class ReactEndpoint(Endpoint):
    """``/react``: one person → motion files of two."""

    name = "react"

    def inputs(self) -> Inputs:
        """See :meth:`Endpoint.inputs`."""
        candidates = methods("react")
        streaming = " or ".join(m.name for m in candidates if "online" in m.modes)
        posed = " or ".join(m.name for m in candidates if "first pose" in m.takes)
        models = " or ".join([AUTOMATIC, *(m.name for m in candidates)])
        return {
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
            **file_facts(),
        }

    def react(
        self, actor: str, prompt: str, steps: int = OWN_STEPS, progress: gr.Progress = PROGRESS, **asked: Any
    ) -> Answer:
        """A second person for a given one, who stays exactly as they are (at 30 frames a second)."""

        def request() -> ReactRequest:
            if not actor:
                raise InputError("There is no actor: send a motion file, such as a .bvh.")
            part = {name: asked.pop(name) for name in ("person", "start", "end", "keep_start")}
            part = {**part, "person": part["person"] or None, "end": part["end"] or None}
            seconds = reactor(asked["model"], prompt or "", asked["role"], asked["mode"]).seconds
            clip, pose = read_actor(actor, **part, choices=reading_choices(asked), seconds=seconds)
            return ReactRequest(actor=clip, first_pose=pose, prompt=prompt or "", steps=steps, **asked)

        title = (prompt or "").strip() or f"Reaction to {Path(actor or '').stem}"
        return self._answer(request, title, progress, reads=True)


class PredictEndpoint(Endpoint):
    """``/predict``: a past → motion files that go on."""

    name = "predict"

    def inputs(self) -> Inputs:
        """See :meth:`Endpoint.inputs`."""
        return {
            "past": gr.File(label="the motion of one person or two: .bvh, .glb, .npz, .c3d …, up to 50 MB"),
            "marker": gr.Number(0, label="the second at which the past ends; 0 is the end of the file"),
            "seconds": gr.Number(PredictRequest.seconds, label="how much to predict in seconds, 0.5 to 4"),
            "model": gr.Textbox(PredictRequest.model, label=" or ".join(m.name for m in methods("predict"))),
            "seed": gr.Number(0, precision=0, label="seed of a method that draws its futures"),
            "samples": gr.Number(PredictRequest.samples, precision=0, label="how many futures it draws, 1 to 8"),
            **file_facts(),
        }

    def predict(self, past: str, marker: float, progress: gr.Progress = PROGRESS, **asked: Any) -> Answer:
        """Predicts what comes after the past of a motion, for one person or two.

        The files hold both, and "prediction" the error (mm) and speed (mm a frame) of every predicted frame.
        """

        def request() -> PredictRequest:
            if not past:
                raise InputError("There is no past: send a motion file, such as a .bvh.")
            motion = read(Path(past), choices=reading_choices(asked), longest=LONGEST)
            return PredictRequest(motion=motion, marker=marker or None, **asked)

        return self._answer(request, f"After {Path(past or '').stem}", progress, reads=True)


class SceneEndpoint(Endpoint):
    """``/scene``: a story, alone or as a part of a motion → motion files."""

    name = "scene"

    def inputs(self) -> Inputs:
        """See :meth:`Endpoint.inputs`."""
        return {
            "story": gr.Textbox(label="the story: TOML (docs/scenes.md), or sentences, which are split into beats"),
            "motion": gr.File(label="a motion of two people that the story goes on from, up to 50 MB; may be empty"),
            "start": gr.Number(0, label="with a motion: the second at which the story begins; 0 is the motion's end"),
            "end": gr.Number(0, label="with a motion: the second at which it goes on unchanged; 0: it does not"),
            "samples": gr.Number(None, label="how many scenes or futures, 1 to 8; the story's own by default"),
            "seed": gr.Number(None, label="seed; the story's own by default"),
            **file_facts(),
        }

    def scene(
        self,
        story: str,
        motion: str | None = None,
        samples: float | None = None,
        seed: float | None = None,
        progress: gr.Progress = PROGRESS,
        **asked: Any,
    ) -> Answer:
        """A scene of several beats, or a span or a continuation of a given motion."""
        story = story or ""  # programs may send null

        def request() -> SceneRequest:
            fields = read_words(story, in_time())
            given = read_motion(Path(motion), reading_choices(asked)) if motion else None
            fields |= {key: value for key, value in (("samples", samples), ("seed", seed)) if value is not None}
            fields |= {key: asked.get(key) or None for key in ("start", "end")}
            return SceneRequest(**fields, motion=given)

        return self._answer(request, story.split("\n", 1)[0][:80] or "A scene", progress, reads=bool(motion))


class ReadEndpoint(Endpoint):
    """``/read``: what is understood of a sentence; nothing is generated."""

    name = "read"
    returns = ""
    options: ClassVar = {"concurrency_limit": READERS, "concurrency_id": READING_EVENTS}

    def inputs(self) -> Inputs:
        """See :meth:`Endpoint.inputs`."""
        return {"text": gr.Textbox(label="English text, at most 2,000 characters")}

    def outputs(self) -> list[gr.Component]:
        """See :meth:`Endpoint.outputs`."""
        return [gr.JSON(label="plan: people, things, acts, and what was not understood")]

    def read(self, text: str | None) -> dict[str, Any]:
        """The plan of a text: who does what to whom, in which order, and what was not understood (docs/acts.md)."""
        try:
            return acts.read(text or "").model_dump(mode="json")
        except Exception as error:
            raise gr.Error(error_line(error), print_exception=False) from None


class RenderEndpoint(Endpoint):
    """``/render``: a motion file → a film, a contact sheet or a plotly figure."""

    name = "render"
    returns = ""
    options: ClassVar = {"concurrency_limit": FILMS, "concurrency_id": "film"}

    def inputs(self) -> Inputs:
        """See :meth:`Endpoint.inputs`."""
        return {
            "motion": gr.File(label="the motion of one person or two: .bvh, .glb, .npz, .c3d …, up to 50 MB"),
            "kind": gr.Textbox("mp4", label="film: mp4, webm, gif; contact sheet: png, pdf; plotly figure: html"),
            "look": gr.Textbox(Style.look, label=" or ".join(LOOKS)),
            "theme": gr.Textbox(Style.theme, label="light or dark"),
            "view": gr.Textbox("threequarter", label=" or ".join(VIEWS)),
            "fps": gr.Number(film.FPS, label="frames a second of a film, 1 to 60"),
            "width": gr.Number(film.SIZE[0], label="width in pixels: even, 64 to 1920"),
            "height": gr.Number(film.SIZE[1], label="height of a film in pixels: even, 64 to 1080"),
            **file_facts(fps="file_fps"),
        }

    def outputs(self) -> list[gr.Component]:
        """See :meth:`Endpoint.outputs`."""
        return [gr.File(label="the film, sheet or figure")]

    def render(self, motion: str, kind: str, look: str, theme: str, view: str, **asked: Any) -> str:
        """A film, a contact sheet or a plotly figure of a motion file."""
        folder = Path()
        try:
            folder = self.page.shelf.folder()
            if not motion:
                raise InputError("There is no motion: send a motion file, such as a .bvh.")
            kind, look, theme = kind or "mp4", look or Style.look, theme or Style.theme
            usual = {"fps": film.FPS, "width": film.SIZE[0], "height": film.SIZE[1]}
            fps, width, height = (asked[name] if asked[name] is not None else usual[name] for name in usual)
            if width > 1920 or height > 1080:
                raise InputError("Pictures have 1920x1080 pixels at most here: ask for less.")
            with READING.place():
                shown = read(
                    Path(motion), choices=reading_choices(asked | {"fps": asked["file_fps"]}), longest=films.LONGEST
                )
            name, suffix = Path(motion).stem, Path(f"x.{kind.lower().lstrip('.')}").suffix  # no other folder
            out = folder / f"{file_name(name, {})}{suffix}"
            style = Style(look=look, theme=theme, names=suffix not in SHEETS)
            if suffix in SHEETS:
                return str(write_sheet(shown, out, width=int(width), title=name, style=style, view=view))
            if suffix == plotly_figure.SUFFIX:
                return str(plotly_figure.write_figure(shown, out, title=name, theme=theme))
            size, hear = (int(width), int(height)), films.in_time()
            return str(
                film.write_film(
                    [Pane(shown)], out, fps=fps, size=size, style=style, view=view, title=name, progress=hear
                )
            )
        except Exception as error:
            raise gr.Error(error_line(without_place(error, folder)), print_exception=False) from None


ENDPOINTS = (
    PredictEndpoint,
    GenerateEndpoint,
    ClassEndpoint,
    ReactEndpoint,
    RenderEndpoint,
    SceneEndpoint,
    ReadEndpoint,
)
"""Gradio's client in the browser takes the page's first function for "/predict", so that one comes first."""
