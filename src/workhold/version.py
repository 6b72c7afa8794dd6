"""The version, and the number of what a search answers, where every layer may read them."""

from __future__ import annotations

__all__ = ["ANSWERS", "__version__"]

__version__ = "0.1.0"
# Is raised whenever the same question may get another answer, or the same answer other bytes in a file, within
# a version: records of batches from before are then made anew.
ANSWERS = 3
