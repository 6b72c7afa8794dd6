"""What is not a file of a sensible size is refused before memory is full, and a seating is what its form says."""

from __future__ import annotations

import io
import json
import os
import resource
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from workhold.errors import InputError
from workhold.files.budget import FileLimits
from workhold.files.result import parts
from workhold.files.result.reader import read_result
from workhold.files.text import parse_json, read_limited

HOSTILE = Path(__file__).parents[2] / "data" / "hostile"
BEGIN = b'{"format": "workhold-result/1",\n"fixtures": [\n'


READ_ALL = """
import sys
from pathlib import Path
from workhold.batch.durations import TaskDurations
from workhold.batch.store import FolderStore
from workhold.benchmark.matching import read_entry
from workhold.cli.jobs import read_jobs
from workhold.errors import InputError
from workhold.files.loads_file import read_loads
from workhold.files.part.load import read_workpiece
from workhold.files.program.reader import read_program
from workhold.files.program.tool_tables import read_tools
from workhold.files.result.reader import read_result
from workhold.files.supports_file import read_supports
from workhold.files.toolkit_file import read_toolkit_file
from workhold.units import MILLIMETRE
from workhold.verification.supports import is_supports_file

readers = (
    read_result, read_supports, read_loads, read_jobs, read_entry, read_toolkit_file, read_workpiece,
    lambda path: read_tools(path, MILLIMETRE), lambda path: read_program(path, thickness=20.0, z_zero="top"),
)
for name in sys.argv[1:]:
    for read in readers:
        try:
            read(Path(name))
        except InputError as error:
            assert "regular file" in str(error) or "not a file" in str(error), str(error)
        else:
            raise AssertionError(f"{read} reads {name}")
    assert not is_supports_file(Path(name)) and not TaskDurations(Path(name)).known
folder = Path(sys.argv[1]).parent
(folder / "ab").mkdir()
Path(sys.argv[1]).rename(folder / "ab" / "abc.json")
assert FolderStore(folder).read("abc") is None
"""


@pytest.mark.thorough
def test_only_regular_files_are_read(tmp_path: Path) -> None:
    """A pipe that nobody writes to would never end, a device neither; a process of its own can be ended."""
    pipe = tmp_path / "pipe.json"
    os.mkfifo(pipe)
    done = subprocess.run(
        [sys.executable, "-c", READ_ALL, str(pipe), "/dev/zero"],
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30)),
    )
    assert done.returncode == 0, done.stderr[-2000:]


def test_a_file_without_line_ends_is_not_read_whole(tmp_path: Path) -> None:
    """Twenty gigabytes of holes."""
    path = tmp_path / "r.json"
    with path.open("wb") as stream:
        stream.truncate(20 << 30)
    with pytest.raises(InputError, match="21475 MB, more than the 50 MB"):
        read_result(path)


class CountingStream(io.BytesIO):
    """A file that keeps the largest number of bytes that was asked for at once; all of them for no number."""

    most = 0

    def read(self, size: int | None = -1) -> bytes:
        self.most = max(self.most, 1 << 60 if size is None or size < 0 else size)
        return super().read(size)

    def readline(self, size: int | None = -1) -> bytes:
        self.most = max(self.most, 1 << 60 if size is None or size < 0 else size)
        return super().readline(size)

    def __next__(self) -> bytes:
        return self.readline()


@pytest.mark.parametrize("content", [BEGIN + b"{}\n]}\n", BEGIN + b"{},\n" + b" " * 5000])
def test_no_line_is_asked_for_without_a_bound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, content: bytes
) -> None:
    """As many bytes as are asked for are set aside."""
    stream = CountingStream(content)
    monkeypatch.setattr(parts, "MOST_LINE", 1000)
    monkeypatch.setattr(parts, "MOST_AROUND", 3000)
    monkeypatch.setattr(Path, "open", lambda *_: stream)
    with suppress(InputError):
        parts.read_lines(tmp_path / "r.json", lambda fixtures, _: list(fixtures))
    assert 0 < stream.most <= parts.CHUNK


def test_no_more_is_asked_for_than_a_file_has(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """However much one may have; what it grows by is read in pieces, up to the limit."""
    path, limits = tmp_path / "r.json", FileLimits("a file", 5_000_000)
    path.write_bytes(b"12345")
    for more, length in ((0, 5), (3_000_000, 3_000_005)):
        stream = CountingStream(b"12345" + bytes(more))
        monkeypatch.setattr(Path, "open", lambda *_, stream=stream: stream)
        assert len(read_limited(path, limits)) == length
        assert stream.most <= 1 << 20
    monkeypatch.setattr(Path, "open", lambda *_: CountingStream(bytes(50_000_000)))
    with pytest.raises(InputError, match="the file grows while it is read"):
        read_limited(path, limits)


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


@pytest.mark.thorough
def test_json_of_too_many_brackets_or_values_is_refused() -> None:
    """Each takes fifty bytes and more of memory for two of the file."""
    for text in ("[" + "[]," * 1_000_000 + "[]]", "[" + "1," * 2_000_001 + "1]"):
        with pytest.raises(InputError, match=r"the file holds more than [12] million"):
            parse_json(text)
        parse_json(text, times=2.0)


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
