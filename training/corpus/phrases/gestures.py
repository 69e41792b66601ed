"""Phrases for people who stay in place: greeting, dancing, talking."""

from __future__ import annotations

from .entry import WATCH, Entry

_COME = ("*come( over|)", "*walk over( to {them}|)", "*come to {other}", "*approach", "*walk up to {other}")

GESTURES: dict[str, Entry] = {
    "wave-back": Entry(
        "reply",
        ("*wave{with_hand}", "*wave at {other}{with_hand}", "*greet {other} with a wave", "*wave hello{with_hand}"),
        ("*wave back{with_hand}", "*return the wave", "*wave (too|as well){with_hand}", "*wave in return"),
        ("*wave at each other", "*greet each other with a wave", "*exchange waves", "*wave hello to each other"),
        ("a wave and a wave back", "waving at each other", "greeting with a wave", "friendly wave"),
    ),
    "bow-back": Entry(
        "reply",
        ("*bow( politely|)", "*bow to {other}", "*greet {other} with a bow", "*take a bow"),
        ("*bow back", "*return the bow", "*bow (too|as well)", "*bow in return"),
        ("*bow to each other", "*greet each other with a bow", "*exchange bows", "*bow politely to each other"),
        ("a bow and a bow back", "bowing to each other", "polite bow", "formal greeting"),
    ),
    "raise-copy": Entry(
        "reply",
        ("*raise {hand}", "*lift {hand}( up|)", "*put {hand} up", "*hold {hand} up in the air"),
        ("*do the same", "*copy {them}", "*raise {hand} too", "*lift {hand} as well", "*follow with {hand}"),
        ("*raise {hand} one after the other", "*put {hand} up one after the other"),
        ("raising a hand and copying it", "both raise a hand", "copying a raised hand"),
    ),
    "raise-watch": Entry(
        "while",
        ("*raise {hand}", "*lift {hand}( up|)", "*put {hand} up", "*hold {hand} up in the air"),
        WATCH,
        (),
        ("raising a hand while being watched", "one raises a hand, one watches"),
    ),
    "call-come": Entry(
        "reply",
        ("*call {other} over{with_hand}", "*beckon{with_hand}", "*wave {other} over", "*signal {other} to come",
         "*call {other}"),
        _COME,
        (),
        ("calling someone over", "beckoning and coming", "come here", "a call and an approach"),
        ("{A} *ask {B} to come, and {B} *walk over.", "{B} *come when {A} *call.", "{B} *follow {As} call and *come."),
    ),
    "goodbye": Entry(
        "reply",
        ("*wave goodbye{with_hand}", "*say goodbye", "*wave farewell{with_hand}", "*bid {other} goodbye"),
        ("*wave back{with_hand}", "*say goodbye too", "*return the goodbye", "*wave goodbye as well"),
        ("*say goodbye( to each other|)", "*wave goodbye( to each other|)", "*part with a wave", "*bid farewell"),
        ("goodbye", "saying goodbye", "farewell wave", "waving goodbye"),
    ),
    "cheer": Entry(
        "while",
        ("*cheer", "*raise both (hands|arms) and *cheer", "*throw both arms up", "*celebrate with both arms up"),
        ("*cheer( along| too|)", "*join in", "*celebrate with {them}", "*raise both arms as well"),
        ("*cheer( together|)", "*celebrate( together|)", "*raise both (hands|arms) in joy", "*cheer each other on"),
        ("cheering", "celebration", "two people cheering", "both arms up in joy"),
    ),
    "dance-together": Entry(
        "while",
        ("*dance", "*dance with {other}", "*dance on the spot"),
        ("*dance (too|along)", "*dance with {them}", "*join the dance"),
        ("*dance( together|)", "*dance with each other", "*dance face to face", "*perform a dance together"),
        ("dancing together", "a dance for two", "pair dance", "partners dancing"),
    ),
    "dance-mirrored": Entry(
        "while",
        ("*dance", "*perform a dance", "*lead a dance"),
        ("*mirror {them}", "*mirror the dance", "*dance as a mirror image", "*copy the steps like a mirror"),
        ("*dance like mirror images", "*mirror each other in a dance", "*dance (face to face |)in mirror image"),
        ("mirrored dance", "mirror dance", "dancing in mirror image"),
    ),
    "dance-watch": Entry(
        "while",
        ("*dance( for {other}|)", "*perform a dance", "*show {other} a dance", "*dance on the spot"),
        WATCH,
        (),
        ("dancing for someone who watches", "one dances, one watches", "solo dance with a spectator"),
    ),
    "point": Entry(
        "while",
        ("*point at {other}{with_hand}", "*point a finger at {other}", "*point{with_hand} at {other}"),
        ("*stand still", "*watch", "*look at {them}", "*stand there", "*look on"),
        (),
        ("pointing at someone", "pointing a finger"),
        ("{B} *is being pointed at by {A}.", "{B} *stand there and {A} *point at {b_them}."),
    ),
    "talk": Entry(
        "while",
        ("*talk", "*talk with (lively |)gestures", "*explain something( with {their} hands|)", "*tell {other} a story"),
        ("*listen", "*listen to {them}", "*listen and *answer with gestures", "*stand and *listen"),
        ("*talk( to each other|)", "*have a conversation", "*chat( with each other|)", "*talk with lively gestures"),
        ("conversation", "talking with gestures", "a chat"),
    ),
    "copy": Entry("reply", (), ("*do the same", "*copy {them}", "*imitate {them}", "*repeat the movement",
                                "*follow the example")),
    "together": Entry("while", (), ()),
    "watch": Entry("while", (), WATCH),
    "ordered": Entry("order", (), ()),
    "sequence": Entry("while", (), ()),
    "turn-away": Entry(
        "while",
        ("*turn away( from {other}|)", "*turn {their} back on {other}", "*turn around", "*turn and *face away"),
        WATCH,
        (),
        ("turning away", "turning one's back"),
    ),
    "idle": Entry(
        "while",
        ("*stand still", "*wait", "*stand around", "*stand idle"),
        ("*stand still too", "*wait as well", "*stand nearby", "*stand there too"),
        ("*stand( still|) facing each other", "*stand around", "*wait( together|)", "*stand idle", "*do nothing"),
        ("standing still", "waiting", "two people standing", "idle"),
    ),
}  # fmt: skip
