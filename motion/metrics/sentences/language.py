"""Rules as text, such as ``then(hands_meet(), walks_away(a))``: read without running any code of theirs.

A rule is one condition over predicates (of :mod:`.paths`, :mod:`.poses`, :mod:`.shapes` and
:mod:`.touches`), or several joined by ``and`` and ``or``. ``a`` and ``b`` are the two people; numbers, text and
keywords are passed on as they are.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from . import paths, poses, shapes, touches  # noqa: F401 (they fill the vocabulary)
from .joints import PREDICATES, Mask, Motion, longest, stretches
from .measures import MEASURES
from .paths import WALK

SLACK = 0.3
"""Seconds by which the middle of a later beat may come before the end of an earlier one."""
SHORTEST = 0.1
"""Seconds that a beat lasts at least."""
EDGE = 0.5
"""Seconds that count as the start or the end of a motion."""

CONDITIONS: dict[str, Callable[..., bool]] = {}
"""The conditions by the name that rules use."""


def condition(function: Callable[..., bool]) -> Callable[..., bool]:
    """Adds a condition to the language, under its name without a final underscore."""
    CONDITIONS[function.__name__.rstrip("_")] = function
    return function


@condition
def happens(m: Motion, mask: Mask, seconds: float = SHORTEST) -> bool:
    """It holds for ``seconds`` in one stretch."""
    return longest(mask, m.fps) >= seconds - 1e-9


@condition
def never(m: Motion, mask: Mask, seconds: float = 0.2) -> bool:
    """It holds for less than ``seconds`` in every stretch."""
    return longest(mask, m.fps) < seconds


@condition
def mostly(m: Motion, mask: Mask, share: float = 0.6) -> bool:
    """It holds for that share of all frames."""
    return bool(mask.mean() >= share)


@condition
def times(m: Motion, mask: Mask, count: int) -> bool:
    """It holds in ``count`` stretches or more."""
    return _times(m, mask) >= count


@condition
def exactly(m: Motion, mask: Mask, count: int) -> bool:
    """It holds in ``count`` stretches, no more and no fewer."""
    return _times(m, mask) == count


def _times(m: Motion, mask: Mask) -> int:
    """In how many stretches it holds."""
    return len([1 for i, j in stretches(mask, m.fps, pause=0.1) if j - i >= 2])


@condition
def start(m: Motion, mask: Mask) -> bool:
    """It holds for most of the first half second."""
    return bool(mask[: round(EDGE * m.fps)].mean() > 0.5)


@condition
def end(m: Motion, mask: Mask) -> bool:
    """It holds for most of the last half second."""
    return bool(mask[-round(EDGE * m.fps) :].mean() > 0.5)


@condition
def then(m: Motion, *masks: Mask) -> bool:
    """The beats come in this order: the middle of each is no more than 0.3 s before the end of the last."""
    after = -np.inf
    for mask in masks:
        spans = [
            (i, j)
            for i, j in stretches(mask, m.fps)
            if j - i >= SHORTEST * m.fps and (i + j) / 2 >= after - SLACK * m.fps
        ]
        if not spans:
            return False
        after = min(j for _, j in spans)
    return True


@condition
def together(m: Motion, first: Mask, second: Mask, seconds: float = 0.5) -> bool:
    """A stretch of one has its middle within ``seconds`` of the middle of a stretch of the other."""
    middles = [[(i + j) / 2 for i, j in stretches(mask, m.fps)] for mask in (first, second)]
    return any(abs(x - y) <= seconds * m.fps for x in middles[0] for y in middles[1])


class RuleError(ValueError):
    """A rule that cannot be read."""


def check(rule: str, motion: Motion) -> bool:
    """True if a motion fulfils one rule.

    Raises:
        RuleError: if the rule uses a word that the language does not have.
    """
    try:
        tree = ast.parse(rule, mode="eval").body
    except SyntaxError as error:
        raise RuleError(f"The rule {rule!r} cannot be read: {error.msg}.") from error
    return _holds(tree, rule, motion)


def measured(rule: str, motion: Motion, *, lacking: bool = False) -> str:
    """A plain measure of the first predicate of a rule that has one (:mod:`.measures`), or "".

    Args:
        rule: as for :func:`check`.
        motion: of two people.
        lacking: of what is missing: how often it is done, if that is wrong, "done 1 time, not 3"; else the first that
            holds in no frame, with what it asks for: "hands 12 cm apart, 5 cm needed".

    Raises:
        RuleError: as :func:`check`.
    """
    least = ""
    for node in _calls(ast.parse(rule, mode="eval").body):
        if lacking and _name(node.func) in ("times", "exactly"):
            mask, count = (_value(argument, motion) for argument in node.args)
            if 0 < (seen := _times(motion, mask)) < count or (seen > count and _name(node.func) == "exactly"):
                return f"done {seen} time{'s' * (seen != 1)}, not {count}"
        if _name(node.func) in MEASURES:
            held = lacking and bool(np.any(_value(node, motion)))
            said, limit = str(_call(node, motion, MEASURES)), _limit(node, motion) if lacking and not held else ""
            said += limit * all((unit in said) == (unit in limit) for unit in ("°", "m/s"))
            if not held:
                return said
            least = least or said  # it is so, and not for long enough, or too often
    return least


def _limit(node: ast.Call, motion: Motion) -> str:
    """The distance or angle that a predicate asks for, as ", 5 cm needed"; "" where it names none."""
    arguments = [_value(argument, motion) for argument in node.args]
    named = {str(keyword.arg): _value(keyword.value, motion) for keyword in node.keywords}
    bound = inspect.signature(PREDICATES[_name(node.func)]).bind(motion, *arguments, **named)
    bound.apply_defaults()
    for name, value in reversed(bound.arguments.items()):
        if name in ("gap", "metres", "over", "rise", "drop") and isinstance(value, float) and value > 0:
            return f", {100 * value:.0f} cm needed" if value < 1 else f", {value:.1f} m needed"
        if name == "speed" and isinstance(value, float) and value > WALK:
            return f", {value:.1f} m/s needed"
        if name == "degrees" and isinstance(value, (int, float)):
            return f", {value:.0f}° needed"
    return ""


def masks(rule: str) -> list[str]:
    """The predicate of each condition of a rule, as text; of several in an order the last, which fulfils it."""
    conditions = [c for c in _calls(ast.parse(rule, mode="eval").body) if _name(c.func) in CONDITIONS]
    return [ast.unparse(c.args[-1 if _name(c.func) == "then" else 0]) for c in conditions if c.args]


def mask_of(predicate: str, motion: Motion) -> Mask:
    """(T,) the frames at which a predicate holds, as :func:`masks` gives it.

    Raises:
        RuleError: as :func:`check`.
    """
    return np.asarray(_value(ast.parse(predicate, mode="eval").body, motion), dtype=bool)


def _calls(node: ast.expr) -> Iterator[ast.Call]:
    """The calls of a rule, from the outside in and from left to right."""
    if isinstance(node, ast.Call):
        yield node
        for argument in node.args:
            yield from _calls(argument)
    elif isinstance(node, ast.BoolOp):
        for part in node.values:
            yield from _calls(part)


def _holds(node: ast.expr, rule: str, motion: Motion) -> bool:
    if isinstance(node, ast.BoolOp):
        held = [_holds(part, rule, motion) for part in node.values]  # all of them, so that a wrong word is found
        return all(held) if isinstance(node.op, ast.And) else any(held)
    if not isinstance(node, ast.Call) or _name(node.func) not in CONDITIONS:
        raise RuleError(f"The rule {rule!r} must begin with one of {', '.join(CONDITIONS)}.")
    return bool(_call(node, motion, CONDITIONS))


def _call(node: ast.Call, motion: Motion, known: dict[str, Callable[..., Any]]) -> Any:
    name = _name(node.func)
    if name not in known:
        raise RuleError(f"{name!r} is not known here: use one of {', '.join(known)}.")
    arguments = [_value(argument, motion) for argument in node.args]
    named = {str(keyword.arg): _value(keyword.value, motion) for keyword in node.keywords}
    try:
        return known[name](motion, *arguments, **named)
    except (TypeError, KeyError) as error:
        raise RuleError(f"{ast.unparse(node)} does not fit {name}: {error}.") from error


def _value(node: ast.expr, motion: Motion) -> Any:
    if isinstance(node, ast.Call):
        return _call(node, motion, PREDICATES)
    if isinstance(node, ast.Name) and node.id in ("a", "b"):
        return "ab".index(node.id)
    try:
        return ast.literal_eval(node)
    except ValueError as error:
        raise RuleError(f"{ast.unparse(node)!r} is neither a person, a number nor a predicate.") from error


def _name(node: ast.expr) -> str:
    return node.id if isinstance(node, ast.Name) else ast.unparse(node)
