"""A story in several beats → two people through time; parts made again, and continuations."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import gradio as gr

from motion import Duet
from webdemo.inference.run import Progress, Result
from webdemo.inference.story import SceneProgress, SceneRequest
from webdemo.inference.story.beats import story_title
from webdemo.ui.components.exports import Record
from webdemo.ui.components.fields import chip, prompt_field
from webdemo.ui.components.film import READ_PLAYER
from webdemo.ui.components.player import show, with_shown_roles
from webdemo.ui.components.reading import Reading, checked
from webdemo.ui.components.scene_parts import FUTURES, only_sample, part_request, place_of, shown_duet, went_on
from webdemo.ui.components.story import StoryLine, story_fields, value_of
from webdemo.ui.components.story_words import edited, lay_out, said_of, settled, story_text, written
from webdemo.ui.context import PageContext
from webdemo.ui.history import Opened
from webdemo.ui.text.panels import status
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import tries_line
from webdemo.view.payload import player_payload

from .job import JobTab, Named
from .results import QUIET, Parts, Updates, said
from .sampling import Sampling

EXAMPLES = (
    (say("scene.greeting"), say("scene.greeting_story")),
    (say("scene.quarrel"), say("scene.quarrel_story")),
    (say("scene.dance"), say("scene.dance_story")),
)
"""(name, story) of the examples."""


class SceneTab(JobTab):
    """A story → a scene."""

    label = "Scene"
    named = "tabs.scene"
    prefix = "scene-"

    def __init__(self, page: PageContext) -> None:
        super().__init__(page)
        self.sampling: Sampling = Sampling(self.prefix, sentences=True)

    # ---- requests --------------------------------------------------------------------------------

    def request(self, fields: Mapping[str, Any]) -> SceneRequest:
        """The whole story; raises InputError where it cannot be made."""
        settings = {f: fields[f] for f in self.sampling.controls if f in fields}  # older grids lack some
        return SceneRequest(**story_fields(fields["story"]), **settings)

    def settled(self, fields: Mapping[str, Any]) -> Mapping[str, Any]:
        """The story that is made with the text that stands for it; see :func:`settled`."""
        if fields.get("part"):
            return fields
        story, text = settled(fields["story"], str(fields["prompt"] or ""))
        return {**fields, "story": story, "prompt": text, "typed": fields["prompt"]}

    def beside_grid(self, made: Mapping[str, Result], fields: Mapping[str, Any]) -> dict[str, Any]:
        """The story of the first cell, without its motion: the cells differ in it."""
        asked = next(iter(made.values())).manifest.get("request", {})
        whole = asked.get("beats") and "motion" not in asked
        return {
            "story": gr.update(value=value_of(SceneRequest.from_dict(asked))) if whole else gr.skip(),
            "prompt": _changed(fields),
            "reading": gr.update(checked={}),
            "spans": gr.update(visible=False),
        }

    def title(self, request: SceneRequest) -> str:
        """The words of its beats."""
        return story_title(request.to_dict()["beats"])

    # ---- layout ----------------------------------------------------------------------------------

    def build(self, record: gr.State) -> None:
        """See :meth:`JobTab.build`."""
        self.lay_out(self._ask, self._settings, below=self._story)
        self.controls = {"prompt": self.prompt, "story": self.line_up, **self.sampling.controls}
        self.wire([self.go.click, self.prompt.submit], record)
        self._wire_parts()
        self._wire_story()
        self.reading.follow(self.prompt, **QUIET)

    def _ask(self) -> None:
        self.prompt = prompt_field(say("scene.prompt"), EXAMPLES[0][1], self._id("prompt"))
        with gr.Row(elem_classes="pd-chips"):
            self.chips = [chip(name, elem_id=self._id(f"example-{i}")) for i, (name, _) in enumerate(EXAMPLES)]
            self.last = chip(say("scene.last"), elem_id=self._id("last"))
        self.reading = Reading(elem_id=self._id("reading"), elem_classes="pd-reading")
        self.build_go(say("scene.go"))

    def _story(self) -> None:
        self.line_up = StoryLine(elem_id=self._id("story"), elem_classes="pd-story")
        with gr.Row(elem_classes="pd-panel pd-parts", visible=False) as self.spans:
            gr.HTML(f'<p class="pd-method">{say("scene.part_info")}</p>')
            self.words = gr.Textbox(
                label=say("scene.part"),
                placeholder=say("scene.part"),
                show_label=False,
                container=False,
                min_width=240,
                elem_id=self._id("part-words"),
            )
            small: dict[str, Any] = {"size": "sm", "min_width": 0, "scale": 0}
            self.remake = gr.Button(say("scene.remake"), elem_id=self._id("remake"), **small)
            self.futures = gr.Button(say("scene.futures", count=FUTURES), elem_id=self._id("futures"), **small)
            self.take = gr.Button(say("scene.take"), visible=False, elem_id=self._id("take"), **small)

    def _settings(self) -> None:
        self.sampling.build()
        self.shown_at = gr.Textbox(visible=False)  # made last: Gradio passes inputs in the order in which they are made

    def more_outputs(self) -> dict[str, Any]:
        """The story with its words, their verdicts, and what can be done with parts of the motion."""
        return {
            "story": self.line_up,
            "prompt": self.prompt,
            "reading": self.reading,
            "spans": self.spans,
            "take": self.take,
        }

    def shown(self, result: Result, title: str) -> dict[str, Any]:
        """Also what can be done with parts of the motion, or with one of several."""
        several = gr.update(visible=len(result.duets) > 1)
        return {**super().shown(result, title), "spans": gr.update(visible=True), "take": several}

    def starts(self) -> dict[str, gr.Button]:
        """Also those of parts."""
        return {**super().starts(), "remake": self.remake, "futures": self.futures}

    # ---- events ----------------------------------------------------------------------------------

    def _wire_story(self) -> None:
        for button, (_, sentences) in zip(self.chips, EXAMPLES, strict=True):
            button.click(
                partial(lay_out, sentences),
                inputs=self.line_up,
                outputs=[self.prompt, self.line_up, self.line],
                **QUIET,
            )
        last: dict[str, Any] = {
            "outputs": [self.line_up, self.line, self.prompt],
            "trigger_mode": "always_last",
            **QUIET,
        }
        self.line_up.input(edited, inputs=self.line_up, **last)
        self.prompt.input(None, inputs=self.line_up, outputs=self.line_up, js=_TYPED, **QUIET)
        self.prompt.blur(written, inputs=[self.prompt, self.line_up], **last)
        changed = [*self.outputs.values(), self.trail]
        shown = [self.results.own, self.trail, self.shown_at]
        self.take.click(self.take_shown, inputs=shown, js=READ_PLAYER, outputs=changed, **QUIET)
        self.last.click(self.take_last, inputs=self.record, outputs=changed, **QUIET)

    def _wire_parts(self) -> None:
        kept = self.remake.click(None, js=_KEEP_POSE, **QUIET).then
        for trigger, part in ((kept, "span"), (self.futures.click, "futures")):
            more = [self.words, self.results.own, self.shown_at]
            self.wire_start(self._starter(part), trigger, more=more, first=READ_PLAYER)

    def kept_more(self, fields: Mapping[str, Any]) -> dict[str, Any]:
        """Of a part also the whole story."""
        return {"story": fields["story"]} if fields.get("part") else {}

    def answer(self, session: str, fields: Mapping[str, Any]) -> Iterator[Named]:
        """Runs the story; parts appear as they are finished and stay if the run is cancelled."""
        part = fields.get("part")
        if part is not None:
            wanted = part_request(fields)
        else:
            wanted = self.request(fields)
            laid = {"prompt": _changed(fields)}
            # Not the story itself: Gradio's page would change it in place into the update after it.
            yield {**laid, "story": gr.update(value=fields["story"])}
        title = fields["record"].prompt if part is not None else self.title(wanted)
        result = yield from self.made(session, wanted, watch=partial(self._watch, title))
        verdicts = checked(str(fields["prompt"]), result.manifest) if part is None else {}
        shown = self.shown(result, title) | {"reading": gr.update(checked=verdicts)}
        if part == "futures":
            story = went_on(fields["story"], wanted)
            shown |= {"story": gr.update(value=story), "prompt": story_text(story_fields(story)["beats"])}
        elif part is None:  # again, as a browser may show only the last of several updates
            shown |= {"story": gr.update(value=fields["story"]), **laid}
        yield shown

    def _starter(self, part: str) -> Callable[..., Iterator[Updates]]:
        """What makes a part of the motion: the selected "span" again, or "futures" from the player's frame on."""

        def start(values: dict[gr.components.Component, Any], request: gr.Request) -> Iterator[Updates]:
            record = values[self.results.own]
            fields = self.fields(values) | {"part": part, "words": values[self.words], "record": record}
            yield from self.run(str(request.session_hash), fields | place_of(values[self.shown_at]))

        return start

    def _watch(self, title: str, event: Progress) -> dict[str, Any] | None:
        """Shows a finished window at once."""
        if not isinstance(event, SceneProgress) or event.sample:
            return None
        line = f"{tries_line(event)}Beat {event.beat + 1} is there. Step {event.step} of {event.total}."
        shown = player_payload(with_shown_roles(event.motion, {}), title=title)
        return {"player": show(shown), "line": status(line, tone="busy")}

    @said
    def take_last(self, record: Record | None) -> Parts:
        """Shows the session's last result here, of whichever tab, so that parts of it can be made again."""
        shown_duet(record, 0)
        assert record is not None
        return self._taken(record.result, record.prompt, status("Select a span of it, or ask for continuations."))

    @said
    def take_shown(self, record: Record | None, trail: list[str], shown: str) -> Parts:
        """Keeps one of several futures as the motion; the choice can be gone back to."""
        sample = place_of(shown)["sample"]
        shown_duet(record, sample)
        assert record is not None
        line = status(f"Taken: number {sample + 1} is the motion now.", tone="done")
        taken = self._taken(only_sample(record.result, sample), record.prompt, line)
        return taken | {self.trail: [*trail, record.result.run]}

    def _taken(self, result: Result, title: str, line: str) -> Parts:
        """A result as the motion of this tab, without verdicts, which were on what another was asked for."""
        shown = self.shown(result, title) | {"line": line, "reading": gr.update(checked={})}
        return {self.outputs[name]: update for name, update in shown.items()}

    def opened(self, run: Opened) -> dict[gr.components.Component, Any]:
        """Also the story that was asked for."""
        updates, duet = super().opened(run), run.result.duets[0]
        if run.entry.kind == "scene" and isinstance(duet, Duet):
            asked = run.entry.request
            motion = duet if "motion" in asked else None
            request = SceneRequest.from_dict(asked, motion)
            whole = run.kept.controls.get("story")  # a part's own request knows nothing of what is around it
            if motion is None or not whole:
                story = value_of(request)
            else:
                story = went_on(whole, request) if request.end is None else whole
            updates[self.line_up] = gr.update(value=story)
            said = said_of(str(run.kept.controls.get("prompt") or ""), story)
            updates[self.prompt] = gr.update(value=said)
            updates[self.reading] = gr.update(checked={} if motion is not None else checked(said, run.result.manifest))
        return updates


def _changed(fields: Mapping[str, Any]) -> Any:
    """An update of the words over the line, where they are not as they were typed."""
    return gr.skip() if fields.get("typed") == fields.get("prompt") else fields["prompt"]


_TYPED = """(story) => ({
  __type__: "update", ...(story?.ahead ? { value: { ...story, ahead: false } } : {}),
})"""
"""JavaScript that tells the line that the words over it are newer than its beats."""
_KEEP_POSE = "() => window.__pasdedeux?.player?.directing.posing?.keep()"
"""JavaScript that keeps a pose that is being pulled at: it is a part of what is made again."""
