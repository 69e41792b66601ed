"""Rules as text, such as ``then(hands_meet(), walks_away(a))``: read without running any code of theirs.

A rule is one condition over predicates (of :mod:`.paths`, :mod:`.poses`, :mod:`.shapes` and
:mod:`.touches`), or several joined by ``and`` and ``or``. ``a`` and ``b`` are the two people; numbers, text and
keywords are passed on as they are.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from . import measures, paths, poses, shapes, touches  # noqa: F401 (they fill the vocabulary)
from .joints import PREDICATES, Mask, Motion, longest, stretches

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
        lacking: of what is missing, with what is needed: "done 1 time, not 3", "hands 12 cm apart, 5 cm needed"; never
            "" for a rule that does not hold.

    Raises:
        RuleError: as :func:`check`.
    """
    tree = ast.parse(rule, mode="eval").body
    if not lacking:
        return next(
            filter(None, (_figure(node, motion)[0] for node in _calls(tree) if _name(node.func) in PREDICATES)), ""
        )
    parts = list(tree.values) if isinstance(tree, ast.BoolOp) else [tree]
    failed = (part for part in parts if isinstance(part, ast.Call) and not _holds(part, rule, motion))
    return next(filter(None, (_lack(part, motion) for part in failed)), "")


def _lack(node: ast.Call, motion: Motion) -> str:
    """What is missing of a condition that does not hold."""
    name, calls = _name(node.func), [each for each in node.args if isinstance(each, ast.Call)]
    seen = [np.asarray(_value(each, motion)) for each in calls]
    figure, limit = _figure(calls[0], motion)
    if name == "never":
        more = "more" if _name(calls[0].func) in measures.AT_MOST else "less"
        return f"{figure or 'so for a while'}, {more}{f' than {limit}' * bool(limit)} needed"
    for each, mask in zip(calls, seen, strict=True):
        if not mask.any():
            return _needed(each, motion)
    if name in ("times", "exactly"):
        count = _times(motion, seen[0])
        asked = _value(node.args[1], motion)
        return f"done {count} time{'s' * (count != 1)}, {f'not {asked}' if name == 'exactly' else f'{asked} needed'}"
    if len(calls) > 1:
        return f"all of it is seen, but not {'at the same time' if name == 'together' else 'in this order'}"
    least = _value(node.args[1], motion) if len(node.args) > 1 else {"mostly": 0.6}.get(name, SHORTEST)
    lasts = longest(seen[0], motion.fps)
    if name == "mostly":
        least, lasts = least * motion.frames / motion.fps, seen[0].sum() / motion.fps
    when = {"start": "not at the start", "end": "not at the end"}.get(name, f"{least:.1f} s needed")
    return f"{figure} for {lasts:.2f} s, {when}".strip()


def _needed(node: ast.Call, motion: Motion) -> str:
    """The figure of a predicate that holds in no frame, and what it asks for."""
    inner = [each for each in node.args if isinstance(each, ast.Call)]
    if inner:
        lacks = (each for each in inner if not np.any(_value(each, motion)))
        return next((_needed(each, motion) for each in lacks), "seen one by one, but not at the same time")
    figure, limit = _figure(node, motion)
    return (
        f"{figure}, {limit} needed" if limit else f"{figure}{', ' * bool(figure)}needed: {_call(node, motion, _ASKS)}"
    )


def _figure(node: ast.Call, motion: Motion) -> tuple[str, str]:
    """As :func:`.measures.figure`."""
    return _call(node, motion, _FIGURES)


_FIGURES: dict[str, Callable[..., Any]] = {name: partial(measures.figure, name) for name in PREDICATES}
_ASKS: dict[str, Callable[..., Any]] = {name: partial(measures.asks, name) for name in PREDICATES}


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
