"""Sentences that name an act of a lab's own folder: the network reads the act's caption."""

from __future__ import annotations

from pathlib import Path

import pytest

from webdemo.inference.requests import GenerateRequest
from webdemo.inference.story.sentences import as_scene

OLLIE = '[ollie]\nframes = ["{a} ollie"]\ncaption = ["{a} [jump]"]\nreads = ["She ollies."]\n'


@pytest.fixture(autouse=True)
def _with_ollie(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "own.toml").write_text(OLLIE)
    monkeypatch.setenv("PASDEDEUX_ACTS", str(tmp_path))


def test_the_network_reads_the_caption_of_the_act() -> None:
    scene = as_scene(GenerateRequest(prompt="She ollies."))
    assert scene is not None and [beat.sentence for beat in scene.beats] == ["Person A jumps."]


def test_more_acts_than_the_seconds_have_room_for_share_a_beat() -> None:
    scene = as_scene(GenerateRequest(prompt="She ollies, then he waves, then she bows, then he ollies.", seconds=1))
    assert scene is not None and len(scene.beats) == 1
    assert {act.act for act in scene.beats[0].acts} == {"ollie", "wave", "bow"}


@pytest.mark.parametrize("prompt", ["Two people hug.", "She does not ollie."])
def test_other_sentences_keep_their_words(prompt: str) -> None:
    scene = as_scene(GenerateRequest(prompt=prompt))
    assert scene is None or all("jump" not in beat.sentence for beat in scene.beats)
