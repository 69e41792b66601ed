"""What the page's document says before Gradio's own script runs, where its ``head`` option cannot put anything.

* The player's scripts load and make an empty 3D scene while Gradio's load, so that the example plays as soon as the
  page has a place for it.
* Gradio's events are no plain objects, so that Svelte, which watches whatever is plain, puts no proxy around each of
  their parts. Gradio looks through all of them for every component and changes none.
* An animation that Gradio leaves running is stopped, so that a page left open lets the browser sleep: its loading
  screen counts its seconds in each frame the screen draws, and goes on when the screen is gone. What is refused is that
  request for a frame alone, recognised by its text; where another release of Gradio words it differently, nothing
  changes.
"""

from __future__ import annotations

from pathlib import Path
from urllib.parse import quote

from gradio.routes import templates
from jinja2 import ChoiceLoader, DictLoader

from .components.player import PLAYER_FOLDER, PLOTLY_JS
from .text.texts import TEXTS_JS

PAGE = "frontend/index.html"
_FILE = "{{ (config.get('root') or '').rstrip('/') }}{{ config.get('api_prefix', '/gradio_api') }}/file="
_BEGIN = r"""%(modules)s<link rel="preload" as="script" href="%(plotly)s">
<script>
(() => {
  const ask = window.requestAnimationFrame.bind(window);
  const counts = /^\(\)\s*=>\s*\{\s*[\w$]+\(\s*[\w$]+,\s*\(performance\.now\(\)\s*-/;
  window.requestAnimationFrame = (draw) => counts.test(draw) ? 0 : ask(draw);
  const unlike = Object.create(Object.prototype);
  for (const each of window.gradio_config.dependencies ?? []) Object.setPrototypeOf(each, unlike);
})();
</script>
<script type="module">import("%(player)s").then((player) => player.warm());</script>"""


def _address(path: Path) -> str:
    """Jinja's for the address of a file, as a part's script makes it."""
    return _FILE + quote(path.as_posix())


def begin_early() -> None:
    """Adds these to the pages that this process serves; a second call does nothing."""
    loader = templates.env.loader
    if loader is not None and not isinstance(loader, ChoiceLoader):
        page, *_ = loader.get_source(templates.env, PAGE)
        modules = [TEXTS_JS, *sorted(PLAYER_FOLDER.rglob("*.js"))]
        links = "".join(f'<link rel="modulepreload" href="{_address(path)}">' for path in modules)
        named = {"plotly": _address(PLOTLY_JS), "player": _address(PLAYER_FOLDER / "main.js")}
        begin = _BEGIN % {"modules": links, **named}
        ours = DictLoader({PAGE: page.replace("</head>", f"{begin}</head>", 1)})
        templates.env.loader = ChoiceLoader([ours, loader])
