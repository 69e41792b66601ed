"""Things beside two people: chairs and cups, balls and books, in metres.

:class:`Thing` is a surface with its own track. :func:`shape` builds the surfaces that there are, parametric and low in
triangles (ours, CC0 1.0: do with them what you like).
"""

from functools import lru_cache

from motion.errors import InputError

from . import kinds
from .kinds import FIXTURES, FURNITURE, HELD, HIGH, KINDS, LEAVES, WIDE
from .thing import MOST_THINGS, Mesh, Thing

__all__ = ["FIXTURES", "FURNITURE", "HELD", "KINDS", "MOST_THINGS", "Mesh", "Thing", "kinds", "shape"]


@lru_cache(maxsize=64)
def shape(kind: str, *, height: float | None = None, width: float | None = None) -> Mesh:
    """The surface of a kind of thing.

    Args:
        kind: one of :data:`KINDS` or :data:`LEAVES`.
        height: metres from the floor to a seat, a table's top, a bed's mattress or the lintel of a door frame, and
            of a box; the usual by default. Other things have one height.
        width: metres along X of furniture, of a box, and across a ball; the usual by default.

    Raises:
        InputError: if there is no such kind, or a size is not between 1 cm and 3 m.
    """
    if kind not in (*KINDS, *LEAVES):
        raise InputError(f"There is no thing {kind!r:.40}: choose one of {', '.join(KINDS)}.")
    for size in (height, width):
        if size is not None and not 0.01 <= size <= 3.0:
            raise InputError(f"A thing of {size:g} m cannot be built: give 0.01 to 3 m.")
    from .parts import joined  # trimesh takes a while to load
    from .shapes import BUILD

    sizes = {name: value for name, value in (("height", height), ("width", width)) if value is not None}
    takes = {"height": HIGH, "width": WIDE}
    return joined(BUILD[kind](**{name: value for name, value in sizes.items() if kind in takes[name]}))
