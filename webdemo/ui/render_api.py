"""``/render``: a motion file → a film, a contact sheet or a figure, for programs."""

from __future__ import annotations

from pathlib import Path

import gradio as gr

from motion import InputError
from motion.formats import read
from webdemo.ui.components.exports import file_name, without_place
from webdemo.ui.components.film import LONGEST, in_time
from webdemo.ui.text.words import error_line
from webdemo.view.camera import VIEWS
from webdemo.view.film import FPS, SIZE, write_film
from webdemo.view.plotly_figure import SUFFIX as FIGURE
from webdemo.view.plotly_figure import write_figure
from webdemo.view.sheet import SUFFIXES as SHEETS
from webdemo.view.sheet import write_sheet
from webdemo.view.stage import LOOKS, Pane, Style

from .api import ORDER, RATE, UP, WHICH, Endpoint, reading_choices
from .places import READING


class RenderEndpoint(Endpoint):
    """``/render``: a motion file → a film, a contact sheet or a plotly figure."""

    def publish(self) -> None:
        """Adds the endpoint to the page that is being built."""
        with gr.Row(visible=False):
            inputs = [
                gr.File(label="the motion of one person or two: .bvh, .glb, .npz, .c3d …, up to 50 MB"),
                gr.Textbox("mp4", label="film: mp4, webm, gif; contact sheet: png, pdf; plotly figure: html"),
                gr.Textbox(Style.look, label=" or ".join(LOOKS)),
                gr.Textbox(Style.theme, label="light or dark"),
                gr.Textbox("threequarter", label=" or ".join(VIEWS)),
                gr.Number(FPS, label="frames a second of a film, 1 to 60"),
                gr.Number(SIZE[0], label="width in pixels: even, 64 to 1920"),
                gr.Number(SIZE[1], label="height of a film in pixels: even, 64 to 1080"),
                gr.Textbox("", label=WHICH),
                gr.Number(0, label=RATE),
                gr.Textbox("", label=UP),
                gr.Textbox("", label=ORDER),
            ]
            gr.Button().click(
                self.render,
                inputs=inputs,
                outputs=gr.File(label="the film, sheet or figure"),
                api_name="render",
                concurrency_limit=1,
                concurrency_id="film",
            )

    def render(
        self,
        motion: str,
        kind: str,
        look: str,
        theme: str,
        view: str,
        fps: float,
        width: float,
        height: float,
        animation: str = "",
        file_fps: float = 0.0,
        up: str = "",
        order: str = "",
    ) -> str:
        """A film, a contact sheet or a plotly figure of a motion file. An error is one sentence."""
        folder = self.page.shelf.folder()
        try:
            if not motion:
                raise InputError("There is no motion: send a motion file, such as a .bvh.")
            kind, look, theme = kind or "mp4", look or Style.look, theme or Style.theme
            fps, width, height = (
                given if given is not None else usual
                for given, usual in zip((fps, width, height), (FPS, *SIZE), strict=True)
            )
            if width > 1920 or height > 1080:
                raise InputError("Pictures have 1920x1080 pixels at most here: ask for less.")
            with READING.place():
                found = read(Path(motion), choices=reading_choices(animation, file_fps, up, order), longest=LONGEST)
            name, suffix = Path(motion).stem, f".{kind.lower().lstrip('.')}"
            out = folder / f"{file_name(name, {})}{suffix}"
            style = Style(look=look, theme=theme, names=suffix not in SHEETS)
            if suffix in SHEETS:
                return str(write_sheet(found, out, width=int(width), title=name, style=style, view=view))
            if suffix == FIGURE:
                return str(write_figure(found, out, title=name, theme=theme))
            size = (int(width), int(height))
            film = write_film(
                [Pane(found)], out, fps=fps, size=size, style=style, view=view, title=name, progress=in_time()
            )
            return str(film)
        except Exception as error:
            raise gr.Error(error_line(without_place(error, folder)), print_exception=False) from None
