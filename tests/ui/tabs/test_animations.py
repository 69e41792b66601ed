"""A .glb of several animations on the tabs React and Predict: the first is shown, and another can be chosen."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gradio as gr
import numpy as np
import pytest

from motion.formats import ImportChoices, read
from tests.motion.bodies import marching
from tests.motion.formats.characters import glb_motion, glb_takes
from tests.ui.tab_events import built, taken
from webdemo.ui.components.actors import offered_animations
from webdemo.ui.tabs.predict import PredictTab
from webdemo.ui.tabs.react import ReactTab

from .reacting import upload

POSITIONS, ROTATIONS = marching(90)
LABELS = ("1 · <b>walk</b>", "2 · glide", "3")
HIDDEN = gr.update(choices=[], value=None, visible=False)


@pytest.fixture
def takes(tmp_path: Path) -> Path:
    """One person in three animations, three seconds."""
    path = tmp_path / "takes.glb"
    path.write_bytes(glb_takes(ROTATIONS, POSITIONS[:, 0], ["<b>walk</b>", "glide", None]))
    return path


@pytest.fixture
def tab(tmp_path: Path) -> ReactTab:
    return built(ReactTab, tmp_path / "files")


def shown(number: int) -> dict[str, Any]:
    return gr.update(choices=[(label, i) for i, label in enumerate(LABELS, 1)], value=number, visible=True)


def test_the_first_is_shown_and_the_line_names_the_others(tab: ReactTab, takes: Path) -> None:
    found = upload(tab, takes)[-1]
    assert "1 (“&lt;b&gt;walk&lt;/b&gt;”) was taken; the others are 2 (“glide”) and 3." in found["line"]
    assert offered_animations(found["state"]) == shown(1)


def test_a_file_of_one_animation_offers_no_choice(tab: ReactTab, takes: Path, walker: Path) -> None:
    takes.write_bytes(glb_motion(ROTATIONS, POSITIONS[:, 0]))
    for path in (takes, walker):
        source = upload(tab, path)[-1]["state"]
        assert offered_animations(source) == HIDDEN and source.notes == ()
    assert offered_animations(None) == HIDDEN


def test_another_is_read_when_it_is_chosen(tab: ReactTab, takes: Path) -> None:
    source = upload(tab, takes)[-1]["state"]
    *_, again = [taken(tab.actor, u) for u in tab.actor.read_again(source, "auto", None, "auto", 2)]
    assert "2 (“glide”) was taken" in again["line"] and offered_animations(again["state"]) == shown(2)
    assert np.abs(again["state"].people[0].positions - source.people[0].positions).max() > 0.1
    *_, wrong = [taken(tab.actor, u) for u in tab.actor.read_again(again["state"], "auto", None, "auto", 9)]
    assert "takes.glb has no such animation" in wrong["line"] and wrong["animation"] == shown(2)


def test_a_past_is_chosen_likewise(tmp_path: Path, takes: Path) -> None:
    tab = built(PredictTab, tmp_path / "files")
    source = [taken(tab.past, u) for u in tab.past.upload(str(takes))][-1]["state"]
    assert offered_animations(source) == shown(1)
    *_, again = [taken(tab.past, u) for u in tab.past.read_again(source, 2)]
    assert "2 (“glide”) was taken" in again["line"] and "animation" not in again
    np.testing.assert_array_equal(
        again["state"].people[0].positions, read(takes, choices=ImportChoices(animation=2)).positions
    )
    *_, wrong = [taken(tab.past, u) for u in tab.past.read_again(again["state"], 9)]
    assert "no such animation" in wrong["line"] and wrong["animation"] == shown(2)
    assert list(tab.past.read_again(None, 1)) == []
