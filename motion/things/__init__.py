"""Things beside two people: chairs and cups, balls and books, in metres.

:class:`Thing` is a surface with its own track. :func:`shape` builds the surfaces that there are, parametric and low in
triangles (ours, CC0 1.0: do with them what you like).
"""

from . import room
from .shapes import FIXTURES, FURNITURE, HELD, HIGH, KINDS, LEAVES, WIDE, shape
from .thing import MOST_FACES, MOST_THINGS, MOST_VERTICES, Mesh, Thing

__all__ = [
    "FIXTURES",
    "FURNITURE",
    "HELD",
    "HIGH",
    "KINDS",
    "LEAVES",
    "MOST_FACES",
    "MOST_THINGS",
    "MOST_VERTICES",
    "WIDE",
    "Mesh",
    "Thing",
    "room",
    "shape",
]
