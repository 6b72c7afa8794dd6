"""The equilibria of a pattern gathered: candidates from subsets of its pegs, and manifolds, each once.

Candidates of subsets are kept in the subsets' own frames. Columns of a subset:

- FIRST, END : of its candidates among all that are kept.
- NUMBER : of the first in their origins.
- JAW : 0 or 1 where its pegs are all of one jaw and fix the part to it, else -1.
- NAMES : four names, the pattern's numbers of its pegs, and last -1 of none.
- SHIFT : what is added to x, y and S.

Columns of what is gathered are those of a candidate, then SUBSET and ORIGIN: the subset that the candidate
comes from and its number in the origins, both -1 where it comes from no subset. For equilibrium manifolds,
functions here find the configurations that lie in them and the starts of descent paths off them.
"""

from __future__ import annotations

from math import hypot, inf, pi

from workhold.kernels.base.compiling import (
    Array,
    IntArray,
    IntVector,
    Matrix,
    Vector,
    compiled,
    inner,
)
from workhold.kernels.seating.candidates import add_fourths
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONTACTS,
    PEG,
    PLACE_X,
    PLACE_Y,
    SEPARATION,
    THETA,
    HeldPart,
    Manifolds,
)
from workhold.kernels.seating.obstacles import compute_length

FIRST, END, NUMBER, JAW, NAMES, SHIFT = 0, 1, 2, 3, 4, 8
SUBSET, ORIGIN = CANDIDATE_LENGTH, CANDIDATE_LENGTH + 1
GATHERED_LENGTH = CANDIDATE_LENGTH + 2


@inner
def write_moved(row: Array, subset: Array, out: Array) -> None:
    """Write a candidate of a subset of pegs to ``out`` as a candidate of the whole pattern: with the
    pattern's peg numbers, and x, y, S shifted.

    ``subset`` is a row (11,) with NAMES (4) and SHIFT (3). See ``seating.columns`` for the layout of ``row``,
    ``seating.gathering`` for that of ``subset``. S is the jaw separation in mm.
    """
    for k in range(CANDIDATE_LENGTH):
        out[k] = row[k]
    for k in range(3):
        out[PLACE_X + k] = row[PLACE_X + k] + subset[SHIFT + k]
    for k in range(PEG, PEG + 4):
        out[k] = subset[NAMES + (int(row[k]) if row[k] >= 0.0 else 3)]


@inner
def keep_reached(out: Array, count: int, end: int, stop: float, widest: float) -> int:
    """Drop those of the rows ``count`` to ``end`` - 1 of ``out`` whose separation is not between ``stop`` and
    ``widest``.

    The rows kept move up, and their columns SUBSET and ORIGIN become -1. Return the new number of rows.
    """
    for n in range(count, end):
        if stop < out[n, SEPARATION] < widest:
            for k in range(CANDIDATE_LENGTH):
                out[count, k] = out[n, k]
            out[count, SUBSET] = out[count, ORIGIN] = -1.0
            count += 1
    return count


@inner
def add_rows(rows: Array, stop: float, widest: float, out: Array, count: int) -> int:
    """Append candidates of no subset with separations between ``stop`` and ``widest`` to ``out`` (N, 26).

    Return the new number of rows, or -1 when there is no room for all of ``rows``. See ``seating.columns``
    for the layout of ``rows``.
    """
    if count + rows.shape[0] > out.shape[0]:
        return -1
    for n in range(rows.shape[0]):
        for k in range(CANDIDATE_LENGTH):
            out[count + n, k] = rows[n, k]
    return keep_reached(out, count, count + rows.shape[0], stop, widest)


@compiled
def write_gathered(
    subsets: Matrix,
    kept: Matrix,
    before: Matrix,
    after: Matrix,
    stop: float,
    widest: float,
    given: HeldPart,
    fixed: Vector,
    out: Matrix,
) -> int:
    """Write all candidates of a pattern with separations between ``stop`` and ``widest`` to ``out``.

    Return their number, or -1 when there is no room. For subsets whose pegs are all of one jaw, the
    candidates are those with a fourth contact, on the other jaw. See ``seating.gathering`` for the layout of
    ``subsets``, ``seating.columns`` for that of ``fixed``.

    Parameters
    ----------
    subsets : (G, 11) with columns FIRST, END, NUMBER, JAW, NAMES (4), SHIFT (3).
    kept : (C, 24) candidates of subsets, in the subsets' frames.
    before, after : (N, 24) candidates of no subset, which come before and after those of subsets.
    stop, widest : separations in mm.
    given : of the pattern.
    fixed : (24,) work space.
    out : (N, 26) receives the candidates with SUBSET and ORIGIN.
    """
    count = add_rows(before, stop, widest, out, 0)
    for number in range(subsets.shape[0]):
        subset = subsets[number]
        first = int(subset[FIRST])
        for n in range(first, int(subset[END])):
            if count < 0 or count >= out.shape[0]:
                return -1
            if subset[JAW] >= 0.0:
                write_moved(kept[n], subset, fixed)
                end = add_fourths(fixed, int(subset[JAW]), given, out, count)
                count = keep_reached(out, count, end, stop, widest) if end >= 0 else -1
            elif stop < kept[n, SEPARATION] + subset[SHIFT + 2] < widest:
                write_moved(kept[n], subset, out[count])
                out[count, SUBSET], out[count, ORIGIN] = number, subset[NUMBER] + (n - first)
                count += 1
    return -1 if count < 0 else add_rows(after, stop, widest, out, count)


# mm. How much farther than to the next of its steps a place may be from a set in which it lies.
BESIDE = 0.02
# Contacts that a candidate has at most.
MOST_CONTACTS = 4


@inner
def find_longest_step(sets: Array, begin: int, end: int, arm: float) -> float:
    """Return the length in mm of the longest step between neighbouring configurations of ``sets[begin:end]``.

    A turn in radians counts as ``arm`` times that many mm.
    """
    longest = 0.0
    for n in range(begin + 1, end):
        dx, dy = sets[n, 1] - sets[n - 1, 1], sets[n, 2] - sets[n - 1, 2]
        longest = max(longest, abs(sets[n, 0] - sets[n - 1, 0]) * arm + abs(dx) + abs(dy))
    return longest


@inner
def is_in_manifold(config: Array, manifolds: Manifolds, number: int, arm: float, most: float) -> bool:
    """Return whether a configuration (4,) lies in a set, to within the distances between neighbours in the
    set.

    A configuration is theta in radians, x, y and the jaw separation S in mm.

    Parameters
    ----------
    number : of the set.
    arm : in mm; a turn in radians times this is compared with shifts.
    most : by how much in mm the separation may differ.
    """
    if not abs(config[3] - manifolds.rows[number, SEPARATION]) < most:
        return False
    sets, nearest = manifolds.configs, inf
    begin, end = manifolds.begins[number], manifolds.begins[number + 1]
    for n in range(begin, end):
        turn = (sets[n, 0] - config[0] + pi) % (2.0 * pi) - pi
        nearest = min(
            nearest, abs(turn) * arm + compute_length(sets[n, 1] - config[1], sets[n, 2] - config[2])
        )
    return nearest <= BESIDE or nearest <= find_longest_step(sets, begin, end, arm) + BESIDE


@inner
def find_first_manifold(config: Array, manifolds: Manifolds, asked: IntArray, arm: float, most: float) -> int:
    """Return the position in ``asked`` (numbers of sets) of the first
    set in which a configuration lies, or -1.

    ``arm`` and ``most`` are those of :func:`is_in_manifold`. A configuration is theta in radians, x, y and
    the jaw separation S in mm.
    """
    for k in range(asked.shape[0]):
        if is_in_manifold(config, manifolds, asked[k], arm, most):
            return k
    return -1


@compiled
def write_first_manifolds(
    configs: Matrix, manifolds: Manifolds, asked: IntVector, arm: float, most: float, out: IntVector
) -> None:
    """Write the result of :func:`find_first_manifold` for each of N configurations (N, 4) to ``out`` (N,).

    A configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    for n in range(configs.shape[0]):
        out[n] = find_first_manifold(configs[n], manifolds, asked, arm, most)


@inner
def write_set(manifolds: Manifolds, number: int, out: Manifolds, at: int) -> None:
    """Copy set ``number`` of ``manifolds`` to set ``at`` of ``out``,
    whose sets before that are written already.
    """
    begin, to = manifolds.begins[number], out.begins[at]
    for j in range(manifolds.rows.shape[1]):
        out.rows[at, j] = manifolds.rows[number, j]
    for n in range(manifolds.begins[number + 1] - begin):
        for j in range(4):
            out.configs[to + n, j] = manifolds.configs[begin + n, j]
    out.begins[at + 1] = to + manifolds.begins[number + 1] - begin
    out.closed[at] = manifolds.closed[number]
    out.across[at, 0], out.across[at, 1] = manifolds.across[number, 0], manifolds.across[number, 1]


@compiled
def write_distinct_sets(manifolds: Manifolds, arm: float, most: float, out: Manifolds) -> int:
    """Write the sets to ``out``, except those whose middle lies in another set with as many contacts or more;
    return the number of sets written.

    Parameters
    ----------
    arm, most : see :func:`is_in_manifold`.
    out : receives the sets in descending order of their numbers of contacts.
    """
    count = 0
    for contacts in range(MOST_CONTACTS, -1, -1):
        for number in range(manifolds.rows.shape[0]):
            if manifolds.rows[number, CONTACTS] == contacts:
                is_new = True
                for k in range(count):
                    if is_in_manifold(manifolds.rows[number], out, k, arm, most):
                        is_new = False
                        break
                if is_new:
                    write_set(manifolds, number, out, count)
                    count += 1
    return count


@compiled
def write_starts_beyond_ends(
    manifolds: Manifolds, arm: float, step: float, configs: Matrix, whose: IntVector
) -> int:
    """Write configurations just past both ends of each equilibrium manifold to ``configs``; return their
    number.

    For a set that gives way (``across`` is not NaN) they are on both sides of its middle; for a whole turn
    there are none. A configuration is theta in radians, x, y and the jaw separation S in mm.

    Parameters
    ----------
    arm : in mm; a turn in radians times this is compared with shifts.
    step : how far beyond, in mm.
    configs, whose : (2 F, 4) and (2 F,) receive the configurations and the numbers of their sets.
    """
    count = 0
    for number in range(manifolds.rows.shape[0]):
        begin, end = manifolds.begins[number], manifolds.begins[number + 1]
        gives = manifolds.across[number, 0] == manifolds.across[number, 0]
        if not gives and (manifolds.closed[number] != 0 or end - begin < 3):
            continue
        for side in range(2):
            config = configs[count]
            # The end may be the same as the configuration before it, but not as the one before that.
            at, before = (begin, begin + 2) if side == 0 else (end - 1, end - 3)
            turn = (manifolds.configs[at, 0] - manifolds.configs[before, 0] + pi) % (2.0 * pi) - pi
            dx = manifolds.configs[at, 1] - manifolds.configs[before, 1]
            dy = manifolds.configs[at, 2] - manifolds.configs[before, 2]
            away = abs(turn) * arm + hypot(dx, dy)
            for j in range(4):
                config[j] = manifolds.rows[number, j] if gives else manifolds.configs[at, j]
            if gives:
                sign = 1.0 if side == 0 else -1.0
                config[1] += sign * (step * manifolds.across[number, 0])
                config[2] += sign * (step * manifolds.across[number, 1])
            elif away > 0.0:
                config[0] += step * turn / away
                config[1] += step * dx / away
                config[2] += step * dy / away
            if gives or away > 0.0:
                whose[count] = number
                count += 1
    return count


@compiled
def write_first_of_equals(rows: Matrix, turn: float, shift: float, kept: IntVector) -> int:
    """Write the indices of those candidates (N, 24) that equal no earlier candidate to ``kept``; return their
    number.

    See ``seating.columns`` for the layout of ``rows``.

    Parameters
    ----------
    turn, shift : differences in radians and mm below which two configurations with as many contacts are
        equal.
    """
    count = 0
    for n in range(rows.shape[0]):
        row, is_new = rows[n], True
        for k in range(count):
            other = rows[kept[k]]
            if (
                abs(other[SEPARATION] - row[SEPARATION]) < shift
                and abs(other[PLACE_X] - row[PLACE_X]) < shift
                and abs(other[PLACE_Y] - row[PLACE_Y]) < shift
                and abs((other[THETA] - row[THETA] + pi) % (2.0 * pi) - pi) < turn
                and other[CONTACTS] == row[CONTACTS]
            ):
                is_new = False
                break
        if is_new:
            kept[count] = n
            count += 1
    return count
