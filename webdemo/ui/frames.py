"""What the page's document says before Gradio's own script runs, where its ``head`` option cannot put anything.

* The player's scripts are part of the document, and the example plays while Gradio's load, where Gradio will put it.
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

from .bundle import bundled
from .components.finder import Finder
from .components.gallery import Gallery
from .components.player import PLOTLY_JS, MotionPlayer
from .components.reading import Reading
from .theme import COLOURS

PAGE = "frontend/index.html"
FIRST = (MotionPlayer, Reading, Finder, Gallery)
"""The parts of the page that are seen first."""
_FILE = "{{ (config.get('root') or '').rstrip('/') }}{{ config.get('api_prefix', '/gradio_api') }}/file="
_BEGIN = r"""<link rel="preload" as="script" href="%(plotly)s">
<style>%(colours)s
body { background: var(--pd-bg) !important; }
body .gradio-container { overflow: clip !important; } /* hidden, it would keep the stage from sticking */
.pdd:not(.pdd-styled), .pdd-early:has(> .pdd:not(.pdd-styled)),
body .gradio-container > .main > .wrap:has(> .loading) { visibility: hidden; }
</style>
<script>
(() => {
  const ask = window.requestAnimationFrame.bind(window);
  const counts = /^\(\)\s*=>\s*\{\s*[\w$]+\(\s*[\w$]+,\s*\(performance\.now\(\)\s*-/;
  window.requestAnimationFrame = (draw) => counts.test(draw) ? 0 : ask(draw);
  const unlike = Object.create(Object.prototype);
  for (const each of window.gradio_config.dependencies ?? []) Object.setPrototypeOf(each, unlike);
})();
</script>"""
_PLAY = """<script>{%% raw %%}%(modules)s{%% endraw %%}
window.pdModules["%(player)s"].begin(window.gradio_config);</script>"""


def _address(path: Path) -> str:
    """Jinja's for the address of a file, as a part's script makes it."""
    return _FILE + quote(path.as_posix())


def begin_early() -> None:
    """Adds these to the pages that this process serves; a second call does nothing."""
    loader = templates.env.loader
    if loader is not None and not isinstance(loader, ChoiceLoader):
        page, *_ = loader.get_source(templates.env, PAGE)
        begin = _BEGIN % {"plotly": _address(PLOTLY_JS), "colours": COLOURS.read_text(encoding="utf-8")}
        scripts = [part.template.parent / part.module for part in FIRST]
        modules = bundled(scripts, lambda path: f"{{% endraw %}}{_address(path)}{{% raw %}}")
        play = _PLAY % {"modules": modules, "player": _address(scripts[0])}
        page = page.replace("</head>", f"{begin}</head>", 1).replace("</body>", f"{play}</body>", 1)
        templates.env.loader = ChoiceLoader([DictLoader({PAGE: page}), loader])
