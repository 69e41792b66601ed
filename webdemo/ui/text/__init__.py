"""The text of the page: words, read-outs, examples. Nothing here knows Gradio's components."""
