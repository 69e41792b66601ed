"""Colours, fonts and the style sheet. Nothing here is fetched from another host."""

from __future__ import annotations

import gradio as gr

from webdemo.ui.text.texts import STATIC

COLOURS = STATIC / "colours.css"
STYLE = STATIC / "ui.css"
"""The page's own style sheet, beside what the theme sets and the colours, with which the document begins."""

_SANS = ("system-ui", "-apple-system", "Segoe UI", "Roboto", "Noto Sans", "Helvetica Neue", "Arial", "sans-serif")
_MONO = ("ui-monospace", "SFMono-Regular", "Menlo", "Consolas", "DejaVu Sans Mono", "monospace")

_COLOURS = {
    "body_background_fill": "bg",
    "background_fill_primary": "panel",
    "background_fill_secondary": "bg",
    "body_text_color": "text",
    "body_text_color_subdued": "soft",
    "block_title_text_color": "text",
    "border_color_primary": "line",
    "input_background_fill": "field",
    "input_border_color": "edge",
    "input_border_color_focus": "a",
    "slider_color": "a",
    "button_primary_background_fill": "press",
    "button_primary_background_fill_hover": "press-hover",
    "button_secondary_background_fill": "panel",
    "button_secondary_text_color": "text",
    "button_secondary_background_fill_hover": "hover",
    "button_secondary_border_color": "edge",
}
"""Gradio's variables, each with a colour of the style sheet, which has them for the light and the dark page."""
_VALUES = {
    "block_background_fill": "transparent",
    "block_background_fill_dark": "transparent",
    "block_border_width": "0px",
    "block_padding": "0px",
    "block_label_text_weight": "600",
    "block_title_text_weight": "600",
    "block_title_text_size": "13px",
    "block_info_text_size": "12px",
    "input_border_width": "1px",
    "button_border_width": "1px",
}
"""Gradio's variables as this page sets them."""

HEAD = f"<script>{(STATIC / 'ui.js').read_text(encoding='utf-8')}</script>"
"""The page's own script: a key that starts a run, and menus that close by themselves."""


def theme() -> gr.themes.Base:
    """Gradio's plain theme in slate and blue, with the system's fonts."""
    return gr.themes.Base(
        primary_hue=gr.themes.colors.blue,
        secondary_hue=gr.themes.colors.orange,
        neutral_hue=gr.themes.colors.slate,
        text_size=gr.themes.sizes.text_md,
        spacing_size=gr.themes.sizes.spacing_md,
        radius_size=gr.themes.sizes.radius_md,
        font=list(_SANS),
        font_mono=list(_MONO),
    ).set(
        **_VALUES, **{f"{name}{dark}": f"var(--pd-{own})" for name, own in _COLOURS.items() for dark in ("", "_dark")}
    )
