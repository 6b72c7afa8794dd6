r"""Certificates in double precision that records of three locators are seats.

The unknowns are z = (L psi, x, y) in mm: the turn of the pegs in the part's frame, and the centre of the
first peg. F are the three contact equations, distances from lines and circles, A an inverse of their
Jacobian, and

    eta >= \|A F(z)\|,   K >= \|second derivatives of F\|

in the norm of the largest absolute row sum. When 2 \|A\| K eta < 1 there is exactly one solution within 1 /
(\|A\| K) of z, and it lies within 2 eta (Newton-Kantorovich). The search gives a bound of the distance of the
exact contacts from those of a record. If it is at most 1 / (\|A\| K), the solution is the exact contact of
the record. A record is listed as undecided if this is not known, or if the error bounds do not decide a rule.

A seat alone fixes the pose, as a simple root: the determinant of its wrenches (n, q x n / L) is above
``LEAST_SEAT``.
"""

from __future__ import annotations

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.contact.features import measure_end_distances
from workhold.contact.problem import Problem
from workhold.conventions import LEAST_SEAT
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HIGH_SLACK,
    IS_ARC,
    LOW_SLACK,
    RADIUS,
    SIGN,
    X,
    Y,
)
from workhold.kernels.contact import record
from workhold.model.search_report import AT_AN_EDGE, GIVEN_UP, NEARLY_DOUBLE, UndecidedCandidate
from workhold.proof.deciding import SearchReport, read_peg_integers

__all__ = ["LOCATORS", "SeatContacts", "decide_seats"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

LOCATORS = 3
STEPS, DOUBLE_STEPS = 6, 40
# No unit. A double root has a determinant below this, were it drawn with few digits.
MARGINAL_SEAT = 1e-5
# Roundings of half a unit in the last place in a contact equation, relative to its terms, on the safe side.
ROUNDINGS = 16.0 * 1.2e-16
# Where the search states nothing better, the exact contact is this near, in mm.
LEAST_REACH = 1e-9
# Records worked on together.
TOGETHER = 1 << 16


@frozen(eq=False)
class SeatContacts:
    """The contacts of S seats with three locators each.

    Lengths are in mm, places in the part's frame about the centre of its bounding box.

    Parameters
    ----------
    feature : (S, 3) numbers of the contact features.
    column, row : (S, 3) of the holes, from the first locator's.
    psi : (S,) the turn of the pegs in the part's frame, in radians.
    point : (S, 3, 2) centres of the pegs.
    """

    feature: IntArray
    column: IntArray
    row: IntArray
    psi: Array
    point: Array

    def __len__(self) -> int:
        return len(self.psi)

    def take(self, chosen: IntArray | BoolArray) -> SeatContacts:
        """Return the chosen seats, by indices or a mask."""
        return SeatContacts(
            self.feature[chosen],
            self.column[chosen],
            self.row[chosen],
            self.psi[chosen],
            self.point[chosen],
        )

    @classmethod
    def concatenate(cls, parts: list[SeatContacts]) -> SeatContacts:
        """Return the seats of all parts, in order."""
        names = ("feature", "column", "row", "psi", "point")
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def decide_seats(records: Array, problem: Problem, title: str) -> tuple[SeatContacts, SearchReport]:
    """Return the seats (three locators that fix the pose) among records (N, 19), and the report on all
    records.

    ``title`` is that of the records' arrangement. See ``kernels.contact.record`` for the layout of records.
    """
    parts, accounts = [find_seats(records[:0], problem, title)[0]], list[SearchReport]()
    for start in range(0, len(records), TOGETHER):
        part, account = find_seats(records[start : start + TOGETHER], problem, title)
        parts.append(part)
        accounts.append(account)
    return SeatContacts.concatenate(parts), SearchReport.sum_up(accounts)


def find_seats(records: Array, problem: Problem, title: str) -> tuple[SeatContacts, SearchReport]:
    """Return the seats among records (N, 19) as :func:`decide_seats` does, all records at once.

    See ``kernels.contact.record`` for the layout of records.
    """
    given_up = records[:, record.STANDING] < 0.0
    lost, chosen = records[given_up], records[~given_up]
    feature, column, row = (numbers[:, :LOCATORS] for numbers in read_peg_integers(chosen))
    pitch = problem.frame.standing.pitch
    steps = np.stack([column * pitch[0], row * pitch[1]], axis=2)
    found = solve_contacts(chosen, problem.rows[feature], steps, problem)
    contacts = SeatContacts(feature, column, row, found.psi, found.point)
    is_seat = found.is_certain & (found.slack > found.off).all(axis=1)
    is_none = (found.is_certain & (found.slack < -found.off).any(axis=1)) | found.is_double
    is_open = ~is_seat & ~is_none
    reasons = [name_undecided(one, problem, title, GIVEN_UP) for one in lost]
    reasons += [
        name_undecided(chosen[k], problem, title, AT_AN_EDGE if found.is_certain[k] else NEARLY_DOUBLE)
        for k in np.flatnonzero(is_open)
    ]
    count = int(is_seat.sum())
    account = SearchReport(len(records), count, len(lost) + int(is_open.sum()), len(lost), tuple(reasons))
    return contacts.take(is_seat), account


@frozen(eq=False)
class Solutions:
    """The solutions of the contact equations of N records.

    Parameters
    ----------
    psi, point : as in :class:`SeatContacts`.
    slack : (N, 7) distance in mm by which the contacts keep the rule of ends, for each of six ends, then the
        determinant minus its least value; all positive for a seat.
    off : (N, 7) error bounds of ``slack``.
    is_certain : (N,) whether there is exactly one solution, the exact contact of the record.
    is_double : (N,) whether every solution of the record is a double root, or nearly one, and therefore no
        seat.
    """

    psi: Array
    point: Array
    slack: Array
    off: Array
    is_certain: BoolArray
    is_double: BoolArray


def solve_contacts(records: Array, rows: Array, steps: Array, problem: Problem) -> Solutions:
    """Return the solutions of the contact equations of records (N, 19) on features (N, 3, 12).

    ``steps`` (N, 3, 2) are the pegs' places in mm from the first one. See ``kernels.contact.record`` for the
    layout of records.
    """
    length = problem.wrench_length
    start = records[:, [record.PSI, record.TAIL_X, record.TAIL_Y]] * np.array([length, 1.0, 1.0])
    unknown = polish_unknowns(start, rows, steps, length, STEPS)
    point, turned = place_pegs(unknown, steps, length)
    value, slope = evaluate_equations(rows, point, turned, length)
    inverse = invert(slope)
    size = np.abs(point).max(axis=(1, 2)) + np.abs(rows[:, :, [X, Y, RADIUS]]).max(axis=(1, 2))
    residual = np.abs(value).max(axis=1) + ROUNDINGS * size + problem.backward_error
    norm = np.abs(inverse).sum(axis=2).max(axis=1)
    eta = norm * residual
    curved = bound_second_derivatives(rows, point, steps, length)
    with np.errstate(invalid="ignore", over="ignore"):
        unique = 1.0 / (norm * curved)
        box = np.maximum(length * records[:, record.REACH], records[:, record.LARGEST_RADIUS]) + LEAST_REACH
        away = np.abs(unknown - start).max(axis=1) + box
        is_certain = np.isfinite(norm) & (2.0 * norm * curved * eta < 1.0) & (away <= unique)
    # How fast the determinant changes with the pegs' centres, per mm.
    sharp = np.where(rows[..., IS_ARC] != 0.0, 1.0 / np.maximum(rows[..., RADIUS], 1e-9), 0.0).max(axis=1)
    rate = 6.0 * (1.0 / length + sharp)
    # Of a peg's centre, which the turn moves as well.
    off = np.where(is_certain, 8.0 * eta, np.inf)[:, None] * np.column_stack(
        [np.ones((len(records), 2 * LOCATORS)), rate]
    )
    is_double = np.zeros(len(records), np.bool_)
    open_ = np.flatnonzero(~is_certain)
    if len(open_):
        is_double[open_] = are_double(
            start[open_], box[open_], rows[open_], steps[open_], rate[open_], residual[open_], length
        )
    ends = measure_end_distances(rows, point) - problem.contact_margin
    ends = ends + np.stack([rows[:, :, LOW_SLACK], rows[:, :, HIGH_SLACK]], axis=2)
    determinant = np.abs(np.linalg.det(compute_wrench_matrices(rows, point, length)))
    slack = np.column_stack([ends.reshape(len(records), 2 * LOCATORS), determinant - LEAST_SEAT])
    slack = np.where(np.isnan(slack), -np.inf, slack)
    return Solutions(unknown[:, 0] / length, point, slack, off, is_certain, is_double)


def polish_unknowns(start: Array, rows: Array, steps: Array, length: float, count: int) -> Array:
    """Return the unknowns (N, 3) after ``count`` steps of Newton's method from ``start``.

    Steps that are not finite or longer than 1 mm are not taken. Beside a double root each step halves the
    error.
    """
    unknown = start.copy()
    for _ in range(count):
        point, turned = place_pegs(unknown, steps, length)
        value, slope = evaluate_equations(rows, point, turned, length)
        step = np.einsum("nij,nj->ni", invert(slope), value)
        step[~np.isfinite(step) | (np.abs(step) > 1.0)] = 0.0
        unknown -= step
    return unknown


def are_double(
    start: Array, box: Array, rows: Array, steps: Array, rate: Array, residual: Array, length: float
) -> BoolArray:
    """Return, for each record, whether its contacts are a double root, up to the rounding of a drawing.

    An error of the equations splits a double root into two. These are no farther from it than the square root
    of (the error times the largest radius), so their determinant is near that of a double root, 0.

    Parameters
    ----------
    start, box : (N, 3) unknowns, and (N,) error bounds in mm.
    rate : (N,) change of the determinant per mm that a peg's centre moves.
    residual : (N,) error of the equations in mm.
    """
    found = polish_unknowns(start, rows, steps, length, DOUBLE_STEPS)
    point, _ = place_pegs(found, steps, length)
    determinant = np.abs(np.linalg.det(compute_wrench_matrices(rows, point, length)))
    apart = 2.0 * np.sqrt(residual * np.maximum(rows[..., RADIUS].max(axis=1), length))
    is_near = np.abs(found - start).max(axis=1) <= 10.0 * box
    return np.asarray(is_near & (determinant + rate * apart < MARGINAL_SEAT))


def place_pegs(unknown: Array, steps: Array, length: float) -> tuple[Array, Array]:
    """Return the pegs' centres (N, 3, 2) in the part's frame, and the
    steps from the first peg turned by psi, in mm.

    ``unknown`` (N, 3) is (L psi, x, y) in mm.
    """
    c, s = np.cos(unknown[:, :1] / length), np.sin(unknown[:, :1] / length)
    turned = np.stack([c * steps[..., 0] - s * steps[..., 1], s * steps[..., 0] + c * steps[..., 1]], axis=2)
    return unknown[:, None, 1:] + turned, turned


def evaluate_equations(rows: Array, point: Array, turned: Array, length: float) -> tuple[Array, Array]:
    """Return the contact equations (N, 3) in mm, and their Jacobian
    (N, 3, 3) over (L psi, x, y), a row for each peg.
    """
    is_arc = rows[..., IS_ARC] != 0.0
    from_row = point - rows[..., [X, Y]]
    far = np.hypot(from_row[..., 0], from_row[..., 1])
    straight = np.stack([rows[..., AXIS_Y], -rows[..., AXIS_X]], axis=2)
    with np.errstate(invalid="ignore", divide="ignore"):
        radial = from_row / far[..., None]
    normal = np.where(is_arc[..., None], radial, straight)
    value = np.where(is_arc, far - rows[..., RADIUS], (from_row * straight).sum(axis=2))
    turning = (normal[..., 1] * turned[..., 0] - normal[..., 0] * turned[..., 1]) / length
    return value, np.concatenate([turning[..., None], normal], axis=2)


def invert(matrices: Array) -> Array:
    """Return the inverses of matrices (N, 3, 3), NaN where a matrix is singular or not finite."""
    out = np.full(matrices.shape, np.nan)
    usable = np.array(np.isfinite(matrices).all(axis=(1, 2)))
    usable[usable] = np.abs(np.linalg.det(matrices[usable])) > 1e-14
    out[usable] = np.linalg.inv(matrices[usable])
    return out


def bound_second_derivatives(rows: Array, point: Array, steps: Array, length: float) -> Array:
    """Return bounds (N,) of the second derivatives of the equations
    per mm, valid up to half an arc's radius away.
    """
    reach = np.hypot(steps[..., 0], steps[..., 1]) / length
    is_arc = rows[..., IS_ARC] != 0.0
    with np.errstate(divide="ignore"):
        bent = np.where(is_arc, 2.0 * (reach + 2.0) ** 2 / rows[..., RADIUS], 0.0)
    return np.asarray((reach / length + bent).max(axis=1)) + 1e-12


def compute_wrench_matrices(rows: Array, point: Array, length: float) -> Array:
    """Return the wrenches (N, 3, 3) of the locators, rows
    (n, q x n / L) with outward normals n; NaN entries become 0.
    """
    is_arc = (rows[..., IS_ARC] != 0.0)[..., None]
    straight = np.stack([rows[..., AXIS_Y], -rows[..., AXIS_X]], axis=2)
    with np.errstate(invalid="ignore", divide="ignore"):
        radial = rows[..., SIGN, None] * (point - rows[..., [X, Y]]) / rows[..., RADIUS, None]
    normal = np.where(is_arc, radial, straight)
    moment = (point[..., 0] * normal[..., 1] - point[..., 1] * normal[..., 0]) / length
    return np.asarray(np.nan_to_num(np.concatenate([normal, moment[..., None]], axis=2)))


def name_undecided(row: Array, problem: Problem, title: str, reason: str) -> UndecidedCandidate:
    """Return an undecided record (19,) as a named candidate with the reason why it is undecided.

    For a pair of chords that was given up, the tail and the head of both chords are named. ``title`` is that
    of the arrangement.
    """
    many = slice(None) if row[record.STANDING] < 0.0 else slice(LOCATORS)
    feature, column, line = (numbers[0, many] for numbers in read_peg_integers(row[None]))
    reach = float(np.degrees(row[record.REACH]))
    return UndecidedCandidate(
        title,
        tuple(problem.faces[feature].tolist()),
        tuple(column.tolist()),
        tuple(line.tolist()),
        float(np.degrees(-row[record.PSI]) % 360.0),
        reason,
        reach if np.isfinite(reach) else None,
    )
