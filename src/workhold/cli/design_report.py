"""Pictures of a design's best fixtures, one by one and as thumbnails, and reasons where there is none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from workhold.cli.table import Table, print_tables
from workhold.files.atomic import explain_system_errors, unfinished

if TYPE_CHECKING:
    from workhold.fixels.toolkit import Toolkit
    from workhold.model.fixture import Fixture
    from workhold.model.notes import Note
    from workhold.model.result import Result
    from workhold.model.search_report import Explanation
    from workhold.units import Unit

__all__ = [
    "NEAREST_MISS",
    "THUMBNAILS",
    "draw_best",
    "write_fixture_pictures",
    "explain_none",
    "list_picture_names",
]

BEST_DRAWN = 12
ENDINGS = (".svg", ".png")
THUMBNAILS, NEAREST_MISS = "thumbnails", "nearest-miss"


def list_picture_names() -> list[str]:
    """Return all file names that pictures of a design may have."""
    ranked = (make_picture_name(rank) for rank in range(1, BEST_DRAWN + 1))
    return [f"{name}{ending}" for name in (THUMBNAILS, NEAREST_MISS, *ranked) for ending in ENDINGS]


def make_picture_name(place: int) -> str:
    """Return the file name, without its ending, of the picture of the n-th entry, ``place`` = n from 1."""
    return f"fixture-{place:02d}"


def write_fixture_pictures(
    fixture: Fixture, result: Result, folder: Path, name: str, title: str, unit: Unit
) -> list[Path]:
    """Draw one fixture of a result into a folder, which is created, as SVG and PNG; return both paths."""
    from workhold.drawing.fixture_pictures import draw_fixture

    with explain_system_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
    svg = draw_fixture(fixture, result.workpiece, result.toolkit, title=title, unit=unit)
    return write_pictures({name: svg}, folder)


def write_pictures(pictures: Mapping[str, str], folder: Path) -> list[Path]:
    """Write each SVG text into a folder as SVG and as PNG, under its name; return the paths.

    If one cannot be written, all are removed and the error is raised again.
    """
    from workhold.drawing.render import render
    from workhold.files.atomic import write_bytes

    written = []
    try:
        for name, svg in pictures.items():
            for ending in ENDINGS:
                path = folder / f"{name}{ending}"
                write_bytes(path, render(svg, ending))
                written.append(path)
                unfinished.add(path)
    except BaseException:
        for path in written:
            path.unlink(missing_ok=True)
        raise
    finally:
        unfinished.difference_update(written)
    return written


def draw_best(result: Result, folder: Path, unit: Unit) -> list[Path]:
    """Draw the best twelve entries and their thumbnails into a folder as SVG and PNG; return the paths.

    The folder is created. Pictures of these names from an earlier design are replaced, or removed where this
    design has fewer fixtures; nothing else in the folder is touched.
    """
    from workhold.drawing.fixture_pictures import draw_best_thumbnails, draw_fixture
    from workhold.drawing.path_drawn import make_planned_path
    from workhold.listing.identity import make_entries

    with explain_system_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
        for old in list_picture_names():
            (folder / old).unlink(missing_ok=True)
    shown = make_entries(result)
    pictures = {}
    for place, index in enumerate(shown.index[:BEST_DRAWN].tolist(), 1):
        held, path = (result[index], result.workpiece, result.toolkit), make_planned_path(result, index)
        svg = draw_fixture(*held, title=f"Fixture {index + 1}", unit=unit, path=path)
        pictures[make_picture_name(place)] = svg
    if not pictures:
        return []
    pictures[THUMBNAILS] = draw_best_thumbnails(result, shown, unit)
    return write_pictures(pictures, folder)


MOST_HELPS = 6


def explain_none(
    result: Result, threads: int | None, folder: Path | None, unit: Unit, stream: TextIO
) -> None:
    """Print how many candidates each rule removes, the nearest miss, and changes that would help.

    The nearest miss is drawn into ``folder`` as SVG and PNG, unless the folder is None.
    """
    from workhold.search.explaining import explain

    explanation = explain(result.query, threads, unit)
    print_explanation(explanation, result.query.toolkit, unit, stream, result.notes)
    if folder is not None and explanation.nearest is not None:
        svg, png = write_fixture_pictures(
            explanation.nearest.fixture, result, folder, NEAREST_MISS, "Nearest miss", unit
        )
        print_tables(f"Drawn: the nearest miss in {svg} and {png.name}.", stream=stream)


def print_explanation(
    explanation: Explanation, toolkit: Toolkit, unit: Unit, stream: TextIO, said: Sequence[Note] = ()
) -> None:
    """Print an explanation of why there is no fixture, without sentences that the notes in ``said`` already
    contain.
    """
    from workhold.cli.tables import tabulate_fixture_setup

    print_tables("", stream=stream)
    if explanation.contacts:
        sets = "sets of four contacts"
        if toolkit.holds_by_friction:
            sets = "ways to lie" if toolkit.strap_set is None else "seats"
        table = Table(("rule", f">{sets}", ">removed", ">left"))
        for removal in explanation.removals:
            table.add_row(removal.rule, f"{removal.before:,}", f"{removal.removed:,}", f"{removal.after:,}")
        print_tables(
            table, f"The rule that removed the last of them: {explanation.last_rule}.", stream=stream
        )
    elif explanation.no_contacts not in said:
        print_tables(str(explanation.no_contacts or ""), stream=stream)
    if explanation.asked_words:
        print_tables(explanation.asked_words, stream=stream)
    if explanation.nearest is not None:
        _, _, _, pegs = tabulate_fixture_setup(explanation.nearest.fixture, toolkit, 1, 1, unit)
        print_tables("", f"Nearest miss: {explanation.nearest.words}", pegs, stream=stream)
    print_tables("", stream=stream)
    if not explanation.helps:
        print_tables("No single change that was tried helps; workhold explore tries others.", stream=stream)
        return
    helps = Table(("what would help", ">fixtures"))
    for item in explanation.helps[:MOST_HELPS]:
        helps.add_row(item.change, f"{item.fixtures:,}" if item.complete else f"over {item.fixtures:,}")
    print_tables(helps, stream=stream)
