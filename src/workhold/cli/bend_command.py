"""The command ``bend``: how far clamps and cutters bend the part of the best fixtures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from attrs import frozen

from workhold.cli.commands import make_option, print_remark, spread_option_groups
from workhold.cli.ending import INTERRUPTED, note_results_to_keep, set_event_on_interrupt
from workhold.cli.options import SHOWN_UNIT, ResultArgument, read_rank, read_result_with_rank
from workhold.cli.outputs import (
    FORCE,
    JSON,
    STANDARD_OUTPUT,
    choose_output_form,
    print_json,
    read_picture_path,
    refuse_both,
    refuse_output,
    refuse_result_file,
    write_output,
    write_picture,
)
from workhold.cli.progress import show_progress
from workhold.cli.setup_sheets import PART_FILE
from workhold.cli.table import Table, print_tables
from workhold.cli.values import (
    choose_printed_unit,
    read_optional_count,
    read_optional_force,
    read_optional_positive_length,
    read_unit,
)
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.bending.asking import BendingQuestion
    from workhold.bending.figures import Bending
    from workhold.model.result import Result
    from workhold.units import Unit

__all__ = ["bend"]

PART, CLAMPING, OUTPUT = "The part", "Clamping", "Results"
# How many of the best fixtures are bent where nobody says.
USUAL = 20


@frozen
class BendWords:
    """Options of the material, the part and the clamping, as typed; None for those not given."""

    material: str = make_option(
        PART,
        "NAME",
        "Material of the part: aluminium-6061, aluminium-7075, mild-steel, steel-4140, stainless-304, brass, cast-iron, "
        "pom, pa6 or peek; or Young's modulus in MPa and Poisson's ratio, such as 69000,0.33, and the yield "
        "strength if you know it: 69000,0.33,276.",
        default="aluminium-6061",
    )
    thickness: str | None = make_option(
        PART, "LENGTH", "Thickness of the part; that of the result if not given."
    )
    part: str | None = PART_FILE
    cut: str | None = make_option(
        PART,
        "FACES",
        "Faces to be cut, whose bending counts: numbers of faces, top and bottom, such as top,3,5; all if not given.",
    )
    jaw_force: str | None = make_option(
        CLAMPING,
        "FORCE",
        "Force of the jaws, or of each clamp or strap, in N; that of the result if not given, else what its loads need, "
        "else 1000 N.",
    )
    jaw: str = make_option(
        CLAMPING,
        "screw|constant|NUMBER",
        "What keeps the jaw closed under loads; see workhold sheet.",
        default="screw",
    )


@frozen
class BentWords:
    """Options of the output, as typed; None for those not given."""

    best: str | None = make_option(OUTPUT, "K", "How many of the best fixtures to look at; 20 if not given.")
    rank_by: str | None = make_option(
        OUTPUT, "FIGURE", "Order these by clamp-distortion or give, the least first; as listed if not given."
    )
    bend: str | None = make_option(
        OUTPUT,
        "LENGTH",
        "Warn of a part that bends or gives by more; one that would yield is warned of anyway.",
    )
    out: str | None = make_option(
        OUTPUT,
        "FILE",
        "Write the result with these figures into this file (.json, .csv or .npz); with --rank-by those that were bent "
        "come first in it.",
    )
    draw: str | None = make_option(
        OUTPUT, "FILE", "Draw the first of these, coloured and bent, into this file (.png or .svg)."
    )
    glb: str | None = make_option(
        OUTPUT, "FILE", "Write that one in three dimensions, coloured and bent, into this file (.glb)."
    )
    force: bool = FORCE


@spread_option_groups
def bend(
    result_file: ResultArgument,
    number: Annotated[
        str | None,
        typer.Argument(metavar="[N]", help="Rank of one fixture; the best ones if not given."),
    ] = None,
    *,
    words: BendWords,
    said: BentWords,
    unit: str | None = SHOWN_UNIT,
    json_: bool = JSON,
) -> None:
    """Report how far clamps bend the part of fixture N, or of the best fixtures, and how far the part moves
    at the cutter.

    The bending by clamps springs back after the cut: a face that was cut flat is no longer flat. Loads and
    program are those of the result. A part that was read from a STEP file needs this file again, with --part.
    The command needs the extra "bending", which is NGSolve.

    Example: workhold bend part.json --material aluminium-6061 --thickness 12 --jaw-force 3000 --bend 0.02
    """
    shown = read_unit(unit)
    rank = None if number is None else read_rank(number)
    if rank is not None and said.best is not None:
        raise InputError("--best counts fixtures, and one is named: leave one of them out.")
    picture = read_picture_path(said.draw, (result_file, words.part), said.force)
    model = None if said.glb is None else Path(said.glb)
    if model is not None:
        if model.suffix.lower() != ".glb":
            raise InputError(f"--glb {model} is not the name of a GLB file: let the name end in .glb.")
        refuse_output(model, (result_file, words.part), said.force)
    form = choose_output_form(said.out, None)
    refuse_both(json_, said.out)
    if said.out is not None and said.out != STANDARD_OUTPUT:
        refuse_result_file(said.out, form, (result_file, words.part), said.force)
    limit = read_optional_positive_length("--bend", said.bend, shown)
    asked = read_question(words, shown)
    figure = read_figure(said.rank_by)
    best = read_optional_count("--best", said.best)
    result, rows = read_rows(result_file, rank, best, said.out is not None)
    from workhold.presenting.assembly import read_part_shape
    from workhold.presenting.bent import make_shape_to_bend

    query = result.query
    shape = read_part_shape(words.part, result.workpiece)
    whole = make_shape_to_bend(query, asked, shape)
    from workhold.bending.asking import find_bendings

    with (
        set_event_on_interrupt("what is found so far is told") as cancel,
        show_progress("Bending", f"of {len(rows)}", "Meshing the part") as progress,
    ):

        def tell(fraction: float, count: int) -> None:
            if count:
                note_results_to_keep()
            progress(fraction, count)

        found = find_bendings(result, rows, whole, asked, cancel, tell)
    ranked = rank_bendings(list(zip(rows, found, strict=False)), figure)
    printed = choose_printed_unit(unit, result.toolkit)
    written = write_first(ranked, result, picture, model, printed)
    order = ""
    if said.out is not None and ranked:
        bent = result.add_bending({row: one.to_figures() for row, one in ranked}, figure)
        write_output(bent, said.out, form)
        if said.out != STANDARD_OUTPUT:
            written.append(said.out)
            order = "" if figure is None else f" There the fixtures are listed in the order of {figure}."
    if said.out == STANDARD_OUTPUT:
        pass
    elif json_:
        fixtures = [{"rank": row + 1, **one.to_data()} for row, one in ranked]
        print_json(fixtures=fixtures, complete=not cancel.is_set(), written=written)
    else:
        print_tables(
            *tabulate(ranked, result, asked, printed),
            *(f"Written to {path}.{order if path == said.out else ''}" for path in written),
        )
    print_warnings(ranked, limit, printed)
    if cancel.is_set():
        raise typer.Exit(INTERRUPTED)


def format_numbers(numbers: Sequence[int]) -> str:
    """Return numbers in words, in rising order.

    >>> format_numbers([7, 2]), format_numbers([1, 4, 3])
    ('2 and 7', '1, 3 and 4')
    """
    *before, last = map(str, sorted(numbers))
    return f"{', '.join(before)} and {last}" if before else last


def print_warnings(ranked: list[tuple[int, Bending]], limit: float | None, unit: Unit) -> None:
    """Print the warnings of fixtures, of figures above ``limit`` in mm and of parts that would yield.

    Of each kind the first fixture has its sentence, and the numbers of the others follow in one line.
    """
    kinds: dict[str, list[tuple[int, str]]] = {}
    for row, one in ranked:
        for kind, sentence in one.find_warnings(limit, unit).items():
            kinds.setdefault(kind, []).append((row + 1, sentence))
    for kind, warned in kinds.items():
        (first, sentence), others = warned[0], [number for number, _ in warned[1:]]
        print_remark(f"fixture {first}: {sentence}")
        if others:
            more = "" if limit is None else f" by more than {unit.format_small_length(limit)}"
            does = {"stress": "might yield", "clamp_distortion": f"are bent{more}", "give": f"give{more}"}[
                kind
            ]
            named = "fixture" if len(others) == 1 else "fixtures"
            print_remark(f"the parts of {named} {format_numbers(others)} {does}, too.")


def read_question(words: BendWords, unit: Unit) -> BendingQuestion:
    """Return the question of bending from the options as typed; lengths without a unit are in ``unit``."""
    from workhold.bending.asking import BendingQuestion
    from workhold.model.elastic_material import find_material
    from workhold.statics.loads import read_jaw_stiffness

    faces = tuple(
        int(one) if one.isdecimal() else one.lower()
        for one in map(str.strip, (words.cut or "").split(","))
        if one
    )
    return BendingQuestion(
        find_material(words.material),
        read_optional_positive_length("--thickness", words.thickness, unit),
        read_optional_force("--jaw-force", words.jaw_force),
        faces,
        read_jaw_stiffness(words.jaw),
    )


def read_figure(name: str | None) -> str | None:
    """Return the key of the figure to rank by; None where none is given."""
    from workhold.model.part_bending import find_bending_figure

    return None if name is None else find_bending_figure(name).key


def read_rows(
    result_file: str, rank: int | None, best: int | None, is_whole: bool
) -> tuple[Result, list[int]]:
    """Return the result in a file, and the indices, from 0, of the fixtures to bend.

    It is the fixture of ``rank`` if given, else the first ``best`` fixtures (20 for None). Seats for which no
    straps were found are left out. ``is_whole`` says that all of the file is read, to be written again.
    """
    if rank is not None and not is_whole:
        return read_result_with_rank(result_file, rank), [rank - 1]
    from workhold.files.result.reader import read_result
    from workhold.presenting.bent import list_rows_to_bend

    result = read_result(result_file)
    if rank is not None:
        if rank > len(result):
            raise InputError(f"{result_file} lists {len(result)} fixtures: there is no fixture {rank}.")
        return result, [rank - 1]
    return result, list_rows_to_bend(result, best or USUAL)


def rank_bendings(found: list[tuple[int, Bending]], figure: str | None) -> list[tuple[int, Bending]]:
    """Return pairs (index, bending) sorted by a figure, the smallest first; equal ones keep their order.

    For None the pairs are returned unchanged. Raises InputError where a bending lacks the figure.
    """
    if figure is None:
        return found
    if any(figure not in one.figures for _, one in found):
        raise InputError(
            "there is nothing to rank by the give: the result has neither loads nor a program with forces."
        )
    return sorted(found, key=lambda pair: pair[1].figures[figure])


def write_first(
    ranked: list[tuple[int, Bending]], result: Result, picture: Path | None, model: Path | None, unit: Unit
) -> list[str]:
    """Write the picture and the 3D model, where paths are given,
    of the first fixture; return the paths written.
    """
    if not ranked:
        return []
    row, one = ranked[0]
    if picture is not None:
        from workhold.drawing.bent_part import draw_bending
        from workhold.drawing.scene import LengthUnit

        lengths = LengthUnit(unit, unit.decimals)
        title = f"How clamping bends {result.workpiece.name}, fixture {row + 1}"
        write_picture(
            picture,
            draw_bending(one, title, lengths, one.list_sentences(result.toolkit.moving.noun, unit)),
        )
    if model is not None:
        from workhold.files.atomic import write_bytes
        from workhold.presenting.bent import make_bent_glb

        write_bytes(model, make_bent_glb(result[row], one))
    return [str(path) for path in (picture, model) if path is not None]


def describe_strength(asked: BendingQuestion, unit: Unit) -> str:
    """Return a sentence on the strength of the part's material, with a space before it; "" if the strength is
    not known.
    """
    strength = asked.material.strength
    if strength is None:
        return ""
    return f" {asked.material.name} is reckoned to yield at {unit.format_stress(strength)}."


def tabulate(
    ranked: list[tuple[int, Bending]], result: Result, asked: BendingQuestion, unit: Unit
) -> list[Table | str]:
    """Return a heading, a table and a footnote on how far each fixture bends its part; [] where ``ranked`` is
    empty.
    """
    small, mover = unit.small_name, result.toolkit.moving.noun
    if not ranked:
        return []
    has_give = any(one.give is not None for _, one in ranked)
    table = Table(
        (
            ">fixture",
            f">{mover} force {unit.force}",
            f">clamping bends {small}",
            ">±",
            f"at {unit.abbreviation}",
            f">stress {unit.pressure}",
            ">±",
            *((f">gives {small}", ">±", "at") if has_give else ()),
        )
    )

    def place(at: Sequence[float]) -> str:
        """Return a point as text in the unit."""
        return ", ".join(unit.format_number(value, max(unit.decimals - 2, 1)) for value in at)

    for row, one in ranked:
        bent, give = one.clamp_distortion, one.give
        cells = [str(row + 1), f"{one.jaw_force / unit.newtons:.0f}", unit.format_small_number(bent.value)]
        cells += [unit.format_small_number(bent.error), place(bent.at)]
        cells += [unit.format_stress_number(value) for value in (one.stress.value, one.stress.error)]
        if give is not None:
            because = f"line {give.line}" if give.line is not None else f"load {give.load}"
            cells += [
                unit.format_small_number(give.value),
                unit.format_small_number(give.error),
                f"{because}: {place(give.at)}",
            ]
        table.add_row(*cells)
    first = ranked[0][1]
    stated = f"You gave no {mover} force, so every figure is for 1000 N.\n" if first.is_assumed else ""
    return [
        f"How far {result.workpiece.name} of {asked.material.words} is bent",
        "",
        table,
        f"{stated}{first.elements:,} elements. What clamping bends springs back; dents under contacts do not count. "
        f"± is the error of the mesh.{describe_strength(asked, unit)}",
    ]
