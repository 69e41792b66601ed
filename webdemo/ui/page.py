"""The page: a header and a tab for every job."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import gradio as gr
from gradio.queueing import Queue

from motion.formats.files import MAX_BYTES
from webdemo.ui.components.finder import Finder
from webdemo.ui.tabs.generate import GenerateTab
from webdemo.ui.tabs.history import LABEL as HISTORY
from webdemo.ui.tabs.history import HistoryTab
from webdemo.ui.tabs.job import JobTab
from webdemo.ui.tabs.predict import PredictTab
from webdemo.ui.tabs.react import ReactTab
from webdemo.ui.tabs.results import QUIET
from webdemo.ui.tabs.scene import SceneTab
from webdemo.ui.text.panels import model_state
from webdemo.ui.text.texts import say

from .api import ENDPOINTS
from .context import PageContext
from .frames import begin_early
from .runs import EngineLike
from .theme import HEAD, STYLE, theme

if TYPE_CHECKING:
    from .context import Health, Notebook

TITLE = "Pas de Deux"

_WRITE = """() => {
  const tab = document.activeElement;
  const write = () => {
    const field = document.getElementById(%s)?.querySelector("textarea");
    if (document.activeElement === tab) field?.focus({ preventScroll: true });
  };
  const pressed = tab.matches("body, [role=tab]:not(:focus-visible)"); // not a control that the search has gone to
  if (pressed && matchMedia("(pointer: fine)").matches) setTimeout(write, 300);
}"""
"""JavaScript that makes a field ready for typing where its tab was opened by a mouse; to be filled with its id."""
_BEGIN_WITH = """(own, first) => ({ __type__: "update", ...(own ? {} : { value: first }) })"""
"""JavaScript that lets an empty player begin with what another shows, so that the page carries the example once."""
_OF_GRADIO = ("common.upload", "upload_text.drop_file", "upload_text.click_to_upload")
"""Keys of Gradio's texts that are others here."""
_CACHE = (1800, 7200)
"""Seconds: how often Gradio's copies of downloads are looked through, and how old they may get."""
_LOOK = 0.02
"""Seconds between two looks at a queue of events in which nothing waits."""


class _Page(gr.Blocks):
    """Blocks that make their queue and their configuration once they are whole, see :func:`start_queue`.

    Gradio would make two applications and four configurations before the one that is served.
    """

    def queue(self, *_: Any, **__: Any) -> _Page:
        """Makes nothing: the blocks ask for it before anything is in them."""
        return self

    def get_config_file(self) -> Any:
        """The configuration; empty while the blocks are built."""
        return super().get_config_file() if self.exited else {}


def build_page(page: PageContext) -> gr.Blocks:
    """Builds the page of what its parts share; launch it with :func:`launch_options`.

    Nothing of the engine is loaded before the page is up.
    """

    def leave(request: gr.Request) -> None:
        page.runs.cancel(str(request.session_hash))

    def loading() -> Iterator[str]:
        yield from watch_loading(page.engine, page.health)

    begin_early()
    with _Page(title=TITLE, delete_cache=_CACHE, fill_width=True, analytics_enabled=False) as demo:
        for endpoint in ENDPOINTS:
            endpoint(page).publish()
        mark = _build_header(page.history)
        _build_tabs(page, demo)
        demo.load(loading, outputs=mark, concurrency_limit=None, **QUIET)
        demo.unload(leave)
    start_queue(demo, partial(Queue, max_size=64))
    return demo


def _build_header(history: Notebook) -> gr.HTML:
    """The title, the search and the mark that says whether the model is ready, which is returned."""
    with gr.Row(elem_classes="pd-header", equal_height=True):
        gr.HTML('<div class="pd-brand"><h1>Pas de Deux</h1></div>')
        finder = Finder(elem_id="finder")
        mark = gr.HTML(model_state("loading"), elem_id="model-state")
    finder.wire(history, **QUIET)
    return mark


def start_queue(page: gr.Blocks, make: Callable[..., Queue]) -> None:
    """Gives a page its queue of events, which is looked into less often than Gradio's own while nothing waits.

    Gradio looks every millisecond, and every ten for progress. An idle server then takes a tenth of a core.

    Args:
        page: the page.
        make: Gradio's queue, or a kind of it, that is given the other options.
    """
    page._queue = make(
        live_updates=True,
        concurrency_count=page.max_threads,
        update_intervals=1,
        blocks=page,
        default_concurrency_limit=4,
    )
    page.api_open = False  # otherwise every event could be called past the queue
    page._queue.sleep_when_free = _LOOK
    page._queue.progress_update_sleep_when_free = 5 * _LOOK
    # Gradio sums up all earlier events after each one, with pandas, for a dashboard that this page does not have.
    page._queue.ANALYTICS_MAX_EVENTS = 1
    page._queue.ANAYLTICS_CACHE_FREQUENCY = sys.maxsize


def _build_tabs(page: PageContext, demo: gr.Blocks) -> None:
    """A tab for every job, and the history."""
    record = gr.State(None, time_to_live=3600)
    generate, scene, react, predict = GenerateTab(page), SceneTab(page), ReactTab(page), PredictTab(page)
    jobs: dict[str, JobTab] = {job.label.lower(): job for job in (generate, scene, react, predict)}
    with gr.Tabs(elem_classes="pd-tabs") as tabs:
        shown: dict[str, gr.Tab] = {}
        for name, job in jobs.items():
            with gr.Tab(say(job.named), id=name) as shown[name]:
                job.build(record)
        shown["scene"].select(None, js=_WRITE % json.dumps(scene.prefix + "prompt"), **QUIET)
        first, own = generate.results.player, scene.results.player
        shown["scene"].select(None, inputs=[own, first], outputs=own, js=_BEGIN_WITH, **QUIET)
        react.actor.wire_arrival(shown["react"], record, react.label)
        predict.wire_page(shown["predict"], tabs, [job.results for job in jobs.values()])
        with gr.Tab(say("tabs.history"), id=HISTORY.lower()) as past:
            HistoryTab(page, jobs, tabs).build(demo, past, record)


def watch_loading(engine: EngineLike, health: Health, *, interval: float = 0.3) -> Iterator[str]:
    """Has the networks loaded and yields the header's mark until they are there, or failed."""
    health.probe()
    shown = None
    while shown in (None, "loading"):
        state = "ready" if engine.ready else "failed" if health.error else "loading"
        if state != shown:
            shown = state
            yield model_state(state, health.error)
        else:
            time.sleep(interval)


def launch_options() -> dict[str, Any]:
    """Keyword arguments for ``launch`` (or ``gr.mount_gradio_app``) that give the page its looks."""
    return {
        "theme": theme(),
        "css": STYLE.read_text(encoding="utf-8"),
        "head": HEAD,
        "footer_links": [],
        "run_history": False,
        "i18n": gr.I18n(en={key: say(key) for key in _OF_GRADIO}),
        "ssr_mode": False,
        "show_error": False,  # an error's own text may hold paths; sentences are shown all the same
        "max_file_size": MAX_BYTES,
    }
