"""What is no file of a sensible size is refused before memory is full, and a seating is what its form says."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

from workhold.errors import InputError
from workhold.files.result import parts
from workhold.files.result.reader import read_result
from workhold.files.text import json_value
from workhold.verification.supports import is_supports_file

HOSTILE = Path(__file__).parents[2] / "data" / "hostile"
BEGIN = b'{"format": "workhold-result/1",\n"fixtures": [\n'


def test_only_regular_files_are_read(tmp_path: Path) -> None:
    """A pipe that nobody writes to would never end, a device neither."""
    pipe = tmp_path / "pipe.json"
    os.mkfifo(pipe)
    for path in (pipe, Path("/dev/zero"), tmp_path):
        with pytest.raises(InputError, match="is not a file: give a result file"):
            read_result(path)
        assert not is_supports_file(path)


def test_a_file_without_line_ends_is_not_read_whole(tmp_path: Path) -> None:
    """Twenty gigabytes of holes."""
    path = tmp_path / "r.json"
    with path.open("wb") as stream:
        stream.truncate(20 << 30)
    with pytest.raises(InputError, match="21475 MB, more than the 200 MB"):
        read_result(path)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (BEGIN + b" " * 2000, "fixture 1 takes more than the 0.001 MB"),
        (BEGIN + b"{},\n" + b" " * 2000, "fixture 2 takes more than"),
        (BEGIN + b"]\n" + b" \n" * 2000, "around the fixtures has more than the 0.003 MB"),
    ],
)
def test_lines_are_read_up_to_a_limit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, content: bytes, words: str
) -> None:
    """Those of fixtures, and all that stands around them."""
    monkeypatch.setattr(parts, "MOST_LINE", 1000)
    monkeypatch.setattr(parts, "MOST_AROUND", 3000)
    path = tmp_path / "r.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=words):
        parts.read_parts(path, lambda fixtures, _: list(fixtures))


@pytest.mark.parametrize("chunk", [1, 7, 16, 40, 1 << 20])
def test_the_first_fixture_is_found_wherever_pieces_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, chunk: int
) -> None:
    """Also after the same words within a line."""
    monkeypatch.setattr(parts, "CHUNK", chunk)
    path = tmp_path / "r.json"
    head = b'{"a": "x \\"fixtures\\": [",\n "b": "fixtures",\r\n  "fixtures": [ \r\n'
    path.write_bytes(head + b"1\n]}\n")
    with path.open("rb") as stream:
        assert parts.start_of_fixtures(stream) == len(head)
        assert stream.read() == path.read_bytes()


def test_json_of_too_many_brackets_or_values_is_refused() -> None:
    """Each takes fifty bytes and more of memory for two of the file."""
    for text in ("[" + "[]," * 10_000_000 + "[]]", "[" + "1," * 30_000_001 + "1]"):
        with pytest.raises(InputError, match=r"the file holds more than \d0 million"):
            json_value(text)


def seated(change: Any) -> dict[str, Any]:
    """A result of which a seat of the first fixture is changed."""
    content: dict[str, Any] = json.loads((HOSTILE / "result_seating.json").read_text())
    change(content["fixtures"][0]["seating"]["seats"][7])
    return content


@pytest.mark.parametrize(
    "change",
    [
        lambda seat: None,
        lambda seat: seat.update(depth=None, more=1),
        lambda seat: seat["pose"].update(more=1),
        lambda seat: [one.update({"corner" if "face" in one else "face": None}) for one in seat["contacts"]],
    ],
)
def test_a_seat_may_lack_what_its_form_lets_be_left_out(tmp_path: Path, change: Any) -> None:
    """A depth, or one of face and corner as null; further keys are read past."""
    path = tmp_path / "r.json"
    path.write_text(json.dumps(seated(change)))
    seat = read_result(path)[0].seating.seats[7]
    assert seat.depth is None
    assert [one.corner for one in seat.contacts] == [
        one.get("corner") is not None
        for one in seated(change)["fixtures"][0]["seating"]["seats"][7]["contacts"]
    ]
