"""No regular expression takes long on the longest text that it may be given, whatever the text."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from webdemo.inference.requests import MAX_PROMPT
from webdemo.inference.story.sentences import LONGEST_READ, MOST_WORDS
from webdemo.inference.story.toml import MOST_CHARACTERS

from .compiled_patterns import ANYTHING, ROOT, SENTENCE, STORY


def slow(pattern: str | bytes, longest: int) -> str:
    """What :func:`tests.pattern_attacks.slow` finds in a process of its own.

    The signal that stops a match has ended workers of the tests by SIGSEGV (Python 3.11.7).
    """
    command = [sys.executable, "-m", "tests.pattern_attacks", repr(pattern), str(longest)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.strip()


@pytest.mark.parametrize("pattern", [r"(?:a+)+$", r"\s+$", rb"[ \t]*\n[ \t]*M"])
def test_a_pattern_of_quadratic_or_exponential_time_is_found(pattern):
    assert slow(pattern, ANYTHING)


def test_the_limits_are_those_of_the_readers():
    assert (SENTENCE, STORY) == (LONGEST_READ, MOST_WORDS)
    assert SENTENCE >= MAX_PROMPT
    assert MOST_CHARACTERS <= 2 * ANYTHING  # its patterns are of linear time


def test_every_pattern_of_the_packages_is_fast():
    """In a process of its own, which is ended where a pattern does not end."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.compiled_patterns"], cwd=ROOT, capture_output=True, text=True, timeout=900
    )
    assert done.returncode == 0, done.stderr[-2000:]
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["patterns"] > 40
    assert found["slow"] == []
