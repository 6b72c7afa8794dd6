"""The fixtures as a table for a spreadsheet: one row per fixture, comma-separated, with a line of column names."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan, nan
from pathlib import Path
from typing import IO

from workhold.files.atomic import text_file
from workhold.files.result.fixture_lines import fixture_rows
from workhold.files.result.rounding import known_figures
from workhold.fixels.contact_kind import FLAT_PIN
from workhold.model.quality import SEATING_FIGURES
from workhold.model.result import Result
from workhold.model.seating import DECIMALS

__all__ = ["column_names", "seating_values", "result_csv_text", "write_result_csv", "write_result_csv_to"]

PEG_COLUMNS = ("hole", "jaw", "column", "row", "x", "y", "face", "force")
POSE_COLUMNS = ("number", "type", "theta_deg", "x", "y")
# How far what moves has travelled, of a fixture with one thing that moves and with two.
TRAVEL_COLUMNS = {1: ("jaw_separation",), 2: ("travel_1", "travel_2")}


def write_result_csv(result: Result, path: str | Path) -> None:
    """Write the fixtures of a result as comma-separated values, numbered by rank from 1.

    Lengths are in mm, angles in degrees; column and row count from 0 and the hole's name is the one in the pictures.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    with text_file(path) as stream:
        write_result_csv_to(result, stream)


def write_result_csv_to(result: Result, stream: IO[str]) -> None:
    """Write the comma-separated values to an open text stream."""
    for text in result_csv_text(result):
        stream.write(text)


def column_names(result: Result) -> list[str]:
    """The names of the columns."""
    toolkit = result.toolkit
    pegs = [f"peg{peg}_{name}" for peg in range(1, toolkit.peg_count + 1) for name in PEG_COLUMNS]
    moved = TRAVEL_COLUMNS[toolkit.travels]
    placed = sum(toolkit.carriers[k].contact.is_placed for k in toolkit.arrangements[0].carriers)
    flats = [f"flat{number}_deg" for number in range(1, 1 + placed * (FLAT_PIN in toolkit.contacts))]
    seating = [figure.key for figure in SEATING_FIGURES] if result.seating else []
    return [*POSE_COLUMNS, *moved, *(figure.key for figure in known_figures(result.table)), *pegs, *flats, *seating]


def seating_values(result: Result) -> list[list[float]]:
    """The figures of the seating of all fixtures of a result in which it is told: infinite where there is no end, NaN where
    it was not worked out."""
    told = [list(one.figures.values()) for one in result.seating]
    return told + [[nan] * len(SEATING_FIGURES)] * (len(result) - len(told))


def result_csv_text(result: Result) -> Iterator[str]:
    """The comma-separated values, piece by piece."""
    toolkit, carriers = result.toolkit, result.toolkit.carriers
    yield ",".join(column_names(result)) + "\n"
    moved, flats = 3 + toolkit.travels, FLAT_PIN in toolkit.contacts
    arrangements = [(one.title, [carriers[k] for k in one.carriers]) for one in toolkit.arrangements]
    number, seated = 0, seating_values(result) if result.seating else []
    for kinds, rows in fixture_rows(result.table, toolkit, result.workpiece):
        lines = []
        for kind, row in zip(kinds, rows, strict=True):
            number += 1
            name, jaws = arrangements[kind]
            row, looks = (row[:-1], row[-1]) if flats else (row, [])
            pose, quality = row[6 * len(jaws) :][:moved], row[6 * len(jaws) + moved :]
            fields = [str(number), name, *map(repr, pose), *(f"{value:.12g}" for value in quality)]
            for peg, jaw in enumerate(jaws):
                column, hole_row, peg_x, peg_y, face, force = row[6 * peg : 6 * peg + 6]
                hole = jaw.place_name(column, hole_row)
                fields += [
                    hole,
                    jaw.name,
                    str(column),
                    str(hole_row),
                    repr(peg_x),
                    repr(peg_y),
                    str(face),
                    f"{force:.12g}",
                ]
            fields += ["" if angle is None else repr(angle) for angle in looks]
            if seated:
                fields += ["" if isnan(value) else repr(round(value, DECIMALS)) for value in seated[number - 1]]
            lines.append(",".join(fields) + "\n")
        yield "".join(lines)
