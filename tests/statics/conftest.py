"""Fixtures of several parts, one part after another."""

from __future__ import annotations

import pytest

from held import CASES, held
from workhold import Result


@pytest.fixture(params=CASES, ids=lambda case: case[0])
def result(request: pytest.FixtureRequest) -> Result:
    """Some fixtures of a part."""
    return held(*request.param)
