"""Blows that miss, and swords, in words."""

from __future__ import annotations

from .entry import Entry

_RECOIL = ("*recoil", "*flinch back", "*reel( back|)", "*stagger back", "*take the hit and *step back")

COMBAT: dict[str, Entry] = {
    "punch-dodge": Entry(
        "reply",
        ("*throw a punch{with_hand}", "*punch at {other}{with_hand}", "*attack with (a punch|{their} fists)",
         "*try to punch {other}"),
        ("*dodge( it| the punch|)", "*step back to avoid it", "*get out of the way", "*evade( it| the punch|)"),
        (),
        ("punch and dodge", "dodging a punch", "a punch that misses"),
    ),
    "punch-recoil": Entry(
        "reply",
        ("*punch {other}{with_hand}", "*throw a punch{with_hand} at {other}", "*strike {other} with a fist"),
        _RECOIL,
        (),
        ("punch and recoil", "taking a punch", "reeling from a punch"),
    ),
    "spar": Entry(
        "while",
        ("*throw punches", "*attack with punches", "*box", "*spar with {other}"),
        ("*fight back", "*throw punches too", "*box as well", "*trade blows with {them}"),
        ("*spar( with each other|)", "*box( against each other|)", "*have a fist fight", "*exchange punches",
         "*fight( each other|)"),
        ("sparring", "boxing match", "fist fight", "two fighters"),
    ),
    "kick-step-back": Entry(
        "reply",
        ("*kick{with_foot}( at {other}|)", "*throw a kick{with_foot}", "*attack with a kick", "*try to kick {other}"),
        ("*step back( to avoid it|)", "*back away", "*move out of reach", "*retreat", "*avoid the kick"),
        (),
        ("kick and step back", "avoiding a kick", "a kick and a retreat"),
    ),
    "sword-retreat": Entry(
        "reply",
        ("*swing a sword( at {other}|)", "*slash at {other} with a sword", "*attack with a sword", "*cut with a sword"),
        ("*retreat", "*back away", "*step back( from the blade|)", "*dodge the blade"),
        (),
        ("sword slash and retreat", "retreating from a sword", "sword attack"),
    ),
    "sword-fight": Entry(
        "while",
        ("*swing a sword", "*slash with a sword", "*attack with a sword"),
        ("*fight back with a sword", "*slash back", "*swing a sword too", "*parry and *strike back"),
        ("*fight with swords", "*have a sword fight", "*cross swords", "*duel( with swords|)", "*fence"),
        ("sword fight", "a duel with swords", "two people sword fighting", "fencing"),
    ),
}  # fmt: skip
