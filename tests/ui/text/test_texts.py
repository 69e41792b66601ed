"""The texts of the page: every language has all of them, each is used, and those that are named are there."""

from __future__ import annotations

import ast
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

from webdemo.inference.methods import methods
from webdemo.ui.text.texts import ENGLISH, TEXTS_FOLDER, english, languages, say, translations, worded

ROOT = Path(__file__).resolve().parents[3]
PYTHON = sorted((ROOT / "webdemo").rglob("*.py"))
MODULES = [
    path for path in sorted((ROOT / "static").rglob("*.js")) if not {"mediapipe", "plotly"} & set(path.parts)
]  # what others wrote says nothing to visitors
MARKUP = sorted((ROOT / "static").rglob("*.html"))
KEY = re.compile(r"[a-z]+\.[a-z0-9_]+")
WORDED = ("examples", "files", "method", "preset", "purpose", "side", "swept", "way")
"""Sections that are looked up by their English labels, which stand in the code or in its data."""
BY_GRADIO = {"common.upload"}


def _literals(path: Path) -> set[str]:
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        found = {n.value for n in ast.walk(ast.parse(text)) if isinstance(n, ast.Constant)}
        return {value for value in found if isinstance(value, str)} | set(re.findall(r"say\('([^']+)'\)", text))
    return set(re.findall(rf"[\"'`]({KEY.pattern})[\"'`]", text))


@pytest.fixture(scope="module")
def literals() -> set[str]:
    return set().union(*map(_literals, (*PYTHON, *MODULES, *MARKUP)))


@pytest.mark.parametrize("language", [name for name in languages() if name != ENGLISH])
def test_every_language_has_all_texts_with_the_same_names_in_braces(language: str) -> None:
    assert languages()[language].keys() == languages()[ENGLISH].keys()
    for key, text in languages()[language].items():
        names, theirs = (sorted(re.findall(r"\{(\w+)\}", each)) for each in (text, english(key)))
        assert text.strip() and names == theirs, key


def test_scripts_know_the_languages() -> None:
    (listed,) = re.findall(r"const LANGUAGES = (\[.*?\]);", (ROOT / "static" / "texts.js").read_text())
    assert json.loads(listed) == sorted(languages()) == [path.stem for path in sorted(TEXTS_FOLDER.iterdir())]


def test_every_text_is_used(literals: set[str]) -> None:
    known = literals | {literal.capitalize() for literal in literals}
    known |= {path.stem.replace("-", " ").capitalize() for path in (ROOT / "static" / "examples").glob("*.npz")}
    known |= {method.summary for task in ("generate", "react", "predict") for method in methods(task)}
    for key, text in languages()[ENGLISH].items():
        by_label = key.split(".")[0] in WORDED and text in known
        assert key in literals or key in BY_GRADIO or by_label, key


def test_every_text_that_is_named_is_there() -> None:
    sections = {key.split(".")[0] for key in languages()[ENGLISH]}
    pages = [path for path in PYTHON if "ui" in path.parts]
    named = {text for path in (*pages, *MODULES, *MARKUP) for text in _literals(path) if KEY.fullmatch(text)}
    named = {text for text in named if text.split(".")[0] in sections and not any((ROOT / "static").glob(f"*/{text}"))}
    assert named <= languages()[ENGLISH].keys()


class _Said(HTMLParser):
    """(key, English that stands in the markup) of all texts of a file."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[str, str]] = []
        self._open: tuple[str, str] | None = None
        self.bare: list[str] = []
        self._said = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        for name in ("title", "aria-label", "placeholder"):
            if key := given.get(f"data-say-{name}"):
                self.found.append((key, given[name]))
            elif re.search(r"[A-Za-z]{3}", given.get(name, "")):
                self.bare.append(given[name])
        self._said = "data-say" in given
        if self._said:
            self.found.append((given["data-say"], ""))

    def handle_data(self, data: str) -> None:
        if self._said:
            key, before = self.found[-1] if self.found[-1][1] == "" else self.found.pop()
            self.found[-1] = key, before + data
        elif re.search(r"[a-z]{3}", data):
            self.bare.append(data.strip())
        self._said = False


@pytest.mark.parametrize("path", MARKUP, ids=lambda path: path.stem)
def test_the_markup_says_what_the_english_file_says(path: Path) -> None:
    said = _Said()
    said.feed(re.sub(r"<script.*?</script>|@\w+@", "", path.read_text(encoding="utf-8"), flags=re.DOTALL))
    for key, text in said.found:
        assert english(key) == text, key
    assert set(said.bare) <= {"Esc", "Ctrl K", "· Pas de Deux"}, "texts that no language replaces"


def test_a_text_for_a_component_is_a_mark_that_gradio_resolves() -> None:
    assert say("files.film") == '__i18n__{"__type__": "translation_metadata", "key": "files.film"}'
    filled = say("scene.futures", count=3)
    key = json.loads(filled.removeprefix("__i18n__"))["key"]
    assert translations()["en"][key] == "3 continuations from here"
    with pytest.raises(KeyError):
        say("files.nothing")


def test_a_label_that_no_text_has_is_shown_as_it_is() -> None:
    assert worded("preset", "Four seeds") == say("preset.four_seeds")
    assert worded("preset", "A lab's own <b>preset</b>") == "A lab's own <b>preset</b>"
