"""Several processes or machines: the engine on Ray Serve."""
