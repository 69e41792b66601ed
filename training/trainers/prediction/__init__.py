"""Training of networks that continue a motion."""
