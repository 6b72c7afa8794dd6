"""The seating of a fixture: the largest opening from which it still catches the part, and the other places
where the part can rest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from functools import cached_property
from itertools import islice, product
from math import inf, isfinite, pi, radians, tau
from threading import Event
from typing import Any

import numpy as np
from attrs import define, evolve, field
from numpy.typing import NDArray

from workhold.errors import refuse_kind
from workhold.fixels.toolkit import Toolkit
from workhold.kernels.seating.columns import CONFIG, CONTACTS, FORCE, PEG, PIECE, SEPARATION
from workhold.limits import choose_thread_count
from workhold.model.fixture import Fixture
from workhold.model.pose import Pose
from workhold.model.result import Result
from workhold.model.seating import Cage, CagePass, Seat, SeatContact, Seating
from workhold.model.workpiece import Workpiece
from workhold.seating.caging_set import CagingSet
from workhold.seating.clamping import find_sticking_friction, plan_hand_loading
from workhold.seating.closing import ClosingMotion
from workhold.seating.contact_forces import (
    OTHERS_MAY_BE,
    WAS_NOT_FOUND,
    find_contact_normals,
    is_equilibrium,
    to_candidate,
)
from workhold.seating.equilibria import find_equilibria
from workhold.seating.join_tree import (
    KINDS,
    LOOSE,
    UNSETTLED,
    CageJoin,
    JoinTree,
    RestPoses,
    measure_distances,
)
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.part_features import Silhouette
from workhold.seating.pattern import Pattern

__all__ = ["SeatingSolver", "seatings"]

Array = NDArray[np.float64]
# mm. A fixture is found among the seats of its pegs when both pose and separation agree to this.
AGREES = 1e-5
# A share of the opening, by which less than the capture opening is less.
LESS = 1e-6
NO_PASS = "The pass at which its cage opens could not be settled: from where on it is caught is not known."


@define(eq=False)
class SeatingSolver:
    """A solver for the seating of one fixture (:meth:`solve`) or many (:meth:`solve_all`) on a part.

    Fixtures whose pegs form the same pattern share the work, as each pattern is solved once.

    Parameters
    ----------
    workpiece, toolkit : the part, and the toolkit that holds it.
    """

    workpiece: Workpiece
    toolkit: Toolkit
    boundaries: dict[tuple[float, float], ObstacleBoundary] = field(factory=dict)
    solved: dict[tuple[object, ...], tuple[Pattern, tuple[JoinTree, JoinTree], tuple[Array, ...]]] = field(
        factory=dict
    )
    outline: Silhouette = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.outline = Silhouette.from_workpiece(self.workpiece)

    def make_closing(self, pattern: Pattern, turned_over: bool) -> ClosingMotion:
        """Return the closing motion of a pattern's jaws and the part, as drawn or turned over."""
        if pattern.radii not in self.boundaries:
            self.boundaries[pattern.radii] = ObstacleBoundary.from_workpiece(self.workpiece, pattern.radii)
        boundary = self.boundaries[pattern.radii]
        return ClosingMotion(boundary.turned_over if turned_over else boundary, pattern, self.outline.arm)

    def find_join_trees(self, pattern: Pattern, missed: Sequence[Array] = ()) -> tuple[JoinTree, JoinTree]:
        """Return the join trees of a pattern: (1) for the part as drawn, (2) for the part turned over.

        ``missed`` are candidates (24,) to add to the seats of the first tree. A candidate is a configuration
        with contacts and forces that may be an equilibrium, see ``kernels.seating.columns``.
        """
        out = list[JoinTree]()
        for closing in (self.make_closing(pattern, turned_over) for turned_over in (False, True)):
            found = find_equilibria(closing.boundary, pattern, closing.size)
            if missed and not out:
                found = evolve(found, seats=np.vstack([found.seats, *missed]))
            out.append(JoinTree.from_equilibria(found, closing))
        return out[0], out[1]

    def solve(self, fixture: Fixture, with_cage: bool = True) -> Seating:
        """Return the seating of a fixture: the opening up to which it catches the part, and the other rest
        poses.

        Parameters
        ----------
        with_cage : whether cage and placing are computed, which about doubles the time.

        Raises
        ------
        InputError
            As ``Pattern.from_fixture``, and for a fixture of another part or toolkit.
        """
        fixture.refuse_others(self.workpiece, self.toolkit)
        return self.make_seating(fixture, Pattern.from_fixture(fixture, self.toolkit), with_cage)

    def make_seating(self, fixture: Fixture, pattern: Pattern, with_cage: bool) -> Seating:
        """Return the seating of a fixture whose pattern is ``pattern``."""
        return self.place_in_pattern(fixture, pattern).make_seating(with_cage)

    def place_in_pattern(self, fixture: Fixture, pattern: Pattern) -> FixtureInPattern:
        """Return a fixture with the join trees of its pattern.

        The pattern is solved the first time. If the fixture is missing among the seats found, it is added to
        them, and the pattern is solved again.
        """
        key = pattern.make_key()
        if key not in self.solved:
            self.solved[key] = pattern, self.find_join_trees(pattern), ()
        found = FixtureInPattern(self, fixture, pattern, *self.solved[key])
        if found.place is not None:
            return found
        missed = (*found.missed, found.make_candidate())
        self.solved[key] = found.known, self.find_join_trees(found.known, missed), missed
        return FixtureInPattern(self, fixture, pattern, *self.solved[key])

    def solve_all(
        self, fixtures: Iterable[Fixture], with_cage: bool = True, threads: int | None = None
    ) -> list[Seating]:
        """Return the seatings of fixtures, in their order.

        Parameters
        ----------
        with_cage : see :meth:`solve`.
        threads : number of threads, among which the patterns are shared out; None for one on each processor.
            The result does not depend on it.

        Raises
        ------
        InputError
            As :meth:`solve`, and for a number of threads that is too large.
        """
        fixtures = list(fixtures)
        for fixture in fixtures:
            fixture.refuse_others(self.workpiece, self.toolkit)
        made = self.solve_until_cancelled(fixtures, with_cage, choose_thread_count(threads))
        return [seating for seating in made if seating is not None]

    def solve_until_cancelled(
        self,
        fixtures: Iterable[Fixture],
        with_cage: bool = True,
        threads: int = 1,
        progress: Callable[[float], None] | None = None,
        cancel: Event | None = None,
    ) -> list[Seating | None]:
        """Return the seatings of fixtures, in their order; None for each one not begun when ``cancel`` was
        set.

        Parameters
        ----------
        progress : called from this thread with the fraction done.
        cancel : when set, no further pattern is begun.

        Raises
        ------
        InputError
            As :meth:`solve`.
        """
        given = [(fixture, Pattern.from_fixture(fixture, self.toolkit)) for fixture in fixtures]
        groups: dict[tuple[object, ...], list[int]] = {}
        for number, (_, pattern) in enumerate(given):
            groups.setdefault(pattern.make_key(), []).append(number)

        made: list[Seating | None] = [None] * len(given)

        def make(numbers: list[int]) -> int:
            """Make the seatings of the fixtures with these numbers, which share one pattern.

            Write them into ``made``, and return how many were made: 0 once ``cancel`` is set.
            """
            if cancel is not None and cancel.is_set():
                return 0
            # All fixtures that stand on the pegs are known before the seating of any is made.
            for number in numbers[1:]:
                self.place_in_pattern(*given[number])
            for number, one in [(number, self.make_seating(*given[number], with_cage)) for number in numbers]:
                made[number] = one
            return len(numbers)

        done = 0
        with ThreadPoolExecutor(max_workers=max(min(threads, len(groups)), 1)) as pool:
            running = [pool.submit(make, numbers) for numbers in groups.values()]
            try:
                for one in as_completed(running):
                    done += one.result()
                    if progress is not None:
                        progress(done / len(given))
            except BaseException:
                pool.shutdown(cancel_futures=True)
                raise
        return made


@define(frozen=True, eq=False)
class FixtureInPattern:
    """A fixture and the solved pattern of its pegs, which may be shifted and in another order.

    Parameters
    ----------
    pattern, known : the fixture's own pattern, and the equal pattern that was solved.
    trees : join trees of the part as drawn, and turned over.
    missed : candidates (24,) of fixtures that were missing among the seats found, and were added.
    """

    solver: SeatingSolver
    fixture: Fixture
    pattern: Pattern
    known: Pattern
    trees: tuple[JoinTree, JoinTree]
    missed: tuple[Array, ...] = ()

    @cached_property
    def shift(self) -> Array:
        """The vector (4,) to add to configurations of the solved pattern to get those of the fixture's own
        pattern.
        """
        # Of the pegs that stand still, and of those that move, the first.
        (still, moving), (there, then) = (
            p.pegs[p.order[[0, -int(p.right.sum())]]] for p in (self.pattern, self.known)
        )
        dx, dy = still - there
        return np.array([0.0, dx, dy, dx - (moving[0] - then[0])])

    @cached_property
    def order(self) -> NDArray[np.int64]:
        """For each of the K pegs of the solved pattern, its index among the fixture's pegs (K,)."""
        out = np.empty(len(self.known.pegs), np.int64)
        out[self.known.order] = np.array(self.pattern.numbers)[self.pattern.order]
        return out

    @cached_property
    def own(self) -> Array:
        """The configuration (4,) of the part in the fixture, in the closing frame."""
        pose = self.fixture.pose
        x, y = pose.apply(*self.solver.workpiece.center)
        return self.pattern.frame.map_from_toolkit(
            np.array([radians(pose.theta_deg), x, y, self.fixture.travel])
        )

    @cached_property
    def place(self) -> int | None:
        """The index of the seat that is the fixture itself; None if it is not among the seats."""
        return self.find_own_candidate(self.trees[0].seats)

    def find_own_candidate(self, rows: Array) -> int | None:
        """Return the index of the candidate in ``rows`` (N, 24) that is the fixture itself, within ``AGREES``
        mm.

        None where no candidate is. A candidate is a configuration with contacts and forces that may be an
        equilibrium, see ``kernels.seating.columns``.
        """
        configs = rows[:, CONFIG] + self.shift
        away = measure_distances(configs, self.own, self.solver.outline.arm) + np.abs(
            configs[:, 3] - self.own[3]
        )
        return int(np.argmin(away)) if len(away) and away.min() <= AGREES else None

    def make_candidate(self) -> Array:
        """Return the fixture itself as a candidate (24,) of the solved pattern.

        A candidate is a configuration with contacts and forces that may be an equilibrium, see
        ``kernels.seating.columns``.
        """
        closing, faces = self.solver.make_closing(self.known, False), [peg.face for peg in self.fixture.pegs]
        touched = [faces[number] for number in self.order]
        return to_candidate(closing.boundary, self.known, self.own - self.shift, touched, closing.size)

    def compute_poses(self, configs: Array, turned_over: NDArray[np.bool_]) -> tuple[Array, Array, Array]:
        """Return the poses of N configurations in the toolkit's frame, as arrays (N,): theta in [0, 360)
        degrees, x, y in mm.

        ``configs`` (N, 4) are in the closing frame. If ``turned_over`` (N,) is True, the pose is that of the
        part turned over.
        """
        x, y = self.solver.workpiece.center
        across = np.where(turned_over, -x, x)
        left = self.pattern.frame.map_to_toolkit(configs)
        theta = left[:, 0] % tau
        c, s = np.cos(theta), np.sin(theta)
        return theta * 180.0 / pi, left[:, 1] - (c * across - s * y), left[:, 2] - (s * across + c * y)

    def make_contacts(self, rows: Array) -> list[tuple[SeatContact, ...]]:
        """Return the contacts of each candidate in ``rows`` (N, 24), by the indices of the fixture's pegs.

        A candidate is a configuration with contacts and forces that may be an equilibrium, see
        ``kernels.seating.columns``.
        """
        # Contacts with a wall come after those of the pegs. Turned over, a part has the same pieces.
        numbers = self.order.tolist() + [
            k for k in range(len(self.fixture.pegs)) if k not in self.pattern.numbers
        ]
        pegs, pieces = (rows[:, at : at + 4].astype(np.int64) for at in (PEG, PIECE))
        pegs = np.where(np.arange(4) < rows[:, CONTACTS, None], np.array(numbers)[pegs], -1)
        return self.solver.make_closing(self.known, False).boundary.make_contacts(pegs, pieces)

    def make_seats(self) -> tuple[Seat, ...]:
        """Return all poses in which the part can rest, as drawn and turned over, in ascending order of
        separation.
        """
        rests = RestPoses.from_join_trees(
            self.trees, self.solver.make_closing(self.known, False).boundary, len(self.known.pegs)
        )
        rows, kinds, own, sign = rests.rows, rests.kinds, self.own, self.pattern.frame.sign
        configs = rows[:, CONFIG] + self.shift
        away, rise = measure_distances(configs, own, self.solver.outline.arm), configs[:, 3] - own[3]
        is_own = (away < AGREES) & (np.abs(rise) < AGREES) & ~(rests.turned_over | (kinds == UNSETTLED))
        same = self.solver.outline.find_same_cover(own, configs, rests.turned_over)
        poses, separations = self.compute_poses(configs, rests.turned_over), sign * configs[:, 3]
        # In a loose rest the forces are not certain.
        ends = (
            np.arange(0, 4 * len(rows), 4) + np.where(kinds < LOOSE, rows[:, CONTACTS], 0.0).astype(np.int64)
        ).tolist()
        forces = rows[:, FORCE : FORCE + 4].ravel().tolist()
        seats = list(
            map(
                Seat,
                [KINDS[kind] for kind in kinds.tolist()],
                map(Pose, *(values.tolist() for values in poses)),
                separations.tolist(),
                (sign * rise).tolist(),
                rests.turned_over.tolist(),
                same.tolist(),
                self.make_contacts(rows),
                [tuple(forces[4 * k : end]) for k, end in enumerate(ends)],
                [None if depth == inf else depth for depth in rests.depths.tolist()],
                is_own.tolist(),
            )
        )
        return tuple([seats[k] for k in np.lexsort((poses[0], rests.turned_over, separations)).tolist()])

    def make_seating(self, with_cage: bool) -> Seating:
        """Return the seating of the fixture, with cage and placing if ``with_cage`` is True.

        The fixture must be among the seats (``place`` is not None).
        """
        tree = self.trees[0]
        place = self.place
        assert place is not None
        row, join = tree.seats[place], tree.find_first_join(place)
        way_out = tree.find_escape_separation(place)
        seats = self.make_seats()
        factor = float(row[FORCE : FORCE + 4].sum())
        capture = None if join is None else float(join.separation - row[SEPARATION])
        unsettled = sum(seat.kind == "unsettled" for seat in seats)
        places = "A place" if unsettled == 1 else f"{unsettled} places"
        doubts = [f"{places} where the part may rest could not be settled."] if unsettled else []
        if join is not None and not is_equilibrium(
            join.candidate, self.solver.make_closing(self.known, False)
        ):
            # Only what was checked is claimed; from no opening at all the part comes home for certain.
            join, capture, doubts = None, 0.0, [*doubts, NO_PASS]
        if self.missed and self.find_own_candidate(np.array(self.missed)) is not None:
            # Whatever missed the seat may have missed a pass out of it.
            join, capture, way_out, doubts = None, 0.0, float(row[SEPARATION]), [*doubts, WAS_NOT_FOUND]
        elif self.missed:
            doubts = [*doubts, OTHERS_MAY_BE]
        cage, placing = None, None
        if join is not None and with_cage:
            cage, placing = self.measure_freedom(row[CONFIG], join)
        return Seating(
            capture_opening=capture,
            room_factor=factor,
            lowest_pass=None if join is None else self.make_pass(join),
            way_out=None if way_out is None else float(way_out - row[SEPARATION]),
            cage=cage,
            placing=placing,
            sticking_friction=self.find_sticking_friction(row),
            stop=self.pattern.frame.sign * self.pattern.stop if isfinite(self.pattern.stop) else None,
            seats=seats,
            unsettled=tuple(doubts),
        ).with_toolkit(self.solver.toolkit)

    def make_pass(self, join: CageJoin) -> CagePass:
        """Return the pass of a join in the toolkit's frame."""
        config = join.candidate[CONFIG] + self.shift
        separation = self.pattern.frame.sign * float(config[3])
        pose = Pose(*(float(value[0]) for value in self.compute_poses(config[None], np.zeros(1, np.bool_))))
        return CagePass(pose, separation, self.make_contacts(join.candidate[None])[0])

    def make_caging_set(self, seat: Array, join: CageJoin) -> CagingSet:
        """Return the caging set of a seat (4,), with the jaws opened by slightly less than up to the pass
        ``join``.
        """
        closing, top = self.solver.make_closing(self.known, False), join.candidate[CONFIG]
        opening = (top[3] - seat[3]) * (1.0 - LESS)
        to_pass = top[:3] - seat[:3]
        to_pass[0] = (to_pass[0] + pi) % tau - pi
        seats = np.ascontiguousarray(self.trees[0].seats[:, CONFIG])
        return CagingSet(closing, np.array(seat), seats, opening, to_pass, self.solver.outline.arm)

    def measure_freedom(self, seat: Array, join: CageJoin) -> tuple[Cage, float]:
        """Return two results for a seat (4,): the cage in the toolkit's frame (degrees and mm), and the
        placing in mm.

        The placing is the distance from the seat within which closing leads into it from every pose; see
        ``CagingSet.placing``.
        """
        around = self.make_caging_set(seat, join)
        turns, across, along = around.extents.reach
        corners = self.pattern.frame.turn_points(np.array(list(product(across, along))), back=True)
        x, y = ((float(ends.min()), float(ends.max())) for ends in corners.T)
        return Cage((float(turns[0]) * 180.0 / pi, float(turns[1]) * 180.0 / pi), x, y), around.placing

    def find_sticking_friction(self, row: Array) -> float:
        """Return the least friction coefficient at which the part can stick near a seat; inf if it never can.

        ``row`` (24,) is the seat as a candidate. A candidate is a configuration with contacts and forces that
        may be an equilibrium, see ``kernels.seating.columns``.
        """
        boundary = self.solver.make_closing(self.known, False).boundary
        places, normals, moves = find_contact_normals(boundary, self.known, row)
        return find_sticking_friction(places, normals, moves)


def seatings(result: Result, fixtures: Sequence[Fixture] | int = 1, *, with_cage: bool = True) -> list[Any]:
    """Return for each fixture the opening up to which it catches the part, and the other places where the
    part can rest.

    Each result is a ``model.seating.Seating``. For toolkits with two clamps, each result is a
    ``seating.clamping.HandLoading``: instructions to put the part in by hand.

    Parameters
    ----------
    fixtures : the fixtures, or the number of best fixtures.
    with_cage : whether cage and placing are computed.

    Raises
    ------
    InputError
        As ``Pattern.from_fixture``: for pegs with a flat and for pegs of radius 0. Also for a fixture of
        another part or toolkit.

    Examples
    --------
    >>> import workhold
    >>> widget = workhold.load("widget")
    >>> result = workhold.design(widget, workhold.Vise(pitch=8, columns=2, peg_radius=2), best=1)
    >>> [seating] = workhold.seatings(result)
    >>> round(seating.capture_opening, 3), round(seating.sticking_friction, 3)
    (0.03, 0.083)
    """
    refuse_kind(result, Result, "the result", "give a Result, as workhold.design and workhold.open make")
    chosen = list(islice(result, fixtures)) if isinstance(fixtures, int) else fixtures
    if not result.toolkit.closes_at_once:
        for fixture in chosen:
            fixture.refuse_others(result.workpiece, result.toolkit)
        return [plan_hand_loading(fixture, result.workpiece, result.toolkit) for fixture in chosen]
    return SeatingSolver(result.workpiece, result.toolkit).solve_all(chosen, with_cage)
