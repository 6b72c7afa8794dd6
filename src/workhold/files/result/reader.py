"""Reader of result files (MODEL, "Result file"), from workhold or any program that writes the form.

The head is checked by pydantic (``files.result.parts``), the fixtures by array operations. A file in columns
is mapped into memory, and its fixtures are checked when they are accessed. The first bytes of a file
determine its form, not its name. Messages count fixtures and pegs from 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np
from attrs import evolve, field, frozen
from numpy.typing import NDArray

from workhold.archive import is_archive
from workhold.conventions import AGREEMENT
from workhold.errors import InputError
from workhold.files.result.bending_forms import add_bendings, check_bending
from workhold.files.result.columns import read_columns
from workhold.files.result.fixture_forms import add_seatings, check_seating
from workhold.files.result.hold_text import is_friction_fixture
from workhold.files.result.holds import (
    AnyHoldPart,
    make_jaw_holds,
    make_table_of_holds,
    read_bendings_of_holds,
    read_holds,
)
from workhold.files.result.parts import (
    LARGEST_LENGTH,
    LARGEST_NUMBER,
    check_query,
    make_result_from_counts,
    read_parts,
    refuse_faulty,
    refuse_rows,
    refuse_unknown_types,
)
from workhold.fixels.carrier import WALL
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture_table import FixtureTable, compute_peg_places
from workhold.model.part_bending import BendingFigures
from workhold.model.pose import Pose
from workhold.model.quality import (
    BEFORE_PINS,
    FIGURES,
    JAW_FORCE_NEEDED,
    LOAD_REACTION,
    PROGRAM_FIGURE,
)
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.seating import Seating
from workhold.model.wall_ends import find_wall_ends

__all__ = ["FixtureArrays", "check_table", "collect_columns", "add_missing_figures", "read_result"]

BLOCK = 4096


@frozen
class FixtureArrays:
    """The fixtures of a file as arrays, N fixtures with P pegs.

    Parameters
    ----------
    types, jaws : (N,) names of the fixtures' types, and (N, P) names of the jaws or other carriers of their
        pegs.
    holes : (N, P, 3) column, row and face.
    contacts : (N, P, 4) x and y in mm, then the force on the contact per unit of the first clamp's force and
        of the second clamp's (0 without a second clamp).
    placing : (N, 5) theta in degrees, x and y in mm, jaw separation in mm and number of pairs.
    quality : (N, Q), Q figures of quality, the program clearance last; NaN where the file gives none.
    seating : seatings of the first fixtures, as the file gives them.
    bending : how far fixtures bend their part, by their index in the file.
    """

    types: NDArray[np.str_]
    jaws: NDArray[np.str_]
    holes: NDArray[np.int32]
    contacts: NDArray[np.float64]
    placing: NDArray[np.float64]
    quality: NDArray[np.float64]
    seating: tuple[Seating, ...] = ()
    bending: Mapping[int, BendingFigures] = field(factory=dict)


def read_result(path: str | Path) -> Result:
    """Return the result in a file in JSON or in columns.

    Parameters
    ----------
    path : path of the file, written by :func:`workhold.save`, by the command or by another program.

    Raises
    ------
    InputError
        When the file cannot be read, is not a result file, or contradicts itself.
    """
    path = Path(path)
    try:
        if is_archive(path):
            return read_columns(path)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}.") from error
    head, columns = read_parts(path, collect_any_fixtures)
    query = check_query(head, path)
    if isinstance(columns, list) != query.toolkit.holds_by_friction:
        if isinstance(columns, list) or len(columns.types):
            raise InputError(f"{path}: its fixtures are not those of a {query.toolkit.noun}.")
        columns = []
    if isinstance(columns, list):
        holds = make_jaw_holds(columns, query, path)
        made = make_result_from_counts(make_table_of_holds(columns, query.toolkit), head, query, path)
        bending = read_bendings_of_holds(columns, path)
        return add_bendings(evolve(made, holds=holds), bending, head.bent_by, path)
    result = make_result_from_counts(
        add_missing_figures(check_table(columns, query, path), query), head, query, path
    )
    result = add_seatings(result, columns.seating, path)
    return add_bendings(result, columns.bending, head.bent_by, path)


def collect_any_fixtures(fixtures: Iterable[Any], path: Path) -> FixtureArrays | list[AnyHoldPart]:
    """Return fixtures with pegs as arrays, or fixtures that hold by friction as a list in their checked form.

    The first fixture decides which they are.
    """
    iterator = iter(fixtures)
    first = list(islice(iterator, 1))
    together = chain(first, iterator)
    return (
        read_holds(together, path)
        if first and is_friction_fixture(first[0])
        else collect_columns(together, path)
    )


def collect_columns(fixtures: Iterable[Any], path: Path, first: int = 0) -> FixtureArrays:
    """Return fixtures with pegs, given as JSON objects, as arrays.

    Raises InputError for a fixture that lacks a key or has an impossible value; ``first`` is the index of the
    first one in the file, from 0, for messages.
    """
    blocks: list[list[NDArray[Any]]] = [[] for _ in range(6)]
    iterator = iter(fixtures)
    number, pegs, seating = first + 1, 0, list[Seating]()
    bending: dict[int, BendingFigures] = {}
    while True:
        rows = []
        for fixture in islice(iterator, BLOCK):
            try:
                rows.append(make_fixture_row(fixture))
            except KeyError as error:
                raise InputError(f"{path}: fixture {number} has no key {error}.") from error
            except (TypeError, ValueError, AttributeError) as error:
                raise InputError(f"{path}: fixture {number} cannot be used: {error}.") from error
            if "seating" in fixture:
                if len(seating) < number - 1:
                    raise InputError(
                        f"{path}: fixture {number} has its seating stated, but not the one before it."
                    )
                theta, x, y, *_ = rows[-1][4]
                seating.append(check_seating(fixture["seating"], Pose(theta, x, y), path, number))
            if fixture.get("bending") is not None:
                bending[number - 1] = check_bending(fixture["bending"], path, number)
            number += 1
        kinds = (np.str_, np.str_, np.int32, np.float64, np.float64, np.float64)
        pegs = pegs or (len(rows[0][1]) if rows else 4)
        if other := next((k for k, row in enumerate(rows) if len(row[1]) != pegs), None):
            wrong = number - len(rows) + other
            raise InputError(
                f"{path}: fixture {wrong} cannot be used: it does not have as many pegs as the first."
            )
        shapes = ((), (pegs,), (pegs, 3), (pegs, 4), (5,), (len(FIGURES) + 1,))
        for k, (kind, shape) in enumerate(zip(kinds, shapes, strict=True)):
            blocks[k].append(np.array([row[k] for row in rows], dtype=kind).reshape(len(rows), *shape))
        if len(rows) < BLOCK:
            types, jaws, holes, contacts, placing, quality = map(np.concatenate, blocks)
            return FixtureArrays(types, jaws, holes, contacts, placing, quality, tuple(seating), bending)


def make_fixture_row(
    fixture: Any,
) -> tuple[str, list[str], list[list[int]], list[list[float]], list[float], list[float]]:
    """Return the values of one fixture for the arrays of :class:`FixtureArrays`, in the order of its fields
    without ``seating``.

    Each value is the fixture's row in one of the arrays. Raises KeyError, TypeError, ValueError or
    AttributeError for a fixture that is not of the form.
    """
    name = fixture["type"]
    pegs, pose = fixture["pegs"], fixture["pose"]
    if "wall" in fixture and isinstance(pegs, list):
        pegs = read_wall_pegs(fixture["wall"]) + pegs
    directions = read_clamp_directions(fixture)
    several = len(directions) > 1
    if not isinstance(pegs, list) or len(pegs) != (5 if several else 4):
        raise ValueError(f"it does not have {'five' if several else 'four'} pegs")
    name = " ".join((name, *directions))
    jaws, holes = [], []
    for peg in pegs:
        carrier, column, row = read_peg_place(peg, peg.get("direction") if several else "".join(directions))
        jaws.append(carrier)
        holes.append([column, row, peg["segment"]])
    if not all(isinstance(word, str) for word in (fixture["type"], *jaws)):
        raise ValueError("its type or a peg's jaw is not text")
    forces = [[*peg["force"]] if several else [peg["force"], 0.0] for peg in pegs]
    if any(len(force) != 2 for force in forces):
        raise ValueError("a peg does not have a force for each clamp")
    contacts = [[peg["x"], peg["y"], *force] for peg, force in zip(pegs, forces, strict=True)]
    figures = fixture.get("quality", {})
    every = (*FIGURES, PROGRAM_FIGURE)
    known = [figures[figure.key] for figure in every if figure.key in figures]
    # The travel of a clamp follows from its place.
    travel = 0.0 if directions else fixture["jaw_separation"]
    placing = [pose["theta_deg"], pose["x"], pose["y"], travel, fixture.get("pairs", 1) if several else 1]
    if {type(value) for hole in holes for value in hole} != {int}:
        raise ValueError("a peg's column, row or segment is not a whole number")
    if any(not 0 <= value <= LARGEST_NUMBER for hole in holes for value in hole):
        raise ValueError("a peg's column, row or segment is negative or far too large")
    numbers = [value for contact in contacts for value in contact] + placing + known
    if not {type(value) for value in numbers} <= {int, float} or any(
        abs(value) > LARGEST_LENGTH for value in numbers
    ):
        raise ValueError("a length, an angle or a force is not a finite number")
    return name, jaws, holes, contacts, placing, [figures.get(figure.key, np.nan) for figure in every]


def read_clamp_directions(fixture: Any) -> list[str]:
    """Return the directions in which the clamps of a fixture push; [] for a fixture without clamps."""
    if fixture.get("directions") is not None:
        return [*fixture["directions"]]
    return [] if fixture.get("direction") is None else [str(fixture["direction"])]


def read_wall_pegs(wall: Any) -> list[Any]:
    """Return the two ends of the contact with a wall as JSON objects of pegs, with 0 for their faces.

    The faces follow from the pose later. Raises ValueError for a wall of another form.
    """
    places, forces = (wall["from"], wall["to"]), wall["forces"]
    if [len(values) for values in (*places, forces)] != [2, 2, 2]:
        raise ValueError("its wall does not have two places of two numbers and two forces")
    return [
        {"role": WALL, "x": x, "y": y, "segment": 0, "force": force}
        for (x, y), force in zip(places, forces, strict=True)
    ]


def read_peg_place(peg: Any, direction: Any) -> tuple[Any, Any, Any]:
    """Return (name of the carrier, column, row) of the hole in which a peg of a file stands.

    Column and row are 0 for a clamp without a hole that lacks them. ``direction`` is the direction in which
    the peg's clamp pushes.
    """
    if "role" not in peg:
        return peg["jaw"], peg["column"], peg["row"]
    if peg["role"] == WALL:
        return WALL, 0, 0
    if peg["role"] == "jaw":
        return "jaw", peg["column"], peg["row"]
    if peg["role"] == "locator":
        return "plate", peg["column"], peg["row"]
    if peg["role"] != "clamp":
        raise ValueError("the role of a peg is not locator, clamp or jaw")
    line = ("column", "row")["x" in str(direction)]
    if peg["hole"] is None:
        places = {"column": 0, "row": 0} | {line: peg[line]}
    else:
        column, row = peg["hole"]
        places = {"column": column, "row": row}
        if places[line] != peg[line]:
            raise ValueError(f"the {line} of its clamp is not that of its hole")
    return f"clamp {direction}", places["column"], places["row"]


def find_indices(words: NDArray[np.str_], names: Sequence[str]) -> NDArray[np.int8]:
    """Return the index of each word in ``names``; -1 for a word that is not in it."""
    out = np.full(words.shape, -1, np.int8)
    for index, name in enumerate(names):
        out[words == name] = index
    return out


def check_table(columns: FixtureArrays, query: Query, path: Path, first: int = 0) -> FixtureTable:
    """Return the table of the fixtures; the pegs of each are put into the order that its type has in the
    toolkit.

    Raises InputError for fixtures that contradict the query or themselves; ``first`` is the index of the
    first one in the file, from 0, for messages.
    """
    toolkit = query.toolkit
    if len(columns.types) == 0:
        return FixtureTable.make_empty(toolkit)
    if columns.jaws.shape[1] != toolkit.peg_count:
        raise InputError(
            f"{path}: its fixtures do not have the {toolkit.peg_count} pegs of the {toolkit.noun}."
        )
    arrangements, carriers = (
        [one.title for one in toolkit.arrangements],
        [one.name for one in toolkit.carriers],
    )
    arrangement, jaw = find_indices(columns.types, arrangements), find_indices(columns.jaws, carriers)
    order = np.argsort(jaw, axis=1, kind="stable")
    jaw = np.take_along_axis(jaw, order, axis=1)
    hole = np.take_along_axis(columns.holes, order[:, :, None], axis=1)
    contact = np.take_along_axis(columns.contacts, order[:, :, None], axis=1)
    column, row, face = (np.ascontiguousarray(hole[:, :, k]) for k in range(3))
    theta_deg, x, y, separation, pairs = columns.placing.T
    for ends in toolkit.ends_on_walls:
        face[:, ends] = find_faces_on_wall(query, np.radians(theta_deg), np.stack([x, y], axis=1), path)
    tips = range(toolkit.peg_count - toolkit.tip_count, toolkit.peg_count)
    strokes = [compute_clamp_travel(toolkit, jaw[:, k], hole[:, k], contact[:, k]) for k in tips]
    travels, force = strokes or [separation], contact[:, :, 2 : 2 + toolkit.travel_count]
    # With one thing that moves there is no axis for it.
    alone = ... if toolkit.travel_count > 1 else 0
    table = FixtureTable(
        arrangement=arrangement,
        column=column,
        row=row,
        face=face,
        theta=np.radians(theta_deg) % (2 * np.pi),
        position=np.stack([x, y], axis=1),
        jaw_separation=np.stack(travels, axis=1)[:, alone].copy(),
        force=np.ascontiguousarray(force[:, :, alone]),
        quality=columns.quality[:, find_asked_figures(query)],
        pairs=pairs.astype(np.int32),
    )

    rows = range(first, first + len(table))
    refuse = partial(refuse_rows, path=path, places=rows)
    refuse_unknown_types(arrangement, toolkit, path)
    refuse(jaw < 0, f"cannot be used: a peg's jaw is not {' or '.join(carriers)}")
    refuse(jaw != toolkit.find_peg_carriers(arrangement), "does not have the pegs of its type on each jaw")
    refuse_faulty(table, query, path, rows)
    hole_x, hole_y = compute_peg_places(table, toolkit, query.workpiece)
    apart = np.hypot(contact[:, :, 0] - hole_x, contact[:, :, 1] - hole_y) > AGREEMENT
    refuse(apart, "has a peg whose x, y are not those of its hole")
    return table


def find_faces_on_wall(
    query: Query, theta: NDArray[np.float64], position: NDArray[np.float64], path: Path
) -> NDArray[np.int64]:
    """Return the faces (N, 2) at the two ends of the contact with a wall.

    Poses are given by ``theta`` (N,) in radians and ``position`` (N, 2) in mm. Raises InputError if there are
    fixtures (N > 0) although the workpiece cannot lie flush on a wall.
    """
    workpiece = query.workpiece
    if len(theta) and len(workpiece.hull_edges) == 0:
        raise InputError(f"{path}: fixture 1 lies flush on a wall, which {workpiece.name} cannot.")
    return find_wall_ends(workpiece, query.toolkit, theta, position).face


def compute_clamp_travel(
    toolkit: Toolkit, numbers: NDArray[Any], hole: NDArray[np.int32], tip: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the travel (N,) in mm of clamps along their
    direction, from the centre of their hole to their tip.

    Parameters
    ----------
    numbers : (N,) index of each clamp's carrier.
    hole : (N, 2 or more) column and row.
    tip : (N, 2 or more) x and y in mm.
    """
    out = np.zeros(len(tip))
    for number, carrier in enumerate(toolkit.carriers):
        if carrier.travel is None:
            continue
        x, y = carrier.compute_hole_center(hole[:, 0], hole[:, 1])
        along, across = carrier.travel.unit
        out = np.where(numbers == number, (tip[:, 0] - x) * along + (tip[:, 1] - y) * across, out)
    return out


def find_asked_figures(query: Query) -> list[int]:
    """Return the indices of the figures that a query's fixtures have, among all figures.

    For their order see ``model.quality.list_figures_in_columns``.
    """
    known = len(FIGURES) if query.knows_heights else BEFORE_PINS
    return [*range(known), *([len(FIGURES)] if query.program is not None else [])]


def add_missing_figures(table: FixtureTable, query: Query) -> FixtureTable:
    """Return the table, with figures of quality computed where they are
    NaN because the file does not give them.
    """
    wanted = np.isnan(table.quality)
    if not query.is_loaded:
        wanted[:, [LOAD_REACTION, JAW_FORCE_NEEDED]] = False
    if not wanted.any():
        return table
    from workhold.statics.quality import measure_quality

    asked = query.tolerance, query.loads
    figures = measure_quality(
        table,
        query.workpiece,
        query.toolkit,
        *asked,
        jaw_force=query.jaw_force,
        passed=query.program_to_clear,
        pressed_top=query.pressed_top,
    )
    return evolve(table, quality=np.where(wanted, figures, table.quality))
