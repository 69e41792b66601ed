"""Things beside two people: chairs and cups, balls and books, in metres.

:class:`Thing` is a surface with its own track. :func:`shape` builds the surfaces that there are, parametric and low in
triangles (ours, CC0 1.0: do with them what you like).
"""

from .shapes import FURNITURE, HELD, HIGH, KINDS, WIDE, shape
from .thing import MOST_FACES, MOST_THINGS, MOST_VERTICES, Mesh, Thing

__all__ = [
    "FURNITURE", "HELD", "HIGH", "KINDS", "MOST_FACES", "MOST_THINGS", "MOST_VERTICES", "WIDE", "Mesh", "Thing",
    "shape",
]  # fmt: skip
