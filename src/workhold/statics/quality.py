"""Figures of quality of whole tables of fixtures (model: "Quality"; see docs/quality.md).

Glossary
--------
main direction : the direction, in degrees in [0, 90), with the greatest total length of straight faces;
    directions a quarter turn apart count as one. Its exact value is that of the longest of these faces, or
    the first of equally long ones. It is the drawing's own x if no face is straight or another direction has
    about the same length.
tilt : angle between the main direction and the nearest of the directions of the jaws, x and y.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from math import cos, pi

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold.conventions import FIGURE_DECIMALS, MAIN_DIRECTION, SQUARE_TILT
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.hull import compute_convex_hull
from workhold.geometry.segment import Arc, Line
from workhold.kernels.contact.clamp_pairs import CLAMP_LENGTH, PUSH, write_closures
from workhold.kernels.contact.quality import LOAD_LENGTH, write_figures
from workhold.model.fixture import Fixture
from workhold.model.fixture_table import FixtureTable, compute_peg_places, make_fixture_of_row
from workhold.model.program import Program
from workhold.model.quality import (
    BEFORE_PINS,
    CLAMP_FREEDOM,
    CLOSURE_MARGIN,
    FIGURES,
    JAW_CONTACT,
    JAW_FORCE_NEEDED,
    LOAD_REACTION,
    PENALTY,
    PIN_FIGURES,
    PROGRAM_CLEARANCE,
    SMALLEST_FACE,
    TILT,
    WARNINGS,
)
from workhold.model.requirements import Load, Tolerance
from workhold.model.result import Result
from workhold.model.wall_ends import find_wall_ends
from workhold.model.workpiece import Workpiece
from workhold.rowwise import find_smallest
from workhold.statics.contact_matrix import ContactMatrices, TouchableFeatures
from workhold.statics.judging import JudgingLimits
from workhold.statics.loads import compute_needed_jaw_forces
from workhold.statics.pins import PinRuns, compute_bent_pins
from workhold.statics.program_clearance import find_nearest_moves
from workhold.statics.program_forces import compute_cutting_figures

__all__ = [
    "find_silhouette_extremes",
    "measure_faces",
    "make_load_rows",
    "find_main_direction",
    "measure_fixture",
    "measure_quality",
    "compute_tilts",
]

Array = NDArray[np.float64]


def find_main_direction(workpiece: Workpiece) -> float:
    """Return the main direction of a part in degrees in [0, 90), in the frame of its drawing; 0.0 if it has
    none.
    """
    lines = [face.segment for face in workpiece.faces if isinstance(face.segment, Line)]
    if not lines:
        return 0.0
    ends = np.array([(*line.start, *line.end) for line in lines])
    along = ends[:, 2:] - ends[:, :2]
    angle, length = np.degrees(np.arctan2(along[:, 1], along[:, 0])) % 90.0, np.hypot(*along.T)
    order = np.argsort(angle)
    # Once more a quarter turn below and above, so that 0 and 90 degrees are neighbours.
    around = np.concatenate([angle[order] + turn for turn in (-90.0, 0.0, 90.0)])
    sums = np.concatenate([[0.0], np.cumsum(np.tile(length[order], 3))])
    low, high = np.searchsorted(around, angle - SQUARE_TILT), np.searchsorted(around, angle + SQUARE_TILT)
    total = sums[high] - sums[low]
    rivals = total >= MAIN_DIRECTION * total.max()
    chosen = angle[rivals][np.round(length[rivals], FIGURE_DECIMALS).argmax()]
    alone = (np.abs((angle[rivals] - chosen + 45.0) % 90.0 - 45.0) < 2 * SQUARE_TILT).all()
    return float(chosen) if alone else 0.0


def compute_tilts(theta: Array, direction: float) -> Array:
    """Return the tilts in degrees, 0 to 45, of a part turned by angles ``theta`` (N,) in radians, (N,).

    ``direction`` is the part's main direction in degrees. Tilts below ``SQUARE_TILT`` are 0.
    """
    off = np.abs((np.degrees(theta) + direction + 45.0) % 90.0 - 45.0)
    return np.where(off < SQUARE_TILT, 0.0, off)


def measure_faces(workpiece: Workpiece) -> Array:
    """Return the size of each face in mm by face number, (S,): length of a straight face, radius of an arc.

    NaN for numbers without a face.
    """
    every = workpiece.numbered
    sizes = np.full(len(every.segments), np.nan)
    for face in every.faces:
        sizes[face.number] = face.segment.radius if isinstance(face.segment, Arc) else face.segment.length
    return sizes


# Number of fixtures measured together; the temporary arrays then take 3 MB.
BLOCK = 1 << 13


def measure_quality(
    table: FixtureTable,
    workpiece: Workpiece,
    toolkit: Toolkit,
    tolerance: Tolerance | None = None,
    loads: Sequence[Load] = (),
    threads: int = 1,
    touched: TouchableFeatures | None = None,
    jaw_force: float | None = None,
    passed: tuple[Program, float] | None = None,
    pressed_top: float | None = None,
) -> Array:
    """Return figures of quality of a table of fixtures, from their holes, poses and faces alone.

    Parameters
    ----------
    tolerance : tolerances of pegs and faces, for the location error; None for 0.01 mm each.
    loads : loads, each of which acts by itself, for the load reaction; the worst load counts.
    threads : how many threads share the work; the outcome does not depend on it.
    touched : the workpiece's contact features; None to compute them.
    jaw_force : in N, for the warning that a peg lets go under a load; None for no such warning.
    passed : a program, and the height of pegs in mm; adds a column for the program clearance. The program's
        cutting forces count as loads. None for no program.
    pressed_top : height in mm up to which pegs press on a prism, to compute how far they bend; None where
        not known. Not needed for a solid.

    Returns
    -------
    (N, F) array with the columns of ``model.quality.list_figures_in_columns``; NaN for figures of loads
    without loads, and for pegs whose contact equations have no unique solution.
    """
    tolerance = tolerance or Tolerance()
    known = touched or TouchableFeatures.from_workpiece(workpiece, toolkit)
    corners, arcs = find_silhouette_extremes(workpiece)
    rows = make_load_rows(loads, workpiece.center)
    tolerances = np.array([tolerance.peg, tolerance.face])
    direction, sizes = find_main_direction(workpiece), measure_faces(workpiece)
    judging = JudgingLimits.from_toolkit(known.length, toolkit, tolerance, jaw_force)
    has_pins = workpiece.solid is not None or pressed_top is not None
    known_figures = len(FIGURES) if has_pins else BEFORE_PINS
    out = np.empty((len(table), known_figures + (passed is not None)))

    def fill(start: int) -> None:
        """Write the figures of one block of fixtures, from row ``start`` on, into the result."""
        block = table.take(slice(start, start + BLOCK))
        pose = np.column_stack([block.theta, block.position])
        faces = block.face.astype(np.int64)
        carriers = toolkit.find_peg_carriers(block.arrangement)
        x, y = compute_peg_places(block, toolkit, workpiece)
        contact_matrices = known.compute_contact_matrices(np.stack([x, y], axis=2), pose, carriers, faces)
        write_figures(
            contact_matrices.points,
            contact_matrices.normals,
            contact_matrices.ends,
            contact_matrices.edges,
            contact_matrices.inverses,
            number_shared_faces(block, toolkit, workpiece),
            known.length,
            tolerances,
            corners,
            arcs,
            rows,
            filled := out[start : start + BLOCK],
            np.empty((10, 3)),
        )
        filled[:, JAW_FORCE_NEEDED] = (
            compute_needed_jaw_forces(contact_matrices.inverses, contact_matrices.closing, known.length, rows)
            if loads
            else np.nan
        )
        if passed is not None and passed[0].forces is not None:
            found = compute_cutting_figures(contact_matrices, known, passed[0])
            chosen = [LOAD_REACTION, JAW_FORCE_NEEDED]
            filled[:, chosen] = np.fmax(filled[:, chosen], found)
        filled[:, CLAMP_FREEDOM] = np.nan
        if toolkit.tip_count > 1:
            filled[:, [CLOSURE_MARGIN, CLAMP_FREEDOM]] = compute_closures(contact_matrices.closing)
        filled[:, JAW_CONTACT] = np.nan
        if toolkit.wall_with_ends is not None:
            (ends,) = toolkit.ends_on_walls
            filled[:, JAW_CONTACT] = np.diff(x[:, ends], axis=1)[:, 0]
        filled[:, TILT] = compute_tilts(block.theta, direction)
        filled[:, SMALLEST_FACE] = find_smallest(measure_touched(block, toolkit, workpiece, sizes))
        if has_pins:
            runs = PinRuns.from_fixtures(
                faces, carriers, workpiece, toolkit, contact_matrices.points, pressed_top
            )
            silhouette = corners, arcs
            filled[:, PIN_FIGURES] = measure_most_bent(
                contact_matrices, runs, jaw_force, known.length, silhouette
            )
        filled[:, WARNINGS] = judging.count_warnings(filled, contact_matrices.edges)
        filled[:, PENALTY] = judging.compute_penalty(filled)
        if passed is not None:
            clearance = find_nearest_moves(block, workpiece, toolkit, *passed).clearance
            filled[:, PROGRAM_CLEARANCE] = np.where(np.isfinite(clearance), clearance, np.nan)

    starts = range(0, len(table), BLOCK)
    if threads > 1 and len(starts) > 1:
        with ThreadPoolExecutor(max_workers=threads) as pool:
            list(pool.map(fill, starts))
    else:
        for start in starts:
            fill(start)
    return out


def measure_most_bent(
    contacts: ContactMatrices,
    runs: PinRuns,
    jaw_force: float | None,
    length: float,
    silhouette: tuple[Array, Array],
) -> Array:
    """Return for each fixture the largest deflection and stress of a
    peg, and the movement of the part, (N, 3).

    In mm, MPa and mm; NaN if not known.
    """
    bent = compute_bent_pins(contacts, runs.diameter, runs.middle, jaw_force, length, silhouette)
    is_peg = ~np.isnan(runs.diameter)
    each = (
        np.where(is_peg, values, 0.0).max(axis=1, initial=0.0) for values in (bent.deflection, bent.stress)
    )
    out = np.column_stack([*each, bent.movement])
    out[~is_peg.any(axis=1)] = np.nan
    return np.asarray(out)


def compute_closures(reactions: Array) -> Array:
    """Return (closure margin, clamp freedom in degrees) of N fixtures with two clamps, (N, 2).

    ``reactions`` (N, 5, 2) are the forces of all contacts per unit of each clamp's force. NaN where they are
    NaN.
    """
    clamps = np.zeros((len(reactions), 2, CLAMP_LENGTH))
    for k in range(2):
        clamps[:, k, PUSH] = 1.0 / reactions[:, 3 + k, k]
        clamps[:, k, :3] = reactions[:, :3, k] * clamps[:, k, PUSH, None]
    out = np.empty((len(reactions), 2))
    write_closures(clamps, out)
    out[np.isnan(reactions).any(axis=(1, 2))] = np.nan
    return out


def number_shared_faces(block: FixtureTable, toolkit: Toolkit, workpiece: Workpiece) -> NDArray[np.int64]:
    """Return a number for each contact, (N, P); contacts with equal numbers move together by an error of
    their common face.

    The numbers are face numbers; each corner on a wall has a unique number.
    """
    faces = block.face.astype(np.int64)
    for ends in toolkit.ends_on_walls:
        faces[:, ends] = find_wall_ends(workpiece, toolkit, block.theta, block.position).shared
    return faces


def measure_touched(block: FixtureTable, toolkit: Toolkit, workpiece: Workpiece, sizes: Array) -> Array:
    """Return the size in mm of the face that each contact touches, (N, P).

    On a wall it is the length that lies on the wall. ``sizes`` (S,) are the sizes by face number.
    """
    out = sizes.take(block.face)
    for ends in toolkit.ends_on_walls:
        out[:, ends] = find_wall_ends(workpiece, toolkit, block.theta, block.position).length[:, None]
    return np.asarray(out)


def measure_fixture(
    result: Result, index: int, loads: Sequence[Load] | None = None, jaw_force: float | None = None
) -> Fixture:
    """Return fixture ``index`` of a result with all figures of quality.

    ``loads`` and ``jaw_force`` in N, if given, replace those of the result's query.
    """
    row = result.table.take(slice(index, index + 1))
    asked = result.query.loads if loads is None else loads
    force = result.query.jaw_force if jaw_force is None else jaw_force
    quality = measure_quality(
        row,
        result.workpiece,
        result.toolkit,
        result.query.tolerance,
        asked,
        jaw_force=force,
        passed=result.query.program_to_clear,
        pressed_top=result.query.pressed_top,
    )
    return make_fixture_of_row(evolve(row, quality=quality), result.toolkit, 0, result.workpiece)


def find_silhouette_extremes(workpiece: Workpiece) -> tuple[Array, Array]:
    """Return corners and arcs of the part's silhouette.

    A small movement of the part moves some point of these farther than all other points.

    Returns
    -------
    (corners, arcs) : (C, 2) corners of the joints' convex hull and (A, 6) convex arcs, relative to the part's
    centre in mm, as ``kernels.contact.quality`` takes them.
    """
    outer = [face.segment for face in workpiece.outer_faces]
    cx, cy = workpiece.center
    joints = [segment.start for segment in outer if not (isinstance(segment, Arc) and segment.is_full)]
    corners = np.array([(x - cx, y - cy) for x, y in compute_convex_hull(joints)]).reshape(-1, 2)
    arcs = [
        (*segment.to_row()[1:3], segment.radius, *segment.to_row()[3:5], cos(min(segment.half_sweep, pi)))
        for segment in outer
        if isinstance(segment, Arc) and segment.sign > 0
    ]
    return corners, np.array(arcs).reshape(-1, 6) - np.array([cx, cy, 0.0, 0.0, 0.0, 0.0])


def make_load_rows(loads: Sequence[Load], center: tuple[float, float]) -> Array:
    """Return the loads as rows (M, 11) for ``kernels.contact.quality``,
    one for each corner of a path's convex hull.

    The largest force is a convex function of the point, so no other point of a path is worse. ``center`` is
    the centre of the part, in mm.
    """
    rows = []
    for load in loads:
        low, high = np.radians(load.directions)
        middle, half = (low + high) / 2, min((high - low) / 2, pi)
        ends = [f(angle) for angle in (low, high, middle) for f in (np.cos, np.sin)]
        for x, y in compute_convex_hull(load.points) or [center]:
            rows.append([load.force, x - center[0], y - center[1], load.moment, *ends, cos(half)])
    return np.array(rows, np.float64).reshape(-1, LOAD_LENGTH)
