"""The finish of a motion, while and after it is made: damping, clean-up, joining, touches, sizes."""
