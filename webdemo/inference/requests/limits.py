"""Limits of requests: the numbers, and the checks that say in a sentence what is wrong and what to do."""

from __future__ import annotations

import math
from typing import Any

from motion import InputError

MAX_PROMPT = 500
STEPS = (1, 1000)
SAMPLES = (1, 8)
TRIES = (1, 4)
GUIDANCE = (0.0, 10.0)
DAMPING = (0.0, 1.0)
STRICTNESS = (0.0, 1.0)
MAX_SEED = 2**32 - 1
SAMPLERS = ("ddim", "dpm++")
_NUMBERS: dict[str, tuple[str, float, float]] = {
    "guidance": ("Guidance scale", *GUIDANCE),
    "damping": ("Damping threshold", *DAMPING),
    "strictness": ("Strictness", *STRICTNESS),
}
_WHOLE: dict[str, tuple[str, int, int]] = {
    "seed": ("Seed", 0, MAX_SEED),
    "samples": ("Samples", *SAMPLES),
    "tries": ("Tries", *TRIES),
    "steps": ("DDIM steps", *STEPS),
}
"""Fields of requests that are numbers, and whole ones, with what messages call them and their limits."""


def check_settings(request: object) -> None:
    """Sets those of a request's fields that are numbers to numbers, and checks its sampler.

    Raises:
        InputError: one sentence on a value that is none, or outside of its limits.
    """
    for name, limits in _WHOLE.items():
        if hasattr(request, name):
            object.__setattr__(request, name, whole(limits[0], getattr(request, name), *limits[1:]))
    for name, bounds in _NUMBERS.items():
        if hasattr(request, name):
            object.__setattr__(request, name, number(bounds[0], getattr(request, name), *bounds[1:]))
    choice("Sampler", getattr(request, "sampler", SAMPLERS[0]), SAMPLERS)


def number(name: str, value: Any, low: float, high: float, unit: str = "") -> float:
    """The value if it is a finite number from ``low`` to ``high``; raises InputError, a sentence, if it is not."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise InputError(f"{name} must be a number from {_plain(low)} to {_plain(high)}{unit}, not {value!r:.40}.")
    if not low <= value <= high:
        raise InputError(f"{name} must be from {_plain(low)} to {_plain(high)}{unit}, not {_plain(value)}.")
    return float(value)


def _plain(value: float) -> str:
    """A number as people write it: 4,294,967,295 rather than 4.29497e+09."""
    return f"{int(value):,}" if 1e4 <= abs(value) < 1e15 and value == int(value) else f"{value:g}"


def whole(name: str, value: Any, low: int, high: int) -> int:
    """As :func:`number`, for a whole one."""
    found = number(name, value, low, high)
    if found != int(found):
        raise InputError(f"{name} must be a whole number from {_plain(low)} to {_plain(high)}, not {value:g}.")
    return int(found)


def prompt_of(value: Any, *, needed: bool) -> str:
    """The value if it is a prompt; raises InputError where it is too long, or empty though ``needed``."""
    if not isinstance(value, str) or (needed and not value.strip()):
        raise InputError("The prompt is empty: say in a sentence what the two people do.")
    if len(value) > MAX_PROMPT:
        raise InputError(f"The prompt has {len(value):,} characters: shorten it to {MAX_PROMPT} or fewer.")
    return value


def choice(name: str, value: Any, known: tuple[str, ...]) -> None:
    """Raises InputError for a value that is not among those known."""
    if value not in known:
        raise InputError(f"{name} {value!r:.40} is not known: choose one of {', '.join(known)}.")
