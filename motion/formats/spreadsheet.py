"""Cells of a .csv that a spreadsheet takes as they are."""

from __future__ import annotations

from typing import Any


def safe_cell(value: Any) -> Any:
    """The value; text that a spreadsheet would compute begins with an apostrophe."""
    formula = isinstance(value, str) and value.lstrip()[:1] in ("=", "+", "-", "@")
    return f"'{value}" if formula else value
