"""Tools of ``workhold mcp`` for agents: load, design, show, sheet and explain, with checked arguments.

Each description of an argument is what an agent reads. Lengths are in mm, angles in degrees, forces in N.
Nothing here knows the protocol. A result stays in its file; the next tool is told the file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from threading import Event, Timer
from typing import Annotated, Any, Literal, TypeVar

from attrs import frozen
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from workhold.cli.options import result_with
from workhold.cli.outputs import refuse_output
from workhold.cli.search_options import with_fit_of
from workhold.errors import InputError
from workhold.files.input_forms import LoadTable
from workhold.files.loads_file import load_from_words
from workhold.files.part.load import Loaded, read_workpiece
from workhold.files.result.save import save
from workhold.files.toolkit_file import load_toolkit
from workhold.fixels.kinds import ALIASES, KINDS, toolkit_of
from workhold.fixels.toolkit import Toolkit
from workhold.listing.identity import entries
from workhold.model.query import Query, asked_ranking
from workhold.model.requirements import Load, Restrictions, Tolerance, circle_zone, polygon_zone
from workhold.model.result import Result
from workhold.presenting.data import explanation_data, fixture_data, load_case_data, part_data, result_data

__all__ = [
    "TOOLS",
    "Answer",
    "DesignArguments",
    "LoadArguments",
    "SheetArguments",
    "ShowArguments",
    "Tool",
    "ToolArguments",
    "checked_arguments",
]

Arguments = TypeVar("Arguments", bound="ToolArguments")
Pair = Annotated[list[float], Field(min_length=2, max_length=2)]
Positive = Annotated[float, Field(gt=0)]
Rank = Annotated[int, Field(ge=1, description="which fixture; 1 is the best")]
ResultPath = Annotated[str, Field(description="path of a result file, as design tells it")]
MayReplace = Annotated[bool, Field(description="replace a file that workhold has not written")]
ClosingForce = Annotated[float | None, Field(ge=0, description="with which the vise is closed, in N")]


class ToolArguments(BaseModel):
    """What all tools have in common: words that are not known are refused."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class LoadArguments(ToolArguments):
    """A part and how it is read."""

    part: str = Field(description="path of a DXF, SVG, JSON or STEP file, or a built-in name such as widget")
    unit: Literal["mm", "cm", "m", "inch"] | None = Field(
        default=None, description="of a drawing that does not say its own"
    )
    layers: list[str] | None = Field(
        default=None, description="DXF layers to read; all visible ones if not given"
    )
    part_number: int | None = Field(
        default=None, ge=1, description="which part of several, from 1 by decreasing area"
    )
    join_tolerance: float = Field(
        default=1e-3, ge=0, description="largest gap between loose ends to close, in mm"
    )
    fit: Positive | None = Field(
        default=None, description="how far lines and arcs may be from true curves that they stand for, in mm"
    )
    axis: Literal["x", "y", "z"] | None = Field(
        default=None, description="STEP: what the pegs are parallel to"
    )
    section: float | None = Field(default=None, description="STEP: take the section at this height, in mm")
    picture: bool = Field(default=False, description="show a picture, too")

    def reading(self) -> dict[str, Any]:
        """The arguments of :func:`workhold.load` but the part."""
        return self.model_dump(include=set(LoadArguments.model_fields) - {"part", "picture"})


class Circle(ToolArguments):
    """A round place that no peg may stand over, in the part's coordinates."""

    circle: Annotated[list[float], Field(min_length=3, max_length=3, description="x, y, radius")]


class Polygon(ToolArguments):
    """A place with corners that no peg may stand over, in the part's coordinates."""

    polygon: list[Pair] = Field(min_length=3)


class DesignArguments(LoadArguments):
    """A search for every way to hold a part."""

    toolkit: str = Field(
        description="a preset such as plate-20mm, clamp-plate-20mm, two-clamp-plate-20mm or fence-20mm, the path of a "
        "toolkit's TOML file, or a kind (vise, opening-vise, plate, fence) with fields"
    )
    fields: dict[str, Any] = Field(
        default_factory=dict,
        description="fields of the toolkit that are given or changed, such as pitch, columns, rows, peg_radius, min_gap, "
        "max_opening, travel, clamps, wall_offset",
    )
    types: list[str] | None = Field(default=None, description="of a vise I, II or both")
    best: int | None = Field(default=None, ge=1, description="seek only so many, the best")
    avoid: list[int] = Field(
        default=[], description="faces not to touch, by number, such as those to be machined"
    )
    keep_out: list[Circle | Polygon] = Field(default=[], description="places that no peg may stand over")
    angles: list[Pair] = Field(default=[], description="ranges of angles that the part may lie at")
    contact_margin: float = Field(
        default=0.0, ge=0, description="smallest distance of a contact from a face's end"
    )
    prefer: Literal["square", "strong", "precise", "roomy"] | None = Field(
        default=None, description="what comes first"
    )
    jaw_force: ClosingForce = None
    loads: list[LoadTable] = Field(default=[], description="what acts on the part while it is held")
    seating: int | None = Field(
        default=None,
        ge=1,
        description="of the first so many fixtures tell from how far open, or drawn back, the part is caught and where else "
        "it can rest, and order them by that too",
    )
    opening: Positive | None = Field(
        default=None,
        description="with seating, list only those that catch the part when opened by so many mm",
    )
    foolproof: bool = Field(
        default=False,
        description="with seating, list only those of which a caliper tells every wrong place to rest",
    )
    count: int = Field(default=5, ge=0, le=100, description="how many fixtures to tell")
    out: str | None = Field(
        default=None, description="path of the result file, .json or .npz; else a temporary one"
    )
    force: MayReplace = False
    seconds: Positive = Field(
        default=120.0, description="longest search; what was found by then is told as incomplete"
    )


class ShowArguments(ToolArguments):
    """One fixture of a result."""

    result_file: ResultPath
    rank: Rank = 1
    loads: list[LoadTable] = Field(default=[], description="instead of those of the result")
    jaw_force: ClosingForce = None
    seating: bool = Field(
        default=False, description="work out whether the part ends up there, and where else it can rest"
    )
    picture: bool = Field(default=True, description="show a picture, too")


class SheetArguments(ToolArguments):
    """A setup sheet, or a set-up for a CAM system."""

    result_file: ResultPath
    rank: Rank = 1
    path: str = Field(description="the file to write: .pdf, .svg, .png, .dxf, .step or .csv (a list of pins)")
    force: MayReplace = False
    paper: Literal["a4", "letter"] = "a4"
    unit: Literal["mm", "inch"] = "mm"
    part_name: str | None = None
    jaw_force: ClosingForce = None
    seating: bool | None = Field(
        default=None, description="whether it says if the part ends up there; if known when null"
    )
    jaw: Literal["screw", "constant"] | Annotated[float, Field(ge=0)] = "screw"
    friction: Positive | None = None
    zero: str | Pair | None = Field(
        default=None, description='part zero: "corner", "centre", "hole 2", or x and y'
    )
    machine_position: Pair | None = Field(default=None, description="of hole A1 in the machine's coordinates")
    thickness: Positive | None = None
    peg_length: Positive | None = None
    peg_height: Positive | None = None
    dowel: str | None = Field(
        default=None, description="what the pegs are and how they fit, such as 6 mm m6 in H7"
    )
    clearance: float = Field(
        default=1.0, ge=0, description="how far the cutter is to keep off the pegs of a .dxf"
    )


def checked_arguments(form: type[Arguments], given: dict[str, Any] | None) -> Arguments:
    """The arguments of a tool.

    Raises
    ------
    InputError
        Naming the first that is not as it should be.
    """
    try:
        return form.model_validate(given or {})
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        place = ".".join(str(part) for part in first["loc"])[:120] or "what is given"
        message = str(first["msg"]).strip().rstrip(".")
        raise InputError(f"{place} is not as it should be: {message[:1].lower()}{message[1:200]}.") from error


@frozen
class Answer:
    """What a tool says, as plain data, and a picture as SVG text where one was asked for."""

    data: dict[str, Any]
    picture: str | None = None


@frozen
class Tool:
    """A tool.

    Parameters
    ----------
    words : what it does, for an agent.
    arguments : their form.
    run : takes the arguments, a folder for files that nobody has named, and an event that ends a search.
    """

    words: str
    arguments: type[ToolArguments]
    run: Callable[[Any, Path, Event], Answer]


def load(asked: LoadArguments, folder: Path, cancel: Event) -> Answer:
    """The part and its faces."""
    loaded = read(asked)
    return Answer(
        part_data(loaded.workpiece, loaded.remarks), loaded.workpiece.draw() if asked.picture else None
    )


def read(asked: LoadArguments) -> Loaded:
    """The part.

    Raises
    ------
    InputError
        When it cannot be read, in the words of a tool's arguments.
    """
    return read_workpiece(asked.part, **asked.reading())


def design(asked: DesignArguments, folder: Path, cancel: Event) -> Answer:
    """The best fixtures, and where all of them are."""
    out = asked.out or str(folder / f"result-{len(list(folder.iterdir())) + 1}.json")
    refuse_output(out, (asked.part, asked.toolkit), asked.force, "force")
    loaded, result = answered(asked, cancel)
    save(result, out)
    told = result_data(result, entries(result), asked.count)
    data = {**told, "result_file": out, "remarks": list(loaded.remarks)}
    return Answer(data, result.draw() if asked.picture and len(result) else None)


def explain(asked: DesignArguments, folder: Path, cancel: Event) -> Answer:
    """Why there is no fixture, and what would help; where there are some, how many."""
    _, result = answered(asked, cancel)
    found = sum(result.found.values())
    if found or not result.complete:
        why = (
            f"There are {found:,} fixtures: design tells them."
            if found
            else "The search was ended before any was found."
        )
        return Answer({"found": found, "complete": bool(result.complete), "sentence": why})
    from workhold.search.explaining import explain as explained

    explanation = explained(result.query)
    words = explanation.nearest.words if explanation.nearest else " ".join(result.notes)
    return Answer(
        {"found": 0, "complete": True, "sentence": words, **explanation_data(explanation, result.toolkit)}
    )


def answered(asked: DesignArguments, cancel: Event) -> tuple[Loaded, Result]:
    """The part, and the answer of the search, which is ended when its time is over.

    Raises
    ------
    InputError
        For a part, a toolkit or wishes that cannot be.
    """
    from workhold.search.design import answer

    loaded = read(asked)
    toolkit, tolerance = held_in(asked.toolkit, asked.fields)
    loads = loads_of(asked.loads)
    zones = [
        circle_zone(*one.circle) if hasattr(one, "circle") else polygon_zone(one.polygon)
        for one in asked.keep_out
    ]
    query = Query(
        loaded.workpiece,
        toolkit,
        asked.types,
        asked.contact_margin,
        Restrictions(avoid=asked.avoid, zones=zones, angles=asked.angles),
        asked_ranking(None, asked.prefer, loads),
        with_fit_of(None, tolerance),
        loads,
        asked.best,
        asked.jaw_force,
        seating=asked.seating,
        opening=asked.opening,
        foolproof=asked.foolproof,
    )
    clock = Timer(asked.seconds, cancel.set)
    clock.start()
    try:
        return loaded, answer(query, cancel=cancel)
    finally:
        clock.cancel()


def held_in(name: str, fields: Mapping[str, Any]) -> tuple[Toolkit, Tolerance | None]:
    """A toolkit of a preset, a file or a kind, with fields that are given or changed, and its tolerance where it has one.

    Raises
    ------
    InputError
        When there is none.
    """
    try:
        if name in KINDS or name in ALIASES:
            return toolkit_of(name, fields), None
        loaded = load_toolkit(name)
        return toolkit_of(loaded.kind, {**loaded.fields, **fields}), loaded.tolerance
    except (TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"the fields of the toolkit are not as they should be: {error}.") from error


def loads_of(tables: list[LoadTable]) -> tuple[Load, ...]:
    """Loads from their descriptions.

    Raises
    ------
    InputError
        For the first that cannot be used.
    """
    given = (table.model_dump(exclude_unset=True) for table in tables)
    return tuple(load_from_words(words, f"load {number}", 1.0) for number, words in enumerate(given, 1))


def show(asked: ShowArguments, folder: Path, cancel: Event) -> Answer:
    """How to set up a fixture, and what loads do to it."""
    from workhold.statics.loads import load_cases

    result = result_with(asked.result_file, asked.rank)
    fixture, loads = result[asked.rank - 1], loads_of(asked.loads) or result.query.loads
    force = result.query.jaw_force if asked.jaw_force is None else asked.jaw_force
    cases = load_cases(fixture, result.workpiece, result.toolkit, loads, force)
    told = {
        "listed": len(result),
        "complete": bool(result.complete),
        "loads": [load_case_data(one) for one in cases],
    }
    shown = fixture_data(fixture, result.toolkit, asked.rank)
    if asked.seating and not result.toolkit.closes_at_once:
        from workhold.seating.clamping import by_hand

        shown["by_hand"] = by_hand(fixture, result.workpiece, result.toolkit).as_fields()
    elif asked.seating and fixture.seating is None:
        from workhold.seating.solver import Solver

        shown["seating"] = Solver(result.workpiece, result.toolkit).of(fixture).as_fields()
    return Answer({"fixture": shown, **told}, fixture.draw() if asked.picture else None)


def sheet(asked: SheetArguments, folder: Path, cancel: Event) -> Answer:
    """The setup sheet, written."""
    refuse_output(asked.path, (asked.result_file,), asked.force, "force")
    result = result_with(asked.result_file, asked.rank)
    wishes = asked.model_dump(exclude={"result_file", "rank", "path", "force"})
    result[asked.rank - 1].save_sheet(asked.path, result_file=asked.result_file, **wishes)
    return Answer({"written": [asked.path]})


TOOLS: Mapping[str, Tool] = {
    "load": Tool(
        "Read a part and list its numbered faces; numbers of faces are what avoid takes.", LoadArguments, load
    ),
    "design": Tool(
        "Find every way to hold a part in a vise, on a plate with clamps or on a fence, proven complete; tells the best and "
        "writes all to a result file.",
        DesignArguments,
        design,
    ),
    "show": Tool(
        "Show how to set up one fixture of a result file: holes, opening, pose, quality, and what loads do to it.",
        ShowArguments,
        show,
    ),
    "sheet": Tool(
        "Write the setup sheet of a fixture of a result file, or its set-up as DXF or STEP, or its list of pins.",
        SheetArguments,
        sheet,
    ),
    "explain": Tool(
        "Tell why there is no way to hold a part, which rule took the last candidates away, and which changes would help.",
        DesignArguments,
        explain,
    ),
}
