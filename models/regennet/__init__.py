"""ReGenNet (Xu et al. 2024): the paper's network, and the variant that is shipped in :mod:`.compact`."""
