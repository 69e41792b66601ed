"""Things beside two people: chairs and cups, balls and books, in metres.

:class:`Thing` is a surface with its own track. :func:`shape` gives the surfaces that there are.
"""

from . import kinds
from .kinds import FIXTURES, FURNITURE, HELD, KINDS
from .shapes import shape
from .thing import MOST_THINGS, Mesh, Thing

__all__ = ["FIXTURES", "FURNITURE", "HELD", "KINDS", "MOST_THINGS", "Mesh", "Thing", "kinds", "shape"]
