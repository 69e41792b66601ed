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

SILL, PANE_WIDTH = 0.9, 0.54
"""Height of a window's sill over the floor, and width of each of its two sashes."""
CURTAIN = 0.58
"""Width of one of two curtains."""
DOOR_WIDTH = 0.95
