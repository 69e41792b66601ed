"""Walking, running, leading and following, in words."""

from __future__ import annotations

from .entry import WATCH, Entry

_BACK = ("*step back", "*back away", "*move back", "*retreat( a few steps|)", "*walk backwards")

LOCOMOTION: dict[str, Entry] = {
    "guide-follow": Entry(
        "reply",
        ("*show the way{with_hand}", "*lead the way", "*guide {other}", "*point the way and *walk ahead"),
        ("*follow( {them}|)", "*walk behind( {them}|)", "*go along", "*walk where {other} points"),
        (),
        ("guiding someone", "showing the way", "a guide and a follower"),
    ),
    "walk-together": Entry(
        "while",
        ("*walk( forward|)", "*walk along"),
        ("*walk beside {them}", "*walk alongside", "*keep pace"),
        ("*walk side by side", "*walk together", "*take a walk( together|)", "*walk next to each other"),
        ("walking side by side", "walking together", "a walk together", "two people walking"),
    ),
    "run-together": Entry(
        "while",
        ("*run( forward|)", "*run along", "*jog"),
        ("*run beside {them}", "*run alongside", "*jog along"),
        ("*run side by side", "*run together", "*jog together", "*go for a run( together|)"),
        ("running side by side", "running together", "a jog together", "two people running"),
    ),
    "meet": Entry(
        "while",
        ("*walk towards {other}", "*come to meet {other}", "*come closer"),
        ("*walk towards {them}", "*come to meet {them}", "*come closer too"),
        ("*meet( in the middle|)", "*walk towards each other( and *stop|)", "*approach each other", "*come together"),
        ("meeting", "walking towards each other", "two people meet", "approaching each other"),
    ),
    "part": Entry(
        "while",
        ("*walk away( from {other}|)", "*leave", "*go away", "*turn and *walk off"),
        ("*walk away too", "*leave as well", "*go the other way"),
        ("*part( ways|)", "*walk away from each other", "*go separate ways", "*turn around and *walk apart"),
        ("parting", "walking apart", "going separate ways", "two people part"),
    ),
    "leave": Entry(
        "while",
        ("*walk away( from {other}|)", "*leave( {other}|)", "*turn around and *walk off"),
        ("*stay( behind|)", "*stand and *watch", "*stay in place", "*remain standing"),
        (),
        ("walking away from someone", "one leaves, one stays", "leaving someone"),
    ),
    "follow": Entry(
        "while",
        ("*walk( ahead| in front|)", "*walk forward", "*lead"),
        ("*follow( {them}|)", "*walk behind( {them}|)", "*walk after {them}", "*follow at a distance"),
        ("*walk one behind the other", "*walk in single file"),
        ("following someone", "walking one behind the other", "single file"),
    ),
    "chase": Entry(
        "while",
        ("*run away( from {other}|)", "*flee( from {other}|)", "*run", "*try to escape"),
        ("*chase {them}", "*run after {them}", "*pursue {them}", "*chase after {other}"),
        ("*chase each other", "*run one behind the other"),
        ("a chase", "running after someone", "chasing", "pursuit"),
    ),
    "circle": Entry(
        "while",
        ("*walk (a|in a) circle around {other}{round}", "*circle {other}{round}", "*walk around {other}{round}"),
        WATCH,
        (),
        ("walking around someone", "circling around a person", "walking in a circle around someone"),
    ),
    "circle-each-other": Entry(
        "while",
        ("*circle around {other}{round}", "*walk in a circle{round}"),
        ("*circle {them}{round}", "*keep opposite {them}", "*walk in a circle too"),
        ("*circle each other{round}", "*walk around each other{round}", "*walk in a circle{round}"),
        ("circling each other", "walking around each other"),
    ),
    "walk-past": Entry(
        "while",
        ("*walk past( {other}|)", "*pass {other}", "*go past {other}", "*walk by"),
        ("*walk past {them}", "*pass {them}", "*walk the other way"),
        ("*walk past each other", "*pass (by |)each other", "*cross paths", "*walk by each other"),
        ("walking past each other", "passing by", "crossing paths"),
    ),
    "walk-up": Entry(
        "while",
        ("*walk up to {other}", "*approach {other}", "*walk towards {other} and *stop", "*come closer"),
        ("*stand still", "*wait", "*stand and *wait", "*watch {them} come"),
        (),
        ("walking up to someone", "approaching someone who waits"),
        ("{B} *wait for {A}, who comes closer.", "{B} *is approached by {A}."),
    ),
    "step-back": Entry(
        "reply",
        ("*walk towards {other}", "*step towards {other}", "*come closer", "*approach( {other}|)"),
        _BACK,
        (),
        ("stepping back from someone who comes closer", "approach and retreat", "backing away"),
    ),
    "make-way": Entry(
        "reply",
        ("*walk towards {other}", "*walk straight at {other}", "*come closer", "*approach( {other}|)"),
        ("*walk off{to_side}", "*walk out of the way{to_side}", "*move out of the way{to_side}", "*make way{to_side}"),
        (),
        ("walking out of the way", "making way for someone", "giving way to someone"),
    ),
}  # fmt: skip
