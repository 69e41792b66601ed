"""One trainer a network: ``python -m training.trainers.NAME``."""
