"""Several processes or machines: names for each, and the engine on Ray Serve."""
