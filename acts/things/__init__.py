"""The things of acts: what the words name, and, in a finished motion, things in hands, under people and on tables.

:mod:`.nouns` knows what the words name. :mod:`.uses` reads from a plan what is done with which thing, :mod:`.courses`
moves what is held and thrown, :mod:`.furniture` places what stands, and :mod:`.furnishing` shapes the hands, brings
it together and says whether acts with things are done: the same plan and the same motion give the same things.
"""

from .nouns import SEATS, Does, Prop, is_fixture, kind_of, nouns_in, on_floor, thing_of

__all__ = ["SEATS", "Does", "Prop", "is_fixture", "kind_of", "nouns_in", "on_floor", "thing_of"]
