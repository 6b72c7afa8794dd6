"""Tools of ``workhold mcp`` for agents: load, design, show, sheet and explain.

Each tool has a form of its arguments (``cli.agent_arguments``). Lengths are in mm, angles in
degrees, forces in N. Nothing here knows the protocol. A result stays in its file; the next tool takes the
file's path.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from threading import Event, Timer
from typing import Any

from attrs import frozen

from workhold.cli.agent_arguments import (
    OF_SEARCH,
    DesignArguments,
    LoadArguments,
    ProgramArguments,
    SheetArguments,
    ShowArguments,
    ToolArguments,
)
from workhold.cli.options import read_result_with_rank
from workhold.cli.outputs import refuse_output
from workhold.cli.search_options import add_dowel_fit
from workhold.cli.show_command import describe_program_clearances
from workhold.errors import InputError
from workhold.files.declared_forms import collect_given_values
from workhold.files.input_forms import LoadTable
from workhold.files.loads_file import parse_load
from workhold.files.part.load import LoadedPart, read_workpiece, refuse_unsure_numbers
from workhold.files.result.save import save
from workhold.files.toolkit_file import load_toolkit
from workhold.fixels.kinds import ALIASES, KINDS, make_toolkit
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Box
from workhold.listing.identity import make_entries
from workhold.model.program import Program
from workhold.model.quality import read_asked_ranking
from workhold.model.query import Query
from workhold.model.requirements import (
    Load,
    Restrictions,
    Tolerance,
    circle_zone,
    describe_far_loads,
    polygon_zone,
)
from workhold.model.result import Result
from workhold.model.workpiece import Workpiece
from workhold.presenting.data import (
    describe_explanation,
    describe_fixture,
    describe_load_case,
    describe_part,
    describe_result,
)
from workhold.units import MILLIMETRE

__all__ = ["TOOLS"]


@frozen
class ToolAnswer:
    """Answer of a tool: plain data, and a picture as SVG text where one was asked for."""

    data: dict[str, Any]
    picture: str | None = None


@frozen
class AgentTool:
    """A tool: its description, the form of its arguments and the function that runs it.

    Parameters
    ----------
    words : description of the tool for an agent.
    arguments : the form of its arguments.
    run : function called with the arguments, a folder for files without a given name, and an event that ends
        a search.
    """

    words: str
    arguments: type[ToolArguments]
    run: Callable[[Any, Path, Event], ToolAnswer]


def load(asked: LoadArguments, folder: Path, cancel: Event) -> ToolAnswer:
    """Return a part, read as ``asked``, as plain data with its faces, and its picture if asked for.

    ``folder`` and ``cancel`` are not used.
    """
    loaded = read_workpiece(asked.part, **asked.to_load_arguments())
    return ToolAnswer(
        describe_part(loaded.workpiece, loaded.remarks), loaded.workpiece.draw() if asked.picture else None
    )


def run_design_tool(asked: DesignArguments, folder: Path, cancel: Event) -> ToolAnswer:
    """Return the best fixtures as plain data, after writing a result file with all fixtures found.

    The file is a new one in ``folder`` unless the arguments name one. Setting ``cancel`` ends the search, and
    the result is incomplete then.
    """
    out = asked.out or str(folder / f"result-{len(list(folder.iterdir())) + 1}.json")
    refuse_output(out, (asked.part, asked.toolkit), asked.force, "force")
    loaded, result = search_until_deadline(asked, cancel)
    save(result, out, overwrite=True)
    found = describe_result(result, make_entries(result), asked.count)
    data = {
        **found,
        "result_file": out,
        "remarks": [*loaded.remarks, *describe_far_loads(result.query.loads, Box(*result.workpiece.bounds))],
    }
    return ToolAnswer(data, result.draw() if asked.picture and len(result) else None)


def explain(asked: DesignArguments, folder: Path, cancel: Event) -> ToolAnswer:
    """Return why there is no fixture and which changes would help, as plain data.

    Where there are fixtures, return their number instead.
    """
    _, result = search_until_deadline(asked, cancel)
    found = sum(result.found.values())
    if found or not result.complete:
        why = (
            f"There are {found:,} fixtures; the tool design lists them."
            if found
            else "The search ended before it found a fixture."
        )
        return ToolAnswer({"found": found, "complete": bool(result.complete), "sentence": why})
    from workhold.search.explaining import explain as explained

    explanation = explained(result.query)
    words = explanation.nearest.words if explanation.nearest else " ".join(map(str, result.notes))
    words = f"{explanation.asked_words} {words}".lstrip()
    return ToolAnswer(
        {"found": 0, "complete": True, "sentence": words, **describe_explanation(explanation, result.toolkit)}
    )


def search_until_deadline(asked: DesignArguments, cancel: Event) -> tuple[LoadedPart, Result]:
    """Return the part and the result of a search, which stops after the seconds asked for or when ``cancel``
    is set.
    """
    from workhold.search.design import answer

    toolkit, tolerance = make_asked_toolkit(asked.toolkit, asked.fields)
    loaded = read_workpiece(asked.part, **asked.to_load_arguments(), peg_diameter=toolkit.peg_diameter)
    refuse_unsure_numbers(loaded, asked.avoid)
    loads = make_loads(asked.loads)
    zones = [
        circle_zone(*one.circle) if hasattr(one, "circle") else polygon_zone(one.polygon)
        for one in asked.keep_out
    ]
    passed = read_program_to_pass(asked.program, loaded.workpiece)
    program = passed.get("program")
    has_forces = program is not None and program.forces is not None
    query = Query(
        loaded.workpiece,
        toolkit,
        asked.types,
        Restrictions(asked.avoid, zones, asked.angles, asked.touch),
        read_asked_ranking(None, asked.prefer, bool(loads) or has_forces, program is not None),
        add_dowel_fit(None, tolerance),
        loads,
        **collect_given_values(asked, OF_SEARCH),
        **passed,
    )
    clock = Timer(asked.seconds, cancel.set)
    clock.start()
    try:
        return loaded, answer(query, cancel=cancel)
    finally:
        clock.cancel()


def read_program_to_pass(asked: ProgramArguments | None, workpiece: Workpiece) -> dict[str, Any]:
    """Return keyword arguments of a query: "program" and "peg_height" in mm; {} where no program is given.

    Raises InputError where neither the pegs' nor the part's height is known.
    """
    if asked is None:
        return {}
    solid = workpiece.solid
    height = None if solid is None else solid.height
    high = asked.peg_height or asked.thickness if solid is None else solid.peg_height
    if high is None:
        raise InputError(
            "the part is an outline without heights, so it is not known which moves of the program "
            "pass over the pegs: give the part's thickness, and peg_height if the pegs are not as "
            "high."
        )
    return {"program": Program.read(asked.path, **asked.to_read_arguments(height)), "peg_height": high}


def make_asked_toolkit(name: str, fields: Mapping[str, Any]) -> tuple[Toolkit, Tolerance | None]:
    """Return the toolkit of a preset, a TOML file or a kind, with ``fields`` replaced, and the toolkit's own
    tolerance.

    The tolerance is None for a kind. Raises InputError for an unknown name and fields that do not fit.
    """
    try:
        if name in KINDS or name in ALIASES:
            return make_toolkit(name, fields), None
        loaded = load_toolkit(name)
        return make_toolkit(loaded.kind, {**loaded.fields, **fields}), loaded.tolerance
    except (TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"the fields of the toolkit are not as they should be: {error}.") from error


def make_loads(tables: list[LoadTable]) -> tuple[Load, ...]:
    """Return loads made of tables as an agent gives them, in order; lengths in mm."""
    given = (table.model_dump(exclude_unset=True) for table in tables)
    return tuple(parse_load(words, f"load {number}", 1.0) for number, words in enumerate(given, 1))


def show(asked: ShowArguments, folder: Path, cancel: Event) -> ToolAnswer:
    """Return how to set up one fixture of a result file,
    and what loads do to it, as plain data, with a picture if asked.
    """
    from workhold.statics.loads import compute_load_cases

    result = read_result_with_rank(asked.result_file, asked.rank)
    fixture, loads = result[asked.rank - 1], make_loads(asked.loads) or result.query.loads
    force = result.query.jaw_force if asked.jaw_force is None else asked.jaw_force
    cases = compute_load_cases(fixture, result.workpiece, result.toolkit, loads, force)
    rest = {
        "listed": len(result),
        "complete": bool(result.complete),
        "loads": [describe_load_case(one) for one in cases],
        "program": describe_program_clearances(result, asked.rank, MILLIMETRE, force),
    }
    shown = describe_fixture(fixture, result.toolkit, asked.rank)
    if asked.seating and not result.toolkit.closes_at_once:
        from workhold.seating.clamping import plan_hand_loading

        shown["by_hand"] = plan_hand_loading(fixture, result.workpiece, result.toolkit).to_fields()
    elif asked.seating and fixture.seating is None:
        from workhold.seating.solver import SeatingSolver

        shown["seating"] = SeatingSolver(result.workpiece, result.toolkit).solve(fixture).to_fields()
    return ToolAnswer({"fixture": shown, **rest}, fixture.draw() if asked.picture else None)


def run_sheet_tool(asked: SheetArguments, folder: Path, cancel: Event) -> ToolAnswer:
    """Write a setup sheet, a set-up for CAM or a list of pins; return the path written."""
    refuse_output(asked.path, (asked.result_file,), asked.force, "force")
    result = read_result_with_rank(asked.result_file, asked.rank)
    wishes = asked.model_dump(exclude={"result_file", "rank", "path", "force"})
    fixture, force = result[asked.rank - 1], asked.force
    fixture.save_sheet(asked.path, result_file=asked.result_file, overwrite=force, **wishes)
    return ToolAnswer({"written": [asked.path]})


TOOLS: Mapping[str, AgentTool] = {
    "load": AgentTool(
        "Read a part and list its numbered faces; avoid takes these numbers.", LoadArguments, load
    ),
    "design": AgentTool(
        "Find every way to hold a part in a vise, on a plate with clamps or on a fence. The list "
        "is proven complete. Report the best fixtures, and write all to a result file.",
        DesignArguments,
        run_design_tool,
    ),
    "show": AgentTool(
        "Show how to set up one fixture of a result file: holes, opening, pose, quality, and what loads do "
        "to it.",
        ShowArguments,
        show,
    ),
    "sheet": AgentTool(
        "Write the setup sheet of a fixture of a result file, or its set-up as DXF or STEP, or its list of "
        "pins.",
        SheetArguments,
        run_sheet_tool,
    ),
    "explain": AgentTool(
        "Explain why there is no way to hold a part: which rule removed the last candidates, and "
        "which changes would help.",
        DesignArguments,
        explain,
    ),
}
