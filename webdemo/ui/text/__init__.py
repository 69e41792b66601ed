"""What the page says: words, read-outs, examples. Nothing here knows Gradio's components."""
