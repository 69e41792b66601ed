"""Poses and courses of bodies that words ask for: limbs, hands, steps, blows and figures of the whole body."""
