"""Gradio writes no type stubs beside components once this package was imported."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[1]
COMPONENT = """
import gradio as gr

class Mine(gr.HTML):
    EVENTS = ["change"]

with gr.Blocks():
    Mine("x").change(print)
"""


@pytest.mark.parametrize(("first", "stubs"), [("import webdemo", 0), ("", 1)])
def test_a_component_gets_no_stub(first: str, stubs: int, tmp_path: Path) -> None:
    script = tmp_path / "mine.py"
    script.write_text(first + COMPONENT)
    paths = {"PYTHONPATH": str(REPOSITORY), "GRADIO_ANALYTICS_ENABLED": "False"}
    subprocess.run([sys.executable, str(script)], env=os.environ | paths, check=True, timeout=300)
    assert len(list(tmp_path.glob("*.pyi"))) == stubs
