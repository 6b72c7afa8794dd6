"""The setup sheet that ``workhold design`` writes of its first choice."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

from workhold.cli.commands import print_remark
from workhold.cli.outputs import STANDARD_OUTPUT, refuse_output
from workhold.cli.sheet_supports import first_side_of, supports_under
from workhold.errors import InputError
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.model.recounted import ChosenSupports
    from workhold.model.result import Result
    from workhold.model.support_triples import Supports

__all__ = ["first_sheet", "refuse_sheet", "report_sheet"]

PAPER = (".pdf", ".svg", ".png")
# So many of the best are asked for supports, a millisecond each.
MOST_ASKED = 200


def refuse_sheet(sheet: str | None, inputs: Iterable[str | None], out: str | None, force: bool) -> None:
    """Refuses a sheet before anything is searched; None is no sheet.

    Raises
    ------
    InputError
        For another ending, the file of the result, and see :func:`refuse_output`.
    """
    if sheet is None:
        return
    path = Path(sheet)
    if path.suffix.lower() not in PAPER:
        raise InputError(f"--sheet {sheet} names no setup sheet: let the name end in .pdf, .svg or .png.")
    if out is not None and out != STANDARD_OUTPUT and path.absolute() == Path(out).absolute():
        raise InputError(f"--sheet and --out are both {sheet}: give them different names.")
    refuse_output(path, inputs, force)


def report_sheet(
    result: Result,
    sheet: str,
    out: str | None,
    thickness: float | None,
    unit: Unit,
    before: str | None,
    supported: Sequence[Supports] = (),
) -> None:
    """Writes the sheet of the first choice and says so, or says why there is none."""
    from workhold.cli.table import print_tables

    stream = sys.stderr if out == STANDARD_OUTPUT else sys.stdout
    rank = first_sheet(result, sheet, out, thickness, unit, before, supported)
    if rank is None:
        print_tables(f"As there is no fixture, {sheet} was not written.", stream=stream)
    else:
        print_tables(f"The setup sheet of fixture {rank} was written to {sheet}.", stream=stream)


def first_sheet(
    result: Result,
    sheet: str,
    out: str | None,
    thickness: float | None,
    unit: Unit,
    before: str | None,
    supported: Sequence[Supports] = (),
) -> int | None:
    """Writes the sheet of the first choice and returns its rank; None where there is no fixture.

    Parameters
    ----------
    out : the file that the result was written to, whose hash stands on the sheet.
    thickness : of the part in mm, where supports are wanted: the first choice is the first that has some.
    before : the result of the set-up of the part's other side before this one; None for none.
    supported : the supports of the best fixtures where they are known already, in order.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    from workhold.presenting.papers import write_paper

    # Fixtures that are alike stand in other holes, which three supports may find room between.
    ranks = range(1, min(len(result), MOST_ASKED) + 1)
    if not ranks:
        return None
    rank, supports = ranks[0], None
    if thickness is not None:
        rank, supports = first_supported(result, ranks, thickness, supported)
    settings = {
        "day": date.today(),
        "unit": unit,
        "thickness": thickness,
        "supports": supports,
        "first_side": None if before is None else first_side_of(result, rank, before),
    }
    result_file = None if out == STANDARD_OUTPUT else out
    write_paper(sheet, result, rank, result_file, settings)
    return rank


def first_supported(
    result: Result, ranks: Sequence[int], thickness: float, supported: Sequence[Supports]
) -> tuple[int, ChosenSupports | None]:
    """The first of some fixtures that three supports hold up, and these; the first one where none has any.

    Supports that are known already go before others, and larger pads before smaller ones.
    """
    from workhold.model.recounted import ChosenSupports
    from workhold.supports.sizes import requests_by_size

    query = result.query
    # The table is for the jaw force that the loads ask for.
    known = dict(enumerate(supported, 1)) if query.jaw_force is None else {}
    for rank in ranks:
        if rank in known and known[rank].triples:
            return rank, said_to_be_there(rank, ranks[0], ChosenSupports.of(known[rank]))
    for request in requests_by_size(result.workpiece, thickness, result.toolkit):
        for rank in ranks:
            chosen = supports_under(result, rank, request, None, query.jaw_force)
            if chosen is not None:
                return rank, said_to_be_there(rank, ranks[0], chosen)
    print_remark(
        "no three supports hold the part under any of the best, so the sheet has none: another side up "
        "(--axis) or a finer pitch may help, or parallels under it instead."
    )
    return ranks[0], None


def said_to_be_there(rank: int, first: int, chosen: ChosenSupports) -> ChosenSupports:
    """Supports under a fixture, with a remark where it is not the first one."""
    if rank != first:
        print_remark(f"fixture {first} has no such supports: the sheet is of fixture {rank}.")
    return chosen
