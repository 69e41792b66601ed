"""The command ``score``: requests as a user's, or the sentences as they are."""

from pathlib import Path

from motion.metrics.sentences import load_sentences
from webdemo.cli.scoring import Scoring, _folder
from webdemo.inference import GenerateRequest
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
