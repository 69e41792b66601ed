"""Turns results into pictures; knows no network."""

from .curves import Contact, Curve, find_contacts, interaction_curves
from .payload import Payload, player_payload, sample_payload

__all__ = [
    "Contact",
    "Curve",
    "Payload",
    "find_contacts",
    "interaction_curves",
    "player_payload",
    "sample_payload",
]
