"""The classes that BiGraphDiff knows, as its weights folder names them; nothing is loaded."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

WEIGHTS = Path(__file__).resolve().parents[2] / "models" / "weights"
MODEL = "bigraphdiff"


def installed_classes(weights: Path = WEIGHTS) -> tuple[list[str], dict[str, Any]]:
    """Names of the classes, and what the model's card says; none and nothing where there are no weights."""
    try:
        meta = json.loads((weights / MODEL / "config.json").read_text())
        return list(map(str, meta["model"]["labels"])), {"name": MODEL, **meta.get("card", {})}
    except (OSError, ValueError, KeyError, TypeError):
        return [], {}
