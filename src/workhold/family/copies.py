"""Several copies of one part on one plate, and their picture: a fixture repeated by whole columns and rows.

Two copies are clear of each other when their pegs and clamps do not overlap, and each part is a gap away from
the other part and from the other copy's pegs and clamps. This depends only on the columns and rows between
the copies. So a packing is a set of places no two of which are too near, and the largest is a maximum
independent set. HiGHS finds it. Each set of places that are pairwise too near is a constraint: it holds one
copy at most.

The picture shows every hole of the plate, and every copy with its pegs and clamps.

Glossary
--------
shift : whole columns and rows by which a copy is moved from the repeated fixture.
too near : a shift is too near when two copies that far apart are not clear of each other.
"""

from __future__ import annotations

from functools import reduce
from itertools import combinations, pairwise
from math import acos, ceil, floor, pi

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import GAP_SLACK
from workhold.drawing.annotation import draw_scale_bar
from workhold.drawing.bench import draw_part, draw_pegs, make_bench
from workhold.drawing.carriers import STILL, choose_labelled, draw_clamp, draw_push, draw_wall
from workhold.drawing.scene import GREY, LANDSCAPE, PORTRAIT, Box, LengthUnit, Scene, View, shorten_text
from workhold.errors import InputError
from workhold.family.patterns import shift_fixture
from workhold.family.solver import ROUNDING, find_best_choice, load_solver
from workhold.fixels.carrier import Carrier, make_column_letters
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Line
from workhold.model.clamps import list_shown_clamps
from workhold.model.fixture import Fixture
from workhold.model.fixture_table import FixtureTable, make_fixture_of_row
from workhold.model.workpiece import Workpiece
from workhold.units import MILLIMETRE, Unit

__all__ = ["PackedCopies", "make_copies", "draw_copies", "pack_copies", "find_too_near_shifts"]

Array = NDArray[np.float64]
Shift = tuple[int, int]

# Outlines are looked at as chords no farther than this from them, in mm; that much is added to the gap on
# either side.
SAGITTA = 1e-3
# More places than this are packed without a proof.
MOST_PLACES = 4000


@frozen
class PackedCopies:
    """Copies of a fixture on a plate.

    Parameters
    ----------
    shifts : (columns, rows) by which each copy is moved, from the lowest row up, from left to right.
    at_most : proven upper bound of the number of copies that the plate holds.
    """

    shifts: tuple[Shift, ...]
    at_most: int


@frozen(eq=False)
class CopyOutlines:
    """The space that one copy takes up, in mm in the plate's frame.

    Parameters
    ----------
    outline : (S, 2, 2) start and end points of the S chords of the part's outline.
    cores : (B, 2, 2) ends of the axes of the B bodies: from a clamp's hole to its tip; equal for a locator.
    radius : (B,) of the bodies.
    """

    outline: Array
    cores: Array
    radius: Array


def collect_bodies(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> CopyOutlines:
    """Return the space that a fixture takes up; arcs are replaced by chords at most ``SAGITTA`` mm away."""
    chords = []
    for loop in workpiece.loop_segments:
        for segment in loop:
            placed = fixture.pose.carry(segment)
            count = 1
            if not isinstance(placed, Line):
                turn = 2 * acos(max(1.0 - SAGITTA / placed.radius, -1.0))
                count = max(1, ceil(2 * placed.half_sweep / max(turn, pi / 720)))
            ends = [placed.compute_point(placed.half_extent * (2 * k / count - 1)) for k in range(count + 1)]
            chords += list(pairwise(ends))
    locators = [peg for peg in fixture.pegs if toolkit.find_carrier(peg.carrier).has_lattice]
    clamps = list(list_shown_clamps(fixture, toolkit))
    cores = [((peg.x, peg.y), (peg.x, peg.y)) for peg in locators]
    cores += [(clamp.back, (clamp.tip.x, clamp.tip.y)) for clamp in clamps]
    radius = [toolkit.find_carrier(peg.carrier).body_radius for peg in locators]
    radius += [clamp.carrier.peg_radius for clamp in clamps]
    return CopyOutlines(np.array(chords), np.array(cores), np.array(radius))


def measure_distances(one: Array, other: Array) -> Array:
    """Return the distances (N, M) of N straight segments from M others; 0 where two cross.

    ``one`` is (N, 2, 2) and ``other`` (M, 2, 2), each segment a pair of points.
    """

    def from_ends(ends: Array, pieces: Array) -> Array:
        """Return the distances (N, M) of points (N, 2) from segments (M, 2, 2)."""
        start, way = pieces[None, :, 0], (pieces[:, 1] - pieces[:, 0])[None]
        off = ends[:, None] - start
        length = (way**2).sum(axis=2)
        share = np.clip((off * way).sum(axis=2) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
        return np.asarray(np.hypot(*np.moveaxis(off - share[:, :, None] * way, 2, 0)))

    def find_side(pieces: Array, points: Array) -> Array:
        """Return (N, M) on which side of N lines M points lie: 1 left, -1 right, 0 on the line.

        ``pieces`` (N, 2, 2) are two points of each line, ``points`` is (M, 2).
        """
        way, off = (pieces[:, 1] - pieces[:, 0])[:, None], points[None] - pieces[:, 0][:, None]
        return np.asarray(np.sign(way[:, :, 0] * off[:, :, 1] - way[:, :, 1] * off[:, :, 0]))

    near = np.minimum(from_ends(one[:, 0], other), from_ends(one[:, 1], other))
    near = np.minimum(near, np.minimum(from_ends(other[:, 0], one), from_ends(other[:, 1], one)).T)
    crossing = find_side(one, other[:, 0]) * find_side(one, other[:, 1]) < 0
    crossing &= (find_side(other, one[:, 0]) * find_side(other, one[:, 1]) < 0).T
    return np.where(crossing, 0.0, near)


def is_clear(bodies: CopyOutlines, move: Array, gap: float) -> bool:
    """Return whether two copies, the second one moved by ``move`` (2,) in mm, keep clear of each other.

    Bodies (pegs and clamps) must not overlap. The part of each copy must be ``gap`` mm from the part and the
    bodies of the other copy. Comparing boundaries is enough: no copy fits inside another, so overlapping
    copies have outlines that cross.
    """
    outline, cores = bodies.outline + move, bodies.cores + move
    slack = GAP_SLACK
    both = bodies.radius[:, None] + bodies.radius
    if (measure_distances(bodies.cores, cores) < both - slack).any():
        return False
    reach = bodies.radius[:, None] + gap + SAGITTA - slack
    for some, around in ((bodies.cores, outline), (cores, bodies.outline)):
        if (measure_distances(some, around) < reach).any():
            return False
    return not (measure_distances(bodies.outline, outline) < gap + 2 * SAGITTA - slack).any()


def find_too_near_shifts(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, gap: float, spread: Shift
) -> set[Shift]:
    """Return all shifts (columns, rows) at which two copies are not clear, up to ``spread`` in each
    direction.

    The set contains (0, 0), and with each shift its negative. ``gap`` is in mm.
    """
    bodies, pitch = collect_bodies(fixture, workpiece, toolkit), np.array(toolkit.carriers[0].pitch)
    points = np.concatenate([bodies.outline.reshape(-1, 2), bodies.cores.reshape(-1, 2)])
    reach = np.ptp(points, axis=0) + 2 * bodies.radius.max() + gap + 2 * SAGITTA
    out = {(0, 0)}
    across, along = (
        min(most, floor(far / step)) for most, far, step in zip(spread, reach, pitch, strict=True)
    )
    for columns in range(across + 1):
        for rows in range(-along if columns else 1, along + 1):
            if not is_clear(bodies, np.array([columns, rows]) * pitch, gap):
                out |= {(columns, rows), (-columns, -rows)}
    return out


def list_places_on_plate(fixture: Fixture, toolkit: Toolkit, columns: int, rows: int) -> list[Shift]:
    """Return the shifts (columns, rows) at which a fixture fits on a plate of this size, row by row.

    ``columns`` and ``rows`` are the numbers of the plate's holes.

    Raises
    ------
    InputError
        For a plate that is too small for the fixture.
    """
    used_columns, used_rows = [], []
    for peg in fixture.pegs:
        in_column, in_row = toolkit.find_carrier(peg.carrier).counted_axes
        used_columns += [peg.column] * in_column
        used_rows += [peg.row] * in_row
    if max(used_columns) - min(used_columns) >= columns or max(used_rows) - min(used_rows) >= rows:
        raise InputError(
            f"a plate of {columns} × {rows} holes does not hold this fixture once: it takes "
            f"{max(used_columns) - min(used_columns) + 1} columns and {max(used_rows) - min(used_rows) + 1} "
            "rows."
        )
    upward = range(1) if toolkit.datum.fixes_rows else range(-min(used_rows), rows - max(used_rows))
    return [(i, j) for j in upward for i in range(-min(used_columns), columns - max(used_columns))]


def pack_copies(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    columns: int,
    rows: int,
    gap: float = 1.0,
    seconds: float | None = None,
) -> PackedCopies:
    """Return the largest number of copies of a fixture that a plate holds, with their shifts.

    A plate with more than ``MOST_PLACES`` places is packed greedily, without a proof.

    Parameters
    ----------
    columns, rows : numbers of the plate's holes.
    gap : smallest distance in mm between a part and anything of another copy.
    seconds : time limit, after which the best packing found so far is returned; None runs until it is proven.

    Raises
    ------
    InputError
        For a vise, whose single jaw cannot press several parts equally, for a plate that holds no copy, and
        when SciPy is not installed.
    """
    if toolkit.strap_set is not None:
        raise InputError(
            "copies are not set up with straps: take a plate with clamps or a fence, or set up one part at a time."
        )
    if toolkit.flat_jaws is not None or len(toolkit.plates) > 1:
        raise InputError(
            f"a {toolkit.noun} holds one part: its {toolkit.moving.noun} presses several copies unlike; take "
            "a plate or a fence."
        )
    places = list_places_on_plate(fixture, toolkit, columns, rows)
    spread = (
        max(i for i, _ in places) - min(i for i, _ in places),
        max(j for _, j in places) - min(j for _, j in places),
    )
    near = find_too_near_shifts(fixture, workpiece, toolkit, gap, spread)
    known = max((place_first_fit(order, near) for order in (places, sorted(places))), key=len)
    if len(places) > MOST_PLACES:
        return PackedCopies(sort_by_rows(known), len(places))
    load_solver()
    return solve_packing(places, near, known, seconds)


def place_first_fit(places: list[Shift], near: set[Shift]) -> list[Shift]:
    """Return a greedy packing: go through the places in order and take each that is not too near to one
    already taken.

    ``near`` are the shifts that are too near.
    """
    taken: list[Shift] = []
    for i, j in places:
        if all((i - a, j - b) not in near for a, b in taken):
            taken.append((i, j))
    return taken


def sort_by_rows(places: list[Shift]) -> tuple[Shift, ...]:
    """Return the places (column, row) sorted from the lowest row up, and from left to right."""
    return tuple(sorted(places, key=lambda place: (place[1], place[0])))


def find_conflict_sets(near: set[Shift]) -> list[list[Shift]]:
    """Return sets of shifts, each a list that begins with (0, 0), whose members are pairwise too near.

    Every shift in ``near`` is the difference of two members of some set.
    """
    left, out = near - {(0, 0)}, []
    ordered = sorted(left, key=lambda shift: (abs(shift[0]) + abs(shift[1]), shift))
    for one in ordered:
        if one not in left:
            continue
        crowd = [(0, 0), one]
        for i, j in ordered:
            if all((i - a, j - b) in near for a, b in crowd) and (i, j) not in crowd:
                crowd.append((i, j))
        for (a, b), (c, d) in combinations(crowd, 2):
            left -= {(a - c, b - d), (c - a, d - b)}
        out.append(crowd)
    return out


def solve_packing(
    places: list[Shift], near: set[Shift], known: list[Shift], seconds: float | None
) -> PackedCopies:
    """Return the largest set of places no two of which are too near, found by integer programming.

    ``near`` are the shifts that are too near, ``known`` a packing that is returned if no better one is found,
    and ``seconds`` the time limit (None: until proven).
    """
    from scipy.optimize import LinearConstraint
    from scipy.sparse import csr_array

    number = {place: k for k, place in enumerate(places)}
    rows = set()
    for crowd in find_conflict_sets(near):
        for i, j in places:
            for a, b in crowd:
                # Every crowd in which this place is any of the members.
                members = tuple(
                    sorted(number[m] for m in ((i - a + c, j - b + d) for c, d in crowd) if m in number)
                )
                if len(members) > 1:
                    rows.add(members)
    if not rows:
        return PackedCopies(sort_by_rows(places), len(places))
    ordered = sorted(rows)
    index = np.concatenate([[0], np.cumsum([len(members) for members in ordered])])
    inside = np.concatenate([np.array(members) for members in ordered])
    matrix = csr_array((np.ones(len(inside)), inside, index), shape=(len(ordered), len(places)))
    count = len(places)
    found, bound = find_best_choice(-np.ones(count), LinearConstraint(matrix, ub=1.0), seconds)
    chosen = known if found is None else [places[k] for k in found]
    is_packing = all((a - c, b - d) not in near for (a, b), (c, d) in combinations(chosen, 2))
    if len(chosen) < len(known) or not is_packing:
        chosen = known
    at_most = count if bound is None else floor(-bound + ROUNDING)
    return PackedCopies(sort_by_rows(chosen), max(at_most, len(chosen)))


EDGE, HEADER, FOOTER, NAMES = 32.0, 74.0, 34.0, 34.0
# Factor on line widths.
WEIGHT = 0.6


def make_copies(
    row: FixtureTable, toolkit: Toolkit, workpiece: Workpiece, packing: PackedCopies
) -> list[Fixture]:
    """Return the copies of a fixture (a table of one row) at all shifts of a packing."""
    moved = (shift_fixture(row, toolkit, {0: columns}, rows) for columns, rows in packing.shifts)
    return [make_fixture_of_row(one, toolkit, 0, workpiece) for one in moved]


def draw_copies(
    copies: list[Fixture],
    workpiece: Workpiece,
    toolkit: Toolkit,
    size: tuple[int, int],
    *,
    unit: Unit = MILLIMETRE,
) -> str:
    """Return copies on a plate of ``size`` (columns, rows), drawn on A4, as SVG text."""
    plate, (columns, rows) = toolkit.carriers[0], size
    benches = [make_bench(fixture, workpiece, toolkit) for fixture in copies]
    holes = Box(*plate.compute_hole_center(0, 0), *plate.compute_hole_center(columns - 1, rows - 1)).grow(
        max(plate.pitch) / 2
    )
    clamps = [clamp.room for bench in benches for clamp in bench.shown.clamps]
    extent = reduce(Box.unite, [*(bench.shown.part for bench in benches), *clamps], holes)
    walls = [Box(holes.x0, wall.bar.y0, holes.x1, wall.bar.y1) for wall in benches[0].shown.walls]
    extent = reduce(Box.unite, walls, extent)
    page = LANDSCAPE if extent.width >= 0.8 * extent.height else PORTRAIT
    count = "1 copy" if len(copies) == 1 else f"{len(copies)} copies"
    heading = shorten_text(f"{workpiece.name}: {count}", 26, page[0] - 2 * EDGE, bold=True)
    scene = Scene.make_page(page, heading)
    scene.add_text((EDGE, EDGE + 12), heading, 26, bold=True)
    scene.add_text(
        (EDGE, EDGE + 42), f"On a plate of {columns} columns and {rows} rows of holes.", 15, fill=GREY
    )
    view = View.fit_box(
        extent, Box(EDGE + NAMES, EDGE + HEADER, page[0] - EDGE, page[1] - EDGE - FOOTER - NAMES)
    )
    draw_whole_plate(scene, holes, plate, size, view)
    for wall in walls:
        draw_wall(scene.group("wall"), wall, view)
    for number, bench in enumerate(benches, 1):
        group = scene.group("copy")
        for clamp in bench.shown.clamps:
            draw_clamp(group, clamp, bench.shown.carriers[0], view, WEIGHT)
        draw_part(group, bench, view, WEIGHT)
        for clamp in bench.shown.clamps:
            draw_push(group, clamp, view, WEIGHT)
        draw_pegs(group, bench, view, WEIGHT)
        group.add_text(
            view(bench.fixture.pose.apply(*workpiece.center)), str(number), 16, "middle", bold=True, halo=3
        )
    draw_scale_bar(
        scene, (EDGE, page[1] - EDGE), view.scale, LengthUnit.from_typical_length(unit, min(plate.pitch))
    )
    return scene.to_svg()


def draw_whole_plate(scene: Scene, holes: Box, plate: Carrier, size: tuple[int, int], view: View) -> None:
    """Draw the plate with all its holes and their column letters and row numbers."""
    box, (columns, rows) = view.map_box(holes), size
    fill, edge = STILL
    scene.group("plate").add_rectangle(box, fill, edge, 2.0)
    group = scene.group("holes")
    radius = max(
        0.28 * min(plate.pitch) * view.scale if plate.peg_radius == 0 else plate.peg_radius * view.scale, 0.5
    )
    for column in range(columns):
        for row in range(rows):
            group.add_circle(
                view(plate.compute_hole_center(column, row)), radius, "#ffffff", GREY, min(0.7, 0.3 * radius)
            )
    names = scene.group("hole-names")
    across = [(column, view(plate.compute_hole_center(column, 0))[0]) for column in range(columns)]
    along = [(row, view(plate.compute_hole_center(0, row))[1]) for row in range(rows)]
    for column, x, _ in choose_labelled(across, set(), 22.0):
        names.add_text((x, box.y1 + 14), make_column_letters(column), 12, "middle", fill=GREY)
    for row, y, _ in choose_labelled(along, set(), 15.0):
        names.add_text((box.x0 - 8, y), str(row + 1), 12, "end", fill=GREY)
