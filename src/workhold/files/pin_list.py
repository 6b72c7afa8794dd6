"""The pins of a fixture as CSV: which hole, which dowel, and what each touches."""

from __future__ import annotations

import csv
import io

from workhold.fixels.contact_kind import FLAT_PIN
from workhold.fixels.holes import column_letters
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.plain import plain
from workhold.units import Unit

__all__ = ["HEADER", "pin_list"]

HEADER = ("hole", "carrier", "column", "row", "x", "y", "diameter", "length", "unit", "dowel", "face")


def pin_list(fixture: Fixture, toolkit: Toolkit, unit: Unit, dowel: str | None, length: float | None) -> str:
    """A row for each pin, in the fixture's order; a clamp is none.

    Parameters
    ----------
    unit : of the lengths: x and y of the hole's centre from the first carrier's hole A1, diameter and length of the pin.
    dowel : what the pins are and how they fit, in words; the cell is empty where it is not known.
    length : of the pins, in mm; the same.
    """
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    flats = FLAT_PIN in toolkit.contacts
    writer.writerow((*HEADER, *["flat_deg"] * flats))
    carriers = {carrier.name: carrier for carrier in toolkit.carriers}
    for peg in fixture.pegs:
        carrier = carriers[peg.carrier]
        if not carrier.has_lattice:
            continue
        sizes = (unit.number(peg.x), unit.number(peg.y), unit.figure(2 * carrier.peg_radius))
        long = "" if length is None else unit.figure(length)
        place = (peg.hole, plain(carrier.title), column_letters(peg.column), peg.row + 1)
        looks = ["" if peg.flat_deg is None else f"{peg.flat_deg:.4f}"] * flats
        writer.writerow((*place, *sizes, long, unit.abbreviation, plain(dowel or ""), peg.face, *looks))
    return stream.getvalue()
