"""Folded parts of the page: as they suit the screen at first, then as the visitor left them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import gradio as gr

_KEPT = "pas-de-deux-folds"
"""The entry of the browser's storage that says which parts are open."""
_READ = f"""let kept = {{}};
  const narrow = matchMedia("(max-width: 960px)").matches;
  const key = (name) => name + (narrow ? " narrow" : "");
  try {{ kept = JSON.parse(localStorage.getItem("{_KEPT}")) ?? {{}}; }} catch {{ /* a browser may keep nothing */ }}"""


def _begin(names: list[str]) -> str:
    """JavaScript that opens and folds parts as the visitor left them; on a narrow screen all are folded at first."""
    return f"""() => {{
  {_READ}
  const open = (name) => (key(name) in kept ? {{ open: Boolean(kept[key(name)]) }} : narrow ? {{ open: false }} : {{}});
  return {json.dumps(names)}.map((name) => ({{ __type__: "update", ...open(name) }}));
}}"""


def _keep(name: str, *, is_open: bool) -> str:
    """JavaScript that notes that a part was opened or folded."""
    return f"""() => {{
  {_READ}
  kept[key({json.dumps(name)})] = {json.dumps(is_open)};
  try {{ localStorage.setItem("{_KEPT}", JSON.stringify(kept)); }} catch {{ /* nothing is kept then */ }}
}}"""


def remember_folds(demo: gr.Blocks, folds: Mapping[str, gr.Accordion], **quiet: Any) -> None:
    """Lets a browser remember which parts are open.

    Args:
        demo: the page.
        folds: the parts, by the names under which they are remembered.
        quiet: options of the page's own events.
    """
    for name, fold in folds.items():
        fold.expand(None, js=_keep(name, is_open=True), **quiet)
        fold.collapse(None, js=_keep(name, is_open=False), **quiet)
    demo.load(None, outputs=list(folds.values()), js=_begin(list(folds)), **quiet)
