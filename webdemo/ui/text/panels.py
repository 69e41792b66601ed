"""The page's small pieces of HTML: status, read-outs, model card. Every text in them is escaped."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import Any

from motion.metrics import MEASURES, Measure
from webdemo.inference.run import Result
from webdemo.inference.story.beats import kept_plan

from .texts import say
from .words import number, seconds, settings, text

Summary = Mapping[str, float]

QUALITY = tuple(measure for measure in MEASURES if measure.better)
RELATION = tuple(measure for measure in MEASURES if not measure.better)
_NO_WARNINGS = ("This was made as ", "Read as ", "After ")
"""Beginnings of notes that say how a sentence or a gesture was understood."""
_VERDICT = ("Done", "Not understood:", "Not measured:", "Not seen:", "This is the ", "Best of ")
"""Beginnings of the note on the acts, which the reading under the prompt shows at its chips."""


def status(line: str = "", *, tone: str = "quiet") -> str:
    """The line under the buttons.

    Args:
        line: one sentence, or a few.
        tone: "quiet", "note", "busy", "done", "warning" or "error"; errors are announced at once.
    """
    if not line:
        return ""
    role = "alert" if tone == "error" else "status"
    return f'<p class="pd-status pd-{tone}" role="{role}">{text(line)}</p>'


def total(result: Result) -> float:
    """Seconds that a result took."""
    return result.timings.get("total", sum(result.timings.values()))


def made_line(result: Result) -> str:
    """How many samples were made, in how many seconds, and by which of several tries."""
    count, tries, spent = len(result.duets), result.manifest.get("tries"), total(result)
    made = "Made" if count == 1 else f"{count} samples made"
    within = f" in {seconds(spent)}" if spent else ""
    chosen = f", try {tries['won']} of {tries['made']}" if tries else ""
    return f"{made}{within}{chosen}."


def notes_lines(results: Mapping[str, Result]) -> str:
    """The notes of results by name, each once, but for those that the reading under the prompt shows."""
    named: dict[str, list[str]] = {}
    for name, result in results.items():
        plan = kept_plan(result.manifest)
        read = {note for acts in plan.acts for note in acts.notes} if plan else set()
        for note in result.notes:
            if note not in read and not note.startswith(_VERDICT):
                named.setdefault(note, []).append(name)
    return "".join(
        status(
            note if len(names) == len(results) else f"{', '.join(names)}: {note}",
            tone="note" if note.startswith(_NO_WARNINGS) else "warning",
        )
        for note, names in named.items()
    )


def effect_line(results: Iterable[Result]) -> str:
    """What the settings did: what share of sentences' motion the plan fixes, and what damping moved and changed.

    "" where no result says either.
    """
    readouts = [each for made in results for each in made.readouts]
    shares = [100 * each["planned"] for each in readouts if "planned" in each]
    said = ""
    if shares:
        least, most = (f"{edge:.0f}" for edge in (min(shares), max(shares)))
        share = most if least == most else f"{least} to {most}"
        said = f"The plan fixes {share} % of this motion; the settings here change the rest."
        said = "The plan fixes all of this motion: the settings here change little." if least == "100" else said
        said = "The network makes all of this motion." if most == "0" else said
    if moved := [100 * each["damped"] for each in readouts if each.get("damped")]:
        said += f" At the last step damping moved the joints by {sum(moved) / len(moved):.1f} cm on average."
    before, after = sides(readouts[0]) if readouts else (None, {})
    pairs = [(measure, _value(measure, before or {}), _value(measure, after)) for measure in QUALITY]
    changed = [f"{m.label.lower()} {old} → {new} {m.unit}".strip() for m, old, new in pairs if old not in ("–", new)]
    said += f" Damping and clean-up: {', '.join(changed[:2])}." if changed else ""
    return f'<p class="pd-method pd-laid" role="status">{text(said.strip())}</p>' if said else ""


def method_line(summary: str) -> str:
    """A quiet line, such as on a method under the place where it is chosen."""
    return f'<p class="pd-method">{text(summary)}</p>'


def model_state(state: str, error: str | None = None) -> str:
    """The small mark in the header: whether the networks are loaded."""
    words = {
        "loading": say("page.loading"),
        "ready": say("page.ready"),
        "failed": text(error) if error else say("page.failed"),
    }
    return f'<p class="pd-model pd-model-{text(state)}" role="status">{words[state]}</p>'


def readout_panel(result: Result) -> str:
    """All figures of a result, behind a line: what was asked, measures, timings."""
    samples = [sides(readout) for readout in result.readouts]
    tables = ""
    if samples:
        compared = any(before is not None for before, _ in samples)
        caption = "Quality, before → after damping and clean-up" if compared else "Quality"
        heads = [f"Sample {i + 1}" for i in range(len(samples))] if len(samples) > 1 else ["Value"]
        columns = dict(zip(heads, samples, strict=True))
        after = {head: (None, each) for head, (_, each) in columns.items()}
        quality = measures_table(caption, QUALITY, columns)
        relation = measures_table("Between the two", RELATION, after)
        tables = f'<div class="pd-tables">{quality}{relation}</div>'
    spent = " · ".join(f"{stage} {seconds(taken)}" for stage, taken in result.timings.items())
    figures = f"{_asked(result)}{tables}{method_line(spent) if spent else ''}"
    shown = f'<details class="pd-figures"><summary>All figures</summary>{figures}</details>'
    return f'<div class="pd-readouts">{shown}</div>'


def prediction_lines(lines: Mapping[str, str]) -> str:
    """A line on the error of each prediction, after its name if there are several."""
    return "".join(
        f'<p class="pd-in-words">{f"<b>{text(name)}</b> " if name else ""}{text(line)}</p>'
        for name, line in lines.items()
    )


def sides(readout: Mapping[str, Any]) -> tuple[Summary | None, Summary]:
    """(before, after) of a read-out, as :func:`motion.metrics.compare` gives it, without what could not be measured."""
    before = readout.get("before")
    return _measured(before) if before else None, _measured(readout.get("after") or {})


def _measured(values: Mapping[str, Any]) -> Summary:
    return {key: value for key, value in values.get("summary", values).items() if value is not None}


def _asked(result: Result) -> str:
    asked = dict(settings(result.manifest.get("request", result.manifest)))
    if result.duets:  # a reaction and a scene are as long as what they are made of
        asked |= {"Seconds": f"{result.duets[0].seconds:.1f} s"}
    items = "".join(f"<div><dt>{name}</dt><dd>{text(value)}</dd></div>" for name, value in asked.items())
    return f'<dl class="pd-asked">{items}</dl>'


def measures_table(
    caption: str, measures: Sequence[Measure], columns: Mapping[str, tuple[Summary | None, Summary]], first: str = ""
) -> str:
    """A table: a row a measure under the row ``first``, and a column for what is (before, after) by its name."""
    rows = "".join(_row(measure, list(columns.values())) for measure in measures)
    return table(caption, list(columns), first + rows)


def _row(measure: Measure, columns: Sequence[tuple[Summary | None, Summary]]) -> str:
    """A measure's values, each after the one before where that reads differently, or the best and the worst marked."""
    cells, key = "", measure.key
    known = [round(after[key], measure.digits) for _, after in columns if key in after]
    for given, after in columns:
        before, tone = given or {}, ""
        old, new = _value(measure, before), _value(measure, after)
        changed = old not in ("–", new)
        if changed and key in after:
            tone = "pd-better" if after[key] < before[key] else "pd-worse"
        elif given is None and measure.better and key in after and len(set(known)) > 1:
            tone = {min(known): "pd-better", max(known): "pd-worse"}.get(round(after[key], measure.digits), "")
        cells += f'<td class="{tone}">{f"{old} → " if changed else ""}<b>{new}</b></td>'
    return f"{_head(measure)}{cells}</tr>"


def _value(measure: Measure, values: Summary) -> str:
    value = values.get(measure.key)
    return "–" if value is None else number(value, measure.digits)


@cache
def _head(measure: Measure) -> str:
    """The beginning of a measure's row."""
    unit = f" <small>{text(measure.unit)}</small>" if measure.unit else ""
    meaning, label = measure.meaning, measure.label
    return f'<tr title="{text(meaning)}"><th scope="row">{text(label)}{unit}</th>'


def table(caption: str, heads: Sequence[str], rows: str) -> str:
    """A table: ``heads`` over the columns behind the first, and ``rows`` as HTML with their tags."""
    cells = "".join(f'<th scope="col">{text(head)}</th>' for head in heads)
    named = f"<caption>{text(caption)}</caption>" if caption else ""
    return (
        f'<div class="pd-table"><table>{named}<thead><tr><td></td>{cells}</tr></thead>'
        f"<tbody>{rows}</tbody></table></div>"
    )
