"""One server for the tests that do not need one of their own."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from running_server import RunningServer, running_server


@pytest.fixture(scope="session")
def server() -> Iterator[RunningServer]:
    """A server with the usual limits."""
    with running_server() as running:
        yield running
