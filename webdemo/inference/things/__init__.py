"""Things of a finished motion: what the plan's acts are done with, put into hands, under people and on tables.

This comes after the network and changes no joint. :mod:`.uses` reads the plan, :mod:`.timing` finds the moments in the
motion, :mod:`.holding` says where a hand holds a thing, and :mod:`.tracks` makes the tracks. The same plan and the same
motion give the same things.
"""

from .furnishing import furnished
from .own import with_own_thing

__all__ = ["furnished", "with_own_thing"]
