"""A plan in the plain words on which the network was trained, beat by beat.

A caption is written for one agent, with its verb in brackets: ``{a} [walk] up to {b}`` becomes "person A walks up to
person B" or "they walk up to each other". ``{b}`` is the other person; ``{part}``, ``{side}``, ``{thing}`` and
``{direction}`` come from the act, or are left out where it names none; ``{limb}`` is "the left hand" or "both arms".
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from .frames import FAMILIES, Frame
from .lexicon import Entry, Lexicon, kind_of, lexicon
from .plan import GAITS, Act, Plan, other_of
from .reading.vocabulary import closed, vocabulary

VERB = re.compile(r"\[([a-z-]+)\]")
"""A verb of a caption or a phrase: ``[walk]``."""
_SLOT = re.compile(r"\{([a-z_]+)\} ?")
_BY_FOOT = re.compile(
    r"\[(?:kick|step|hop|jump|lunge|pirouette|stand|stop|walk|run|march|limp|stumble|stamp|turn|spin)\]"
)
_NAMES = {"a": "person A", "b": "person B"}
_COUNTS = {1: "once", 2: "twice", 3: "three times"}
_WITH, _BESIDE = re.compile(r" with \{b\}"), re.compile(r" (with|past) \{b\}")
_OTHER = re.compile(r"(?<! each) other$")
_AHEAD = {"tried": "try to", "offered": "offer to", "pretended": "pretend to", "wished": "want to"}


def singular(verb: str) -> str:
    """A verb's base form in the third person singular: "passes"."""
    if verb in ("be", "have"):
        return {"be": "is", "have": "has"}[verb]
    if verb.endswith(("s", "sh", "ch", "x", "z", "o")):
        return f"{verb}es"
    return f"{verb[:-1]}ies" if verb.endswith("y") and verb[-2:-1] not in "aeiou" else f"{verb}s"


_DOUBLED = re.compile(r"[^aeiouy][aeiou][bdgkmnprtv]")


def gerund(verb: str) -> str:
    """A verb's base form with "-ing": "hugging", "waving", "high-fiving"."""
    if verb.endswith("ie"):
        return f"{verb[:-2]}ying"
    short = verb.rpartition("-")[2]
    if _DOUBLED.fullmatch(short[-3:]) and len(re.findall("[aeiouy]+", short)) == 1:
        return f"{verb}{verb[-1]}ing"
    return f"{verb[:-1] if re.search('[^eoy]e$', verb) and verb != 'be' else verb}ing"


def past(verb: str) -> str:
    """A regular verb's past: "hugged", "waved", "carried"."""
    if verb.endswith("y") and verb[-2:-1] not in "aeiou":
        return f"{verb[:-1]}ied"
    return f"{verb}d" if verb.endswith("e") else f"{gerund(verb).removesuffix('ing')}ed"


def plural(part: str) -> str:
    """The plural of a part of the body."""
    return {"foot": "feet"}.get(part, f"{part}s")


def paced(act: Act, caption: str) -> str:
    """A caption with the verb of the act's gait: "[limp] up to {b}"."""
    verb, first = next((GAITS[manner] for manner in act.manner if manner in GAITS), ""), VERB.search(caption)
    if not verb or first is None:
        return caption
    if first[1] not in FAMILIES["walk+"].split("|"):
        return f"{caption} {gerund(verb)}"
    return caption.replace(first[0], f"[{verb}]", 1)


def worded(act: Act, caption: str) -> str:
    """An act in the words of a caption, without a full stop: "person A pats person B on the back twice"."""
    both = len(act.agents) == 2
    other = act.patient or other_of(act.agents[0])
    caption = paced(act, caption.replace("{a+b}", "{a}"))
    caption = caption if act.part else caption.replace(" on the {part}", "").replace("'s {part}", "")
    trunk = vocabulary().part(act.part or "") in closed("trunk")  # which is touched, and touches nothing
    limb = ("" if trunk else act.part) or usual_limb(caption)
    text = VERB.sub(lambda m: ("are" if m[1] == "be" else m[1]) if both else singular(m[1]), caption)
    values = {
        "a": "they" if both else _NAMES[act.agents[0]],
        "b": "each other" if both else _NAMES[other],
        "part": f"{act.part_side or ''} {act.part or ''}".strip(),
        "side": act.side if act.side in ("left", "right") else "",
        "thing": act.thing or "",
        "direction": act.direction or "",
        "limb": f"both {plural(limb)}" if act.side == "both" else f"the {act.side or ''} {limb}",
    }

    def fill(match: re.Match[str]) -> str:
        value = values.get(match[1]) or ""
        return f"{value} " if value and match[0].endswith(" ") else value

    text = " ".join(_SLOT.sub(fill, text).split())
    text = text.replace(" forward", " backwards") if act.direction == "back" else text
    text += _by_hand(act, caption)
    if act.times is not None and act.times > 1:
        text += f" {_COUNTS.get(act.times, f'{act.times} times')}"
    for adverb in [each for each in act.manner if each not in GAITS][:1]:
        if adverb not in ("then", "finally") and not text.endswith(adverb):
            text += f" {adverb}"
    return text


def _by_hand(act: Act, caption: str) -> str:
    """The hand or foot that does it, where the words name one and the caption has no place for it."""
    told = any(slot in caption for slot in ("{side}", "{limb}", "{part}", "{direction}"))
    if act.side not in ("left", "right") or act.side == act.direction or act.part or told:
        return ""
    return by_limb(act, caption)


def usual_limb(caption: str) -> str:
    """The limb by which an act is done where the words name none: the foot that kicks, the knee, else the hand."""
    return "foot" if _BY_FOOT.search(caption) else "knee" if "[kneel]" in caption else "hand"


def by_limb(act: Act, caption: str) -> str:
    """The limb on the act's side that does it: " with the left foot"."""
    own = act.part if act.part in closed("limbs") and act.part_of in act.agents else None
    limb = own or usual_limb(caption)
    return f" with both {plural(limb)}" if act.side == "both" else f" with the {act.side} {limb}"


def with_thing(act: Act, caption: str) -> tuple[Act, str]:
    """An act and a caption with the thing that its words name, in place of an example: "a book"."""
    words = caption.split()
    for i, (article, noun) in enumerate(pairwise([*words, ""])):
        if act.thing and ((article == "something" and kind_of(act.thing)) or (article == "a" and kind_of(noun))):
            caption = " ".join([*words[:i], "{thing}", *words[i + 1 + (article == "a") :]])
            break
    named = act.thing if act.thing in closed("pronouns of things") else f"the {act.thing}"
    return (act.model_copy(update={"thing": named}) if act.thing else act), caption


def caption_of(act: Act, entry: Entry) -> str:
    """The caption that fits an act: its entry's first, or the first without the other where one person acts alone."""
    alone = len(act.agents) == 1 and act.patient is None and entry.to != "other" and not entry.mutual
    own = [text for text in entry.caption if "{b}" not in text and not text.startswith("{a+b}")]
    return own[0] if alone and own else entry.caption[0]


def beats(plan: Plan, known: Lexicon) -> list[str]:
    """A sentence for each beat of a plan: what is done at the same time stands in one.

    Acts that are denied, tried, pretended or wished are not done; a person of whom nothing else is told in that beat
    then stands still.
    """
    return [words for group in plan.beats() if (words := _sentence(group, known))]


def sentence(groups: Sequence[Sequence[Act]], known: Lexicon) -> str:
    """Groups of acts that follow each other closely, as one sentence; "" where nothing is done or left undone."""
    told = [words.rstrip(".") for group in groups if (words := _sentence(group, known))]
    text = ", and then ".join([*told[:1], *(f"{words[:1].lower()}{words[1:]}" for words in told[1:])])
    return f"{text}." if told else ""


def _sentence(group: Sequence[Act], known: Lexicon) -> str:
    done = [act for act in group if act.happens and act.act in known.entries]
    parts: list[tuple[str, str]] = []
    for act in done:
        parts.append(("".join(act.agents), worded(act, caption_of(act, known.entries[act.act]))))
    busy: set[str] = {who for act in done for who in act.agents}
    for act in group:
        idle = "".join(who for who in act.agents if who not in busy)
        if not act.happens and idle and not _is_still(act, known):
            parts.append((idle, f"{_NAMES[idle]} stands still" if len(idle) == 1 else "they stand still"))
            busy.update(idle)
    text, last = "", ""
    for who, words in parts:
        if not text:
            text = words
        elif who == last:
            text += f" and {words.removeprefix('they ').removeprefix('person A ').removeprefix('person B ')}"
        else:
            text += f" while {words}"
        last = who
    return f"{text[:1].upper()}{text[1:]}." if text else ""


def _is_still(act: Act, known: Lexicon) -> bool:
    """True for standing still, which must not be said of a person who is told not to."""
    entry = known.entries.get(act.act)
    return entry is not None and {shape.do for shape in entry.stage} == {"stay"}


def in_words(plan: Plan) -> str:
    """The text of a plan; of one that was written by hand its acts in plain words."""
    return plan.sentence.strip() or " ".join(beats(plan, lexicon()))


def of_each(acts: Sequence[Act], known: Lexicon) -> tuple[str, str]:
    """A sentence for person a and one for person b; "" for a person who does nothing.

    Both are "" where an act is both people's: then the sentence of the whole beat says it best.
    """
    done = [act for act in acts if act.happens and act.act in known.entries and known.entries[act.act].shown]
    if any(len(act.agents) == 2 or known.entries[act.act].mutual for act in done):
        return "", ""
    told: dict[str, list[str]] = {"a": [], "b": []}
    for act in done:
        who = act.agents[0]
        own, other = _NAMES[who], _NAMES[other_of(who)]
        words = worded(act, caption_of(act, known.entries[act.act])).removeprefix(f"{own} ")
        words = words.replace(f"{own}'s", "their").replace(own, "them").replace(other, "the other person")
        told[who].append(words)
    a, b = (f"One person {' and '.join(words)}." if words else "" for words in (told["a"], told["b"]))
    return a, b


def short(act: Act, entry: Entry | None) -> str:
    """An act in a few words, beside its people: "pats on right shoulder ×2", "face each other", "does not wave".

    They are those of the entry's ``chip`` or caption, or of its name where the caption describes the act by another
    verb, since it keeps to the words of the network. An act without an entry goes by its name.
    """
    both = len(act.agents) == 2
    ahead = _AHEAD.get(act.modality, "")
    if act.polarity == "not":
        ahead = f"{'do' if both else 'does'} not {ahead}".strip()
    elif ahead and not both:
        verb, _, rest = ahead.partition(" ")
        ahead = f"{singular(verb)} {rest}"
    plain = ahead or both
    phrase = _phrase(act, entry, "each other" if both else "")
    text = f"{ahead} {VERB.sub(lambda m: m[1] if plain else singular(m[1]), phrase)}".strip()
    side = act.direction if act.direction in closed("turns") else act.side
    if side in closed("turns") and f" {side} " not in f" {text} ":
        turns = side == act.direction or "[turn]" in phrase
        limb = by_limb(act, phrase).replace(" the ", " ")
        text += limb if not turns else f" to the {side}" if side in ("left", "right") else f" {side}"
    for adverb in [each for each in act.manner if each not in GAITS][:1]:
        if adverb not in ("then", "finally", "simultaneously") and f" {adverb} " not in f" {text} ":
            text += f" {adverb}"
    return f"{text} ×{act.times}" if act.times is not None and act.times > 1 else text


def _phrase(act: Act, entry: Entry | None, both: str) -> str:
    """The words of :func:`short` with their verbs in brackets; ``both`` is what two who do it do it to."""
    name = act.act.split("-")
    if entry is None:
        return " ".join(name)
    named = paced(act, f"[{name[0]}] {' '.join(name[1:])}".strip()).replace(" thing", f" {act.thing or 'something'}")
    named = _OTHER.sub(f" {both or 'the other'}", named).removesuffix(" person")
    if not entry.caption:
        return named
    act, caption = with_thing(act, paced(act, entry.chip or entry.caption[0]))
    verb = VERB.search(caption)
    other = verb is None or verb[1] != name[0] or caption.startswith("{b}")
    no_limb = "{limb}" in caption and not act.part
    # "opens window", where the caption has a door, which the network knows
    named_thing = bool(act.thing) and "thing" in name and "{thing}" not in caption
    if not entry.chip and (no_limb or named_thing or (other and "{limb}" not in caption and "{part}" not in caption)):
        verbs = {verb for frame in entry.frames for verb in Frame.parse(frame).verbs} | {"be"}
        if name[0] in verbs and not verbs.intersection(name[1:]):
            return named
    side = f"{act.side} " if act.side in ("left", "right") and "{side}" not in caption else ""
    of_part = f"{act.part_side} " if act.part_side else side
    values = {
        "a": "",
        "b": both or "*",
        "part": f"{of_part}{act.part}" if act.part else "",
        "side": side.strip(),
        "thing": act.thing or "something",
        "direction": act.direction or "",
        "limb": f"both {plural(act.part or 'hand')}" if act.side == "both" else f"{side}{act.part or 'hand'}",
    }
    if both:  # "stagger", not past each other
        caption = (_WITH if "past" in name else _BESIDE).sub("", caption)
    filled = _SLOT.sub(lambda m: f"{values.get(m[1], '')} ", caption)
    kept: list[str] = []
    for word in filled.split():
        if word == "'s" and both:
            kept[-1] += word
        elif word in ("*", "'s"):
            before = closed("to people" if act.patient else "to whatever")
            while word == "*" and kept and kept[-1] in before:
                kept.pop()
        elif word not in closed("plain"):
            kept.append(word)
    while kept and kept[-1] in ("on", "of", "to", "with", "at", "from", "against"):
        kept.pop()
    return " ".join(kept).replace(" ,", ",").removesuffix("'s")
