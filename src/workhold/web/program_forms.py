"""A program of the machine in a request, with its table of tools, and the server's answers about it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from math import isfinite
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated, Any, Literal

from attrs import asdict, evolve
from pydantic import ConfigDict, Field

from workhold.asking.declaring import list_declarations
from workhold.asking.program import CuttingQuestion, ProgramQuestion, StockQuestion
from workhold.errors import InputError
from workhold.files.declared_forms import add_declared_fields, collect_given_values
from workhold.files.result.hold_text import make_need_entry
from workhold.model.jaw_hold import JawHold
from workhold.model.program import Program
from workhold.model.solid import SolidOutline
from workhold.model.straps import StrappedHold
from workhold.units import MILLIMETRE
from workhold.web.request_forms import LARGEST, Form, Name, Point
from workhold.web.worker import TaskContext

if TYPE_CHECKING:
    from workhold.files.program.reader import ReadProgram

__all__ = ["ProgramForm", "ReadProgramForm", "read_sent_program"]

# Characters; 100,000 lines have three million.
MOST_TEXT, MOST_TABLE = 3_500_000, 400_000
OF_PROGRAM = list_declarations(ProgramQuestion)
TABLES = (".toml", ".csv", ".tbl")
Thick = Annotated[float, Field(gt=0, le=LARGEST)]
Start = Annotated[list[Annotated[float, Field(ge=-LARGEST, le=LARGEST)]], Field(min_length=3, max_length=3)]
# What the questions of a program's reader are called on the page.
CALLED = {"start": '"Tip starts at"'}

EXAMPLE: dict[str, Any] = {
    "name": "plate.nc",
    "text": "G21 G90\nT1 M6\nG0 X-20 Y0 Z20\nG1 Z2 F300\nX80\nM30\n",
    "tools": {"name": "tools.csv", "text": "tool,diameter,stickout,holder_diameter\n1,10,32,40\n"},
    "thickness": 12,
    "peg_height": 8,
}


class ToolTableForm(Form):
    """A table of tools as its file has it: TOML, CSV, or that of LinuxCNC; its name says which."""

    name: Name = "tools.csv"
    text: Annotated[str, Field(max_length=MOST_TABLE)]


@add_declared_fields(list_declarations(CuttingQuestion), LARGEST)
class CuttingForm(Form):
    """How tools cut that the table does not describe: a force in N, a power in kW, or a material."""

    material: Name | None = None


@add_declared_fields(list_declarations(StockQuestion), LARGEST)
class StockForm(Form):
    """The stock that the part is cut from: the outline or the block around it, with allowances around and on
    top.
    """


@add_declared_fields(OF_PROGRAM, LARGEST)
class ProgramForm(Form):
    """A program (G-code) whose tools keep clear of everything that holds the part; lengths in mm.

    Without a table of tools, the program's comments on its tools are used. ``zero`` is the point of the part
    at the program's X0 Y0. ``z_zero`` is the height of its Z0 above the part's lower side. ``thickness`` and
    ``peg_height``, up to which pegs, clamps and walls extend, are known for a solid. ``start`` is the tip's
    position at the start, from the program's own zero, if the program does not give it. ``whole_numbers`` is
    the unit of lengths without a decimal point: thousandths are 0.001 mm or 0.0001 inch. With ``cutting``, or
    a table with cutting data, tools press on the part where they meet the ``stock``.
    """

    model_config = ConfigDict(json_schema_extra={"examples": [EXAMPLE]})

    name: Name = "program.nc"
    text: Annotated[str, Field(max_length=MOST_TEXT)]
    tools: ToolTableForm | None = None
    zero: Point = Field(default=[0.0, 0.0])
    z_zero: Literal["top", "bottom"] | Annotated[float, Field(ge=-LARGEST, le=LARGEST)] = "top"
    start: Start | None = None
    cutting: CuttingForm | None = None
    stock: StockForm | None = None
    thickness: Thick | None = None
    peg_height: Thick | None = None

    def to_program(self, solid: SolidOutline | None) -> tuple[Program, float | None]:
        """Return the program whose tools the fixtures must clear,
        and the height in mm up to which pegs, clamps and walls reach.

        Parameters
        ----------
        solid : solid of the part, for its heights; None for a part from a drawing.

        Raises
        ------
        InputError
            For a program or a table that cannot be read, and heights that are needed and not given.
        """
        thick, high = self.thickness, self.peg_height
        if solid is not None:
            thick, high = thick or solid.height, solid.peg_height
        if thick is None and (self.z_zero == "top" or high is None):
            raise InputError(
                "The part is an outline without heights, so it is not known which moves of the program "
                "pass over the pegs: give the part's thickness, and the pegs' height if that is less."
            )
        read = read_sent_program(self, thick)
        return evolve(read.program, name=self.name), high or thick


class ReadProgramForm(Form):
    """A program to be shown, and the heights of the part's solid, if it has one."""

    program: ProgramForm
    height: Thick | None = None
    peg_height: Thick | None = None


def read_sent_program(form: ProgramForm, thickness: float | None) -> ReadProgram:
    """Return the program that was sent, as read; errors use the user's names of the files.

    ``thickness`` is that of the part in mm, None where unknown.
    """
    from workhold.files.program.reader import read_program_with_calls

    with write_program_files(form) as (path, tools):
        return read_program_with_calls(
            path,
            tools,
            thickness=thickness,
            **collect_given_values(form, OF_PROGRAM),
            cutting=None if form.cutting is None else form.cutting.model_dump(),
            stock=None if form.stock is None else form.stock.model_dump(),
            called=CALLED,
        )


@contextmanager
def write_program_files(form: ProgramForm) -> Iterator[tuple[Path, Path | None]]:
    """Yield the paths of temporary files with a program and with its tool table, None without a table.

    InputErrors are raised again with the user's names of the files; other errors of reading become an
    InputError.
    """
    with TemporaryDirectory(prefix="workhold-") as folder:
        path, tools = Path(folder) / "program.nc", None
        path.write_text(form.text, encoding="utf-8", newline="")
        names = {str(path): form.name}
        if form.tools is not None:
            ending = f".{form.tools.name.rpartition('.')[2].lower()}"
            tools = Path(folder) / f"tools{ending if ending in TABLES else '.csv'}"
            tools.write_text(form.tools.text, encoding="utf-8", newline="")
            names[str(tools)] = form.tools.name
        try:
            yield path, tools
        except InputError as error:
            raise InputError(rename_files_in_sentence(str(error), names)) from error
        except (ArithmeticError, LookupError, ValueError, RecursionError) as error:
            raise InputError(f"{form.name} is damaged: post it anew.") from error


def rename_files_in_sentence(sentence: str, names: Mapping[str, str]) -> str:
    """Return a sentence with each path in ``names`` replaced by the user's name of that file."""
    for path, name in names.items():
        sentence = sentence.replace(path, name)
    return sentence


def look_at_program(question: ReadProgramForm, order: TaskContext) -> dict[str, Any]:
    """Return a program, as it was read, as plain data: tools, bounding box, notes, and paths to draw.

    Heights are in mm above the part's lower side. The paths are SVG path data in tenths of mm, y downward.
    Each has the index of its tool, its kind, and for cutting moves its level of height from 0.
    """
    from workhold.drawing.path_drawn import SHADES, find_heights_cut
    from workhold.model.program_figures import bound_tip, measure_tools

    form = question.program
    thick = form.thickness if question.height is None else question.height
    high = form.peg_height if question.peg_height is None else question.peg_height
    if thick is None and form.z_zero == "top":
        raise InputError('The part\'s thickness is not known: fill in "Part thickness".')
    read = read_sent_program(form, thick)
    program, figures = read.program, measure_tools(read.program)
    low, top = bound_tip(program.moves)
    last = dict(zip(program.moves.tool.tolist(), program.moves.line.tolist(), strict=True))
    levels = find_heights_cut(program)
    return {
        "name": form.name,
        "lines": read.lines,
        "moves": len(program.moves),
        "unit": program.unit,
        "thickness": thick,
        "peg_height": high or thick,
        "tools": [
            {
                "tool": one.tool,
                "name": program.tools[one.tool].name,
                "diameter": program.tools[one.tool].diameter,
                "reach": max(cylinder.high for cylinder in program.tools[one.tool].cylinders),
                "widest": 2 * max(cylinder.radius for cylinder in program.tools[one.tool].cylinders),
                "first_line": one.first_line,
                "last_line": last[one.tool],
                "cutting": one.cutting,
                "rapid": one.rapid,
                "seconds": one.seconds,
                "lowest": one.lowest,
                "lowest_cut": one.lowest_cut,
            }
            for one in figures
        ],
        "box": [low.tolist(), top.tolist()],
        "heights_cut": list(levels),
        "levels": SHADES,
        "skipped": list(program.skipped),
        "notes": list(program.notes),
        "paths": list(describe_paths(program)),
    }


def describe_paths(program: Program) -> Iterator[dict[str, Any]]:
    """Yield the paths of a program to draw, one for each tool, kind and level."""
    from workhold.drawing.path_drawn import PagePaths, group_moves_by_look
    from workhold.drawing.scene import View

    paths = PagePaths.from_moves(program.moves, View(10.0, 0.0, 0.0))
    for look, rows in group_moves_by_look(program):
        d = paths.make_path_data(rows)
        if d:
            yield {"place": look.place, "kind": look.kind, "level": look.level, "d": d}


def describe_clearance(result: Any, index: int) -> dict[str, Any] | None:
    """Return where the tools of a result's program come nearest to the fixture with this index.

    Return None where they never come near.
    """
    from workhold.statics.program_clearance import find_nearest_passing

    near = find_nearest_passing(result, index)
    return None if near is None or not isfinite(near.distance) else asdict(near)


def describe_vise_clearance(result: Any, index: int) -> list[str]:
    """Return sentences on how far tools cut through a part between flat jaws, and on the body that they come
    nearest to; [] for other fixtures.
    """
    from workhold.statics.jaw_clearance import list_vise_sentences

    return list_vise_sentences(result[index], result.query, MILLIMETRE)


def describe_forces(result: Any, index: int) -> dict[str, Any] | None:
    """Return the clamping forces that the program's tools need, in N and in sentences; None without forces."""
    from workhold.statics.jaw_program import describe_asked_force
    from workhold.statics.program_forces import find_cutting_need
    from workhold.supports.words_of_straps import describe_program_need

    hold, program = (result[index].hold, result.query.program) if result.holds else (None, None)
    if isinstance(hold, JawHold) and hold.program_need is not None and program is not None:
        asked = hold.program_need
        return {**make_need_entry(asked), "words": [describe_asked_force(asked, program, MILLIMETRE)]}
    if isinstance(hold, StrappedHold):
        if hold.program_need is None or program is None:
            return None
        words = describe_program_need(hold.program_need, program, MILLIMETRE)
        return {**make_need_entry(hold.program_need), "words": [words]}
    need = find_cutting_need(result, index)
    if need is None:
        return None
    return need.to_dict() | {
        "words": need.list_sentences(result.toolkit.moving.noun, MILLIMETRE, result.toolkit.travel_count)
    }
