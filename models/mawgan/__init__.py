"""PredictiveMA-WGAN (Chopin, thesis, chapter 2): network and losses, on the sphere of :mod:`.srvf`."""
