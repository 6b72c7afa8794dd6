"""Cutting forces by hand: given, by power and by Kienzle; what lacks something is named with its remedy."""

from __future__ import annotations

from itertools import pairwise
from math import pi, radians, sin, sqrt, tan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from workhold import InputError, Program
from workhold.model.cutting_forces import CuttingForces, compute_cutting_forces, compute_engaged_tooth_sum
from workhold.model.cutting_tool import MATERIALS, SOURCE, CuttingData, Cylinder, Tool, find_material
from workhold.model.moves import Moves

# A rapid move, a line, a ramp down, a hole down and up at the feed.
PLACES = [(0, 0, 5), (0, 0, -2), (30, 0, -2), (30, 20, -4), (30, 20, -9), (30, 20, 1)]


def moves_of(feed: float = 600.0, spindle: float = 3000.0) -> Moves:
    """Moves of one tool."""
    pairs = pairwise(PLACES)
    rows = [(k, 1, k > 1, a, b, 0.0, feed * (k > 1), spindle) for k, (a, b) in enumerate(pairs, 1)]
    return Moves.from_rows(rows)


def solve_contact_forces(own: dict[str, Any], job: dict[str, Any] | None = None, **how: Any) -> CuttingForces:
    """The forces of a tool of 10 mm, called a drill so that it drills straight down."""
    tool = Tool(1, [Cylinder(0, 40, 5)], 10, cutting=CuttingData(**own), kind="drill")
    found = compute_cutting_forces(moves_of(**how), {1: tool}, CuttingData(**(job or {})))
    assert found is not None
    return found


def test_a_given_force_acts_where_the_tool_cuts() -> None:
    found = solve_contact_forces({"cutting_force": 500, "cut_depth": 3, "helix_angle": 45})
    assert found.force.tolist() == [0, 500, 500, 0, 0]
    assert found.torque.tolist() == [0, 2500, 2500, 2500, 0]
    assert found.height.tolist() == [0, 1.5, 1.5, 0, 0]
    # A helix of 45 degrees pulls as much as it pushes; a ramp presses down, and a drill with 1.4 times it.
    assert found.axial == pytest.approx(np.array([[0, 0], [-500, 0], [-500, 500], [0, 700], [0, 0]]))
    assert solve_contact_forces({"cutting_force": 500}).axial[1, 0] == pytest.approx(-500 * tan(radians(30)))


def test_power_and_speed_make_a_force() -> None:
    # 60 000 * 2.2 kW / (pi * 0.01 m * 3000 / min).
    assert solve_contact_forces({"power": 2.2}).force[1] == pytest.approx(60000 * 2.2 / (pi * 0.01 * 3000))


def test_kienzle_by_hand() -> None:
    # 600 / (3000 * 4) = 0.05 mm a tooth; a quarter of the diameter is 60 degrees, in which one of 4 teeth cuts.
    own = {"teeth": 4, "cut_depth": 2, "cut_width": 2.5, "material": "steel"}
    chip = 0.05 * sin(radians(60))
    assert solve_contact_forces(own).force[1] == pytest.approx(1500 * chip ** (1 - 0.22) * 2, rel=1e-9)
    # Of a slot two of 4 teeth cut at once, at 45 degrees each they add up to most.
    full = solve_contact_forces(own | {"cut_width": None})
    assert full.force[1] == pytest.approx(2 * 1500 * (0.05 * sqrt(0.5)) ** 0.78 * 2, rel=1e-9)
    # A drill with two lips and a point of 118 degrees: f D kc / 4.
    thick = 0.2 / 2 * sin(radians(59))
    kc = 1500 * thick**-0.22
    hole = solve_contact_forces({}, {"material": "steel", "teeth": 4, "cut_depth": 2})
    assert hole.torque[3] == pytest.approx(0.2 * 10 * kc / 4 * 5, rel=1e-9)
    assert hole.axial[3].tolist() == pytest.approx([0, 1.4 * 0.2 * 10 * kc / 4])


@pytest.mark.parametrize(("teeth", "angle"), [(1, 0.3), (2, pi), (3, pi), (4, 2.0), (6, pi / 2), (7, 2.9)])
def test_teeth_add_up_to_most_where_a_walk_says(teeth: int, angle: float) -> None:
    pitch = 2 * pi / teeth
    best = 0.0
    for k in range(20_000):
        at = pitch * k / 20_000
        best = max(best, sum(sin(a) ** 0.75 for i in range(teeth) if 0 <= (a := at + i * pitch) <= angle))
    assert compute_engaged_tooth_sum(teeth, angle, 0.75) == pytest.approx(best, rel=2e-3)
    assert compute_engaged_tooth_sum(teeth, angle, 0.75) >= best - 2e-4


def test_what_a_tool_says_goes_before_what_the_job_says() -> None:
    found = solve_contact_forces({"cutting_force": 80}, {"material": "steel"})
    assert found.force[1] == 80
    assert found.reasons[1] == "as given."
    assert (
        compute_cutting_forces(moves_of(), {1: Tool(1, [Cylinder(0, 9, 5)], 10)}, CuttingData(teeth=3))
        is None
    )


@pytest.mark.parametrize(
    ("own", "job", "how", "said"),
    [
        ({}, {"material": "brass"}, {}, "T1 lacks its teeth and its depth of cut"),
        ({"teeth": 3}, {"material": "brass"}, {}, "T1 lacks its depth of cut"),
        (
            {"power": 2},
            {},
            {"spindle": 0},
            "line 2: T1 cuts, and the program does not say the spindle's speed",
        ),
        ({"teeth": 2, "cut_depth": 1}, {"material": "brass"}, {"feed": 0}, "does not say a feed"),
        ({}, {"cutting_force": -1}, {}, "cutting_force -1 cannot be used"),
        ({}, {"power": 2, "material": "steel"}, {}, "power and material are two ways to the same force"),
        ({}, {"material": "butter"}, {}, "the material 'butter' is not known"),
        ({}, {"material": "1500,2"}, {}, "mc 2 cannot be used"),
        ({"teeth": 2.5}, {}, {}, "give a whole number from 1"),
        ({}, {"direction": "up"}, {}, "give any or feed"),
    ],
)
def test_what_is_lacking_is_named(own: Any, job: Any, how: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        solve_contact_forces(own, job, **how)


def test_a_tool_without_any_is_named() -> None:
    tools = {1: Tool(1, [Cylinder(0, 9, 5)], 10), 2: Tool(2, [Cylinder(0, 9, 5)], 10)}
    tools[2] = Tool(2, [Cylinder(0, 9, 5)], 10, cutting=CuttingData(cutting_force=9))
    with pytest.raises(InputError, match="T1 has no cutting force: give its cutting_force"):
        compute_cutting_forces(moves_of(), tools, CuttingData())


def test_every_material_has_its_source_and_a_name_of_its_own() -> None:
    assert len({one.name for one in MATERIALS}) == len(MATERIALS) >= 12
    assert all(one.source == SOURCE and "group" in one.words for one in MATERIALS)
    assert find_material(" ALUMINUM ") is find_material("aluminium")
    assert find_material("Cast Iron").kc < find_material("titanium").kc


TABLE = """unit = "inch"
tool.1 = {diameter = 0.5, flutes = 4, cut_depth = 0.1, point_angle = 400}
"""
NC = "G20 G90\nT1 M6\nS2000 M3\nG0 X0 Y0 Z1\nG1 Z-0.1 F10\nG1 X1 F20\nG2 X2 Y-1 I0 J-1\nM30\n"


def test_a_table_in_inches_and_a_program_come_back_from_their_entries(tmp_path: Path) -> None:
    (tmp_path / "t.toml").write_text(TABLE)
    (tmp_path / "p.nc").write_text(NC)
    bare = Program.read(tmp_path / "p.nc", tmp_path / "t.toml", z_zero=10)
    assert bare.forces is None and "forces" not in bare.to_dict() and bare.tools[1].cutting.teeth == 4
    assert all("cutting" not in piece for piece in bare.to_dict()["pieces"])
    (tmp_path / "t.toml").write_text(TABLE.replace("400", "118"))
    asked = {"material": "aluminium", "direction": "feed"}
    program = Program.read(tmp_path / "p.nc", tmp_path / "t.toml", z_zero=10, cutting=asked)
    assert program.forces is not None and program.forces.direction == "feed"
    # 20 in/min at 2000/min with 4 teeth: 0.0635 mm a tooth, 2.54 mm deep, two teeth at 45 degrees.
    by_hand = 2 * 800 * (0.0635 * sqrt(0.5)) ** 0.75 * 2.54
    assert program.forces.force[-1] == pytest.approx(by_hand, rel=1e-9)
    back = Program.from_entries(program.to_dict())
    assert back.forces == program.forces and back.to_dict() == program.to_dict()
    with pytest.raises(InputError, match=r"p\.nc: T1 lacks its depth of cut"):
        Program.read(tmp_path / "p.nc", {1: {"diameter": 9, "teeth": 2}}, z_zero=1, cutting=asked)
    with pytest.raises(InputError, match="cutting has no 'powr'"):
        Program.read(tmp_path / "p.nc", {1: 9}, z_zero=1, cutting={"powr": 2})


def test_the_manual_has_the_numbers_of_the_table() -> None:
    text = (Path(__file__).parents[2] / "docs" / "program.md").read_text()
    cells = [cell.strip() for line in text.splitlines() for cell in line.split("|")]
    for one in MATERIALS:
        place = cells.index(one.name, cells.index("material"))
        group, kc, mc = cells[place + 1 : place + 4]
        assert f"(group {group})" in one.words and (float(kc), float(mc)) == (one.kc, one.mc)
