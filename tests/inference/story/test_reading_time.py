"""Reading a stranger's text takes time in proportion to its length, whatever the text."""

from __future__ import annotations

import subprocess
import sys
import time

import pytest

from webdemo.inference.requests import GenerateRequest
from webdemo.inference.run import Cancelled
from webdemo.inference.story import split_sentence
from webdemo.inference.story.sentences import as_scene

LONGEST = 500
"""The longest prompt that the page takes, in characters."""
_READ = """
from acts import read
for word in ("slowly", "eagerly"):
    for before in ("", "A man "):
        read((before + f"{word} " * 70)[:500])
"""


def test_an_adverb_repeated_is_read_at_once():
    """Each of these once matched in two ways, and forty of them in 2⁴⁰."""
    subprocess.run([sys.executable, "-c", _READ], check=True, timeout=60)


REPEATED = (
    "Anna, ",
    "A. ",
    ", ",
    "(",
    "he hugs him and ",
    "\u3042",
    "x",
    "Two people walk up to each other and shake hands. ",
    "slowly ",
)


@pytest.mark.parametrize("part", REPEATED)
@pytest.mark.parametrize("before", ["", "A man "])
def test_a_prompt_of_the_longest_length_is_read_in_a_fifth_of_a_second(before, part):
    read("Two people walk.")  # loads the parser
    text = (before + part * LONGEST)[:LONGEST]
    assert min(read(text, again) for again in range(2)) < 0.2


def read(text: str, again: int = 0) -> float:
    """Processor seconds in which a prompt is split, planned and told of, read for the first time."""
    began = time.process_time()
    scene = as_scene(GenerateRequest(prompt=text, seconds=10.0))
    if scene is not None:
        assert len(scene.scores) == len(scene.beats)
    return time.process_time() - began


def test_a_story_is_read_in_linear_time_and_can_be_stopped():
    story = "They walk up to each other and hug. They part. " * 20
    calls: list[int] = []
    assert len(split_sentence(story, lambda: calls.append(1))) == 60
    assert len(calls) == 2, "once a stretch of thirty sentences"

    def stop() -> None:
        raise Cancelled("Stopped.")

    with pytest.raises(Cancelled):
        split_sentence(story, stop)
