"""InterFormer (Chopin, thesis, chapter 3): the network, its decoding, and the shipped :mod:`.compact`."""
