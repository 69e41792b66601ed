"""From duets to a table: shares of verdicts that pass, and physical measures beside real motion's."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

from scipy.stats import binomtest

from motion import Duet
from motion.metrics.physical import PHYSICAL, physical

from .rules import CHECKS, Task, judge

_WORDS = {
    "side": "the hand the words name moves",
    "contact": "hands or hand and body meet",
    "distance": "they come nearer, part or keep their distance",
    "facing": "they face each other",
    "order": "two actions in the order of the words",
}


def score(duets: Sequence[Duet], tasks: Sequence[Task]) -> dict[str, Any]:
    """Scores of duets against the sentences they should show.

    Returns:
        ``checks``: for each check ``passed`` and ``count``, overall and by family; ``verdicts``: for each
        duet its caption, family and verdicts; ``physical``: means over the duets (:data:`PHYSICAL`).
    """
    rows = []
    tally: dict[str, dict[str, list[bool]]] = {check: defaultdict(list) for check in CHECKS}
    for duet, task in zip(duets, tasks, strict=True):
        verdicts = judge(duet, task)
        for verdict in verdicts:
            tally[verdict.check][task.family].append(verdict.passed)
        rows.append(
            {
                "caption": task.caption,
                "family": task.family,
                "verdicts": {v.check: {"passed": v.passed, "value": _number(v.value)} for v in verdicts},
            }
        )
    checks = {}
    for check, families in tally.items():
        flags = [flag for found in families.values() for flag in found]
        checks[check] = {
            "passed": sum(flags),
            "count": len(flags),
            "families": {name: [sum(found), len(found)] for name, found in sorted(families.items())},
        }
    return {"checks": checks, "physical": physical(duets), "verdicts": rows}


def _number(value: float) -> float | None:
    """A number for JSON, which knows no NaN."""
    return round(value, 4) if math.isfinite(value) else None


def table(scores: dict[str, Any]) -> str:
    """The scores as Markdown: what a person would check, then the physical measures.

    Args:
        scores: ``real``, ``other`` and, where motion was generated, ``generated``, each as :func:`score`
            gives it, ``about``, a line on what was judged, and perhaps ``everyday``, the scores of
            :func:`training.evaluate.judge.prompts.everyday`.
    """
    made = scores.get("generated")
    lines = [
        scores["about"],
        "",
        "| Check | Generated (95 % interval) | Real motion | Motion of other words |",
    ]
    lines.append("|---|---|---|---|")
    for check in CHECKS:
        cells = [_share(scores[kind]["checks"][check]) for kind in ("real", "other")]
        own = _share(made["checks"][check], interval=True) if made else "–"
        lines.append(f"| {check}: {_WORDS[check]} | {own} | {cells[0]} | {cells[1]} |")
    lines += ["", "| Measure | Generated | Real motion | Ratio |", "|---|---|---|---|"]
    for key, (label, unit) in PHYSICAL.items():
        real = scores["real"]["physical"][key]
        own = made["physical"][key] if made else None
        ratio = f"{own / real:.2f}" if own is not None and real > 0 else "–"
        shown = "–" if own is None else f"{own:.3g}"
        lines.append(f"| {label}, {unit} | {shown} | {real:.3g} | {ratio} |")
    if everyday := scores.get("everyday"):
        lines += [
            "",
            f"| {len(everyday['verdicts'])} sentences written by hand | Generated (95 % interval) |",
            "|---|---|",
        ]
        lines += [
            f"| {check}: {_WORDS[check]} | {_share(everyday['checks'][check], interval=True)} |"
            for check in CHECKS
        ]
    return "\n".join(lines) + "\n"


def reactions_table(scores: Mapping[str, dict[str, Any]]) -> str:
    """A row for each method; ``scores`` are those of :func:`score`, by the method's name."""
    heads = [*CHECKS, *(f"{label}, {unit}" for label, unit in PHYSICAL.values())]
    count = max(len(found["verdicts"]) for found in scores.values())
    lines = [f"| Person b for a recorded person a, {count} captions | {' | '.join(heads)} |"]
    lines.append("|---" * (len(heads) + 1) + "|")
    for method, found in scores.items():
        cells = [_share(found["checks"][check]) for check in CHECKS]
        cells += [f"{found['physical'][key]:.3g}" for key in PHYSICAL]
        lines.append(f"| {method} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _share(found: dict[str, Any], *, interval: bool = False) -> str:
    passed, count = found["passed"], found["count"]
    if not count:
        return "–"
    text = f"{100 * passed / count:.0f} % ({passed}/{count}"
    if interval:
        bounds = binomtest(passed, count).proportion_ci(method="wilson")
        text += f"; {100 * bounds.low:.0f}–{100 * bounds.high:.0f} %"
    return text + ")"
