"""How far pegs bend, how hard that stresses them, and what it moves the part by (docs/quality.md, "Pins bend").

Each peg is a cantilever, built in at the face of its plate, a round section of its diameter d. The part presses on
it with F at the height a above the plate: at the middle of the run of heights on which the peg can press, or, at
worst, at the top of that run. Then (S. P. Timoshenko, *Philosophical Magazine* 41, 1921, with the shear
coefficient 9/10 of a circle)

    deflection = F a³ / (3 E I) + 10 F a / (9 G A),   stress = 32 F a / (π d³),   I = π d⁴ / 64,   A = π d² / 4 .

Tips of clamps and walls are taken as rigid; a clamp follows its locators all the same, and its stroke alone takes
up that it gives way. Pegs give way along their normals, away from the part. What that moves the part by follows
from the inverse of the contact matrix, as for the location error; but here all pegs give way at once by what they
give way, not by what they might.

By hand: Ø 6 mm, 38 mm high, 500 N: 0.694 mm, of which 0.685 mm is bending, and 896 MPa.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import (
    ELASTIC_MODULUS,
    PIN_MOVEMENT_LIMIT,
    PIN_STRESS_LIMIT,
    SHEAR_MODULUS,
    STATED_FORCE,
)
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Segment
from workhold.model.solid import run_at
from workhold.model.workpiece import Workpiece
from workhold.statics.contact_matrix import ContactMatrices

__all__ = ["BentPins", "PinRuns", "compute_bent_pins", "compute_deflections", "limits_of", "stresses"]

Array = NDArray[np.float64]
# Numbers looked at together: fixtures times corners of the silhouette.
AT_ONCE = 1 << 20


def compute_deflections(force: Any, height: Any, diameter: Any) -> Any:
    """How far cantilevers give way in mm where they are pressed, numbers or arrays of them.

    Parameters
    ----------
    force, height, diameter : in N, in mm above where they are built in, and in mm.

    Examples
    --------
    >>> round(compute_deflections(500.0, 38.0, 6.0), 3)
    0.694
    """
    inertia, area = pi * diameter**4 / 64, pi * diameter**2 / 4
    bending = force * height**3 / (3 * ELASTIC_MODULUS * inertia)
    return bending + 10 * force * height / (9 * SHEAR_MODULUS * area)


def stresses(force: Any, height: Any, diameter: Any) -> Any:
    """Largest bending stresses of cantilevers in MPa, see :func:`compute_deflections`.

    >>> round(stresses(500.0, 38.0, 6.0))
    896
    """
    return 32 * force * height / (pi * diameter**3)


def limits_of(toolkit: Toolkit) -> tuple[float, float]:
    """The largest stress in MPa and the farthest movement in mm that pins of a toolkit may have unremarked."""
    own = toolkit.pins
    stress, movement = (None, None) if own is None else (own.stress_limit, own.movement_limit)
    return (
        PIN_STRESS_LIMIT if stress is None else stress,
        PIN_MOVEMENT_LIMIT if movement is None else movement,
    )


@frozen(eq=False)
class PinRuns:
    """The runs of heights in mm on which pegs of N fixtures press, above the plates.

    Parameters
    ----------
    low, high : (N, P), NaN of what is no peg in a hole of a plate, and where they are not known.
    diameter : (N, P) in mm, NaN of what is no peg.
    """

    low: Array
    high: Array
    diameter: Array

    @classmethod
    def of(
        cls,
        faces: NDArray[Any],
        carriers: NDArray[Any],
        workpiece: Workpiece,
        toolkit: Toolkit,
        points: Array,
        pressed_up_to: float | None,
        lift: float = 0.0,
    ) -> PinRuns:
        """The runs of some fixtures.

        Parameters
        ----------
        faces, carriers : (N, P) numbers of the faces touched, and of the pegs' carriers.
        points : (N, P, 2) peg centres about the centre of the part, in the part's frame, in mm.
        pressed_up_to : up to which height pegs press on a prism, in mm; None where nobody knows, and of a solid.
        lift : how far the part lies above the plates, in mm.
        """
        each = np.array([2 * c.peg_radius if c.has_lattice else np.nan for c in toolkit.carriers])
        diameter = each.take(carriers)
        diameter[diameter == 0.0] = np.nan
        if workpiece.solid is None:
            top = np.nan if pressed_up_to is None else float(pressed_up_to)
            low, high = np.zeros(diameter.shape), np.full(diameter.shape, top)
        else:
            low, high = find_runs_on_solid(faces, points + np.array(workpiece.center), workpiece)
        is_none = np.isnan(diameter)
        low[is_none], high[is_none] = np.nan, np.nan
        return cls(low + lift, high + lift, diameter)

    @property
    def middle(self) -> Array:
        """The heights (N, P) at their middle."""
        return (self.low + self.high) / 2


def find_runs_on_solid(faces: NDArray[Any], points: Array, workpiece: Workpiece) -> tuple[Array, Array]:
    """The lower and the upper ends (N, P) of the runs that hold the bands of faces, where pegs touch them."""
    numbered = workpiece.numbered
    bands = [(np.nan, np.nan) if band is None else band for band in numbered.bands]
    low, high = (np.array(ends, np.float64).take(faces) for ends in zip(*bands, strict=True))
    if not any(numbered.runs):
        return low, high
    for face in numbered.faces:
        if not any(numbered.runs[k] for k in face.segments):
            continue
        at = np.nonzero(faces == face.number)
        if not len(at[0]):
            continue
        low[at], high[at] = runs_along(face.segments, points[at], workpiece)
    return low, high


def runs_along(segments: tuple[int, ...], points: Array, workpiece: Workpiece) -> tuple[Array, Array]:
    """The runs (N,) at points (N, 2) of a face that has some segments, over one of which runs slide."""
    numbered = workpiece.numbered
    parameters = np.array([compute_parameters(numbered.segments[k], points) for k in segments])
    extents = np.array([numbered.segments[k].half_extent for k in segments])
    touched = np.argmin(np.abs(parameters) - extents[:, None], axis=0)
    low, high = np.empty(len(points)), np.empty(len(points))
    for place, number in enumerate(segments):
        here = np.flatnonzero(touched == place)
        rows, segment, band = numbered.runs[number], numbered.segments[number], numbered.bands[number]
        if not rows:
            low[here], high[here] = (np.nan, np.nan) if band is None else band
            continue
        against = -1.0 if isinstance(segment, Arc) and segment.sign < 0 else 1.0
        shares = (against * parameters[place, here] / segment.half_extent + 1.0) / 2.0
        for one, share in zip(here.tolist(), shares.tolist(), strict=True):
            ends = run_at(rows, share)
            own = band or ends
            low[one], high[one] = max(min(ends[0], own[0]), 0.0), max(ends[1], own[1])
    return low, high


def compute_parameters(segment: Segment, points: Array) -> Array:
    """Parameters (N,) on a segment of points (N, 2)."""
    return np.array([segment.parameter((x, y)) for x, y in points.tolist()])


@frozen(eq=False)
class BentPins:
    """How far the pegs of N fixtures bend with the force at some heights.

    Parameters
    ----------
    deflection, stress : (N, P) in mm and MPa, NaN of what is no peg.
    movement : (N,) the farthest that a point of the silhouette moves, in mm.
    """

    deflection: Array
    stress: Array
    movement: Array


def compute_bent_pins(
    contacts: ContactMatrices,
    diameters: Array,
    heights: Array,
    jaw_force: float | None,
    length: float,
    extremes: tuple[Array, Array],
) -> BentPins:
    """How far pegs bend, and what that moves the part by.

    Diameters of the pegs (N, P), and heights of the forces on them above their plates, are in mm, NaN of
    others. A jaw force is in N; None is for each kN. ``length`` is L in mm. For the extremes of the
    silhouette see ``statics.quality.extremes``.
    """
    force = (STATED_FORCE if jaw_force is None else jaw_force) * np.abs(contacts.inverses[:, 3, :])
    deflection = np.asarray(compute_deflections(force, heights, diameters))
    gives_way = np.where(np.isnan(diameters), 0.0, deflection)
    moves = np.einsum("nkp,np->nk", contacts.inverses[:, :3, :], gives_way)
    moves[:, 2] /= length
    return BentPins(deflection, np.asarray(stresses(force, heights, diameters)), farthest(moves, *extremes))


def farthest(moves: Array, corners: Array, arcs: Array) -> Array:
    """The farthest movements (N,) of a point of the silhouette, from shifts of its centre and turns (N, 3).

    A point q about the centre moves by v + t (-q_y, q_x): farthest at a corner, or inside a convex arc about m
    where the turn adds to the movement of m, there by |v(m)| + r |t| (``kernels.contact.quality``).
    """
    most = np.zeros(len(moves))
    step = max(AT_ONCE // max(len(corners) + len(arcs), 1), 1)
    for start in range(0, len(moves), step):
        x, y, turn = (moves[start : start + step, k, None] for k in range(3))
        reach = np.zeros((len(x), 1))
        if len(corners):
            reach = np.hypot(x - turn * corners[:, 1], y + turn * corners[:, 0])
        found = reach.max(axis=1)
        if len(arcs):
            along, across = x - turn * arcs[:, 1], y + turn * arcs[:, 0]
            speed = np.hypot(along, across)
            side = np.where(turn > 0.0, 1.0, -1.0) * (across * arcs[:, 3] - along * arcs[:, 4])
            moved = np.where(side >= speed * arcs[:, 5], speed + np.abs(turn) * arcs[:, 2], 0.0)
            found = np.maximum(found, moved.max(axis=1))
        most[start : start + step] = found
    return most
