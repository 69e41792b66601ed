"""The registry of methods: the one list that everything else reads.

Those that ship are in :mod:`.built_in`; models of a lab's own enter by a table ``[models.NAME]`` of the settings
(:mod:`webdemo.inference.own`). Importing this module imports no torch.
"""

from __future__ import annotations

import json
import logging
import os
import threading

from motion import InputError
from webdemo.inference.built_in import BUILT_IN, REACTIONS_VARIABLE
from webdemo.inference.method import WEIGHTS, Method, Task, Variant
from webdemo.inference.own.classes import class_method
from webdemo.inference.own.entries import read_entries
from webdemo.inference.own.released import released_method

log = logging.getLogger(__name__)

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
    known = _registered.get(name)
    if known is None and name in _failed:
        raise InputError(_failed[name])
    if known is not None and (task is None or task in known.tasks):
        return known
    wrong = f"There is no model {name!r:.40}" if known is None else f"{known.label} does not {task}"
    raise InputError(f"{wrong}: choose one of {', '.join(m.name for m in methods(task))}.")


def automatic(prompt: str, role: str, mode: str = "offline") -> Method:
    """The method for a reaction that nobody chose one for: the one with the best score in docs/reactions.md.

    Words go to the default method, which follows them (docs/scores.md). Without words, a person who acts first is
    answered by the nearest recorded reaction where a lab has recordings of its own, and else by ReGenNet. Frame by
    frame, the first method answers that can.
    """
    candidates = methods("react")
    if mode != "offline":
        return next((m for m in candidates if mode in m.modes), candidates[0])
    if prompt.strip() or role != "a":
        return candidates[0]
    best = method("nearest" if os.environ.get(REACTIONS_VARIABLE) else "regennet")
    return best if best.installed(WEIGHTS) else candidates[0]


def reactor(name: str, prompt: str, role: str, mode: str = "offline") -> Method:
    """A method for a reaction by name, or the one that :func:`automatic` chooses; raises InputError as method."""
    return automatic(prompt, role, mode) if name == AUTOMATIC else method(name, "react")


def label_of(name: str) -> str:
    """The label of a method; its name if it is not registered, as in an old history."""
    _register_all()
    return _registered[name].label if name in _registered else name


def variants(task: Task) -> dict[str, Variant]:
    """The methods for a task in each of their modes, by key."""
    return {variant.key: variant for m in methods(task) for variant in m.variants}


def installed(task: Task) -> tuple[Method, ...]:
    """The methods for a task whose weights are there; the task's default is always among them."""
    return tuple(m for i, m in enumerate(methods(task)) if i == 0 or m.installed(WEIGHTS))


def failed() -> dict[str, str]:
    """Models that cannot be used: the name in the settings → one sentence on why."""
    _register_all()
    return dict(_failed)


def register(added: Method) -> None:
    """Adds a method of a lab's own.

    Raises:
        InputError: if its name is taken.
    """
    _register_all()
    if added.name in _registered:
        raise InputError(f"There is a method named {added.name} already: choose another name.")
    _registered[added.name] = added


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
                register(class_method(entry) if entry.pipeline else released_method(entry))
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
        for shipped in BUILT_IN:
            register(shipped)
        register_settings()


def takes_class(name: str) -> bool:
    """True if a method takes the name of a class instead of a sentence."""
    return "class" in method(name).takes


def by_class() -> Method:
    """The method that makes two people from a class."""
    return next(each for each in methods("generate") if "class" in each.takes)


def installed_classes() -> list[str]:
    """Names of the classes; none where there are no weights."""
    try:
        meta = json.loads((WEIGHTS / str(by_class().weights) / "config.json").read_text())
        return list(map(str, meta["model"]["labels"]))
    except (OSError, ValueError, KeyError, TypeError):
        return []
