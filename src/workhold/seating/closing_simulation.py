"""Simulation of closing the jaws on a part that was put somewhere: its path, for display, and its end.

``seating.closing`` follows the path without friction, from one level of S to the next. Levels are evenly
spaced, as a vise closes steadily; further levels are added where the part moves far between two.

Glossary
--------
closing simulation : the motion of a part between jaws that close on it: R. C. Brost, "Automatic grasp
    planning in the presence of uncertainty", International Journal of Robotics Research 7 (1988).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, degrees, inf, radians, sin, tau

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.kernels.base.distance import is_inside, measure_outline_distances
from workhold.kernels.seating.closing import AT_THE_STOP, GAVE_UP
from workhold.kernels.seating.descent_paths import AT_SEAT, SAME_LEVEL
from workhold.model.fixture import Fixture
from workhold.model.pose import Pose
from workhold.model.seating import Seat
from workhold.seating.closing import ClosingMotion
from workhold.seating.join_tree import measure_distances
from workhold.seating.pattern import ClosingFrame, Pattern
from workhold.seating.solver import SeatingSolver

__all__ = ["ENDINGS", "ClosingSimulation", "simulate_closing"]

Array = NDArray[np.float64]
# The fixture's own seat; one that covers the same place; another; rest in none of them; the stop with the
# part loose beside the pegs, or gone from them; and a path that could not be followed to its end.
ENDINGS = "right", "same place", "wrong", "elsewhere", "stop", "outside", "lost"
# A part that is put by hand may enter a peg by this part of the peg's radius: it is pushed out again.
ENTERS = 0.5
# mm. Steps of closing at first; a peg is pushed out of the part from as deep as so many of them.
FIRST_STEP, STEPS_DEEP = 0.05, 8.0
# mm. Ends whose S differs by less are one.
LEVEL = 1e-6
# Levels of S; of the part's size how far it moves between two of them; how often a stretch is halved, and how
# many configurations there are at most.
LEVELS, FAR, HALVINGS, MOST = 60, 0.02, 6, 400


@frozen(eq=False)
class ClosingSimulation:
    """The motion of a part while the jaws close on it, and how it ends.

    Parameters
    ----------
    poses : poses of the part, one after the other; poses of the part turned over if that was asked for.
    travels : travel of the jaw or clamp in mm at each pose, such as the jaw separation.
    ending : one of :data:`ENDINGS`.
    seat : the seat in which the part ended, of those given; None for any other end.
    """

    poses: tuple[Pose, ...]
    travels: tuple[float, ...]
    ending: str
    seat: Seat | None


def simulate_closing(
    solver: SeatingSolver,
    fixture: Fixture,
    seats: Sequence[Seat],
    pose: Pose,
    opening: float,
    turned_over: bool = False,
    is_cancelled: Callable[[], bool] = lambda: False,
) -> ClosingSimulation:
    """Return the motion of a part while a fixture's jaws close on it, from a given starting pose.

    Parameters
    ----------
    seats : seats of the fixture, see :class:`workhold.model.seating.Seating`.
    pose : starting pose of the part. With ``turned_over`` it is the pose of the part turned over (x to -x in
        its own frame).
    opening : distance in mm by which the jaws are open at the start, beyond the fixture's opening, or by
        which the clamp is drawn back.
    is_cancelled : called between steps; once it returns True, only the last pose is added.

    Raises
    ------
    InputError
        As ``Pattern.from_fixture``, and for a fixture of another part or toolkit. Also where the jaws meet
        their stop or are opened beyond their end, and where a peg stands in the part.
    """
    fixture.refuse_others(solver.workpiece, solver.toolkit)
    pattern = Pattern.from_fixture(fixture, solver.toolkit)
    closing = solver.make_closing(pattern, turned_over)
    center = CenterFrame(solver.workpiece.center, turned_over, pattern.frame)
    start = center.make_configuration(pose, fixture.travel + solver.toolkit.clamping * opening)
    travel = solver.toolkit.moving.travel
    assert travel is not None
    if pattern.frame.sign > 0.0 and travel.most is not None and start[3] > travel.most + LEVEL:
        raise InputError("the jaw or clamp does not open so far: open it by less.")
    if not pattern.stop <= start[3] <= pattern.widest:
        raise InputError("pegs meet before the jaw or clamp gets there: open it more, or less.")
    into = measure_entered_depth(solver, fixture, pattern, start, turned_over)
    # What is pushed out of a peg may be let go in a tighter place than it was put in; the jaws stand as they
    # stood.
    first = max(FIRST_STEP, into / STEPS_DEEP)
    configs, how = closing.close_from(start[None], first, level=start[3])
    if how[0] == GAVE_UP:
        raise InputError(
            "a peg stands in the part there, and there is no room beside it: put the part elsewhere."
        )
    path = follow_descent_path(closing, configs[0], is_cancelled)
    end, how = closing.close_from(path[-1][None], FIRST_STEP)
    path.append(end[0])
    ending, seat = classify_ending(solver, closing, center, end[0], int(how[0]), seats)
    poses = tuple(center.make_pose(config) for config in path)
    return ClosingSimulation(
        poses, tuple(pattern.frame.sign * float(config[3]) for config in path), ending, seat
    )


@frozen
class CenterFrame:
    """The map between poses of a part and configurations of the centre of its box in a closing frame.

    Parameters
    ----------
    middle : centre of the box in the part's own coordinates, in mm.
    turned_over : whether the part is turned over.
    frame : change to the toolkit's frame and back.
    """

    middle: tuple[float, float]
    turned_over: bool
    frame: ClosingFrame

    @property
    def own(self) -> tuple[float, float]:
        """The centre of the part's bounding box in mm, in the part's own coordinates; for a part turned over,
        x is negated.
        """
        x, y = self.middle
        return (-x, y) if self.turned_over else (x, y)

    def make_configuration(self, pose: Pose, travelled: float) -> Array:
        """Return the configuration (4,) that belongs to a pose and a travel (mm) in the toolkit's frame.

        It is in the closing frame: theta in radians, x and y of the centre of the part's box in mm, and the
        jaw separation S in mm.
        """
        return self.frame.map_from_toolkit(
            np.array([radians(pose.theta_deg), *pose.apply(*self.own), travelled])
        )

    def make_pose(self, config: Array) -> Pose:
        """Return the pose in the toolkit's frame that belongs to a configuration (4,); its theta is from 0 to
        360 degrees.
        """
        left, (x, y) = self.frame.map_to_toolkit(config), self.own
        theta = float(left[0]) % tau
        c, s = cos(theta), sin(theta)
        return Pose(degrees(theta), float(left[1]) - (c * x - s * y), float(left[2]) - (s * x + c * y))


def measure_entered_depth(
    solver: SeatingSolver, fixture: Fixture, pattern: Pattern, config: Array, turned_over: bool
) -> float:
    """Return the depth in mm to which a peg or a wall is inside the part in a configuration (4,); 0 if none
    is.

    Raises
    ------
    InputError
        If it is deeper than ``ENTERS`` peg radii.
    """
    rows = solver.outline.rows
    points = pattern.place_pegs(config[None])[0] * ([-1.0, 1.0] if turned_over else [1.0, 1.0])
    away = measure_outline_distances(np.ascontiguousarray(points), rows)
    deepest = 0.0
    if pattern.half_plane is not None:
        hull = solver.make_closing(pattern, turned_over).boundary.hull
        deepest = max(-float(hull.compute_wall_clearance(config[None], pattern.half_plane)[0]), 0.0)
        if deepest > ENTERS * min(pattern.radii):
            raise InputError("the part lies in the fence there: put it clear of the fence.")
    pegs = [fixture.pegs[number] for number in pattern.numbers]
    for (x, y), off, peg in zip(points.tolist(), away.tolist(), pegs, strict=True):
        radius = solver.toolkit.find_carrier(peg.carrier).peg_radius
        depth = radius + off if is_inside(x, y, rows) else radius - off
        if depth > ENTERS * radius:
            raise InputError(
                f"the peg in {peg.hole} stands in the part there: put the part elsewhere, or open farther."
            )
        deepest = max(deepest, depth)
    return deepest


def follow_descent_path(
    closing: ClosingMotion, config: Array, is_cancelled: Callable[[], bool]
) -> list[Array]:
    """Return configurations (4,) along the descent path from ``config``, at evenly spaced values of S.

    The first is ``config``; S is the jaw separation in mm. The path is shorter where it is cancelled.
    """
    path = [config]
    while not is_cancelled() and len(path) < MOST:
        before = float(path[-1][3])
        low = float(closing.close_from(path[-1][None], FIRST_STEP)[0][0, 3])
        # A path from level to level may take another turn than one without levels, and end lower.
        if before - low < LEVEL:
            break
        for level in np.linspace(before, low, LEVELS + 1)[1:]:
            if is_cancelled() or len(path) >= MOST:
                break
            follow_to_level(closing, path, float(level), HALVINGS)
        if before - path[-1][3] < LEVEL:
            break
    return path


def follow_to_level(closing: ClosingMotion, path: list[Array], level: float, halvings: int) -> None:
    """Follow a descent path to the value ``level`` of the jaw separation S (mm), and append to ``path`` in
    place.

    Where the part moves far, the stretch of S is halved, up to ``halvings`` times, so that more
    configurations are appended.
    """
    before = path[-1]
    if level >= before[3]:
        return
    after = closing.close_from(before[None], FIRST_STEP, level=level)[0][0]
    if (
        halvings
        and len(path) < MOST
        and measure_distances(after[None], before, closing.size)[0] > FAR * closing.size
    ):
        follow_to_level(closing, path, (before[3] + float(after[3])) / 2.0, halvings - 1)
        follow_to_level(closing, path, level, halvings - 1)
    else:
        path.append(after)


def classify_ending(
    solver: SeatingSolver,
    closing: ClosingMotion,
    center: CenterFrame,
    config: Array,
    how: int,
    seats: Sequence[Seat],
) -> tuple[str, Seat | None]:
    """Return (one of :data:`ENDINGS` for a path, the seat of ``seats`` in which it ended or None).

    ``config`` (4,) is its last configuration, and ``how`` the code of ``kernels.seating.closing`` for its
    end.
    """
    if how == GAVE_UP:
        return "lost", None
    if how == AT_THE_STOP:
        return ("outside" if closing.find_escaping(config[None])[0] else "stop"), None
    best, found = inf, None
    for seat in seats:
        there = center.make_configuration(seat.pose, seat.jaw_separation)
        if seat.mirrored != center.turned_over or abs(there[3] - config[3]) > SAME_LEVEL:
            continue
        away = float(measure_distances(there[None], config, closing.size)[0])
        # Where nothing locates the part, it may lie anywhere along what the seat is the middle of.
        if away < best and (away < AT_SEAT or seat.kind in ("loose", "unsettled")):
            best, found = away, seat
    if found is None:
        return "elsewhere", None
    return ("right" if found.is_own else "same place" if found.same_place else "wrong"), found
