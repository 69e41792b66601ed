"""What one person does alone: the words of the families that join two such actions."""

# ruff: noqa: E501 (a table of phrases reads better unbroken)

from __future__ import annotations

ACTIONS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    # action: (verb phrases, nouns)
    "bow": (("*bow( politely|)", "*take a bow", "*bow to {other}", "*make a bow", "*bend forward in a bow"),
            ("a bow", "bowing")),
    "wave": (("*wave{with_hand}", "*wave {hand}", "*wave at {other}{with_hand}", "*give a wave{with_hand}"),
             ("a wave", "waving")),
    "bye": (("*wave goodbye{with_hand}", "*say goodbye", "*wave farewell{with_hand}", "*wave bye{with_hand}"),
            ("a goodbye", "waving goodbye")),
    "call": (("*call {other} over", "*beckon{with_hand}", "*call out to {other}", "*signal {other} to come"),
             ("a call", "beckoning")),
    "raise-hand": (("*raise {hand}", "*lift {hand}( up|)", "*put {hand} up", "*hold {hand} up"),
                   ("a raised hand", "raising a hand")),
    "raise-hands": (("*raise both hands", "*lift both (hands|arms)", "*put both hands up", "*throw both arms up"),
                    ("raised hands", "both hands up")),
    "cheer": (("*cheer", "*cheer with both arms up", "*raise both hands and *cheer", "*throw both arms up in joy"),
              ("a cheer", "cheering")),
    "dance": (("*dance", "*do a dance", "*dance on the spot", "*perform a short dance"), ("a dance", "dancing")),
    "guide": (("*show the way{with_hand}", "*point the way", "*gesture the way{with_hand}"),
              ("a guiding gesture", "showing the way")),
    "point": (("*point at {other}{with_hand}", "*point a finger at {other}", "*point{with_hand} at {other}"),
              ("pointing",)),
    "kick": (("*kick{with_foot}", "*throw a kick{with_foot}", "*do a kick"), ("a kick", "kicking")),
    "punch": (("*punch{with_hand}", "*throw (a punch|punches)", "*swing {their} fists"),
              ("a punch", "punching")),
    "slash": (("*swing a sword", "*slash with a sword", "*make a sword cut"), ("a sword slash", "slashing")),
    "respond": (("*answer with a gesture", "*respond with a gesture", "*make an answering gesture"),
                ("a response", "responding")),
    "walk": (("*walk( forward|)", "*take a walk", "*walk along", "*stroll"), ("a walk", "walking")),
    "walk-turn": (("*walk and *turn{to_side}", "*walk, turning{to_side}", "*make a turn{to_side} while walking"),
                  ("a walk with a turn", "walking and turning")),
    "turn": (("*turn{to_side}", "*turn around{to_side}", "*make a turn{to_side}"), ("a turn", "turning")),
    "run": (("*run", "*run along", "*jog", "*go running"), ("a run", "running")),
    "dash": (("*dash", "*rush forward", "*stride in a hurry", "*hurry along"), ("a dash", "rushing")),
    "walk-back": (("*walk backwards", "*back away", "*step back", "*walk back"), ("a step back", "backing away")),
    "walk-left": (("*walk to the left", "*walk off to the left", "*go to the left"),
                  ("a walk to the left",)),
    "walk-right": (("*walk to the right", "*walk off to the right", "*go to the right"),
                   ("a walk to the right",)),
    "idle": (("*stand still", "*wait", "*stand idle", "*watch"), ("standing still", "waiting")),
    "talk": (("*talk with (lively |)gestures", "*talk and *gesture", "*explain something with {their} hands"),
             ("talking", "a talk")),
}  # fmt: skip
