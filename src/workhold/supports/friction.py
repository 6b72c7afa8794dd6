"""The effect of friction on supports: the least clamp force for which some friction forces balance the loads.

Every contact presses within its cone of friction: pegs on their faces, supports from below, the clamp from
above. Pegs are taken at both ends of their bands of heights, and the worst result counts. The moving carrier
pushes with the jaw force as before. The least clamp force that balances a load is a linear program in the
forces along the edges of pyramids inside the cones, with six equations of balance and one for the jaw. It is
convex in the load, so the ends of ranges, and corners around a range of directions, are the worst loads.

The result is optimistic: with friction, statics does not determine the forces, and the most favourable ones
are assumed. It does not affect the ranking.

The programs, minimize c . x subject to A x = b, x >= 0, with c >= 0, differ in b alone. They are solved by
the simplex method in two phases (G. B. Dantzig, *Linear Programming and Extensions*, 1963, chapter 5), by R.
G. Bland's rule, which never goes in circles (Mathematics of Operations Research 2, 1977). An optimal basis of
one b stays optimal for every other b that it solves with x >= 0, because the reduced costs do not depend on
b. So few programs are solved, and the others reuse their bases.

Reference: J. Kerr and B. Roth, "Analysis of multifingered hands", International Journal of Robotics Research
4, 1986, for pyramids inside the cones and linear programs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from math import ceil, cos, isfinite, pi, radians, sin

import numpy as np
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.limits import MOST_FRICTION, convert_real
from workhold.model.support_request import SpatialLoad
from workhold.model.support_triples import Supports, Triple
from workhold.statics.contact_matrix import TouchableFeatures
from workhold.statics.loads import find_contacts_on_part

__all__ = ["make_balance_program", "compute_clamp_force", "find_least_costs", "yield_load_wrenches"]

Array = NDArray[np.float64]
# Edges of each pyramid; and the widest step in degrees between corners around a range of directions, which
# makes the force at most 0.5 % larger than it is.
EDGES, WIDEST_STEP = 8, 11.25
IntArray = NDArray[np.int64]
# Part of the largest entry of a right side below which forces and costs are rounding errors, and the most
# steps of the method.
NEGLIGIBLE, MOST_TURNS = 1e-10, 2000


def compute_clamp_force(supports: Supports, triple: Triple, friction: float) -> float:
    """Return the least clamp force in N at which friction could balance every load.

    It is at most the force needed without friction.

    Parameters
    ----------
    triple : one of the triples of these supports, with the clamp at :attr:`Triple.clamp`.
    friction : coefficient of friction of all contacts.

    Raises
    ------
    InputError
        For an invalid coefficient, and for supports without loads.
    """
    coefficient = convert_real(friction)
    if not (isfinite(coefficient) and 0 <= coefficient <= MOST_FRICTION):
        raise InputError(
            f"friction {coefficient:g} cannot be used: give a coefficient from 0 to {MOST_FRICTION:g}, such "
            "as 0.15."
        )
    if not supports.loads:
        raise InputError("friction needs loads, and there are none: give a load too.")
    wrenches = np.array([one for load in supports.loads for one in yield_load_wrenches(load, supports)])
    bands = supports.request.list_peg_bands(len(supports.fixture.pegs)).tolist()
    worst = 0.0
    for heights in product(*(sorted(set(band)) for band in bands)):
        matrix, costs, length = make_balance_program(supports, triple, coefficient, heights)
        sides = np.column_stack([-wrenches, np.full(len(wrenches), supports.jaw_force)])
        sides[:, 3:6] /= length
        worst = max(worst, float(find_least_costs(matrix, costs, sides).max()))
    return min(worst, triple.clamp.clamp_needed)


def make_balance_program(
    supports: Supports, triple: Triple, friction: float, heights: Sequence[float]
) -> tuple[Array, Array, float]:
    """Return (matrix (7, V), costs (V,), length in mm): the linear program of the balance of forces.

    Each of the V columns is the effect of a unit force along an edge of a friction cone. Rows: force in x, y,
    z; moments about the part's centre divided by the length; push against the moving carrier. The cost is 1
    for the clamp's edges, else 0. ``heights`` has the height in mm at which each peg presses.
    """
    query, fixture = supports.query, supports.fixture
    touched = TouchableFeatures.from_workpiece(query.workpiece, query.toolkit)
    matrices = touched.compute_for_fixture(fixture, query.toolkit)
    points, normals, moving, against = find_contacts_on_part(
        fixture, query.workpiece, query.toolkit, touched, matrices
    )
    against = np.broadcast_to(against, normals.shape)
    columns, costs = [], []

    def add(point: Array, push: Array, back: Array, cost: float) -> None:
        """Append the edges of the pyramid about a unit push at a point.

        ``back`` is the direction against what moves, ``cost`` the cost of each edge.
        """
        for edge in yield_pyramid_edges(push, friction):
            moment = np.cross(point, edge) / touched.length
            columns.append([*edge, *moment, -(edge[:2] @ back)])
            costs.append(cost)

    still = np.zeros(2)
    for peg, height in enumerate(heights):
        push = np.array([*-normals[peg], 0.0])
        add(np.array([*points[peg], height]), push, against[peg] * moving[peg], 0.0)
    for pad in triple.supports:
        at = np.array([pad.x, pad.y]) - touched.center
        add(np.array([*at, 0.0]), np.array([0.0, 0.0, 1.0]), still, 0.0)
    high = supports.request.find_clamped_height(triple.clamp.at)
    at = np.array(triple.clamp.at) - touched.center
    add(np.array([*at, high]), np.array([0.0, 0.0, -1.0]), still, 1.0)
    return np.array(columns).T, np.array(costs), touched.length


def yield_pyramid_edges(push: Array, friction: float) -> Iterator[Array]:
    """Yield the edges (3,) of a pyramid inside the friction cone about
    a unit push; each has component 1 along it.
    """
    one = np.array([-push[1], push[0], 0.0]) if push[2] == 0.0 else np.array([1.0, 0.0, 0.0])
    other = np.cross(push, one)
    if friction == 0.0:
        yield push
        return
    for k in range(EDGES):
        turn = 2 * pi * k / EDGES
        yield push + friction * (cos(turn) * one + sin(turn) * other)


def yield_load_wrenches(load: SpatialLoad, supports: Supports) -> Iterator[list[float]]:
    """Yield wrenches [fx, fy, fz, mx, my, mz] whose convex hull contains every case of a load.

    They are about the part's centre, in N and N mm.
    """
    center = TouchableFeatures.from_workpiece(supports.query.workpiece, supports.query.toolkit).center
    assert load.heights is not None
    ways = list(yield_polygon_corners(load.directions)) if load.force else [(0.0, 0.0)]
    for point in load.points or (tuple(center.tolist()),):
        for height, axial, way in product(sorted(set(load.heights)), sorted(set(load.axial)), ways):
            force = np.array([load.force * way[0], load.force * way[1], -axial])
            moment = np.cross([point[0] - center[0], point[1] - center[1], height], force)
            moment += [*load.tilt, load.moment]
            yield [*force, *moment]


def yield_polygon_corners(directions: tuple[float, float]) -> Iterator[tuple[float, float]]:
    """Yield points (x, y) whose convex hull contains the unit vectors of a range of directions in degrees."""
    low, wide = radians(directions[0]), radians(min(directions[1] - directions[0], 360.0))
    steps = max(ceil(wide / radians(WIDEST_STEP)), 1)
    half = wide / steps / 2
    if wide < 2 * pi:
        yield cos(low), sin(low)
        yield cos(low + wide), sin(low + wide)
    if wide > 0.0:
        for k in range(steps):
            turn = low + (2 * k + 1) * half
            yield cos(turn) / cos(half), sin(turn) / cos(half)


def find_least_costs(matrix: Array, costs: Array, sides: Array) -> Array:
    """Return the least costs of N programs min c . x, A x = b, x >= 0, as (N,); inf where infeasible.

    ``matrix`` is A (R, V), whose rows must have entries of similar size; ``costs`` is c (V,) >= 0; the rows
    of ``sides`` (N, R) are the right sides b.
    """
    out, open_ = np.full(len(sides), np.inf), np.ones(len(sides), bool)
    while open_.any():
        first = int(np.flatnonzero(open_)[0])
        open_[first] = False
        basis = find_optimal_basis(matrix, costs, sides[first])
        if basis is None:
            continue
        values = np.linalg.solve(matrix[:, basis], sides.T).T
        size = np.abs(sides).max(axis=1, initial=1.0)
        solved = open_ & (values >= -NEGLIGIBLE * size[:, None]).all(axis=1)
        solved[first] = True
        out[solved] = np.maximum(values[solved], 0.0) @ costs[basis]
        open_ &= ~solved
    return out


def find_optimal_basis(matrix: Array, costs: Array, side: Array) -> IntArray | None:
    """Return the basic columns (R,) of an optimal solution of the program with the right side ``side``.

    None where the program is infeasible, or where the rows of the matrix are dependent.
    """
    rows, columns = matrix.shape
    size = max(float(np.abs(side).max()), 1.0)
    signs = np.where(side < 0.0, -1.0, 1.0)
    wide = np.hstack([matrix, np.diag(signs)])
    basis = np.arange(columns, columns + rows)
    artificial = np.concatenate([np.zeros(columns), np.ones(rows)])
    basis, values = improve_basis(wide, artificial, side, basis)
    if values[basis >= columns].sum() > 1e-8 * size:
        return None
    # Artificial variables that are 0 leave the basis for a column that can replace them.
    for place in np.flatnonzero(basis >= columns):
        row = np.linalg.inv(wide[:, basis])[place] @ matrix
        row[basis[basis < columns]] = 0.0
        if np.abs(row).max() < 1e-9:
            return None
        basis[place] = int(np.abs(row).argmax())
    return improve_basis(matrix, costs, side, basis)[0]


def improve_basis(matrix: Array, costs: Array, side: Array, basis: IntArray) -> tuple[IntArray, Array]:
    """Return (1) an optimal basis (R,) and (2) its values (R,), by the
    simplex method from a feasible basis.
    """
    basis = basis.copy()
    for turn in range(MOST_TURNS):
        inverse = np.linalg.inv(matrix[:, basis])
        values = inverse @ side
        reduced = costs - (costs[basis] @ inverse) @ matrix
        reduced[basis] = 0.0
        entering = np.flatnonzero(reduced < -NEGLIGIBLE)
        if not len(entering):
            break
        # The steepest column is quick, but may cycle; Bland's first column ends.
        enters = int(entering[0] if turn > MOST_TURNS // 4 else entering[reduced[entering].argmin()])
        change = inverse @ matrix[:, enters]
        falls = np.flatnonzero(change > 1e-11)
        if not len(falls):
            break
        ratios = np.maximum(values[falls], 0.0) / change[falls]
        ties = falls[ratios <= ratios.min() * (1 + 1e-12)]
        leaves = ties[basis[ties].argmin()] if turn > MOST_TURNS // 4 else ties[change[ties].argmax()]
        basis[leaves] = enters
    return basis, np.linalg.inv(matrix[:, basis]) @ side
