"""The endpoints as a program on another machine meets it."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gradio_client import Client, handle_file
from gradio_client.exceptions import AppError
from PIL import Image

from motion import InputError
from motion.formats import read
from tests.motion.bodies import marching
from tests.motion.formats.characters import glb_takes
from webdemo.inference.methods import method
from webdemo.ui.components import film
from webdemo.ui.components.exports import Shelf
from webdemo.ui.page import build_page, launch_options

from .stub_engine import StubEngine, walking
from .stub_page import stub_context

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("own_temporary")]


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    page = build_page(stub_context(StubEngine(), tmp_path_factory.mktemp("files")))
    _, url, _ = page.launch(prevent_thread_lock=True, quiet=True, server_name="127.0.0.1", **launch_options())
    yield Client(url, verbose=False, download_files=str(tmp_path_factory.mktemp("client")))
    page.close()


def generate(client: Client, **fields: Any) -> Any:
    return client.predict(api_name="/generate", **fields)


def test_generate_gives_a_manifest_and_files_that_can_be_read(client: Client) -> None:
    answer, files = generate(client, prompt="two people walk", seconds=2, seed=5, steps=3, samples=2)
    assert answer["manifest"]["request"]["seed"] == 5
    assert len(answer["readouts"]) == 2
    by_name = {Path(path).name: Path(path) for path in files}
    assert set(by_name) == {name for names in answer["files"].values() for name in names}
    (plain,) = (Path(name).stem for name in by_name if name.endswith(".json"))
    assert plain.startswith("two-people-walk-seed5-")
    with np.load(by_name[f"{plain}-2.npz"], allow_pickle=False) as saved:
        assert saved["positions"].shape == (2, 60, 22, 3)
    assert json.loads(by_name[f"{plain}.json"].read_text())["request"]["steps"] == 3
    assert by_name[f"{plain}-1_a.bvh"].read_text().startswith("HIERARCHY")


def test_a_class_is_enough_too(client: Client) -> None:
    answer, files = client.predict("shake hands", api_name="/generate_class")
    asked = answer["manifest"]["request"]
    assert (asked["model"], asked["prompt"], asked["guidance"]) == ("bigraphdiff", "shake hands", 1.8)
    assert asked["steps"] == method("bigraphdiff").steps == 50
    assert any(re.fullmatch("shake-hands-seed0-[0-9a-f]{4}.npz", Path(path).name) for path in files)


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"prompt": "x" * 10_000}, "The prompt has 10,000 characters: shorten it to 500 or fewer."),
        ({"prompt": "x", "seed": 1.5}, "Seed must be a whole number from 0 to 4,294,967,295, not 1.5."),
        ({"prompt": "crash"}, "Something went wrong inside the program (RuntimeError); its log says more. Try again."),
    ],
)
def test_errors_are_the_requests_own_sentences(client: Client, fields: dict[str, Any], sentence: str) -> None:
    with pytest.raises(AppError) as caught:
        generate(client, **fields)
    assert str(caught.value) == sentence
    generate(client, prompt="two people walk", steps=1, seconds=1)


def test_a_scene_without_a_story_is_one_sentence(client: Client) -> None:
    with pytest.raises(AppError, match="is empty"):
        client.predict(story=None, api_name="/scene")


def test_the_endpoint_is_documented(client: Client) -> None:
    endpoint = client.view_api(return_format="dict", print_info=False)["named_endpoints"]["/generate"]
    parameters = {p["parameter_name"]: p for p in endpoint["parameters"]}
    takes = "prompt seconds seed samples guidance steps damping sampler model tries"
    assert list(parameters) == takes.split()
    assert all(p["parameter_has_default"] for name, p in parameters.items() if name != "prompt")
    assert "two-person .npz" in endpoint["description"]


def test_react_takes_a_file_and_gives_files(client: Client, walkers: Path) -> None:
    answer, files = client.predict(actor=handle_file(walkers), person="b", start=1, end=3, steps=2, api_name="/react")
    assert answer["manifest"]["request"]["actor"]["name"] == "walkers.npz"
    motion = next(Path(path) for path in files if path.endswith(".npz"))
    assert re.fullmatch("reaction-to-walkers-seed0-[0-9a-f]{4}.npz", motion.name)
    np.testing.assert_array_equal(read(motion).a.positions, walking(12.0).b.positions[30:90])


def test_one_animation_of_several_is_chosen_and_noted(client: Client, walkers: Path) -> None:
    positions, rotations = marching(60)
    robot = walkers.with_name("takes.glb")
    robot.write_bytes(glb_takes(rotations, positions[:, 0], ["walk", "glide"]))
    note = "Of the 2 animations in takes.glb, {} was taken; the other is {}."
    for fields, taken, other in (
        ({}, "1 (“walk”)", "2 (“glide”)"),
        ({"animation": "glide"}, "2 (“glide”)", "1 (“walk”)"),
    ):
        answer, _ = client.predict(actor=handle_file(robot), steps=2, api_name="/react", **fields)
        assert answer["notes"][0] == note.format(taken, other)
    with pytest.raises(AppError, match="no such animation"):
        client.predict(past=handle_file(robot), marker=0, animation="run", api_name="/predict")
    with pytest.raises(AppError, match="no such animation"):
        client.predict(motion=handle_file(robot), kind="png", animation="run", api_name="/render")
    with pytest.raises(AppError, match="no such animation"):
        client.predict(story="They bow.", motion=handle_file(robot), animation="run", api_name="/scene")


def test_render_films_a_motion_file(
    client: Client, walkers: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    path = client.predict(motion=handle_file(walkers), kind="gif", width=96, height=64, fps=5, api_name="/render")
    with Image.open(path) as picture:
        assert picture.size == (96, 64) and picture.n_frames == 60
    sheet = client.predict(motion=handle_file(walkers), kind="pdf", look="skeletons", api_name="/render")
    assert Path(sheet).read_bytes().startswith(b"%PDF")
    for fields, sentence in (
        ({"kind": "avi"}, "Films end in"),
        ({"width": 5000}, "ask for less"),
        ({"motion": None}, "no motion"),
    ):
        with pytest.raises(AppError, match=sentence):
            client.predict(api_name="/render", **({"motion": handle_file(walkers)} | fields))
    small = {"motion": handle_file(walkers), "width": 96, "height": 64, "fps": 5, "api_name": "/render"}
    client.predict(kind=f"x{'/..' * 20}{tmp_path}/elsewhere.gif", **small)
    assert not list(tmp_path.iterdir())
    with monkeypatch.context() as full:
        full.setattr(Shelf, "folder", lambda *_: (_ for _ in ()).throw(InputError("There is no room.")))
        with pytest.raises(AppError, match=r"There is no room\."):
            client.predict(kind="gif", **small)
    monkeypatch.setattr(film, "DRAWN_IN", 0.0)
    with pytest.raises(AppError, match="were drawn in"):
        client.predict(motion=handle_file(walkers), kind="gif", width=96, height=64, fps=5, api_name="/render")
