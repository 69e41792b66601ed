"""The registry of methods: the one list that everything else reads.

A module of this package exports ``METHOD``. Models of a lab's own enter by a table ``[models.NAME]`` of the settings
(:mod:`webdemo.inference.own`), by an entry point of the group ``pasdedeux.methods``, or by a path in the environment
variable ``PASDEDEUX_METHODS`` (files or folders, separated as in ``PATH``). An entry point names a ``METHOD`` or a
class with the ``Pipeline`` protocol; a file exports ``METHOD``. Importing this package imports no torch.
"""

from __future__ import annotations

import importlib.util
import logging
import os
import sys
import threading
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType

from motion import InputError
from webdemo.inference.method import WEIGHTS, Method, Task, Variant
from webdemo.inference.own import method_of, read_entries
from webdemo.inference.own.classes import method_of_class

from . import agent, bigraphdiff, interformer, intergen, intergen_together, mawgan, motion_mlp, nearest, regennet, still

log = logging.getLogger(__name__)

BUILT_IN = tuple(
    module.METHOD
    for module in (
        intergen,
        bigraphdiff,
        regennet,
        interformer,
        nearest,
        agent,
        motion_mlp,
        mawgan,
        intergen_together,
        still,
    )
)
"""In the order in which the page offers them; the first one for a task is that task's default."""
PATHS_VARIABLE = "PASDEDEUX_METHODS"
ENTRY_POINTS = "pasdedeux.methods"
AUTOMATIC = "automatic"
"""Stands for a model in a request for a reaction: :func:`automatic` chooses it."""

_lock = threading.RLock()
_registered: dict[str, Method] = {}
_failed: dict[str, str] = {}
_from_settings: set[str] = set()
_complete = False


def methods(task: Task | None = None) -> tuple[Method, ...]:
    """All methods, or those for a task, in the order in which they are offered."""
    _register_all()
    return tuple(m for m in _registered.values() if task is None or task in m.tasks)


def method(name: str, task: Task | None = None) -> Method:
    """A method by name.

    Raises:
        InputError: if there is none of this name, none that does this task, or the settings name one that cannot
            be used.
    """
    _register_all()
    found = _registered.get(name)
    if found is None and name in _failed:
        raise InputError(_failed[name])
    if found is not None and (task is None or task in found.tasks):
        return found
    wrong = f"There is no model {name!r:.40}" if found is None else f"{found.label} does not {task}"
    raise InputError(f"{wrong}: choose one of {', '.join(m.name for m in methods(task))}.")


def automatic(prompt: str, role: str, mode: str = "offline") -> Method:
    """The method for a reaction that nobody chose one for: the one with the best score in docs/reactions.md.

    Words go to the default method, which follows them (docs/scores.md). Without words, a person who acts first is
    answered by the nearest recorded reaction where a lab has recordings of its own, and else by ReGenNet. Frame by
    frame, the first method answers that can.
    """
    found = methods("react")
    if mode != "offline":
        return next((m for m in found if mode in m.modes), found[0])
    if prompt.strip() or role != "a":
        return found[0]
    best = nearest.METHOD if os.environ.get(nearest.FOLDER_VARIABLE) else regennet.METHOD
    return best if best.installed(WEIGHTS) else found[0]


def label_of(name: str) -> str:
    """The label of a method; its name if it is not registered, as in an old history."""
    _register_all()
    return _registered[name].label if name in _registered else name


def variants(task: Task) -> dict[str, Variant]:
    """The methods for a task in each of their modes, by key."""
    return {variant.key: variant for m in methods(task) for variant in m.variants}


def installed(task: Task, weights: Path | None = None) -> tuple[Method, ...]:
    """The methods for a task whose weights are there; the task's default is always among them."""
    folder = WEIGHTS if weights is None else weights
    return tuple(m for i, m in enumerate(methods(task)) if i == 0 or m.installed(folder))


def failed() -> dict[str, str]:
    """Models that cannot be used: the name in the settings, or the place of a module → one sentence on why."""
    _register_all()
    return dict(_failed)


def register(found: Method | type) -> None:
    """Adds a method of a lab's own, or a class with the ``Pipeline`` protocol.

    Raises:
        InputError: if it is neither, or its name is taken.
    """
    _register_all()
    if isinstance(found, type):
        found = method_of_class(found)
    if not isinstance(found, Method):
        raise InputError("METHOD is not a webdemo.inference.method.Method.")
    if found.name in _registered:
        raise InputError(f"There is a method named {found.name} already: choose another name.")
    _registered[found.name] = found


def unregister(name: str) -> None:
    """Removes a method that :func:`register` added."""
    if name not in {m.name for m in BUILT_IN}:
        _registered.pop(name, None)


def register_path(path: Path) -> None:
    """Adds the methods of a Python file, or of every file in a folder that exports ``METHOD``.

    The folder is put on ``sys.path``, so that a method's file can import its pipeline from another one. A file
    that fails is reported by :func:`failed` and leaves the others as they are.
    """
    _register_all()
    if not path.exists():
        _failed[str(path)] = f"There is no file or folder {path}: correct {PATHS_VARIABLE}."
        return
    folder = path if path.is_dir() else path.parent
    if str(folder) not in sys.path:
        sys.path.append(str(folder))
    for file in sorted(folder.glob("*.py")) if path.is_dir() else [path]:
        # A folder may hold pipelines, too, which import torch: only files that name METHOD are imported.
        if path.is_dir() and "METHOD" not in file.read_text(errors="replace"):
            continue
        try:
            register(_import(file).METHOD)
        except Exception as error:
            _fail(str(file), error)


def register_settings() -> None:
    """Adds the models of the settings as they are now, in place of those of before."""
    _register_all()
    with _lock:
        for name in _from_settings:
            _registered.pop(name, None)
            _failed.pop(name, None)
        _from_settings.clear()
        entries, failures = read_entries()
        for name, entry in entries.items():
            try:
                register(method_of(entry))
            except Exception as error:
                log.debug("%s cannot be used.", name, exc_info=True)
                reason = str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}."
                failures[name] = f"The model {name} cannot be used: {reason}"
        for sentence in failures.values():
            log.warning("%s", sentence)
        _failed.update(failures)
        _from_settings.update(entries, failures)


def _register_all() -> None:
    global _complete
    with _lock:  # re-entrant: a method's module may look at the registry while it is imported
        if _complete:
            return
        _complete = True
        for found in BUILT_IN:
            register(found)
        for entry in entry_points(group=ENTRY_POINTS):
            try:
                register(entry.load())
            except Exception as error:
                _fail(entry.value, error)
        for path in filter(None, os.environ.get(PATHS_VARIABLE, "").split(os.pathsep)):
            register_path(Path(path))
        register_settings()


def _import(file: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"pasdedeux_method_{file.stem}", file)
    if spec is None or spec.loader is None:
        raise InputError(f"{file.name} is not a Python file.")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _fail(where: str, error: Exception) -> None:
    _failed[where] = f"The method in {where} cannot be used: {type(error).__name__}: {error}"
    log.warning("%s", _failed[where])
