"""Text files are read within a limit, and what JSON and TOML leave open is refused."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import workhold
from workhold import Load, Tolerance, Vise, Workpiece, circle_zone
from workhold.errors import InputError, make_printable, shorten_middle
from workhold.files.budget import LIMITS, FileLimits
from workhold.files.loads_file import read_loads
from workhold.files.part.load import read_workpiece
from workhold.files.text import parse_json, parse_toml, read_at_most, read_limited, read_text
from workhold.files.toolkit_file import read_toolkit_file

HUGE = "1" + "0" * 400
MARK = b"\xef\xbb\xbf"
PLATE = '{"units": "mm", "loops": [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]]}'
VISE = 'unit = "mm"\npitch = 10\ncolumns = 2\npeg_radius = 2\n'
LOADS = "[[load]]\nforce = 1\nat = [1, 2]\n"
READERS = {
    "part.json": (read_workpiece, PLATE, "60"),
    "vise.toml": (read_toolkit_file, VISE, "10"),
    "loads.toml": (read_loads, LOADS, "2]"),
    "loads.json": (read_loads, '{"load": [{"force": 1, "at": [1, 2]}]}', "2]"),
}


@pytest.mark.parametrize("name", READERS)
def test_a_byte_order_mark_is_no_content(tmp_path: Path, name: str) -> None:
    """As Windows editors write it."""
    read, text, _ = READERS[name]
    (tmp_path / name).write_bytes(MARK + text.encode())
    read(tmp_path / name)  # type: ignore[operator]


@pytest.mark.parametrize("name", READERS)
def test_a_number_of_400_digits_is_refused(tmp_path: Path, name: str) -> None:
    """In one sentence that begins with the file's name, instead of an OverflowError."""
    read, text, number = READERS[name]
    (tmp_path / name).write_text(
        text.replace(number, HUGE + number[2:] if number[0] != "2" else HUGE + "]", 1)
    )
    with pytest.raises(InputError, match=f"{name}.* digits"):
        read(tmp_path / name)  # type: ignore[operator]


@pytest.mark.parametrize(
    "make",
    [
        lambda huge: Vise(pitch=huge, columns=2, peg_radius=1),
        lambda huge: Vise(pitch=10, columns=2, peg_radius=huge),
        lambda huge: Vise(pitch=10, columns=2, peg_radius=1, min_gap=huge),
        lambda huge: Vise(pitch=10, columns=2, peg_radius=1, max_opening=huge),
        lambda huge: Load(points=[(0, 0)], force=huge),
        lambda huge: Load(points=[(huge, 0)], force=1),
        lambda huge: Load(points=[(0, 0)], force=1, directions=(0, huge)),
        lambda huge: Load(moment=huge),
        lambda huge: Tolerance(huge, 0.01),
        lambda huge: circle_zone(0, 0, huge),
        lambda huge: circle_zone(1, 1, 1e308),
        lambda huge: Workpiece.from_loops("p", [[[0, 0, 0], [huge, 0, 0], [1, 1, 0]]]),
        lambda huge: Workpiece.from_loops("p", [[[0, 0, 0], [1, 0, 2e9], [1, 1, 0]]]),
    ],
)
def test_numbers_beyond_all_floats_are_refused_from_python(make) -> None:  # type: ignore[no-untyped-def]
    """So are lengths of which no digits would be left; without a warning of the arithmetic."""
    with pytest.raises(InputError):
        make(10**400)


def test_a_key_given_twice_is_refused(tmp_path: Path) -> None:
    """Python's reader would take the last, another program the first."""
    with pytest.raises(InputError, match='the key "units" is given twice'):
        parse_json('{"units": "mm", "units": "inch"}')
    result = tmp_path / "r.json"
    result.write_text(
        '{"format": "workhold-result/1",\n"complete": true,\n"complete": false,\n"fixtures": [\n]}'
    )
    with pytest.raises(InputError, match=r'r\.json is not a result file: the key "complete" is given twice'):
        workhold.open(result)


def test_size_is_looked_at_before_a_file_is_read(tmp_path: Path) -> None:
    """A file of holes of two million bytes."""
    path = tmp_path / "l.toml"
    with path.open("wb") as stream:
        stream.truncate(2_000_000)
    with pytest.raises(
        InputError, match=r"l\.toml is not a loads file: the file has 2 MB, more than the 1 MB"
    ):
        read_loads(path)
    with pytest.raises(InputError, match="this is not a file"):
        read_text(Path("/dev/zero"), LIMITS["toolkit"])


def test_a_file_of_just_the_size_is_read_and_one_that_grows_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a file that is longer than the system says, no more is read than shows that."""
    path, few = tmp_path / "a.txt", FileLimits("a text", 10)
    path.write_bytes(b"x" * 10)
    assert read_limited(path, few) == b"x" * 10
    path.write_bytes(b"x" * 11)
    with pytest.raises(InputError, match="more than the"):
        read_limited(path, few)
    path.write_bytes(b"x" * 2000)
    whole = Path.stat

    def stat(self: Path, **options: bool) -> os.stat_result:
        found = whole(self, **options)
        return os.stat_result((*found[:6], 4, *found[7:10])) if self == path else found

    monkeypatch.setattr(Path, "stat", stat)
    monkeypatch.setattr("workhold.files.text.BLOCK", 100)
    with pytest.raises(InputError, match="the file grows while it is read"):
        read_limited(path, few)
    assert 10 < len(read_at_most(path, 10)) <= 200
    assert len(read_at_most(path, None)) == 2000


def test_what_is_no_utf8_is_told_by_its_line(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_bytes(b"one\ntwo\nth\xffree\n")
    with pytest.raises(InputError, match=r"not UTF-8 text \(byte 10, line 3\)"):
        read_text(path, LIMITS["toolkit"])


def test_whole_numbers_end_where_floats_do() -> None:
    """With 308 digits they are read, in JSON and in TOML, wherever they stand."""
    largest, over = "9" * 308, "1" + "0" * 308
    assert parse_json(largest) == parse_toml(f"a = {largest}")["a"] == int(largest)
    for text in (
        f"a = {over}",
        f"a = -{over}",
        f"a = [1, {over}]",
        f"[a]\nb = {over}",
        f"[[a]]\nb = [[{over}]]",
    ):
        with pytest.raises(InputError, match="more than 308 digits"):
            parse_toml(text)
    with pytest.raises(InputError, match="309 digits"):
        parse_json(f"[{over}]")


def test_json_that_would_fill_the_memory_is_refused_before_it_is_read(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Lists and objects count together; a file of which more is expected may hold more."""
    monkeypatch.setattr("workhold.files.text.MOST_BRACKETS", 6)
    monkeypatch.setattr("workhold.files.text.MOST_COMMAS", 8)
    assert parse_json("[[],[],{},{}]   ") == [[], [], {}, {}]
    for text, words in (("[[],[],{},{},{},{}]", "lists and objects"), ("[1,1,1,1,1,1,1,1,1,1]", "values")):
        with pytest.raises(InputError, match=f"million {words}: save less in it"):
            parse_json(text)
        assert parse_json(text, times=2.0)


@pytest.mark.parametrize("text", ["[" * 200_000, '{"a":' * 200_000])
def test_json_that_is_nested_too_deeply_is_one_sentence(text: str) -> None:
    with pytest.raises(InputError, match="nested too deeply"):
        parse_json(text)


@pytest.mark.parametrize(
    "text", ["a = 1" + "0" * 5000, "a = [" * 5000, "a = \x00", "a = 1\na = 2", f"a = {HUGE}"]
)
def test_broken_toml_is_one_sentence(text: str) -> None:
    """Also where Python's reader raises something of its own."""
    with pytest.raises(InputError, match=r"^the file .*\.$"):
        parse_toml(text)


def test_what_is_shown_cannot_steer_a_terminal() -> None:
    """Escapes, C1 controls, line breaks and marks that turn the direction of writing; letters of any language stay."""
    assert make_printable("\x1b[2J\x9b\u202e\u2066\ud800\x7f") == "?[2J?????"
    assert make_printable("a\r\n\u2028b") == "a   b"
    assert make_printable("Flansch Ø5 – 板") == "Flansch Ø5 – 板"


def test_a_message_stays_short_whatever_it_quotes() -> None:
    """Beginning and end stay: the place and the remedy."""
    message = str(InputError("a" * 5000 + " is unknown: correct it."))
    assert len(message) == 1000 and message.startswith("aaa") and message.endswith(": correct it.")
    assert shorten_middle("short") == "short"
