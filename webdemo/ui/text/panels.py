"""The page's small pieces of HTML: status, read-outs, model card, own acts. Every text in them is escaped."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from acts import Lexicon
from motion.metrics import MEASURES, Measure
from webdemo.inference.methods import label_of
from webdemo.inference.run import Result

from .texts import say, worded
from .words import number, seconds, text

Summary = Mapping[str, float]

QUALITY = tuple(measure for measure in MEASURES if measure.better)
RELATION = tuple(measure for measure in MEASURES if not measure.better)
_NO_WARNINGS = ("This was made as ", "Read as ")
"""Beginnings of notes that say how a sentence was understood."""
_SAME = '<td class="pd-same">same</td>'


def status(line: str = "", *, tone: str = "quiet") -> str:
    """The line under the buttons.

    Args:
        line: one sentence in English, or a few; the visitor gets it in their language.
        tone: "quiet", "note", "busy", "done", "warning" or "error"; errors are announced at once.
    """
    if not line:
        return ""
    role = "alert" if tone == "error" else "status"
    return f'<p class="pd-status pd-{tone}" role="{role}">{text(line)}</p>'


def notes_lines(result: Result) -> str:
    """The notes of a result, which stand right beside how long it took."""
    return "".join(status(note, tone=_note_tone(note)) for note in result.notes)


def _note_tone(note: str) -> str:
    """The tone of a note: what was not done is a warning; how the sentence was read, and what was done, is not."""
    if any(head in note for head in ("Not understood:", "Not checked:", "Not seen:")):
        return "warning"
    if note.startswith("Done"):
        return "quiet"
    return "note" if note.startswith(_NO_WARNINGS) else "warning"


def plan_line(results: Iterable[Result]) -> str:
    """One line on what share of sentences' motion was laid out for the network; "" where none says so."""
    shares = [100 * each["planned"] for made in results for each in made.readouts if "planned" in each]
    if not shares:
        return ""
    least, most = (f"{edge:.0f}" for edge in (min(shares), max(shares)))
    if least == "100":
        said = "The plan lays out all of this motion: guidance, steps and seed change little."
    elif most == "0":
        said = "The plan lays out nothing of this motion: the network makes it."
    else:
        share = most if least == most else f"{least} to {most}"
        said = f"The plan lays out {share} % of this motion, whatever is set here; the network makes the rest."
    return f'<p class="pd-method pd-laid" role="status">{text(said)}</p>'


def method_line(summary: str) -> str:
    """One line on a method, under the place where it is chosen."""
    known = worded("method", summary)
    return f'<p class="pd-method">{text(summary) if known == summary else known}</p>'


def model_state(state: str, error: str | None = None) -> str:
    """The small mark in the header: whether the networks are loaded."""
    words = {
        "loading": say("page.loading"),
        "ready": say("page.ready"),
        "failed": text(error) if error else say("page.failed"),
    }
    return f'<p class="pd-model pd-model-{text(state)}" role="status">{words[state]}</p>'


def readout_panel(result: Result) -> str:
    """All figures of a result, behind a line: what was asked, measures, contacts, timings."""
    samples = [sides(readout) for readout in result.readouts]
    tables = ""
    if samples:
        both = _quality_table(samples) + _relation_table(samples, result)
        tables = f'<div class="pd-tables">{both}</div>'
    figures = f"{_asked(result)}{tables}{_timings(result.timings)}"
    shown = f'<details class="pd-figures"><summary>All figures</summary>{figures}</details>'
    return f'<div class="pd-readouts">{shown}</div>'


def prediction_lines(lines: Mapping[str, str]) -> str:
    """A line on the error of each prediction, after its name if there are several."""
    return "".join(
        f'<p class="pd-in-words">{f"<b>{text(name)}</b> " if name else ""}{text(line)}</p>'
        for name, line in lines.items()
    )


def _heads(count: int) -> list[str]:
    return [f"Sample {i + 1}" for i in range(count)]


def sides(readout: Mapping[str, Any]) -> tuple[Summary | None, Summary]:
    """(before, after) of a read-out, as :func:`motion.metrics.compare` gives it, without what could not be measured."""
    before = readout.get("before")
    return _measured(before) if before else None, _measured(readout.get("after") or {})


def _measured(values: Mapping[str, Any]) -> Summary:
    return {key: value for key, value in values.get("summary", values).items() if value is not None}


def _asked(result: Result) -> str:
    request = result.manifest.get("request", result.manifest)
    shown = [
        ("Method", _method(request)),
        ("Actor", request.get("actor", {}).get("name")),
        ("Seed", request.get("seed")),
        ("Length", f"{result.duets[0].seconds:.1f} s" if result.duets else None),
        ("Guidance", _plain(request.get("guidance"))),
        ("Steps", request.get("steps")),
        ("Damping", _plain(request.get("damping"))),
        ("Tries", tries if (tries := request.get("tries", 1)) != 1 else None),
        ("Plan from the words", "off" if request.get("planned") is False else None),
    ]
    items = "".join(
        f"<div><dt>{text(label)}</dt><dd>{text(value)}</dd></div>" for label, value in shown if value is not None
    )
    return f'<dl class="pd-asked">{items}</dl>'


def _method(request: Mapping[str, Any]) -> str | None:
    """The method of a reaction, which may have been chosen by itself."""
    return label_of(str(request.get("model"))) if request.get("kind") == "react" else None


def _plain(value: Any) -> str | None:
    return None if value is None else f"{value:g}"


def _quality_table(samples: Sequence[tuple[Summary | None, Summary]]) -> str:
    head: Sequence[str]
    if len(samples) == 1 and samples[0][0] is not None:
        head = ("Before", "After", "Change")
    elif len(samples) == 1:
        head = ("Value",)
    else:
        head = _heads(len(samples))
    rows = "".join(_quality_row(measure, samples) for measure in QUALITY)
    compared = any(before is not None for before, _ in samples)
    return _table("Quality, before → after damping and clean-up" if compared else "Quality", head, rows)


def _quality_row(measure: Measure, samples: Sequence[tuple[Summary | None, Summary]]) -> str:
    cells = []
    for before, after in samples:
        new = _value(measure, after)
        old = "" if before is None else _value(measure, before)
        if len(samples) > 1:
            cells.append(f"<td>{old} → <b>{new}</b></td>" if old else f"<td><b>{new}</b></td>")
        elif before is None:
            cells.append(f"<td><b>{new}</b></td>")
        else:
            cells.append(f"<td>{old}</td><td><b>{new}</b></td>{_change(measure, before, after)}")
    return _row(measure, "".join(cells))


def _change(measure: Measure, before: Summary, after: Summary) -> str:
    old, new = before.get(measure.key), after.get(measure.key)
    smallest = 0.5 * 10**-measure.digits
    if old is None or new is None:
        return "<td>–</td>"
    if _value(measure, before) == _value(measure, after):
        return _SAME
    tone = "pd-better" if new < old else "pd-worse"
    if old < smallest:
        return f'<td class="{tone}">+{number(new - old, measure.digits)}</td>'
    percent = f"{100 * (new - old) / old:+.0f}".replace("-", "−")
    if percent in ("+0", "−0"):
        return _SAME
    return f'<td class="{tone}">{percent} %</td>'


def _relation_table(samples: Sequence[tuple[Summary | None, Summary]], result: Result) -> str:
    head = ("Value",) if len(samples) == 1 else _heads(len(samples))
    rows = "".join(
        _row(measure, "".join(f"<td><b>{_value(measure, after)}</b></td>" for _, after in samples))
        for measure in RELATION
    )
    contacts = "".join(_contacts(i, result, head) for i in range(len(samples)))
    return f'<div class="pd-relation">{_table("Between the two", head, rows)}{contacts}</div>'


def _contacts(sample: int, result: Result, head: Sequence[str]) -> str:
    found = result.readouts[sample].get("contacts")
    if found is None:
        return ""
    fps = result.duets[sample].fps
    title = "Contacts" + (f", {head[sample]}" if len(result.duets) > 1 else "")
    items = "".join(
        f'<li class="pd-{text(contact["kind"])}">'
        f"<b>{_span(contact['start'] / fps, contact['stop'] / fps)} s</b> {text(contact['label'])}</li>"
        for contact in found
    )
    items = items or "<li>none</li>"
    return f'<div class="pd-contacts"><h4>{text(title)}</h4><ul>{items}</ul></div>'


def _span(start: float, stop: float) -> str:
    """Two times in seconds, or one where they are the same tenth."""
    first, last = f"{start:.1f}", f"{stop:.1f}"
    return first if first == last else f"{first}–{last}"


def _timings(timings: Mapping[str, float]) -> str:
    if not timings:
        return ""
    items = " · ".join(f"{text(stage)} {seconds(spent)}" for stage, spent in timings.items())
    return f'<p class="pd-timings">{items}</p>'


def _value(measure: Measure, values: Summary) -> str:
    value = values.get(measure.key)
    return "–" if value is None else number(value, measure.digits)


def _row(measure: Measure, cells: str) -> str:
    unit = f" <small>{text(measure.unit)}</small>" if measure.unit else ""
    meaning, label = measure.meaning, measure.label
    return f'<tr title="{text(meaning)}"><th scope="row">{text(label)}{unit}</th>{cells}</tr>'


def _table(caption: str, head: Sequence[str], rows: str) -> str:
    cells = "".join(f'<th scope="col">{text(label)}</th>' for label in head)
    return (
        f'<div class="pd-table"><table><caption>{text(caption)}</caption>'
        f"<thead><tr><td></td>{cells}</tr></thead><tbody>{rows}</tbody></table></div>"
    )


def model_card(info: Mapping[str, Any]) -> str:
    """A model's name, its summary and the plain facts of its card."""
    facts = "".join(
        f"<div><dt>{text(str(key).replace('_', ' ').capitalize())}</dt><dd>{text(value)}</dd></div>"
        for key, value in info.items()
        if key not in ("name", "summary") and isinstance(value, (str, int, float)) and not isinstance(value, bool)
    )
    paragraphs = "".join(f"<p>{text(part)}</p>" for part in str(info.get("summary", "")).split("\n\n") if part.strip())
    return (
        f'<div class="pd-card"><h4>{text(info.get("name", "Model"))}</h4>{paragraphs}'
        f'<dl class="pd-facts">{facts}</dl></div>'
    )


MOST_LISTED = 200
"""Acts in the table, at most."""


def own_acts(known: Lexicon) -> str:
    """HTML on what the lab added to the lexicon and what of it was left out; empty where it added nothing."""
    if not known.own and not known.problems:
        return ""
    rows = []
    for name in known.own[:MOST_LISTED]:
        entry = known.entries[name]
        cells = (name.replace("-", " "), entry.reads[0], f"{entry.group}.toml")
        rows.append("<tr>" + "".join(f"<td>{text(cell)}</td>" for cell in cells) + "</tr>")
    left_out = "".join(status(f"Left out: {problem}", tone="warning") for problem in known.problems)
    heads = "".join(f"<th>{head}</th>" for head in ("Act", "For example", "File"))
    table = f"<table><thead><tr>{heads}</tr></thead>"
    listed = f"{table}<tbody>{''.join(rows)}</tbody></table>" if rows else ""
    head = f"This lab's own acts: {len(known.own)}"
    if known.problems:
        head += f" (left out: {len(known.problems)})"
    return f'<details class="pd-own"><summary>{text(head)}</summary>{left_out}{listed}</details>'
