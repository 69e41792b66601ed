"""Models of a lab's own, named in the settings: released checkpoints of the papers, and Python classes.

:mod:`.entries` reads the tables ``[models.NAME]``, :mod:`.released` and :mod:`.classes` turn each into a
:class:`~webdemo.inference.method.Method`. No module here imports torch when it is imported.
"""
