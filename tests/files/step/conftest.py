"""STEP files are read in the process of the tests, where these are not about the process that reads them.

``test_damaged`` and ``test_library``, and the tests of ``files.apart``, read in processes as the program does.
"""

from __future__ import annotations

import pytest

from reading_here import READERS, run_here

# Modules whose tests are about the process.
APART = ("test_damaged", "test_library")


@pytest.fixture(autouse=True)
def read_here(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read without a process, where the tests are not about it."""
    if not request.module.__name__.endswith(APART):
        for module in READERS:
            monkeypatch.setattr(f"{module}.run_apart", run_here)
