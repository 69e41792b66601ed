"""The same words and seed give the same motion wherever they are given: one default of denoising steps."""

from __future__ import annotations

from argparse import ArgumentParser
from typing import Any

import pytest

from motion import Clip, InputError
from tests.motion.bodies import marching
from webdemo.cli.parser import add_sampling, sampling_fields
from webdemo.inference.method import DEFAULT_STEPS
from webdemo.inference.methods import method, methods
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.story.beats import Beat
from webdemo.inference.story.request import SceneRequest
from webdemo.inference.story.toml import read_story
from webdemo.ui.tabs.generate import GenerateTab
from webdemo.ui.tabs.react import ReactTab
from webdemo.ui.tabs.sampling import FAST

STORY = '[[beat]]\nwords = "They wave."\n'
BEATS = (Beat("They wave."),)


def from_shell(task: Any, model: str) -> int | None:
    """The steps that a command hands to its request where none are given."""
    parser = ArgumentParser()
    add_sampling(parser, task)
    return sampling_fields(parser.parse_args(["--out", "x.npz", "--model", model]))["steps"]


def test_a_sentence_has_as_many_steps_everywhere() -> None:
    shell = GenerateRequest(prompt="They wave.", steps=from_shell("generate", "intergen"))  # type: ignore[arg-type]
    python, story = GenerateRequest(prompt="They wave."), SceneRequest(**read_story(STORY))
    page = GenerateTab.asked_by("intergen")[3]["value"]
    assert {shell.steps, python.steps, story.steps, page, FAST, DEFAULT_STEPS} == {8}


@pytest.mark.parametrize("name", [found.name for found in methods("generate")])
def test_a_generator_has_its_own_steps_everywhere(name: str) -> None:
    own = method(name).steps
    assert GenerateRequest(prompt="They wave.", model=name).steps == own
    assert GenerateTab.asked_by(name)[3]["value"] == own
    assert from_shell("generate", name) in (None, own)


@pytest.mark.parametrize("name", [found.name for found in methods("react")])
def test_a_reactor_has_its_own_steps_everywhere(name: str) -> None:
    found = method(name)
    asked = ReactRequest(actor=Clip(marching(30)[0], 30.0), model=name, sampler=found.samplers[0])
    assert asked.steps == found.steps == ReactTab.fit_method(name)[1]["value"]
    assert from_shell("react", name) in (None, found.steps)


def test_steps_that_are_given_are_kept() -> None:
    assert SceneRequest(beats=BEATS, steps=50).steps == 50
    with pytest.raises(InputError, match="DDIM steps must be from 1"):
        SceneRequest(beats=BEATS, steps=0)
