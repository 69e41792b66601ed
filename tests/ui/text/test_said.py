"""What the server says in another language: the sentences are those of the code, and all acts are there."""

from __future__ import annotations

import ast
import re
import time
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import pytest
from gradio.context import LocalContext

from motion import InputError
from motion.metrics import MEASURES
from webdemo.inference.requests import Progress
from webdemo.ui.text.panels import status
from webdemo.ui.text.said import NAME, Template, Translations, known_languages, said, sections_of, words_of
from webdemo.ui.text.words import error_line, progress_line
from webdemo.ui.visitor import wanted_language

ROOT = Path(__file__).resolve().parents[3]
HOLE = "\0"
"""Stands where the code fills something in."""
LEAST = 0.4
"""Share of a sentence's letters that stand in one text of the code; a name may stand there for the rest."""


def _texts(tree: ast.AST) -> Iterator[str]:
    """The texts of a module, those with values among them."""
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            parts = (part.value if isinstance(part, ast.Constant) else HOLE for part in node.values)
            yield "".join(map(str, parts))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield re.sub(r"\{[\w:.]*\}", HOLE, node.value)


def _modules() -> Iterator[ast.Module]:
    for package in ("acts", "motion", "webdemo"):
        for path in sorted((ROOT / package).rglob("*.py")):
            yield ast.parse(path.read_text(encoding="utf-8"))


@cache
def _written() -> frozenset[str]:
    return frozenset(re.sub(f"{HOLE}+", HOLE, text) for tree in _modules() for text in _texts(tree))


def _letters(text: str) -> int:
    return len(re.findall("[A-Za-z]", text))


def _is_written(english: str, written: frozenset[str], blob: str) -> bool:
    """Whether the code has a text, or one that becomes this text where some of its holes are filled."""
    wanted = NAME.sub(HOLE, english)
    if wanted in blob:
        return True
    least = max(2, LEAST * _letters(wanted))
    for text in written:
        if _letters(text) >= least:
            pattern = Template(tuple(f"{HOLE}{text}{HOLE}".split(HOLE)), (), "")
            at = 0
            for part in pattern.parts:
                at = wanted.find(part, at) + len(part) if part in wanted[at:] else -1
                if at < 0:
                    break
            else:
                return True
    return False


def test_every_sentence_is_one_of_the_code() -> None:
    blob = "\n".join(_written())
    for language in known_languages():
        unknown = [
            text for text in words_of(language, "sentences") if not _is_written(text, _written(), blob)
        ]
        assert not unknown, "nothing says this any more: correct or remove it"


def test_a_sentence_that_no_code_says_is_noticed() -> None:
    blob = "\n".join(_written())
    assert not _is_written("The prompt is far too silly: say something else.", _written(), blob)
    assert not _is_written("{name} must be a pleasant number from {low} to {high}.", _written(), blob)
    assert _is_written("Cancelled at step {step} of {total}.", _written(), blob)


@pytest.mark.parametrize("language", known_languages())
def test_translations_have_the_names_of_the_english_text(language: str) -> None:
    sections = sections_of(language, "sentences")
    texts = words_of(language, "sentences")
    assert len(texts) == sum(map(len, sections.values())), "a text stands in two sections"
    for english, text in texts.items():
        assert text.strip(), english
        assert sorted(NAME.findall(text)) == sorted(set(NAME.findall(english))), english
        assert "}{" not in english, "two values in a row cannot be told apart"
        assert not NAME.search(english) or _letters(NAME.sub("", english)) >= 1, "any text fits this"


@pytest.mark.parametrize("language", known_languages())
def test_every_act_of_the_lexicon_has_a_line(language: str) -> None:
    from acts.lexicon import OURS

    lines, words = words_of(language, "acts"), sections_of(language, "words")
    entries = {name for path in OURS.glob("*.toml") for name in tomllib.loads(path.read_text())}
    assert lines.keys() == entries, f"languages/{language}/acts.toml has a line for each act of acts/lexicon"
    for name, line in lines.items():
        _, both = line.split(" | ")
        assert "{b}" not in both, f"{name}: both do it, so that nobody is the other"
        for slot in re.findall(r"\{[^}]*\}", line):
            kind, _, usual = slot.strip("{}").partition(":")
            assert slot == "{b}" or usual in words[f"{kind}s"], f"{name}: {slot}"


@pytest.mark.parametrize("language", known_languages())
def test_every_part_of_the_body_and_every_thing_has_a_word(language: str) -> None:
    words = sections_of(language, "words")
    body = tomllib.loads((ROOT / "acts" / "reading" / "words.toml").read_text())["body"]
    things = tomllib.loads((ROOT / "acts" / "things.toml").read_text())["nouns"]
    missing = {each for line in body.values() for each in line.split()} - words["parts"].keys()
    missing |= (
        {each for kind, nouns in things.items() for each in (kind, *nouns)}
        - words["things"].keys()
        - {"chest"}
    )
    assert not missing
    for forms in words["parts"].values():
        assert len(forms.split(" | ")) in (1, 4), forms


# ---- the mechanism
KNOWN = Translations.of(
    {
        "Done in {time}.": "Fertig in {time}.",
        "Done: {acts}.": "Zu sehen: {acts}.",
        "No {thing}: choose one.": "Kein {thing}: wählen.",
        "hand": "Hand",
        "{who} waves": "{who} winkt",
    }
)


@pytest.mark.parametrize(
    "english, german",
    [
        ("Done in 3.1 s.", "Fertig in 3.1 s."),
        ("Done: A waves; B waves. Done in 2 s.", "Zu sehen: A winkt; B winkt. Fertig in 2 s."),
        ("No hand: choose one.", "Kein Hand: wählen."),
        ("No “hand”: choose one.", "Kein “hand”: wählen."),
        ("Nothing of this is known.", "Nothing of this is known."),
        ("Done in", "Done in"),
    ],
)
def test_a_sentence_is_found_by_its_template(english: str, german: str) -> None:
    assert KNOWN.say(english, {}) == german


def test_a_text_of_many_parts_takes_no_time(german: None) -> None:
    hostile = ", and; ".join(["a b. A"] * 400)
    began = time.perf_counter()
    assert said(hostile) == hostile
    assert time.perf_counter() - began < 1.0


def test_parts_that_are_known_here_alone_are_found_first() -> None:
    assert KNOWN.say("Done: A waves; B bows.", {"B bows": "B verbeugt sich"}) == (
        "Zu sehen: A winkt; B verbeugt sich."
    )


@pytest.mark.parametrize(
    "query, page, browser, language",
    [
        ("", "", "", "en"),
        ("de", "", "fr", "de"),
        ("", "http://lab/?run=1&lang=de", "en-US,en;q=0.9", "de"),
        ("", "http://lab/", "de-AT,de;q=0.9,en;q=0.8", "de"),
        ("", "http://[", "en-GB", "en"),
        ("", "", ";;q=", "en"),
    ],
)
def test_the_address_goes_before_the_browser(query: str, page: str, browser: str, language: str) -> None:
    request = SimpleNamespace(
        query_params={"lang": query} if query else {},
        headers={"accept-language": browser, "referer": page},
        scope={},
    )
    token = LocalContext.request.set(SimpleNamespace(request=request))
    try:
        assert wanted_language() == language
    finally:
        LocalContext.request.reset(token)


def test_english_is_as_the_code_says_it() -> None:
    assert said("Done in 3.1 s.") == "Done in 3.1 s."
    assert wanted_language() == "en"


def test_programs_get_english_and_the_page_german(german: None) -> None:
    error = InputError("The prompt is empty: say in a sentence what the two people do.")
    assert error_line(error) == str(error)
    assert "Die Eingabe ist leer" in status(error_line(error), tone="error")


def test_progress_is_german(german: None) -> None:
    event = Progress(stage="sample", step=12, total=50, elapsed=6.0, attempt=2, attempts=3)
    assert said(progress_line(event)) == "Versuch 2 von 3. Entrauschen: Schritt 12 von 50, noch etwa 5 s"


def test_every_measure_is_german(german: None) -> None:
    for measure in MEASURES:
        assert said(measure.label) != measure.label
        assert said(measure.meaning) != measure.meaning


# ---- how many of the errors
def _errors() -> set[str]:
    """The texts of all InputErrors that are written where they are raised."""
    found = set()
    for tree in _modules():
        for node in ast.walk(tree):
            is_error = (
                isinstance(node, ast.Call) and getattr(node.func, "id", "") == "InputError" and node.args
            )
            if is_error and isinstance(node.args[0], ast.Constant | ast.JoinedStr):
                found.add(re.sub(f"{HOLE}+", HOLE, next(_texts(node.args[0]))))
    return found


def test_the_document_says_how_many_errors_are_translated() -> None:
    errors = _errors()
    known = Translations.of(words_of("de", "sentences"))
    filled = [text.replace(HOLE, "x") for text in errors]
    translated = [
        text for text in filled if text in known.whole or any(each.values(text) for each in known.templates)
    ]
    document = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    told = re.search(r"(\d+) of the about (\d+) error sentences", document.replace("\n", " "))
    assert told, "the document names both"
    print(f"{len(translated)} of {len(errors)} error sentences are German")
    assert int(told[1]) <= len(translated), "fewer are translated than the document says"
    assert abs(int(told[2]) - len(errors)) <= 0.1 * len(errors), "their number has changed much"
