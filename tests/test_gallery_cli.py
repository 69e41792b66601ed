"""The examples of the page are made anew by one command."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import pytest

from motion import Duet
from tests.e2e.harness import walking_duet
from webdemo.cli import gallery, main
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.run import Result
from webdemo.ui.components.gallery import SCENES

WANTED = {"prompt": "Two friends hug.", "seconds": 4.0, "seed": 3}


def made_by(asked: list[Any]) -> Any:
    """A run that notes its request and succeeds with the next seed."""

    def run(request: GenerateRequest) -> Result:
        asked.append(request)
        duet = walking_duet()
        assert isinstance(duet, Duet)
        return Result(duets=(duet,), readouts=(), manifest={"tries": {"seed": request.seed + 1}})

    return run


def test_the_command_keeps_the_seed_that_did_it_and_a_thumbnail(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[GenerateRequest] = []
    monkeypatch.setattr(gallery, "run", made_by(asked))
    path = tmp_path / "scenes.json"
    path.write_text(json.dumps({"scenes": [WANTED]}), encoding="utf-8")
    assert main(["gallery", str(path)]) == 0
    (scene,) = json.loads(path.read_text(encoding="utf-8"))["scenes"]
    assert (asked[0].prompt, asked[0].seconds, asked[0].seed, asked[0].tries) == ("Two friends hug.", 4.0, 3, 4)
    assert scene["seed"] == 4 and base64.b64decode(scene["thumbnail"])[:2] == bytes([2, 20])


def test_a_file_without_scenes_is_refused_in_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scenes.json"
    path.write_text("{}", encoding="utf-8")
    assert main(["gallery", str(path)]) == 2
    assert "holds no scenes" in capsys.readouterr().err


def test_there_are_twenty_four_small_examples() -> None:
    scenes = json.loads(SCENES.read_text(encoding="utf-8"))["scenes"]
    assert len({scene["prompt"] for scene in scenes}) == 24
    assert SCENES.stat().st_size < 64_000
