"""Two people from one sentence or a class: the controls, the player and what is measured under it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.inference.method import SECONDS
from webdemo.inference.methods import installed, installed_classes, label_of, method, takes_class
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.requests.paths import path_of
from webdemo.inference.run import Result
from webdemo.inference.story.beats import plans_of_result
from webdemo.ui.components.fields import chip, looked_up, prompt_field, slider
from webdemo.ui.components.gallery import Gallery
from webdemo.ui.components.player import arrival_payload
from webdemo.ui.components.reading import Reading, checked, drawn_paths, edited_plan, shown
from webdemo.ui.components.story import path_value
from webdemo.ui.components.sweep import Kind
from webdemo.ui.context import PageContext
from webdemo.ui.history import Opened
from webdemo.ui.text.examples import ARRIVAL, CLIPS, EXAMPLES
from webdemo.ui.text.texts import say

from .grids import PLAN, SENTENCES, methods_kind
from .job import JobTab
from .results import PRESS, QUIET, Updates
from .sampling import Sampling


def generate_choices() -> list[tuple[str, str]]:
    """(label, name) of the methods that make two people: by what they take, and from the second on by name."""
    choices: list[tuple[str, str]] = []
    plain = {"words": "A sentence", "class": "A class"}
    for each in installed("generate"):
        kind = next((kind for kind in plain if kind in each.takes), "")
        choices.append((plain.pop(kind, each.label), each.name))
    return choices


def _chosen_class(fields: Mapping[str, Any]) -> str:
    if not fields["class_name"]:
        raise InputError("No class is chosen: choose what the two people do.")
    return str(fields["class_name"])


def _class_in(sentence: str, label: str) -> str:
    """The class that a sentence names; raises InputError if it names none."""
    named = next((name for name in installed_classes() if name in sentence.lower()), None)
    if named is None:
        raise InputError(
            f"The sentence names none of {label}'s classes: write one of them, such as “shake hands”, or change to "
            "A class, which lists them all."
        )
    return named


class GenerateTab(JobTab):
    """Text, or a class → two people."""

    label = "Generate"
    named = "tabs.generate"

    def __init__(self, page: PageContext) -> None:
        super().__init__(page)
        self.sampling: Sampling = Sampling(self.prefix, sentences=True)

    def request(self, fields: Mapping[str, Any]) -> GenerateRequest:
        """See :meth:`JobTab.request`; raises InputError if no class is chosen, or the edited plan is none."""
        asked = {name: value for name, value in fields.items() if name not in ("class_name", "acts")}
        if takes_class(fields.get("model", GenerateRequest.model)):
            asked["prompt"] = _chosen_class(fields)
            return GenerateRequest(**asked)
        plan = edited_plan(fields.get("acts"), str(fields.get("prompt") or ""))
        if plan is not None and not asked.get("planned", True):
            raise InputError("The edited plan is not followed: choose Plan from the words, or press Read again.")
        asked |= {"acts": plan, "paths": drawn_paths(fields.get("acts"))}
        return GenerateRequest(**asked)

    def title(self, request: GenerateRequest) -> str:
        """The sentence or class."""
        return request.prompt

    def kinds(self) -> Sequence[Kind]:
        """Also sentences, and methods."""
        methods = {name: method(name).label for _, name in generate_choices()}
        return (*super().kinds(), PLAN, SENTENCES, methods_kind("model", methods))

    def presets(self) -> Mapping[str, tuple[str, str]]:
        """Also a sentence beside a class, where there are classes."""
        labels = [method(name).label for _, name in generate_choices()]
        beside = {"Sentence beside class": ("model", "; ".join(labels))} if len(labels) > 1 else {}
        return {**super().presets(), **beside}

    def cell_fields(self, fields: Mapping[str, Any], cell: Mapping[str, Any]) -> dict[str, Any]:
        """A method of classes gets the guidance that suits it, and the class that the sentence names.

        Where the tab asks for a class, the methods of sentences get one of that class.
        """
        asked = {**fields, **cell}
        if "model" not in cell:
            return asked
        by_class = takes_class(asked["model"])
        if by_class and "guidance" not in cell:
            asked["guidance"] = method(asked["model"]).defaults.get("guidance", asked["guidance"])
        if by_class and not takes_class(fields["model"]):
            asked["class_name"] = _class_in(str(asked.get("prompt") or ""), label_of(asked["model"]))
        elif not by_class and takes_class(fields["model"]):
            asked["prompt"] = f"Two people {_chosen_class(fields)}."
        return asked

    # ---- layout ----------------------------------------------------------------------------------

    def build(self, record: gr.State) -> None:
        """See :meth:`JobTab.build`."""
        self.lay_out(self._ask, self._settings, first=arrival_payload(CLIPS / ARRIVAL))
        self.controls = {
            "model": self.model,
            "prompt": self.prompt,
            "class_name": self.class_name,
            "seconds": self.seconds,
            **self.sampling.controls,
            "planned": self.planned,
            "acts": self.reading,
        }
        self.first = self.reading.read_first(self.prompt, self.seconds, self.controls.values())
        self.wire([self.go.click, self.prompt.submit], record)
        self.reading.follow(self.prompt, **QUIET)
        for button, (_, sentence) in zip(self.chips, EXAMPLES, strict=True):
            filled = button.click(None, outputs=self.prompt, js=f"() => {json.dumps(sentence)}", **QUIET)
            filled.then(None, js=PRESS % json.dumps(self.go.elem_id), **QUIET)
        self.gallery.fill(self.prompt, self.seconds, self.sampling.seed, self.go, **QUIET)
        asked_by = {name: self.asked_by(name) for _, name in generate_choices()}
        form = self.sampling
        fitted = [self.by_sentence, self.class_name, form.guidance, form.steps, *self._of_sentences()]
        self.model.input(None, inputs=self.model, outputs=fitted, js=looked_up(asked_by), **QUIET)

    def _ask(self) -> None:
        classes = installed_classes()
        choices = generate_choices()
        self.model = gr.Radio(
            choices,
            value=GenerateRequest.model,
            show_label=False,
            container=False,
            visible=len(choices) > 1,
            elem_id="way",
            elem_classes="pd-way",
        )
        with gr.Column(min_width=0, elem_classes="pd-sentence") as self.by_sentence:
            info = say("generate.prompt_info")
            self.prompt = prompt_field(say("generate.prompt"), EXAMPLES[0][1], "prompt", info=info, autofocus=True)
            with gr.Row(elem_classes="pd-chips"):
                self.gallery = Gallery(elem_id="gallery", elem_classes="pd-gallery", min_width=0)
                self.chips = [chip(name) for name, _ in EXAMPLES]
            usual = GenerateRequest.seconds
            self.reading = Reading(editable=True, usual=usual, elem_id="reading", elem_classes="pd-reading")
        self.class_name = gr.Dropdown(
            classes,
            value=None,
            label=say("generate.prompt"),
            info=say("generate.class_info", count=len(classes)),
            visible=False,
            elem_id="class",
        )
        self.build_go(say("generate.go"))

    def _settings(self) -> None:
        self.seconds = slider("generate.seconds", SECONDS, GenerateRequest.seconds, 0.5, elem_id="seconds")
        self.sampling.build(self._who)

    def _who(self) -> None:
        """A switch that gives the whole motion to the network."""
        self.planned = gr.Radio(
            [(say("generate.planned"), True), (say("generate.alone"), False)],
            value=GenerateRequest.planned,
            label=say("generate.who"),
            show_label=False,
            container=False,
            elem_id="planned",
            elem_classes="pd-way",
        )

    @staticmethod
    def asked_by(way: str) -> Updates:
        """Shows the inputs that a method takes, and sets its guidance and steps."""
        chosen, by_class = method(way), takes_class(way)
        of_sentences = gr.update(visible=not by_class)
        return (
            # Were it not visible, Gradio would forget what is read and judged in it.
            gr.update(elem_classes=["pd-sentence", *["pd-off"] * by_class]),
            gr.update(visible=by_class),
            gr.update(value=chosen.defaults.get("guidance", GenerateRequest.guidance)),
            gr.update(value=chosen.steps),
            *(of_sentences,) * 3,
        )

    def _of_sentences(self) -> list[Any]:
        """The settings that a class has no use for."""
        return [self.planned, self.sampling.strictness, self.sampling.tries]

    # ---- what is shown ---------------------------------------------------------------------------

    def more_outputs(self) -> dict[str, Any]:
        """The reading, whose acts are marked as done or not."""
        return {"reading": self.reading}

    def restored(self) -> Sequence[Any]:
        """The inputs that the method takes."""
        return [self.by_sentence, self.class_name]

    def shown(self, result: Result, title: str) -> dict[str, Any]:
        """Also the verdicts on the acts."""
        asked = result.manifest.get("request") or {}
        marks = checked(str(asked.get("prompt") or ""), result.manifest)
        return {**super().shown(result, title), "reading": gr.update(checked=marks)}

    def beside_grid(self, made: Mapping[str, Result], fields: Mapping[str, Any]) -> dict[str, Any]:
        """The verdicts of the last result go: the cells have their own, in the table."""
        return {"reading": gr.update(checked={})}

    def opened(self, run: Opened) -> dict[gr.components.Component, Any]:
        """Also what was asked by: a sentence or a class."""
        asked = run.entry.request
        model = asked.get("model", GenerateRequest.model)
        sentence, label, *_, setting = self.asked_by(model)
        updates = super().opened(run)
        updates |= {part: updates.get(part, {}) | setting for part in self._of_sentences()}
        if takes_class(model):
            label = gr.update(value=asked.get("prompt"), visible=True)
        else:
            updates[self.reading] = self._opened_reading(asked, run.result)
        planned = bool(asked.get("planned", takes_class(model)))  # once, words did not become paths
        updates[self.planned] |= {"value": planned}
        return updates | {self.by_sentence: sentence, self.class_name: label}

    def _opened_reading(self, asked: Mapping[str, Any], result: Result) -> dict[str, Any]:
        """The update that shows the plan of a kept run."""
        text = str(asked.get("prompt") or "")
        plan = plans_of_result(result.manifest)[0]
        drawn = [path_value(path_of(path)) for path in asked.get("paths") or ()]
        of_text = {"text": text, "number": None, "edited": plan.reader == "hand", "paths": drawn}
        return gr.update(shown=of_text | shown(plan), checked=checked(text, result.manifest))
