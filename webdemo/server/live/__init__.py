"""Live streams: a person's poses arrive while they move, and a partner answers each of them."""
