"""Scenes as beats in sequence: any act of one with any answer of the other, then the next beat.

:mod:`.performer` is the timeline of one person, :mod:`.play` two of them on one stage, :mod:`.acts` what one
person does, and :mod:`.moves` where two go. Two act on each other in :mod:`.touching`, :mod:`.joined`
and :mod:`.blows`. :mod:`.script` draws the beats that follow each other.
"""
