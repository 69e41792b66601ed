"""The kinds of things there are, and the sizes of those that stand in a room."""

FIXTURES = ("door frame", "window", "curtain", "hi-fi")
"""What stands where it is: people go to it, face it and use it."""
FURNITURE = ("chair", "bench", "table", "computer", "bed", *FIXTURES)
"""What stands on the floor: the origin is on the floor in its middle, and its front is +Z."""
HELD = (
    "box",
    "ball",
    "book",
    "cup",
    "phone",
    "umbrella",
    "flower",
    "ring",
    "sword",
    "stick",
    "guitar",
    "bag",
    "cigarette",
)
"""What hands hold: the origin is where a hand holds it, and its length or its upright is +Y."""
KINDS = (*FURNITURE, *HELD)
"""The kinds of things there are."""
LEAVES = ("sash", "door")
"""Parts of fixtures that move, beside curtains."""


HIGH = ("chair", "bench", "table", "bed", "door frame", "box")
"""Kinds whose height can be chosen."""
WIDE = (*HIGH, "ball")
"""Kinds whose width can be chosen."""

SILL, PANE_WIDTH, PANE_HEIGHT = 0.9, 0.54, 1.14
"""Height of a window's sill over the floor, and width and height of each of its two sashes."""
RAIL = 2.14
"""Height of a curtain rail."""
CURTAIN = 0.58
"""Width of one of two curtains."""
DOOR_WIDTH, DOOR_HEIGHT = 0.95, 2.05
