"""Files and films of a result, as every tab offers them."""

from __future__ import annotations

import json
import re
import threading
import zipfile
from pathlib import Path
from typing import Any

import av
import gradio as gr
import pytest

from tests.ui.tab_events import built
from tests.ui.tabs.generating import result_of
from webdemo.inference.run import Cancelled
from webdemo.ui.components.exports import KINDS, file_name, for_download, offered, write_files
from webdemo.ui.components.film import link_address, make_film
from webdemo.ui.tabs import results
from webdemo.ui.tabs.generate import GenerateTab
from webdemo.view.stage import Style


@pytest.fixture
def tab(tmp_path: Path) -> GenerateTab:
    return built(GenerateTab, tmp_path)


def test_files_of_one_sample(tab: GenerateTab, tmp_path: Path) -> None:
    record = result_of(tab)
    files = write_files(record.result, tab.page.shelf.folder(), prompt=record.prompt)
    name = file_name("two people walk", record.result.manifest)
    assert name.startswith("two-people-walk-seed3-")
    assert {path.name for path in files["bvh"]} == {f"{name}_a.bvh", f"{name}_b.bvh"}
    assert json.loads(files["json"][0].read_text())["request"]["seed"] == 3
    found = for_download(files)
    assert found["npz"].suffix == ".npz"
    assert zipfile.ZipFile(found["bvh"]).namelist() == [path.name for path in files["bvh"]]


def test_export_fills_the_buttons_with_files_that_are_written_once(tab: GenerateTab) -> None:
    record = result_of(tab)
    first = tab.results.export(record)
    written = {kind for kind in KINDS if offered(kind)}
    filled = {kind for kind, update in zip(KINDS, first[1:], strict=True) if update["interactive"]}
    assert filled == written
    assert tab.results.export(record) == first
    assert all(update == gr.skip() for update in tab.results.export(None))


def test_a_full_disk_is_reported_and_leaves_nothing(tab: GenerateTab, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: Any, **__: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("webdemo.ui.components.exports.write_sheet", full)
    line, *buttons = tab.results.export(result_of(tab))
    assert "The disk is full" in line
    assert not any(button["interactive"] for button in buttons)
    assert list(tab.page.shelf.root.glob("run-*")) == []


@pytest.mark.parametrize("shown", ["{}", "no json", '{"yaw": 1e999, "look": "none", "sample": 9, "view": null}'])
def test_a_film_shows_the_last_result(tab: GenerateTab, monkeypatch: pytest.MonkeyPatch, shown: str) -> None:
    monkeypatch.setattr("webdemo.ui.components.film.film.SIZE", (96, 64))
    (_, busy, _), *_, (_, _, button) = tab.results.draw("result.film", result_of(tab, seconds=1.0), shown)
    assert busy["value"].endswith(" %")
    with av.open(str(button["value"])) as opened:
        assert sum(1 for _ in opened.decode(video=0)) == 30


def test_a_drawing_ends_with_the_page_that_asked_for_it(tab: GenerateTab, monkeypatch: pytest.MonkeyPatch) -> None:
    """Gradio closes an event's iterator on its event loop: it must not wait for the drawing."""
    left, over = threading.Event(), threading.Event()
    ended: list[BaseException] = []

    def drawn(*given: Any) -> Path:
        left.wait(10)
        try:
            given[-1](1, 2)
        except BaseException as error:
            ended.append(error)
        over.set()
        return Path()

    monkeypatch.setitem(results.DRAWN, "result.film", drawn)
    drawing = tab.results.draw("result.film", result_of(tab), "{}")
    next(drawing)
    drawing.close()
    left.set()
    assert over.wait(10)
    assert isinstance(ended[0], Cancelled)


def test_a_film_is_what_the_player_shows(tab: GenerateTab, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: dict[str, Any] = {}
    monkeypatch.setattr("webdemo.ui.components.film.film.write_film", lambda *_, **options: asked.update(options))
    shown = {"yaw": 1.5, "elevation": 9, "view": "top", "follow": False, "look": "both", "theme": "dark"}
    record = result_of(tab)
    make_film(record, json.dumps(shown), tab.page.shelf.folder())
    assert (asked["yaw"], asked["elevation"], asked["view"], asked["follow"]) == (1.5, 1.5, "top", False)
    assert asked["style"] == Style(look="both", theme="dark")
    assert asked["title"] == "two people walk"


@pytest.mark.parametrize(
    ("prompt", "expected"),
    [
        ("Two people shake hands!", "two-people-shake-hands-seed7"),
        ("../../etc/passwd", "etc-passwd-seed7"),
        ("你好 🕺", "motion-seed7"),
        ("<img onerror=x>", "img-onerror-x-seed7"),
        ("word " * 100, "word-word-word-word-word-word-word-word-seed7"),
    ],
)
def test_file_names_are_plain(prompt: str, expected: str) -> None:
    name, _, digest = file_name(prompt, {"request": {"seed": 7}}).rpartition("-")
    assert re.fullmatch("[0-9a-f]{4}", digest)
    assert name == expected or (prompt.startswith("word") and len(name) <= 56 and name.endswith("-seed7"))


def test_runs_that_differ_have_files_that_differ_in_name() -> None:
    asked = {"seed": 7, "guidance": 2.5, "steps": 50}
    manifests = [{"request": asked}, {"request": asked | {"guidance": 3.0}}, {"request": asked, "model": "other"}]
    manifests.append({"request": asked, "weights_sha256": "other"})
    names = [file_name("hug", manifest) for manifest in manifests]
    assert len(set(names)) == 4 and file_name("hug", dict(manifests[0])) == names[0]


@pytest.mark.parametrize("shown", ["[" * 2000, f'{{"frame": {"9" * 400}, "yaw": NaN}}', '{"frame": 1e999}', "{", "7"])
def test_a_link_has_of_a_player_only_what_can_be_used(shown: str) -> None:
    address = link_address("http://lab/", "k", shown)
    assert "yaw" not in address and len(address) < 60
