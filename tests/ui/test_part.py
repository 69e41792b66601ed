"""What all parts of the page that scripts draw have in common."""

from pathlib import Path

import pytest

from webdemo.ui.components.camera import CameraPanel
from webdemo.ui.components.finder import Finder
from webdemo.ui.components.gallery import Gallery
from webdemo.ui.components.live import LivePanel
from webdemo.ui.components.notebook import NotebookView
from webdemo.ui.components.part import Part, scoped
from webdemo.ui.components.player import MotionPlayer, busy, show
from webdemo.ui.components.reading import Reading
from webdemo.ui.components.story import StoryLine

PARTS = (CameraPanel, Finder, Gallery, LivePanel, MotionPlayer, NotebookView, Reading, StoryLine)


@pytest.mark.parametrize("part", PARTS)
def test_values_pass_unchanged_and_the_template_is_constant(part: type[Part]) -> None:
    made = part(render=False)
    value = {"text": "<script>alert(1)</script>"}
    assert made.preprocess(value) is value and made.postprocess(value) is value
    assert made.html_template == part.template.read_text(encoding="utf-8")
    assert set(made.props) == set(part.declared)


def test_what_the_player_is_told_arrives() -> None:
    """Gradio leaves None out of an update, and the page keeps what it had."""
    assert None not in busy("Starting …").values() and show(None)["progress"] is not None


def test_a_part_is_given_to_the_module_beside_its_template() -> None:
    script = LivePanel(render=False).js_on_load
    assert '/static/live/live.js";' in script and "mount(element, props, watch, trigger)" in script


def test_every_rule_of_a_style_sheet_stays_inside_its_part(tmp_path: Path) -> None:
    sheet = tmp_path / "x.css"
    sheet.write_text(".one { top: 0; }\n.two { top: 0; }\n")
    assert scoped(sheet).split() == ["&", ".one", "{", "top:", "0;", "}", "&", ".two", "{", "top:", "0;", "}"]
