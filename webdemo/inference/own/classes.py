"""Python classes of a lab's own as methods, and the fence around them: a broken one fails alone."""

from __future__ import annotations

import importlib
import importlib.util
import logging
import re
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, get_args

import numpy as np

from motion import Clip, Duet, InputError
from motion.skeleton import SMPL22
from webdemo.inference.method import SECONDS, Method, Pipeline, Task
from webdemo.inference.run import Cancelled, CancelToken, Progress, Result, StageTimer

from .entries import Entry

log = logging.getLogger(__name__)

_FOLDERS = re.compile(r"(?<![\w.])/(?:[^\s/'\":]+/)+")
TASKS = get_args(Task)
INPUTS = ("words", "actor", "first pose", "either role", "past")


def class_method(entry: Entry) -> Method:
    """The method of an entry that names a class.

    Raises:
        InputError: one sentence on why the class cannot be used.
    """
    return method_of_class(find_class(entry.pipeline, entry.folder), name=entry.name, label=entry.label)


def method_of_class(pipeline: Any, *, name: str = "", label: str = "") -> Method:
    """The method of a class with the :class:`~webdemo.inference.method.Pipeline` protocol.

    The class may say more in attributes: ``label``, ``summary``, ``tasks``, ``takes``, ``seconds``, ``defaults``,
    ``fixed``, ``samplers`` and, for reactions, ``modes``, as in :class:`Method`.

    Raises:
        InputError: if it lacks ``run``, or an attribute has a value that nothing can be done with.
    """
    if not isinstance(pipeline, type) or not callable(getattr(pipeline, "run", None)):
        raise InputError("it is not a class with a method `run(request, cancel, timer)`.")
    name = name or str(getattr(pipeline, "name", "") or pipeline.__name__.lower())
    tasks = _texts(pipeline, "tasks", ("generate",), TASKS)
    assumed = {"generate": ("words",), "react": ("actor",), "predict": ("past",), "scene": ("words",)}
    takes = _texts(pipeline, "takes", tuple(t for task in tasks for t in assumed[task]), INPUTS)
    seconds = getattr(pipeline, "seconds", SECONDS)
    if not (isinstance(seconds, tuple | list) and len(seconds) == 2 and 0 < seconds[0] <= seconds[1] <= 60):
        raise InputError("its `seconds` must be the shortest and the longest motion, such as (1.0, 10.0).")
    return Method(
        name=name,
        label=label or str(getattr(pipeline, "label", name)),
        summary=str(getattr(pipeline, "summary", "A model of this lab's own.")),
        tasks=tasks,  # type: ignore[arg-type]
        takes=frozenset(takes),  # type: ignore[arg-type]
        seconds=(float(seconds[0]), float(seconds[1])),
        modes=dict(getattr(pipeline, "modes", {})),
        defaults=dict(getattr(pipeline, "defaults", {})),
        fixed=dict(getattr(pipeline, "fixed", {})),
        samplers=tuple(getattr(pipeline, "samplers", ("ddim", "dpm++"))),
        load=partial(_load, pipeline, name),
    )


def find_class(place: str, folder: Path) -> Any:
    """The class at ``file.py:Class``, relative to a folder, or at ``package.module:Class``.

    Raises:
        InputError: if it cannot be imported, whatever the file itself raises.
    """
    module, _, name = place.rpartition(":")
    if not module or not name.isidentifier():
        raise InputError(f"`pipeline` must be file.py:Class or package.module:Class, not {place!r:.60}.")
    try:
        loaded = _from_file(folder / module) if module.endswith(".py") else importlib.import_module(module)
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        log.warning("%s cannot be imported.", module, exc_info=True)
        raise InputError(f"importing {module} raised {_named(error)}.") from error
    pipeline = getattr(loaded, name, None)
    if pipeline is None:
        raise InputError(f"{module} has no class {name}.")
    return pipeline


def _from_file(path: Path) -> Any:
    if not path.is_file():
        raise InputError(f"there is no file {path.name}.")
    if str(path.parent) not in sys.path:  # so that the file can import others beside it
        sys.path.append(str(path.parent))
    spec = importlib.util.spec_from_file_location(f"pasdedeux_own_{path.stem}", path)
    assert spec is not None and spec.loader is not None  # its name ends in .py
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[spec.name]
        raise
    return module


def _texts(pipeline: Any, attribute: str, otherwise: tuple[str, ...], known: tuple[str, ...]) -> tuple[str, ...]:
    value = getattr(pipeline, attribute, otherwise)
    if isinstance(value, str) or not value or not set(value) <= set(known):
        raise InputError(f"its `{attribute}` must be some of {', '.join(known)}, not {value!r:.60}.")
    return tuple(value)


def _named(error: BaseException) -> str:
    """The error for a sentence, on one line and without the folders of this machine; the log has all of it."""
    text = " ".join(f"{type(error).__name__}: {error}".split())
    return _FOLDERS.sub("", text)[:300].rstrip(".")


def _load(pipeline: Any, name: str, folder: Path) -> Pipeline:
    """Makes the pipeline; ``folder`` is that of shipped weights, which it does not get."""
    try:
        return Fenced(pipeline(), name)
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        log.warning("The model %s cannot be made.", name, exc_info=True)
        raise InputError(f"The model {name} cannot be loaded: it raised {_named(error)}.") from error


class Fenced:
    """A pipeline of a lab's own: what it raises or gives wrongly ends its run with one sentence.

    Args:
        inner: the lab's object.
        name: of the model.
    """

    def __init__(self, inner: Any, name: str) -> None:
        self.inner, self.name = inner, name
        self.digest = str(getattr(inner, "digest", ""))

    def __getattr__(self, attribute: str) -> Any:
        return getattr(self.inner, attribute)

    def run(self, request: Any, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """As the pipeline's own, checked event by event.

        Raises:
            InputError: if the pipeline raises anything but Cancelled, or gives what is no result.
        """
        try:
            for event in self.inner.run(request, cancel, timer):
                if isinstance(event, Result):
                    yield self._checked(event)
                    return
                if not isinstance(event, Progress):
                    raise InputError(f"The model {self.name} gave {event!r:.60}, not Progress or a Result.")
                yield event
        except (InputError, Cancelled):
            raise
        except (Exception, SystemExit) as error:
            log.warning("The model %s failed.", self.name, exc_info=True)
            raise InputError(f"The model {self.name} failed: it raised {_named(error)}.") from error
        raise InputError(f"The model {self.name} ended without a Result: yield one at the end of `run`.")

    def _checked(self, result: Result) -> Result:
        wrong = ""
        if not result.duets or not all(isinstance(duet, Duet | Clip) for duet in result.duets):
            wrong = "no motion of two people"
        elif any(duet.skeleton.joint_names != SMPL22.joint_names for duet in result.duets):
            wrong = "people who do not have SMPL's 22 joints"
        elif not all(np.isfinite(person.positions).all() for d in result.duets for person in d.people):
            wrong = "positions that are not finite"
        if wrong:
            raise InputError(f"The model {self.name} gave {wrong}: see docs/own-model.md.")
        return result
