"""A folder of pages in a .zip: a gallery and a page for each result, which play from a disk without a network.

A browser lets no page that it opened from a disk load modules or fetch files. So the modules are in one plain script,
as addresses that hold their source, and the bodies in another.
"""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path, PurePosixPath
from posixpath import normpath

from motion.formats.files import replacing
from webdemo.ui.history import Opened
from webdemo.ui.text.texts import languages

from .public_html import FILES, SHARE_FOLDER, Place, gallery_html, payload_of, player_html

ROOT = "pas-de-deux/"
"""Before the names of the modules, so that they resolve by the page's map alone."""
_IMPORT = re.compile(r"""(\bfrom\s*+|\bimport\s*+\(?\s*+)(["'])(\.{1,2}/[^"']+)\2""")
_SCRIPTS = '<script src="@files@bodies.js"></script>\n<script src="@files@offline.js"></script>'
_PLAIN = ("plotly.min.js", "share/share.css", "player/player.css")
_PLACE = Place(files="files/", scripts=_SCRIPTS)
READ_ME = "Open index.html in a browser. Everything that the pages need is in this folder.\n"
FILES_BYTES = 2 * 2**20
"""About how many bytes the files weigh that every such .zip holds, when packed."""


def write_site(results: Sequence[Opened], file: Path, *, title: str) -> None:
    """Writes the pages of results into a .zip file.

    Args:
        results: at least one, in their order.
        file: to be written; no half of it is left where that fails.
        title: of the gallery.
    """
    entries = {number: opened.entry for number, opened in enumerate(results, start=1)}
    names = {number: f"{number}.html" for number in entries}
    back = Place(files=_PLACE.files, scripts=_SCRIPTS, back="index.html")
    with replacing(file) as temporary, zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("READ ME.txt", READ_ME)
        archive.writestr("index.html", gallery_html(title, entries, names, _PLACE, until=None))
        for number, opened in enumerate(results, start=1):
            page = player_html(opened.entry, payload_of(opened), back, until=None)
            archive.writestr(names[number], page)
        archive.writestr("files/offline.js", offline_script())
        archive.writestr("files/bodies.js", _bodies())
        for name in _PLAIN:
            archive.write(FILES[name], f"files/{name}")


@cache
def offline_script() -> str:
    """One plain script that makes a map of all modules, brings their texts along and starts ``share/share.js``."""
    modules: dict[str, str] = {}
    waiting = ["share/share.js"]
    while waiting:
        name = waiting.pop()
        if name not in modules:
            modules[name] = FILES[name].read_text(encoding="utf-8")
            waiting += [_beside(name, found[3]) for found in _IMPORT.finditer(modules[name])]
    whole = {ROOT + name: _named(name, source) for name, source in modules.items()}
    start = (SHARE_FOLDER / "offline.js").read_text(encoding="utf-8")
    texts = json.dumps(_texts(), ensure_ascii=False)
    return (
        f"globalThis.pasDeDeuxModules = {json.dumps(whole)};\nglobalThis.pasDeDeuxTexts = {texts};\n{start}"
    )


def _texts() -> dict[str, dict[str, str]]:
    """The texts of the player and of the pages around it, in every language."""
    return {
        language: {key: text for key, text in texts.items() if key.startswith(("player.", "share."))}
        for language, texts in languages().items()
    }


def _named(module: str, source: str) -> str:
    """A module's source whose imports name the modules of the map."""
    return _IMPORT.sub(lambda found: f'{found[1]}"{ROOT}{_beside(module, found[3])}"', source)


def _beside(module: str, path: str) -> str:
    return normpath((PurePosixPath(module).parent / path).as_posix())


@cache
def _bodies() -> str:
    bodies = {
        PurePosixPath(name).stem: json.loads(path.read_text(encoding="utf-8"))
        for name, path in FILES.items()
        if name.startswith("bodies/")
    }
    return f"globalThis.pasDeDeuxBodies = {json.dumps(bodies, separators=(',', ':'))};\n"
