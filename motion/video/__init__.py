"""From the landmarks that a pose network finds in a film to clips on SMPL22, without torch and without pictures."""

from .landmarks import Landmarks, Sent, unpack_film
from .people import Filmed, people_of

__all__ = ["Filmed", "Landmarks", "Sent", "people_of", "unpack_film"]
