"""Words for scenes of beats: phrases of every act, sentences written by hand, and the grammar that joins them.

``acts.txt`` holds verb phrases, ``sentences/*.txt`` whole sentences by what they tell; :mod:`.lexicon` reads
both, :mod:`.voice` says who is meant, :mod:`.narrator` writes the captions of a scene.
"""

from .narrator import Narrator

__all__ = ["Narrator"]
