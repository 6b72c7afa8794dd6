"""Tables of tools in their four forms, and what is said of tools that are not known."""

from __future__ import annotations

from pathlib import Path

import pytest
from program_examples import HEAD, read_text, read_tools

from workhold.errors import InputError
from workhold.model.cutting_tool import Tool

TOML = """
unit = "mm"
[tool.1]
name = "end mill"
diameter = 10
flute_length = 22
stickout = 40
holder_diameter = 40
holder_length = 50
[tool.12]
diameter = 3
flute_length = 9
shank_diameter = 6
stickout = 30
corner_radius = 0.5
"""
CSV = """tool,name,diameter,flute_length,stickout,holder_diameter,holder_length,shank_diameter,unit
1,end mill,10,22,40,40,50,,mm
T12,,3,9,30,,,6,mm
"""
STACKS = {
    1: [(0.0, 40.0, 5.0), (40.0, 90.0, 20.0)],
    12: [(0.0, 9.0, 1.5), (9.0, 30.0, 3.0)],
}


def stacks(tools: dict[int, Tool]) -> dict[int, list[tuple[float, float, float]]]:
    """Heights and radii of the cylinders of tools."""
    return {key: [(one.low, one.high, one.radius) for one in tool.cylinders] for key, tool in tools.items()}


def table(folder: Path, text: str, name: str = "tools.toml") -> Path:
    """A file with some text."""
    path = folder / name
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("tools.toml", TOML),
        ("tools.csv", CSV),
        ("tools.csv", CSV.replace(",", ";").replace(";10;", ";10,0;")),
        ("tools.txt", CSV.replace(",", "\t") + "\n\n"),
        (
            "tools.toml",
            TOML.replace('unit = "mm"\n', "").replace("diameter = 10", 'unit = "mm"\ndiameter = 10', 1),
        ),
    ],
)
def test_tables_say_the_same(tmp_path: Path, name: str, text: str) -> None:
    """A flute up to the holder or the shank, the shank, the holder; commas, semicolons and tabs."""
    found, said = read_tools(tmp_path, table(tmp_path, text, name), 1, 12)
    assert stacks(found) == STACKS and found[1].name == "end mill" and found[12].diameter == 3.0
    assert said == (("unit" in text.split("[tool.12]")[0] and "unit" in text[:20]) or name != "tools.toml")


def test_lengths_are_in_the_unit_that_is_said_or_that_of_the_program(tmp_path: Path) -> None:
    """The file's, a tool's own, or the program's, which is then noted."""
    for text, diameter in (
        ("tool.1 = {diameter = 0.5}", 12.7),
        ('unit = "mm"\ntool.1 = {diameter = 0.5}', 0.5),
        ('tool.1 = {diameter = 0.5, unit = "inch"}', 12.7),
    ):
        found, said = read_tools(tmp_path, table(tmp_path, text), 1, unit="G20")
        assert found[1].diameter == diameter and said == ("unit" in text)
    program = HEAD.replace("G21", "G20") + "G0 X0 Y0 Z0\n"
    read = read_text(tmp_path, program, tools=table(tmp_path, "tool.1 = {diameter = 0.5}"))
    assert "is read in inch like the program" in read.notes[1] and read.tools[1].diameter == 12.7
    assert read_text(tmp_path, program, tools={1: 0.5}).tools[1].diameter == 12.7


def test_a_holder_as_wide_as_its_tool_is_known(tmp_path: Path) -> None:
    """What a table says of a holder is known, whatever its width and length; a shank is not a holder."""
    program, words = HEAD + "G0 X0 Y0 Z9\n", "The holder of T1 is not known"
    for further, is_known in (
        ("holder_diameter = 10, holder_length = 30", True),
        ("holder_diameter = 40", True),
        ("flute_length = 20, shank_diameter = 8", False),
    ):
        tools = table(tmp_path, f"tool.1 = {{diameter = 10, stickout = 40, {further}}}")
        read = read_text(tmp_path, program, tools=tools)
        assert (words not in "\n".join(read.notes)) == is_known


def test_the_table_of_linuxcnc(tmp_path: Path) -> None:
    """T, P, D and Z in any order; Z says nothing of the shape, and tools without a diameter are left out."""
    lines = ["T1 P1 D10 Z50.2 ;end mill", "D3.5P2Z+1T7", "P9 T9 Z4 ; probe", "Z-.5 P3 T+12 D+8."]
    for turned in range(len(lines)):
        text = "; my tools\n" + "\n".join(lines[turned:] + lines[:turned]) + "\n\n"
        found, said = read_tools(tmp_path, table(tmp_path, text, "tool.tbl"), 1, 7, 12)
        assert not said and set(found) == {1, 7, 12}
        with pytest.raises(InputError, match="the diameter of T9 is not known"):
            read_tools(tmp_path, tmp_path / "tool.tbl", 9)
    assert (found[1].name, found[1].diameter, found[7].diameter) == ("end mill", 10.0, 3.5)
    assert stacks(found)[1] == [(0.0, 1000.0, 5.0)]


@pytest.mark.parametrize(
    ("text", "diameter", "name"),
    [
        ("T3 D=6. CR=0. - ZMIN=-5. - flat end mill", 6.0, "flat end mill"),
        ("T3  D=6 CR=0 TAPER=118deg - ZMIN=-5 - DRILL", 6.0, "DRILL"),
        ("T3 D=10 CR=0", 10.0, ""),
        (
            "t3 spiral mill 3.175*12mm   D=3.175 CR=0. - ZMIN=-26. - flat end mill",
            3.175,
            "spiral mill 3.175*12mm",
        ),
        ("T3 d=.5 CR=0.", 0.5, ""),
    ],
)
def test_comments_describe_tools(tmp_path: Path, text: str, diameter: float, name: str) -> None:
    """As Fusion and others write them, whatever stands between."""
    program = f"({text})\n{HEAD.replace('T1', 'T3')}G0 X0 Y0 Z0\n"
    (tool,) = read_text(tmp_path, program, tools=None).tools.values()
    assert (tool.number, tool.diameter, tool.name) == (3, diameter, name)


def test_other_comments_describe_none(tmp_path: Path) -> None:
    """Tool changes, remarks about other things, and diameters of 0."""
    texts = ["TC: T3 6mm", "M6 T3", "T3", "D=5", "T3 D=0 CR=0", "THICK D=4", "T3 D=abc", "Diameter: 6.0"]
    for text in texts:
        program = f"({text})\nG21 G90\nT3 M6\nG0 X0 Y0 Z0\n"
        with pytest.raises(InputError, match="the diameter of T3 is not known"):
            read_text(tmp_path, program, tools=None)


def test_comments_of_other_posts(tmp_path: Path) -> None:
    """OpenBuilds says the unit; FreeCAD speaks of the tool in the spindle, in mm whatever the program's unit."""
    said = "(Tool 5: Spot Drill 3 Flutes, Diam = 5mm, Len = 20.00mm)\n(Tool 6: mill, Diam = 0.25in)\n"
    calls = "".join(f"T{number} M6\nG0 X0 Y0 Z9\n" for number in (5, 6))
    found = read_text(tmp_path, f"{said}G20 G90\n{calls}", tools=None).tools
    assert (found[5].diameter, found[5].name, found[6].diameter) == (5.0, "Spot Drill 3 Flutes", 6.35)
    text = (
        "(Compensated Tool Path. Diameter: 6.35)\nG0 X0 Y0 Z9\nT2 M6\n(Compensated Tool Path. Diameter: 3)\n"
    )
    later = "G0 X1 Y1 Z9\nT4 M6\n(Compensated Tool Path. Diameter: 8)\nG0 X1 Y1 Z9\n"
    read = read_text(tmp_path, "G20 G90\n" + text + later, tools=None)
    assert {key: tool.diameter for key, tool in read.tools.items()} == {0: 6.35, 2: 3.0, 4: 8.0}


def test_two_diameters_of_a_tool_are_refused_and_one_twice_is_not(tmp_path: Path) -> None:
    """A program of several operations lists a tool again."""
    same, other = "(T1 D=6. CR=0. - drill)\n" * 2, "(T1 D=6.)\n(T1 D=6.5)\n"
    text = HEAD + "G0 X0 Y0 Z0\n"
    assert read_text(tmp_path, same + text, tools=None).tools[1].diameter == 6.0
    with pytest.raises(InputError, match="line 2: the comments give T1 two diameters"):
        read_text(tmp_path, other + text, tools=None)
    assert read_text(tmp_path, other + text, tools={1: 7}).tools[1].diameter == 7.0


def test_tools_that_are_not_known_are_named_with_the_form_in_which_to_give_them(tmp_path: Path) -> None:
    """The line that is shown is one of the table, and fills the gap."""
    text = HEAD + "G0 X0 Y0 Z0\nT5 M6\nG0 X1 Y0 Z0\nT3 M6\nG0 X1 Y0 Z0\nT9 M6\n"
    with pytest.raises(InputError) as caught:
        read_text(tmp_path, text, tools={3: 5.0})
    words = str(caught.value)
    assert "the program calls T1, T3 and T5, and the diameter of T1 and T5 is not known" in words
    line = words.partition("such as ")[2].rstrip(".")
    assert line.startswith("tool.1 = {diameter = ")
    shown = f"{line}\n{line.replace('tool.1', 'tool.5')}\n{line.replace('tool.1', 'tool.3')}"
    assert set(read_text(tmp_path, text, tools=table(tmp_path, shown)).tools) == {1, 3, 5}


def test_a_tool_before_any_call(tmp_path: Path) -> None:
    """It is the only one that is given, or number 0 of the table; else it is asked for."""
    text = "G21 G90\nG0 X0 Y0 Z0\n"
    read = read_text(tmp_path, text, tools={7: 5.0})
    assert set(read.tools) == {7} and "T7, the only one given, is taken" in read.notes[1]
    assert set(read_text(tmp_path, text, tools={0: 4.0, 7: 5.0}).tools) == {0}
    with pytest.raises(
        InputError, match=r"without calling a tool, and what is in the spindle \(T0\) is not known"
    ):
        read_text(tmp_path, text, tools={3: 4.0, 7: 5.0})
    later = read_text(tmp_path, text + "T3 M6\nG0 X5 Y5 Z5\n", tools={0: 4.0, 3: 5.0})
    assert later.moves.tool.tolist() == [0, 3]
    early = read_text(tmp_path, text + "T3 M6\nG0 X5 Y5 Z5\n", tools={3: 5.0})
    assert early.moves.tool.tolist() == [3] and "Line 2: a rapid move before any tool" in "".join(early.notes)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("t.toml", "tool.1 = {diameter = 0}", "diameter is not a length above 0"),
        ("t.toml", "tool.1 = {diameter = true}", "diameter is not a length above 0"),
        ("t.toml", "tool.1 = {name = 'a'}", "tool.1 has no diameter"),
        ("t.toml", "tool.1 = {diameter = 5, length = 4}", "unknown key 'length'"),
        ("t.toml", "tool.a = {diameter = 5}", "'a' is not the number of a tool"),
        ("t.toml", "tool.1 = 5", "its tools are not tables"),
        ("t.toml", "tools = 5", "'tools' is not known"),
        ("t.toml", "unit = 'ell'", "ell"),
        ("t.toml", "", "there are no tools in it"),
        ("t.toml", "tool.1 = {", "not valid TOML"),
        ("t.toml", "tool.1 = {diameter = 5, holder_diameter = 9}", "a holder and no stickout"),
        ("t.toml", "tool.1 = {diameter = 5, holder_length = 9}", "no holder_diameter"),
        ("t.toml", "tool.1 = {diameter = 5, shank_diameter = 9}", "no flute_length"),
        ("t.toml", "tool.1 = {diameter = 5, stickout = 2e6}", "beyond"),
        ("t.csv", "a,b\n1,2\n", "names no columns"),
        ("t.csv", "", "names no columns"),
        ("t.csv", "tool,diameter\n1,5\n1,6\n", "T1 is given twice"),
        ("t.csv", "tool,diameter\n1,5,6\n", "row 1 has 3 cells under 2 names"),
        ("t.csv", "tool,diameter\nx,5\n", "row 1: 'x' is not the number"),
        ("t.csv", "tool,diameter\n1,five\n", "T1: diameter is not a length"),
        ("t.tbl", "T1 P1 D5\nhello\n", "line 2 is not one of LinuxCNC's"),
        ("t.tbl", "T1.5 P1 D5\n", "is not the number"),
        ("t.tbl", "T1 P1 Z5\n", "there are no tools"),
    ],
)
def test_tables_that_are_none_are_refused(tmp_path: Path, name: str, text: str, words: str) -> None:
    """Naming the file and the tool."""
    with pytest.raises(InputError, match=words) as caught:
        read_tools(tmp_path, table(tmp_path, text, name), 1)
    assert str(caught.value).startswith(f"{tmp_path / name} is not a table of tools: ")
