"""One thread a test run, so that results do not depend on the machine."""

import sys
from pathlib import Path

import torch

sys.path.insert(0, str(Path(__file__).parent))  # for `from reference_arrays import …`
torch.set_num_threads(1)
