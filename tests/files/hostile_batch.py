"""Seeded hostile files, each read and held against what its own numbers say, in a process with limits of time and memory.

``python hostile_batch.py part.json 0 60`` tries some; it ends with 0, or tells the seed of the file that fails.
"""

from __future__ import annotations

import faulthandler
import json
import os
import random
import signal
import sys
import tempfile
import tomllib
import warnings
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout, suppress
from io import StringIO
from itertools import pairwise
from math import hypot
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import ezdxf
import numpy as np
from ezdxf import DXFError, recover
from ezdxf.disassemble import recursive_decompose, to_primitives
from ezdxf.entities import LWPolyline
from fuzzed import ALL_MAKERS
from pytest import approx, raises

from workhold.archive import map_archive
from workhold.benchmark.matching import read_entry
from workhold.cli.jobs import read_jobs
from workhold.cli.main import app
from workhold.errors import InputError
from workhold.files.apart import limit_memory, limit_processor
from workhold.files.loads_file import read_loads
from workhold.files.part.load import read_workpiece
from workhold.files.program.reader import read_program
from workhold.files.program.tool_tables import read_tools
from workhold.files.result.parts import HEAD, describe_columns_from_head
from workhold.files.result.reader import read_result
from workhold.files.supports_file import read_supports
from workhold.files.toolkit_file import read_toolkit_file
from workhold.kernels.base.distance import measure_outline_distances
from workhold.units import MILLIMETRE

__all__ = ["check_one", "run_batch"]

# Processor seconds for one file, wall seconds, and bytes of address space beyond what the libraries take.
SECONDS, WALL_SECONDS, MEMORY = 20, 200, 1 << 30
# Sizes of the part: what lies further from the origin is not of the part.
FAR = 1e6
# Columns that are held against what NumPy reads.
COMPARED = ("theta", "position", "jaw_separation", "column", "row", "face", "force")


def check_part(path: Path) -> None:
    """The edges are those of the file's own numbers, run either way."""
    read = read_workpiece(path).workpiece
    content = json.loads(path.read_bytes().decode("utf-8-sig"))
    unit = {"mm": 1.0, "inch": 25.4}[content["units"]]
    told = [[[x * unit, y * unit, bulge] for x, y, bulge in loop] for loop in content["loops"]]
    assert [edges_of(loop.tolist()) for loop in read.loops] == [edges_of(loop) for loop in told]


def edges_of(loop: list[list[float]]) -> list[tuple[float, ...]]:
    """Every edge with its bulge, from its smaller end to its larger one; too flat an arc is a line."""
    edges = []
    for (x, y, bulge), (to_x, to_y, _) in zip(loop, loop[1:] + loop[:1], strict=True):
        bulge *= abs(bulge) >= max(2e-6, 2e-6 / hypot(to_x - x, to_y - y))
        edges.append(
            (x, y, to_x, to_y, bulge + 0.0) if (x, y) < (to_x, to_y) else (to_x, to_y, x, y, 0.0 - bulge)
        )
    return sorted(edges)


def check_result(path: Path) -> None:
    """All fixtures of the file are there, with their holes and places."""
    read = read_result(path)
    content = json.loads(path.read_bytes().decode("utf-8-sig"))
    assert len(read) == len(content["fixtures"])
    for fixture, told in zip(read, content["fixtures"], strict=True):
        pegs = sorted((peg.carrier, peg.column, peg.row, peg.face, peg.force) for peg in fixture.pegs)
        told_pegs = [
            [peg[key] for key in ("jaw", "column", "row", "segment", "force")] for peg in told["pegs"]
        ]
        assert pegs == sorted(map(tuple, told_pegs))
        assert fixture.travel == approx(told["jaw_separation"])
        assert fixture.pose.x == approx(told["pose"]["x"])


def check_columns(path: Path) -> None:
    """All fixtures of the file are there, with the holes and places that NumPy reads, and as the other form gives them."""
    read = list(read_result(path))
    with np.load(path, allow_pickle=False) as archive:
        try:
            told = {name: archive[name] for name in COMPARED}
        except (BadZipFile, NotImplementedError) as error:
            # Checksums are compared by what verifies a file, and names told twice only once.
            if "CRC" in str(error):
                with raises(InputError):
                    map_archive(path, describe_columns_from_head, HEAD, whole=True)
            return
        assert len(read) == len(told["theta"])
        for k, fixture in enumerate(read):
            assert fixture.pose.theta_deg % 360 == approx(np.degrees(told["theta"][k]) % 360)
            assert [fixture.pose.x, fixture.pose.y, fixture.travel] == approx(
                [*told["position"][k], told["jaw_separation"][k]]
            )
            holes = zip(*(told[name][k].tolist() for name in ("column", "row", "face", "force")), strict=True)
            assert sorted((peg.column, peg.row, peg.face, peg.force) for peg in fixture.pegs) == sorted(holes)


def check_vise(path: Path) -> None:
    """Every length is the file's."""
    read = read_toolkit_file(path).toolkit
    content = tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    unit = {"mm": 1.0, "inch": 25.4}[content["unit"]]
    told = content["pitch"] if isinstance(content["pitch"], list) else [content["pitch"]] * 2
    assert read.pitch == approx([unit * length for length in told])
    for key in ("peg_radius", "min_gap", "max_opening", "row_offset", "body_radius"):
        if content.get(key) is not None:
            assert getattr(read, key) == approx(unit * content[key])
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
    if any(entity.has_width for entity in document.query("LWPOLYLINE") if isinstance(entity, LWPolyline)):
        # What it makes of a polyline with a width is the outline of a stroke.
        return
    rows = []
    try:
        primitives = list(to_primitives(recursive_decompose(document.modelspace())))
    except (DXFError, ValueError):
        # It stumbles itself, over bulges for one: there is nothing to compare with.
        return
    samples = np.array([point for segment in read.segments for point in points_of(segment)])
    size = float(np.ptp(samples, axis=0).max())
    for primitive in primitives:
        if primitive.path is not None and len(primitive.path):
            if max(abs(point.x) + abs(point.y) for point in primitive.path.control_vertices()) > FAR * size:
                # It makes whole ellipses of nearly straight bulges in a block with two scales.
                return
            points = np.array([(point.x, point.y) for point in primitive.path.flattening(1e-4)])
            if not np.isfinite(points).all():
                # A height that is not a number makes places of the plan that are none.
                return
            rows += [line_row(start, end) for start, end in pairwise(points) if (start != end).any()]
    # ezdxf draws arcs as Bézier curves, which are off by 2.7e-4 of the radius.
    assert measure_outline_distances(samples, np.array(rows)).max() < 1e-3 + 4e-4 * size


def line_row(start: Any, end: Any) -> Any:
    """A short line as a kernel's row."""
    from workhold.geometry.segment import Line, make_segment_rows

    return make_segment_rows([Line(tuple(map(float, start)), tuple(map(float, end)))])[0]


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
    "result.npz": check_columns,
}


def check_fixtures(path: Path) -> None:
    """Every fixture of a result is there to be looked at."""
    read = read_result(path)
    assert len(list(read)) == len(read) == sum(read.counts.values())


# Of these only that they are read, or refused, is held against what the file says.
READERS: dict[str, Callable[[Path], Any]] = {
    "toolkit.toml": read_toolkit_file,
    **dict.fromkeys(("tools.csv", "tools.toml", "tools.tbl"), lambda path: read_tools(path, MILLIMETRE)),
    **dict.fromkeys(("jobs.csv", "jobs.toml"), read_jobs),
    **dict.fromkeys(("list.csv", "list.json"), read_entry),
    **dict.fromkeys(("lines.json", "whole.json"), check_fixtures),
    "supports.json": read_supports,
    "program.nc": lambda path: read_program(path, thickness=20.0, z_zero="top"),
    "part.step": read_workpiece,
    **dict.fromkeys(("made.svg", "made.dxf", "made.json"), read_workpiece),
}
CHECKS |= READERS

# What is done on the command line with a file that is read: with every tenth, for it takes longer than the reading.
EVERY = 10
RESULT_COMMANDS = (
    ("show", "{file}", "1", "--draw", "{picture}", "--force"),
    ("verify", "{file}"),
    ("convert", "{file}", "{other}", "--force"),
)
COMMANDS: dict[str, tuple[tuple[str, ...], ...]] = {
    "part.json": (("features", "{file}", "--peg-radius", "2", "--draw", "{picture}", "--force"),),
    "drawing.dxf": (("features", "{file}", "--peg-radius", "2", "--drawing-unit", "mm"),),
    "result.json": RESULT_COMMANDS,
    "result.npz": RESULT_COMMANDS,
    **dict.fromkeys(
        ("lines.json", "whole.json"),
        (
            *RESULT_COMMANDS,
            ("sheet", "{file}", "1", "-o", "{picture}", "--force"),
            ("seat", "{file}", "1"),
        ),
    ),
    "supports.json": (("verify", "{file}"),),
    "program.nc": (("program", "{file}", "--thickness", "20"),),
}


def check_one(path: Path, with_commands: bool) -> bool:
    """Whether a file is read, and then as what it says; otherwise it is refused in one short sentence."""
    try:
        CHECKS[path.name](path)
    except InputError as error:
        message = str(error)
        assert path.name in message and message.isprintable() and len(message) <= 1000, message
        return False
    for words in COMMANDS.get(path.name, ()) if with_commands else ():
        told = StringIO()
        picture, other = (str(path.with_name(name)) for name in ("picture.svg", "other.json"))
        with redirect_stdout(told), redirect_stderr(told):
            code = app(
                [word.format(file=path, picture=picture, other=other) for word in words],
                standalone_mode=False,
            )
        assert code in (0, 2), f"{words[0]} ends with {code}: {told.getvalue()}"
    return True


def address_space() -> int:
    """Bytes of address space that this process has, where the system tells."""
    try:
        return int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return 4 << 30


def warm_up(name: str, path: Path) -> None:
    """Read some files without limits: what is loaded and compiled once does not count."""
    for seed in range(20):
        path.write_bytes(ALL_MAKERS[name](random.Random(seed)))
        with suppress(Exception):
            check_one(path, with_commands=True)


def run_batch(name: str, first: int, last: int) -> None:
    """Try the files of some seeds, each told on standard output before it is tried, so that the last one is known where the
    process ends: when a file takes too long, or brings the interpreter down.

    Raises
    ------
    AssertionError
        With the seeds that failed and why.
    """
    # A warning would reach the terminal.
    warnings.simplefilter("error", RuntimeWarning)
    if hasattr(signal, "SIGXCPU"):
        faulthandler.register(signal.SIGXCPU, chain=True)
    read, failures = 0, []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        warm_up(name, path)
        limit_memory(address_space() + MEMORY)
        for seed in range(first, last):
            path.write_bytes(ALL_MAKERS[name](random.Random(seed)))
            sys.stdout.write(f"{name} of seed {seed}\n")
            sys.stdout.flush()
            limit_processor(SECONDS)
            faulthandler.dump_traceback_later(WALL_SECONDS, exit=True)
            try:
                read += check_one(path, with_commands=seed % EVERY == 0)
            except Exception as error:
                failures.append(f"seed {seed}: {error!r}")
            faulthandler.cancel_dump_traceback_later()
    assert not failures, "\n".join(failures)
    # The files are neither harmless nor so bad that nothing of the reader is tried.
    assert 0 < read < last - first, read


if __name__ == "__main__":
    run_batch(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
