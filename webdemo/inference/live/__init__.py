"""Motion that is made while somebody watches or moves: reactions to a stream, and a partner in the room."""
