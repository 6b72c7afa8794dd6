"""All equilibria of a pattern of pegs and a part, sorted into seats, passes and what is loose or not settled.

Glossary
--------
seat : an equilibrium at which the separation has a strict minimum, so that closing ends there.
pass : a saddle of the separation, through which a cage opens; the puncture grasp of E. Rimon and A. Blake,
    "Caging planar bodies by one-parameter two-fingered gripping systems", International Journal of Robotics
    Research 18 (1999).
"""

from __future__ import annotations

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.conventions import SAME_POSE
from workhold.kernels.seating.candidates import DOUBTFUL, IN_BALANCE, complete_two
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CELL_LENGTH,
    CONTACTS,
    DEPTH,
    FORCE,
    SECOND,
    SEPARATION,
    Manifolds,
    SelfMotions,
)
from workhold.kernels.seating.four_contacts import two_pairs
from workhold.kernels.seating.freedom import first_of_each
from workhold.kernels.seating.slides import slides_held
from workhold.kernels.seating.subset_candidates import GATHERED_LENGTH, SUBSET, gathered
from workhold.kernels.seating.three_contacts import ROOT_LENGTH
from workhold.seating.antipodal_contacts import antipodal_candidates
from workhold.seating.contact_forces import settle_on_wall, verdicts, with_forces
from workhold.seating.descent_paths import DescentPaths
from workhold.seating.equilibrium_manifolds import ManifoldFinder, joined, of_pattern
from workhold.seating.growing_rows import filled
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern
from workhold.seating.peg_subsets import PegSubset, subsets_of
from workhold.seating.self_motions import on_one_line
from workhold.seating.subset_equilibria import SubsetCache, equilibria_of_subset
from workhold.seating.two_contact_curves import TwoContactCurves
from workhold.seating.wall_equilibria import wall_candidates
from workhold.seating.wall_manifolds import wall_manifolds

__all__ = ["Equilibria", "equilibria"]

Array = NDArray[np.float64]

# mm. Pegs that do not touch may be in the part by this much: rounding.
CLEAR_SLACK = 1e-7
# mm. Pegs may be in the part by this much where bounds leave in doubt whether the place exists, which is less
# well known.
CLEAR_IN_DOUBT = 1e-5
# mm. Configurations this near are one equilibrium; those in doubt this near count as one.
SAME, SAME_DOUBT = 1e-5, 0.1


@define(frozen=True, eq=False)
class Equilibria:
    """The equilibria of a pattern.

    Parameters
    ----------
    seats : (N, 24) candidates at which the separation has a strict minimum, ordered by it.
    passes : (N, 24) candidates with one direction in which the separation falls, to both sides.
    loose : equilibrium manifolds, each of one separation.
    doubtful : (N, 24) candidates that bounds did not prove to exist, of near ones the one that presses
        hardest.
    origins : (N, 2) for each pass the number of the subset that makes it, and of its candidate among all that
        are kept; -1 where none does.
    subsets : the subsets of pegs, with their descent paths.
    """

    seats: Array
    passes: Array
    loose: Manifolds
    doubtful: Array
    origins: NDArray[np.int64]
    subsets: tuple[tuple[PegSubset, DescentPaths], ...] = ()


def equilibria(boundary: ObstacleBoundary, pattern: Pattern, size: float) -> Equilibria:
    """All equilibria of a pattern; moments are divided by the part's ``size`` in mm."""
    if pattern.half_plane is not None:
        return equilibria_on_wall(boundary, pattern, size)
    curves, finder = TwoContactCurves.of(boundary, pattern), ManifoldFinder(boundary, pattern)
    given, jaws, pockets = curves.given, (curves.of_jaw(0), curves.of_jaw(1)), boundary.pocket_pieces
    work = np.empty((2, CELL_LENGTH)), np.empty((DEPTH, 2)), np.empty(len(jaws[1].cells), np.int64)
    roots = filled(ROOT_LENGTH, 1024, two_pairs, *jaws, curves.sought, *work)
    two = filled(CANDIDATE_LENGTH, len(roots) + 1, complete_two, roots, given, pockets)
    slid = filled(CANDIDATE_LENGTH, 256, slides_held, curves.slides, *jaws, given, pockets)
    kept, ends, of_subsets = SubsetCache.on(boundary), (pattern.stop, pattern.widest), list[tuple[float, ...]]()
    subsets, motions = list[tuple[PegSubset, DescentPaths]](), list[tuple[PegSubset, SelfMotions]]()
    for subset in subsets_of(pattern):
        own = equilibria_of_subset(kept, boundary, subset, size)
        of_subsets.append((own.first, own.end, own.descents.first, *subset.numbers_and_shift))
        subsets.append((subset, own.descents))
        motions.append((subset, own.motions))
    room = len(two) + len(slid) + sum(int(end - first) for first, end, *_ in of_subsets) + 256
    among = np.array(of_subsets, dtype=np.float64), kept.candidates, two, slid, *ends, given, np.empty(CANDIDATE_LENGTH)
    found = filled(GATHERED_LENGTH, room, gathered, *among)
    every = with_forces(np.ascontiguousarray(found[:, :SUBSET]), given, size)
    loose = finder.distinct(finder.cut(of_pattern(motions)))
    return sorted_out(every, loose, found[:, SUBSET:].astype(np.int64), tuple(subsets))


def equilibria_on_wall(boundary: ObstacleBoundary, pattern: Pattern, size: float) -> Equilibria:
    """All equilibria between a wall, a locator and a tip."""
    pressed = antipodal_candidates(boundary, pattern)
    candidates = np.concatenate([pressed, wall_candidates(boundary, pattern)])
    settle_on_wall(candidates, boundary, pattern, size)
    finder = ManifoldFinder(boundary, pattern)
    loose = joined([finder.cut(finder.free(on_one_line(boundary, pattern))), *wall_manifolds(finder)])
    return sorted_out(candidates, finder.distinct(loose), np.full((len(candidates), 2), -1))


def sorted_out(
    candidates: Array,
    loose: Manifolds,
    origins: NDArray[np.int64],
    subsets: tuple[tuple[PegSubset, DescentPaths], ...] = (),
) -> Equilibria:
    """Sorts candidates with forces into seats and passes; the other arguments are those of ``Equilibria``."""
    balance = verdicts(candidates, CLEAR_SLACK, CLEAR_IN_DOUBT)
    sure = balance == IN_BALANCE
    found = candidates[sure]
    order = once(found, SAME_POSE, SAME)
    found, whose = found[order], origins[sure][order]
    four = found[:, CONTACTS] == 4.0
    is_pass = ~four & (found[:, SECOND] < 0.0)
    doubtful = candidates[balance == DOUBTFUL]
    if len(doubtful):
        doubtful = doubtful[np.argsort(-doubtful[:, FORCE : FORCE + 4].sum(axis=1), kind="stable")]
        doubtful = doubtful[once(doubtful, SAME_DOUBT, SAME_DOUBT)]
    seats, passes = found[four | (found[:, SECOND] > 0.0)], found[is_pass]
    return Equilibria(seats, passes, loose, doubtful, whose[is_pass], subsets)


def once(rows: Array, turn: float, shift: float) -> NDArray[np.int64]:
    """Numbers of candidates, ordered by separation; of configurations that agree, the first."""
    kept = np.empty(len(rows), np.int64)
    kept = kept[: first_of_each(rows, turn, shift, kept)]
    return kept[np.argsort(rows[kept, SEPARATION], kind="stable")]
