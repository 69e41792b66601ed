"""What the page's handlers do, without a browser."""

from __future__ import annotations

import json
import os
import re
import threading
import time
import zipfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")

import av
import gradio as gr

from motion.character import character_body
from motion.formats.glb_reader import read_character
from tests.motion.formats.characters import glb_character, unpacked
from tests.motion.formats.rigs import RIGS
from tests.ui.stub_engine import StubEngine
from tests.ui.tab_events import built, changes
from webdemo.inference.cancel import CancelToken
from webdemo.inference.methods import method
from webdemo.inference.requests import Cancelled, GenerateRequest, Progress, Result
from webdemo.ui.components.exports import KINDS, Record, Shelf, Worn, file_name, for_download, write_files
from webdemo.ui.components.film import make_film
from webdemo.ui.page import build_page, watch_loading
from webdemo.ui.runs import Loader, Runs
from webdemo.ui.tabs.generate import GenerateTab
from webdemo.ui.tabs.job import PACE
from webdemo.ui.text.classes import installed_classes
from webdemo.ui.text.examples import EXAMPLES
from webdemo.view.stage import Style

FIELDS = {"prompt": "two people walk", "seconds": 2.0, "seed": 3, "samples": 1, "guidance": 2.5, "steps": 5,
          "damping": 0.7}  # fmt: skip


@pytest.fixture
def tab(tmp_path: Path) -> GenerateTab:
    return built(GenerateTab, tmp_path)


def run(tab: GenerateTab, **changed: Any) -> list[dict[str, Any]]:
    return [changes(tab.outputs, updates) for updates in tab.run("me", {**FIELDS, **changed})]


def result_of(tab: GenerateTab, **changed: Any) -> Record:
    return run(tab, **changed)[-1]["record"]


def test_a_run_ends_with_a_motion_readouts_and_a_record(tab: GenerateTab) -> None:
    steps = run(tab)
    assert steps[0]["go"]["interactive"] is False
    assert steps[0]["stop"]["interactive"] is True
    assert [button["interactive"] for button in tab.rest()] == [True, True, False]
    last = steps[-1]
    assert last["player"]["value"]["title"] == "two people walk"
    assert last["player"]["busy"] == ""
    assert "Foot skate" in last["readouts"]
    assert last["record"].result.manifest["request"]["seed"] == 3


def test_a_class_is_asked_for_in_place_of_a_sentence(tab: GenerateTab) -> None:
    last = run(tab, model="bigraphdiff", class_name="shake hands")[-1]
    assert last["player"]["value"]["title"] == "shake hands"
    assert last["record"].result.manifest["request"]["model"] == "bigraphdiff"
    unchosen = run(tab, model="bigraphdiff", class_name=None)[-1]
    assert "No class is chosen" in unchosen["line"] and "record" not in unchosen
    for way, sentence in (("intergen", True), ("bigraphdiff", False)):
        *shown, guidance, about = tab.asked_by(way)
        assert method(way).summary in about
        assert [update["visible"] for update in shown] == [sentence, not sentence]
        assert (
            guidance["value"] == GenerateRequest(prompt="x").guidance if sentence else guidance["value"] < 4
        )


def test_classes_are_those_of_the_weights(tmp_path: Path) -> None:
    names, card = installed_classes()
    assert "shake hands" in names and card["name"] == "bigraphdiff" and "summary" in card
    assert installed_classes(tmp_path) == ([], {})
    (tmp_path / "bigraphdiff").mkdir()
    (tmp_path / "bigraphdiff" / "config.json").write_text('{"model": []}')
    assert installed_classes(tmp_path) == ([], {})


def test_progress_is_true_and_paced(tab: GenerateTab) -> None:
    tab.page.engine.pause = 0.03
    began = time.monotonic()
    lines = [step["line"] for step in run(tab, steps=20)[1:-1]]
    assert any("step 1 of 20" in line for line in lines)
    stages = 3  # each is told at once
    assert 3 <= len(lines) <= stages + (time.monotonic() - began) / PACE


def test_cancel_ends_within_one_step_and_touches_no_result(tab: GenerateTab) -> None:
    engine = tab.page.engine
    engine.pause = 0.15
    updates = tab.run("me", {**FIELDS, "steps": 50})
    seen = [changes(tab.outputs, next(updates)) for _ in range(5)]
    assert tab.page.runs.cancel("me")
    rest = [changes(tab.outputs, update) for update in updates]
    done = engine.steps_done
    assert done < 10
    assert "Cancelled at step" in rest[-1]["line"]
    assert "of 50" in rest[-1]["line"]
    assert "record" not in rest[-1]
    assert "readouts" not in rest[-1]
    assert "step" in seen[-1]["line"]
    assert not tab.page.runs.cancel("me"), "nothing is left to cancel"


def test_every_update_of_a_run_says_what_lasts(tab: GenerateTab) -> None:
    tab.page.engine.pause = 0.1
    for step in run(tab):
        assert step["stop"] == gr.update(interactive=True)
        assert all(step[name] == gr.update(interactive=False) for name in tab.starts())


def test_a_run_is_cancelled_before_its_request_was_read(tab: GenerateTab) -> None:
    steps = tab.run("me", FIELDS)
    next(steps)
    tab.cancel(SimpleNamespace(session_hash="me"))
    assert "Cancelled before the first step." in changes(tab.outputs, list(steps)[-1])["line"]
    assert tab.page.engine.steps_done == 0
    assert "record" in run(tab)[-1], "the next run goes on"


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"prompt": "   "}, "The prompt is empty"),
        ({"prompt": "x" * 501}, "The prompt has 501 characters"),
        ({"seconds": 100.0}, "Length must be from 1 to 10 seconds"),
        ({"steps": 0}, "DDIM steps must be from 1 to 1000"),
        ({"steps": 2.5}, "DDIM steps must be a whole number"),
        ({"guidance": float("nan")}, "Guidance scale must be a number"),
        ({"damping": -0.1}, "Damping threshold must be from 0 to 1"),
        ({"seed": -1}, "Seed must be from 0"),
        ({"samples": 99}, "Samples must be from 1 to 8"),
        ({"prompt": "impossible"}, "The stub cannot do this"),
        ({"prompt": "crash"}, "Something went wrong inside the program (RuntimeError)"),
    ],
)
def test_errors_are_one_sentence_and_the_next_run_works(
    tab: GenerateTab, changed: dict[str, Any], sentence: str
) -> None:
    last = run(tab, **changed)[-1]
    assert sentence in last["line"]
    assert 'role="alert"' in last["line"]
    assert last["player"]["busy"] == ""
    assert "record" not in last
    assert "record" in run(tab)[-1]


def test_an_empty_seed_is_drawn_and_shown(tab: GenerateTab) -> None:
    class Visit:
        session_hash = "me"

    seeds = set()
    for _ in range(2):
        fields = {**FIELDS, "seed": None, "model": "intergen", "class_name": None}
        steps = tab.start({part: fields[name] for name, part in tab.controls.items()}, Visit())
        last = [changes(tab.outputs, step) for step in steps][-1]
        seed = last["record"].result.manifest["request"]["seed"]
        assert f"<dd>{seed}</dd>" in last["readouts"]
        seeds.add(seed)
    assert len(seeds) == 2


def test_a_second_run_waits_for_the_first_and_can_be_cancelled_in_the_line() -> None:
    engine = StubEngine(pause=0.05)
    runs = Runs(engine)
    request = GenerateRequest(prompt="two people walk", steps=20, seconds=1)
    first = runs.run("one", request)
    next(first)
    second = runs.run("two", request)
    assert next(second).stage == "queue"
    runs.cancel("two")
    with pytest.raises(Cancelled):
        list(second)
    assert isinstance(list(first)[-1], Result), "the first was not disturbed"
    assert isinstance(list(runs.run("two", request))[-1], Result)


def test_leaving_the_page_frees_the_place() -> None:
    runs = Runs(StubEngine())
    request = GenerateRequest(prompt="two people walk", seconds=1, steps=3)
    left = runs.run("gone", request)
    next(left)
    left.close()
    assert isinstance(list(runs.run("next", request))[-1], Result)


def test_a_new_run_of_a_session_cancels_its_earlier_one() -> None:
    runs = Runs(StubEngine(pause=0.01), parallel=2)
    request = GenerateRequest(prompt="two people walk", seconds=1, steps=200)
    earlier = runs.run("me", request)
    next(earlier)
    later = runs.run("me", request)
    next(later)
    with pytest.raises(Cancelled):
        list(earlier)
    assert next(later).stage == "sample", "the end of the earlier run does not stop the later one"


def test_cancel_token_is_seen_in_other_threads() -> None:
    token = CancelToken()
    seen = threading.Event()

    def loop() -> None:
        while not token.cancelled:
            time.sleep(0.005)
        seen.set()

    threading.Thread(target=loop, daemon=True).start()
    token.cancel()
    assert seen.wait(2)
    with pytest.raises(Cancelled):
        token.raise_if_cancelled()


def test_loading_is_shown_until_it_is_done_or_failed() -> None:
    marks = list(watch_loading(Loader(StubEngine(load=0.2)), interval=0.02))
    assert "Loading model" in marks[0]
    assert "Model ready" in marks[-1]

    class Broken(StubEngine):
        def warm_up(self) -> None:
            raise ValueError("The weights file is missing: run the download again.")

    marks = list(watch_loading(Loader(Broken(load=1)), interval=0.02))
    assert "The weights file is missing" in marks[-1]


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


def test_files_of_several_samples_are_zipped(tab: GenerateTab) -> None:
    record = result_of(tab, samples=2)
    found = for_download(write_files(record.result, tab.page.shelf.folder(), prompt=record.prompt))
    assert len(zipfile.ZipFile(found["npz"]).namelist()) == 2
    assert len(zipfile.ZipFile(found["bvh"]).namelist()) == 4


def test_export_fills_the_buttons_once(tab: GenerateTab) -> None:
    record = result_of(tab)
    first = tab.export(record)
    offered = {kind.key for kind in KINDS if kind.offered()}
    filled = {kind.key for kind, update in zip(KINDS, first[1:], strict=True) if update["interactive"]}
    assert filled == offered
    assert all(update == gr.skip() for update in tab.export(record))
    assert all(update == gr.skip() for update in tab.export(None))


def test_a_full_disk_is_reported_and_leaves_nothing(
    tab: GenerateTab, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: Any, **__: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("webdemo.ui.components.exports.write_sheet", full)
    line, *buttons = tab.export(result_of(tab))
    assert "The disk is full" in line
    assert not any(button["interactive"] for button in buttons)
    assert list(tab.page.shelf.root.glob("run-*")) == []


@pytest.mark.parametrize(
    "shown", ["{}", "no json", '{"yaw": 1e999, "look": "none", "sample": 9, "view": null}']
)
def test_a_film_shows_the_last_result(tab: GenerateTab, monkeypatch: pytest.MonkeyPatch, shown: str) -> None:
    monkeypatch.setattr("webdemo.ui.components.film.film.SIZE", (96, 64))
    (busy, _), (line, button) = tab.make_film(result_of(tab, seconds=1.0), shown)
    assert "Drawing" in busy and "The film is ready" in line
    with av.open(str(button["value"])) as opened:
        assert sum(1 for _ in opened.decode(video=0)) == 30


def test_a_film_is_what_the_player_shows(tab: GenerateTab, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: dict[str, Any] = {}
    monkeypatch.setattr(
        "webdemo.ui.components.film.film.write_film", lambda *_, **options: asked.update(options)
    )
    shown = {
        "yaw": 1.5,
        "elevation": 9,
        "view": "top",
        "follow": False,
        "trails": True,
        "look": "both",
        "theme": "dark",
    }
    record = result_of(tab)
    make_film(record, json.dumps(shown), tab.page.shelf.folder())
    assert (asked["yaw"], asked["elevation"], asked["view"], asked["follow"]) == (1.5, 1.5, "top", False)
    assert asked["style"] == Style(look="both", trails=True, theme="dark")
    assert asked["title"] == "two people walk"


@pytest.mark.parametrize("shown", [True, False, None, "yes"])
def test_a_film_wears_the_character_while_the_player_shows_it(
    tab: GenerateTab, monkeypatch: pytest.MonkeyPatch, shown: Any
) -> None:
    asked: dict[str, Any] = {}
    monkeypatch.setattr(
        "webdemo.ui.components.film.film.write_film", lambda *_, **options: asked.update(options)
    )
    record = result_of(tab)
    record.worn = Worn(character_body(read_character(glb_character(), name="x.glb")), Path("x.glb"))
    make_film(record, json.dumps({"character": shown}), tab.page.shelf.folder())
    assert asked["style"].body is (record.worn.body if shown is True else None)


def test_a_film_of_nothing_is_one_sentence(tab: GenerateTab) -> None:
    *_, (line, _) = tab.make_film(None, "{}")
    assert "make one first" in line


def test_old_folders_are_removed(tmp_path: Path) -> None:
    shelf = Shelf(tmp_path / "runs", max_age=60)
    old, new = shelf.folder(), shelf.folder()
    (old / "motion.npz").write_bytes(b"0")
    os.utime(old, (time.time() - 120,) * 2)
    shelf.folder()
    assert not old.exists()
    assert new.exists()


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
    manifests = [
        {"request": asked},
        {"request": asked | {"guidance": 3.0}},
        {"request": asked, "model": "other"},
    ]
    names = [file_name("hug", manifest) for manifest in manifests]
    assert len(set(names)) == 3 and file_name("hug", dict(manifests[0])) == names[0]


def test_examples_are_prompts_that_a_request_takes() -> None:
    for _, sentence in EXAMPLES:
        assert GenerateRequest(prompt=sentence).prompt == sentence


def test_the_page_imports_no_torch() -> None:
    import subprocess
    import sys

    code = "import sys, webdemo.ui.page; sys.exit('torch' in sys.modules or 'diffusers' in sys.modules)"
    root = Path(__file__).resolve().parents[3]
    assert subprocess.run([sys.executable, "-c", code], cwd=root, timeout=600).returncode == 0


def test_progress_events_of_other_stages_have_words(tab: GenerateTab) -> None:
    from webdemo.ui.text.words import progress_line

    for stage in ("load", "text", "finish", "queue", "something else"):
        assert progress_line(Progress(stage=stage)).endswith("…")


def test_build_page_offers_an_endpoint_a_job(tmp_path: Path) -> None:
    demo = build_page(StubEngine(), files=tmp_path)
    assert list(demo.get_api_info()["named_endpoints"]) == [
        "/predict",
        "/generate",
        "/generate_class",
        "/react",
        "/render",
        "/scene",
    ]


def test_both_wear_an_uploaded_character_in_this_result_and_the_next(
    tab: GenerateTab, tmp_path: Path
) -> None:
    file = tmp_path / "robot.glb"
    file.write_bytes(glb_character("unreal"))
    line, worn, player, *offered = tab.put_on(str(file), None)
    assert "Both wear robot.glb" in line and worn.body.zones == ("character",) and offered == [gr.skip()] * 2
    assert player["character"]["zones"] == ["character"] and player["character"]["id"]
    record = result_of(tab)
    _, *updates = tab.export(record, worn)
    later = [updates[[kind.key for kind in KINDS].index(key)]["value"] for key in ("glb", "png")]
    plain = Record(record.result, "two people walk")
    _, *bare = tab.export(Record(record.result, "two people walk"))
    _, _, _, *offered = tab.put_on(str(file), plain)
    assert all(each["interactive"] for each in offered) and plain.worn is not None
    sheets = [Path(path).read_bytes() for path in (later[1], offered[1]["value"])]
    stock = bare[[kind.key for kind in KINDS].index("png")]["value"]
    assert sheets[0] == sheets[1] != Path(stock).read_bytes(), "the contact sheet shows it, too"
    for path in (later[0], offered[0]["value"]):
        told = unpacked(Path(path).read_bytes())[0]
        names = [told["nodes"][joint]["name"] for joint in told["skins"][1]["joints"]]
        assert set(names) == set(RIGS["unreal"].values()), "on the character's own skeleton"


@pytest.mark.parametrize("content", [b"no character", glb_character()[:3000], glb_character(skins=[])])
def test_a_file_that_is_no_character_is_a_sentence(tab: GenerateTab, tmp_path: Path, content: bytes) -> None:
    (tmp_path / "x.glb").write_bytes(content)
    line, *rest = tab.put_on(str(tmp_path / "x.glb"), None)
    assert "pd-error" in line and "x.glb" in line and rest == [gr.skip()] * 4
