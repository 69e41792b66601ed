"""Words of the page on progress, errors, numbers and what was asked."""

from __future__ import annotations

import errno
import html
import logging
import time
from collections.abc import Mapping
from typing import Any

from motion import InputError
from webdemo.inference.methods import label_of, methods, variants
from webdemo.inference.run import Progress
from webdemo.ui.runs import Waiting
from webdemo.ui.visitor import visitor

from .texts import texts

log = logging.getLogger(__name__)

_WORK = {"step": "Denoising", "pass": "Predicting"}
"""What is done, by the unit in which it is counted."""
_ROLES = {"a": "acts first", "b": "reacts"}
_PACE_STEPS = 3
"""Steps after which the pace is known, or a tenth of them all."""
_SHORT = 3.0
"""Seconds: less than this is not announced."""


def text(value: object) -> str:
    """Any value as text inside HTML: no tags, no attributes, no ``${…}`` of a template."""
    escaped = html.escape(str(value), quote=True)
    return escaped.replace("$", "&#36;").replace("{", "&#123;").replace("}", "&#125;").replace("`", "&#96;")


def progress_line(progress: Progress) -> str:
    """One line for a progress event, such as "Denoising: step 12 of 50, about 10 s left"."""
    if isinstance(progress, Waiting):
        left = progress.seconds_left
        soon = "" if left is None else f", about {_about(left)} until it starts"
        return f"Waiting in line: place {progress.step} of {progress.total}{soon} …"
    line = texts().get(f"stage.{progress.stage}", f"{progress.stage.capitalize()} …")
    if progress.stage == "sample":
        work = _WORK.get(progress.unit, "Generating")
        line = f"{work}: {progress.unit} {progress.step} of {progress.total}{_left(progress)}"
    return f"{tries_line(progress)}{line}"


def tries_line(progress: Progress) -> str:
    """The words before the progress of one of several tries: "Try 2 of 4. "; "" where there is one."""
    return f"Try {progress.attempt} of {progress.attempts}. " if progress.attempts > 1 else ""


def _left(progress: Progress) -> str:
    """The time left at the pace so far; empty while there is no pace, or if little is left."""
    if progress.step < max(_PACE_STEPS, progress.total / 10):
        return ""
    done = (progress.attempt - 1) * progress.total + progress.step  # earlier tries took their time as well
    left = progress.elapsed / done * (progress.total - progress.step)
    return f", about {_about(left)} left" if left >= _SHORT else ""


def _about(duration: float) -> str:
    """A duration as rough as it is known: "5 s", "40 s", "3 min"."""
    return f"{max(5, round(duration / 5) * 5)} s" if duration < 100 else f"{round(duration / 60)} min"


def cancelled_line(progress: Progress | None) -> str:
    """The sentence after a cancellation, with the last step that was done."""
    if progress is None or progress.stage != "sample":
        return "Cancelled before the first step."
    number = f" of try {progress.attempt}" if progress.attempts > 1 else ""
    return f"Cancelled at {progress.unit} {progress.step} of {progress.total}{number}."


def error_line(error: Exception) -> str:
    """The sentence for an error; an error of the program's own goes to the log with its traceback."""
    if isinstance(error, InputError):
        return str(error)
    log.error("A request failed.", exc_info=error, extra={"request": visitor().reference})
    if isinstance(error, OSError) and error.errno == errno.ENOSPC:
        return "The disk is full: free some space and try again."
    if isinstance(error, OSError):
        return f"A file could not be read or written ({error.strerror or error}): try again."
    if isinstance(error, MemoryError):
        return "There is not enough memory for this: ask for a shorter motion or fewer samples."
    reference = visitor().reference
    where = f"its log says more under {reference}" if reference else "its log says more"
    return f"Something went wrong inside the program ({type(error).__name__}); {where}. Try again."


def day(moment: float, clock: str = "") -> str:
    """A moment in seconds since 1970 as "5 Mar 2026" at the server, or with its time where ``clock`` is " %H:%M"."""
    return time.strftime(f"%d %b %Y{clock}", time.localtime(moment)).lstrip("0")


def link_line(until: float) -> str:
    """A sentence on who can open a new link, and until when."""
    signed = " and can sign in here" if visitor().account else ""
    return f"Anyone who has this link{signed} can see the motion until {day(until)}, unless you end its links first."


def counted(number: int, what: str) -> str:
    """Such as "one pair" or "12 pairs"."""
    return f"one {what}" if number == 1 else f"{number} {what}s"


def number(value: float, digits: int) -> str:
    """A number with ``digits`` after the point and a thin space between thousands."""
    return f"{value:,.{digits}f}".replace(",", "\u202f")


def seconds(value: float) -> str:
    """A duration: "0.24 s", "3.1 s", "72 s"."""
    return f"{value:.2f} s" if value < 1 else f"{value:.1f} s" if value < 60 else f"{value:.0f} s"


def settings(asked: Mapping[str, Any]) -> list[list[str]]:
    """(name, value) of everything that a run was asked with."""
    rows = [["Method", method_label(asked) or label_of(str(asked.get("model", "")))]]
    given = asked.get("actor") or asked.get("motion")
    if isinstance(given, Mapping):
        rows.append(["Given", str(given.get("name", ""))])
    if "actor" in asked:
        rows.append(["The given person", _ROLES.get(str(asked.get("role")), "")])
    for key, name in texts().items():
        kind, _, field = key.partition(".")
        value = asked.get(field) if kind == "settings" else None
        if isinstance(value, bool):
            rows.append([name, "on" if value else "off"])
        elif value is not None:  # of a file from elsewhere it may be anything
            rows.append([name, f"{value:g}" if isinstance(value, float) else str(value)])
    return [pair for pair in rows if pair[1]]


def method_label(asked: Mapping[str, Any]) -> str:
    """The label of the method of a run; "" for the one that sentences go to by default."""
    model, mode = str(asked.get("model", "")), asked.get("mode")
    if asked.get("kind") == "generate" and model in ("", methods("generate")[0].name):
        return ""
    if asked.get("kind") == "react":
        known = (v.label for v in variants("react").values() if (v.method.name, v.mode) == (model, mode))
        return next(known, label_of(model))
    return label_of(model)
