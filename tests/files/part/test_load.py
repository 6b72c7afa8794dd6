"""Finding a part, telling files apart, and JSON workpieces."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest
from reading_helpers import RECTANGLE, area

from workhold import load
from workhold.errors import InputError
from workhold.files.part.load import list_builtin_parts, read_workpiece

PLATE: dict[str, Any] = {"name": "plate", "units": "mm", "loops": [[[x, y, 0] for x, y in RECTANGLE]]}


def write(tmp_path: Path, content: Any, name: str = "part.json") -> Path:
    path = tmp_path / name
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


@pytest.mark.parametrize("name", [part.name for part in list_builtin_parts()])
def test_every_builtin_part_loads_by_name_in_any_capitals(name: str) -> None:
    """Seven models of the paper's parts; each has an area and keeps its name."""
    part = load(name.upper())
    assert part.name == name
    assert area(part) > 500
    assert len(part.loops) == 1


def test_a_file_wins_over_a_builtin_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file called ``widget`` is read instead of the model ``widget``."""
    write(tmp_path, PLATE, "widget")
    monkeypatch.chdir(tmp_path)
    assert load("widget").name == "plate"


def test_an_unknown_name_lists_close_ones() -> None:
    """A mistyped name is answered with the name that was meant; a hopeless one with all."""
    with pytest.raises(InputError, match=r"file not found.*try widget\)"):
        load("widgit")
    with pytest.raises(InputError, match=r"file not found.*8Handle.*widget"):
        load("no/such.dxf")
    with pytest.raises(InputError, match="file not found"):
        load("a" * 5000)
    with pytest.raises(InputError, match="file not found"):
        load("nul\0byte")


def test_json_gives_the_loops_it_holds(tmp_path: Path) -> None:
    """A 60 x 40 mm plate has an area of 2400 mm²; inches count 25.4 mm each."""
    assert area(load(write(tmp_path, PLATE))) == pytest.approx(2400)
    assert area(load(write(tmp_path, {**PLATE, "units": "inch"}))) == pytest.approx(2400 * 25.4**2)


def test_json_loops_may_run_in_either_direction(tmp_path: Path) -> None:
    """A clockwise outer loop and a counter-clockwise hole are turned; a circle's area is pi r²."""
    loops = [[[x, y, 0] for x, y in reversed(RECTANGLE)], [[35, 20, 1], [25, 20, 1]]]
    part = load(write(tmp_path, {**PLATE, "loops": loops}))
    assert area(part) == pytest.approx(2400 - np.pi * 25)


def test_a_result_file_gives_its_workpiece(tmp_path: Path) -> None:
    """The ``workpiece`` of a result file is a workpiece file."""
    result = {"format": "workhold-result/1", "workpiece": PLATE, "fixtures": []}
    assert load(write(tmp_path, result)).name == "plate"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "empty"),
        ("   \n", "empty"),
        ("{", "not valid JSON.*line 1"),
        ('{"a": 1,}', "not valid JSON"),
        ("[1, 2]", "holds no workpiece"),
        ("3", "holds no workpiece"),
        ("[" * 200_000, "nested too deeply|not valid JSON"),
        ("1" * 5000, "5000 digits"),
        ('{"format": "workhold-result/1"}', "holds no workpiece"),
        ({"loops": PLATE["loops"]}, 'no units.*"units": "mm"'),
        ({**PLATE, "units": "furlong"}, 'units "furlong" are not known'),
        ({**PLATE, "units": 3}, "no units"),
        ({**PLATE, "loops": []}, "no loops"),
        ({**PLATE, "name": 7}, '"name" must be text'),
        ({"units": "mm"}, "no loops"),
        ({**PLATE, "loops": [3]}, "Loop 0 must be a list"),
        ({**PLATE, "loops": [[]]}, "too few segments"),
        ({**PLATE, "loops": [[[0, 0], [1, 0], [0, 1]]]}, r"Loop 0, vertex 0 must be three numbers"),
        ({**PLATE, "loops": [[[0, 0, 0, 0]]]}, r"Loop 0, vertex 0 must be three numbers"),
        ({**PLATE, "loops": [[[0, 0, 0], [1, "2", 0], [0, 1, 0]]]}, r"Loop 0, vertex 1 has a y that is not"),
        ({**PLATE, "loops": [[[0, 0, 0], [1, True, 0], [0, 1, 0]]]}, r"Loop 0, vertex 1 has a y that is not"),
        (
            {**PLATE, "loops": [[[0, 0, None], [1, 1, 0], [0, 1, 0]]]},
            r"Loop 0, vertex 0 has a bulge that is not",
        ),
        ('{"units": "mm", "loops": [[[0, 0, NaN]]]}', "NaN is not a number"),
        ('{"units": "mm", "loops": [[[0, -Infinity, 0]]]}', "-Infinity is not a number"),
        (
            '{"units": "mm", "loops": [[[0, 1e999, 0], [1, 0, 0], [0, 1, 0]]]}',
            "vertex 0 has a y that is not a finite",
        ),
        (
            '{"units": "mm", "loops": [[[0, 1e200, 0], [1, 0, 0], [0, 1, 0]]]}',
            "has a coordinate beyond 1e.06 mm",
        ),
        (
            {**PLATE, "loops": [[[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 1, 0]]]},
            "loop 0, segment 1 has zero length",
        ),
        ({**PLATE, "loops": [[[0, 0, 0], [2, 2, 0], [2, 0, 0], [0, 2, 0]]]}, "cross or touch at"),
    ],
)
def test_wrong_json_is_one_plain_sentence(tmp_path: Path, content: Any, words: str) -> None:
    """Whatever a JSON file holds, the answer names the file and the place, on one line."""
    with pytest.raises(InputError, match=words) as caught:
        load(write(tmp_path, content))
    message = str(caught.value)
    assert message.startswith("part.json: ")
    assert "\n" not in message


def test_choices_that_do_not_apply_are_refused(tmp_path: Path) -> None:
    """JSON has no layers, its own units and one part."""
    path = write(tmp_path, PLATE)
    with pytest.raises(InputError, match="DXF files only"):
        load(path, layers=["A"])
    with pytest.raises(InputError, match='its own "units"'):
        load(path, unit="mm")
    with pytest.raises(InputError, match="only one part"):
        load(path, part_number=2)
    with pytest.raises(InputError, match="Unit 'ell' is not known"):
        load(path, unit="ell")
    for tolerance in (-1.0, float("nan"), float("inf")):
        with pytest.raises(InputError, match="join tolerance"):
            load(path, join_tolerance=tolerance)
    assert len(read_workpiece(path, part_number=1).parts) == 1


def test_folders_and_unreadable_files_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder and a file without permission each get a sentence."""
    with pytest.raises(InputError, match="this is a folder"):
        load(tmp_path)
    path = write(tmp_path, PLATE)

    def refuse(*_: object) -> NoReturn:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(InputError, match=r"part\.json: the file cannot be read \(permission denied\)"):
        load(path)


@pytest.mark.parametrize("name", ["part.dxf", "part.svg", "part.json", "part.bin", "part"])
def test_random_bytes_are_refused_politely(tmp_path: Path, name: str) -> None:
    """Noise under any ending is an input error."""
    noise = np.random.default_rng(7).bytes(5000)
    (tmp_path / name).write_bytes(noise)
    with pytest.raises(InputError, match=name.replace(".", r"\.")):
        load(tmp_path / name)


def test_files_without_an_ending_are_told_apart_by_their_bytes(tmp_path: Path) -> None:
    """The first bytes tell JSON and SVG."""
    assert load(write(tmp_path, PLATE, "plate")).name == "plate"
    svg = '<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg"><rect width="3" height="4"/></svg>'
    assert area(load(write(tmp_path, svg, "drawing"), unit="mm")) == pytest.approx(12)
    with pytest.raises(InputError, match="neither a JSON, a DXF, an SVG nor a STEP"):
        load(write(tmp_path, "solid part", "part.stl"))


@pytest.mark.thorough
def test_loading_json_imports_no_drawing_library() -> None:
    """A JSON part loads without ezdxf and svgelements, whose imports are slow."""
    code = (
        "import sys; from workhold import load; load('widget'); "
        "print([m for m in ('ezdxf', 'svgelements') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_drawing_of_fifty_megabytes_is_refused_unread(tmp_path: Path) -> None:
    """A file too large to be a drawing of one part is refused by its size, at once."""
    path = tmp_path / "huge.dxf"
    with path.open("wb") as stream:
        stream.write(b"  0\nSECTION\n")
        stream.truncate(50_000_000)
    with pytest.raises(
        InputError, match=r"huge\.dxf: the file is larger than 40 MB: save a drawing of the part"
    ):
        read_workpiece(path, unit="mm")
