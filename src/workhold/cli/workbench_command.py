"""The command ``workbench``: answers FreeCAD's workbench in one process that reads the part once.

The workbench writes ``order.json`` into a folder, and finds there the result of the search and the pictures
drawn. The answer is one JSON object on standard output. Bodies are passed as prisms, since FreeCAD can model
them itself. So the library for STEP files is needed only to read the part.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from threading import Event, Thread
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import evolve, field, frozen

from workhold.cli.commands import make_default_group, print_remark
from workhold.cli.design_report import NEAREST_MISS, THUMBNAILS
from workhold.cli.options import read_result_with_rank
from workhold.cli.outputs import print_json, write_output
from workhold.cli.program_options import ProgramOptions
from workhold.cli.search_options import QueryOptions
from workhold.cli.toolkit_options import ToolkitOptions
from workhold.errors import InputError
from workhold.geometry.segment import Line, Segment
from workhold.units import MILLIMETRE

if TYPE_CHECKING:
    from workhold.model.bodies import FixtureBody
    from workhold.model.fixture import Fixture
    from workhold.model.query import Query
    from workhold.model.result import Result
    from workhold.model.support_triples import ChosenSupports
    from workhold.model.workpiece import Workpiece

__all__ = ["workbench"]

ORDER, RESULT, LONGER, CHOSEN = "order.json", "result.json", "longer.json", "chosen"
# What the questions of a part's reader are called in the panel; what it has not is named by what it is.
CALLED = {
    "axis": "the axis that points up",
    "peg_height": "the peg height",
    "section": "a section",
    "head_room": "the head room",
    "least_band": "the least height of a face",
    "part_number": "another body",
    "heights": "the toolkit's own heights",
}
# How far down the list a fixture that was chosen before is looked for, and how many choices are drawn.
MOST_SEARCHED, MOST_DRAWN = 5000, 12
# Of pictures in pixels: as many as a panel shows of a sheet of thumbnails, and a window of a whole page.
ACROSS_SHEET, ACROSS_PAGE = 1200, 1600
# In degrees: a part that lies turned by more than this in the same holes is another fixture.
MOST_TURNED = 45.0


@frozen(kw_only=True)
class WorkbenchOrder:
    """An order of FreeCAD's workbench.

    Parameters
    ----------
    part : path of the part's STEP file for a design; None to show another fixture of the result in the
        folder.
    name : name of the part in the document.
    axis, peg_height, toolkit, best : options of ``design``; lengths are in mm.
    avoid, only : faces of the document by name, each with its place in the STEP file.
    program, tools, z_zero : options of ``design``.
    supports : whether three supports and a clamp on top are put in.
    pictures : whether pictures of the first choices and of the chosen fixture are drawn.
    marks : JSON that identifies the fixture chosen before, see :func:`find_rank_in_file`; empty for none.
    chosen : rank of the fixture whose bodies are returned.
    """

    part: str | None = None
    name: str = ""
    axis: str = "z"
    peg_height: float | None = None
    toolkit: str = ""
    best: int = 20
    avoid: Mapping[str, int] = field(factory=dict)
    only: Mapping[str, int] = field(factory=dict)
    program: str | None = None
    tools: str | None = None
    z_zero: float = 0.0
    supports: bool = False
    pictures: bool = False
    marks: str = ""
    chosen: int = 1

    @classmethod
    def read(cls, folder: Path) -> WorkbenchOrder:
        """Return the order in ``order.json`` of a folder.

        Raises
        ------
        InputError
            Where there is no order, or one of another version.
        """
        path = folder / ORDER
        try:
            return cls(**json.loads(path.read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError) as error:
            raise InputError(
                f"{path} is not an order of this version's workbench: install the add-on that came with workhold."
            ) from error


def workbench(
    folder: Annotated[
        str,
        typer.Argument(metavar="FOLDER", help="The folder with order.json, where the answer goes as well."),
    ],
) -> None:
    """Answer FreeCAD's workbench: design, and give the bodies and pictures of the chosen fixture.

    Example: workhold workbench /tmp/order
    """
    place = Path(folder)
    order = WorkbenchOrder.read(place)
    if order.part is None:
        if order.chosen < 1:
            raise InputError(f"there is no fixture {order.chosen} in the list: design first.")
        print_json(
            **describe_placed_fixture(
                read_result_with_rank(place / RESULT, order.chosen), order.chosen, order, place
            )
        )
        return
    cancel = Event()
    Thread(target=watch_for_cancel, args=(cancel,), daemon=True).start()
    query = make_query(order, order.part)
    from workhold.search.design import answer

    result = answer(query, cancel=cancel)
    write_output(result, str(place / RESULT), "json")
    print_json(**make_design_data(result, order, place, cancel))


def watch_for_cancel(cancel: Event) -> None:
    """Set the event when a byte arrives on stdin or stdin is closed.

    Runs in a thread, so that the search can end and its result be kept.
    """
    # Not through Python's own buffer, whose lock would outlive the end of the process.
    os.read(sys.stdin.fileno(), 1)
    cancel.set()


def make_query(order: WorkbenchOrder, part: str) -> Query:
    """Return the query of an order, with the part read.

    Options mean the same as in ``design``, so that both list the same fixtures.
    """
    from workhold.files.part.load import read_workpiece
    from workhold.model.query import Query

    toolkit, tolerance = make_default_group(ToolkitOptions, toolkit=order.toolkit).read_toolkit(MILLIMETRE)
    try:
        loaded = read_workpiece(
            part, axis=order.axis, peg_height=order.peg_height, heights=toolkit.heights, called=CALLED
        )
    except InputError as error:
        raise InputError(str(error).replace(Path(part).name, order.name)) from error
    for remark in loaded.remarks:
        print_remark(remark)
    workpiece = loaded.workpiece
    avoid = list_avoided_segments(order, workpiece)
    named: dict[str, Any] = {"program": order.program, "tools": order.tools or None}
    machined = make_default_group(
        ProgramOptions, **(named | {"z_zero": f"{order.z_zero:.6f}mm"} if order.program else {})
    )
    peg_height = None if order.peg_height is None else f"{order.peg_height}mm"
    words = make_default_group(QueryOptions, avoid=[",".join(map(str, avoid))] if avoid else None)
    wishes = words.read_arguments(MILLIMETRE, machined.program is not None, machined.has_forces)
    wishes |= machined.read_query_arguments(MILLIMETRE, peg_height, workpiece)
    wishes["tolerance"] = tolerance
    return Query(workpiece, toolkit, best=order.best, **wishes)


def list_avoided_segments(order: WorkbenchOrder, workpiece: Workpiece) -> list[int]:
    """Return the numbers, ascending, of the outline's faces that no peg may touch because the order names
    their faces.

    Raises InputError for a named face that pegs cannot touch anyway, and for an outline without face numbers
    of a solid.
    """
    if not (order.avoid or order.only):
        return []
    numbered = workpiece.numbered
    if not numbered.over:
        raise InputError(
            "the outline of this part has no faces of its solid: choose another axis or peg height."
        )

    def list_segments_under(named: Mapping[str, int]) -> set[int]:
        """Return the numbers of the outline's faces that lie under the named faces of the solid."""
        numbers = set[int]()
        for name, place in named.items():
            segments = set(numbered.list_segments_under({place}))
            if not segments:
                raise InputError(f"{name} is not upright where pegs reach, so nothing touches it anyway.")
            numbers.update(face.number for face in numbered.faces if not segments.isdisjoint(face.segments))
        return numbers

    avoid = list_segments_under(order.avoid)
    if order.only:
        avoid |= {face.number for face in numbered.faces} - list_segments_under(order.only)
    return sorted(avoid)


def make_design_data(result: Result, order: WorkbenchOrder, folder: Path, cancel: Event) -> dict[str, Any]:
    """Return notes, first choices and the chosen fixture of a search as plain data; write pictures if wanted.

    The chosen fixture is the one with the order's marks, else the first.
    """
    from workhold.listing.identity import make_entries

    shown = make_entries(result)
    first = zip(shown.index[:MOST_DRAWN].tolist(), shown.like[:MOST_DRAWN].tolist(), strict=True)
    data: dict[str, Any] = {
        "complete": bool(result.complete),
        "notes": list(map(str, result.notes)),
        "first": [{"rank": index + 1, "like": like} for index, like in first],
        "lower": None,
    }
    if not len(result):
        if result.complete and order.pictures:
            draw_nearest_miss(result, folder)
        return data
    rank = find_rank_in_file(read_listed_fixtures(folder), order.marks)
    if rank is None and order.marks and result.complete:
        from workhold.search.design import answer

        longer = answer(evolve(result.query, best=MOST_SEARCHED), cancel=cancel)
        write_output(longer, str(folder / LONGER), "json")
        data["lower"] = find_rank_in_file(read_listed_fixtures(folder, LONGER), order.marks)
    if order.pictures:
        from workhold.drawing.fixture_pictures import draw_best_thumbnails

        svg = draw_best_thumbnails(result, shown)
        (folder / f"{THUMBNAILS}.svg").write_text(svg, encoding="utf-8")
        write_png(svg, folder / f"{THUMBNAILS}.png", ACROSS_SHEET)
    return data | {"found": rank is not None} | describe_placed_fixture(result, rank or 1, order, folder)


def read_listed_fixtures(folder: Path, name: str = RESULT) -> list[dict[str, Any]]:
    """Return the entries of the fixtures in a result file of the folder."""
    fixtures: list[dict[str, Any]] = json.loads((folder / name).read_text(encoding="utf-8"))["fixtures"]
    return fixtures


def find_rank_in_file(fixtures: Sequence[Mapping[str, Any]], marks: str) -> int | None:
    """Return the rank, from 1, of the fixture with these marks among a result file's entries; None without
    one.

    Marks are JSON made by :func:`identify_fixture`. Where several fixtures use the same holes, the one whose
    part's angle is nearest is returned, if it is at most :data:`MOST_TURNED` degrees off.
    """
    if not marks:
        return None
    holes, angle = json.loads(marks)
    turned = {
        rank: abs((one["pose"]["theta_deg"] - angle + 180.0) % 360.0 - 180.0)
        for rank, one in enumerate(fixtures, 1)
        if json.loads(identify_fixture(one))[0] == holes
    }
    nearest = min(turned, key=turned.__getitem__, default=None)
    return nearest if nearest is not None and turned[nearest] <= MOST_TURNED else None


def identify_fixture(fixture: Mapping[str, Any]) -> str:
    """Return the marks of a fixture's entry as JSON:
    its type, directions and holes, and the angle of the part in degrees.
    """
    pegs = [[peg.get("jaw"), peg.get("column"), peg.get("row")] for peg in fixture["pegs"]]
    directions = fixture.get("directions", fixture.get("direction"))
    return json.dumps([[fixture["type"], directions, pegs], fixture["pose"]["theta_deg"]])


def describe_placed_fixture(result: Result, rank: int, order: WorkbenchOrder, folder: Path) -> dict[str, Any]:
    """Return the bodies (without the part), pose, holes and marks of the fixture of a rank, as plain data.

    Its picture is written if the order asks for it.
    """
    from workhold.presenting.assembly import Assembly

    fixture = result[rank - 1]
    note, chosen = "", None
    if order.supports:
        chosen, note = find_supports_under(fixture, result.query)
    assembly = Assembly.from_fixture(fixture, result, {}, chosen)
    if order.pictures:
        from workhold.drawing.fixture_pictures import draw_fixture
        from workhold.drawing.path_drawn import make_planned_path

        path = make_planned_path(result, rank - 1)
        svg = draw_fixture(fixture, result.workpiece, result.toolkit, title=f"Fixture {rank}", path=path)
        write_png(svg, folder / f"{CHOSEN}.png", ACROSS_PAGE)
    pose = assembly.fixture.pose
    return {
        "rank": rank,
        "marks": identify_fixture(read_listed_fixtures(folder)[rank - 1]),
        "holes": [peg.hole for peg in fixture.pegs],
        "note": note,
        "pose": {"theta_deg": pose.theta_deg, "x": pose.x, "y": pose.y},
        "bodies": [convert_body_to_prisms(body) for body in assembly.bodies[1:]],
    }


def find_supports_under(fixture: Fixture, query: Query) -> tuple[ChosenSupports | None, str]:
    """Return (the best three supports under a fixture, ""), or (None, the reason why there are none)."""
    from workhold.model.support_triples import ChosenSupports
    from workhold.supports.asking import support_with_smaller_sizes, try_smaller_requests
    from workhold.supports.words import explain_no_set

    (found,), _ = support_with_smaller_sizes([fixture], query, try_smaller_requests(query, None))
    return (
        (ChosenSupports.from_supports(found), "")
        if found.triples
        else (None, explain_no_set(found, MILLIMETRE))
    )


def draw_nearest_miss(result: Result, folder: Path) -> None:
    """Draw the nearest miss into the folder, if there is one."""
    from workhold.drawing.fixture_pictures import draw_fixture
    from workhold.search.explaining import explain

    nearest = explain(result.query).nearest
    if nearest is not None:
        svg = draw_fixture(nearest.fixture, result.workpiece, result.toolkit, title="Nearest miss")
        write_png(svg, folder / f"{NEAREST_MISS}.png", ACROSS_PAGE)


def write_png(svg: str, path: Path, width: int) -> None:
    """Write SVG text as a PNG of this width in pixels."""
    from workhold.drawing.render import convert_svg_to_png

    path.write_bytes(convert_svg_to_png(svg, width))


def convert_body_to_prisms(body: FixtureBody) -> dict[str, Any]:
    """Return a body as plain data: its name and slabs,
    each with two heights in mm and its border followed by its holes.
    """
    slabs = [
        {
            "low": one.low,
            "high": one.high,
            "borders": [convert_loop_to_numbers(loop) for loop in (one.outer, *one.holes)],
        }
        for one in body.slabs
    ]
    return {"name": body.name, "slabs": slabs}


def convert_loop_to_numbers(segments: Iterable[Segment]) -> list[list[float]]:
    """Return a loop as plain data: [x, y, x, y] for a line,
    [x, y, radius, from, to] for an arc; in mm and rad.

    An arc's angles are counter-clockwise from low to high, whichever way the loop runs it; a full circle
    spans 2 pi.
    """
    return [
        [*one.start, *one.end]
        if isinstance(one, Line)
        else [*one.center, one.radius, one.mid_angle - one.half_sweep, one.mid_angle + one.half_sweep]
        for one in segments
    ]
