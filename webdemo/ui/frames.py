"""Stops an animation that Gradio leaves running in every page, so that a page left open lets the browser sleep.

Gradio's loading screen counts its seconds in each frame the screen draws, and goes on when the page has come and the
screen is gone. What is refused here is that request for a frame alone, recognised by its text; where another release
of Gradio words it differently, nothing changes. The script must stand before Gradio's own, where its ``head`` option
cannot put it, so it is added to the template.
"""

from __future__ import annotations

from gradio.routes import templates
from jinja2 import ChoiceLoader, DictLoader

PAGE = "frontend/index.html"
SCRIPT = r"""<script>
(() => {
  const ask = window.requestAnimationFrame.bind(window);
  const counts = /^\(\)\s*=>\s*\{\s*[\w$]+\(\s*[\w$]+,\s*\(performance\.now\(\)\s*-/;
  window.requestAnimationFrame = (draw) => counts.test(draw) ? 0 : ask(draw);
})();
</script>"""


def let_rest() -> None:
    """Adds the script to the pages that this process serves; a second call does nothing."""
    loader = templates.env.loader
    if loader is not None and not isinstance(loader, ChoiceLoader):
        page, *_ = loader.get_source(templates.env, PAGE)
        ours = DictLoader({PAGE: page.replace("<head>", f"<head>{SCRIPT}", 1)})
        templates.env.loader = ChoiceLoader([ours, loader])
