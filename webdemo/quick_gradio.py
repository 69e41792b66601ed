"""Gradio's import without the type stubs that it writes beside every component, which is half of a start's time.

For each class of a component Gradio parses the class' source twice and writes a ``.pyi`` file for editors next to it,
also next to the classes of this package, each time that a process starts.
"""

from __future__ import annotations

import sys
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import Any

MODULE = "gradio.component_meta"
WRITER = "create_or_modify_pyi"


def _write_nothing(*_: Any) -> None:
    """Stands for the function that writes stubs."""


class _WithoutStubs(MetaPathFinder):
    """Finds the one module that writes stubs, and takes that from it once it is loaded."""

    def find_spec(self, name: str, path: Any = None, target: ModuleType | None = None) -> ModuleSpec | None:
        if name != MODULE:
            return None
        spec = PathFinder.find_spec(name, path, target)
        if spec is None or spec.loader is None:
            return None
        loader: Any = spec.loader
        execute = loader.exec_module

        def exec_module(module: ModuleType) -> None:
            execute(module)
            if hasattr(module, WRITER):
                setattr(module, WRITER, _write_nothing)

        loader.exec_module = exec_module
        return spec


def install() -> None:
    """Lets Gradio write no stubs; does nothing where it is imported already."""
    if MODULE not in sys.modules and not any(isinstance(each, _WithoutStubs) for each in sys.meta_path):
        sys.meta_path.insert(0, _WithoutStubs())
