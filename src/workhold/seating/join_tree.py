"""The join tree of the separation: the passes at which cages join or the part gets out, and the rest poses.

Both descent paths from each pass are followed to their ends. While the jaws open, cages grow, and two cages
become one at the lowest pass between them. So passes are taken in ascending order of their separation. Rest
poses of the part as drawn and turned over are computed once for all fixtures on the same pegs.

Glossary
--------
join tree : the tree that tells which components of a function's sublevel sets join at which saddle: H. Carr,
    J. Snoeyink and U. Axen, "Computing contour trees in all dimensions", Computational Geometry 24 (2003).
place : the end of a descent path: a seat, a loose set, a doubtful configuration, the outside or the stop.
loose set : an equilibrium manifold, along which nothing locates the part.
join : a pass, with the places that both of its descent paths end in.
rest pose : a pose in which a part comes to rest by itself: K. Goldberg, B. Mirtich, Y. Zhuang, J. Craig, B.
    Carlisle and J. Canny, "Part pose statistics: estimators and experiments", IEEE Transactions on Robotics
    and Automation 15 (1999).
"""

from __future__ import annotations

from functools import cached_property
from math import inf, pi, tau

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.kernels.seating.closing import AT_REST, AT_THE_STOP
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONFIG,
    CONTACTS,
    PEG,
    PIECE,
    SEPARATION,
    Manifolds,
)
from workhold.kernels.seating.descent_paths import (
    BESIDE,
    FALLS,
    find_pass_to_outside,
    write_known_path_ends,
    write_last_free_nodes,
    write_places,
)
from workhold.kernels.seating.gathering import write_first_manifolds, write_starts_beyond_ends
from workhold.seating.closing import LONGEST_STEP, ClosingMotion, find_descent_starts
from workhold.seating.equilibria import Equilibria
from workhold.seating.obstacle_boundary import ObstacleBoundary

__all__ = [
    "CURVED",
    "KINDS",
    "LOOSE",
    "POCKET",
    "UNSETTLED",
    "CageJoin",
    "JoinTree",
    "RestPoses",
    "measure_distances",
    "follow_pass_descents",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def follow_pass_descents(
    found: Equilibria, closing: ClosingMotion, seats: Array
) -> tuple[Array, Array, NDArray[np.int8]]:
    """Return the two descent paths from each of N passes: starts (2 N, 4), ends (2 N, 4), and how they end (2
    N,).

    Rows 2 n and 2 n + 1 belong to pass n. ``seats`` (M, 4) are configurations at which closing is known to
    end.
    """
    starts, lengths = find_descent_starts(found.passes, closing.size)
    ends, how, left = np.array(starts), np.full(len(starts), AT_REST, np.int8), np.ones(len(starts), np.int8)
    known = np.flatnonzero(found.origins[:, 0] >= 0)
    if len(known):
        cache, shifts = found.subsets[0][1].cache, compute_subset_shifts(found)
        paths = select_free_paths(found, known, closing, shifts)
        write_known_path_ends(
            known, *paths, cache.nodes, cache.begins, cache.how, shifts, ends, lengths, left
        )
    rest = np.flatnonzero(left)
    ends[rest], how[rest] = closing.close_from(ends[rest], lengths[rest], seats)
    return starts, ends, how


def compute_subset_shifts(found: Equilibria) -> Array:
    """Return the vectors (G, 4) to add to configurations of each of the G subsets to get configurations of
    the pattern.
    """
    return np.array([subset.shift for subset, _ in found.subsets])


def select_free_paths(
    found: Equilibria, passes: IntArray, closing: ClosingMotion, shifts: Array
) -> tuple[IntArray, IntArray, IntArray]:
    """Return the two cached descent paths of each of N passes, and the part of each that is free of the
    pattern's other pegs.

    Three arrays (2 N,): the path's number in the cache; the index of its subset; its last node at which no
    other peg is inside the part. Paths not yet in the cache are followed and added. ``passes`` are indices of
    passes with origins; ``shifts`` are those of :func:`compute_subset_shifts`.
    """
    whose, numbers = found.origins[passes, 0], found.origins[passes, 1]
    cache = found.subsets[0][1].cache
    new = cache.numbers[numbers, 0] < 0
    for subset in dict.fromkeys(whose[new].tolist()):
        found.subsets[subset][1].follow(numbers[new & (whose == subset)])
    paths, whose = cache.numbers[numbers].ravel(), np.repeat(whose, 2)
    others = np.ones((len(found.subsets), len(closing.pattern.pegs)), np.int8)
    for row, (subset, _) in zip(others, found.subsets, strict=True):
        row[list(subset.numbers)] = 0
    most, lasts = LONGEST_STEP * min(closing.pattern.radii), np.empty(len(paths), np.int64)
    work = shifts, others, most, closing.obstacles, np.empty((4, 4))
    write_last_free_nodes(paths, whose, cache.nodes, cache.begins, *work, lasts)
    return paths, whose, lasts


# mm. How long the first steps of a descent path off a loose set are.
FIRST_STEP = BESIDE / 2.0


@frozen
class CageJoin:
    """A pass, and the two places whose cages become one there.

    Parameters
    ----------
    separation : S of the pass in mm.
    candidate : (24,) the pass.
    places : numbers of the places at which its two descent paths end, see ``JoinTree``.
    """

    separation: float
    candidate: Array = field(eq=False)
    places: tuple[int, int]


@define(frozen=True, eq=False, slots=False)
class JoinTree:
    """The places in which closing ends, and the passes at which their cages join.

    Places are numbered: 0 to N - 1 are seats, the next L are loose sets, the next M are doubtful
    configurations; -1 is the outside (the part gets away), -2 the stop of the jaws.

    Parameters
    ----------
    seats : (N, 24) seats.
    loose : (L, 24) loose sets (the part rests anywhere along a motion) from which no path leads down.
    slack : (K, 24) loose sets with three or more contacts from which a path leads down. Whether the part
        rests there is not known; they are not places.
    doubtful : (M, 4) configurations for which error bounds do not decide whether the part rests there.
    passes : (J, 24) passes in ascending order of separation.
    joined : (J, 2) numbers of the places at which the two descent paths of each pass end.
    own : (N + L,) for each seat and loose set its own number; for a seat that lies on a loose set, the number
        of that set.
    """

    seats: Array
    loose: Array
    slack: Array
    doubtful: Array
    passes: Array
    joined: IntArray
    own: IntArray

    @classmethod
    def from_equilibria(cls, found: Equilibria, closing: ClosingMotion) -> JoinTree:
        """Return the join tree of equilibria, found by following the descent paths from all passes and loose
        sets.
        """
        loose, size, configs = found.loose, closing.size, np.ascontiguousarray(found.seats[:, CONFIG])
        # A flat face may lead on from a curved seat: such a seat is a place of its own only where nothing
        # leads on.
        strict = np.flatnonzero(find_loose_sets(configs, loose, np.arange(len(loose.rows)), size) < 0)
        strict = strict[np.argsort(configs[strict, 3], kind="stable")]
        seats, off = configs[strict], ManifoldDescents.from_manifolds(loose, closing, configs[strict])
        first = len(configs) + len(off.lying)
        parts = off.both, follow_pass_descents(found, closing, seats), off.one
        starts, ends, how = (np.concatenate([part[k] for part in parts]) for k in range(3))
        leaves = closing.find_escaping_at_stop(starts, ends, how == AT_THE_STOP).astype(np.int8)
        doubtful, count = np.empty((len(found.doubtful) + len(ends), 4)), len(found.doubtful)
        doubtful[:count] = found.doubtful[:, CONFIG]
        places = np.empty(len(ends) - len(off.falling), np.int64)
        known = ends, how, leaves, loose, off.lying, off.falling, seats, strict, first, size
        count = write_places(*known, doubtful, count, np.empty(len(off.falling), np.int64), places)
        passes = np.concatenate([loose.rows[off.dividing], found.passes])
        order, own = np.argsort(passes[:, SEPARATION], kind="stable"), np.arange(first)
        beside = find_loose_sets(configs, loose, off.lying, size)
        own[: len(configs)][beside >= 0] = len(configs) + beside[beside >= 0]
        rows = found.seats, loose.rows[off.lying], loose.rows[off.slack]
        return cls(*rows, doubtful[:count], passes[order], places.reshape(-1, 2)[order], own)

    @cached_property
    def first_joins(self) -> IntArray:
        """The index of the lowest pass at which each place's cage joins another cage, -1 if there is none.

        The array (N + L + M + 2,) is indexed by the number of the place: its last two entries are the stop
        (-2) and the outside (-1).
        """
        out = np.full(len(self.own) + len(self.doubtful) + 2, -1)
        leading = np.flatnonzero(self.joined[:, 0] != self.joined[:, 1])[::-1]
        out[self.joined[leading]] = leading[:, None]
        return out

    def make_join(self, number: int) -> CageJoin:
        """Return the pass with the index ``number`` in ``passes``."""
        one, two = self.joined[number].tolist()
        return CageJoin(float(self.passes[number, SEPARATION]), self.passes[number], (one, two))

    def find_first_join(self, place: int) -> CageJoin | None:
        """Return the lowest pass at which the cage of a seat or loose set joins another cage; None if there
        is none.
        """
        number = int(self.first_joins[self.own[place]])
        return None if number < 0 else self.make_join(number)

    @property
    def tops(self) -> Array:
        """For each seat and loose set, the separation in mm of the lowest pass out of its cage (N + L,); inf
        without a pass.
        """
        return np.append(self.passes[:, SEPARATION], inf)[self.first_joins[self.own]]

    def find_escape_separation(self, place: int) -> float | None:
        """Return the least separation in mm at which a part can get from a place to the outside; None if it
        cannot.
        """
        number = find_pass_to_outside(
            self.joined, int(self.own[place]), np.empty(len(self.first_joins), np.int64)
        )
        return None if number < 0 else float(self.passes[number, SEPARATION])


@frozen(eq=False)
class ManifoldDescents:
    """The descent paths from loose sets, in which a part rests anywhere along a motion.

    Parameters
    ----------
    lying : (L,) indices of sets from which no path leads down.
    falling : (G,) indices of sets from which a path leads down.
    slack : those indices of ``falling`` whose sets have three or more contacts; a part may still rest on
        them.
    dividing : (D,) indices of sets with two paths that lead down, one to each side.
    both : for the paths from dividing sets, starts (2 D, 4), ends (2 D, 4) and how they end (2 D,).
    one : for the first path from each falling set, starts (G, 4), ends (G, 4) and how it ends (G,).
    """

    lying: IntArray
    falling: IntArray
    slack: IntArray
    dividing: IntArray
    both: tuple[Array, Array, NDArray[np.int8]]
    one: tuple[Array, Array, NDArray[np.int8]]

    @classmethod
    def from_manifolds(cls, loose: Manifolds, closing: ClosingMotion, seats: Array) -> ManifoldDescents:
        """Return the descent paths from loose sets; ``seats`` (M, 4) are configurations at which closing is
        known to end.
        """
        if not len(loose.rows):
            return NOTHING
        starts, whose = np.empty((2 * len(loose.rows), 4)), np.empty(2 * len(loose.rows), np.int64)
        count = write_starts_beyond_ends(loose, closing.size, BESIDE, starts, whose)
        starts, whose = starts[:count], whose[:count]
        ends, how = closing.close_from(starts, FIRST_STEP, seats)
        falls = np.flatnonzero(ends[:, 3] < loose.rows[whose, SEPARATION] - FALLS)
        paths = np.bincount(whose[falls], minlength=len(loose.rows))
        falling, first = np.flatnonzero(paths), falls[np.searchsorted(whose[falls], np.flatnonzero(paths))]
        both = paths[whose] == 2
        # A part on two pegs that slides off does not rest at all; on three or more it lies there a while.
        rests = (loose.rows[falling, CONTACTS] >= 3.0) & np.isnan(loose.across[falling, 0])
        return cls(
            np.flatnonzero(paths == 0),
            falling,
            falling[rests],
            np.flatnonzero(paths == 2),
            (starts[both], ends[both], how[both]),
            (starts[first], ends[first], how[first]),
        )


NUMBERS, PATHS = np.zeros(0, np.int64), (np.zeros((0, 4)), np.zeros((0, 4)), np.zeros(0, np.int8))
NOTHING = ManifoldDescents(NUMBERS, NUMBERS, NUMBERS, NUMBERS, PATHS, PATHS)


def find_loose_sets(configs: Array, loose: Manifolds, asked: IntArray, size: float) -> IntArray:
    """Return for each configuration (N, 4) the loose set in which it lies, as an index into ``asked``; -1 for
    none.

    Only the sets with the indices ``asked`` are tried; the first that fits counts. ``size`` is the part's in
    mm.
    """
    out = np.empty(len(configs), np.int64)
    write_first_manifolds(configs, loose, asked, size, FALLS, out)
    return out


def measure_distances(configs: Array, others: Array, size: float) -> Array:
    """Return the distances in mm between configurations (..., 4) and ``others`` (..., 4), broadcast.

    A distance is the distance of the places (x, y), plus the turn in radians (at most pi) times ``size``
    (mm). Separations do not count.
    """
    turn = np.abs((configs[..., 0] - others[..., 0] + pi) % tau - pi)
    return np.asarray(
        turn * size + np.hypot(configs[..., 1] - others[..., 1], configs[..., 2] - others[..., 2])
    )


# mm. Seats from which a part is out again with less are not listed: they may be or not.
SHALLOW = 1e-3
# The kinds of seats, and their numbers.
KINDS = "curved", "corner", "pocket", "fixture", "loose", "unsettled"
CURVED, CORNER, POCKET, FIXTURE, LOOSE, UNSETTLED = range(len(KINDS))
# Kinds from here on are listed whatever their depth: they are fixtures of a complete list, or their depth is
# not known.
ALWAYS = FIXTURE


@frozen(eq=False)
class RestPoses:
    """The poses in which a part can rest in a pattern, without seats so shallow that they may not exist.

    Parameters
    ----------
    rows : (N, 24) candidates; if it is not known whether the part rests there, only the configuration is
        filled in.
    kinds : (N,) indices into ``KINDS``.
    depths : (N,) opening in mm beyond which the part can leave for another place; inf if it never can, and if
        that is not known.
    turned_over : (N,) whether it is a pose of the part turned over.
    """

    rows: Array
    kinds: NDArray[np.int64]
    depths: Array
    turned_over: NDArray[np.bool_]

    @classmethod
    def from_join_trees(
        cls, trees: tuple[JoinTree, JoinTree], boundary: ObstacleBoundary, pegs: int
    ) -> RestPoses:
        """Return the rest poses from two join trees: first those of the part as drawn, then those of the part
        turned over.

        ``pegs`` is the number of pegs in the pattern; a wall does not count.
        """
        parts, tops = list[Array](), list[Array]()
        for tree in trees:
            unknown = np.zeros((len(tree.doubtful), CANDIDATE_LENGTH))
            unknown[:, CONFIG] = tree.doubtful
            parts += [tree.seats, tree.loose, tree.slack, unknown]
            tops += [tree.tops, tree.slack[:, SEPARATION], np.full(len(unknown), inf)]
        counts = [len(part) for part in parts]
        rows = np.concatenate(parts)
        kinds = np.repeat([FIXTURE, LOOSE, LOOSE, UNSETTLED] * 2, counts)
        kinds[kinds == FIXTURE] = classify_seats(rows[kinds == FIXTURE], boundary, pegs)
        depths = np.concatenate(tops) - rows[:, SEPARATION]
        listed = (kinds >= ALWAYS) | (depths >= SHALLOW)
        turned_over = np.arange(len(rows)) >= sum(counts[:4])
        return cls(rows[listed], kinds[listed], depths[listed], turned_over[listed])


def classify_seats(rows: Array, boundary: ObstacleBoundary, pegs: int) -> NDArray[np.int64]:
    """Return the kinds (N,) of seats (N, 24), as indices into ``KINDS``.

    CURVED: fewer than four contacts. With four contacts, POCKET: a peg touches twice; CORNER: no peg touches
    twice, and a peg touches a corner of the part; FIXTURE: all other seats. ``pegs`` is the number of pegs
    without a wall.
    """
    who, where = (rows[:, at : at + 4].astype(np.int64) for at in (PEG, PIECE))
    ordered = np.sort(who, axis=1)
    twice = (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)
    # A corner on a wall is not one that a peg has to keep to.
    corner = (boundary.corners[where] & (who < pegs)).any(axis=1)
    four = np.where(twice, POCKET, np.where(corner, CORNER, FIXTURE))
    return np.where(rows[:, CONTACTS] < 4.0, CURVED, four)
