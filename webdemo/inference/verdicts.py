"""What a result shows of its words: a verdict on each act, and the note under the result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from acts.accounting import account
from acts.checking import NO_RULE, checked
from acts.plan import PlanFrames
from acts.things.furnishing import judge_things
from motion import SMPL22, Clip, Duet
from motion.metrics.sentences.joints import Motion
from webdemo.inference.finish.looks import lengths_of
from webdemo.inference.requests import SamplingRequest
from webdemo.inference.run import Result

MOST_NAMED = 6
"""Acts that a note names of each kind, at most."""
MOST_CHARACTERS = 350
"""Characters of a note, at most, where fewer acts of each kind make it so short."""
_ORDINALS = ("1st", "2nd", "3rd", "4th")

Rows = list[dict[str, Any]]
"""Verdicts as a manifest holds them: ``act``, ``words``, ``done``, ``measure``, and ``beat`` where it has several."""


@dataclass(frozen=True)
class Judged:
    """A result with what its samples show of the words.

    Attributes:
        result: with ``checked`` and ``told`` in the manifests, of the first sample in that of all.
        rows: of each sample; () where the request has no words that can be read.
        unread: stretches of the words that are in no act.
    """

    result: Result
    rows: tuple[Rows, ...] = ()
    unread: tuple[str, ...] = ()

    @property
    def counts(self) -> tuple[int, int]:
        """Acts that are done and that can be judged, over all samples."""
        verdicts = [row["done"] for rows in self.rows for row in rows if row["done"] is not None]
        return sum(verdicts), len(verdicts)

    @property
    def share(self) -> float:
        """Acts that are done among those that can be judged; 1 where there are none."""
        done, told = self.counts
        return done / told if told else 1.0


def plans_of(request: Any) -> list[PlanFrames]:
    """The plans of what people do in a request, with their frames and beats; none where it has no words."""
    return list(request.spans()) if isinstance(request, SamplingRequest) else []


def judged(request: Any, result: Result) -> Judged:
    """A result with the verdicts on the acts of its request's words; unchanged where there are none to judge."""
    plans = plans_of(request)
    lengths = lengths_of(result.manifest)
    unread = tuple(dict.fromkeys(words for plan, *_ in plans for words in account(plan).unread))
    judgements = [_judged_sample(plans, duet, lengths) for duet in result.duets] if plans else []
    rows = tuple(own["checked"] for own in judgements)
    if not any(rows):
        return Judged(result, (), unread)
    judgements = [own | ({"unread": list(unread)} if unread else {}) for own in judgements]
    duets = tuple(_with(duet, own) for duet, own in zip(result.duets, judgements, strict=True))
    return Judged(replace(result, manifest=result.manifest | judgements[0], duets=duets), rows, unread)


def _with(duet: Duet | Clip, own: Mapping[str, Any]) -> Duet | Clip:
    return replace(duet, manifest={**(duet.manifest or {}), **own}) if isinstance(duet, Duet) else duet


def kept_rows(duet: Duet) -> dict[str, Any]:
    """The part of a sample's manifest that is its own: its verdicts, what happens in words, and its things."""
    manifest = duet.manifest or {}
    return {key: manifest[key] for key in ("checked", "told", "unread", "things") if key in manifest}


def _judged_sample(plans: Sequence[PlanFrames], duet: Duet | Clip, lengths: Sequence[float]) -> dict[str, Any]:
    """The verdicts on a sample, ``checked``, and what happens in it in words, ``told``."""
    if not isinstance(duet, Duet) or duet.skeleton.joint_names != SMPL22.joint_names:
        return {"checked": []}
    rows: Rows = []
    for plan, start, stop, beat in plans:
        verdicts = checked(plan, Motion(duet.positions[:, start:stop], duet.fps))
        split = () if beat is not None else lengths
        end = duet.num_frames if stop is None else stop
        verdicts = judge_things(verdicts, plan, duet, start, end, split)
        rows += [each.to_dict() | ({} if beat is None else {"beat": beat}) for each in verdicts]
    return {"checked": rows, "told": note([rows])}


def note(rows: Sequence[Rows], tries: Mapping[str, Any] | None = None, unread: Sequence[str] = ()) -> str:
    """The verdict under a result; "" for nothing.

    What of its words is not understood, what nothing measures, what is not seen, and then what is done. "Done" stands
    alone where all of the words are acts, with all that is said of them, and all are measured and seen.

    Args:
        rows: of each sample; with several, an act counts how often it is done.
        tries: as the manifest holds them.
        unread: stretches of the words that are in no act.
    """
    acts = [list(column) for column in zip(*rows, strict=True)]
    judged = [column for column in acts if any(row["done"] is not None for row in column)]
    made = [column for column in judged if all(row["done"] for row in column)]
    done = [column[0]["words"] for column in made if not column[0].get("wrote")]
    missed = [_missed(column) for column in judged if column not in made]
    open_ = [each for each in map(_unchecked, acts) if each]
    quoted = [f"“{words}”" for words in unread]
    heads = {"Not understood": quoted, "Not measured": open_, "Not seen": missed, "Done": done}
    for most in range(MOST_NAMED, 0, -1):
        parts = [f"{head}: {_listed(words, most)}." for head, words in heads.items() if words]
        if len(" ".join(parts)) <= MOST_CHARACTERS:
            break
    if tries is None or not judged:
        return " ".join(parts)
    if missed:
        met = sum(bool(row["done"]) for column in judged for row in column)
        return f"Best of {tries['made']} tries, {met} of {sum(map(len, judged))} acts. {' '.join(parts)}"
    won = _ORDINALS[tries["won"] - 1]
    if len(parts) > 1:
        return f"This is the {won} of {tries['asked']} tries. {' '.join(parts)}"
    return f"Done on the {won} of {tries['asked']} tries: {_listed(done)}."


def _unchecked(column: Sequence[Mapping[str, Any]]) -> str:
    """Parts left out of an act that is done, an act that nothing measures, words that no other part says; or ""."""
    row = column[0]
    words, left = str(row["words"]), list(row.get("unchecked", ()))
    missed = any(each["done"] is False for each in column)
    if row.get("wrote"):
        return _with_why(f"“{row['wrote']}”, read as: {words}", " and ".join(left)) * (not missed)
    if row["done"] is None:
        why = [] if row["measure"] == NO_RULE else [row["measure"]]
        return _with_why(words, " and ".join(why + left))
    left = [each for each in left if each.startswith("“") or not missed]
    return _with_why(" and ".join(left), " ".join(words.split()[:2])) * bool(left)


def _with_why(words: str, why: str) -> str:
    return f"{words} ({why})" if why else words


def _missed(column: Sequence[Mapping[str, Any]]) -> str:
    """An act that is not done, with what was measured; of several samples with the number of those that show it."""
    words = str(column[0]["words"])
    words = f"“{column[0]['wrote']}”, read as: {words}" if column[0].get("wrote") else words
    if len(column) > 1:
        met = sum(bool(row["done"]) for row in column)
        return f"{words} (in {met} of {len(column)} samples)"
    return _with_why(words, column[0]["measure"])


def _listed(words: Sequence[str], most: int = MOST_NAMED) -> str:
    words = list(dict.fromkeys(words))
    more = f"; and {len(words) - most} more" if len(words) > most else ""
    return "; ".join(words[:most]) + more
