"""The papers' tables that compare trainings, small, on SBU and K3HI: ``python -m training.evaluate.paper_tables``."""
