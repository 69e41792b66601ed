"""Scenes as beats in sequence: any act of one with any answer of the other, then the next beat.

:mod:`.performer` is the timeline of one person, :mod:`.play` two of them on one stage, :mod:`.acts` what one
person does, :mod:`.moves` and :mod:`.touching` what two do, :mod:`.script` which beats follow each other.
"""
