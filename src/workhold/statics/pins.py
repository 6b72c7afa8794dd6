"""The deflection and stress of pegs, and the movement of the part by them (docs/quality.md, "Pins bend").

Each peg is a cantilever, built in at the face of its plate, a round section of its diameter d. The part
presses on it with F at the height a above the plate: at the middle of the range of heights at which the peg
can press or, in the worst case, at the top of that range. Then (S. P. Timoshenko, *Philosophical Magazine*
41, 1921, with the shear coefficient 9/10 of a circle)

    deflection = F a³ / (3 E I) + 10 F a / (9 G A),   stress = 32 F a / (π d³),   I = π d⁴ / 64,   A = π d² / 4 .

Tips of clamps and walls count as rigid: a clamp follows its locators, and its stroke takes up its own
deflection. Pegs deflect along their normals, away from the part. The movement of the part follows from the
inverse of the contact matrix, as for the location error. But here all pegs deflect at once and by known
amounts, instead of by unknown errors.

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
from workhold.model.solid import interpolate_run
from workhold.model.workpiece import Workpiece
from workhold.statics.contact_matrix import ContactMatrices

__all__ = [
    "BentPins",
    "PinRuns",
    "compute_bent_pins",
    "compute_deflections",
    "get_limits",
    "compute_stresses",
]

Array = NDArray[np.float64]
# Numbers looked at together: fixtures times corners of the silhouette.
AT_ONCE = 1 << 20


def compute_deflections(force: Any, height: Any, diameter: Any) -> Any:
    """Return the deflections in mm of round steel cantilevers at the point of the force; numbers or arrays.

    Parameters
    ----------
    force : force in N.
    height : height of the force above the end at which the cantilever is built in, in mm.
    diameter : diameter of the cantilever in mm.

    Examples
    --------
    >>> round(compute_deflections(500.0, 38.0, 6.0), 3)
    0.694
    """
    inertia, area = pi * diameter**4 / 64, pi * diameter**2 / 4
    bending = force * height**3 / (3 * ELASTIC_MODULUS * inertia)
    return bending + 10 * force * height / (9 * SHEAR_MODULUS * area)


def compute_stresses(force: Any, height: Any, diameter: Any) -> Any:
    """Return the largest bending stresses in MPa of round cantilevers, numbers or arrays.

    Parameters as in :func:`compute_deflections`.

    >>> round(compute_stresses(500.0, 38.0, 6.0))
    896
    """
    return 32 * force * height / (pi * diameter**3)


def get_limits(toolkit: Toolkit) -> tuple[float, float]:
    """Return (1) the largest stress in MPa and (2) the largest movement
    in mm allowed for a toolkit without a warning.

    They are the bending stress of its pins, and the movement of the part by bent pins.
    """
    own = toolkit.pins
    stress, movement = (None, None) if own is None else (own.stress_limit, own.movement_limit)
    return (
        PIN_STRESS_LIMIT if stress is None else stress,
        PIN_MOVEMENT_LIMIT if movement is None else movement,
    )


@frozen(eq=False)
class PinRuns:
    """The ranges of heights above the plates, in mm, at which pegs of N fixtures can be pressed.

    Parameters
    ----------
    low, high : (N, P) lowest and highest height for each of P contacts; NaN for contacts that are not pegs in
        holes of a plate, and if not known.
    diameter : (N, P) diameter of the peg; NaN for contacts that are not pegs.
    """

    low: Array
    high: Array
    diameter: Array

    @classmethod
    def from_fixtures(
        cls,
        faces: NDArray[Any],
        carriers: NDArray[Any],
        workpiece: Workpiece,
        toolkit: Toolkit,
        points: Array,
        pressed_top: float | None,
        lift: float = 0.0,
    ) -> PinRuns:
        """Return the ranges of heights of the pegs of N fixtures.

        Parameters
        ----------
        faces, carriers : (N, P) numbers of the faces touched, and of the pegs' carriers.
        points : (N, P, 2) peg centres relative to the centre of the part, in the part's frame, in mm.
        pressed_top : height in mm up to which pegs press on a prism; None where not known, and for a solid.
        lift : height of the part above the plates, in mm.
        """
        each = np.array([2 * c.peg_radius if c.has_lattice else np.nan for c in toolkit.carriers])
        diameter = each.take(carriers)
        diameter[diameter == 0.0] = np.nan
        if workpiece.solid is None:
            top = np.nan if pressed_top is None else float(pressed_top)
            low, high = np.zeros(diameter.shape), np.full(diameter.shape, top)
        else:
            low, high = find_runs_on_solid(faces, points + np.array(workpiece.center), workpiece)
        is_none = np.isnan(diameter)
        low[is_none], high[is_none] = np.nan, np.nan
        return cls(low + lift, high + lift, diameter)

    @property
    def middle(self) -> Array:
        """Middles (N, P) of the ranges of heights, in mm."""
        return (self.low + self.high) / 2


def find_runs_on_solid(faces: NDArray[Any], points: Array, workpiece: Workpiece) -> tuple[Array, Array]:
    """Return (1) the lowest and (2) the highest heights in mm at which
    pegs can press on faces of a solid, (N, P).

    NaN for faces without known heights. ``faces`` is (N, P), ``points`` (N, P, 2) in the part's coordinates.
    """
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
        low[at], high[at] = find_runs(face.segments, points[at], workpiece)
    return low, high


def find_runs(segments: tuple[int, ...], points: Array, workpiece: Workpiece) -> tuple[Array, Array]:
    """Return (1) the lowest and (2) the highest heights in mm of one face at points (N, 2) of it, (N,) each.

    ``segments`` are the numbers of the face's segments. If the range of heights varies along a segment, the
    range at the point is taken.
    """
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
            ends = interpolate_run(rows, share)
            own = band or ends
            low[one], high[one] = max(min(ends[0], own[0]), 0.0), max(ends[1], own[1])
    return low, high


def compute_parameters(segment: Segment, points: Array) -> Array:
    """Return the parameters on a segment of points (N, 2) of it, (N,); see ``Segment.parameter``."""
    return np.array([segment.find_parameter((x, y)) for x, y in points.tolist()])


@frozen(eq=False)
class BentPins:
    """Bending of the pegs of N fixtures under forces at given heights.

    Parameters
    ----------
    deflection, stress : (N, P) in mm and in MPa; NaN for contacts that are not pegs.
    movement : (N,) largest movement of a point of the silhouette, in mm.
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
    """Return how far the pegs of N fixtures bend, and by how much this moves the part.

    Parameters
    ----------
    diameters : (N, P) diameters of the pegs, in mm; NaN for other contacts.
    heights : (N, P) heights of the forces above the pegs' plates, in mm.
    jaw_force : in N; None for figures at a jaw force of 1 kN.
    length : length L in mm that moments are divided by.
    extremes : corners and arcs of the silhouette, see ``statics.quality.find_silhouette_extremes``.
    """
    force = (STATED_FORCE if jaw_force is None else jaw_force) * np.abs(contacts.inverses[:, 3, :])
    deflection = np.asarray(compute_deflections(force, heights, diameters))
    gives_way = np.where(np.isnan(diameters), 0.0, deflection)
    moves = np.einsum("nkp,np->nk", contacts.inverses[:, :3, :], gives_way)
    moves[:, 2] /= length
    return BentPins(
        deflection,
        np.asarray(compute_stresses(force, heights, diameters)),
        find_farthest_movements(moves, *extremes),
    )


def find_farthest_movements(moves: Array, corners: Array, arcs: Array) -> Array:
    """Return for each of N small movements of the part the largest movement in mm of a point of its
    silhouette, (N,).

    ``moves`` (N, 3) are the shift (v_x, v_y) in mm and the turn t in radians. A point q, relative to the
    centre, moves by v + t (-q_y, q_x). It is farthest at a corner, or inside a convex arc about m where the
    turn adds to the movement of m; there the movement is |v(m)| + r |t|, with the arc's radius r
    (``kernels.contact.quality``).
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
