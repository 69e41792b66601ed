"""The endpoint /scene, called as its job."""

from pathlib import Path

import gradio as gr
import numpy as np
import pytest

from motion.formats import read, write
from webdemo.inference.story import sentences
from webdemo.ui.api import SceneEndpoint

from .stub_engine import StubEngine, walking
from .stub_page import stub_context


@pytest.fixture
def endpoint(tmp_path: Path) -> SceneEndpoint:
    engine = StubEngine()
    return SceneEndpoint(stub_context(engine, tmp_path / "files"))


def test_sentences_and_toml_give_files(endpoint: SceneEndpoint) -> None:
    answer, files = endpoint.scene("Two people meet. Then they hug.", samples=2, seed=4)
    asked = answer["manifest"]["request"]
    assert [beat["words"] for beat in asked["beats"]] == ["Two people meet.", "They hug."]
    assert (asked["seed"], asked["samples"]) == (4, 2)
    assert sum(path.endswith(".npz") and ".smpl." not in path for path in files) == 2
    answer, _ = endpoint.scene('seed = 7\n[[beat]]\nwords = "They hug."\nseconds = 2\n')
    assert answer["manifest"]["request"]["seed"] == 7


def test_a_span_of_a_file_is_made_again(endpoint: SceneEndpoint, tmp_path: Path) -> None:
    (path,) = write(walking(5.0), tmp_path / "walk.npz")
    _, files = endpoint.scene("They wave.", str(path), start=1.0, end=3.0)
    made = read(Path(next(file for file in files if file.endswith(".npz"))))
    np.testing.assert_array_equal(made.positions[:, 90:], read(path).positions[:, 90:])


def test_errors_are_sentences(endpoint: SceneEndpoint, tmp_path: Path) -> None:
    (alone,) = write(walking(2.0).a, tmp_path / "alone.npz")
    for story, motion, sentence in (
        ("", None, "The story is empty"),
        ("[[beat]]\nwrods = 'x'\n", None, "Line 2: there is no key 'wrods' in a beat; did you mean 'words'?"),
        ("They wave.", str(alone), "alone.npz holds one person"),
    ):
        with pytest.raises(gr.Error, match=sentence):
            endpoint.scene(story, motion)


def test_a_story_is_read_in_limited_time(endpoint: SceneEndpoint, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sentences, "READING_SECONDS", 1e-9)
    with pytest.raises(gr.Error, match="took longer than 1e-09 seconds to read: shorten"):
        endpoint.scene("They meet. Then they hug.")
