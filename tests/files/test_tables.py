"""Tables are read however a spreadsheet writes them, and what could be read in two ways is refused with its place."""

from __future__ import annotations

from pathlib import Path

import pytest
from program_examples import read_tools

from workhold.benchmark.matching import read_entry
from workhold.cli.jobs import read_jobs
from workhold.errors import InputError
from workhold.files.budget import UNLIMITED, Budget, FileLimits
from workhold.files.tables import MOST_COLUMNS, MOST_LETTERS, read_table

HOSTILE = Path(__file__).parents[1] / "data" / "hostile"
ROWS = [{"a": "1", "b": "x"}, {"a": "2", "b": "y, z"}]
# Above this Python's own reader of CSV stops, with an error of its own.
CSV_LIMIT = 131_072


def rows(text: str, remarks: str = "") -> list[dict[str, str]]:
    """The cells of each row."""
    return [dict(row.cells) for row in read_table(text, Budget(UNLIMITED), remarks).iterate_rows()]


@pytest.mark.parametrize("end", ["\n", "\r", "\r\n", "\n\r", "\r\r\n"])
@pytest.mark.parametrize(
    "lines",
    [
        ["a,b", "1,x", '2,"y, z"'],
        ["A , b", " 1 , x ", '2 , "y, z" '],
        ["a,b,", "1,x,", '2,"y, z",'],
        ["", "a,b", "", "1,x", ",", '2,"y, z"', ",,", ""],
        ["a;b", "1;x", "2;y, z"],
        ["a\tb", "1\tx", '2\t"y, z"'],
        ["sep=;", "a;b", "1;x", "2;y, z"],
        ["SEP=,", "a,b", "1,x", '2,"y, z"'],
        ['"a","b"', '"1","x"', '"2","y, z"'],
        ["a,,b", "1,,x", '2,,"y, z"'],
    ],
)
def test_a_table_says_the_same_however_it_is_written(end: str, lines: list[str]) -> None:
    """Any end of line, any of the three marks, empty rows and columns, cells with spaces and in quotes."""
    assert rows(end.join(lines)) == ROWS
    assert rows(end.join(lines) + end) == ROWS


def test_cells_that_are_not_given_are_not_there() -> None:
    """A short row lacks its last cells; quotes twice are one; a cell in quotes may have several lines."""
    assert rows("a,b,c\n1\n,,3\n") == [{"a": "1"}, {"c": "3"}]
    assert rows('a,b\n"1/2"" mill",3/8" drill\n') == [{"a": '1/2" mill', "b": '3/8" drill'}]
    assert rows('a,b\n"x\r\ny",2\n3,4') == [{"a": "x\ny", "b": "2"}, {"a": "3", "b": "4"}]
    assert rows("# tools\na,b\n  # none\n1,# x\n", remarks="#") == [{"a": "1", "b": "# x"}]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "it is empty"),
        ("\n,,\n\n", "it is empty"),
        ("a,b,A\n", "two columns have the name 'a'"),
        ("a,b\n1,2\n1,2,3\n", "line 3, row 2 has 3 cells under 2 names"),
        ("a,,b\n1,2,3\n", r"line 2, row 1, column 2 has a cell and no name"),
        ('a,b\n1,2\n"3,4\n5,6\n', r"line 3, row 2, column 1 \(a\) begins with a quote that is not closed"),
        ('a,b\n1,"2"3\n', r"line 2, row 1, column 2 \(b\) goes on after its closing quote"),
        ('"a,b\n1,2\n', "line 1, column 1 begins with a quote"),
        ("a,b\n\n1,\0\n", r"line 3, row 1, column 2 \(b\) has a NUL byte"),
        (f"a,b\n1,{'x' * 200_000}\n", r"line 2, row 1, column 2 \(b\) has 200,000 letters, more than"),
        (f'a,b\n1,"{"x," * 100_000}"\n', r"line 2, row 1, column 2 \(b\) has 200,000 letters, more than"),
        (f"{'x' * 200_000},b\n1,2\n", "line 1, column 1 has 200,000 letters"),
        (",".join(map(str, range(2000))), "line 1 has more than 1,000 cells"),
        (f"a,b\n1,2\n1{',' * 2000}\n", "line 3, row 2 has more than 1,000 cells"),
    ],
)
def test_what_is_no_table_is_refused_with_its_place(text: str, words: str) -> None:
    """Line, row and column, and what helps."""
    with pytest.raises(InputError, match=words) as caught:
        rows(text)
    assert str(caught.value).endswith(".") and ": " in str(caught.value)


def test_the_largest_cell_and_row_are_read() -> None:
    """A letter or a cell more is refused."""
    assert rows(f"a\n{'x' * MOST_LETTERS}\n") == [{"a": "x" * MOST_LETTERS}]
    with pytest.raises(InputError, match="letters"):
        rows(f"a\n{'x' * (MOST_LETTERS + 1)}\n")
    names = [f"c{k}" for k in range(MOST_COLUMNS)]
    assert rows(f"{','.join(names)}\n{',' * (MOST_COLUMNS - 1)}1\n") == [{names[-1]: "1"}]


def test_rows_are_taken_from_the_budget() -> None:
    """One after the other, so that a table of too many is not read to its end."""
    budget = Budget(FileLimits("a table", None, 2, "rows", remedy="split it"))
    table = read_table("a\n1\n2\n3\n4\n", budget)
    with pytest.raises(InputError, match="more than the 2 rows that a table may have: split it"):
        list(table.iterate_rows())
    assert budget.elements == 3


@pytest.mark.parametrize("mark", [",", ";", "\t"])
@pytest.mark.parametrize("word", ["n/a", "N/A", "#N/A", "-", "–", "", " "])
def test_a_tool_says_in_words_that_something_is_not_given(tmp_path: Path, word: str, mark: str) -> None:
    """An optional cell; a name may be any word."""
    path = tmp_path / "tools.csv"
    path.write_text(mark.join(("tool", "diameter", "flutes", "stickout", "name")) + "\n", encoding="utf-8")
    with path.open("a", encoding="utf-8") as stream:
        stream.write(mark.join(("1", "10.5", word, word, word)) + "\n")
    tools, _ = read_tools(tmp_path, path, 1)
    assert (tools[1].diameter, tools[1].cutting.teeth, tools[1].name) == (10.5, None, word.strip())


@pytest.mark.parametrize("mark", [";", "\t"])
def test_a_comma_in_a_number_is_its_point_where_commas_separate_nothing(tmp_path: Path, mark: str) -> None:
    """As spreadsheets of much of Europe write it."""
    path = tmp_path / "tools.csv"
    path.write_text(f"tool{mark}diameter\n1{mark}10,5\n", encoding="utf-8")
    assert read_tools(tmp_path, path, 1)[0][1].diameter == 10.5


def test_the_tables_that_came_in_are_read(tmp_path: Path) -> None:
    """Flutes that are not given, and lines that end in CR alone."""
    tools, said = read_tools(tmp_path, HOSTILE / "flutes.csv", 1, 2, 3)
    assert [one.cutting.teeth for one in tools.values()] == [None, 3.0, 2.0] and said
    assert [(one.part, one.toolkits) for one in read_jobs(HOSTILE / "jobs_cr.csv")] == [
        ("widget", ["gripper-one-column"])
    ]


@pytest.mark.parametrize("flutes", ["nan", "inf", "1e999", "two", "0", "-3", "2.5"])
def test_flutes_that_are_none_hold_nothing_up(tmp_path: Path, flutes: str) -> None:
    """Where no force is asked for they are not used; where one is, they are refused in a sentence."""
    path = tmp_path / "tools.csv"
    path.write_text(f"tool,diameter,flutes\n1,10,{flutes}\n")
    assert read_tools(tmp_path, path, 1)[0][1].cutting.teeth is None
    path.write_text(f"tool,diameter,flutes,power\n1,10,{flutes},2\n")
    with pytest.raises(InputError, match=r"teeth .* cannot be used: give a whole number from 1"):
        read_tools(tmp_path, path, 1)


@pytest.mark.parametrize("name", ["tools.csv", "jobs.csv", "bar-plate.csv"])
@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"tool,diameter\n1,10\n2,\xd810\n", "not UTF-8 text .*line 3.*Excel"),
        ("tool,diameter\n1,10\n".encode("utf-16"), "not UTF-8 text .*Excel"),
        (b"tool,part\n1,\0\n", "NUL byte|names no columns|columns must be named"),
        (b"tool,part\n1," + b"x" * (CSV_LIMIT + 1) + b"\n", "letters|names no columns|columns must be named"),
    ],
)
def test_every_reader_of_tables_refuses_in_a_sentence(
    tmp_path: Path, name: str, content: bytes, words: str
) -> None:
    """Of tools, jobs and other programs' fixtures; Latin-1 and UTF-16 as Excel writes them."""
    path = tmp_path / name
    path.write_bytes(content)
    reader = {"tools.csv": lambda: read_tools(tmp_path, path, 1), "jobs.csv": lambda: read_jobs(path)}
    with pytest.raises(InputError, match=words):
        reader.get(name, lambda: read_entry(path))()


@pytest.mark.parametrize(
    ("head", "row", "words"),
    [
        ("theta_deg,x,y,peg1,peg1_x,peg1_y", "0,1,2,left,3,4", ""),
        ("theta_deg;x;y;peg1;peg1_x;peg1_y", "0,5;1;2;left;3;4", ""),
        ("theta_deg,x,y,peg1,peg1_x", "0,1,2,left,3", "the column peg1_y is missing"),
        ("theta_deg,x,y,peg1,peg2,peg1_x,peg1_y", "0,1,2,left,left,3,4", "the column peg2_x is missing"),
        ("theta_deg,x,y,peg1,peg1_x,peg1_y", "0,1,2,left,3,", "line 2, row 1, column peg1_y: there is no"),
        ("theta_deg,x,y,peg1,peg1_x,peg1_y", "0,1,two,left,3,4", "column y: 'two' is not a finite number"),
        ("theta_deg,x,y,peg1,peg1_x,peg1_y", "0,1,1e999,left,3,4", "column y: '1e999' is not a finite"),
        ("theta_deg,x,y,peg1,peg1_x,peg1_y", "0,1,1e308,left,3,4", "beyond 1e\\+06 mm"),
        ("theta_deg,x,y,peg1,peg1_x,peg1_y", "0,1,2,,3,4", "the role '' is not known"),
        ("theta_deg,x,y", "0,1,2", "columns must be named"),
    ],
)
def test_a_list_of_fixtures_lacks_no_column(tmp_path: Path, head: str, row: str, words: str) -> None:
    """Nor a number; also of a peg whose columns must be named all there."""
    path = tmp_path / "bar-plate.csv"
    path.write_text(f"{head}\n{row}\n")
    if words:
        with pytest.raises(InputError, match=words):
            read_entry(path)
    else:
        assert [len(one.pegs) for one in read_entry(path).fixtures] == [1]
