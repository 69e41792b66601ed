"""The texts of the page: each is used, and those that are named are there."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from webdemo.ui.text.texts import say, texts

ROOT = Path(__file__).resolve().parents[3]
PYTHON = sorted((ROOT / "webdemo").rglob("*.py"))
MODULES = [
    path for path in sorted((ROOT / "static").rglob("*.js")) if not {"mediapipe", "plotly"} & set(path.parts)
] + [ROOT / "static" / "share" / "page.html"]  # what others wrote says nothing to visitors
KEY = re.compile(r"[a-z]+\.[a-z0-9_]+")


def _literals(path: Path) -> set[str]:
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        found = {n.value for n in ast.walk(ast.parse(text)) if isinstance(n, ast.Constant)}
        return {value for value in found if isinstance(value, str)}
    return set(re.findall(rf"[\"'`]({KEY.pattern})[\"'`]", text))


def test_every_text_is_used() -> None:
    literals = set().union(*map(_literals, (*PYTHON, *MODULES)))
    literals |= {f"{key}_info" for key in literals}  # a slider takes it by itself
    literals |= {f"{kind}.{key}" for kind in ("files", "settings", "stage") for key in literals}  # named by their key
    assert [key for key in texts() if key not in literals] == []


def test_every_text_that_is_named_is_there() -> None:
    sections = {key.split(".")[0] for key in texts()}
    pages = [path for path in PYTHON if "ui" in path.parts]
    named = {text for path in (*pages, *MODULES) for text in _literals(path) if KEY.fullmatch(text)}
    named = {text for text in named if text.split(".")[0] in sections and not any((ROOT / "static").glob(f"*/{text}"))}
    assert named <= texts().keys()


def test_a_text_is_filled_in() -> None:
    assert say("scene.futures", count=3) == "3 continuations from here"
    with pytest.raises(KeyError):
        say("files.nothing")
