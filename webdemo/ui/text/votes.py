"""The result of a blind study as a table."""

from __future__ import annotations

from webdemo.study import Comparison, StudyResult
from webdemo.ui.studies import StudyEntry

from .panels import status
from .words import text


def count(number: int, what: str) -> str:
    """Such as "one pair" or "12 pairs"."""
    return f"one {what}" if number == 1 else f"{number} {what}s"


def result_html(study: StudyEntry, result: StudyResult) -> str:
    """The result: a row a comparison, and how far they agree."""
    checks = count(study.checks, "attention check") if study.checks else "no attention checks"
    state = "The voting has ended" if study.closed else "The voting goes on"
    pairs = count(study.pairs, "pair")
    lines = [f"“{study.question}” {pairs}, {checks}. {state}."]
    if not study.votes:
        return status(f"{lines[0]} Nobody has voted yet.")
    left_out = f", {result.excluded} more left out by the attention checks" if result.excluded else ""
    lines.append(f"{count(result.votes, 'vote')} of {_people(result.raters)} count{left_out}.")
    lines.append(_agreement(result))
    rows = "".join(_row(each) for each in result.comparisons)
    heads = "".join(
        f'<th scope="col" title="{title}">{head}</th>'
        for head, title in (
            ("Wins", "Votes for the first"), ("Losses", "Votes for the second"), ("Ties", "Votes for neither"),
            ("Skipped", "Answers withheld"), ("Share", "Wins among wins and losses"),
            ("95 %", "Wilson score interval of the share"), ("p", "Exact two-sided sign test"), ("", "0 to 100 %"),
        )
    )  # fmt: skip
    return (
        "".join(map(status, lines)) + '<div class="pd-readouts"><div class="pd-table pd-votes"><table>'
        f"<thead><tr><td></td>{heads}</tr></thead><tbody>{rows}</tbody></table></div></div>"
    )


def _people(number: int) -> str:
    return "one person" if number == 1 else f"{number} people"


def _agreement(result: StudyResult) -> str:
    if result.agreement is None:
        return "No pair has votes of two people yet, so their agreement is not known."
    known = result.alpha is not None
    alpha = f"{result.alpha:.2f}".replace("-", "−") if known else "not defined, since all votes are the same"
    return f"Agreement: Krippendorff's α {alpha}; {result.agreement:.0%} of all pairs of votes on a pair are the same."


def _row(each: Comparison) -> str:
    share, (low, high) = each.share, each.interval
    counts = "".join(f"<td><b>{value}</b></td>" for value in (each.wins, each.losses, each.ties, each.skips))
    if share is None:
        rest = "<td>–</td><td>–</td><td>–</td><td></td>"
    else:
        bar = (
            '<div class="pd-interval" aria-hidden="true">'
            f'<i style="left:{100 * low:.1f}%;width:{100 * (high - low):.1f}%"></i>'
            f'<b style="left:{100 * share:.1f}%"></b></div>'
        )
        p = "&lt; 0.001" if each.p_value < 0.001 else f"{each.p_value:.3f}"
        rest = f"<td><b>{share:.0%}</b></td><td>{low:.0%} to {high:.0%}</td><td>{p}</td><td>{bar}</td>"
    sides = f"{each.sets[0]} against {each.sets[1]}"
    return f'<tr><th scope="row">{text(sides)}</th>{counts}{rest}</tr>'
