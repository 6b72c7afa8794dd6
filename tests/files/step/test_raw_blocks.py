"""The raw block of a solid goes around all of it, also around a flange in the middle that no jaw could touch."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from step_shapes import cylinder, fused, write_step

import workhold
from workhold import InputError, PlainVise
from workhold.verification import verify

VISE = PlainVise(jaw_width=152, jaw_height=48, max_opening=150, parallels=[20, 40])


@pytest.fixture
def flanged(tmp_path: Path) -> Path:
    """A spindle of 20 mm, 30 mm high, with a flange of 50 mm from 12 to 18 mm."""
    return write_step(
        tmp_path / "flanged.step", fused(cylinder(10, 30, (0, 0, 0)), cylinder(25, 6, (0, 0, 12)))
    )


def test_block_goes_around_a_flange(flanged: Path) -> None:
    found = workhold.design(workhold.load(flanged), VISE, raw={"side": 2, "top": 1, "bottom": 8})
    query = found.query
    assert query.workpiece.bounds == pytest.approx((-27.0, -27.0, 27.0, 27.0), abs=1e-9)
    assert query.part_height == pytest.approx(39.0) and query.workpiece.solid is None
    assert query.workpiece.as_finished.bounds == pytest.approx((-25.0, -25.0, 25.0, 25.0), abs=1e-9)
    # Jaws 48 mm high on parallels of 40: level with the part's lower side.
    assert found[0].hold.parallels == 40.0 and found[0].hold.grip == 8.0
    assert verify(found).holds


def test_outline_of_low_pegs_makes_no_block(flanged: Path) -> None:
    low = workhold.load(flanged, peg_height=8)
    with pytest.raises(InputError, match="the lowest 8 mm: read the part without a peg height"):
        workhold.design(low, VISE, raw={"side": 2})
