"""Whatever a file holds, it is read as what it says or refused in one sentence; seeded, so that every run is the same."""

from __future__ import annotations

import json
import random
import tomllib
from collections.abc import Callable
from itertools import pairwise
from math import hypot
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from ezdxf import DXFError, recover
from ezdxf.disassemble import recursive_decompose, to_primitives
from hostile_files import MAKERS

from workhold.errors import InputError
from workhold.files.loads_file import read_loads
from workhold.files.part.load import read_workpiece
from workhold.files.result.reader import read_result
from workhold.files.toolkit.reader import read_vise_file
from workhold.kernels.base.distance import outline_distances
from workhold.model.workpiece import Workpiece

FEW, MANY = range(60), range(60, 10_060)


def check_part(path: Path) -> None:
    """The edges are those of the file's own numbers, run either way."""
    read = read_workpiece(path).workpiece
    content = json.loads(path.read_bytes().decode("utf-8-sig"))
    unit = {"mm": 1.0, "inch": 25.4}[content["units"]]
    told = [[[x * unit, y * unit, bulge] for x, y, bulge in loop] for loop in content["loops"]]
    assert [edges_of(loop.tolist()) for loop in read.loops] == [edges_of(loop) for loop in told]


def edges_of(loop: list[list[float]]) -> list[tuple[float, ...]]:
    """Every edge with its bulge, from its smaller end to its larger one; an arc nowhere 1e-7 mm off its chord is a line."""
    edges = []
    for (x, y, bulge), (to_x, to_y, _) in zip(loop, loop[1:] + loop[:1], strict=True):
        bulge *= abs(bulge) * hypot(to_x - x, to_y - y) / 2.0 >= 1e-7
        edges.append((x, y, to_x, to_y, bulge + 0.0) if (x, y) < (to_x, to_y) else (to_x, to_y, x, y, 0.0 - bulge))
    return sorted(edges)


def check_result(path: Path) -> None:
    """All fixtures of the file are there, with their holes and places."""
    read = read_result(path)
    content = json.loads(path.read_bytes().decode("utf-8-sig"))
    assert len(read) == len(content["fixtures"])
    for fixture, told in zip(read, content["fixtures"], strict=True):
        pegs = sorted((peg.jaw, peg.column, peg.row, peg.face, peg.force) for peg in fixture.pegs)
        told_pegs = [[peg[key] for key in ("jaw", "column", "row", "segment", "force")] for peg in told["pegs"]]
        assert pegs == sorted(map(tuple, told_pegs))
        assert fixture.jaw_separation == pytest.approx(told["jaw_separation"])
        assert fixture.pose.x == pytest.approx(told["pose"]["x"])


def check_vise(path: Path) -> None:
    """Every length is the file's."""
    read = read_vise_file(path).vise
    content = tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    unit = {"mm": 1.0, "inch": 25.4}[content["unit"]]
    told = content["pitch"] if isinstance(content["pitch"], list) else [content["pitch"]] * 2
    assert read.pitch == pytest.approx([unit * length for length in told])
    for key in ("peg_radius", "min_gap", "max_opening", "row_offset", "body_radius"):
        if content.get(key) is not None:
            assert getattr(read, key) == pytest.approx(unit * content[key])
    assert read.columns == content["columns"] and len(read.blocked) == len(content.get("blocked", ()))


def check_loads(path: Path) -> None:
    """As many loads as the file has, forces that are plain numbers as they stand there."""
    read = read_loads(path)
    content = tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    assert len(read) == len(content["load"])
    for load, told in zip(read, content["load"], strict=True):
        if isinstance(told.get("force", 0), int | float):
            assert load.force == told.get("force", 0)


def check_drawing(path: Path) -> None:
    """Every segment lies on what ezdxf itself makes of the drawing."""
    read = read_workpiece(path, unit="mm").workpiece
    try:
        document = ezdxf.readfile(path)
    except Exception:
        document, _ = recover.readfile(path)
    rows = []
    try:
        primitives = list(to_primitives(recursive_decompose(document.modelspace())))
    except DXFError:
        # There is nothing to compare with.
        return
    for primitive in primitives:
        if primitive.path is not None and len(primitive.path):
            points = np.array([(point.x, point.y) for point in primitive.path.flattening(1e-4)])
            rows += [line_row(start, end) for start, end in pairwise(points) if (start != end).any()]
    samples = np.array([point for segment in read.segments for point in points_of(segment)])
    # ezdxf draws arcs as Bézier curves, which are off by 2.7e-4 of the radius.
    assert outline_distances(samples, np.array(rows)).max() < 1e-3 + 4e-4 * float(np.ptp(samples, axis=0).max())


def line_row(start: Any, end: Any) -> Any:
    """A short line as a kernel's row."""
    from workhold.geometry.segment import Line, segment_rows

    return segment_rows([Line(tuple(map(float, start)), tuple(map(float, end)))])[0]


def points_of(segment: Any) -> list[tuple[float, float]]:
    """Start and middle of a segment."""
    from workhold.geometry.segment import Arc

    (x0, y0), (x1, y1) = segment.start, segment.end
    if not isinstance(segment, Arc):
        return [(x0, y0), ((x0 + x1) / 2, (y0 + y1) / 2)]
    x, y = segment.center
    return [
        (x0, y0),
        (x + segment.radius * np.cos(segment.mid_angle), y + segment.radius * np.sin(segment.mid_angle)),
    ]


CHECKS: dict[str, Callable[[Path], None]] = {
    "part.json": check_part,
    "result.json": check_result,
    "vise.toml": check_vise,
    "loads.toml": check_loads,
    "drawing.dxf": check_drawing,
}


def check(folder: Path, name: str, seeds: range) -> None:
    """Every file is read as what it says, or refused in one short sentence; some of either."""
    refused = 0
    path = folder / name
    for seed in seeds:
        path.write_bytes(MAKERS[name](random.Random(seed)))
        try:
            CHECKS[name](path)
        except InputError as error:
            message = str(error)
            assert name in message and message.isprintable() and len(message) <= 1000, seed
            refused += 1
        except Exception as error:
            raise AssertionError(f"{name} of seed {seed}: {error!r}") from error
    assert 0 < refused < len(seeds)


@pytest.mark.parametrize("name", MAKERS)
def test_hostile_files_are_read_right_or_refused(tmp_path: Path, name: str) -> None:
    """Sixty of each kind."""
    check(tmp_path, name, FEW)


@pytest.mark.prove
@pytest.mark.parametrize("name", MAKERS)
def test_ten_thousand_hostile_files_are_read_right_or_refused(tmp_path: Path, name: str) -> None:
    """As above, within two gigabytes."""
    resource = pytest.importorskip("resource")
    check(tmp_path, name, MANY)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < 2_000_000


def test_the_fuzzer_finds_a_misreading(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A part that is read a little too large is told."""
    read = read_workpiece

    def wrong(path: Path) -> Any:
        loaded = read(path)
        loops = [loop * [1.001, 1.001, 1.0] for loop in loaded.workpiece.loops]
        return type(loaded)(Workpiece.from_loops("p", loops), (), loaded.parts)

    monkeypatch.setitem(globals(), "read_workpiece", wrong)
    with pytest.raises(AssertionError, match=r"part\.json of seed"):
        check(tmp_path, "part.json", FEW)
