"""Two people from one sentence: the controls, the player and what is measured under it."""

from __future__ import annotations

import json
import secrets
import time
from collections.abc import Iterator, Mapping
from typing import Any

import gradio as gr

from webdemo.inference.requests import (
    DAMPING,
    GUIDANCE,
    MAX_SEED,
    SAMPLES,
    SECONDS,
    Cancelled,
    GenerateRequest,
    Progress,
    Result,
)

from .context import PageContext
from .examples import EXAMPLES
from .exports import KINDS, Record, for_download, write_files
from .panels import model_card, readout_panel, status
from .player import MotionPlayer, busy, show
from .show import result_payload
from .words import cancelled_line, error_line, progress_line, seconds

STEPS_SHOWN = (5, 100)
"""What the slider offers; the API takes more."""
PACE = 0.1
"""Seconds between two updates of the page while a run goes on."""

_DAMPING_INFO = (
    "While t ≤ threshold × T the predicted motion is corrected for foot contact, bone length, smoothness, "
    "interpenetration, near-contacts and facing; 0 = plain sampler."
)
_GUIDANCE_INFO = "How closely the motion follows the words; 1 = unguided."
_STEPS_INFO = "From noise to motion: fewer are faster, more are finer."
_SEED_INFO = "Same seed, same motion; empty draws a new one."

Updates = tuple[Any, ...]


class GenerateTab:
    """Text → two people.

    Args:
        page: what the tabs share.
    """

    label = "Generate"

    def __init__(self, page: PageContext) -> None:
        self.page = page

    # ---- layout ----------------------------------------------------------------------------------

    def build(self, demo: gr.Blocks) -> None:
        """Lays out the tab inside ``demo`` and wires its events."""
        with gr.Row(elem_classes="pd-lab", equal_height=False):
            with gr.Column(elem_classes="pd-controls", min_width=0):
                self._ask()
                self._settings()
                with gr.Accordion("About the model", open=False, elem_classes="pd-panel pd-about"):
                    self.card = gr.HTML(elem_id="model-card")
            with gr.Column(elem_classes="pd-results", min_width=0):
                with gr.Column(elem_classes="pd-panel pd-stage", min_width=0):
                    self.player = MotionPlayer(elem_id="player")
                with gr.Column(elem_classes="pd-panel pd-under", min_width=0, visible=False) as self.under:
                    self._takeaways()
        self.record = gr.State(None, time_to_live=3600)
        self._wire(demo)

    def _ask(self) -> None:
        with gr.Column(elem_classes="pd-panel pd-ask", min_width=0):
            self.prompt = gr.Textbox(
                label="What do the two people do?",
                placeholder=EXAMPLES[0][1],
                lines=1,  # so that Enter generates; the style sheet gives it the height of three
                max_lines=6,
                elem_id="prompt",
                autofocus=True,
            )
            with gr.Row(elem_classes="pd-chips"):
                self.chips = [
                    gr.Button(name, size="sm", elem_classes="pd-chip", min_width=0) for name, _ in EXAMPLES
                ]
            with gr.Row(elem_classes="pd-go"):
                self.go = gr.Button("Generate", variant="primary", elem_id="generate", min_width=0)
                self.stop = gr.Button("Cancel", elem_id="cancel", interactive=False, min_width=0)
            self.line = gr.HTML(status(), elem_id="status")

    def _settings(self) -> None:
        start = GenerateRequest(prompt=EXAMPLES[0][1])
        with gr.Column(elem_classes="pd-panel pd-settings", min_width=0):
            with gr.Row(elem_classes="pd-pair"):
                self.seconds = gr.Slider(
                    *SECONDS, value=start.seconds, step=0.5, label="Seconds", elem_id="seconds"
                )
                self.samples = gr.Slider(
                    *SAMPLES, value=start.samples, step=1, label="Samples", elem_id="samples"
                )
            with gr.Row(elem_classes="pd-seed"):
                self.seed = gr.Number(
                    value=start.seed, precision=0, label="Seed", info=_SEED_INFO, elem_id="seed", min_width=0
                )
                self.dice = gr.Button("Random", size="sm", elem_id="dice", min_width=0)
            self.guidance = gr.Slider(
                *GUIDANCE, value=start.guidance, step=0.1, label="Guidance scale", info=_GUIDANCE_INFO,
                elem_id="guidance",
            )  # fmt: skip
            self.steps = gr.Slider(
                *STEPS_SHOWN, value=start.steps, step=1, label="DDIM steps", info=_STEPS_INFO, elem_id="steps"
            )
            self.damping = gr.Slider(
                *DAMPING, value=start.damping, step=0.05, label="Damping threshold", info=_DAMPING_INFO,
                elem_id="damping",
            )  # fmt: skip

    def _takeaways(self) -> None:
        with gr.Row(elem_classes="pd-downloads", elem_id="downloads"):
            self.downloads = [
                gr.DownloadButton(
                    kind.label, size="sm", interactive=False, visible=kind.offered(), min_width=0,
                    elem_id=f"download-{kind.key}",
                )
                for kind in KINDS
            ]  # fmt: skip
        self.readouts = gr.HTML(elem_id="readouts")

    # ---- events ----------------------------------------------------------------------------------

    def _wire(self, demo: gr.Blocks) -> None:
        quiet = {"api_visibility": "private", "show_progress": "hidden"}
        self.outputs = {
            "player": self.player,
            "line": self.line,
            "go": self.go,
            "stop": self.stop,
            "under": self.under,
            "readouts": self.readouts,
            "record": self.record,
        }
        run = gr.on(
            [self.go.click, self.prompt.submit],
            self.start,  # not "generate": that name is the public endpoint's
            inputs=[
                self.prompt, self.seconds, self.seed, self.samples, self.guidance, self.steps, self.damping
            ],
            outputs=list(self.outputs.values()),
            concurrency_limit=None,  # runs wait in a line of their own, where they can be cancelled
            trigger_mode="once",
            **quiet,
        )  # fmt: skip
        # Only now would a press be taken: while the event goes on, Gradio drops it.
        run.then(self.rest, outputs=[self.go, self.stop], queue=False, **quiet)
        run.then(
            self.export,
            inputs=self.record,
            outputs=[self.line, *self.downloads],
            concurrency_limit=2,
            **quiet,
        )
        self.stop.click(self.cancel, queue=False, **quiet)
        self.dice.click(
            None, outputs=self.seed, js=f"() => Math.floor(Math.random() * {MAX_SEED + 1})", **quiet
        )
        for chip, (_, sentence) in zip(self.chips, EXAMPLES, strict=True):
            focus = "document.querySelector('#prompt textarea').focus();"
            chip.click(
                None, outputs=self.prompt, js=f"() => {{ {focus} return {json.dumps(sentence)}; }}", **quiet
            )
        demo.load(self.describe_model, outputs=self.card, queue=False, **quiet)

    def start(
        self,
        prompt: str,
        seconds: float,
        seed: float | None,
        samples: float,
        guidance: float,
        steps: float,
        damping: float,
        request: gr.Request,
    ) -> Iterator[Updates]:
        """Runs what the controls ask for; yields updates of the page.

        Whatever goes wrong ends as one sentence in the status line, with the last result still on show.
        """
        fields = {
            "prompt": prompt,
            "seconds": seconds,
            "seed": secrets.randbelow(MAX_SEED + 1) if seed is None else seed,
            "samples": samples,
            "guidance": guidance,
            "steps": steps,
            "damping": damping,
        }
        yield from self.run(str(request.session_hash), fields)

    def run(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """The page's updates while a request with these fields runs for a session."""
        last: Progress | None = None
        shown_at = 0.0
        yield self._updates(
            player=busy("Starting …"),
            line=status("Starting …", tone="busy"),
            go=gr.update(interactive=False),
            stop=gr.update(interactive=True),
        )
        try:
            wanted = GenerateRequest(**fields)
            for event in self.page.runs.run(session, wanted):
                if isinstance(event, Result):
                    yield self._updates(**self._shown(event, wanted.prompt))
                    return
                new_stage = last is None or event.stage != last.stage
                last = event
                if new_stage or time.monotonic() - shown_at >= PACE:
                    shown_at = time.monotonic()
                    line = progress_line(event)
                    share = event.step / max(event.total, 1) if event.stage == "sample" else None
                    yield self._updates(player=busy(line, progress=share), line=status(line, tone="busy"))
        except Cancelled:
            yield self._stopped(cancelled_line(last), "warning")
        except Exception as error:
            yield self._stopped(error_line(error), "error")

    def _shown(self, result: Result, prompt: str) -> dict[str, Any]:
        total = result.timings.get("total", sum(result.timings.values()))
        count = len(result.duets)
        made = "Done" if count == 1 else f"{count} samples done"
        return {
            "player": show(result_payload(result, title=prompt)),
            "line": status(f"{made} in {seconds(total)}." if total else f"{made}.", tone="done"),
            "under": gr.update(visible=True),
            "readouts": readout_panel(result),
            "record": Record(result, prompt),
        }

    def _stopped(self, line: str, tone: str) -> Updates:
        return self._updates(player=busy(""), line=status(line, tone=tone))

    @staticmethod
    def rest() -> Updates:
        """The buttons once a run is over, however it ended."""
        return gr.update(interactive=True), gr.update(interactive=False)

    def _updates(self, **changed: Any) -> Updates:
        """Updates in the order of the outputs; what is not named stays as it is."""
        return tuple(changed.get(name, gr.skip()) for name in self.outputs)

    def cancel(self, request: gr.Request) -> None:
        """Stops the session's run within one denoising step."""
        self.page.runs.cancel(str(request.session_hash))

    def export(self, record: Record | None) -> Updates:
        """Writes the files of a new result and hands them to the download buttons."""
        unchanged = (gr.skip(),) * (1 + len(KINDS))
        if record is None or record.exported:
            return unchanged
        record.exported = True
        try:
            files = write_files(record.result, self.page.shelf.folder(), prompt=record.prompt)
            found = for_download(files)
        except Exception as error:
            off = gr.update(value=None, interactive=False)
            return (status(f"The motion is ready, but not its files. {error_line(error)}", tone="error"),
                    *(off for _ in KINDS))  # fmt: skip
        return (
            gr.skip(),
            *(gr.update(value=found.get(kind.key), interactive=kind.key in found) for kind in KINDS),
        )

    def describe_model(self) -> str:
        """The model card for the page."""
        try:
            return model_card(self.page.engine.info())
        except Exception as error:
            return status(error_line(error), tone="error")
