"""Making of a workpiece from the outline of a drawing or of a solid, with remarks on how it was read, and its
name.

A part that is one of several solids of a STEP file is named after its solid too.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from attrs import evolve, frozen

from workhold.errors import InputError
from workhold.files.budget import UNLIMITED, Budget
from workhold.files.outline.chain import Drawing, drop_zero_lengths
from workhold.files.outline.curves import (
    describe_curve_fit,
    describe_departure,
    merge_short_chords,
    refuse_true_curves,
)
from workhold.files.outline.diagnostics import (
    describe_strays,
    name_layers_in_error,
    refuse_nothing_closed,
    refuse_open_outline,
)
from workhold.files.outline.joining import JoinedLoop
from workhold.files.outline.nesting import DrawnPart, join_loops_as_one_part, refuse_loops_across
from workhold.files.outline.shared_lines import choose_outline, describe_bad_spots, make_outlines
from workhold.files.part.finding import detect_file_kind, find_part_file, read_bytes
from workhold.files.questions import PART_NUMBER
from workhold.model.own_outlines import name_outline
from workhold.model.solid import FileSolid, HeightRow, SolidOutline
from workhold.model.workpiece import Workpiece

if TYPE_CHECKING:
    from workhold.files.step.by_height import HeightDrawing
    from workhold.files.step.usual_height import UsualPegHeight

__all__ = [
    "LoadedPart",
    "build_workpiece",
    "from_drawing",
    "from_heights",
    "refuse_large",
    "solids_in",
    "name_part_after_solid",
]

# A part of more segments than this is a scan or a picture, and would keep every later step busy for hours.
MOST_SEGMENTS = 20_000
PART_LIST = 10


@frozen
class LoadedPart:
    """A workpiece and remarks on how it was read.

    Parameters
    ----------
    workpiece : the part, in mm.
    remarks : one sentence each: what was ignored, closed, dropped or chosen.
    parts : all parts the file holds, by decreasing area; ``workpiece`` is one of them.
    number : number of the workpiece among ``parts``, from 1.
    heights : for a solid seen at the height of the pegs, the outlines at other heights; otherwise empty.
    solids : all of a STEP file, the largest first.
    usual : height of pegs chosen for a solid because the user gave none; None otherwise.
    """

    workpiece: Workpiece
    remarks: tuple[str, ...]
    parts: tuple[DrawnPart, ...]
    number: int = 1
    heights: tuple[HeightRow, ...] = ()
    solids: tuple[FileSolid, ...] = ()
    usual: UsualPegHeight | None = None


def from_heights(name: str, drawing: HeightDrawing) -> LoadedPart:
    """Return a part, called ``name``, from the outline of a solid at the height of the pegs."""
    refuse_large(sum(len(loop) for loop in drawing.loops))
    loops = [JoinedLoop(loop, ("",) * len(loop)) for loop in drawing.loops]
    workpiece = build_workpiece(name, loops, with_labels=False, solid=drawing.solid)
    own = []
    for one in drawing.own:
        refuse_large(sum(len(loop) for loop in one.loops))
        rows = [JoinedLoop(loop, ("",) * len(loop)) for loop in one.loops]
        between = name_outline((one.solid.low, one.solid.peg_height))
        own.append((one.role, build_workpiece(between, rows, with_labels=False, solid=one.solid)))
    if own:
        workpiece = evolve(workpiece, outlines=tuple(own))
    remarks = (*drawing.remarks, *workpiece.remarks)
    return LoadedPart(
        workpiece,
        remarks,
        (join_loops_as_one_part(loops),),
        heights=drawing.heights,
        solids=drawing.solids,
        usual=drawing.usual,
    )


def from_drawing(
    path: Path,
    drawing: Drawing,
    part_number: int | str | None,
    tolerance: float,
    fit: float | None,
    layered: bool = False,
    budget: Budget | None = None,
) -> LoadedPart:
    """Return a part, named after the file, from a drawing's chains.

    Parameters
    ----------
    path : of the file; only its name is used.
    part_number : number of the part to take, from 1 by decreasing area; None takes the largest that can be
        read.
    tolerance : largest gap between ends to close, in mm.
    fit : largest distance in mm of lines and arcs from curves that they replace; None refuses true curves.
    layered : whether layers of the drawing can be chosen, for advice.
    budget : work and time that may still be spent on the file; None means no limit.

    Raises
    ------
    InputError
        For a drawing without a usable closed outline, or with true curves and no fit.
    """
    budget = budget or Budget(UNLIMITED)
    try:
        return make_loaded_outline(path, drawing, part_number, tolerance, fit, layered, budget)
    except InputError as error:
        if not drawing.layers:
            raise
        raise name_layers_in_error(
            error, drawing, partial(is_usable, path, part_number, tolerance, fit, budget)
        ) from error


def is_usable(
    path: Path,
    part_number: int | str | None,
    tolerance: float,
    fit: float | None,
    budget: Budget,
    drawing: Drawing,
) -> bool:
    """Return whether a part can be made of a drawing; its arguments are those of :func:`from_drawing`."""
    try:
        make_loaded_outline(path, drawing, part_number, tolerance, fit, True, budget)
    except InputError:
        return False
    return True


def make_loaded_outline(
    path: Path,
    drawing: Drawing,
    part_number: int | str | None,
    tolerance: float,
    fit: float | None,
    layered: bool,
    budget: Budget,
) -> LoadedPart:
    """Return the result of :func:`from_drawing`; unlike there, error messages do not name layers with which a
    part could be made.
    """
    clean = drop_zero_lengths(drawing.chains)
    outlines = make_outlines(clean.chains, tolerance, drawing, budget)
    parts = outlines.parts
    if not parts and outlines.spots:
        raise outlines.spots[0].junction.refusal
    if not parts:
        refuse_nothing_closed(outlines.strays, drawing.remarks)
    budget.check_time()
    part = choose_outline(outlines, part_number)
    if part_number is None:
        refuse_open_outline(part, outlines.strays)
    labels = [label for loop in part.loops for label in loop.labels]
    refuse_true_curves(labels, drawing.curves, fit, layered, budget)
    departure, of_curves = describe_curve_fit(labels, drawing.curves)
    loops, more, of_chords = merge_short_chords(part.loops, drawing.curves, fit, budget)
    departure += more
    merged = evolve(part, loops=loops)
    refuse_large(merged.segment_count)
    try:
        workpiece = build_workpiece(path.stem, loops, departure=departure)
        refuse_loops_across(merged, [other for other in parts if other is not part], budget)
    except ZeroDivisionError as error:  # pragma: no cover - geometry checks first
        raise InputError("the outline has a segment too short to use: simplify the drawing.") from error
    remarks = (*drawing.remarks, *clean.remarks, *outlines.remarks, *of_curves, *of_chords)
    remarks += (*workpiece.remarks, *describe_departure(departure), *describe_strays(outlines.strays))
    remarks += (*describe_bad_spots(outlines), *describe_other_parts(parts, part, part_number))
    return LoadedPart(workpiece, remarks, parts, part.number, solids=drawing.solids)


def build_workpiece(
    name: str,
    loops: Sequence[JoinedLoop],
    with_labels: bool = True,
    departure: float = 0.0,
    solid: SolidOutline | None = None,
) -> Workpiece:
    """Return a workpiece from loops in mm; its error messages do not begin with the part's name.

    The caller puts the file's name there instead. Without ``with_labels`` the segments have no labels;
    ``departure`` is in mm.
    """
    labels = [loop.labels for loop in loops] if with_labels else None
    try:
        return Workpiece.from_loops(name, [loop.vertices for loop in loops], labels, departure, solid)
    except InputError as error:
        raise InputError(str(error).replace(f"{name}: ", "")) from error


def refuse_large(segments: int) -> None:
    """Raise an InputError for a part with more segments than a search can handle."""
    if segments > MOST_SEGMENTS:
        raise InputError(
            f"the part has {segments} segments, more than the {MOST_SEGMENTS} this program takes: draw its "
            "outline with lines and arcs instead of many short pieces."
        )


def describe_other_parts(parts: Sequence[DrawnPart], chosen: DrawnPart, asked: int | str | None) -> list[str]:
    """Return one sentence that lists the parts of a drawing and says which is used; [] for a single part.

    ``asked`` is the number that the user gave, or None.
    """
    if len(parts) == 1:
        return []
    more = f"; and {len(parts) - PART_LIST} smaller ones" if len(parts) > PART_LIST else ""
    largest = "the largest" if chosen.number == 1 else "the largest that can be read"
    because = "" if asked is not None else f", {largest} (choose another with {PART_NUMBER})"
    listing = "; ".join(str(part) for part in parts[:PART_LIST])
    used = f"Part {chosen.number} is used{because}."
    return [f"The file holds {len(parts)} separate parts: {listing}{more}. {used}"]


def solids_in(path: str | PathLike[str]) -> tuple[FileSolid, ...]:
    """Return the solids of a STEP file by decreasing volume, with their names where the file has them.

    ``load`` takes one of them by its number or its name.

    Parameters
    ----------
    path : of the file.

    Returns
    -------
    Number, name, size along x, y and z, and lowest corner of each; lengths in mm, in the file's own axes. A
    name is empty where the file has none.

    Raises
    ------
    InputError
        For a file that cannot be read, is of another kind, or has no solid; naming the file.
    """
    file = find_part_file(path)
    try:
        content = read_bytes(file)
        if detect_file_kind(file, content) != "step":
            raise InputError("only STEP files have solids.")
        from workhold.files.step.solids import list_solids

        return list_solids(content)
    except InputError as error:
        raise InputError(f"{file.name}: {error}") from error


def name_part_after_solid(loaded: LoadedPart, file: str, chosen: int | str | None) -> LoadedPart:
    """Return the part renamed as in "lug of machine", after its solid and ``file``, if the file holds several
    solids.

    It is returned unchanged where the solid has no name, or has the name of the file. ``chosen`` is the
    number or the name of the solid that was read; None is the largest.
    """
    name = "" if len(loaded.solids) < 2 else find_chosen_name(loaded.solids, chosen)
    if not name or name == file:
        return loaded
    return evolve(loaded, workpiece=evolve(loaded.workpiece, name=f"{name} of {file}"))


def find_chosen_name(solids: Sequence[FileSolid], chosen: int | str | None) -> str:
    """Return the name of the solid chosen by number (from 1) or by name in any
    mixture of capitals; None chooses the first.

    "" if the solid has no name. A ``chosen`` name must be that of a solid.
    """
    if not isinstance(chosen, str):
        return solids[(chosen or 1) - 1].name
    asked = " ".join(chosen.split())
    names = [solid.name for solid in solids]
    return asked if asked in names else next(one for one in names if one.casefold() == asked.casefold())
