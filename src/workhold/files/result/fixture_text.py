"""The fixtures of a result as text: lines of JSON (MODEL, "Result file"), and CSV for a spreadsheet.

A line of JSON is made from a template that follows from the toolkit's carriers. It gives each contact's
place, in the form for its carrier, and the force on it per unit of force of each moving carrier. The
templates are filled with columns of numbers, because a result may have a million fixtures.

The CSV table has one row per fixture and a line of column names. The pins of one fixture have a separate
table: hole, dowel, and touched face of each.

Glossary
--------
block : the fixtures that are turned into Python objects at the same time.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Mapping, Sequence
from math import isnan, nan
from typing import Any

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.errors import make_printable
from workhold.fixels.carrier import Carrier, make_column_letters
from workhold.fixels.contacts import CLAMP_TIP, FLAT_PIN, Arrangement
from workhold.fixels.toolkit import Toolkit
from workhold.model.clamps import compute_force_ratios
from workhold.model.fixture import Fixture
from workhold.model.fixture_table import FixtureTable, compute_peg_places, list_flat_angles
from workhold.model.part_bending import BENDING_COLUMNS
from workhold.model.quality import SEATING_FIGURES, Figure, list_figures_in_columns
from workhold.model.result import Result
from workhold.model.seating import DECIMALS
from workhold.model.workpiece import Workpiece
from workhold.units import Unit

__all__ = [
    "ANGLE_STEPS",
    "HEADER",
    "LENGTH_STEPS",
    "round_table_for_file",
    "list_column_names",
    "write_fixture_lines",
    "list_fixture_rows",
    "list_known_figures",
    "write_pin_list",
    "write_result_csv",
    "round_to_steps",
    "round_degrees",
    "list_bending_columns",
    "list_bending_values",
    "list_seating_values",
    "round_to_twelve_digits",
]

LENGTH_STEPS = 1e9
ANGLE_STEPS = 1e10
# Digits of forces and figures of quality; what lies nearer than this to the middle between two such numbers
# is rounded one by one, because a product in doubles may fall on its other side.
DIGITS, DOUBTFUL = 12, 1e-3


def list_known_figures(table: FixtureTable) -> list[Figure]:
    """Return the figures of quality that are finite for
    all fixtures of a table, in the order of its columns.
    """
    figures = list_figures_in_columns(table.quality.shape[1])
    return [figure for number, figure in enumerate(figures) if np.isfinite(table.quality[:, number]).all()]


def round_to_steps(values: NDArray[np.floating[Any]], steps: float) -> NDArray[np.float64]:
    """Return the values rounded to multiples of 1/steps, without negative zeros."""
    return np.rint(values.astype(np.float64) * steps) / steps + 0.0


def round_degrees(degrees: Any) -> NDArray[np.float64]:
    """Return angles in degrees, a number or an array, in [0, 360) and rounded to 1e-10."""
    out = round_to_steps(np.asarray(degrees) % 360.0, ANGLE_STEPS)
    return np.where(out >= 360.0, 0.0, out)


def round_table_for_file(table: FixtureTable) -> tuple[NDArray[np.float64], FixtureTable]:
    """Return (1) the orientations (N,) in degrees as they are written, and (2) the table with the poses and
    jaw travels that a reader will get.

    Writer and reader compute the places of pegs from these rounded values, so the places agree.
    """
    theta = round_degrees(np.degrees(table.theta))
    position, travel = (
        round_to_steps(values, LENGTH_STEPS) for values in (table.position, table.jaw_separation)
    )
    return theta, evolve(table, theta=np.radians(theta), position=position, jaw_separation=travel)


def round_to_twelve_digits(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the floats nearest to values with twelve
    significant digits; NaN for infinite ones, which JSON lacks.

    The results equal those of formatting and parsing each value, but are computed on arrays: a whole number
    below 1e12 is multiplied or divided by an exact power of ten, which rounds once, as parsing does. Values
    for which the twelve digits are in doubt are formatted and parsed.
    """
    values = np.where(np.isfinite(values), values, np.nan)
    size = np.abs(values)
    known = size > 0.0
    exponent = np.floor(np.log10(np.where(known, size, 1.0))).astype(np.int64)
    shift = DIGITS - 1 - exponent
    exact = known & (np.abs(shift) <= 22)
    power = 10.0 ** np.where(exact, np.abs(shift), 0)
    scaled = np.where(shift >= 0, values * power, values / power)
    digits = np.rint(scaled)
    out = np.where(exact, np.where(shift >= 0, digits / power, digits * power), values)
    doubtful = known & ~(exact & (np.abs(scaled - np.floor(scaled) - 0.5) > DOUBTFUL))
    out[doubtful] = [float(f"{value:.{DIGITS}g}") for value in values[doubtful].tolist()]
    return np.asarray(out)


BLOCK = 4096

# The form of a force and of a figure, by how many things move. Of two the forces are those at either one's
# force, rounded before their ratio is taken, so that reading and writing changes nothing.
FORCE: Mapping[int, str] = {1: "%.12g", 2: "[%r, %r]"}
FIGURE: Mapping[int, str] = {1: "%.12g", 2: "%r"}
# What stands about the directions in which clamps push, by how many there are, before the pegs.
PUSHED: Mapping[int, str] = {0: "", 1: '"direction": {0}, ', 2: '"directions": [{0}, {1}], '}
RATIO: Mapping[int, str] = {0: "", 1: "", 2: '"ratio": [%r, %s], '}
# What stands about a travel behind the pose, by how many clamps there are; that of a clamp follows from its
# place.
TRAVELLED: Mapping[int, str] = {0: '"jaw_separation": %r, ', 1: "", 2: '"pairs": %d, '}
POSE = '"pose": {"theta_deg": %r, "x": %r, "y": %r}, '
# A number that is not written.
LEFT_OUT = "%.0s"


def make_fixture_template(
    arrangement: Arrangement, toolkit: Toolkit, figures: Sequence[Figure], band: str
) -> str:
    """Return the %-template of the JSON line of a fixture of one type (arrangement).

    It takes its numbers in the order of :meth:`WrittenBlock.list_line_columns`; ``band`` is the template of a
    peg's band, or "".
    """
    tips, travels = toolkit.tip_count, toolkit.travel_count
    carriers = [toolkit.carriers[number] for number in arrangement.carriers]
    pegs = ", ".join(
        f"{{{make_peg_template(one, travels)}{band}}}" for one in carriers if one.contact.is_placed
    )
    quality = ", ".join(f'"{figure.key}": {FIGURE[travels]}' for figure in figures)
    pushed = PUSHED[tips].format(*map(json.dumps, arrangement.directions))
    forces = f"[{FORCE[travels]}, {FORCE[travels]}]"
    ends = f'"from": [%r, %r], "to": [%r, %r], "segments": [%d, %d], "forces": {forces}'
    wall = f'"wall": {{{ends}}}, ' * len(toolkit.ends_on_walls)
    flats = ', "flats": %s' * (FLAT_PIN in toolkit.contacts)
    return (
        f'{{"type": "{arrangement.name}", {pushed}{wall}{RATIO[tips]}"pegs": [{pegs}], {POSE}'
        f'{TRAVELLED[tips]}"quality": {{{quality}}}{flats}}}'
    )


def make_peg_template(carrier: Carrier, travels: int) -> str:
    """Return the %-template of a peg on a carrier (jaw, plate or clamp).

    ``travels`` is the number of moving carriers. The template of a clamp takes column and row twice: for the
    clamp's hole, and for the line along which it pushes.
    """
    key, name = carrier.file_entry
    contact = f'"x": %r, "y": %r, "segment": %d, "force": {FORCE[travels]}'
    if carrier.contact is not CLAMP_TIP:
        return f'"{key}": "{name}", "column": %d, "row": %d, {contact}'
    direction = f'"direction": "{carrier.direction}", ' * (travels > 1)
    hole = "[%d, %d]" if carrier.measure == "stroke" else f"null{LEFT_OUT}{LEFT_OUT}"
    line = f'{LEFT_OUT}"row": %d' if carrier.line == "row" else f'"column": %d{LEFT_OUT}'
    return f'"{key}": "{name}", {direction}"hole": {hole}, {line}, {contact}'


def write_fixture_lines(table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece) -> Iterator[list[str]]:
    """Yield the JSON lines of the fixtures of a table, as a list for each block."""
    figures = list_known_figures(table)
    band = ', "band": %s' * (workpiece.solid is not None)
    templates = [make_fixture_template(one, toolkit, figures, band) for one in toolkit.arrangements]
    for block in split_into_written_blocks(table, toolkit, workpiece):
        rows = zip(*block.list_line_columns(), strict=True)
        yield [templates[k] % row for k, row in zip(block.table.arrangement.tolist(), rows, strict=True)]


def list_fixture_rows(
    table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece
) -> Iterator[tuple[list[int], Iterator[tuple[Any, ...]]]]:
    """Yield the blocks of fixtures as plain numbers, rounded as they are written.

    Yields
    ------
    For each block (1) the index of the arrangement of each fixture, and (2) an iterator over a tuple of
    numbers for each fixture. The tuple begins with column, row, x, y, face and force of each peg (with two
    clamps, the force at their working ratio). Then come theta in degrees, x and y of the pose, jaw separation
    or each clamp's travel, and the figures of :func:`list_known_figures`. If pegs have flats, the tuple ends
    with a list of the directions in degrees of the flats of all pegs in holes. Lengths are in mm.
    """
    for block in split_into_written_blocks(table, toolkit, workpiece):
        yield block.table.arrangement.tolist(), zip(*block.list_row_columns(), strict=True)


def split_into_written_blocks(
    table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece
) -> Iterator[WrittenBlock]:
    """Yield the fixtures of a table in blocks of at most ``BLOCK``, rounded as they are written."""
    figures = list_figures_in_columns(table.quality.shape[1])
    known = [figures.index(figure) for figure in list_known_figures(table)]
    for start in range(0, len(table), BLOCK):
        block = table.take(slice(start, start + BLOCK))
        theta, table_read = round_table_for_file(block)
        x, y = (
            round_to_steps(places, LENGTH_STEPS)
            for places in compute_peg_places(table_read, toolkit, workpiece)
        )
        yield WrittenBlock(table_read, toolkit, workpiece, theta, x, y, known)


@frozen(eq=False)
class WrittenBlock:
    """A block of N fixtures, with places rounded as in the file.

    Parameters
    ----------
    table : table of the fixtures, with poses and travels rounded.
    theta : (N,) orientations in degrees.
    x, y : (N, P) places of the contacts in mm.
    known : indices of the figures that are written.
    """

    table: FixtureTable
    toolkit: Toolkit
    workpiece: Workpiece
    theta: NDArray[np.float64]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    known: Sequence[int]

    @property
    def contacts(self) -> range:
        """Indices of the contacts."""
        return range(self.toolkit.peg_count)

    @property
    def placed(self) -> list[int]:
        """Indices of the contacts that are not ends of a wall."""
        on_walls = [k for ends in self.toolkit.ends_on_walls for k in self.contacts[ends]]
        return [k for k in self.contacts if k not in on_walls]

    @property
    def pose(self) -> list[list[Any]]:
        """A list of three columns: theta in degrees, x in mm and y in mm."""
        return [array.tolist() for array in (self.theta, *self.table.position.T)]

    @property
    def flats(self) -> list[list[list[float | None]]]:
        """A list with one column, in which each fixture has the angles in degrees of
        its placed pegs' flats; [] without flat pins.
        """
        if FLAT_PIN not in self.toolkit.contacts:
            return []
        angles, placed = list_flat_angles(self.table, self.toolkit, self.workpiece), self.placed
        return [[[row[k] for k in placed] for row in angles]]

    def list_row_columns(self) -> list[list[Any]]:
        """Return the columns of numbers for :func:`list_fixture_rows`."""
        table, columns = self.table, list[list[Any]]()
        for k in self.contacts:
            numbers = (table.column, table.row, self.x, self.y, table.face, table.contact_force_ratios)
            columns += [array[:, k].tolist() for array in numbers]
        figures = [table.quality[:, number] for number in self.known]
        moved = [array.tolist() for array in (*np.atleast_2d(table.jaw_separation.T), *figures)]
        return [*columns, *self.pose, *moved, *self.flats]

    def list_line_columns(self) -> list[list[Any]]:
        """Return the columns of values in the order in which a line's template takes them."""
        table, toolkit, tips = self.table, self.toolkit, self.toolkit.tip_count
        force, quality, ratio = table.force[:, :, None], table.quality, list[list[Any]]()
        if toolkit.travel_count > 1:
            force, quality = round_to_twelve_digits(table.force) + 0.0, round_to_twelve_digits(quality) + 0.0
            low, high = (round_to_twelve_digits(ends).tolist() for ends in compute_force_ratios(force))
            ratio = [low, ["null" if isnan(end) else repr(end) for end in high]]
        known, walls, pegs = self.workpiece.numbered.bands, list[NDArray[Any]](), list[NDArray[Any]]()
        bands = [np.array([json.dumps(band) for band in known], object)] if known else []
        for ends in toolkit.ends_on_walls:
            several = self.contacts[ends]
            walls += [array[:, k] for k in several for array in (self.x, self.y)]
            walls += [table.face[:, k] for k in several]
            walls += [part for k in several for part in force[:, k].T]
        for k in self.placed:
            times = 2 if k >= len(self.contacts) - tips else 1
            pegs += [
                *[table.column[:, k], table.row[:, k]] * times,
                self.x[:, k],
                self.y[:, k],
                table.face[:, k],
            ]
            pegs += [*force[:, k].T, *(texts[table.face[:, k]] for texts in bands)]
        travelled: dict[int, list[NDArray[Any]]] = {0: [table.jaw_separation], 1: [], 2: [table.pairs]}
        behind = [*travelled[tips], *(quality[:, number] for number in self.known)]
        before, middle, after = ([array.tolist() for array in several] for several in (walls, pegs, behind))
        flats = [[json.dumps(angles) for angles in column] for column in self.flats]
        return [*before, *ratio, *middle, *self.pose, *after, *flats]


PEG_COLUMNS = ("hole", "jaw", "column", "row", "x", "y", "face", "force")
POSE_COLUMNS = ("number", "type", "theta_deg", "x", "y")
# How far what moves has travelled, of a fixture with one thing that moves and with two.
TRAVEL_COLUMNS = {1: ("jaw_separation",), 2: ("travel_1", "travel_2")}


def list_column_names(result: Result) -> list[str]:
    """Return the column names of a result's CSV table."""
    toolkit = result.toolkit
    pegs = [f"peg{peg}_{name}" for peg in range(1, toolkit.peg_count + 1) for name in PEG_COLUMNS]
    moved = TRAVEL_COLUMNS[toolkit.travel_count]
    figures = [figure.key for figure in list_known_figures(result.table)]
    placed = sum(toolkit.carriers[k].contact.is_placed for k in toolkit.arrangements[0].carriers)
    flats = [f"flat{number}_deg" for number in range(1, 1 + placed * (FLAT_PIN in toolkit.contacts))]
    seating = [figure.key for figure in SEATING_FIGURES] if result.seating else []
    return [*POSE_COLUMNS, *moved, *figures, *pegs, *flats, *seating, *list_bending_columns(result)]


def list_seating_values(result: Result) -> list[list[float]]:
    """Return the seating figures of all fixtures in the order of ``SEATING_FIGURES``.

    A figure is inf where it is unbounded, and NaN for fixtures whose seating has not been computed.
    """
    known = [list(one.figures.values()) for one in result.seating]
    return known + [[nan] * len(SEATING_FIGURES)] * (len(result) - len(known))


def list_bending_columns(result: Result) -> Sequence[str]:
    """Return the names of the columns of bending; () for a result without any."""
    return BENDING_COLUMNS if result.bending else ()


def list_bending_values(result: Result, row: int) -> list[float | None]:
    """Return the values of :func:`list_bending_columns` of the fixture at a row; None for those not known."""
    if not result.bending:
        return []
    bent = result.bending.get(row)
    return [None] * len(BENDING_COLUMNS) if bent is None else bent.list_values()


def write_hold_csv(result: Result) -> Iterator[str]:
    """Yield the CSV table, in one piece, of a result whose fixtures hold by friction."""
    from workhold.files.result.hold_text import list_hold_columns, list_hold_rows

    lines = io.StringIO()
    table = csv.writer(lines, lineterminator="\n")
    table.writerow([*list_hold_columns(result.query), *list_bending_columns(result)])
    for place, row in enumerate(list_hold_rows(result)):
        values = [*row, *list_bending_values(result, place)]
        table.writerow(["" if value is None else value for value in values])
    yield lines.getvalue()


def write_result_csv(result: Result) -> Iterator[str]:
    """Yield the CSV table of a result, piece by piece; fixtures are numbered by rank from 1.

    Lengths are in mm, angles in degrees; column and row count from 0 and the hole's name is the one in the
    pictures.
    """
    toolkit, carriers = result.toolkit, result.toolkit.carriers
    if toolkit.holds_by_friction:
        yield from write_hold_csv(result)
        return
    yield ",".join(list_column_names(result)) + "\n"
    moved, flats = 3 + toolkit.travel_count, FLAT_PIN in toolkit.contacts
    arrangements = [(one.title, [carriers[k] for k in one.carriers]) for one in toolkit.arrangements]
    number, seated = 0, list_seating_values(result) if result.seating else []
    for kinds, rows in list_fixture_rows(result.table, toolkit, result.workpiece):
        lines = []
        for kind, row in zip(kinds, rows, strict=True):
            number += 1
            name, jaws = arrangements[kind]
            row, looks = (row[:-1], row[-1]) if flats else (row, [])
            pose, quality = row[6 * len(jaws) :][:moved], row[6 * len(jaws) + moved :]
            fields = [str(number), name, *map(repr, pose), *(f"{value:.12g}" for value in quality)]
            for peg, jaw in enumerate(jaws):
                column, hole_row, peg_x, peg_y, face, force = row[6 * peg : 6 * peg + 6]
                fields += [jaw.name_place(column, hole_row), jaw.name, str(column), str(hole_row)]
                fields += [repr(peg_x), repr(peg_y), str(face), f"{force:.12g}"]
            fields += ["" if angle is None else repr(angle) for angle in looks]
            if seated:
                fields += [
                    "" if isnan(value) else repr(round(value, DECIMALS)) for value in seated[number - 1]
                ]
            bent = list_bending_values(result, number - 1)
            fields += ["" if value is None else repr(value) for value in bent]
            lines.append(",".join(fields) + "\n")
        yield "".join(lines)


HEADER = ("hole", "carrier", "column", "row", "x", "y", "diameter", "length", "unit", "dowel", "face")


def write_pin_list(
    fixture: Fixture, toolkit: Toolkit, unit: Unit, dowel: str | None, length: float | None
) -> str:
    """Return a CSV table with a row for each pin, in the fixture's order; clamps have no row.

    Parameters
    ----------
    unit : unit of the lengths in the table: x and y of the hole's centre from the first carrier's hole A1,
        diameter and length of the pin.
    dowel : description of the pins and their fit; the cell is empty for None.
    length : length of the pins in mm; the cell is empty for None.
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
        sizes = (
            unit.format_number(peg.x),
            unit.format_number(peg.y),
            unit.format_short_length(2 * carrier.peg_radius),
        )
        long = "" if length is None else unit.format_short_length(length)
        place = (peg.hole, make_printable(carrier.title), make_column_letters(peg.column), peg.row + 1)
        looks = ["" if peg.flat_deg is None else f"{peg.flat_deg:.4f}"] * flats
        writer.writerow(
            (*place, *sizes, long, unit.abbreviation, make_printable(dowel or ""), peg.face, *looks)
        )
    return stream.getvalue()
