"""All equilibria of a pattern of pegs and a part, sorted into seats, passes, loose sets and doubtful ones.

In an equilibrium two or three of a pattern's pegs balance the part, or pegs of one jaw fix it. The same
subset of pegs, up to a shift, occurs in many patterns of one lattice (``seating.pattern``), so its equilibria
are cached with the part.

Glossary
--------
equilibrium : a pose and separation in which pressing contact forces balance; without friction a critical
    point of the separation (E. Rimon and A. Blake 1999, see ``seating.pattern``).
seat : an equilibrium at which the separation has a strict minimum, so that closing ends there.
pass : a saddle of the separation, through which a cage opens; the puncture grasp of Rimon and Blake.
"""

from __future__ import annotations

from itertools import product
from math import cos, inf, sin, sqrt
from threading import Lock

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.conventions import PARALLEL, SAME_CENTER, SAME_POSE
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, RADIUS, SIGN, X, Y
from workhold.kernels.seating.candidates import (
    DOUBTFUL,
    IN_BALANCE,
    NO_BALANCE,
    complete_third,
    complete_three,
    complete_two,
)
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CELL_LENGTH,
    CONTACTS,
    DEPTH,
    FORCE,
    PEG,
    PIECE,
    SECOND,
    SEPARATION,
    HeldPart,
    Manifolds,
    SelfMotions,
)
from workhold.kernels.seating.four_contacts import write_third_of_jaw, write_two_pairs
from workhold.kernels.seating.gathering import GATHERED_LENGTH, SUBSET, write_first_of_equals, write_gathered
from workhold.kernels.seating.parallel_and_concentric import write_about_one_center
from workhold.kernels.seating.slides import (
    write_blocked_slides,
    write_held_slides,
    write_parallel_third_contacts,
)
from workhold.kernels.seating.three_contacts import ROOT_LENGTH, write_three_contacts
from workhold.seating.antipodal_contacts import find_antipodal_candidates, find_parallel_candidates
from workhold.seating.closing import ClosingMotion, DescentCache, DescentPaths, ensure_room, fill_rows
from workhold.seating.contact_forces import complete_with_forces, judge_candidates, write_forces_on_wall
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.part_features import HullSide
from workhold.seating.pattern import Pattern, PegSubset, list_subsets
from workhold.seating.self_motions import (
    NO_MOTIONS,
    SHORTEST,
    SLIDE_STEPS,
    ManifoldFinder,
    SelfMotion,
    find_motions_on_one_center,
    find_motions_on_one_line,
    find_motions_on_parallel_lines,
    find_pattern_motions,
    is_balanced,
    join_manifolds,
    make_turning_motion,
)
from workhold.seating.two_contact_curves import TwoContactCurves
from workhold.seating.wall_equilibria import LOCATOR, ON_WALL, TIP, WallEquilibria, find_wall_candidates

__all__ = ["Equilibria", "SubsetCache", "SubsetEquilibria", "find_equilibria", "find_subset_equilibria"]

Array = NDArray[np.float64]
# Subsets of which something is kept, and nodes of their descent paths, of 80 bytes; with more, all are
# forgotten.
MOST_KEPT, MOST_NODES = 1024, 600_000
NONE = np.zeros((0, CANDIDATE_LENGTH))
# Candidates of a subset and its self-motions, see ``SubsetEquilibria``.
Found = tuple[Array, SelfMotions]


@frozen(eq=False)
class SubsetEquilibria:
    """The equilibria of a subset of pegs, in the subset's own frame.

    Parameters
    ----------
    first, end : the subset's candidates are rows ``first`` to ``end`` - 1 of ``SubsetCache.candidates``. Two
        or three contacts balance in each. For pegs of one jaw, three contacts fix the part instead, at the
        place that it has at separation 0.
    motions : self-motions: how the part can move between these pegs at one separation.
    descents : descent paths from the candidates that have been followed so far.
    """

    first: int
    end: int
    motions: SelfMotions
    descents: DescentPaths


@define(eq=False)
class SubsetCache:
    """Cache of the equilibria of subsets of pegs on a part.

    Parameters
    ----------
    found : the equilibria of each subset, by the part's size and ``PegSubset.key``.
    descents : the descent paths from these equilibria.
    candidates : (C, 24) candidates of all subsets; rows from ``count`` on are not used yet. Rows never move.
    count : number of candidates.
    """

    found: dict[tuple[object, ...], SubsetEquilibria] = field(factory=dict)
    descents: DescentCache = field(factory=DescentCache)
    candidates: Array = field(factory=lambda: NONE)
    count: int = 0
    lock: Lock = field(factory=Lock)

    def add_candidates(self, rows: Array) -> int:
        """Append candidates (N, 24), and return the index of the first of them in ``candidates``.

        A candidate is a configuration with contacts and forces that may be an equilibrium, see
        ``kernels.seating.columns``.
        """
        with self.lock:
            first = self.count
            self.candidates = ensure_room(self.candidates, first, len(rows))
            self.candidates[first : first + len(rows)] = rows
            self.count += len(rows)
        return first

    @classmethod
    def find_for_boundary(cls, boundary: ObstacleBoundary) -> SubsetCache:
        """Return the cache of a part; if it is full, replace it with an empty one and return that.

        Callers that already hold the full cache can go on using it.
        """
        kept = boundary.find_once(cls.make_empty)
        is_full = len(kept.found) >= MOST_KEPT or kept.descents.counts[1] > MOST_NODES
        return boundary.find_once(cls.make_empty, anew=True) if is_full else kept

    @classmethod
    def make_empty(cls, _: ObstacleBoundary) -> SubsetCache:
        """Return an empty cache. The argument is ignored."""
        return cls()


def find_subset_equilibria(
    kept: SubsetCache, boundary: ObstacleBoundary, subset: PegSubset, size: float
) -> SubsetEquilibria:
    """Return the equilibria of a subset of pegs from the cache ``kept``; if they are not there, compute and
    add them.

    ``size`` is the part's in mm.
    """
    key = size, subset.key
    found = kept.found.get(key)
    if found is None:
        kind = (
            find_jaw_equilibria
            if subset.is_of_a_jaw
            else pair_equilibria
            if len(subset.sides) == 2
            else find_triple_equilibria
        )
        candidates, motions = kind(boundary, subset, size)
        passes = NONE if subset.is_of_a_jaw else candidates
        descents = DescentPaths(ClosingMotion(boundary, subset.pattern, size), passes, kept.descents)
        first = kept.add_candidates(candidates)
        found = kept.found[key] = SubsetEquilibria(first, first + len(candidates), motions, descents)
    return found


def pair_equilibria(boundary: ObstacleBoundary, subset: PegSubset, size: float) -> Found:
    """Return the equilibria of two pegs, one of each jaw: (candidates (N, 24), self-motions).

    The candidates are antipodal contacts whose forces balance. In a self-motion the part moves while the
    separation stays the same: it slides along parallel faces or turns about concentric arcs. A candidate is a
    configuration with contacts and forces that may be an equilibrium, see ``kernels.seating.columns``.
    """
    pattern, given = subset.pattern, TwoContactCurves.from_one_jaw(boundary, subset).given
    candidates = find_antipodal_candidates(boundary, pattern)
    return balance_candidates(candidates, given, size), ManifoldFinder(boundary, pattern).find_free_motions(
        find_motions_on_one_line(boundary, pattern)
    )


def find_triple_equilibria(boundary: ObstacleBoundary, subset: PegSubset, size: float) -> Found:
    """Return the equilibria of three pegs, two of one jaw and one of the other: (candidates (N, 24),
    self-motions).

    A candidate is a configuration with contacts and forces that may be an equilibrium, see
    ``kernels.seating.columns``.
    """
    # The only peg of the other jaw has two contacts in pockets alone.
    pattern, curves = subset.pattern, TwoContactCurves.from_one_jaw(boundary, subset)
    given, slides = curves.given, curves.slides
    [(known, _, _)] = curves.jaws.values()
    work = np.empty((DEPTH, 2)), np.empty((5, len(boundary.discs)))
    sought = known.cells, known.middles, curves.sought, boundary.discs, pattern.stop
    roots = fill_rows(ROOT_LENGTH, 1024, write_three_contacts, *sought, *work)
    candidates = [
        fill_rows(CANDIDATE_LENGTH, len(roots) + 1, complete_three, roots, given, boundary.pocket_pieces),
        *(
            [fill_rows(CANDIDATE_LENGTH, 256, write_parallel_third_contacts, slides, given)]
            if len(slides)
            else []
        ),
        *find_parallel_candidates(boundary, pattern, given),
        fill_rows(CANDIDATE_LENGTH, 64, write_about_one_center, given, pattern.stop, pattern.widest),
    ]
    every = np.concatenate(candidates)
    motions = [
        *find_motions_on_parallel_lines(boundary, pattern, slides, given),
        *find_motions_on_one_center(boundary, pattern),
    ]
    reached = every[pattern.is_reachable(every[:, SEPARATION])]
    return balance_candidates(reached, given, size), ManifoldFinder(boundary, pattern).find_free_motions(
        motions
    )


def find_jaw_equilibria(boundary: ObstacleBoundary, subset: PegSubset, _: float) -> Found:
    """Return (candidates (N, 24) in which pegs of one jaw alone fix the part by three contacts, no
    self-motions).

    Three pegs touch once each, or one of two pegs touches twice in a pocket. The last argument is ignored. A
    candidate is a configuration with contacts and forces that may be an equilibrium, see
    ``kernels.seating.columns``.
    """
    curves, stack = TwoContactCurves.from_one_jaw(boundary, subset), np.empty((DEPTH, 2))
    [(known, _, _)] = curves.jaws.values()
    roots = fill_rows(
        ROOT_LENGTH,
        1024,
        write_third_of_jaw,
        known.cells,
        known.middles,
        curves.sought,
        boundary.discs,
        stack,
    )
    fixed = [
        fill_rows(
            CANDIDATE_LENGTH, len(roots) + 1, complete_third, roots, curves.given, boundary.pocket_pieces
        ),
        fill_rows(CANDIDATE_LENGTH, 256, write_blocked_slides, curves.slides, curves.given),
    ]
    return np.concatenate(fixed), NO_MOTIONS


def balance_candidates(candidates: Array, given: HeldPart, size: float) -> Array:
    """Return those candidates (N, 24) whose contact forces balance or may balance, with their forces written.

    Candidates in which another peg enters the part are kept. The forces are also written into the given
    array. ``size`` is the part's in mm. A candidate is a configuration with contacts and forces that may be
    an equilibrium, see ``kernels.seating.columns``.
    """
    return np.asarray(
        candidates[judge_candidates(complete_with_forces(candidates, given, size), inf, inf) != NO_BALANCE]
    )


def find_wall_manifolds(finder: ManifoldFinder) -> list[Manifolds]:
    """Return the loose sets of a part that touches a wall, as a list of ``Manifolds``.

    In a loose set the part rests anywhere along a motion, and nothing locates it there.
    """
    wall = WallEquilibria(finder.boundary, finder.pattern)
    return find_wall_slides(finder, wall) + find_wall_turns(finder, wall)


def find_wall_slides(finder: ManifoldFinder, wall: WallEquilibria) -> list[Manifolds]:
    """Return the sets of equilibria in which a part slides along a wall, with a hull edge on the wall.

    The clamp's tip presses a face parallel to that edge, between the edge's ends. The list is empty where the
    tip does not push towards the wall.
    """
    if wall.half_plane[0] <= 0.0:
        return []
    out, (tx, ty) = [], finder.pattern.pegs[TIP].tolist()
    for side, number in product(wall.sides, finder.lines):
        row, theta = finder.rows[number], wall.compute_outward_direction() - side.angle
        c, s = cos(theta), sin(theta)
        # Its normal is x.
        nx, ny = c * row[AXIS_Y] + s * row[AXIS_X], s * row[AXIS_Y] - c * row[AXIS_X]
        if nx < 0.0 or abs(ny) > PARALLEL or not finder.boundary.can_touch(1, number):
            continue
        known = wall.find_resting_place(side.pieces[0], theta)
        ends = sorted(float(s * x + c * y) for x, y in finder.boundary.hull.rows[list(side.pieces), :2])
        middle = s * row[X] + c * row[Y]
        low = max(ty - ends[1], ty - middle - row[HALF_EXTENT])
        high = min(ty - ends[0], ty - middle + row[HALF_EXTENT])
        separation = known + c * row[X] - s * row[Y] - tx
        if high - low > SHORTEST and finder.pattern.is_reachable(separation, SHORTEST):
            every = np.ones(SLIDE_STEPS)
            configs = np.stack(
                [theta * every, known * every, np.linspace(low, high, SLIDE_STEPS), separation * every],
                axis=1,
            )
            manifolds = finder.cut_into_manifolds(
                finder.find_free_motions([SelfMotion(configs, [(TIP, number)], False, None)])
            )
            for candidate in manifolds.rows:
                name_both_edge_ends(candidate, wall, side)
            out.append(manifolds)
    return out


def name_both_edge_ends(row: Array, wall: WallEquilibria, side: HullSide) -> None:
    """Extend the contacts of a candidate (24,) in place, so that both ends of a hull edge on the wall are
    among them.

    The candidate must already have a contact with the wall. Nothing is added where it has four contacts; the
    contact's piece is set to the start of the edge in any case. A candidate is a configuration with contacts
    and forces that may be an equilibrium, see ``kernels.seating.columns``.
    """
    count = int(row[CONTACTS])
    pegs = row[PEG : PEG + count].tolist()
    row[PIECE + pegs.index(ON_WALL[0])] = wall.make_wall_contact(side.pieces[0])[1]
    if count < 4:
        row[PEG + count], row[PIECE + count] = wall.make_wall_contact(side.pieces[1], True)
        row[CONTACTS] = count + 1


def find_wall_turns(finder: ManifoldFinder, wall: WallEquilibria) -> list[Manifolds]:
    """Return the loose sets in which a part on a wall turns about the common centre of concentric arcs.

    One arc lies on the wall and one touches the clamp's tip. Either a third arc touches the locator, or the
    locator does not touch and the tip pushes towards the wall.
    """
    out, (ux, uy, off) = list[Manifolds](), wall.half_plane
    (lx, ly), (tx, ty) = finder.pattern.pegs[LOCATOR].tolist(), finder.pattern.pegs[TIP].tolist()
    hull = finder.boundary.hull.rows
    for group, piece in product(finder.boundary.concentric, range(len(hull))):
        first = finder.rows[group[0]]
        if hull[piece, 2] == 0.0 or np.hypot(*(first[[X, Y]] - hull[piece, :2])) > SAME_CENTER:
            continue
        known = (ux + uy) * (off + hull[piece, 2])
        for tip in (k for k in group if finder.boundary.can_touch(1, k)):
            signed = float(finder.rows[tip, SIGN] * finder.rows[tip, RADIUS])
            if ux > 0.0:
                across = (0.0, 1.0) if signed > 0.0 else None
                motions = make_turning_motion(
                    finder.pattern, first, (known, ty), known + signed - tx, [(TIP, tip)], across
                )
                out.append(finder.cut_into_manifolds(finder.find_free_motions(motions)))
            for locator in (k for k in group if finder.boundary.can_touch(0, k)):
                bend = float(finder.rows[locator, SIGN] * finder.rows[locator, RADIUS])
                square = bend**2 - ((known - lx) if ux else (known - ly)) ** 2
                for turn in (1.0, -1.0) if square > 0.0 else ():
                    center = (known, ly + turn * sqrt(square)) if ux else (lx + turn * sqrt(square), known)
                    reach = signed**2 - (ty - center[1]) ** 2
                    if reach <= 0.0:
                        continue
                    # The tip's normal is forward.
                    separation = center[0] + float(finder.rows[tip, SIGN]) * sqrt(reach) - tx
                    at = (lx, ly), (tx + separation, ty)
                    normals = [
                        ((x - center[0]) / radius, (y - center[1]) / radius)
                        for (x, y), radius in zip(at, (bend, signed), strict=True)
                    ]
                    if is_balanced([(-ux, -uy), *normals], [0, 0, 1]):
                        contacts = [(LOCATOR, locator), (TIP, tip)]
                        motions = make_turning_motion(
                            finder.pattern, first, center, separation, contacts, None
                        )
                        out.append(finder.cut_into_manifolds(finder.find_free_motions(motions)))
    return out


# mm. Pegs that do not touch may be in the part by this much: rounding.
CLEAR_SLACK = 1e-7
# mm. Pegs may be in the part by this much where bounds leave in doubt whether the place exists, which is less
# well known.
CLEAR_IN_DOUBT = 1e-5
# mm. Configurations this near are one equilibrium; those in doubt this near count as one.
SAME, SAME_DOUBT = 1e-5, 0.1


@define(frozen=True, eq=False)
class Equilibria:
    """The equilibria of a pattern of pegs and a part. Rows (24,) are candidates, see
    ``kernels.seating.columns``.

    Parameters
    ----------
    seats : (N, 24) equilibria at which the separation has a strict minimum, in ascending order of separation.
    passes : (N, 24) saddles: there is one direction in which the separation falls, to both sides. In
        ascending order of separation.
    loose : sets of equilibria with the same separation, along which the part can move.
    doubtful : (N, 24) candidates that error bounds neither prove nor exclude; of several near each other, the
        one with the largest forces.
    origins : (N, 2) for each pass the index in ``subsets`` of the pegs that touch there, and the candidate's
        number in the ``DescentCache``; -1 where the pass belongs to no subset.
    subsets : the subsets of pegs, each with its descent paths.
    """

    seats: Array
    passes: Array
    loose: Manifolds
    doubtful: Array
    origins: NDArray[np.int64]
    subsets: tuple[tuple[PegSubset, DescentPaths], ...] = ()


def find_equilibria(boundary: ObstacleBoundary, pattern: Pattern, size: float) -> Equilibria:
    """Return all equilibria of a pattern and a part.

    ``size`` is the part's in mm, by which moments are divided.
    """
    if pattern.half_plane is not None:
        return find_wall_equilibria(boundary, pattern, size)
    curves, finder = TwoContactCurves.from_pattern(boundary, pattern), ManifoldFinder(boundary, pattern)
    given, jaws, pockets = (
        curves.given,
        (curves.make_jaw_cells(0), curves.make_jaw_cells(1)),
        boundary.pocket_pieces,
    )
    work = np.empty((2, CELL_LENGTH)), np.empty((DEPTH, 2)), np.empty(len(jaws[1].cells), np.int64)
    roots = fill_rows(ROOT_LENGTH, 1024, write_two_pairs, *jaws, curves.sought, *work)
    two = fill_rows(CANDIDATE_LENGTH, len(roots) + 1, complete_two, roots, given, pockets)
    slid = fill_rows(CANDIDATE_LENGTH, 256, write_held_slides, curves.slides, *jaws, given, pockets)
    kept, ends = SubsetCache.find_for_boundary(boundary), (pattern.stop, pattern.widest)
    parts = [(one, find_subset_equilibria(kept, boundary, one, size)) for one in list_subsets(pattern)]
    numbers = [(own.first, own.end, own.descents.first, *one.numbers_and_shift) for one, own in parts]
    room = len(two) + len(slid) + sum(own.end - own.first for _, own in parts) + 256
    given_subsets = np.array(numbers, dtype=np.float64), kept.candidates
    among = *given_subsets, two, slid, *ends, given, np.empty(CANDIDATE_LENGTH)
    found = fill_rows(GATHERED_LENGTH, room, write_gathered, *among)
    every = complete_with_forces(np.ascontiguousarray(found[:, :SUBSET]), given, size)
    loose = finder.drop_contained(
        finder.cut_into_manifolds(find_pattern_motions([(one, own.motions) for one, own in parts]))
    )
    subsets = tuple((one, own.descents) for one, own in parts)
    return sort_equilibria(every, loose, found[:, SUBSET:].astype(np.int64), subsets)


def find_wall_equilibria(boundary: ObstacleBoundary, pattern: Pattern, size: float) -> Equilibria:
    """Return all equilibria of a part and a pattern with a wall; ``size`` is the part's in mm."""
    pressed = find_antipodal_candidates(boundary, pattern)
    candidates = np.concatenate([pressed, find_wall_candidates(boundary, pattern)])
    write_forces_on_wall(candidates, boundary, pattern, size)
    finder = ManifoldFinder(boundary, pattern)
    loose = join_manifolds(
        [
            finder.cut_into_manifolds(finder.find_free_motions(find_motions_on_one_line(boundary, pattern))),
            *find_wall_manifolds(finder),
        ]
    )
    return sort_equilibria(candidates, finder.drop_contained(loose), np.full((len(candidates), 2), -1))


def sort_equilibria(
    candidates: Array,
    loose: Manifolds,
    origins: NDArray[np.int64],
    subsets: tuple[tuple[PegSubset, DescentPaths], ...] = (),
) -> Equilibria:
    """Return the equilibria among candidates (N, 24), sorted into seats, passes and doubtful ones.

    The candidates have their forces already, and ``origins`` (N, 2) has a row for each. ``loose`` and
    ``subsets`` are passed on, see ``Equilibria``. A candidate is a configuration with contacts and forces
    that may be an equilibrium, see ``kernels.seating.columns``.
    """
    balance = judge_candidates(candidates, CLEAR_SLACK, CLEAR_IN_DOUBT)
    sure = balance == IN_BALANCE
    found = candidates[sure]
    order = number_first_of_equals(found, SAME_POSE, SAME)
    found, whose = found[order], origins[sure][order]
    four = found[:, CONTACTS] == 4.0
    is_pass = ~four & (found[:, SECOND] < 0.0)
    doubtful = candidates[balance == DOUBTFUL]
    if len(doubtful):
        doubtful = doubtful[np.argsort(-doubtful[:, FORCE : FORCE + 4].sum(axis=1), kind="stable")]
        doubtful = doubtful[number_first_of_equals(doubtful, SAME_DOUBT, SAME_DOUBT)]
    seats, passes = found[four | (found[:, SECOND] > 0.0)], found[is_pass]
    return Equilibria(seats, passes, loose, doubtful, whose[is_pass], subsets)


def number_first_of_equals(rows: Array, turn: float, shift: float) -> NDArray[np.int64]:
    """Return the indices of candidates (N, 24), leaving out each one that equals an earlier candidate.

    The indices are in ascending order of separation. Two candidates are equal if they have the same number of
    contacts and their configurations differ by less than ``turn`` radians and ``shift`` mm. A candidate is a
    configuration with contacts and forces that may be an equilibrium, see ``kernels.seating.columns``.
    """
    kept = np.empty(len(rows), np.int64)
    kept = kept[: write_first_of_equals(rows, turn, shift, kept)]
    return kept[np.argsort(rows[kept, SEPARATION], kind="stable")]
