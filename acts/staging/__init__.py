"""From a plan to what the network is given: the stage, with shapes, ways and bodies. No torch."""
