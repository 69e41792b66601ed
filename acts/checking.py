"""A plan and a motion → which of its acts are done, by the rules of their entries.

A rule is a condition of :mod:`motion.metrics.sentences` in which these names stand for an act's own values: ``who`` is
its agent and ``whom`` the other; ``side`` and ``way`` are "any", ``hands`` is "both" and ``part`` (of the body) is
"body" where the words name none; ``n`` is how often, 1 where they do not say, ``several`` likewise 2, and
``times(…, n)`` asks for no more where they do; ``metres`` is how far apart, and ``held`` the share of the time that two
fifths of a beat are.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from motion import SMPL22, Duet
from motion.metrics.sentences.joints import Motion, stretches
from motion.metrics.sentences.language import check, mask_of, masks, measured
from motion.metrics.sentences.touches import has_sides

from .accounting import account, shown_caption
from .captions import VERB, by_limb, with_thing, worded
from .lexicon import Entry, Lexicon, lexicon
from .plan import ON_TIPTOE, Act, Plan, other_of
from .qualifiers import body_part, plain, qualifiers, side_of, travels
from .reading.vocabulary import closed
from .shapes import Lift

ONLY = {"tried": "only tried", "offered": "only offered", "pretended": "only pretended", "wished": "only wished"}
"""The reason why an act that is not told cannot be judged, by its modality."""

NO_RULE = "nothing measures it"
"""The reason where an entry has no rule."""

HELD = 0.4
"""The part of a motion during which a posture is held, where the words say nothing."""
UNSAID: Mapping[str, str | float] = {
    "side": "any",
    "hands": "both",
    "part": "body",
    "way": "any",
    "n": 1,
    "several": 2,
    "metres": 1.2,
}
"""What a rule asks for where the words say nothing, beside :data:`HELD`: ``metres`` is how far apart at least."""


@dataclass(frozen=True)
class Verdict:
    """The verdict on one act of a plan.

    Attributes:
        id: of the act in its plan.
        act: name of its entry.
        words: what is done, in plain words: "A pats B on the back".
        done: None where it cannot be judged.
        measure: what was measured, such as "hand 34 cm from the shoulder"; "" where the rule has no measure; why it
            cannot be judged, where it cannot.
        unchecked: the kinds of its qualifiers that nothing measures, such as "how often", and quoted words that
            it does not say; the words of an act that is done leave them out.
        wrote: the sentence's own words where they name another act than the one that they were read as.
    """

    id: str
    act: str
    words: str
    done: bool | None
    measure: str = ""
    unchecked: tuple[str, ...] = ()
    wrote: str = ""

    def to_dict(self) -> dict[str, Any]:
        """As it stands in a manifest."""
        row: dict[str, Any] = {"act": self.act, "words": self.words, "done": self.done, "measure": self.measure}
        row |= {"unchecked": list(self.unchecked)} if self.unchecked else {}
        return row | ({"wrote": self.wrote} if self.wrote else {})


def checked(plan: Plan, motion: Duet | Motion) -> tuple[Verdict, ...]:
    """One verdict an act, in the plan's order.

    A denied act is done where its rule does not hold. An act that comes after others is done where its rule holds and
    what it shows comes after what they show, as far as those are done.

    Args:
        plan: of the motion.
        motion: of SMPL's 22 joints.

    Raises:
        ValueError: for a motion of another skeleton.
    """
    known = lexicon()
    if isinstance(motion, Duet):
        if motion.a.skeleton.joint_names != SMPL22.joint_names:
            raise ValueError("Acts are checked on SMPL's 22 joints: bring the motion there first (to_smpl).")
        motion = Motion(motion.positions, motion.fps)
    verdicts: dict[str, Verdict] = {}
    for group in plan.beats():
        for act in group:
            verdicts[act.id] = _verdict(act, plan, motion, known, verdicts)
    return tuple(verdicts[act.id] for act in plan.acts)


def _verdict(act: Act, plan: Plan, motion: Motion, known: Lexicon, before: Mapping[str, Verdict]) -> Verdict:
    entry = known.entries.get(act.act)
    left = account(plan)
    wrote = left.others.get(act.id, "")
    quoted = tuple(f"“{each}”" for each in left.unsaid.get(act.id, ()))

    def verdict(done: bool | None, measure: str, kinds: Iterable[str]) -> Verdict:
        words = _words(plain(act, frozenset(kinds)) if done and act.happens else act, entry, plan)
        return Verdict(act.id, act.act, words, done, measure, (*kinds, *quoted), wrote)

    if why := _unjudged(act, entry):
        return verdict(None, why, _kinds(act, entry, plan) if why == NO_RULE and entry is not None else ())
    assert entry is not None
    asked: dict[str, list[str]] = {}
    held = round(max(HELD / len(plan.beats()), motion.fps / motion.frames), 2)
    unchecked: dict[str, None] = {}
    again = any(each.act == act.act and each.id != act.id and {*each.agents} & {*act.agents} for each in plan.acts)
    for who in act.agents:
        asked[who] = rules_of(act, entry, who, counted=not again, held=held)
        mask = next((mask for rule in asked[who] for mask in masks(rule)[:1]), "")
        for kind, rule in qualifiers(act, entry, who, mask, plan.text(act.words), to_other=act.id in left.towards):
            asked[who] += [rule] if rule else []
            unchecked |= {} if rule else {kind: None}
    casts = [rule for rules in asked.values() for rule in rules]
    if len(asked) == 2 and _AT_ONCE.search(plan.text(act.words)) and not (entry.mutual or _is_attitude(entry)):
        casts += [f"together({', '.join(masks(rules[0])[0] for rules in asked.values())}, 1.0)"]
    if act.polarity == "not":
        seen = any(all(check(rule, motion) for rule in rules) for rules in asked.values())
        done = None if seen and unchecked else not seen
        measure = next(iter(unchecked)) if done is None else _measure([], casts, motion)
        return verdict(done, measure, unchecked)
    failed = [rule for rule in casts if not check(rule, motion)]
    late = "" if failed else _held_before(act, plan, motion, known) or _too_early(act, plan, motion, known, before)
    return verdict(not failed and not late, late or _measure(failed, casts, motion), unchecked)


def decided(verdict: Verdict, act: Act, plan: Plan, *, done: bool, measure: str) -> Verdict:
    """A verdict by something else than a rule, such as a thing that moves: nothing measures the act's qualifiers."""
    entry = lexicon().entries[act.act]
    kinds = _kinds(act, entry, plan)
    words = _words(plain(act, frozenset(kinds)) if done else act, entry, plan)
    left = dict.fromkeys((*kinds, *verdict.unchecked))
    return replace(verdict, done=done, measure=measure, words=words, unchecked=tuple(left))


def _kinds(act: Act, entry: Entry, plan: Plan) -> dict[str, None]:
    """The kinds of an act's qualifiers, where no rule measures any."""
    return dict.fromkeys(
        kind for who in act.agents for kind, _ in qualifiers(act, entry, who, "", plan.text(act.words))
    )


def _unjudged(act: Act, entry: Entry | None) -> str:
    """The reason why an act cannot be judged, or ""."""
    if entry is None:
        return "the lexicon does not have it"
    if act.modality != "told":
        return ONLY[act.modality]
    if not entry.rule:
        return NO_RULE if entry.shown else "no body shows it"
    return ""


def _measure(failed: list[str], rules: list[str], motion: Motion) -> str:
    lacking = bool(failed)
    return next(filter(None, (measured(rule, motion, lacking=lacking) for rule in failed or rules)), "")


_AT_ONCE = re.compile(r"\b(?:together|simultaneously|at the same time|in (?:unison|sync|synchrony))\b", re.IGNORECASE)
_LATER = 0.2
"""Seconds by which an act that comes after another is later, at least."""
_ENTERS = re.compile(r"\b(?:down|up|onto|(?:get|take|mount|jump|hop|climb|leap|drop|sink|lower)s?)\b")
"""Words that say of an attitude that it begins."""


# ---- order -----------------------------------------------------------------------------------------------
def _too_early(act: Act, plan: Plan, motion: Motion, known: Lexicon, before: Mapping[str, Verdict]) -> str:
    """Names the act that an act wrongly comes before, or "".

    What shows it must come later than the first stretch that shows the other, so that a motion which shows both at
    once shows no order: each by its middle, or its first second, where it lasts, and an attitude by its beginning.
    What is no attitude may also have begun before, where it goes on for a second after the other is over. An answer may
    come at once, as a fall does with a push, and who kneels twice may stay on their knees.
    """
    acts = {other.id: other for other in plan.acts}
    earlier = [acts[name] for name in _chain(act, plan) if name in before and before[name].done]
    told = [other for other in earlier if other.polarity == "done"]
    mine = [each for mask in _seen(act, known) for each in _stretches(mask, motion)]
    last = max((j for _, j in mine), default=None)
    if last is not None and last < 0.3 * motion.fps and not act.already and len(motion.positions[0]) > motion.fps:
        return "is over when it begins"
    begins = _is_attitude(known.entries[act.act])
    moments = [i if begins else _middle((i, j), motion) for i, j in mine]
    for other in told:
        theirs = min((each for mask in _seen(other, known) for each in _stretches(mask, motion)[:1]), default=None)
        if theirs is None or last is None or _is_all_along(theirs, motion):
            continue
        first = theirs[0] if _is_attitude(known.entries[other.act]) else _middle(theirs, motion)
        answers = known.entries[act.act].answers and act.agents == (other.patient,) and last > theirs[0]
        stays = begins and _seen(other, known) == _seen(act, known) and last >= theirs[0] + motion.fps
        goes_on = answers or stays or (not begins and last >= theirs[1] + motion.fps)
        if max(moments) <= first + _LATER * motion.fps and not goes_on:
            times = f"at {max(moments) / motion.fps:.1f} s, and that at {first / motion.fps:.1f} s"
            return f"does not come after “{before[other.id].words}”: {times}"
    same = [other for other in told if (other.act, other.agents) == (act.act, act.agents)]
    if same and any(len(_stretches(mask, motion)) <= len(same) for mask in _seen(act, known)):
        between = [other for other in told if other not in same]  # done again: as many times as it is said
        return "is not done again" if between else ""
    return ""


def _stretches(mask: str, motion: Motion) -> list[tuple[int, int]]:
    return stretches(mask_of(mask, motion), motion.fps)


def _is_all_along(stretch: tuple[int, int], motion: Motion) -> bool:
    """True for what is so from the first frame to the last: whatever is done is done in it."""
    edge = _LATER * motion.fps
    return stretch[0] <= edge and stretch[1] >= len(motion.positions[0]) - 1 - edge


def _middle(stretch: tuple[int, int], motion: Motion) -> float:
    """The moment that stands for a stretch: its middle, or a second after it begins, where it lasts."""
    return min((stretch[0] + stretch[1]) / 2, stretch[0] + motion.fps)


def _is_attitude(entry: Entry) -> bool:
    """True for an act after which somebody stays as they are: sits, kneels, or is carried."""
    return entry.takes_down() or any(isinstance(shape, Lift) for shape in entry.stage)


def _held_before(act: Act, plan: Plan, motion: Motion, known: Lexicon) -> str:
    """Says so of an attitude that the words begin, as "sits down" does, and that is held from the start."""
    said = plan.text(act.words).lower()
    if act.already or not _ENTERS.search(said) or not _is_attitude(known.entries[act.act]):
        return ""
    begins = [i for mask in _seen(act, known) for i, _ in _stretches(mask, motion)]
    return "is so from the start" if begins and max(begins) < _LATER * motion.fps else ""


def _chain(act: Act, plan: Plan) -> list[str]:
    """Ids of the acts that an act comes after, the last of them first."""
    after: dict[str, list[str]] = {other.id: [] for other in plan.acts}
    for other in plan.acts:
        for relation in other.order:
            if relation.kind == "after":
                after[other.id].append(relation.act)
            elif relation.kind in ("before", "until"):
                after[relation.act].append(other.id)
    steps: list[str] = []
    left = list(after[act.id])
    while left:
        name = left.pop(0)
        if name not in steps and name != act.id:
            steps.append(name)
            left += after[name]
    return steps


def _seen(act: Act, known: Lexicon) -> list[str]:
    """The predicates by which an act is seen, one for each agent; none for one that is true all along."""
    entry = known.entries[act.act]
    spans = [mask for who in act.agents for rule in rules_of(act, entry, who)[:1] for mask in masks(rule)[:1]]
    return [mask for mask in spans if not mask.startswith("stays(")]


_SIDE = re.compile(r"\b(?:side|hands)\b")
_COUNT = re.compile(r"\btimes\((.*?), (n|several)\)")
_NAME = re.compile(r"'[^']*'|\b[a-z]+\b(?!\s*[(=])")
"""Names in a rule, and what stands in quotes, which is none."""


# ---- rules -----------------------------------------------------------------------------------------------
def rules_of(act: Act, entry: Entry, who: str, *, counted: bool = True, **said: str | float) -> list[str]:
    """The rules of an act with its own values in the place of their names, for one of its agents, and what is said.

    Where its words give a number, it is asked for so often, if it is ``counted``, and else at least so often.
    """
    whom = other_of(who)
    part = body_part(act) or "body"
    part = f"{act.part_side} {part}" if act.part_side and has_sides(part) else part
    said |= {"side": act.side or "any", "hands": act.side or "both", "part": part, "way": side_of(act)}
    said |= {"n": act.times, "several": act.times} if act.times else {}
    said |= {"metres": 0.7 * act.distance} if act.distance else {}
    counted = counted and bool(act.times)
    return [cast(rule, who, whom, counted=counted, **said) for rule in entry.rule]


@lru_cache(maxsize=4096)
def cast(rule: str, who: str, whom: str, *, counted: bool = False, **said: str | float) -> str:
    """A rule of the lexicon with an act's own values in the place of their names.

    Args:
        rule: of an entry.
        who: "a" or "b", the agent.
        whom: the other.
        counted: the words say how often, so that ``times(…, n)`` is "exactly".
        said: what they say in place of :data:`UNSAID`.
    """
    given = {**UNSAID, "held": HELD, **said}
    values = {name: repr(value) for name, value in given.items()} | {"who": who, "whom": whom}
    exact = _COUNT.sub(r"exactly(\1, \2)", rule) if counted else rule
    return _NAME.sub(lambda name: values.get(name[0], name[0]), exact)


def _words(act: Act, entry: Entry | None, plan: Plan) -> str:
    """An act in plain words, with the people as A and B; what is done to nobody in the plan's words names nobody."""
    if entry is None or not entry.caption:
        return act.act.replace("-", " ")
    said = plan.text(act.words)
    if entry.to == "other" and act.id not in account(plan).towards and not re.search(r"\bback\b", said):
        act = act.model_copy(update={"patient": None})
    if act.distance is not None:
        act = act.model_copy(update={"times": None})
    caption = shown_caption(act, entry, said)
    if act.polarity == "not":
        caption = VERB.sub(r"[do] not \1", caption, count=1)
    if act.already:
        caption = caption.replace("] down", "]")  # "they sit", and not "they sit down"
    text = worded(*with_thing(act, caption))
    for person, name in (("person A", "A"), ("person B", "B")):
        text = text.replace(person, name)
    if act.side is not None and " a hand " in text:
        text = text.replace(" a hand ", " both hands " if act.side == "both" else f" the {act.side} hand ")
    elif act.side not in (None, act.direction, *text.split()) and _SIDE.search("".join(entry.rule)):
        text += by_limb(act, caption)
    way = {"back": "backwards"}.get(act.direction or "", act.direction)
    ways = closed("turns") | ({"forward", "backwards"} if travels(entry) else set())
    if way in ways and not {way, act.direction} & set(text.split()):
        text += " to the" * (way in ("left", "right")) + f" {way}"
    pace = "slowly" if act.speed < 0.7 else "quickly" * (act.speed > 1.4)
    if pace and pace not in text and set(act.manner) <= {ON_TIPTOE}:
        text += f" {pace}"
    if act.distance is not None and "apart" not in text:
        text += f" ({act.distance:.1f} m)"
    return text + " once" * (act.times == 1)
