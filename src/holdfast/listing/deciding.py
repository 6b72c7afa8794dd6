"""Deciding which records are fixtures: in double precision where that is enough, else in ball arithmetic.

A record tells where four contacts are and how far the exact ones may be from there. It goes through up to four stages, and
leaves with the first that decides it:

1. a certificate of its solution (``certificate``), with all rules decided by enclosures;
2. the same with the contact equations computed in ball arithmetic;
3. the fold lemma (``folds``): two solutions that merge or nearly so; where they are apart, stage 2 for each;
4. an interval Newton search of the whole box in ball arithmetic (``settling``).
"""

from __future__ import annotations

import numpy as np
from attrs import define
from numpy.typing import NDArray

from holdfast.kernels import vise_checks as record
from holdfast.kernels.distance import outline_distances
from holdfast.listing.certificate import (
    DISCARDED,
    OPEN,
    PROVEN,
    ROUNDINGS,
    Rules,
    certificate,
    coordinates,
    judged,
    slacks,
)
from holdfast.listing.polish import Contacts, contacts_at, polish
from holdfast.listing.problem import Problem
from holdfast.model.proof import Undecided
from holdfast.model.vise import Vise

__all__ = ["Account", "contacts_of", "decided", "is_left", "peg_integers"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Verdicts = NDArray[np.int8]

# A peg may be inside the part by this much, in mm, in the check that follows the proof.
TOUCH = 1e-7
# Where an engine tells nothing better, the exact contact is this near, in mm.
LEAST_REACH = 1e-9
# Error in mm of contact equations computed in ball arithmetic.
TINY = 1e-30
# How often the fold lemma is applied: its boxes shrink quadratically.
FOLDINGS = 3
# Numbers of the rules bend by at most this many times (1 / R + 1 / L) over the square of a step, in units of the slope.
BENDS = 10.0
GIVEN_UP = "the pair of chords of these faces and steps could not be bounded there"
UNBOUNDED = "where its contacts may lie could not be bounded"


@define(frozen=True)
class Account:
    """What became of records: how many there were, proven fixtures, how many went to ball arithmetic, how many were pairs
    of chords that the engine had given up, and the undecided."""

    records: int
    verified: int
    escalated: int
    given_up: int
    undecided: tuple[Undecided, ...]

    @classmethod
    def together(cls, accounts: list[Account]) -> Account:
        """Several accounts as one."""
        lost = tuple(item for account in accounts for item in account.undecided)
        records, verified, escalated, given_up = (
            sum(getattr(account, name) for account in accounts)
            for name in ("records", "verified", "escalated", "given_up")
        )
        return cls(records, verified, escalated, given_up, lost)


def is_left(kind: IntArray) -> NDArray[np.bool_]:
    """Which of the four pegs are on the left jaw, (N, 4)."""
    return np.arange(4) < np.where(kind == 1, 2, 3)[:, None]


def peg_integers(records: Array) -> tuple[IntArray, IntArray, IntArray]:
    """Features, columns and rows of records, each (N, 4)."""
    whole = records[:, record.FEATURES : record.PSI].astype(np.int64)
    return whole[:, :4], whole[:, 4:8], whole[:, 8:12]


def peg_places(records: Array, vise: Vise) -> tuple[Array, Array]:
    """Places (N, 4, 2) of the pegs in mm from the first, with the right jaw at zero, and which move with it (N, 4)."""
    whole = records[:, record.COLUMNS : record.PSI]
    right = ~is_left(records[:, record.KIND].astype(np.int64))
    height = whole[:, 4:] * vise.pitch[1] + right * vise.row_offset
    return np.stack([whole[:, :4] * vise.pitch[0], height], axis=-1), right.astype(np.float64)


def unknowns(records: Array) -> tuple[Array, Array, Array]:
    """Orientation (N,), tail (N, 2) and distance apart (N,) of records."""
    return records[:, record.PSI], records[:, record.TAIL_X : record.TAIL_Y + 1], records[:, record.APART]


def contacts_of(records: Array, problem: Problem) -> Contacts:
    """The contacts of records as they are."""
    rows = problem.rows[peg_integers(records)[0], :8]
    return contacts_at(rows, *unknowns(records), *peg_places(records, problem.vise), problem.wrench_length)


def rules_of(records: Array, problem: Problem) -> Rules:
    """What records are judged by."""
    return Rules(
        problem.rows[peg_integers(records)[0]],
        is_left(records[:, record.KIND].astype(np.int64)),
        problem.contact_margin,
        problem.vise.min_gap,
        problem.wrench_length,
    )


def box_reach(records: Array, length: float) -> Array:
    """How far the exact unknowns (L psi, tail x, tail y, apart) may be from those of records, (N, 4) in mm."""
    turn, radius = length * records[:, record.REACH] + LEAST_REACH, records[:, record.RADIUS] + LEAST_REACH
    return np.stack([turn, radius, radius, 2.0 * (radius + turn)], axis=1)


def decided(records: Array, problem: Problem) -> tuple[Array, Account]:
    """Decide records.

    Parameters
    ----------
    records : (N, 19) from an engine, laid out as ``kernels.vise_checks`` says.

    Returns
    -------
    (those proven to be fixtures, with their solutions to the last digits; what became of all)
    """
    given_up = records[:, record.KIND] < 0.0
    lost = [undecided(row, problem, GIVEN_UP) for row in records[given_up]]
    records = records[~given_up]
    contacts = polish(
        problem.rows[peg_integers(records)[0], :8],
        *unknowns(records),
        *peg_places(records, problem.vise),
        problem.wrench_length,
    )
    error = ROUNDINGS * coordinates(contacts) + problem.blur
    verdicts = verdicts_on(records, contacts, error, problem)
    is_open = verdicts == OPEN
    settled, reasons = escalated(records[is_open], problem)
    proven = np.concatenate([solved(records, contacts)[verdicts == PROVEN], settled])
    left_open = int(is_open.sum()) + len(lost)
    account = Account(len(records) + len(lost), len(proven), left_open, len(lost), (*lost, *reasons))
    return proven, account


def verdicts_on(records: Array, contacts: Contacts, error: Array, problem: Problem) -> Verdicts:
    """Verdicts on records from certificates of their solutions; open where another solution may be in the box."""
    certified = certificate(contacts, problem.wrench_length, error)
    verdicts = judged(contacts, certified, rules_of(records, problem))
    psi, tail, apart = unknowns(records)
    away = np.stack(
        [
            problem.wrench_length * np.abs(contacts.psi - psi),
            np.abs(contacts.tail - tail).max(axis=1),
            np.abs(contacts.apart - apart),
        ]
    ).max(axis=0, initial=0.0)
    alone = away + box_reach(records, problem.wrench_length).max(axis=1, initial=0.0) <= certified.unique
    verdicts = np.where(alone, verdicts, OPEN)
    # The trimmed features keep a peg clear of the rest of the part; this is looked at once more.
    clear = outline_distances(contacts.points.reshape(-1, 2), problem.outline).reshape(-1, 4).min(axis=1)
    return np.where((verdicts == PROVEN) & (clear < problem.vise.peg_radius - TOUCH), DISCARDED, verdicts)


def solved(records: Array, contacts: Contacts) -> Array:
    """Records with the unknowns of contacts."""
    out = records.copy()
    out[:, record.PSI], out[:, record.APART] = contacts.psi, contacts.apart
    out[:, record.TAIL_X : record.TAIL_Y + 1] = contacts.tail
    return out


def escalated(records: Array, problem: Problem) -> tuple[Array, list[Undecided]]:
    """Decide open records with the help of ball arithmetic: the fixtures among them, and what stays undecided."""
    if len(records) == 0:
        return records, []
    from holdfast.listing.folds import exactly_polished

    found: list[Array] = []

    def refined(chosen: Array) -> Array:
        """Take out what exact certificates decide, and return the rest."""
        if len(chosen) == 0:
            return chosen
        places = peg_places(chosen, problem.vise)
        contacts = exactly_polished(contacts_of(chosen, problem), *places, problem.wrench_length)
        verdicts = verdicts_on(chosen, contacts, np.full(len(chosen), TINY), problem)
        found.append(solved(chosen, contacts)[verdicts == PROVEN])
        return np.asarray(chosen[verdicts == OPEN])

    rest = merged(refined(records), problem)
    for _ in range(FOLDINGS):
        halves, rest = unfolded(rest, problem)
        if len(halves) == 0:
            break
        rest = np.concatenate([rest, refined(halves)])
    settled, reasons = settled_records(merged(rest, problem), problem)
    return np.concatenate([*found, settled]), reasons


def unfolded(records: Array, problem: Problem) -> tuple[Array, Array]:
    """Apply the fold lemma: boxes about single solutions instead of records that hold two, and the records left as they
    are. Records without solutions, or where a rule is broken all along, are discarded."""
    if len(records) == 0:
        return records, records
    from holdfast.listing.folds import fold

    length = problem.wrench_length
    reach = np.sqrt((box_reach(records, length) ** 2).sum(axis=1))
    folds = fold(contacts_of(records, problem), reach, *peg_places(records, problem.vise), length)
    rules = rules_of(records, problem)
    # A rule that is broken at both ends is broken between, up to the bend of its number.
    smallest = np.where(rules.features[..., 0] == 0.0, np.inf, rules.features[..., 6]).min(axis=1, initial=np.inf)
    between = np.abs(np.stack(box_steps(folds.low, folds.high, length))).max(axis=0, initial=0.0)
    bend = folds.radius + BENDS * between**2 * (1.0 / smallest + 1.0 / length)
    with np.errstate(all="ignore"):
        broken = (slacks(folds.low, bend, rules)[1] < 0.0) & (slacks(folds.high, bend, rules)[1] < 0.0)
    left = (folds.at_low | folds.at_high) & ~(np.isfinite(bend) & broken.any(axis=0))
    # A box is worth dividing only if the parts are much smaller.
    split = left & folds.apart & (folds.near < 0.3 * reach)
    halves = []
    for end, there in ((folds.low, folds.at_low), (folds.high, folds.at_high)):
        half = solved(records, end)[split & there]
        half[:, record.REACH] = folds.near[split & there] / length
        half[:, record.RADIUS] = folds.near[split & there]
        halves.append(half)
    return np.concatenate(halves), records[left & ~split]


def merged(records: Array, problem: Problem) -> Array:
    """Records of the same pegs on the same features whose boxes overlap, as one with a box around all."""
    if len(records) < 2:
        return records
    order = np.lexsort([records[:, record.PSI], *(records[:, k] for k in range(record.PSI - 1, -1, -1))])
    reach = box_reach(records, problem.wrench_length)
    psi, tail, apart = unknowns(records)
    middle = np.column_stack([problem.wrench_length * psi, tail, apart])
    out: list[Array] = []
    low = high = middle[order[0]]
    for n, k in enumerate(order):
        same = n > 0 and bool((records[k, : record.PSI] == records[order[n - 1], : record.PSI]).all())
        bottom, top = middle[k] - reach[k], middle[k] + reach[k]
        if same and np.isfinite(reach[k]).all() and bool((bottom <= high).all() and (low <= top).all()):
            low, high = np.minimum(low, bottom), np.maximum(high, top)
            center, half = (low + high) / 2.0, (high - low) / 2.0
            row = out[-1]
            row[record.PSI], row[record.APART] = center[0] / problem.wrench_length, center[3]
            row[record.TAIL_X : record.TAIL_Y + 1] = center[1:3]
            row[record.REACH], row[record.RADIUS] = (
                half[0] / problem.wrench_length,
                max(half[1], half[2], half[3] / 2.0),
            )
        else:
            low, high = bottom, top
            out.append(records[k].copy())
    return np.array(out)


def box_steps(one: Contacts, two: Contacts, length: float) -> tuple[Array, ...]:
    """Differences of the unknowns of contacts, (N,) each, in mm."""
    tail = two.tail - one.tail
    return length * (two.psi - one.psi), tail[:, 0], tail[:, 1], two.apart - one.apart


def settled_records(records: Array, problem: Problem) -> tuple[Array, list[Undecided]]:
    """Records settled one by one: the fixtures among them, and what stays undecided."""
    from holdfast.listing.settling import Box, Limits, settle

    limits = Limits(problem.contact_margin, problem.vise.min_gap, problem.wrench_length)
    offsets, _ = peg_places(records, problem.vise)
    reach = box_reach(records, problem.wrench_length)
    found: list[Array] = []
    reasons: list[Undecided] = []
    for k, row in enumerate(records):
        if not np.isfinite(reach[k]).all():
            reasons.append(undecided(row, problem, UNBOUNDED))
            continue
        features = problem.rows[row[record.FEATURES : record.COLUMNS].astype(np.int64)]
        psi, x, y, apart = (float(v) for v in row[record.PSI : record.REACH])
        turn, right, up, open_by = (float(v) for v in reach[k])
        lefts = 2 if row[record.KIND] == 1.0 else 3
        places = [(float(u), float(v)) for u, v in offsets[k]]
        widths = (turn / problem.wrench_length, right, up, open_by)
        outcome = settle(Box(features.tolist(), places, lefts, (psi, x, y, apart), widths), limits)
        if outcome.reason:
            reasons.append(undecided(row, problem, outcome.reason))
        for solution in outcome.fixtures:
            fixed = row.copy()
            fixed[record.PSI : record.REACH] = solution
            found.append(fixed)
    return np.array(found).reshape(-1, record.RECORD_LENGTH), reasons


def undecided(row: Array, problem: Problem, reason: str) -> Undecided:
    """A record that is not decided, for the account."""
    feature, column, line = peg_integers(row[None])
    faces = problem.faces[feature[0]].tolist()
    kind = "I" if abs(row[record.KIND]) == 1.0 else "II"
    theta = float(np.degrees(-row[record.PSI]) % 360.0)
    return Undecided(kind, tuple(faces), tuple(column[0].tolist()), tuple(line[0].tolist()), theta, reason)
