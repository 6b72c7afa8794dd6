"""The folder of the benchmarks, whose modules find each other by name, for the tests of the report."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
# Behind everything else: names such as ``batch`` are those of others first.
for folder in (HERE, HERE.parents[1] / "benchmarks"):
    if str(folder) not in sys.path:
        sys.path.append(str(folder))
