"""Scores of what is shipped: ``python -m training.evaluate``, and a module for each other table."""
