"""The application: inference, the page, the server and the shell commands."""

from . import quick_gradio, quick_imports

quick_gradio.install()  # before anything of this package imports Gradio
quick_imports.install()
