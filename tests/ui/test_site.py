"""A folder of pages: everything that they load is in it, under names that they use."""

from __future__ import annotations

import json
import re
import zipfile
from pathlib import Path

import pytest

from motion import InputError
from tests.ui.stub_engine import StubEngine
from webdemo.inference.requests import GenerateRequest
from webdemo.ui.history import Entry, Opened
from webdemo.ui.public_html import FILES
from webdemo.ui.site import ROOT, offline_script, write_site
from webdemo.ui.text.texts import languages

TITLE = "<i>Two</i> @files@ people"


def opened(title: str = TITLE) -> Opened:
    request = GenerateRequest(prompt=title, seconds=1.0, steps=1)
    *_, result = StubEngine().run(request)
    entry = Entry(
        id="r", kind="generate", title=title, state="done", request=request.to_dict(), note="private"
    )
    return Opened(entry=entry, result=result)


def modules() -> dict[str, str]:
    first = offline_script().split("\n", 1)[0]
    return json.loads(first.removeprefix("globalThis.pasDeDeuxModules = ").removesuffix(";"))


def test_every_import_of_the_offline_modules_is_among_them() -> None:
    found = modules()
    assert f"{ROOT}player/main.js" in found and len(found) > 25
    wanted = {
        name for source in found.values() for name in re.findall(r'(?:from|import)\s*\(?\s*"([^"]+)"', source)
    }
    assert wanted and wanted <= found.keys()
    assert not [name for name, source in found.items() if re.search(r"""from\s+["']\.""", source)]
    outside = {name for name, source in found.items() if "import.meta.url" in source}
    supplied = {f"{ROOT}player/main.js", f"{ROOT}player/loader.js", f"{ROOT}texts.js"}
    assert outside <= supplied, "an address that holds it has no folder"


def test_the_offline_pages_bring_the_texts_of_the_player_in_every_language() -> None:
    second = offline_script().split("\n", 2)[1]
    texts = json.loads(second.removeprefix("globalThis.pasDeDeuxTexts = ").removesuffix(";"))
    assert texts["en"]["player.front"] == "Front" and texts["de"]["player.front"] == "Vorn"
    named = {
        key
        for name, source in modules().items()
        if name.startswith((f"{ROOT}player/", f"{ROOT}share/"))
        for key in re.findall(r'"((?:[a-z]+)\.[a-z_]+)"', source)
        if key in languages()["en"]
    }
    assert len(named) > 30 and named <= texts["de"].keys() == texts["en"].keys()


def test_a_folder_has_a_page_for_each_result_and_every_file_that_they_name(tmp_path: Path) -> None:
    file = tmp_path / "pages.zip"
    write_site([opened(), opened("They bow.")], file, title=TITLE)
    with zipfile.ZipFile(file) as archive:
        names = set(archive.namelist())
        pages = {name: archive.read(name).decode() for name in names if name.endswith(".html")}
        bodies = archive.read("files/bodies.js").decode()
    assert set(pages) == {"index.html", "1.html", "2.html"}
    for page in pages.values():
        loaded = re.findall(r'(?:src|href|data-plotly|data-player-style)="([^"]+)"', page)
        assert {name for name in loaded if name != "data:,"} <= names
        assert "private" not in page and "<i>" not in page and "http" not in page
    assert "&lt;i&gt;Two&lt;/i&gt; @files@ people" in pages["index.html"]
    supplied = json.loads(bodies.removeprefix("globalThis.pasDeDeuxBodies = ").removesuffix(";\n"))
    assert set(supplied) == {Path(name).stem for name in FILES if name.startswith("bodies/")}


def test_a_folder_that_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "no").write_text("a file")
    with pytest.raises(InputError, match="could not be written"):
        write_site([opened()], tmp_path / "no" / "pages.zip", title="x")
    assert [path.name for path in tmp_path.iterdir()] == ["no"]
