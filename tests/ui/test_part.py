"""What all parts of the page that scripts draw have in common."""

import json
from pathlib import Path

import pytest

from webdemo.ui.components.camera import CameraPanel
from webdemo.ui.components.finder import Finder
from webdemo.ui.components.gallery import Gallery
from webdemo.ui.components.live import LivePanel
from webdemo.ui.components.notebook import NotebookView
from webdemo.ui.components.part import MOUNT, Part, on_load, scoped
from webdemo.ui.components.player import MotionPlayer
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


def test_values_of_a_script_become_json() -> None:
    quoted = 'say "100 %s"'
    script = on_load("start(%s, %s)", quoted, Path("a b") / "c.js")
    assert script.endswith(f"start({json.dumps(quoted)}, {json.dumps('a b/c.js')})")
    assert "element, props, watch, trigger" in on_load(MOUNT, Path("main.js"))


def test_every_rule_of_a_style_sheet_stays_inside_its_part(tmp_path: Path) -> None:
    sheet = tmp_path / "x.css"
    sheet.write_text(".one { top: 0; }\n.two { top: 0; }\n")
    assert scoped(sheet).split() == ["&", ".one", "{", "top:", "0;", "}", "&", ".two", "{", "top:", "0;", "}"]
