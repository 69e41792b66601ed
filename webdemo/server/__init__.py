"""The page for a lab: settings, accounts, a fair queue, history, limits, health and figures."""

import os

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")  # before Gradio is imported: it asks no other host
os.environ.setdefault("MPLBACKEND", "agg")  # else Gradio has Matplotlib look for a screen at the first event
