"""The fixtures of a result as lines of JSON and as rows of numbers, block by block (MODEL, "Result file").

A line is a template that follows from the toolkit's carriers: of each contact the place where it stands, as its carrier is
written, and the force on it, per unit of the force of each thing that moves. The templates are filled with columns of
numbers, because a result may have a million fixtures.

Glossary
--------
block : the fixtures that are turned into Python objects at the same time.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from math import isnan
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.files.result.rounding import LENGTH_STEPS, as_told, known_figures, rounded, significant
from workhold.fixels.arrangement import Arrangement
from workhold.fixels.carrier import Carrier
from workhold.fixels.contact_kind import CLAMP_TIP, FLAT_PIN
from workhold.fixels.toolkit import Toolkit
from workhold.model.force_ratio import ratios
from workhold.model.quality import FIGURES, Figure
from workhold.model.result import FixtureTable, flat_angles, peg_places
from workhold.model.workpiece import Workpiece

__all__ = ["fixture_lines", "fixture_rows"]

BLOCK = 4096

# The form of a force and of a figure, by how many things move. Of two the forces are those at either one's force, rounded
# before their ratio is told, so that reading and writing changes nothing.
FORCE: Mapping[int, str] = {1: "%.12g", 2: "[%r, %r]"}
FIGURE: Mapping[int, str] = {1: "%.12g", 2: "%r"}
# What is told of the directions in which clamps push, by how many there are, before the pegs.
PUSHED: Mapping[int, str] = {0: "", 1: '"direction": {0}, ', 2: '"directions": [{0}, {1}], '}
RATIO: Mapping[int, str] = {0: "", 1: "", 2: '"ratio": [%r, %s], '}
# What is told of a travel behind the pose, by how many clamps there are; that of a clamp follows from its place.
TRAVELLED: Mapping[int, str] = {0: '"jaw_separation": %r, ', 1: "", 2: '"pairs": %d, '}
POSE = '"pose": {"theta_deg": %r, "x": %r, "y": %r}, '
# A number that is not written.
LEFT_OUT = "%.0s"


def fixture_template(arrangement: Arrangement, toolkit: Toolkit, figures: Sequence[Figure]) -> str:
    """The line of a fixture with its numbers left open, in the order of :meth:`Told.line_columns`."""
    tips, travels = toolkit.tips, toolkit.travels
    carriers = [toolkit.carriers[number] for number in arrangement.carriers]
    pegs = ", ".join(f"{{{peg_template(one, travels)}}}" for one in carriers if one.contact.is_placed)
    quality = ", ".join(f'"{figure.key}": {FIGURE[travels]}' for figure in figures)
    pushed = PUSHED[tips].format(*map(json.dumps, arrangement.directions))
    ends = f'"from": [%r, %r], "to": [%r, %r], "segments": [%d, %d], "forces": [{FORCE[travels]}, {FORCE[travels]}]'
    wall = f'"wall": {{{ends}}}, ' * len(toolkit.ends_on_walls)
    flats = ', "flats": %s' * (FLAT_PIN in toolkit.contacts)
    return (
        f'{{"type": "{arrangement.name}", {pushed}{wall}{RATIO[tips]}"pegs": [{pegs}], {POSE}{TRAVELLED[tips]}'
        f'"quality": {{{quality}}}{flats}}}'
    )


def peg_template(carrier: Carrier, travels: int) -> str:
    """What is written of a peg of a carrier, with its numbers left open; those of the place of a clamp come twice."""
    key, name = carrier.written_as
    contact = f'"x": %r, "y": %r, "segment": %d, "force": {FORCE[travels]}'
    if carrier.contact is not CLAMP_TIP:
        return f'"{key}": "{name}", "column": %d, "row": %d, {contact}'
    direction = f'"direction": "{carrier.direction}", ' * (travels > 1)
    hole = "[%d, %d]" if carrier.measure == "stroke" else f"null{LEFT_OUT}{LEFT_OUT}"
    line = f'{LEFT_OUT}"row": %d' if carrier.line == "row" else f'"column": %d{LEFT_OUT}'
    return f'"{key}": "{name}", {direction}"hole": {hole}, {line}, {contact}'


def fixture_lines(table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece) -> Iterator[list[str]]:
    """The lines of a list of fixtures, block by block."""
    figures = known_figures(table)
    templates = [fixture_template(one, toolkit, figures) for one in toolkit.arrangements]
    for told in blocks(table, toolkit, workpiece):
        rows = zip(*told.line_columns(), strict=True)
        yield [templates[k] % row for k, row in zip(told.table.arrangement.tolist(), rows, strict=True)]


def fixture_rows(
    table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece
) -> Iterator[tuple[list[int], Iterator[tuple[Any, ...]]]]:
    """Blocks of fixtures as plain numbers, rounded as they are written.

    Yields
    ------
    The indices of the arrangements, and for every fixture a tuple of numbers: for each peg column, row, x, y, face, force
    (of two clamps at their working ratio); then theta in degrees, x and y of the pose, jaw separation or the travel of each
    clamp; and after them the figures of :func:`known_figures`. Where pegs have flats, last a list: which way the flat of
    each looks that stands in a hole.
    """
    for told in blocks(table, toolkit, workpiece):
        yield told.table.arrangement.tolist(), zip(*told.row_columns(), strict=True)


def blocks(table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece) -> Iterator[Told]:
    """The fixtures of a table, rounded as they are written, block by block."""
    known = [FIGURES.index(figure) for figure in known_figures(table)]
    for start in range(0, len(table), BLOCK):
        block = table.take(slice(start, start + BLOCK))
        theta, told = as_told(block)
        x, y = (rounded(places, LENGTH_STEPS) for places in peg_places(told, toolkit, workpiece))
        yield Told(told, toolkit, workpiece, theta, x, y, known)


@frozen(eq=False)
class Told:
    """A block of N fixtures with their places as they are written.

    Parameters
    ----------
    table : of them, their poses and travels rounded.
    theta : (N,) orientations in degrees.
    x, y : (N, P) places of the contacts in mm.
    known : the numbers of the figures that are written.
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
        """The numbers of the contacts."""
        return range(self.toolkit.peg_count)

    @property
    def placed(self) -> list[int]:
        """The numbers of the contacts that are no ends of walls."""
        on_walls = [k for ends in self.toolkit.ends_on_walls for k in self.contacts[ends]]
        return [k for k in self.contacts if k not in on_walls]

    @property
    def pose(self) -> list[list[Any]]:
        """The columns of the poses."""
        return [array.tolist() for array in (self.theta, *self.table.position.T)]

    @property
    def flats(self) -> list[list[list[float | None]]]:
        """A column of the flats' angles in degrees, of all pegs in places of their own, where there are any."""
        if FLAT_PIN not in self.toolkit.contacts:
            return []
        angles, placed = flat_angles(self.table, self.toolkit, self.workpiece), self.placed
        return [[[row[k] for k in placed] for row in angles]]

    def row_columns(self) -> list[list[Any]]:
        """The columns of :func:`fixture_rows`."""
        table, columns = self.table, list[list[Any]]()
        for k in self.contacts:
            numbers = (table.column, table.row, self.x, self.y, table.face, table.working_force)
            columns += [array[:, k].tolist() for array in numbers]
        figures = [table.quality[:, number] for number in self.known]
        moved = [array.tolist() for array in (*np.atleast_2d(table.jaw_separation.T), *figures)]
        return [*columns, *self.pose, *moved, *self.flats]

    def line_columns(self) -> list[list[Any]]:
        """The columns of numbers in the order in which a line has them."""
        table, toolkit, tips = self.table, self.toolkit, self.toolkit.tips
        force, quality, ratio = table.force[:, :, None], table.quality, list[list[Any]]()
        if toolkit.travels > 1:
            force, quality = significant(table.force) + 0.0, significant(quality) + 0.0
            low, high = (significant(ends).tolist() for ends in ratios(force))
            ratio = [low, ["null" if isnan(end) else repr(end) for end in high]]
        walls, pegs = list[NDArray[Any]](), list[NDArray[Any]]()
        for ends in toolkit.ends_on_walls:
            several = self.contacts[ends]
            walls += [array[:, k] for k in several for array in (self.x, self.y)]
            walls += [table.face[:, k] for k in several]
            walls += [part for k in several for part in force[:, k].T]
        for k in self.placed:
            times = 2 if k >= len(self.contacts) - tips else 1
            pegs += [*[table.column[:, k], table.row[:, k]] * times, self.x[:, k], self.y[:, k], table.face[:, k]]
            pegs += [*force[:, k].T]
        travelled: dict[int, list[NDArray[Any]]] = {0: [table.jaw_separation], 1: [], 2: [table.pairs]}
        behind = [*travelled[tips], *(quality[:, number] for number in self.known)]
        before, middle, after = ([array.tolist() for array in several] for several in (walls, pegs, behind))
        flats = [[json.dumps(angles) for angles in column] for column in self.flats]
        return [*before, *ratio, *middle, *self.pose, *after, *flats]
