"""The seating of a fixture: from how wide open the part is caught, where else it can rest, and how one would notice."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from functools import cached_property
from itertools import product
from math import isfinite, pi, radians, tau
from threading import Event

import numpy as np
from attrs import define, evolve, field
from numpy.typing import NDArray

from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONFIG,
    CONTACTS,
    FORCE,
    PEG,
    PIECE,
    SEPARATION,
)
from workhold.limits import thread_count
from workhold.model.fixture import Fixture, Pose
from workhold.model.result import Result
from workhold.model.seating import Cage, Contact, Pass, Seat, Seating
from workhold.model.toolkit import Toolkit
from workhold.model.workpiece import Workpiece
from workhold.seating.balance import contact_normals
from workhold.seating.cage import Surroundings
from workhold.seating.descents import Closing
from workhold.seating.equilibria import equilibria
from workhold.seating.locus import Locus
from workhold.seating.missed import OTHERS_MAY_BE, WAS_NOT_FOUND, as_candidate
from workhold.seating.pattern import Pattern
from workhold.seating.place import Silhouette
from workhold.seating.settled import is_equilibrium
from workhold.seating.sticking import sticking_friction
from workhold.seating.tree import Join, Tree, distances

__all__ = ["Solver", "seatings"]

Array = NDArray[np.float64]
# mm. A fixture is found among the seats of its pegs when both pose and separation agree to this.
AGREES = 1e-5
# mm. Seats from which a part is out again with less are not listed: they may be or not.
SHALLOW = 1e-3
# A share of the opening, by which less than the capture opening is less.
LESS = 1e-6
NO_PASS = "The pass at which its cage opens could not be settled: from where on the part is caught is not known."
# Those that are listed all the same: nothing is known of their depth, or they are fixtures of a complete list.
ALWAYS = ("fixture", "loose", "unsettled")
KINDS = {2: "curved", 3: "curved", 4: "fixture"}


@define(eq=False)
class Solver:
    """Solves patterns of pegs on a part, each once: of one fixture with :meth:`of`, of many with :meth:`of_all`.

    Parameters
    ----------
    workpiece, toolkit : what is held in what.
    """

    workpiece: Workpiece
    toolkit: Toolkit
    loci: dict[tuple[float, float], Locus] = field(factory=dict)
    solved: dict[tuple[object, ...], tuple[Pattern, tuple[Tree, Tree], tuple[Array, ...]]] = field(factory=dict)
    outline: Silhouette = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.outline = Silhouette.of(self.workpiece)

    def closing(self, pattern: Pattern, turned_over: bool) -> Closing:
        """The jaws of a pattern about the part, also turned over."""
        if pattern.radii not in self.loci:
            self.loci[pattern.radii] = Locus.of(self.workpiece, pattern.radii)
        locus = self.loci[pattern.radii]
        return Closing(locus.turned_over if turned_over else locus, pattern, self.outline.arm)

    def trees(self, pattern: Pattern, missed: Sequence[Array] = ()) -> tuple[Tree, Tree]:
        """What can be reached from where, as drawn and turned over, with further seats (24,) of the part as drawn."""
        out = list[Tree]()
        for closing in (self.closing(pattern, turned_over) for turned_over in (False, True)):
            found = equilibria(closing.locus, pattern, closing.size)
            if missed and not out:
                found = evolve(found, seats=np.vstack([found.seats, *missed]))
            out.append(Tree.of(found, closing))
        return out[0], out[1]

    def of(self, fixture: Fixture, with_cage: bool = True) -> Seating:
        """The seating of a fixture.

        Parameters
        ----------
        with_cage : whether cage and placing are worked out, which takes about as long as all else.

        Raises
        ------
        InputError
            As ``Pattern.of``.
        """
        return self.read(fixture, Pattern.of(fixture, self.toolkit), with_cage)

    def read(self, fixture: Fixture, pattern: Pattern, with_cage: bool) -> Seating:
        """The seating of a fixture of a pattern."""
        return self.reading(fixture, pattern).seating(with_cage)

    def reading(self, fixture: Fixture, pattern: Pattern) -> Reading:
        """What a pattern, solved once, says of a fixture, which is among its seats from then on."""
        key = pattern.key()
        if key not in self.solved:
            self.solved[key] = pattern, self.trees(pattern), ()
        reading = Reading(self, fixture, pattern, *self.solved[key])
        if reading.nearest(reading.trees[0].seats) is not None:
            return reading
        missed = (*reading.missed, reading.as_candidate())
        self.solved[key] = reading.known, self.trees(reading.known, missed), missed
        return Reading(self, fixture, pattern, *self.solved[key])

    def of_all(self, fixtures: Iterable[Fixture], with_cage: bool = True, threads: int | None = None) -> list[Seating]:
        """The seatings of many fixtures, in their order; patterns are shared out among threads.

        Parameters
        ----------
        with_cage : see :meth:`of`.
        threads : how many; None for one on each processor. The seatings do not depend on it.

        Raises
        ------
        InputError
            As ``Pattern.of``, and for a number of threads that is too large.
        """
        return [told for told in self.as_many(fixtures, with_cage, thread_count(threads)) if told is not None]

    def as_many(
        self,
        fixtures: Iterable[Fixture],
        with_cage: bool = True,
        threads: int = 1,
        progress: Callable[[float], None] | None = None,
        cancel: Event | None = None,
    ) -> list[Seating | None]:
        """The seatings of fixtures until somebody cancels, in their order; None of those that were left.

        Parameters
        ----------
        progress : called from this thread with the fraction done.
        cancel : when set, no further pattern is begun.

        Raises
        ------
        InputError
            As :meth:`of`.
        """
        given = [(fixture, Pattern.of(fixture, self.toolkit)) for fixture in fixtures]
        groups: dict[tuple[object, ...], list[int]] = {}
        for number, (_, pattern) in enumerate(given):
            groups.setdefault(pattern.key(), []).append(number)

        told: list[Seating | None] = [None] * len(given)

        def tell(numbers: list[int]) -> int:
            if cancel is not None and cancel.is_set():
                return 0
            # All that stand on the pegs are known before any is told.
            for number in numbers[1:]:
                self.reading(*given[number])
            for number, one in [(number, self.read(*given[number], with_cage)) for number in numbers]:
                told[number] = one
            return len(numbers)

        done = 0
        with ThreadPoolExecutor(max_workers=max(min(threads, len(groups)), 1)) as pool:
            running = [pool.submit(tell, numbers) for numbers in groups.values()]
            try:
                for one in as_completed(running):
                    done += one.result()
                    if progress is not None:
                        progress(done / len(given))
            except BaseException:
                pool.shutdown(cancel_futures=True)
                raise
        return told


@define(frozen=True, eq=False)
class Reading:
    """What a solved pattern says of one of its fixtures, whose pegs may stand elsewhere and in another order.

    Parameters
    ----------
    pattern, known : the fixture's, and the one that was solved.
    trees : what can be reached from where, as drawn and turned over.
    missed : (24,) candidates of fixtures that were not found among the seats, to which they were added.
    """

    solver: Solver
    fixture: Fixture
    pattern: Pattern
    known: Pattern
    trees: tuple[Tree, Tree]
    missed: tuple[Array, ...] = ()

    @cached_property
    def shift(self) -> Array:
        """(4,) by which configurations of the solved pattern become the fixture's."""
        here, there = (np.lexsort((p.pegs[:, 1], p.pegs[:, 0], p.right))[0] for p in (self.pattern, self.known))
        right = np.lexsort((self.pattern.pegs[:, 1], self.pattern.pegs[:, 0], -self.pattern.right))[0]
        other = np.lexsort((self.known.pegs[:, 1], self.known.pegs[:, 0], -self.known.right))[0]
        dx, dy = self.pattern.pegs[here] - self.known.pegs[there]
        return np.array([0.0, dx, dy, dx - (self.pattern.pegs[right, 0] - self.known.pegs[other, 0])])

    @cached_property
    def order(self) -> NDArray[np.int64]:
        """(K,) number of each solved peg among the fixture's."""
        here, there = (np.lexsort((p.pegs[:, 1], p.pegs[:, 0], p.right)) for p in (self.pattern, self.known))
        out = np.empty(len(there), np.int64)
        out[there] = np.array(self.pattern.numbers)[here]
        return out

    @cached_property
    def own(self) -> Array:
        """(4,) configuration of the fixture."""
        pose = self.fixture.pose
        x, y = pose.apply(*self.solver.workpiece.center)
        return self.pattern.door.enter(np.array([radians(pose.theta_deg), x, y, self.fixture.jaw_separation]))

    def nearest(self, rows: Array) -> int | None:
        """Which of some candidates (N, 24) is the fixture; None if none is."""
        configs = rows[:, CONFIG] + self.shift
        away = distances(configs, self.own, self.solver.outline.arm) + np.abs(configs[:, 3] - self.own[3])
        return int(np.argmin(away)) if len(away) and away.min() <= AGREES else None

    def as_candidate(self) -> Array:
        """The fixture as a candidate of the solved pattern."""
        closing, faces = self.solver.closing(self.known, False), [peg.face for peg in self.fixture.pegs]
        touched = [faces[number] for number in self.order]
        return as_candidate(closing.locus, self.known, self.own - self.shift, touched, closing.size)

    def poses(self, configs: Array, mirrored: bool) -> list[Pose]:
        """The poses of configurations (N, 4), in the toolkit's frame."""
        x, y = self.solver.workpiece.center
        x = -x if mirrored else x
        left = self.pattern.door.leave(configs)
        theta = left[:, 0] % tau
        c, s = np.cos(theta), np.sin(theta)
        told = theta * 180.0 / pi, left[:, 1] - (c * x - s * y), left[:, 2] - (s * x + c * y)
        return [Pose(*one) for one in zip(*(values.tolist() for values in told), strict=True)]

    @cached_property
    def every_contact(self) -> list[tuple[Contact, ...]]:
        """All that the fixture's pegs may touch, by the numbers of pegs and pieces in candidates."""
        locus = self.solver.closing(self.known, False).locus
        # Contacts with a wall come after those of the pegs. Turned over, a part has the same pieces.
        pegs = self.order.tolist() + [k for k in range(len(self.fixture.pegs)) if k not in self.pattern.numbers]
        return [locus.contacts_of(peg) for peg in pegs]

    def contacts(self, rows: Array) -> list[tuple[Contact, ...]]:
        """What touches in each of some candidates (N, 24)."""
        every = self.every_contact
        pegs, pieces = (rows[:, at : at + 4].astype(np.int64).tolist() for at in (PEG, PIECE))
        told = zip(rows[:, CONTACTS].astype(np.int64).tolist(), pegs, pieces, strict=True)
        return [tuple([every[p][q] for p, q in zip(one[:n], other[:n], strict=True)]) for n, one, other in told]

    def kind(self, kind: str, contacts: tuple[Contact, ...]) -> str:
        """What a seat is called, four contacts of which are a fixture's or what they touch."""
        if kind != "fixture":
            return kind
        if len({contact.peg for contact in contacts}) < 4:
            return "pocket"
        pegs = self.fixture.pegs
        return "corner" if any(one.corner and not pegs[one.peg].is_on_wall for one in contacts) else kind

    def side(self, tree: Tree, mirrored: bool) -> list[Seat]:
        """The seats of the part as drawn, or turned over."""
        flat, slack = tree.loose, tree.slack
        unknown = np.zeros((len(tree.doubtful), CANDIDATE_LENGTH))
        unknown[:, CONFIG] = tree.doubtful
        rows = np.concatenate([tree.seats, flat, slack, unknown])
        kinds = [KINDS[int(count)] for count in tree.seats[:, CONTACTS]]
        kinds += ["loose"] * (len(flat) + len(slack)) + ["unsettled"] * len(unknown)
        joins = [tree.join_of(place) for place in range(len(tree.seats) + len(flat))]
        levels = rows[:, SEPARATION].tolist()
        depths = [None if join is None else join.separation - level for join, level in zip(joins, levels, strict=False)]
        depths += [0.0] * len(slack) + [None] * len(unknown)
        kept = [k for k, (kind, depth) in enumerate(zip(kinds, depths, strict=True)) if is_listed(kind, depth)]
        rows, kinds, depths = rows[kept], [kinds[k] for k in kept], [depths[k] for k in kept]
        configs, own, sign = rows[:, CONFIG] + self.shift, self.own, self.pattern.door.sign
        apart = distances(configs, own, self.solver.outline.arm), np.abs(configs[:, 3] - own[3])
        is_own = (apart[0] < AGREES) & (apart[1] < AGREES) & (not mirrored)
        told = zip(
            rows[:, FORCE : FORCE + 4].tolist(),
            self.contacts(rows),
            kinds,
            depths,
            self.poses(configs, mirrored),
            (sign * configs[:, 3]).tolist(),
            (sign * (configs[:, 3] - own[3])).tolist(),
            self.solver.outline.cover_same(own, configs, mirrored).tolist(),
            is_own.tolist(),
            strict=True,
        )
        out = []
        for pressing, contacts, kind, depth, pose, separation, difference, same, itself in told:
            forces = tuple(pressing[: len(contacts)]) if kind in KINDS.values() else ()
            kind, itself = self.kind(kind, contacts), itself and kind != "unsettled"
            if is_listed(kind, depth):
                out.append(Seat(kind, pose, separation, difference, mirrored, same, contacts, forces, depth, itself))
        return out

    def seats(self) -> tuple[Seat, ...]:
        """All seats, by their separations."""
        one, two = (self.side(tree, mirrored) for mirrored, tree in zip((False, True), self.trees, strict=True))
        return tuple(sorted(one + two, key=lambda seat: (seat.jaw_separation, seat.mirrored, seat.pose.theta_deg)))

    def seating(self, with_cage: bool) -> Seating:
        """The seating of the fixture."""
        tree = self.trees[0]
        place = self.nearest(tree.seats)
        assert place is not None
        row, join = tree.seats[place], tree.join_of(place)
        way_out = tree.way_out(place)
        seats = self.seats()
        factor = float(row[FORCE : FORCE + 4].sum())
        capture = None if join is None else float(join.separation - row[SEPARATION])
        doubts = unsettled_words(sum(seat.kind == "unsettled" for seat in seats))
        if join is not None and not is_equilibrium(join.candidate, self.solver.closing(self.known, False)):
            # Nothing is told that was not seen to be so; from no opening at all the part comes home for certain.
            join, capture, doubts = None, 0.0, (*doubts, NO_PASS)
        if self.missed and self.nearest(np.array(self.missed)) is not None:
            # Whatever missed the seat may have missed a pass out of it.
            join, capture, way_out, doubts = None, 0.0, float(row[SEPARATION]), (*doubts, WAS_NOT_FOUND)
        elif self.missed:
            doubts = (*doubts, OTHERS_MAY_BE)
        cage, placing = (None, None)
        if join is not None and with_cage:
            cage, placing = self.freedom(row[CONFIG], join)
        return Seating(
            capture_opening=capture,
            room_factor=factor,
            lowest_pass=None if join is None else self.lowest_pass(join),
            way_out=None if way_out is None else float(way_out - row[SEPARATION]),
            cage=cage,
            placing=placing,
            sticking_friction=self.sticking(row),
            stop=self.pattern.door.sign * self.pattern.stop if isfinite(self.pattern.stop) else None,
            seats=seats,
            unsettled=doubts,
        ).in_toolkit(self.solver.toolkit)

    def lowest_pass(self, join: Join) -> Pass:
        """A join as the fixture's pass."""
        config = join.candidate[CONFIG] + self.shift
        separation = self.pattern.door.sign * float(config[3])
        return Pass(self.poses(config[None], False)[0], separation, self.contacts(join.candidate[None])[0])

    def freedom(self, seat: Array, join: Join) -> tuple[Cage, float]:
        """Cage and placing."""
        closing, top = self.solver.closing(self.known, False), join.candidate[CONFIG]
        opening = (top[3] - seat[3]) * (1.0 - LESS)
        way = top[:3] - seat[:3]
        way[0] = (way[0] + pi) % tau - pi
        seats = np.ascontiguousarray(self.trees[0].seats[:, CONFIG])
        around = Surroundings(closing, np.array(seat), seats, opening, way, self.solver.outline.arm)
        turns, across, along = around.cage
        corners = self.pattern.door.turned(np.array(list(product(across, along))), back=True)
        x, y = ((float(ends.min()), float(ends.max())) for ends in corners.T)
        return Cage((float(turns[0]) * 180.0 / pi, float(turns[1]) * 180.0 / pi), x, y), around.placing

    def sticking(self, row: Array) -> float:
        """The friction below which the part cannot stick near its seat."""
        locus = self.solver.closing(self.known, False).locus
        places, normals, moves = contact_normals(locus, self.known, row)
        return sticking_friction(places, normals, moves)


def unsettled_words(count: int) -> tuple[str, ...]:
    """What is said of so many places that could not be settled."""
    if count == 0:
        return ()
    return (f"{'A place' if count == 1 else f'{count} places'} where the part may rest could not be settled.",)


def is_listed(kind: str, depth: float | None) -> bool:
    """Whether a seat is listed: because of its kind, or as a part does not get out of it with next to nothing."""
    return kind in ALWAYS or depth is None or depth >= SHALLOW


def seatings(result: Result, fixtures: Sequence[Fixture] | int = 1, *, with_cage: bool = True) -> list[Seating]:
    """The seatings of fixtures of a result: from how wide open each catches the part, and where else it can rest.

    Parameters
    ----------
    fixtures : which, or how many of the best.
    with_cage : whether cage and placing are worked out.

    Raises
    ------
    InputError
        As ``Pattern.of``: on a fence, with two clamps, for pegs with a flat and for pegs of radius 0.

    Examples
    --------
    >>> import workhold
    >>> widget = workhold.load("widget")
    >>> result = workhold.design(widget, workhold.Vise(pitch=8, columns=2, peg_radius=2), best=1)
    >>> [told] = workhold.seatings(result)
    >>> round(told.capture_opening, 3), round(told.sticking_friction, 3)
    (0.03, 0.083)
    """
    chosen = result[:fixtures] if isinstance(fixtures, int) else fixtures
    return Solver(result.workpiece, result.toolkit).of_all(chosen, with_cage)
