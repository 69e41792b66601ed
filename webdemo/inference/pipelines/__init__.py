"""The pipelines of the methods, one module each: a loaded network and its sampling. These modules import torch."""
