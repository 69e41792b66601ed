"""Requests whose words name an act of the lab's own follow the plan of these words."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from acts import config
from acts.config import look_again
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.requests.acting import acted
from webdemo.inference.story.sentences import as_scene

OLLIE = '[ollie]\nframes = ["{a} ollie"]\ncaption = ["{a} [jump]"]\nreads = ["She ollies."]\n'


@pytest.fixture
def with_ollie(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    (tmp_path / "own.toml").write_text(OLLIE)
    monkeypatch.setattr(config, "LOOK_EVERY", 0.0)
    monkeypatch.setenv("PASDEDEUX_ACTS", str(tmp_path))
    yield
    monkeypatch.undo()
    look_again()


@pytest.mark.usefixtures("with_ollie")
def test_the_network_reads_the_caption_of_the_act() -> None:
    asked = acted(GenerateRequest(prompt="She ollies."))
    assert asked.acts is not None and [act.act for act in asked.acts.acts] == ["ollie"]
    assert asked.prompt == "She ollies."
    scene = as_scene(asked)
    assert scene is not None and [beat.sentence for beat in scene.beats] == ["Person A jumps."]


@pytest.mark.usefixtures("with_ollie")
def test_more_acts_than_the_seconds_have_room_for_share_a_beat() -> None:
    asked = acted(GenerateRequest(prompt="She ollies, then he waves, then she bows, then he ollies.", seconds=1))
    scene = as_scene(asked)
    assert scene is not None and len(scene.beats) == 1
    assert {act.act for act in scene.beats[0].acts} == {"ollie", "wave", "bow"}


@pytest.mark.usefixtures("with_ollie")
@pytest.mark.parametrize(
    "fields",
    [
        {"prompt": "Two people hug."},
        {"prompt": "She does not ollie."},
        {"prompt": "She ollies.", "split": False},
        {"prompt": "She ollies.", "planned": False},
    ],
)
def test_other_requests_follow_no_acts(fields: dict[str, object]) -> None:
    assert acted(GenerateRequest(**fields)).acts is None  # type: ignore[arg-type]


def test_without_acts_of_ones_own_nothing_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("webdemo.inference.requests.acting.directed", None)
    request = GenerateRequest(prompt="She ollies.")
    assert acted(request) is request
