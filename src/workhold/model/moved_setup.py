"""The place of a set-up on the shop's plate, in the middle or at a chosen hole, and the overhang of the part.

A fixture is listed in the lowest columns and rows. Part, pegs and clamps may all be moved by the same number
of columns and rows. If the plate's columns and rows are known, sheet and page show the set-up in the middle
of the plate. Jaws of a vise keep their columns, which are those nearest to the opening; beside a wall the
rows are kept. Beside a flat jaw with ends, the listed columns are those in which the jaw holds best.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from math import inf

from attrs import evolve, frozen

from workhold.conventions import AGREEMENT
from workhold.errors import InputError, join_words
from workhold.fixels.carrier import make_column_letters
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Box
from workhold.model.clamps import list_shown_clamps
from workhold.model.fixture import Fixture, Peg
from workhold.model.shown import bound_held_part, bound_placed_part
from workhold.model.workpiece import Workpiece

__all__ = [
    "Overhang",
    "shift_hole_numbers",
    "find_move_to_middle",
    "move_to",
    "move_fixture_by_holes",
    "describe_overhang",
    "find_overhangs",
    "count_spare_holes",
]

Hole = tuple[int, int]
NAME = re.compile(r"(?:[A-Z]-)?([A-Z]{1,3})([1-9][0-9]{0,5})")
REMEDY = "give a column letter and a row of the plate, such as D4"


def shift_hole_numbers(
    fixture: Fixture,
    toolkit: Toolkit,
    move: tuple[float, float],
    shifts: Mapping[str, Hole],
    travel: float,
) -> Fixture:
    """Return a fixture whose part and pegs are moved by ``move`` and whose holes have new numbers.

    Parameters
    ----------
    move : translation (x, y) in mm.
    shifts : by the name of a plate, the columns and rows to add to the holes on it.
    travel : travel in mm of the moved fixture, without the component of ``move`` along a clamp's travel,
        which is added if a clamp is measured from the first column or row.
    """
    dx, dy = move

    def move_peg(peg: Peg) -> Peg:
        """Return the peg moved, with its hole (and name of place) numbered anew."""
        carrier = toolkit.find_carrier(peg.carrier)
        if not carrier.contact.is_placed:
            return evolve(peg, x=peg.x + dx, y=peg.y + dy)
        by = shifts[carrier.stands_on]
        in_column, in_row = carrier.counted_axes
        column, row = peg.column + in_column * by[0], peg.row + in_row * by[1]
        place = None if peg.place is None else carrier.name_place(column, row)
        return evolve(peg, column=column, row=row, x=peg.x + dx, y=peg.y + dy, place=place)

    pose = evolve(fixture.pose, x=fixture.pose.x + dx, y=fixture.pose.y + dy)
    # A clamp of which only the line is known is measured from the first column or row.
    ahead = [
        0.0
        if all(carrier.counted_axes) or carrier.travel is None
        else dx * carrier.travel.unit[0] + dy * carrier.travel.unit[1]
        for carrier in (toolkit.find_carrier(peg.carrier) for peg in fixture.pegs)
        if carrier.on is not None
    ]
    before = fixture.travels
    ends = ahead or [0.0]
    pair = fixture.pair and evolve(fixture.pair, travels=(before[0] + ends[0], before[-1] + ends[-1]))
    own = travel + (ahead[0] if ahead else 0.0)
    return evolve(fixture, pegs=tuple(map(move_peg, fixture.pegs)), pose=pose, travel=own, pair=pair)


def find_used_columns_and_rows(fixture: Fixture, toolkit: Toolkit) -> tuple[list[int], list[int]]:
    """Return (columns, rows), numbers from 0, of the holes of pegs and clamps.

    A number that denotes no hole is left out: the one along a clamp's line, where the place of its tip is
    measured.
    """
    counted = [(peg, toolkit.find_carrier(peg.carrier).counted_axes) for peg in fixture.pegs]
    return (
        [peg.column for peg, (in_column, _) in counted if in_column],
        [peg.row for peg, (_, in_row) in counted if in_row],
    )


def count_spare_holes(
    fixture: Fixture, toolkit: Toolkit
) -> tuple[tuple[int, int | None], tuple[int, int | None]]:
    """Return ((left, right), (down, up)): the numbers of columns and rows by which a set-up may be moved in
    each direction.

    None for any number, if the plate has no end; 0 for a direction in which the set-up must not be moved.
    """
    if toolkit.strap_set is not None:
        # Bolts and tips have their places beside the locators' as they are listed.
        return (0, 0), (0, 0)
    plate = toolkit.plates[0]
    along, across = (
        (min(used), None if count is None else count - 1 - max(used))
        for used, count in zip(
            find_used_columns_and_rows(fixture, toolkit), (plate.columns, plate.rows), strict=True
        )
    )
    # Jaws hold in the columns nearest to the opening, and a jaw with ends where it reaches the part best.
    if len(toolkit.plates) > 1 or toolkit.wall_with_ends is not None:
        along = 0, 0
    return along, (0, 0) if toolkit.datum.fixes_rows else across


def find_move_to_middle(fixture: Fixture, toolkit: Toolkit, workpiece: Workpiece) -> Hole:
    """Return (columns, rows) by which to move a set-up so that it stands in the middle of its plate.

    The middle of the bounding box of part, pegs and clamps comes as near to the plate's middle as holes
    allow; of two equally near places the lower one is taken. A number is 0 if the plate has no end in that
    direction or :func:`count_spare_holes` allows no move, as for the columns of two jaws.
    """
    if not toolkit.plates:
        return 0, 0
    plate = toolkit.plates[0]
    held = bound_held_part(
        bound_placed_part(workpiece, fixture.pose), fixture, tuple(list_shown_clamps(fixture, toolkit))
    )
    centers = (held.x0 + held.x1) / 2, (held.y0 + held.y1) / 2
    found = []
    for center, (back, ahead), count, pitch, first in zip(
        centers,
        count_spare_holes(fixture, toolkit),
        (plate.columns, plate.rows),
        plate.pitch,
        plate.offset,
        strict=True,
    ):
        if count is None or ahead is None or len(toolkit.plates) > 1:
            found.append(0)
            continue
        off = center - first - (count - 1) * pitch / 2
        steps = range(-back, ahead + 1)
        # The nearest miss of a part that finds no fixture may stand in holes that the plate does not have.
        found.append(min(steps, key=lambda step: (round(abs(off + step * pitch), 6), step), default=0))
    return found[0], found[1]


def move_to(fixture: Fixture, toolkit: Toolkit, name: str) -> Hole:
    """Return (columns, rows) by which to move a set-up so that its lowest column and row are those of a named
    hole.

    A direction in which the set-up must not be moved has 0, whatever the hole.

    Parameters
    ----------
    name : name of the hole to which the set-up's lowest column and lowest row are moved, such as "D4".

    Raises
    ------
    InputError
        For text that names no hole, and for an impossible place of the set-up.
    """
    if not toolkit.plates:
        raise InputError(f"a {toolkit.noun} has no holes to stand at: a work stop says where the part lies.")
    match = NAME.fullmatch(name.strip().upper())
    if match is None:
        raise InputError(f"{name[:40]!r} names no hole to stand at: {REMEDY}.")
    column = 0
    for letter in match[1]:
        column = 26 * column + ord(letter) - ord("A") + 1
    wanted, lowest = (
        (column - 1, int(match[2]) - 1),
        [*map(min, find_used_columns_and_rows(fixture, toolkit))],
    )
    if toolkit.datum.fixes_rows:
        # Rows beside a wall, or of a jaw that slides toward one, are where they are.
        wanted = wanted[0], lowest[1]
    if len(toolkit.plates) > 1:
        # So are the columns of two jaws, nearest to the opening.
        wanted = lowest[0], wanted[1]
    move = wanted[0] - lowest[0], wanted[1] - lowest[1]
    for number, (steps, (back, ahead), noun) in enumerate(
        zip(move, count_spare_holes(fixture, toolkit), ("column", "row"), strict=True)
    ):
        if not -back <= steps <= (inf if ahead is None else ahead):
            least = lowest[number] - back
            most = None if ahead is None else lowest[number] + ahead
            named = make_row_name if number else make_column_letters
            may = named(least)
            if most is None:
                may += " or farther"
            elif most > least:
                may = f"one of {may} to {named(most)}"
            raise InputError(
                f"the set-up cannot stand at {name.strip()[:40]}: its lowest {noun} can be {may}; {REMEDY}."
            )
    for peg in move_fixture_by_holes(fixture, toolkit, move).pegs:
        if toolkit.find_carrier(peg.carrier).is_blocked(peg.column, peg.row):
            raise InputError(
                f"the set-up cannot stand at {name.strip()[:40]}: hole {peg.hole} is blocked; {REMEDY}."
            )
    return move


def make_row_name(row: int) -> str:
    """Return the name of a row of holes whose number counts from 0: "1" for 0."""
    return str(row + 1)


def move_fixture_by_holes(fixture: Fixture, toolkit: Toolkit, move: Hole) -> Fixture:
    """Return a fixture moved by (columns, rows), in pitches of the toolkit's first plate."""
    if move == (0, 0):
        return fixture
    pitch = toolkit.plates[0].pitch
    by, shifts = (move[0] * pitch[0], move[1] * pitch[1]), {plate.name: move for plate in toolkit.plates}
    return shift_hole_numbers(fixture, toolkit, by, shifts, fixture.travel)


@frozen
class Overhang:
    """A side over which the part hangs.

    Parameters
    ----------
    side : "left", "right", "lower" or "upper".
    length : length of the overhang in mm.
    """

    side: str
    length: float


def find_overhangs(fixture: Fixture, toolkit: Toolkit, workpiece: Workpiece) -> Iterator[Overhang]:
    """Yield the sides over which the part hangs, in the order left, right, lower, upper.

    The edges are those of a wall with ends or of flat jaws, else of the plates, half a pitch beyond the last
    holes.
    """
    part, wall = bound_placed_part(workpiece, fixture.pose), toolkit.wall_with_ends
    jaws = toolkit.flat_jaws
    edge = bound_plates(fixture, toolkit) if jaws is None else Box(0.0, -inf, jaws.width, inf)
    if wall is not None and wall.reach is not None:
        edge = Box(wall.reach[0], -inf, wall.reach[1], inf)
    sides = {
        "left": edge.x0 - part.x0,
        "right": part.x1 - edge.x1,
        "lower": edge.y0 - part.y0,
        "upper": part.y1 - edge.y1,
    }
    yield from (Overhang(side, length) for side, length in sides.items() if length > AGREEMENT)


# What the sides of a plate are called after "at the".
SIDES = {"left": "left", "right": "right", "lower": "lower side", "upper": "upper side"}


def describe_overhang(
    fixture: Fixture, toolkit: Toolkit, workpiece: Workpiece, text: Callable[[float], str]
) -> str:
    """Return a sentence on how far the part hangs over the plates or stands out beyond a jaw; "" if it does
    neither.

    Parameters
    ----------
    text : function that formats a length in mm.
    """
    found, wall = list(find_overhangs(fixture, toolkit, workpiece)), toolkit.wall_with_ends
    if not found:
        return ""
    sides = join_words([f"{text(one.length)} at the {SIDES[one.side]}" for one in found])
    if wall is not None or toolkit.flat_jaws is not None:
        return f"The part stands out beyond the {'jaws' if wall is None else wall.noun}: {sides}."
    nouns = join_words([plate.title for plate in toolkit.plates])
    edges = "edge is" if len(toolkit.plates) == 1 else "edges are"
    return f"The part hangs over the {nouns}: {sides} (the {edges} taken half a pitch beyond the last holes)."


def bound_plates(fixture: Fixture, toolkit: Toolkit) -> Box:
    """Return the box in mm around all plates, which reach half a pitch beyond their outermost holes.

    The bounds are ±inf along an axis on which a plate has no end.
    """
    boxes = []
    for plate in toolkit.plates:
        travelled = 0.0 if plate.travel is None else fixture.travel
        (x0, y0), half_x, half_y = (
            plate.compute_hole_center(0, 0, travelled),
            plate.pitch[0] / 2,
            plate.pitch[1] / 2,
        )
        right = inf if plate.columns is None else x0 + (2 * plate.columns - 1) * half_x
        upper = inf if plate.rows is None else y0 + (2 * plate.rows - 1) * half_y
        left, lower = (
            -inf if end == inf else first for end, first in ((right, x0 - half_x), (upper, y0 - half_y))
        )
        # What counts from a wall goes on below its first row, and a plate that slides leaves the rows open.
        is_open = toolkit.datum.fixes_rows
        boxes.append(Box(left, -inf if is_open else lower, right, inf if is_open and plate.travel else upper))
    box = boxes[0]
    for other in boxes[1:]:
        box = box.unite(other)
    return box
