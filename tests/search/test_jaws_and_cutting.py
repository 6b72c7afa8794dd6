"""What a program asks of flat jaws, from the design to its verification, its file, its sheet and the command."""

import json
from pathlib import Path

import pytest
from attrs import evolve

import workhold
from workhold.model.program import Program

RECTANGLE = ((0, 0), (100, 0), (100, 60), (0, 60))
TOOLS = "tool.1 = {diameter = 10, flute_length = 30, stickout = 40, holder_diameter = 40}\n"
POCKET = """G21 G90 G17
T1 M6
S4000 M3
G0 X30. Y25. Z10.
G1 Z-3. F200
G1 X70. F800
G3 X70. Y35. I0. J5.
G1 X30.
Y25.
G0 Z20.
M30
"""


@pytest.fixture
def files(tmp_path: Path) -> Path:
    (tmp_path / "pocket.nc").write_text(POCKET)
    (tmp_path / "tools.toml").write_text(TOOLS)
    return tmp_path


def program_in(folder: Path, force: float | None = 400.0) -> Program:
    cutting = None if force is None else {"cutting_force": force}
    return Program.read(folder / "pocket.nc", folder / "tools.toml", thickness=25, cutting=cutting)


def designed(folder: Path, outline=RECTANGLE, **more):
    vise = workhold.PlainVise(jaw_width=152, jaw_height=48, parallels=[30], max_opening=150, max_force=20000)
    return workhold.design(
        workhold.Workpiece.from_points("plate", outline),
        vise,
        thickness=25,
        program=program_in(folder),
        **more,
    )


@pytest.mark.thorough
def test_a_pocket_names_its_line_and_stands_before_verification(files: Path) -> None:
    result = designed(files)
    first = result[0].hold
    assert first is not None and first.program_need is not None
    assert first.clamp_needed == first.program_need.force > 2 * 400 / (2 * 0.1)
    assert first.program_need.tool == 1 and 6 <= first.program_need.line <= 9
    assert first.slip_reserve == pytest.approx(20000 / first.clamp_needed)
    outcome = workhold.verify(result)
    assert (outcome.proven, outcome.faults) == (len(result), ())


@pytest.mark.thorough
def test_loads_and_the_program_together_ask_for_the_worst(files: Path) -> None:
    load = workhold.Load(points=((50, 30),), force=6000, directions=(0, 0))
    square = workhold.Restrictions(angles=[(0, 0)])
    alone, both = (designed(files, restrictions=square, loads=loads)[0].hold for loads in ([], [load]))
    assert alone is not None and both is not None and alone.clamp_needed is not None
    assert both.clamp_needed == both.clamp_needed_each[0] > alone.clamp_needed
    assert both.program_need == alone.program_need


@pytest.mark.thorough
@pytest.mark.parametrize("change", [{"force": 0.9}, {"force": 1.1}, {"line": 5}, {"force": None}])
def test_another_force_or_line_is_refuted(files: Path, change: dict[str, float | None]) -> None:
    result = designed(files)
    hold = result.holds[0]
    assert hold.program_need is not None and hold.program_need.force is not None
    kept = {**change}
    if kept.get("force") is not None:
        kept["force"] *= hold.program_need.force
    told = evolve(hold, program_need=evolve(hold.program_need, **kept))
    assert workhold.verify(evolve(result, holds=(told, *result.holds[1:]))).refuted == 1


@pytest.mark.thorough
def test_a_file_keeps_what_the_program_asks_for(files: Path) -> None:
    result = designed(files)
    path = files / "r.json"
    workhold.save(result, path)
    again = workhold.open(path)
    needs = [one.program_need for one in again.holds]
    assert [need and (need.line, need.tool, need.move) for need in needs] == [
        one.program_need and (one.program_need.line, one.program_need.tool, one.program_need.move)
        for one in result.holds
    ]
    entry = json.loads(path.read_text())["fixtures"][0]
    assert entry["program_force"]["force"] == entry["quality"]["clamp_needed"]


@pytest.mark.thorough
def test_where_a_jaw_cannot_press_all_over_the_program_is_held_by_no_force(files: Path) -> None:
    result = designed(files, ((0, 0), (100, 0), (50, 60)))
    held = [one for one in result.holds if not one.full_contact]
    assert all(one.program_need is not None and one.program_need.force is None for one in held)
    assert all(one.is_beyond_rating for one in held)


def test_the_thickness_is_needed(files: Path) -> None:
    part, vise = workhold.Workpiece.from_points("plate", RECTANGLE), workhold.PlainVise(jaw_width=152)
    with pytest.raises(workhold.InputError, match="give its thickness"):
        workhold.design(part, vise, program=program_in(files))
