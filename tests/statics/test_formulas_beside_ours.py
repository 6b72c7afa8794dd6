"""The manual's tables of what calculators say beside the jaw force that is found here: each figure is reckoned anew."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

import workhold
from workhold import Load, PlainVise, Program, Workpiece

MANUAL = Path(__file__).parents[2] / "docs" / "plain-vise.md"
BLOCK = Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
FRICTION, SAFETY = 0.15, 2.0
# Place, height and direction, or the force upward.
LOADS = {
    "500 N along the jaws at the middle of the grip": Load((50, 30), 500, 0, height=12),
    "500 N along the jaws, 11 mm above that": Load((50, 30), 500, 0, height=23),
    "500 N toward the moving jaw, 11 mm above that": Load((50, 30), 500, 90, height=23),
    "500 N toward the fixed jaw, 11 mm above that": Load((50, 30), 500, 270, height=23),
    "400 N upward, 4 mm beside the middle": Load((54, 30), upward=400),
}
CUTS = {
    "along the jaws, in the middle": ((30, 30), (70, 30)),
    "along the jaws, 8 mm from the fixed one": ((30, 8), (70, 8)),
    "across the jaws, in the middle": ((50, 15), (50, 45)),
    "across the jaws, 8 mm from the part's end": ((92, 15), (92, 45)),
}
CUT, DEEP, THICK = 400.0, 3.0, 25.0


def list_rows(heading: str) -> Iterator[list[str]]:
    """The cells of each row of the manual's table that begins with a heading."""
    lines = MANUAL.read_text(encoding="utf-8").splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith(f"| {heading} |"))
    for line in lines[first + 2 :]:
        if not line.startswith("|"):
            return
        yield [cell.strip() for cell in line.strip("|").split("|")]


def hold(parallels: float, **asked: object) -> workhold.Fixture:
    """The block as drawn on parallels, its lower side on the fixed jaw."""
    vise = PlainVise(jaw_width=152, jaw_height=44, max_opening=150, parallels=[parallels])
    result = workhold.design(BLOCK, vise, thickness=THICK, friction={"jaw": FRICTION}, **asked)
    return next(one for one in result if one.pose.theta_deg == 0.0)


def read_program(folder: Path, cuts: list[tuple[tuple[int, int], tuple[int, int]]]) -> Program:
    lines = ["G21 G90", "T1 M6"]
    for (x0, y0), (x1, y1) in cuts:
        lines += ["G0 Z30.", f"X{x0}. Y{y0}.", "Z1.", f"G1 Z-{DEEP} F200", f"X{x1}. Y{y1}. F600", "G0 Z30."]
    (folder / "slots.nc").write_text("\n".join([*lines, "M30", ""]))
    (folder / "tools.toml").write_text(
        f'unit = "mm"\ntool.1 = {{diameter = 10, flute_length = 30, stickout = 40, cutting_force = {CUT}}}\n'
    )
    return Program.read(folder / "slots.nc", folder / "tools.toml", thickness=THICK, start=(30, 30, 70))


@pytest.mark.thorough
def test_single_loads_are_as_written() -> None:
    rows = list(list_rows("load"))
    assert [row[0] for row in rows] == list(LOADS)
    for name, formula, here, _ in rows:
        load = LOADS[name]
        size = load.force or load.upward
        assert formula == f"{SAFETY * size / (2 * FRICTION):.0f} N"
        assert here == f"{hold(20, loads=[load]).hold.clamp_needed:.0f} N", name


@pytest.mark.thorough
def test_cuts_of_a_program_are_as_written(tmp_path: Path) -> None:
    rows = list(list_rows("cut"))
    assert [row[0] for row in rows] == [*CUTS, "the whole program"]
    for name, formula, tipping, here in rows:
        cuts = [CUTS[name]] if name in CUTS else list(CUTS.values())
        fixture = hold(30, program=read_program(tmp_path, cuts))
        grip = fixture.hold.grip
        assert grip == pytest.approx(14.0)
        assert formula == f"{SAFETY * CUT / (2 * FRICTION):.0f} N"
        assert tipping == f"{SAFETY * CUT * (THICK - DEEP - grip) / (grip / 2):.0f} N"
        assert here == f"{fixture.hold.program_need.force:.0f} N", name


def test_the_mill_pulls_as_written(tmp_path: Path) -> None:
    forces = read_program(tmp_path, list(CUTS.values())).forces
    assert f"pulls with {-forces.axial.min():.0f} N here" in MANUAL.read_text(encoding="utf-8")
