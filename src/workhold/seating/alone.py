"""What two or three pegs of a pattern do by themselves, found once for all patterns in which they stand alike."""

from __future__ import annotations

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.kernels.seating.candidates import complete_third, complete_three, settle
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONTACTS,
    DEPTH,
    DOUBT,
    FORCE,
    RESIDUAL,
    SEPARATION,
    Given,
    Ways,
)
from workhold.kernels.seating.concentric import about_one_center
from workhold.kernels.seating.four_contacts import third_of_jaw
from workhold.kernels.seating.slides import slides_squared, slides_stopped
from workhold.kernels.seating.three_contacts import ROOT_LENGTH, three_contacts
from workhold.seating.common_normals import squeezed
from workhold.seating.descents import Closing
from workhold.seating.families import NO_WAYS, Finder
from workhold.seating.filled import filled
from workhold.seating.groups import Group
from workhold.seating.holdings import Holdings
from workhold.seating.locus import Locus
from workhold.seating.pattern import Pattern
from workhold.seating.tangent import tangent
from workhold.seating.ways_down import Trodden, WaysDown

__all__ = ["Alone", "Kept", "alone", "balanced", "settled"]

Array = NDArray[np.float64]
# Groups of which something is kept, and nodes of their ways down, of 80 bytes; beyond, all are forgotten.
MOST_KEPT, MOST_NODES = 1024, 600_000
# No unit. Forces balance to this, per unit of jaw force; each is above the second; in doubt, what bounds left so.
BALANCED, LEAST_FORCE, BALANCED_IN_DOUBT = 1e-7, 1e-9, 1e-3
NONE = np.zeros((0, CANDIDATE_LENGTH))
# Of a group its candidates, what fixes the part and the ways, as of ``Alone``.
Told = tuple[Array, Array, Ways]


@frozen(eq=False)
class Alone:
    """What a group of pegs does, in its own frame.

    Parameters
    ----------
    candidates : (N, 24) those of two or three contacts in which forces balance.
    fixed : (N, 24) of pegs of one jaw: where they touch in three places, the part's place that at separation 0.
    ways : that the part can go between the pegs with one separation.
    down : off the candidates, as far as they were followed.
    """

    candidates: Array
    fixed: Array
    ways: Ways
    down: WaysDown


@define(eq=False)
class Kept:
    """What is known of groups on a part.

    Parameters
    ----------
    found : what each does, by how its pegs stand.
    trodden : their ways down.
    """

    found: dict[tuple[object, ...], Alone] = field(factory=dict)
    trodden: Trodden = field(factory=Trodden)

    @classmethod
    def on(cls, locus: Locus) -> Kept:
        """What is kept of the groups on a part: nothing when it has become too much. Who has it goes on with it."""
        kept = locus.alone.get("kept")
        if kept is None or len(kept.found) >= MOST_KEPT or kept.trodden.counts[1] > MOST_NODES:
            kept = locus.alone["kept"] = cls()
        return kept


def alone(kept: Kept, locus: Locus, group: Group, size: float) -> Alone:
    """What a group does; ``size`` in mm as of ``equilibria``."""
    key = size, *group.key
    found = kept.found.get(key)
    if found is None:
        kind = jaw_alone if group.is_of_a_jaw else two_alone if len(group.sides) == 2 else three_alone
        candidates, fixed, ways = kind(locus, group.pattern, size)
        closing = Closing(locus, group.pattern, size)
        found = kept.found[key] = Alone(candidates, fixed, ways, WaysDown(closing, candidates, kept.trodden))
    return found


def two_alone(locus: Locus, pattern: Pattern, size: float) -> Told:
    """Of a peg of each jaw: on common normals, and on parallel faces or arcs of one centre."""
    given, finder = Holdings.of(locus, pattern).given, Finder(locus, pattern)
    candidates = np.array(squeezed(pattern, locus.common_normals)).reshape(-1, CANDIDATE_LENGTH)
    return in_balance(candidates, given, size), NONE, finder.free(finder.on_one_line())


def three_alone(locus: Locus, pattern: Pattern, size: float) -> Told:
    """Of two pegs of a jaw and one of the other."""
    holdings, finder = Holdings.of(locus, pattern), Finder(locus, pattern)
    given, sought = holdings.given, holdings.sought
    # Of the jaw of two; the other's only peg holds the part in pockets alone.
    cells = holdings.by_holding(int(pattern.right.sum() == 2))
    work = np.empty((DEPTH, 2)), np.empty((5, len(locus.discs)))
    roots = filled(ROOT_LENGTH, 1024, three_contacts, *cells, sought, locus.discs, pattern.stop, *work)
    candidates = [
        filled(CANDIDATE_LENGTH, len(roots) + 1, complete_three, roots, given, locus.pocket_pieces),
        filled(CANDIDATE_LENGTH, 256, slides_squared, holdings.slides, given),
        *tangent(locus, pattern, given),
        filled(CANDIDATE_LENGTH, 64, about_one_center, given, pattern.stop, pattern.widest),
    ]
    ways = [*finder.on_parallel_lines(holdings.slides, given), *finder.on_one_center()]
    every = np.concatenate(candidates)
    return in_balance(every[pattern.reaches(every[:, SEPARATION])], given, size), NONE, finder.free(ways)


def jaw_alone(locus: Locus, pattern: Pattern, _: float) -> Told:
    """Of pegs of one jaw that touch in three places: three, or two of which one is in a pocket."""
    holdings, stack = Holdings.of(locus, pattern), np.empty((DEPTH, 2))
    cells = holdings.by_holding(int(pattern.right[0]))
    roots = filled(ROOT_LENGTH, 1024, third_of_jaw, *cells, holdings.sought, locus.discs, stack)
    fixed = [
        filled(CANDIDATE_LENGTH, len(roots) + 1, complete_third, roots, holdings.given, locus.pocket_pieces),
        filled(CANDIDATE_LENGTH, 256, slides_stopped, holdings.slides, holdings.given),
    ]
    return NONE, np.concatenate(fixed), NO_WAYS


def settled(candidates: Array, given: Given, size: float) -> Array:
    """Candidates (N, 24) with their forces and clearances."""
    settle(candidates, given, size, np.empty((4, 4)), np.empty((4, 5)))
    return candidates


def balanced(candidates: Array) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """In which settled candidates (N, 24) all contacts press and forces balance: for certain, and of those in doubt."""
    used = np.arange(4) < candidates[:, CONTACTS, None]
    forces = np.where(used, candidates[:, FORCE : FORCE + 4], np.inf)
    pressed, doubt = forces.min(axis=1, initial=np.inf) > LEAST_FORCE, candidates[:, DOUBT] != 0.0
    off = candidates[:, RESIDUAL]
    return pressed & ~doubt & (off < BALANCED), pressed & doubt & (off < BALANCED_IN_DOUBT)


def in_balance(candidates: Array, given: Given, size: float) -> Array:
    """Candidates of a group, those that may be equilibria."""
    sure, doubtful = balanced(settled(candidates, given, size))
    return np.array(candidates[sure | doubtful])
