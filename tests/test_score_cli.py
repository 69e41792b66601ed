"""The command ``score``: requests as a user's, or the sentences as they are."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from acts import read
from acts.staging.given import Story
from acts.staging.stage import scores_of
from acts.staging.window import KnownPath, Window
from motion import InputError
from motion.metrics.sentences import load_sentences
from motion.transforms import Placement
from webdemo import cli
from webdemo.cli.scoring import Scoring, _folder
from webdemo.inference import GenerateRequest
from webdemo.inference.ablations import leave_places
from webdemo.inference.story.sentences import as_scene

SENTENCE = next(s for s in load_sentences() if s.id == "shake-part")


def test_sentences_are_made_as_on_the_page_or_plain(tmp_path: Path) -> None:
    page, plain = (Scoring("intergen", 5, 4.3, 0.7, plain=as_they_are) for as_they_are in (False, True))
    asked = page.request(SENTENCE, 1, None)
    assert isinstance(asked, GenerateRequest) and as_scene(asked) is not None
    as_is = plain.request(SENTENCE, 1, None)
    assert isinstance(as_is, GenerateRequest) and as_scene(as_is) is None and not as_is.planned
    alone = Scoring("intergen", 5, 4.3, 0.7, planned=False).request(SENTENCE, 1, None)
    assert isinstance(alone, GenerateRequest) and (scene := as_scene(alone)) is not None
    assert len(scene.beats) > 1 and not scene.planned
    kept = [_folder(tmp_path, scoring, "weights") for scoring in (page, plain)]
    assert kept[0] is not None and kept[1] is not None and kept[0].folder != kept[1].folder


def test_of_a_plan_the_places_are_left() -> None:
    pipeline = SimpleNamespace(name="intergen", scenes=SimpleNamespace(planner=None))
    leave_places(pipeline)
    story = Story(scores_of([read("A walks up to B and waves.").acts]), [4.0], [0, 120], seed=0)
    placement = Placement(np.eye(3), np.zeros(3), np.zeros(3))
    parts = pipeline.scenes.planner(story, Window(0, 0, 0, 120), np.zeros((2, 120, 22, 3)), placement, ())
    assert parts and all(isinstance(part, KnownPath) for part in parts)
    with pytest.raises(InputError, match="leave --places out"):
        leave_places(SimpleNamespace(name="regennet"))


def test_motions_are_not_kept_where_no_digest_names_the_weights(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    blank = SimpleNamespace(pipeline=lambda _: SimpleNamespace(digest=""))
    monkeypatch.setattr("webdemo.inference.engine.Engine", lambda: blank)
    assert cli.main(["score", "--motions", str(tmp_path)]) == 2
    assert "leave --motions out" in capsys.readouterr().err
