"""From the landmarks that a pose network finds in a film to clips on SMPL22, without torch and without pictures."""

from .landmarks import Landmarks, unpack_film
from .person import Filmed, person_of

__all__ = ["Filmed", "Landmarks", "person_of", "unpack_film"]
