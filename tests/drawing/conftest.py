"""What the tests of the pictures draw."""

from __future__ import annotations

import pytest
from attrs import evolve
from drawing_examples import example

from workhold import Fixture, Vise, Workpiece


@pytest.fixture(params=[1.0, 0.01, 40.0], ids=["usual", "tiny", "huge"])
def held(request: pytest.FixtureRequest) -> tuple[Fixture, Workpiece, Vise]:
    """The example, also half a millimetre and two metres large."""
    return example(request.param)


@pytest.fixture
def many() -> tuple[list[Fixture], Workpiece, Vise]:
    """Twelve fixtures that differ in their names only."""
    fixture, workpiece, vise = example()
    return [evolve(fixture, type="I" if k % 2 else "II") for k in range(12)], workpiece, vise
