"""Deciding which records are fixtures: in double precision where that is enough, else in ball arithmetic.

A record holds where four contacts are and how far the exact ones may be from there. It goes through up to
four stages, and leaves with the first that decides it:

1. a certificate of its solution (``kernels.proof.newton_kantorovich``), with all rules decided by enclosures;
2. the same for the features' rows as they are, without what rounding may have done to the drawing before;
3. the interval Newton method in double precision (``kernels.proof.interval_newton``): boxes in which no
   fixture can be are dropped, and those with exactly one solution go through stage 2;
4. the same method in ball arithmetic (``interval_newton``).
"""

from __future__ import annotations

from math import inf, isfinite
from threading import Event, Lock
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.kernels.base.tables import Lattice, Setting
from workhold.kernels.contact import record
from workhold.kernels.contact.record import WORK_LENGTH
from workhold.kernels.proof.interval_newton import interval_newton, jacobians
from workhold.kernels.proof.merging import merge_boxes
from workhold.kernels.proof.newton_kantorovich import LEAST_REACH, OPEN, PROVEN, certified, discs_around
from workhold.model.search_report import GIVEN_UP, UNBOUNDED, Undecided
from workhold.proof.degenerate import hold_nothing

if TYPE_CHECKING:
    from workhold.proof.interval_newton import BoxOutcome

__all__ = ["Account", "Course", "decided", "is_standing", "merged", "read_peg_integers"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# The precision of balls is one for the whole process, so one thread at a time works with them.
BALLS = Lock()
# Records looked at between two looks at the flag that stops the work: at first, at most, and the seconds
# under which twice as many are looked at next.
OPEN_BLOCK, LARGEST_BLOCK, QUICK = 16, 1024, 0.02
# A box is flat whose turn is no more than this part of its other sides.
FLAT = 1e-6
# Seconds after somebody asked to stop in which records are still decided, by what takes little time.
GRACE = 0.5


@define(eq=False)
class Course:
    """How far the deciding of records has come, and whether it is to stop.

    Parameters
    ----------
    total : records to decide.
    progress : called with the fraction done and how many records still may be fixtures.
    cancel : when set, what takes long is left out, and all that is not decided soon after.
    """

    total: int
    progress: Progress | None = None
    cancel: Event | None = None
    done: int = field(default=0, init=False)
    kept: int = field(default=0, init=False)
    lock: Lock = field(factory=Lock, init=False)
    deadline: float = field(default=inf, init=False)

    @property
    def is_stopped(self) -> bool:
        stopped = self.deadline < inf or (self.cancel is not None and self.cancel.is_set())
        if stopped:
            self.deadline = min(self.deadline, perf_counter() + GRACE)
        return stopped

    @property
    def is_late(self) -> bool:
        """Whether it is some time since somebody asked to stop."""
        return self.is_stopped and perf_counter() >= self.deadline

    def give_up(self) -> None:
        """Stop at once: nobody waits for the outcome."""
        self.deadline = 0.0

    def advance(self, done: int, kept: int) -> None:
        """Records are decided, and some of them kept; may be called from any thread."""
        with self.lock:
            self.done += done
            self.kept += kept
        if self.progress is not None and done:
            self.progress(self.fraction, self.kept)

    @property
    def fraction(self) -> float:
        """The part of the records that is decided."""
        return min(self.done / max(self.total, 1), 1.0)


@define(frozen=True)
class Account:
    """What became of records: how many there were, and how many are proven fixtures.

    Escalated are records that the first certificate left open, and left are those not decided when the work
    was stopped. Given up are pairs of chords that the engine did not follow to their crossings.
    """

    records: int
    verified: int
    escalated: int
    given_up: int
    undecided: tuple[Undecided, ...]
    left: int = 0

    @classmethod
    def together(cls, accounts: list[Account]) -> Account:
        lost = tuple(item for account in accounts for item in account.undecided)
        records, verified, escalated, given_up, left = (
            sum(getattr(account, name) for account in accounts)
            for name in ("records", "verified", "escalated", "given_up", "left")
        )
        return cls(records, verified, escalated, given_up, lost, left)


def is_standing(standing: NDArray[Any]) -> NDArray[np.bool_]:
    """Which of the four pegs are on the carrier that stands still, (N, 4), from how many are (N,)."""
    return np.arange(4) < standing[:, None]


def read_peg_integers(records: Array) -> tuple[IntArray, IntArray, IntArray]:
    """Features, columns and rows of records, each (N, 4)."""
    whole = records[:, record.FEATURES : record.PSI].astype(np.int64)
    return whole[:, :4], whole[:, 4:8], whole[:, 8:12]


def peg_places(row: Array, lattice: Lattice) -> list[tuple[float, float]]:
    """Places of the four pegs of one record in mm from the first, without the separation."""
    _, columns, rows = (numbers[0] for numbers in read_peg_integers(row[None]))
    moves = ~is_standing(row[[record.STANDING]])[0]
    height = rows * lattice.pitch_y + moves * lattice.row_offset
    return [(float(x), float(y)) for x, y in zip(columns * lattice.pitch_x, height, strict=True)]


def bound_box(records: Array, length: float) -> Array:
    """Distances (N, 4) in mm of the exact (L psi, tail x, tail y, separation) from those of records."""
    turn, radius = (
        length * records[:, record.REACH] + LEAST_REACH,
        records[:, record.LARGEST_RADIUS] + LEAST_REACH,
    )
    return np.stack([turn, radius, radius, 2.0 * (radius + turn)], axis=1)


def decided(records: Array, problem: Problem, course: Course | None = None) -> tuple[Array, Account]:
    """Decides records.

    Parameters
    ----------
    records : (N, 19) from an engine, laid out as ``kernels.contact.record`` says.
    course : notes how far the work has come, and is asked whether to stop.

    Returns
    -------
    (those proven to be fixtures, with their solutions to the last digits; what became of all)
    """
    course = course or Course(len(records))
    if course.is_late:
        return records[:0], Account(0, 0, 0, 0, (), len(records))
    given_up = records[:, record.STANDING] < 0.0
    lost = [undecided(row, problem, GIVEN_UP) for row in records[given_up]] if given_up.any() else []
    chosen = records[~given_up] if lost else records
    proven, rest = sifted(chosen, problem, problem.setting)
    rest = rest[~hold_nothing(rest, problem)]
    course.advance(len(records) - len(rest), len(proven))
    found, reasons, left = escalated(rest, problem, course)
    if len(found):
        proven = np.concatenate([proven, found])
    account = Account(
        len(records) - left, len(proven), len(rest) - left + len(lost), len(lost), (*lost, *reasons), left
    )
    return proven, account


def sifted(records: Array, problem: Problem, setting: Setting) -> tuple[Array, Array]:
    """Records that a certificate proves, with their solutions, and those it leaves open, as they are."""
    solutions = np.empty((len(records), 4))
    verdicts, work = np.full(len(records), PROVEN, np.int8), (np.empty((WORK_LENGTH, 4)), np.empty((2, 4, 2)))
    for outline, kept in clearances(problem, setting):
        discs, judged = (
            discs_around(outline, max(kept.standing_radius, kept.moving_radius)),
            np.empty(len(records), np.int8),
        )
        certified(records, problem.rows, outline, discs, kept, solutions, judged, *work)
        verdicts = np.minimum(verdicts, judged)
    is_proven = np.flatnonzero(verdicts == PROVEN)
    proven = records.take(is_proven, axis=0)
    proven[:, record.PSI : record.REACH] = solutions.take(is_proven, axis=0)
    return proven, records[verdicts == OPEN]


def clearances(problem: Problem, setting: Setting) -> list[tuple[Array, Setting]]:
    """Outlines (S, 10), and what pegs keep from each: those that do not meet it, nothing."""
    one, other = problem.outlines
    if one is other:
        return [(one, setting)]
    return [(one, setting._replace(moving_radius=-inf)), (other, setting._replace(standing_radius=-inf))]


def escalated(records: Array, problem: Problem, course: Course) -> tuple[Array, list[Undecided], int]:
    """Decides open records by the later stages: fixtures, undecided ones, and how many were left.

    Records are left when the work is stopped.
    """
    if len(records) == 0:
        return records, [], 0
    setting = problem.setting._replace(backward_error=0.0)
    proven, rest = sifted(records, problem, setting)
    course.advance(len(records) - len(rest), len(proven))
    together = merged(rest, problem)
    course.advance(len(rest) - len(together), 0)
    found, waiting, left = [proven], [together[:0]], 0
    begin, size = 0, OPEN_BLOCK
    while begin < len(together):
        block, since = together[begin : begin + size], perf_counter()
        if course.is_stopped:
            left += len(together) - begin
            break
        proven, rest = decide_by_interval_newton(block, problem, setting)
        found.append(proven)
        waiting.append(rest)
        course.advance(max(len(block) - len(rest), 0), len(proven))
        begin += size
        # Most boxes take microseconds, some a tenth of a second.
        size = min(2 * size, LARGEST_BLOCK) if perf_counter() - since < QUICK else OPEN_BLOCK
    in_balls, reasons, left_out = decide_records_in_balls(
        merged(np.concatenate(waiting), problem), problem, course
    )
    return np.concatenate([*found, in_balls]), reasons, left + left_out


def decide_by_interval_newton(records: Array, problem: Problem, setting: Setting) -> tuple[Array, Array]:
    """Open records contracted: the fixtures found, and the boxes that stay open."""
    slopes = jacobians(records, problem.rows, setting)
    bounded = np.isfinite(records).all(axis=1) & np.isfinite(slopes).all(axis=(1, 2))
    known = records[bounded]
    reach = bound_box(known, problem.wrench_length)
    # Where the orientation is known far better than the place, a frame must not mix them.
    reach[reach[:, 0] >= FLAT * reach[:, 1]] = 1.0
    left, _, right = np.linalg.svd(slopes[bounded] * reach[:, None, :])
    frames = np.stack([left, right.transpose(0, 2, 1)], axis=1)
    verdicts, roots = interval_newton(known, problem.rows, setting, frames)
    proven, still_open = sifted(roots, problem, setting)
    return proven, np.concatenate([records[~bounded], known[verdicts == OPEN], still_open])


def merged(records: Array, problem: Problem) -> Array:
    """Records of the same pegs on the same features whose boxes overlap, as one with a box around all."""
    if len(records) < 2:
        return records
    order = np.lexsort(records.T[::-1])
    records = records[order]
    same = np.asarray((records[1:, : record.PSI] == records[:-1, : record.PSI]).all(axis=1))
    reach = bound_box(records, problem.wrench_length)
    middle = records[:, record.PSI : record.REACH] * np.array([problem.wrench_length, 1.0, 1.0, 1.0])
    low, high = middle - reach, middle + reach
    may, heads = np.zeros(len(records), np.int64), np.empty(len(records), np.int64)
    may[1:] = same & np.isfinite(reach[1:]).all(axis=1)
    heads = heads[: merge_boxes(low, high, may, heads)]
    for k in heads[heads >= 0].tolist():
        records[k] = around(records[k], low[k], high[k], problem.wrench_length)
    return np.asarray(records[np.where(heads < 0, -1 - heads, heads)])


def around(row: Array, low: Array, high: Array, length: float) -> Array:
    """A record whose box holds what is between two corners, (4,) each in mm."""
    center, half = (low + high) / 2.0, (high - low) / 2.0
    out = row.copy()
    out[record.PSI : record.REACH] = center[0] / length, *center[1:]
    out[record.REACH], out[record.LARGEST_RADIUS] = half[0] / length, max(half[1], half[2], half[3] / 2.0)
    return out


def decide_records_in_balls(
    records: Array, problem: Problem, course: Course
) -> tuple[Array, list[Undecided], int]:
    """Decides records one by one in ball arithmetic: fixtures, undecided ones, and how many were left.

    Records are left when the work is stopped.
    """
    found: list[Array] = []
    reasons: list[Undecided] = []
    left = 0
    for k, row in enumerate(records):
        outcome = record_in_balls(row, problem, course)
        if outcome is None:
            left = len(records) - k
            break
        if outcome.reason:
            reasons.append(undecided(row, problem, outcome.reason))
        for solution in outcome.fixtures:
            fixed = row.copy()
            fixed[record.PSI : record.REACH] = solution
            found.append(fixed)
        course.advance(1, len(outcome.fixtures))
    return np.array(found).reshape(-1, record.RECORD_LENGTH), reasons, left


def record_in_balls(row: Array, problem: Problem, course: Course) -> BoxOutcome | None:
    """One record decided in ball arithmetic; None when the work was stopped before."""
    from workhold.proof.ball_contacts import CandidateBox
    from workhold.proof.interval_newton import BoxOutcome, solutions_in

    length = problem.wrench_length
    turn, right, up, along = (float(v) for v in bound_box(row[None], length)[0])
    if not np.isfinite(row).all():
        return BoxOutcome((), UNBOUNDED)
    psi, x, y, separation = (float(v) for v in row[record.PSI : record.REACH])
    box = CandidateBox(
        features=problem.rows[row[record.FEATURES : record.COLUMNS].astype(np.int64)].tolist(),
        offsets=peg_places(row, problem.frame.lattice),
        standing=int(row[record.STANDING]),
        middle=(psi, x, y, separation),
        reach=(turn / length, right, up, along),
    )
    with BALLS:
        return solutions_in(box, problem.limits, lambda: course.is_stopped)


def undecided(row: Array, problem: Problem, reason: str) -> Undecided:
    feature, column, line = read_peg_integers(row[None])
    faces = problem.faces[feature[0]].tolist()
    standing = np.abs(row[[record.STANDING]]).astype(np.int64)
    kind = problem.toolkit.arrangements[problem.toolkit.find_arrangement_numbers(standing)[0]].title
    theta = float((np.degrees(-row[record.PSI]) + 90.0 * problem.frame.quarters) % 360.0)
    reach = float(np.degrees(row[record.REACH]))
    across, up = problem.frame.step_back(column[0], line[0])
    holes = tuple(across.tolist()), tuple(up.tolist())
    return Undecided(kind, tuple(faces), *holes, theta, reason, reach if isfinite(reach) else None)
