"""The judge: does a duet do what its sentence says, and is it as clean as recorded motion?

:mod:`.rules` checks a motion the way a person would, :mod:`.prompts` picks the sentences,
:mod:`.draw` generates them and :mod:`.report` counts; :mod:`.retrieval` measures by learned features.
``python -m training.evaluate`` runs them all.
"""
