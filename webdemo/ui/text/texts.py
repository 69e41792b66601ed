"""The texts of the page by key: ``static/texts.json``, which its own scripts read as well."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

STATIC = Path(__file__).resolve().parents[3] / "static"
"""Folder of what browsers load."""
TEXTS_JS = STATIC / "texts.js"
"""The module by which scripts read the texts."""
TEXTS = TEXTS_JS.with_suffix(".json")


@cache
def texts() -> dict[str, str]:
    """Key → text."""
    return json.loads(TEXTS.read_text(encoding="utf-8"))


def say(key: str, **values: object) -> str:
    """The text of a key, with values in the place of names in braces; KeyError for an unknown key."""
    text = texts()[key]
    for name, value in values.items():
        text = text.replace(f"{{{name}}}", str(value))
    return text
