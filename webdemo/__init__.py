"""The application: inference, the page, the server and the shell commands."""

from .quick_gradio import install

install()  # before anything of this package imports Gradio
