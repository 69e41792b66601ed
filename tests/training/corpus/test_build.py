"""A corpus from a few made-up recordings to classes of prepared scenes: motion, labels, captions, all anew."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from acts.reading import read
from models.motion_tokens import TokenLayout
from tests.training.corpus.test_compose import clips
from training.corpus import __main__ as command
from training.corpus import build, retell
from training.corpus.cues import Label, class_of
from training.prepare import prepare
from training.trainers.bigraphdiff import labels_of, of_classes

FAMILIES = ("wave-back", "ordered", "bow-back")


@pytest.fixture(scope="module")
def corpus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """72 seconds of three families."""
    folder = tmp_path_factory.mktemp("corpus")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "load_sources", lambda data: [*clips(), *clips("test")])
        words = ["--data", str(folder), "--out", str(folder), "--hours", "0.02", "--families", *FAMILIES]
        assert command.main(words) == 0
    return folder


def rows(corpus: Path) -> list[dict]:
    return json.loads((corpus / "index.json").read_text())


def test_every_scene_has_a_plan_that_its_captions_tell(corpus: Path) -> None:
    found = rows(corpus)
    assert {row["family"] for row in found} == set(FAMILIES)
    assert {row["split"] for row in found} == {"train", "test"}
    captions = right = 0
    for row in found:
        known = Label.of_row(row["label"])
        assert known.plan.acts and all(0 <= a < b <= row["frames"] for a, b in known.spans.values())
        acts = {act.act for act in known.plan.acts}
        assert len(set(row["captions"])) == len(row["captions"]) >= 3
        assert all(row["alone"])
        for text in row["captions"]:
            captions += 1
            told = {act.act for act in read(text).acts}
            right += bool(told) and told <= acts
    assert right >= 0.9 * captions


def test_a_scene_has_its_class_from_its_label(corpus: Path) -> None:
    scenes = of_classes(prepare(corpus, TokenLayout()))
    assert {row["family"] for row in scenes.rows} == set(FAMILIES) - {"ordered"}
    names, touches = labels_of(scenes)
    assert {"bow", "wave"} <= set(names) and len(touches) == len(names)
    assert all(class_of(row) in names for row in scenes.split("train"))


def test_captions_are_written_anew_and_the_rest_stays(corpus: Path) -> None:
    before = rows(corpus)
    assert retell.main(["--corpus", str(corpus), "--seed", "3"]) == 0
    after = rows(corpus)
    assert any(one["captions"] != other["captions"] for one, other in zip(before, after, strict=True))
    words = ("captions", "alone", "beats")
    assert [{k: v for k, v in row.items() if k not in words} for row in before] == [
        {k: v for k, v in row.items() if k not in words} for row in after
    ]
