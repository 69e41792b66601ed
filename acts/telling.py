"""A plan and the verdicts on its motion → what happens, in words for people who cannot see it.

"A walks up to B and taps B on the right shoulder; B turns to A." An act that was asked for but not seen, or that
nothing measures, is not told as if it were: it is named at the end.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .captions import caption_of, naming, short, with_thing, worded
from .checking import Verdict
from .lexicon import Lexicon, lexicon
from .plan import Act, Plan

_BOTH, _THEY = "A and B", "they"


def told(plan: Plan, verdicts: Sequence[Verdict], known: Lexicon | None = None) -> str:
    """One or two sentences on what a motion shows of a plan; "" where it shows nothing and nothing is amiss.

    Args:
        plan: of the motion.
        verdicts: on the plan's acts, as :func:`acts.checking.checked` gives them.
        known: the lexicon; ours by default.
    """
    known = lexicon() if known is None else known
    by_id = {verdict.id: verdict for verdict in verdicts}
    acts = [act for group in plan.beats() for act in group if act.act in known.entries and act.id in by_id]
    done = [act for act in acts if act.happens and by_id[act.id].done]
    open_ = [act for act in acts if act.happens and by_id[act.id].done is None]
    missed = [act for act in acts if act.happens and by_id[act.id].done is False]
    denied = [act for act in acts if act.polarity == "not" and by_id[act.id].done is False]
    parts = [
        _joined(_clauses(done, known)),
        _listed("Asked for and not measured", [act for act in open_ if known.entries[act.act].shown], known),
        _listed("Asked for but not seen", missed, known),
        _listed("Seen although the words rule it out", denied, known),
    ]
    return " ".join(part for part in parts if part)


def _clauses(acts: Sequence[Act], known: Lexicon) -> Iterator[tuple[str, str]]:
    """Each act as (its subject, what they do)."""
    for act in acts:
        entry = known.entries[act.act]
        words = _sided(*with_thing(act, naming(act, entry, caption_of(act, entry))))
        for name, letter in (("person A", "A"), ("person B", "B"), ("two people", _BOTH), (_THEY, _BOTH)):
            words = f"{letter} {words.removeprefix(f'{name} ')}" if words.startswith(f"{name} ") else words
            words = words.replace(name, letter) if name.startswith("person") else words
        subject = next((each for each in (_BOTH, "A", "B") if words.startswith(f"{each} ")), "")
        brief = short(act, known.entries[act.act])
        if act.thing and act.thing not in words and act.thing in brief:  # the network's words leave it out
            subject = _BOTH if len(act.agents) == 2 else act.agents[0].upper()
            words = brief.replace(act.thing, f"the {act.thing}")
        rest = words.removeprefix(subject).strip()
        if " and A " in rest or " and B " in rest:  # two people's, each with a verb of their own
            subject, rest = "", f"{subject} {rest}"
        yield subject, rest


def _sided(act: Act, caption: str) -> str:
    """An act in the words of a caption, with the side of the part where it has one."""
    if act.side in ("left", "right") and not any(slot in caption for slot in ("{side}", "{limb}")):
        if act.part and "{part}" in caption:
            act = act.model_copy(update={"part": f"{act.side} {act.part}"})
        elif act.part in ("hand", "foot"):
            act = act.model_copy(update={"part": None})  # then the hand is named behind
    return worded(act, caption)


def _joined(clauses: Iterator[tuple[str, str]]) -> str:
    """Clauses as one sentence: those that follow each other with one subject share it."""
    text, last = "", None
    for subject, words in clauses:
        if not text:
            text = f"{subject} {words}".strip()
        elif subject and subject == last:
            text += f" and {words}"
        else:
            text += "; " + f"{subject} {words}".strip()
        last = subject
    return f"{text[:1].upper()}{text[1:]}." if text else ""


def _listed(head: str, acts: Sequence[Act], known: Lexicon) -> str:
    said = dict.fromkeys(" ".join(clause).strip() for clause in _clauses(acts, known))
    return f"{head}: {'; '.join(said)}." if said else ""
