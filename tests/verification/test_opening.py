"""A fixture that clamps by opening: the sign of clamping is the toolkit's."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from workhold import Fixture, OpeningVise, Peg, Pose, Vise, Workpiece
from workhold.verification import verify_file, verify_fixture

SQUARE = [[-17, -17, 0], [-17, 17, 0], [17, 17, 0], [17, -17, 0]]
RING = Workpiece.from_loops("ring", [[[-30, -30, 0], [30, -30, 0], [30, 30, 0], [-30, 30, 0]], SQUARE])
NUMBERS = {"pitch": (10.0, 10.0), "columns": 2, "peg_radius": 3.0, "min_gap": 6.0, "row_offset": 8.0}
# A pinwheel inside the square hole: pegs at (-14, -4), (-4, -14), (4, 14) and (14, 4) about its centre, each pushing on its
# own side with the force of the jaws.
HELD = (
    ("left", 0, 1, 0.0, 10.0, 4),
    ("left", 1, 0, 10.0, 0.0, 7),
    ("right", 0, 2, 18.0, 28.0, 5),
    ("right", 1, 1, 28.0, 18.0, 6),
)
# By hand: all forces are equal; the sides' contact features run from -14 to 14 mm.
QUALITY = {"closure_margin": 0.25, "clamp_amplification": 1.0, "end_distance": 10.0}


def pinwheel() -> Fixture:
    """The fixture."""
    pegs = tuple(Peg(*peg, 1.0) for peg in HELD)  # type: ignore[arg-type]
    return Fixture("I", pegs, Pose(0.0, 14.0, 14.0), 8.0, QUALITY)  # type: ignore[arg-type]


def test_it_is_proven_in_an_opening_vise_only() -> None:
    assert verify_fixture(pinwheel(), RING, OpeningVise(**NUMBERS)).verdict == "proven"  # type: ignore[arg-type]
    ruling = verify_fixture(pinwheel(), RING, Vise(**NUMBERS))  # type: ignore[arg-type]
    assert (ruling.verdict, ruling.reason) == (
        "refuted",
        "closing the vise does not clamp: the clamping force is -0.25",
    )


@pytest.mark.parametrize(
    ("kind", "reason"),
    [
        ("opening-vise", "its wrench radius is missing"),
        ("vise", "closing the vise does not clamp: the clamping force is -0.25"),
    ],
)
def test_a_file_names_its_toolkit(tmp_path: Path, kind: str, reason: str) -> None:
    """The same fixture as another program's file writes it, with three figures of the five: all that speaks against it."""
    keys = ("jaw", "column", "row", "x", "y", "segment")
    listed = {
        "type": "I",
        "pegs": [dict(zip(keys, peg, strict=True)) | {"force": 1.0} for peg in HELD],
        "pose": {"theta_deg": 0.0, "x": 14.0, "y": 14.0},
        "jaw_separation": 8.0,
        "quality": QUALITY,
    }
    data = {
        "format": "workhold-result/1",
        "workpiece": {"name": "ring", "units": "mm", "loops": [loop.tolist() for loop in RING.loops]},
        "toolkit": {"kind": kind, **NUMBERS},
        "counts": {"I": 1, "II": 0},
        "fixtures": [listed],
    }
    path = tmp_path / "opening.json"
    path.write_text(json.dumps(data))
    outcome = verify_file(path)
    assert [item.reason for item in outcome.unproven] == [reason]
    assert (
        "the key ranking is missing" in outcome.faults
        and "the key toolkit.blocked is missing" in outcome.faults
    )
