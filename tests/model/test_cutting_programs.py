"""Three programs whose forces were worked by hand: a drilled hole, a face mill that comes down beside the part, a slot.

All are on a plate of 120 x 70 x 15 mm, with Z0 at its top. Kienzle's constants are those of the table: steel 1500 N/mm2
and 0.22, aluminium 800 N/mm2 and 0.25.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from workhold import Program, Query, Vise, Workpiece, answer
from workhold.model.cutting_forces import CUT_KINDS, CuttingForces
from workhold.statics.program_forces import find_cutting_need

PLATE = Workpiece.from_points("plate", [(0, 0), (120, 0), (120, 70), (0, 70)])
VISE = Vise(pitch=10, columns=3, peg_radius=3)


def asked(path: Path, tools: str, text: str, material: str, stock: dict[str, float] | None = None) -> Query:
    """The plate with a program and a table of its tools."""
    (path / "t.toml").write_text(tools)
    (path / "p.nc").write_text(text)
    how = {} if stock is None else {"stock": stock}
    program = Program.read(
        path / "p.nc", path / "t.toml", thickness=15, cutting={"material": material}, **how
    )
    return Query(PLATE, VISE, program=program, peg_height=8, best=1)


def solve_contact_forces(query: Query) -> tuple[CuttingForces, list[int]]:
    """The forces of its program, and the lines of its moves."""
    assert query.program is not None and query.program.forces is not None
    return query.program.forces, query.program.moves.line.tolist()


def kinds_by_line(query: Query) -> dict[int, str]:
    """What the program does, by the line that does it."""
    forces, lines = solve_contact_forces(query)
    return {lines[k]: CUT_KINDS[forces.kind[k]] for k in range(len(lines)) if forces.kind[k]}


def test_a_drilled_hole(tmp_path: Path) -> None:
    """Ø 8.5, 180 mm/min at 1200/min: 0.15 mm a turn, so a chip of 0.075 sin 59 = 0.0643 mm.

    kc = 1500 / 0.0643^0.22 = 2743 N/mm2; at the periphery 0.15 x 8.5 x 2743 / 4 = 874.5 N, so a torque of 3717 N mm
    and a thrust of 1.4 x 874.5 = 1224 N. From 17 mm down to -3 mm it drills from the top, 15 mm, on: a tenth is air.
    """
    tools = '[tool.1]\ndiameter = 8.5\ntype = "drill"\n'
    text = "G21 G90\nT1 M6\nS1200 M3\nG0 X60 Y35 Z20\nG81 X60. Y35. Z-18. R2. F180\nG80\nM30\n"
    query = asked(tmp_path, tools, text, "steel", {"side": 0, "top": 0})
    forces, lines = solve_contact_forces(query)
    assert kinds_by_line(query) == {5: "drilling"}
    (move,) = set(forces.stretches.move.tolist())
    assert lines[move] == 5
    assert forces.torque[move] == pytest.approx(3716.6, abs=1.0) and forces.force[move] == 0.0
    assert forces.axial[move].tolist() == pytest.approx([0.0, 1224.3], abs=0.5)
    assert forces.stretches.list_shares(move) == [[pytest.approx(0.1, abs=1e-6), 1.0]]


@pytest.mark.thorough
def test_a_face_mill_that_comes_down_in_air(tmp_path: Path) -> None:
    """Ø 40 with 5 teeth, 600 mm/min at 800/min: 0.15 mm a tooth, 2 mm deep and as wide as the tool.

    Teeth at 18, 90 and 162 degrees cut most: 1 + 2 x sin18^0.78 = 1.800. 1500 x 0.15^0.78 x 2 x 1.800 = 1230 N. It comes
    down at x = -30, where its rim is at -10 and the stock at -5, and presses on nothing. Then it cuts from x = -25 to 145,
    of a way from -30 to 150.
    """
    tools = "[tool.2]\ndiameter = 40\nteeth = 5\ncut_depth = 2\n"
    text = "G21 G90\nT2 M6\nS800 M3\nG0 X-30. Y35. Z5.\nG1 Z-2. F200\nG1 X150. F600\nG0 Z5.\nM30\n"
    query = asked(tmp_path, tools, text, "steel")
    forces, _ = solve_contact_forces(query)
    assert kinds_by_line(query) == {6: "milling"}
    (move,) = set(forces.stretches.move.tolist())
    assert forces.force[move] == pytest.approx(1230.0, abs=1.5)
    assert forces.torque[move] == pytest.approx(1230.0 * 20, abs=30)
    assert forces.stretches.list_shares(move) == [
        [pytest.approx(5 / 180, abs=1e-6), pytest.approx(175 / 180, abs=1e-6)]
    ]
    # Nothing presses down with more than the helix pulls: the plunge is in air.
    assert forces.axial.max() == 0.0
    need = find_cutting_need(answer(query), 0)
    assert need is not None and need.jaw.line == 6


@pytest.mark.thorough
def test_a_slot(tmp_path: Path) -> None:
    """Ø 10 with 4 teeth in aluminium, 4 mm deep: two teeth cut at once, at 45 degrees each.

    600 mm/min at 6000/min: 0.025 mm a tooth. 2 x 800 x (0.025 sin 45)^0.75 x 4 = 310.3 N. The plunge, at 240 mm/min,
    0.01 mm a tooth: 2 x 800 x (0.01 sin 45)^0.75 x 4 = 156.1 N, pressing down; from 3 mm above the top it is in the stock,
    which reaches 5 mm above it.
    """
    tools = "[tool.3]\ndiameter = 10\nteeth = 4\ncut_depth = 4\n"
    text = "G21 G90\nT3 M6\nS6000 M3\nG0 X30. Y35. Z3.\nG1 Z-4. F240\nG1 X90. F600\nG0 Z5.\nM30\n"
    query = asked(tmp_path, tools, text, "aluminium")
    forces, lines = solve_contact_forces(query)
    assert kinds_by_line(query) == {5: "plunging", 6: "milling"}
    plunge, slot = lines.index(5), lines.index(6)
    assert forces.force[slot] == pytest.approx(310.3, abs=0.3) and forces.force[plunge] == 0.0
    assert forces.torque[plunge] == pytest.approx(156.1 * 5, abs=1.0)
    assert forces.axial[plunge].tolist() == pytest.approx([0.0, 156.1], abs=0.2)
    # Nobody said its helix: 30 degrees, which pull with 310.3 tan 30 = 179.2 N; on the level it presses not down.
    assert forces.axial[slot].tolist() == pytest.approx([-179.2, 0.0], abs=0.3)
    assert forces.height[slot] == 2.0
    need = find_cutting_need(answer(query), 0)
    assert need is not None and need.jaw.line == 6


def test_a_tool_that_meets_air_alone_needs_no_data(tmp_path: Path) -> None:
    """What its force would follow from is not asked of a tool that stays above the stock."""
    tools = "[tool.3]\ndiameter = 10\nteeth = 4\ncut_depth = 4\n[tool.4]\ndiameter = 6\n"
    air = "T4 M6\nG0 X-60. Y35.\nG1 Z10. F240\nG1 X-30.\n"
    text = f"G21 G90\nT3 M6\nS6000 M3\nG0 X30. Y35. Z3.\nG1 Z-4. F240\nG1 X90. F600\nG0 Z5.\n{air}M30\n"
    query = asked(tmp_path, tools, text, "aluminium")
    assert kinds_by_line(query) == {5: "plunging", 6: "milling"}
