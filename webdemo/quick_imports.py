"""Packages that others import and hardly ever use, loaded when something of them is first asked for.

Gradio imports pandas to recognise a data frame in its cache, which this page does not use. It takes 30 MB and a fifth
of a second. The standard library's ``LazyLoader`` would not do: whoever looks through all modules, as ``inspect``
does, makes it load.
"""

from __future__ import annotations

import sys
import threading
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import Any

LATE = frozenset({"pandas"})


class _LateModule(ModuleType):
    """A package that is executed when an attribute of it, or a module in it, is first asked for."""

    def __getattr__(self, name: str) -> Any:
        if name == "__version__" or not name.startswith("__"):
            _load(self)
            if type(self) is ModuleType:  # not while it is being executed
                return getattr(self, name)
        raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")


class _LateLoader(Loader):
    """Makes a :class:`_LateModule` of what another loader executes."""

    def __init__(self, loader: Loader) -> None:
        self.loader: Loader | None = loader
        self.lock = threading.RLock()

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return _LateModule(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Does nothing yet."""


def _load(module: ModuleType) -> None:
    """Executes a late module, once; another thread that asks for it meanwhile waits."""
    late = module.__spec__.loader if module.__spec__ else None
    if not isinstance(late, _LateLoader):
        return
    with late.lock:
        loader, late.loader = late.loader, None
        if loader is not None:
            loader.exec_module(module)
            module.__class__ = ModuleType


class _Late(MetaPathFinder):
    """Finds these packages, and has them executed before a module in them."""

    def find_spec(self, name: str, path: Any = None, target: ModuleType | None = None) -> ModuleSpec | None:
        package, _, rest = name.partition(".")
        if package not in LATE:
            return None
        if rest:
            if package in sys.modules:
                _load(sys.modules[package])
            return None
        spec = PathFinder.find_spec(name, path, target)
        if spec is not None and spec.loader is not None:
            spec.loader = _LateLoader(spec.loader)
        return spec


def install() -> None:
    """Puts off the import of these packages; does nothing for those that are imported already."""
    if not any(isinstance(each, _Late) for each in sys.meta_path):
        sys.meta_path.insert(0, _Late())
