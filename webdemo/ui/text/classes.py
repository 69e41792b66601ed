"""The classes that can be picked, as the weights folder of their method names them; nothing is loaded."""

from __future__ import annotations

import json
from pathlib import Path

from webdemo.inference.method import Method
from webdemo.inference.methods import WEIGHTS, method, methods


def takes_class(name: str) -> bool:
    """True if a method takes the name of a class instead of a sentence."""
    return "class" in method(name).takes


def class_method() -> Method:
    """The method that makes two people from a class."""
    return next(found for found in methods("generate") if "class" in found.takes)


def installed_classes(weights: Path = WEIGHTS) -> list[str]:
    """Names of the classes; none where there are no weights."""
    try:
        meta = json.loads((weights / str(class_method().weights) / "config.json").read_text())
        return list(map(str, meta["model"]["labels"]))
    except (OSError, ValueError, KeyError, TypeError):
        return []
