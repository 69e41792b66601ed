"""The things of acts in a finished motion: in hands, under people and on tables.

:mod:`.uses` reads from a plan what is done with which thing, :mod:`.courses` moves what is held and thrown,
:mod:`.furniture` places what stands, and :mod:`.furnishing` shapes the hands, brings it together and says whether acts
with things are done: the same plan and the same motion give the same things.
"""
