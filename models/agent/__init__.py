"""The virtual agent of Chopin's thesis (chapter 5): the network that recognises a gesture."""
