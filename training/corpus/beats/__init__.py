"""Scenes as beats in sequence: any act of one with any answer of the other, then the next beat.

:mod:`.play` is the timeline of each person and the stage that two share, :mod:`.acts` what one person does,
:mod:`.moves` where two go, and :mod:`.touching` how they act on each other. :mod:`.script` draws the beats that follow
each other.
"""
