"""Deciding which records are fixtures: in double precision where that is enough, else in ball arithmetic.

A record has the places of four contacts, with error bounds. It goes through up to four stages, until one of
them decides it:

1. a certificate of its solution (``kernels.proof.newton_kantorovich``), with all rules decided by enclosures;
2. the same for the features' rows as exact numbers, ignoring that the drawing may have been rounded before;
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
from workhold.kernels.proof.interval_newton import compute_jacobians, contract_boxes
from workhold.kernels.proof.merging import merge_boxes
from workhold.kernels.proof.newton_kantorovich import LEAST_REACH, OPEN, PROVEN, certify_records, make_discs
from workhold.model.search_report import GIVEN_UP, UNBOUNDED, UndecidedCandidate
from workhold.proof.degenerate import cannot_hold

if TYPE_CHECKING:
    from workhold.proof.interval_newton import BoxOutcome

__all__ = [
    "SearchReport",
    "DecidingProgress",
    "decide_records",
    "is_standing",
    "merge_overlapping_records",
    "read_peg_integers",
]

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
class DecidingProgress:
    """The progress of deciding records, with a flag to stop; shared by threads.

    Parameters
    ----------
    total : number of records to decide.
    progress : called with the fraction done and the number of records that still may be fixtures.
    cancel : when set, slow stages are skipped, and after ``GRACE`` seconds all others too.
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
        """Whether somebody has asked to stop; when it is first found to be so, the deadline is set to
        ``GRACE`` seconds later."""
        stopped = self.deadline < inf or (self.cancel is not None and self.cancel.is_set())
        if stopped:
            self.deadline = min(self.deadline, perf_counter() + GRACE)
        return stopped

    @property
    def is_late(self) -> bool:
        """Whether somebody asked to stop and the deadline ``GRACE`` seconds after that has passed."""
        return self.is_stopped and perf_counter() >= self.deadline

    def give_up(self) -> None:
        """Stop at once, because the caller no longer waits for the result."""
        self.deadline = 0.0

    def advance(self, done: int, kept: int) -> None:
        """Count ``done`` more records as decided and ``kept`` more as
        kept, and report; may be called from any thread.
        """
        with self.lock:
            self.done += done
            self.kept += kept
        if self.progress is not None and done:
            self.progress(self.fraction, self.kept)

    @property
    def fraction(self) -> float:
        """The fraction of the records that is decided, from 0 to 1."""
        return min(self.done / max(self.total, 1), 1.0)


@define(frozen=True)
class SearchReport:
    """The account of deciding records.

    Parameters
    ----------
    records : number of records examined, decided or undecided, without those in ``left``.
    verified : number of proven fixtures.
    escalated : number of records that the first certificate did not decide, including those in ``given_up``.
    given_up : number of pairs of chords whose crossings the engine did not find.
    undecided : candidates that remain undecided.
    left : number of records not decided when the work was stopped.
    """

    records: int
    verified: int
    escalated: int
    given_up: int
    undecided: tuple[UndecidedCandidate, ...]
    left: int = 0

    @classmethod
    def sum_up(cls, accounts: list[SearchReport]) -> SearchReport:
        """Return one report with the sums of all numbers, and all undecided candidates in order."""
        lost = tuple(item for account in accounts for item in account.undecided)
        records, verified, escalated, given_up, left = (
            sum(getattr(account, name) for account in accounts)
            for name in ("records", "verified", "escalated", "given_up", "left")
        )
        return cls(records, verified, escalated, given_up, lost, left)


def is_standing(standing: NDArray[Any]) -> NDArray[np.bool_]:
    """Return a mask (N, 4) of the pegs on the fixed carrier: the first ``standing`` (N,) of each four pegs."""
    return np.arange(4) < standing[:, None]


def read_peg_integers(records: Array) -> tuple[IntArray, IntArray, IntArray]:
    """Return the features, columns and rows of the pegs of records (M, 19), each (M, 4) of whole numbers.

    See ``kernels.contact.record`` for the layout of records.
    """
    whole = records[:, record.FEATURES : record.PSI].astype(np.int64)
    return whole[:, :4], whole[:, 4:8], whole[:, 8:12]


def compute_peg_places(row: Array, lattice: Lattice) -> list[tuple[float, float]]:
    """Return the places (x, y) of the four pegs of one record in mm
    from the first peg's hole, without the separation.
    """
    _, columns, rows = (numbers[0] for numbers in read_peg_integers(row[None]))
    moves = ~is_standing(row[[record.STANDING]])[0]
    height = rows * lattice.pitch_y + moves * lattice.row_offset
    return [(float(x), float(y)) for x, y in zip(columns * lattice.pitch_x, height, strict=True)]


def bound_box(records: Array, length: float) -> Array:
    """Return bounds (N, 4) in mm of the distance of the exact unknowns from those of each record.

    The unknowns are (L psi, tail x, tail y, separation); ``length`` is L in mm, by which moments are divided.
    """
    turn, radius = (
        length * records[:, record.REACH] + LEAST_REACH,
        records[:, record.LARGEST_RADIUS] + LEAST_REACH,
    )
    return np.stack([turn, radius, radius, 2.0 * (radius + turn)], axis=1)


def decide_records(
    records: Array, problem: Problem, course: DecidingProgress | None = None
) -> tuple[Array, SearchReport]:
    """Decide which records are fixtures.

    Parameters
    ----------
    records : (N, 19) from an engine, laid out as described in ``kernels.contact.record``.
    course : receives the progress, and tells whether to stop.

    Returns
    -------
    (records (M, 19) proven to be fixtures, with their solutions to the last digits; report on all records)
    """
    course = course or DecidingProgress(len(records))
    if course.is_late:
        return records[:0], SearchReport(0, 0, 0, 0, (), len(records))
    given_up = records[:, record.STANDING] < 0.0
    lost = (
        [make_undecided_candidate(row, problem, GIVEN_UP) for row in records[given_up]]
        if given_up.any()
        else []
    )
    chosen = records[~given_up] if lost else records
    proven, rest = sift_records(chosen, problem, problem.setting)
    rest = rest[~cannot_hold(rest, problem)]
    course.advance(len(records) - len(rest), len(proven))
    found, reasons, left = escalate_records(rest, problem, course)
    if len(found):
        proven = np.concatenate([proven, found])
    account = SearchReport(
        len(records) - left, len(proven), len(rest) - left + len(lost), len(lost), (*lost, *reasons), left
    )
    return proven, account


def sift_records(records: Array, problem: Problem, setting: Setting) -> tuple[Array, Array]:
    """Return the records that a certificate proves to be fixtures, with
    polished solutions, and the records it leaves open.

    Records with a certificate that they are not fixtures are in neither.
    """
    solutions = np.empty((len(records), 4))
    verdicts, work = np.full(len(records), PROVEN, np.int8), (np.empty((WORK_LENGTH, 4)), np.empty((2, 4, 2)))
    for outline, kept in list_clearances(problem, setting):
        discs, judged = (
            make_discs(outline, max(kept.standing_radius, kept.moving_radius)),
            np.empty(len(records), np.int8),
        )
        certify_records(records, problem.rows, outline, discs, kept, solutions, judged, *work)
        verdicts = np.minimum(verdicts, judged)
    is_proven = np.flatnonzero(verdicts == PROVEN)
    proven = records.take(is_proven, axis=0)
    proven[:, record.PSI : record.REACH] = solutions.take(is_proven, axis=0)
    return proven, records[verdicts == OPEN]


def list_clearances(problem: Problem, setting: Setting) -> list[tuple[Array, Setting]]:
    """Return pairs (outline, setting) to test the pegs' clearance with, one for each outline (S, 10) that
    carriers meet.

    If both carriers meet the same outline, there is one pair with the given setting. Else there are two, each
    with the peg radius -inf for the carrier that does not meet the outline.
    """
    one, other = problem.outlines
    if one is other:
        return [(one, setting)]
    return [(one, setting._replace(moving_radius=-inf)), (other, setting._replace(standing_radius=-inf))]


def escalate_records(
    records: Array, problem: Problem, course: DecidingProgress
) -> tuple[Array, list[UndecidedCandidate], int]:
    """Decide open records by stages 2 to 4.

    Return (proven fixtures (M, 19), undecided candidates, number of records left because the work was
    stopped). See ``kernels.contact.record`` for the layout of records.
    """
    if len(records) == 0:
        return records, [], 0
    setting = problem.setting._replace(backward_error=0.0)
    proven, rest = sift_records(records, problem, setting)
    course.advance(len(records) - len(rest), len(proven))
    together = merge_overlapping_records(rest, problem)
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
        merge_overlapping_records(np.concatenate(waiting), problem), problem, course
    )
    return np.concatenate([*found, in_balls]), reasons, left + left_out


def decide_by_interval_newton(records: Array, problem: Problem, setting: Setting) -> tuple[Array, Array]:
    """Contract open records in double precision (stage 3); return the
    proven fixtures, and the boxes that stay open.
    """
    slopes = compute_jacobians(records, problem.rows, setting)
    bounded = np.isfinite(records).all(axis=1) & np.isfinite(slopes).all(axis=(1, 2))
    known = records[bounded]
    reach = bound_box(known, problem.wrench_length)
    # Where the orientation is known far better than the place, a frame must not mix them.
    reach[reach[:, 0] >= FLAT * reach[:, 1]] = 1.0
    left, _, right = np.linalg.svd(slopes[bounded] * reach[:, None, :])
    frames = np.stack([left, right.transpose(0, 2, 1)], axis=1)
    verdicts, roots = contract_boxes(known, problem.rows, setting, frames)
    proven, still_open = sift_records(roots, problem, setting)
    return proven, np.concatenate([records[~bounded], known[verdicts == OPEN], still_open])


def merge_overlapping_records(records: Array, problem: Problem) -> Array:
    """Return the records after merging those with overlapping boxes, of the same pegs on the same features,
    into one box around all of them.

    Records are sorted where there are two or more.
    """
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
        records[k] = enclose_corners(records[k], low[k], high[k], problem.wrench_length)
    return np.asarray(records[np.where(heads < 0, -1 - heads, heads)])


def enclose_corners(row: Array, low: Array, high: Array, length: float) -> Array:
    """Return a copy of a record with the smallest box that holds both
    corners (4,), in mm (L psi, tail x, tail y, separation).
    """
    center, half = (low + high) / 2.0, (high - low) / 2.0
    out = row.copy()
    out[record.PSI : record.REACH] = center[0] / length, *center[1:]
    out[record.REACH], out[record.LARGEST_RADIUS] = half[0] / length, max(half[1], half[2], half[3] / 2.0)
    return out


def decide_records_in_balls(
    records: Array, problem: Problem, course: DecidingProgress
) -> tuple[Array, list[UndecidedCandidate], int]:
    """Decide records one by one in ball arithmetic (stage 4).

    Return (proven fixtures (M, 19), undecided candidates, number of records left because the work was
    stopped). See ``kernels.contact.record`` for the layout of records.
    """
    found: list[Array] = []
    reasons: list[UndecidedCandidate] = []
    left = 0
    for k, row in enumerate(records):
        outcome = decide_record_in_balls(row, problem, course)
        if outcome is None:
            left = len(records) - k
            break
        if outcome.reason:
            reasons.append(make_undecided_candidate(row, problem, outcome.reason))
        for solution in outcome.fixtures:
            fixed = row.copy()
            fixed[record.PSI : record.REACH] = solution
            found.append(fixed)
        course.advance(1, len(outcome.fixtures))
    return np.array(found).reshape(-1, record.RECORD_LENGTH), reasons, left


def decide_record_in_balls(row: Array, problem: Problem, course: DecidingProgress) -> BoxOutcome | None:
    """Decide one record in ball arithmetic; return None when the work was stopped before."""
    from workhold.proof.ball_contacts import CandidateBox
    from workhold.proof.interval_newton import BoxOutcome, find_solutions

    length = problem.wrench_length
    turn, right, up, along = (float(v) for v in bound_box(row[None], length)[0])
    if not np.isfinite(row).all():
        return BoxOutcome((), UNBOUNDED)
    psi, x, y, separation = (float(v) for v in row[record.PSI : record.REACH])
    box = CandidateBox(
        features=problem.rows[row[record.FEATURES : record.COLUMNS].astype(np.int64)].tolist(),
        offsets=compute_peg_places(row, problem.frame.lattice),
        standing=int(row[record.STANDING]),
        middle=(psi, x, y, separation),
        reach=(turn / length, right, up, along),
    )
    with BALLS:
        return find_solutions(box, problem.limits, lambda: course.is_stopped)


def make_undecided_candidate(row: Array, problem: Problem, reason: str) -> UndecidedCandidate:
    """Return a record (19,) as an undecided candidate, in the toolkit's frame, with a reason.

    See ``kernels.contact.record`` for the layout of records.
    """
    feature, column, line = read_peg_integers(row[None])
    faces = problem.faces[feature[0]].tolist()
    standing = np.abs(row[[record.STANDING]]).astype(np.int64)
    kind = problem.toolkit.arrangements[problem.toolkit.find_arrangement_numbers(standing)[0]].title
    theta = float((np.degrees(-row[record.PSI]) + 90.0 * problem.frame.quarters) % 360.0)
    reach = float(np.degrees(row[record.REACH]))
    across, up = problem.frame.map_step_to_toolkit(column[0], line[0])
    holes = tuple(across.tolist()), tuple(up.tolist())
    return UndecidedCandidate(kind, tuple(faces), *holes, theta, reason, reach if isfinite(reach) else None)
