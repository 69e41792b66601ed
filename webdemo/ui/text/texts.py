"""The texts of the page, by key: ``static/texts`` holds a file a language, of which the browser picks one.

Gradio carries the texts of all languages in the page's configuration and puts them where a component names a key; the
page's own scripts read them from there, see ``static/texts.js``. A sentence that the server makes for an event, such as
progress, errors and read-outs, is English and no part of them.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

from gradio.i18n import I18nData

TEXTS_FOLDER = Path(__file__).resolve().parents[3] / "static" / "texts"
TEXTS_JS = TEXTS_FOLDER.with_suffix(".js")
"""The module by which scripts read the texts."""
ENGLISH = "en"
_FILLED: dict[str, tuple[str, dict[str, object]]] = {}
"""Texts with their values, by the keys under which the page's configuration has them."""


@cache
def languages() -> dict[str, dict[str, str]]:
    """Key → text of every language, by the names of its file."""
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in sorted(TEXTS_FOLDER.glob("*.json"))}


def say(key: str, **values: object) -> str:
    """A text for a component, which the browser puts into its language.

    Args:
        key: of the text; KeyError for an unknown one.
        values: for the names in braces in the text. They are the same for everybody: a text is filled in when the page
            is built.

    Returns:
        Gradio's mark for the text. One mark may stand in a label, an info, a placeholder or the value of a button or
        an HTML, with fixed words around it; a second one in the same value would stay as it is.
    """
    english(key, **values)
    if values:
        filled = f"{key} {' '.join(f'{name}={value}' for name, value in values.items())}"
        _FILLED[filled] = key, values
        key = filled
    return str(I18nData(key))


def english(key: str, **values: object) -> str:
    """The English text of a key, with values in the place of names in braces; KeyError for an unknown key."""
    return fill(languages()[ENGLISH][key], values)


def worded(section: str, label: str) -> str:
    """A label that a program knows in English, as the page shows it; the label itself where no text has it.

    Args:
        section: the part of the keys before the point.
        label: such as "Four seeds"; it stays the value that programs use.
    """
    found = _keys(section).get(label)
    return say(found) if found else label


@cache
def _keys(section: str) -> dict[str, str]:
    known = languages()[ENGLISH].items()
    return {label: key for key, label in known if key.startswith(f"{section}.")}


def fill(text: str, values: dict[str, object]) -> str:
    """A text with values in the place of the names in braces."""
    for name, value in values.items():
        text = text.replace(f"{{{name}}}", str(value))
    return text


def translations() -> dict[str, dict[str, str]]:
    """All texts as ``gr.I18n`` takes them, with those that were filled in while the page was built."""
    return {
        language: texts | {filled: fill(texts[key], values) for filled, (key, values) in _FILLED.items()}
        for language, texts in languages().items()
    }


SAY = """const say = (key) => {
  const known = window.gradio_config?.i18n_translations ?? {};
  const { lang } = document.documentElement;
  return (known[lang] ?? known[lang.split("-")[0]] ?? known.en)?.[key] ?? key;
};"""
"""JavaScript for an event of the page that needs a text itself: ``say(key)``, in the language that Gradio chose."""
