"""Pipelines of the checkpoints that the papers' authors released, one file a network."""
