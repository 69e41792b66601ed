"""A sentence of several things, split into beats that can be read alone."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from motion import InputError
from webdemo.inference.cancel import CancelToken
from webdemo.inference.requests import MAX_PROMPT

from .beats import MOST_BEATS, Beat, is_known_act
from .clauses import LONGEST_READ, Clause, Reader, clauses
from .gestures import gestures
from .moves import MEETS, is_bare, is_moved
from .names import named
from .postures import changes, is_down_or_up, leaps
from .ways import Way, way_of

MOST_WORDS = MOST_BEATS * MAX_PROMPT
"""Characters of a story in sentences: as many as its beats may have."""
READING_SECONDS = 30.0
"""In which a story is read that no run waits for."""
_MARK = r"(?:and )?(?:then|finally|afterwards?|after that|at last|at the end|lastly)"
_LOOSE_MARK = r"(?:next|later|now)"
"""Marks of time only at the beginning of a clause: "next to each other" is a place."""
_BREAK = re.compile(
    rf"(?:[.;!,] ?| ){_MARK}\b,? ?|[.;!,] (?:and )?{_LOOSE_MARK}\b,? (?!to\b)|(?<=[.!]) "
    r"|,? before (?=(?:they|he|she)\b)",
    re.IGNORECASE,
)
_LATE_MARK = re.compile(
    r"(?:, (?:and )?| and )(?P<who>person [ab]|the (?:other|first|second)(?: person)?|they|he|she|both) "
    r"(?P<mark>then|finally|afterwards) ",
    re.IGNORECASE,
)
_VERB = (
    r"(?:walk|go|come|run|turn|bow|wave|shake|hug|embrac|danc|kick|push|punch|jump|sit|kneel|get|stand|talk|part|leav|circl"
    r"|hold|clap|point|pat|tap|nod|step|stop|help|hand|give|take|wait|meet|greet|stroll|high[- ]five|raise|let"
    r"|fight|spar|box|salut|kiss|throw|fall|lie|crouch|slap|touch|spin|twirl|lift|march)\w*"
)
_LIST = re.compile(rf", (?={_VERB}\b)|,? and (?={_VERB}\b)", re.IGNORECASE)
_IN_A_LIST = re.compile(rf", {_VERB}\b", re.IGNORECASE)
_OPENING = re.compile(
    r"^(?:first(?:ly)?|at first|to begin with|in the beginning)\b(?! person),? ?", re.IGNORECASE
)
_STARTS_WITH_MARK = re.compile(rf"^(?:{_MARK}\b,?|{_LOOSE_MARK},) ?", re.IGNORECASE)
_NAMES = re.compile(r"(?:person [ab]|the (?:first|second) person)\b", re.IGNORECASE)

_MOMENT = re.compile(
    r"\b(?:shak|high[- ]fiv|low[- ]fiv|fist|bump|hug|embrac|bow|kiss|slap|pat\b|pats\b|tap|nod|curts|salut|greet)\w*"
)
"""Acts that are over when a walk begins."""
_TOGETHER = re.compile(r"^(?:shak|high[- ]fiv|hug|embrac|kiss|fist[- ]bump|bump)\w*")
"""Touches of two people, which begin when what both showed before is over."""
_SHOWN = re.compile(
    r"^(?:cheer|clap|applaud|wav|bow|danc|shak|high[- ]fiv|hug|nod|fight|argu|laugh|kiss|jump)\w*"
)
ARRIVES = (Way.TO, Way.BEHIND)
"""Ways that are over before what the person does next; two who walk up to each other and shake hands do it in one."""
DEPARTS = (Way.AWAY, Way.PAST, Way.ROUND, Way.ALONG, Way.AFTER, *ARRIVES)
"""Ways that begin when what the person did before is over."""


def in_time() -> Callable[[], None]:
    """A ``go_on`` for :func:`split_sentence` that raises InputError after :data:`READING_SECONDS` from now."""
    late = "The story took longer than {limit} to read: shorten it, or try again when the lab is less busy."
    return CancelToken(READING_SECONDS, late).start().raise_if_cancelled


def split_sentence(text: str, go_on: Callable[[], None] = lambda: None) -> tuple[Beat, ...]:
    """The beats of a sentence such as "First …, then …. Finally …"; one beat if it names one thing.

    Who comes or goes does the one after the other, also where the words only say "and". In a story of several
    beats single people are called person A and person B, so that each beat can be read alone.

    Args:
        text: what happens, in linear time of whose length it is read.
        go_on: called before each sentence; what it raises ends the reading.

    Raises:
        InputError: for a text, or a sentence in it, that is longer than any scene's.
    """
    if len(text) > MOST_WORDS:
        raise InputError(f"The story has {len(text):,} characters: shorten it to {MOST_WORDS:,}.")
    text = " ".join(re.sub(r"\([^()]*\)", " ", text).split())
    reader = Reader()
    parts: list[str] = []
    setting = ""
    for part in _clauses(_OPENING.sub("", named(text))):
        part = _STARTS_WITH_MARK.sub("", _OPENING.sub("", part.strip())).strip(" ,;.!")
        part = re.sub(r"^and | and$", "", part, flags=re.IGNORECASE)
        go_on()
        _check_length(part, setting)
        if part and not _is_act(part, clauses(part)):
            setting += f"{part}, "
        elif part:
            part, setting = f"{setting}{part[:1].lower()}{part[1:]}" if setting else part, ""
            found = reader.read(part)
            groups = _acts(found)
            parts += [_worded(group) for group in groups] if len(groups) > 1 else [_in_words(part, found)]
            if len(parts) > MOST_BEATS:
                raise InputError(
                    f"The story has more than {MOST_BEATS} beats: keep to {MOST_BEATS} or fewer."
                )
    if setting and parts:
        parts[-1] = f"{parts[-1].rstrip('.')}, {setting.rstrip(', ')}."
    if len(parts) < 2:
        return (Beat(_meeting(text)),) if text else ()
    return tuple(Beat(part) for part in parts)


def _check_length(part: str, setting: str) -> None:
    """Raises InputError where the next part of a story would make no beat that a scene takes."""
    if len(part) > LONGEST_READ:
        raise InputError(
            f"The sentence “{part[:40]} …” has {len(part):,} characters: shorten it to {MAX_PROMPT}, or split it."
        )
    if len(setting) > MAX_PROMPT:
        raise InputError(f"Nobody does anything from “{setting[:40]} …” on: say who does what.")


def _meeting(text: str) -> str:
    """The text, where one without a subject such as "walk, shake hands" has them walk up to each other."""
    found = clauses(text)
    if not found or any(clause.subject for clause in found) or not is_bare(found[0]):
        return text
    acts = [clause.words for clause in found[1:]]
    if not any(MEETS.match(act) for act in acts) or any(re.match(r"\w+ing\b", act) for act in acts):
        return text
    verb = re.sub(r"(?:(?<=n)n|(?<=g)g|(?<=p)p)?ing$", "", found[0].words.split()[0])
    return f"They {verb} up to each other and {' and '.join(acts)}."


def _is_act(part: str, found: Sequence[Clause]) -> bool:
    """True if somebody does something in a part; "Sports day" is only a setting."""
    return (
        any(clause.stated or way_of(clause.words) is not None for clause in found)
        or is_known_act(part)
        or any(read(part) for read in (changes, leaps, gestures))
    )


def _acts(found: Sequence[Clause]) -> list[list[Clause]]:
    """The clauses in groups that happen one after another."""
    if any(is_moved(clause) for clause in found):
        return [list(found)]
    groups: list[list[Clause]] = []
    several = sum(clause.stated for clause in found) >= 3
    for i, clause in enumerate(found):
        beside = (
            clause.at_once
            or (clause.until and not is_down_or_up(clause))
            or any(later.at_once and later.who == clause.who for later in found[i + 1 : i + 2])
        )
        after = bool(groups) and (
            _follows(groups[-1], clause, found[i + 1 : i + 2])
            or (several and clause.stated and _is_over(groups[-1][-1]))
        )
        if not groups or beside or not after:
            groups[-1:] = [[*(groups[-1] if groups else []), clause]]
        else:
            groups.append([clause])
    return groups


def _is_over(clause: Clause) -> bool:
    """True if what a clause says takes a moment."""
    return bool(_MOMENT.search(clause.words)) or way_of(clause.words) in (Way.TURN, Way.FACE)


def _follows(group: Sequence[Clause], clause: Clause, after: Sequence[Clause]) -> bool:
    """True if a clause begins when a group is over."""
    way = way_of(clause.words)
    group = [done for done in group if done.subject or is_known_act(done.words)] or group
    before = [way_of(done.words) for done in group]
    if way is Way.TURN and after and way_of(after[0].words) is Way.AWAY:
        way = Way.AWAY
    if way is None and not after and is_bare(clause):
        return bool(_MOMENT.search(group[-1].words))
    if (
        clause.who == "ab" == group[-1].who
        and _TOGETHER.search(clause.words)
        and _SHOWN.search(group[-1].words)
    ):
        return True
    if way is Way.AFTER and Way.AWAY in before:
        return False  # who follows sets off at once
    own = [done for done in group if set(done.who) & set(clause.who)]
    if _MOMENT.search(clause.words) and any(is_down_or_up(done) for done in own):
        return True
    if way in DEPARTS:
        return any(done is None for done in before) or any(is_down_or_up(done) for done in own)
    if is_down_or_up(clause):
        return any(way_of(done.words) in DEPARTS for done in own)
    arrived = [done for done in own if way_of(done.words) in (*ARRIVES, Way.AFTER) and done.who != "ab"]
    return bool(arrived) and way is None


def _in_words(part: str, found: Sequence[Clause]) -> str:
    """A part as a sentence: as it is if it names both or a person; otherwise with the name of who is meant."""
    whole = f"{part[:1].upper()}{part[1:]}."
    if not found or not found[0].subject:
        return whole
    told = found[0].stated and (found[0].who == "ab" or _NAMES.match(part))
    return whole if told and not any(c.who != "ab" and c.stated for c in found[1:]) else _worded(found)


def _worded(found: Sequence[Clause]) -> str:
    """Clauses as one sentence."""
    names = {"a": "person A", "b": "person B", "ab": "they"}
    text, last = "", ""
    for clause in found:
        own = re.sub(r"\bperson ([ab])\b", lambda m: f"person {m[1].upper()}", clause.words)
        joint = " until " if clause.until else " while " if clause.at_once and clause.who != last else " and "
        joint = ", " if not last else joint
        who = (
            "" if not clause.subject or (clause.who == last and not clause.until) else f"{names[clause.who]} "
        )
        text += f"{joint if text else ''}{who}{own}"
        last = clause.who if clause.subject else ""
    return f"{text[:1].upper()}{text[1:]}."


def _clauses(text: str) -> list[str]:
    """The text cut where one thing follows another: at marks of time, at full stops, and in lists of three or more."""
    found: list[str] = []
    pieces = _BREAK.split(_LATE_MARK.sub(lambda m: f", {m['mark']} {m['who']} ", text))
    for i, piece in enumerate(pieces):
        listed = _LIST.split(piece)
        goes_on = i + 1 < len(pieces) and not pieces[i + 1][:1].isupper()
        in_a_list = bool(_IN_A_LIST.search(piece))
        found += listed if in_a_list and (len(listed) > 2 or goes_on) else [piece]
    return found
