"""Colours, fonts and the style sheet. Nothing here is fetched from another host."""

from __future__ import annotations

from pathlib import Path

import gradio as gr

_STATIC = Path(__file__).resolve().parents[2] / "static"
COLOURS = _STATIC / "colours.css"
STYLE = _STATIC / "ui.css"
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

HEAD = """<script>
// Gradio takes Enter in a prompt; this adds Ctrl+Enter and Cmd+Enter.
document.addEventListener("keydown", (event) => {
  if (event.key !== "Enter" || !(event.ctrlKey || event.metaKey)) return;
  const ask = event.target.closest?.(".pd-ask:has(textarea:focus)");
  if (!ask) return;
  event.preventDefault();
  ask.querySelector("button.pd-run:enabled")?.click();
});
// A press beside an open menu, Escape, or what starts a run in it closes it.
const shut = ({ type, key, target }) => {
  if (type === "keydown" && key !== "Escape") return;
  const starts = type === "click" && target.closest(".pd-menu :is(.pd-chip, [id$=grid-make])");
  if (type === "click" && !starts) return;
  for (const fold of document.querySelectorAll(".pd-menu > .label-wrap.open")) {
    if (type !== "pointerdown" || !fold.parentElement.contains(target)) fold.click();
  }
};
document.addEventListener("click", shut);
document.addEventListener("pointerdown", shut);
document.addEventListener("keydown", shut, { capture: true }); // the player keeps its keys to itself
// A menu under a resting mouse is open until the mouse leaves it; a press in it keeps it open, one on its name shut.
{
  const label = (menu) => menu?.querySelector(":scope > .label-wrap");
  let rested = null; // the menu that the mouse has opened
  let closed = null; // one that stays shut until the mouse has left it
  let soon;
  const rest = (menu) => {
    const open = document.querySelector(".pd-menu > .label-wrap.open");
    if (open && (open !== label(rested) || menu === rested)) return; // it was pressed, or the mouse is on it again
    open?.click();
    rested = menu;
    label(menu)?.click();
  };
  document.addEventListener("pointerover", ({ pointerType, target }) => {
    const menu = pointerType === "mouse" ? target.closest(".pd-menu") : null;
    clearTimeout(soon);
    if (menu !== closed) closed = null;
    if (menu !== closed || !menu) soon = setTimeout(rest, 200, menu);
  });
  document.addEventListener("click", (event) => {
    const menu = event.isTrusted && event.target.closest(".pd-menu");
    if (!menu) return;
    const shuts = label(menu).contains(event.target) && label(menu).classList.contains("open");
    if (shuts && menu === rested) event.stopPropagation();
    else if (shuts) closed = menu;
    rested = null;
  }, { capture: true });
  document.addEventListener("keydown", ({ key }) => {
    if (key === "Escape") [closed, rested] = [rested, null];
  }, { capture: true });
}
</script>"""


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
