"""Moves: where a sentence sends its people, read from its verbs of motion."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum

from .clauses import Clause, clauses


class Way(Enum):
    """A way of moving over the floor, or of staying."""

    TO = "walks up to the other"
    BEHIND = "comes up behind the other"
    AWAY = "walks away from the other"
    BACK = "steps back"
    PAST = "walks past the other"
    ROUND = "walks around the other"
    ALONG = "walks side by side with the other"
    AFTER = "follows the other"
    TURN = "turns around"
    AVERTED = "stands with their back to the other"
    ASIDE = "steps aside"
    FACE = "turns to the other"
    BACKS = "stands with their back to the other's"
    STAY = "stays in place"


@dataclass(frozen=True)
class Move:
    """The movement of one person in a sentence.

    Attributes:
        person: "a" or "b".
        way: how they move.
        speed: metres a second.
        turns: whole turns, of :attr:`Way.ROUND` and :attr:`Way.TURN`.
        until: the move ends early, because the sentence goes on with "until …".
        linked: they hold each other by the hands or arms.
        late: the sentence tells it after something else that is done in place.
    """

    person: str
    way: Way
    speed: float = 1.1
    turns: float = 0.5
    until: bool = False
    linked: bool = False
    late: bool = False


_GO = (
    r"(?:walk|go|goes|going|stroll|wander|run|jog|rush|hurr[yi]|sprint|dash|march|strid|stomp|storm|step|mov|head|creep|"
    r"sneak|tiptoe|wade|shuffl|limp|stagger|skip|danc|drift|saunter|trot|charg|stumbl|ambl|pac(?:e|ing)|bolt|scurr[yi]|"
    r"dart|trudg|plod|glid|swagger|slip|roam|parad|scamper|hobbl|totter|stalk|pranc|inch|race|racing|spring|squeez|"
    r"brush|sidl|mosey|swan|strut|waddl|toddl|scuttl|scoot|lumber|lurch|slink|steal|prowl|stump|clomp|tramp|traips|"
    r"canter|gallop|hasten|hurtl|zoom|zip|speed|tear|shoot|barg|breez|bustl|flounc|sashay|sweep|weav|zigzag|gambol|hik|"
    r"lop|meander|mill|pad|potter|rambl|scrambl|skulk|slither|slop|sleepwalk|slouch|bound|hotfoot|power|nip|pop|travel|"
    r"wend|goose-?step|moonwalk)\w*"
)
_OTHER = r"(?:person [ab]|(?:the|his|her|their|an?|another) (?:\w+ )?\w+|him|her|them|each other|one another)"
_PERSON = (
    r"(?:person [ab]|each other|one another|him|her|them|the (?:other|first|second)(?: person| one)?"
    r"|(?:the|an?|another) (?:man|woman|boy|girl|person|stranger|friend))"
)
_AROUND = r"(?:a?round)"
_HIS = r"(?:his|her|their)"
_PLACES = re.compile(
    r"\b(?:to|towards?|for|into|through|out of) (?:the|an?|his|her|their) (?:\w+ )?(?:door|exit|window|kitchen|car|bus|"
    r"train|taxi|house|home|street|park|shop|store|office|school|bar|bathroom|bedroom|garden|gate|corner|stairs|hall|"
    r"fridge|bed|stage|shower|forest|woods|beach|water|lift|elevator|goal|finish line|shelf|cupboard)s?\b"
)
"""Places that are not where the other person is."""
_WAYS: tuple[tuple[Way, tuple[str, ...]], ...] = (
    (Way.BACKS, (r"\b(?:stand|sit|lean|wait)\w* (?:\w+ )?back[- ]to[- ]back\b", r"^back[- ]to[- ]back\b")),
    (
        Way.AVERTED,
        (
            r"\b(?:with|has|have|keeps?) (?:his|her|their) back(?:s)? (?:to|turned|towards)\b",
            r"\b(?:is|stands?|sits?|waits?) (?:facing|turned|looking) (?:away\b|the other way\b)",
        ),
    ),
    (
        Way.AFTER,
        (
            r"\b(?:follow|chas|pursu|trail|shadow)\w*|\btags? along\b|\btails\b",
            rf"\b{_GO} (?:\w+ )?after {_OTHER}",
            rf"\b(?:walk|stroll|march|run|jog|trot)\w* (?:(?!up\b)\w+ ){{0,2}}?behind {_OTHER}",
            r"\bin pursuit\b|\b(?:hot |close )?on (?:his|her|their|person [ab]'s|the other's) heels\b",
        ),
    ),
    (
        Way.BEHIND,
        (
            rf"\b(?:{_GO}|com\w+|approach\w*) (?:\w+ )?(?:up )?(?:from )?behind\b",
            r"\bapproach\w* .*\bfrom behind\b",
            rf"\b(?:sneak|creep|steal)s? up on {_OTHER}",
        ),
    ),
    (
        Way.PAST,
        (
            rf"\b(?:{_GO}|com\w+) (?:\w+ )?(?:past\b|(?<!side )by\b(?! the (?:hand|arm)| side))",
            r"\bovertak\w+|^(?:right|straight|just) past\b",
            rf"\bpass(?:es|ing)? (?:by\b|{_PERSON}(?! (?:an?|the)\b))",
        ),
    ),
    (
        Way.ROUND,
        (
            rf"\bcircl\w+ (?:{_AROUND} )?{_OTHER}",
            r"\borbit\w*",
            rf"\b(?!turn|spin|look){_GO} (?:\w+ ){{0,5}}?{_AROUND}(?: and around)? {_OTHER}",
            rf"\b{_GO} in (?:a )?circles? {_AROUND}",
        ),
    ),
    (
        Way.BACK,
        (
            r"\b(?:back|step|mov|shrink|jump|hop|walk|go|tak|retreat|recoil|stagger|stumbl|edg|flinch|lean)\w*"
            r" (?:(?:a|one|two|\w+) (?:step|pace)s? )?(?:away backwards|backwards?|back(?! to(?!\w)| into)\b"
            r"|off a step)",
            r"\bbacks? (?:away|off|up)\b",
            r"\bbacking (?:away|off)",
            r"\bretreats?\b",
            r"\brecoils?\b",
            r"\b(?:shies|shy|shrinks?|flinch\w*) away\b",
        ),
    ),
    (
        Way.ASIDE,
        (
            r"\b(?:step|mov|jump|dodg|leap|hop|slip|duck)\w* (?:\w+ )?(?:aside|sideways)\b",
            r"\b(?:step|mov|jump|dodg|leap|hop)\w* to (?:the|one|his|her|their) (?:\w+ )?side\b",
            r"\bout of the way\b",
            r"\bmakes? way\b(?! (?:to|over|up))",
            r"\bsidesteps?\b",
        ),
    ),
    (
        Way.AWAY,
        (
            rf"\b{_GO} (?:\w+ ){{0,2}}?(?:away|off|out\b(?! (?:a|the|his|her|their) (?:hand|arm))|home|elsewhere)\b",
            r"\bleav(?:e|es|ing)\b(?! \w+ (?:hand|arm))",
            r"\b(?:depart|separat|escap|withdr[ae]w|disappear|vanish)\w*",
            r"\b(?:mak|tak)(?:e|es|ing) off\b(?! (?:together|side by side|in the same))",
            r"\btak(?:es?|ing) (?:his|her|their) leave\b",
            r"\bon (?:his|her|their) heels?\b",
            r"\bgets? away\b",
            r"\bpart(?:s|ing)?(?: again| ways| company)?$",
            r"\b(?:go|goes|going|walk|head|run)\w* (?:\w+ )?(?:their|his|her) (?:separate |own |different )?ways?\b",
            r"\bopposite directions\b",
            rf"\b{_GO} apart\b",
            r"\bheads? for\b",
            rf"\b(?:go|goes|walks?|heads?|runs?|gets?) back to (?!{_PERSON})",
            r"\bsplit up\b",
            r"\bflees?\b",
            r"\bexits?\b",
            r"\bsets? off\b(?! together| side)",
            r"\bcarr(?:y|ies) on\b",
            r"\b(?:run|walk|go|jog)s? on ahead\b",
            r"\bgoes on\b",
            r"\bon (?:his|her|their) way out\b",
        ),
    ),
    (
        Way.ALONG,
        (
            rf"\b{_GO} (?:\w+ ){{0,3}}?(?:side by side|next to (?:each other|one another)|abreast|in step|hand in hand|"
            r"arm in arm|together|alongside|beside|shoulder to shoulder|"
            r"with (?:each other|him|her|them|person [ab]|the other)|in (?:the )?(?:same direction|parallel))",
            r"\baccompan\w+",
            r"\bsets? off (?:together|side by side)\b",
            r"\bin the same direction\b",
            r"\bkeep\w* (?:pace|up) with\b",
            rf"\b(?:side by side|next to each other|hand in hand|arm in arm)\b.*\b{_GO}",
            rf"\b{_GO} (?:on|along)\b",
        ),
    ),
    (
        Way.TO,
        (
            rf"\b(?:{_GO}|com\w+|return\w*) (?:\w+ ){{0,2}}?(?:up to|over to|towards?|closer|nearer|running"
            r"|over\b(?! (?:him|her|it|the|person))"
            rf"|in\b|to {_OTHER}|right up)",
            r"\bcom(?:e|es|ing) (?:up |over |closer|nearer|running|back|along)",
            r"\bcomes? (?:over|closer|nearer)?$",
            rf"\b(?:walks?|comes?|runs?|steps?) up$|\b(?:walk|run|bump|crash)s? (?:\w+ )?into {_OTHER}",
            r"\bcollid\w+",
            r"\b(?:approach|joins?)\w*|\bmeets?\b|\bmeeting\b(?! (?:is|over))|\bkeeps? (?:on )?coming\b",
            r"\bclos\w+ (?:in|the (?:gap|distance))\b",
            r"\bgets? (?:closer|nearer)\b",
            r"\badvanc(?:e|es|ing)\b",
            r"\bmak(?:es?|ing) (?:his|her|their) way (?:over|up|to)\b",
        ),
    ),
    (
        Way.FACE,
        (
            rf"\bturn\w* (?:all the way )?(?:{_AROUND} )?(?:to|towards) (?!go|leave|walk)",
            r"\bface each other\b",
            rf"\bturns? to {_PERSON}",
            r"\b(?:comes?|turns?|swings?|spins?) (?:back )?(?:a?round|about) to (?:face|look)",
        ),
    ),
    (
        Way.TURN,
        (
            r"\babout[- ]face\b",
            r"^turns?$",
            rf"\bturn\w* (?:\w+ ){{0,3}}?(?:{_AROUND}\b|away|back\b|{_HIS} backs?)",
            r"\b(?:spin|pirouette|twirl|whirl|pivot|swivel|rotat)\w*\b|\b(?:wheel|swing|whip)s? (?:a?round|about)\b",
        ),
    ),
    (
        Way.STAY,
        (
            r"(?<!n't )(?<!not )(?<!never )\b(?:stay|stand|wait|remain|watch|look|freez|stop|paus|halt|linger)\w*",
            r"\bholds? still\b",
            r"\brooted\b",
            r"\bdo(?:es)? ?n[o']t (?:move|react|budge|follow)\b",
            r"\bon the spot\b",
            r"\brefus\w+ to (?:come|move|follow|budge)",
            r"\b(?:motionless|immobile)\b",
            r"\bkeeps? still\b",
        ),
    ),
)
_PATTERNS = tuple((way, re.compile("|".join(patterns))) for way, patterns in _WAYS)
_PERSON_NAMED = re.compile(
    r"\b(?:to|towards?|up|over|at|join\w*|meet\w*) (?:person [ab]|him|her|them|each other|the other)\b"
)
_NOT = re.compile(r"\b(?:do(?:es)?n't|not|without|never|refus\w+ to|wants? to|tries to|let(?:s|ting)?)\b")
MOVED = re.compile(
    r"\b(?:danc|waltz|lead|drag|pull|carr(?!(?:y|ies) on)|guid|push|shov|fight|kick|punch|wrestl|help|support|"
    r"escort)\w*"
)
"""Acts in which one moves the other: where they go follows from their touch."""
_FLOOR = re.compile(
    r"\b(?:sit|kneel|crawl|roll|lie|lying|fall|seated|crouch|squat|get|jump|leap)\w*|\bone knee\b|\bdown\b"
)
"""Acts that take a person off their feet or to the ground, for which no place is held."""
_BARE = re.compile(r"(?:walk|run|jog|stroll|skip|march)s?(?:ing)?(?: together| a bit| a little)?")
_WITH = re.compile(r"\b(?:beside|next to|alongside|with|accompan\w+|together|by side)\b")
_LINKED = re.compile(
    r"\b(?:hand in hand|arm in arm|(?:hold|link|join|tak)\w* (?:\w+ )?(?:hands?|arms?)|arms? around)\b"
)
_HALT = re.compile(r"\b(?:stop|halt|stand still|wait|freeze|stay|remain|pause)s?\b")
_SPEEDS = (
    (r"\b(?:run|sprint|dash|charg|chas|rac(?:e|ing)|fle[ed]|bolt|dart|scamper)\w*", 2.2),
    (r"\b(?:jog|hurr|rush|storm|trot)\w*|\bquick\w*|\bfast\b", 1.7),
    (r"\b(?:stroll|saunter|wander|ambl|drift|trudg|plod|roam)\w*|\bslow\w*|\bcalm\w*|\bcareful\w*", 0.8),
    (r"\b(?:creep|sneak|tiptoe|shuffl|limp|edg|inch|hobbl|totter)\w*", 0.6),
)
_FULL = re.compile(
    r"\b(?:in (?:a )?circles?|once|all the way|full|whole|complete\w*|360|(?:round )?and round|several times|twice)\b"
)


_SPINS = re.compile(r"\b(?:spin|pirouette|twirl|whirl|rotat)\w*\b(?! (?:a?round|about|to))")


def way_of(words: str) -> Way | None:
    """The way of moving that a clause's words name, if they do."""
    denied = _NOT.search(words)
    for way, pattern in _PATTERNS:
        found = pattern.search(words)
        if found is None:
            continue
        if way is not Way.STAY and denied is not None and denied.start() < found.start():
            continue
        if way is Way.TO and _PLACES.search(words) and not _PERSON_NAMED.search(words):
            return Way.AWAY
        return way
    return None


_GOING = {Way.AWAY, Way.PAST, Way.ROUND, Way.ALONG, Way.TO, Way.BEHIND}


_OF_ONE = {Way.AFTER, Way.BEHIND, Way.PAST, Way.ROUND, Way.TO}
_EACH = re.compile(r"\b(?:each other|one another|meets?)\b")


def is_bare(clause: Clause) -> bool:
    """True if a clause says that both walk, and nothing else."""
    return clause.who == "ab" and bool(_BARE.fullmatch(clause.words))


def goes(found: Sequence[Move]) -> bool:
    """True if any of the moves takes a person elsewhere or turns them."""
    return any(move.way is not Way.STAY for move in found)


def moves(sentence: str) -> tuple[Move, ...]:
    """The moves of a beat's sentence, for each person in order; () where its words move nobody.

    A person who is not mentioned while the other walks stays in place. A sentence in which one moves the other by
    touch, as in leading or pushing, has no moves: the network places those two better.
    """
    found = clauses(sentence)
    if any(MOVED.search(clause.words) for clause in found):
        return ()
    made: list[Move] = []
    hands = any(re.search(r"\bhands?\b|\barms?\b", clause.words) for clause in found)
    for i, clause in enumerate(found):
        late = not clause.at_once and any(way_of(before.words) is None for before in found[:i])
        if is_bare(clause) and i == len(found) - 1:
            clause, late = replace(clause, words=f"{clause.words} along"), False
        if (
            clause.who == "ab"
            and hands
            and re.search(r"\b(?:spin|twirl|whirl|turn)\w* (?:a?round)", clause.words)
        ):
            clause = replace(clause, words="circle each other")
        made += _of_clause(clause, late=late)
    for person, other in ("ab", "ba"):
        ways = {move.way for move in made if move.person == other}
        after = next((move for move in made if move.person == person and move.way is Way.AFTER), None)
        if after is not None and not ways & _GOING:
            until = any(clause.until for clause in found)
            made.insert(0, Move(other, Way.AWAY, after.speed, until=until))
    if _LINKED.search(sentence.lower()):
        made = [replace(move, linked=True) for move in made]
    for i, clause in enumerate(found):
        if clause.until and i:
            made = [_ended(move, found[i - 1]) for move in made]
    if not goes(made):
        return (
            tuple(made) if len({move.person for move in made}) == 2 and _HALT.search(sentence.lower()) else ()
        )
    low = {who for clause in found if _FLOOR.search(clause.words) for who in clause.who}
    backs = any(move.way in (Way.BACK, Way.ASIDE) for move in made)
    for person in "ab":
        if all(move.person != person for move in made) and person not in low and not backs:
            made.append(Move(person, Way.STAY))
    return tuple(move for move in made if move.way is not Way.STAY or move.person not in low)


def _of_clause(clause: Clause, *, late: bool) -> list[Move]:
    way, who = way_of(clause.words), clause.who
    if way is None or (_FLOOR.search(clause.words) and way in (Way.STAY, Way.TURN)):
        return []
    if not clause.subject and way in _OF_ONE and not _EACH.search(clause.words):
        who = "a"
    if way is Way.ALONG and _WITH.search(clause.words):
        who = "ab"
    elif way is Way.ALONG and who != "ab":
        way = Way.AWAY  # "the other one walks on"
    late = late and way is not Way.AFTER
    speed = next((value for pattern, value in _SPEEDS if re.search(pattern, clause.words)), 1.1)
    turns = 1.0 if _FULL.search(clause.words) or (way is Way.TURN and _SPINS.search(clause.words)) else 0.5
    return [Move(person, way, speed, turns, late=late) for person in who]


def _ended(move: Move, before: Clause) -> Move:
    """The move with an early end, if it is the one of the clause before an "until"."""
    ends = move.person in before.who and way_of(before.words) is move.way
    return replace(move, until=True) if ends else move
