"""Where a part on a fence is in balance: what bounds isolate against sampling by plain formulas."""

from __future__ import annotations

from math import cos, pi, radians, sin, sqrt, tan

import numpy as np
import pytest
from scipy.optimize import fsolve

import workhold
from workhold import Fence, Fixture, Peg, Pose, Workpiece
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import (
    CONTACTS,
    DOUBT,
    FORCE,
    MOTION,
    PEG,
    PIECE,
    RESIDUAL,
    SECOND,
    THETA,
)
from workhold.model.quality import FIGURE_RANKING
from workhold.seating.contact_forces import write_forces_on_wall
from workhold.seating.pattern import Pattern
from workhold.seating.solver import SeatingSolver
from workhold.seating.wall_equilibria import LOCATOR, TIP, WallEquilibria

PART = Workpiece.from_loops(
    "rounded",
    [[[0, 0, 0], [60, 8, 0.3], [60, 40, 0], [30, 50, 0], [0, 30, 0]], [[22, 22, -1.0], [38, 26, -1.0]]],
)
# With inner corners, in which the tip may be.
NOTCHED = Workpiece.from_loops(
    "notched",
    [[[0, 0, 0], [70, 0, 0], [70, 45, 0], [48, 45, 0], [42, 28, 0], [30, 30, 0], [26, 52, 0.2], [0, 40, 0]]],
)
# Of random parts on fences with a clamp of each direction.
SEEDS = (0, 1, 6, 11, 27)


def crossings(row, side, theta, level):
    """Where level lines (N,) cross a piece of a part in orientations (N,), from the part's place, and the outward normals
    there; NaN where they do not.

    Parameters
    ----------
    side : of an arc's two crossings.
    """
    c, s = np.cos(theta), np.sin(theta)
    cx, up = c * row[X] - s * row[Y], level - (s * row[X] + c * row[Y])
    mx, my = c * row[AXIS_X] - s * row[AXIS_Y], s * row[AXIS_X] + c * row[AXIS_Y]
    with np.errstate(all="ignore"):
        if row[IS_ARC] == 0.0:
            there = np.abs(up) <= row[HALF_EXTENT] * np.abs(my)
            along, nx, ny = cx + up / my * mx, my, -mx
        else:
            dx = side * np.sqrt((row[RADIUS] - up) * (row[RADIUS] + up))
            there = np.abs(np.arctan2(mx * up - my * dx, mx * dx + my * up)) <= row[HALF_EXTENT]
            along, nx, ny = cx + dx, row[SIGN] * dx / row[RADIUS], row[SIGN] * up / row[RADIUS]
        return np.where(there, along, np.nan), nx + 0.0 * along, ny + 0.0 * along


def separations(fence, piece, locator, tip, theta):
    """S (N,) of a part that stands on a piece of its hull and touches locator and tip, each with a piece and a side, and
    whether all three may press; NaN where one does not touch."""
    (lx, ly), (tx, ty) = fence.pattern.pegs[LOCATOR], fence.pattern.pegs[TIP]
    ux, uy, off = fence.half_plane
    row, c, s = fence.boundary.hull.rows[piece], np.cos(theta), np.sin(theta)
    rows = fence.boundary.rows
    if ux:
        x = ux * (off + row[2]) - (c * row[0] - s * row[1])
        across, bx, by = crossings(rows[locator[0]], locator[1], theta + pi / 2.0, lx - x)
        ax, ay, y = by, -bx, ly + across
    else:
        y = uy * (off + row[2]) - (s * row[0] + c * row[1])
        along, ax, ay = crossings(rows[locator[0]], locator[1], theta, ly - y)
        x = lx - along
    ahead, bx, by = crossings(rows[tip[0]], tip[1], theta, ty - y)
    with np.errstate(all="ignore"):
        # What the tip's force, 1 along x, needs of the locator's and the wall's.
        first = -by / bx / ay if ux else -1.0 / ax
        second = ux * (1.0 + first * ax) if ux else uy * (by / bx + first * ay)
    return x + ahead - tx, (bx > 0.0) & (first > 0.0) & (second > 0.0)


def sides_of(fence, jaw):
    """Pieces of the locator (0) or the tip (1), and sides of arcs."""
    for number in range(*fence.boundary.parts[jaw]):
        yield from (
            (number, side) for side in ((1.0, -1.0) if fence.boundary.rows[number, IS_ARC] else (1.0,))
        )


def sampled(fence, step):
    """Orientations and pieces at which S, sampled in steps of radians, is less or more than at both sides and all may
    press, found by golden section: rows of theta, piece on the wall, of the locator and of the tip."""
    for piece, low, high in fence.runs:
        thetas = np.linspace(low, high, max(int((high - low) / step), 4) + 1)
        for locator in sides_of(fence, 0):
            if (
                np.isnan(separations(fence, piece, locator, locator, thetas)[0]).all()
                and not fence.runs_along_y
            ):
                continue
            for tip in sides_of(fence, 1):
                s, _ = separations(fence, piece, locator, tip, thetas)
                for sign in (1.0, -1.0):
                    least = (sign * s[1:-1] < sign * s[:-2]) & (sign * s[1:-1] < sign * s[2:])
                    for k in np.flatnonzero(least):
                        theta = golden(fence, piece, locator, tip, thetas[k], thetas[k + 2], sign)
                        if separations(fence, piece, locator, tip, np.array([theta]))[1][0]:
                            yield theta, piece, locator[0], tip[0]


def golden(fence, piece, locator, tip, low, high, sign):
    """An orientation between two at which S, times a sign, is least; to the square root of rounding."""
    ratio = (sqrt(5.0) - 1.0) / 2.0
    while high - low > 1e-8:
        inner = np.array([high - ratio * (high - low), low + ratio * (high - low)])
        one, two = sign * separations(fence, piece, locator, tip, inner)[0]
        low, high = (low, inner[1]) if one < two else (inner[0], high)
    return (low + high) / 2.0


def placed(part, toolkit, locator, tip):
    """A part on a fence with a locator and a tip at places in mm."""
    at = (
        ("plate", *locator),
        ("wall", 0.0, 0.0),
        ("wall", 1.0, 0.0),
        (f"clamp {toolkit.directions[0]}", *tip),
    )
    fixture = Fixture(
        "edge", tuple(Peg(name, 0, 0, x, y, 0, 0.0) for name, x, y in at), Pose(0, 0, 0), 0.0, {}
    )
    closing = SeatingSolver(part, toolkit).make_closing(Pattern.from_fixture(fixture, toolkit), False)
    return WallEquilibria(closing.boundary, closing.pattern), closing


def missing(fence, step):
    """What sampling finds and bounds do not."""
    found = fence.find_three_contacts()
    on_hull = found[:, PIECE + 2] - len(fence.boundary.rows)
    out, count = [], 0
    for theta, piece, locator, tip in sampled(fence, step):
        same = (found[:, PIECE] == locator) & (found[:, PIECE + 1] == tip) & (on_hull == piece)
        count += 1
        if not (same & (np.abs(found[:, THETA] - theta) < 1e-5)).any():
            out.append((theta, piece, locator, tip))
    return out, count


def random_part(seed):
    """A part with faces and arcs, shallow ones too, about a middle."""
    random = np.random.default_rng(seed)
    count = int(random.integers(4, 8))
    angles = (np.arange(count) + random.uniform(0.1, 0.9, count)) * 2.0 * pi / count
    reach = random.uniform(20.0, 45.0, count)
    bulges = random.choice([0.0, 0.02, -0.1, 0.25], count)
    loop = np.stack([reach * np.cos(angles), reach * np.sin(angles), bulges], axis=1).round(3)
    return Workpiece.from_loops(f"random {seed}", [loop.tolist()])


def random_fence(seed):
    """A random part on a fence, clamped along it or onto it."""
    random = np.random.default_rng(1000 + seed)
    way = ("+x", "-x", "+y", "-y")[seed % 4]
    toolkit = Fence(
        pitch=20, peg_radius=3, wall_offset=10, directions=[way], clamp_radius=float(random.uniform(2, 6))
    )
    locator, tip = random.uniform((-20.0, 10.0), (20.0, 50.0), (2, 2))
    # A clamp that lifts the part off the wall lifts it against a locator above it.
    locator[1] += 30.0 * (way == "+y")
    return placed(random_part(seed), toolkit, locator, tip)[0]


@pytest.mark.thorough
def test_no_balance_that_sampling_finds_is_missed():
    """A few random parts in steps of 5e-3 radians; many more in small steps below."""
    told = [missing(random_fence(seed), 5e-3) for seed in SEEDS]
    assert [out for out, _ in told] == [[]] * len(SEEDS) and min(count for _, count in told) > 1


@pytest.mark.prove
@pytest.mark.parametrize("seed", range(36))
def test_no_balance_of_many_parts_is_missed(seed):
    assert missing(random_fence(seed), 1e-4)[0] == []


def made_with_two():
    """A part on a round foot between a locator on a flat and a tip on an arc, made so that S' is 0 at two orientations that
    are 0.04 degrees apart; and these.

    About the foot's centre, both pegs k above it, the locator's line is p away and the tip's circle has its centre at c. S
    is, but for a constant, c cos t + sqrt(R^2 - (k - c sin t)^2) + (p + k sin t) / cos t.
    """
    p, k, pair = 30.0, -4.0, (-0.4, -0.4 + radians(0.04))

    def slope(t, c, radius):
        up = k - c * sin(t)
        return -c * sin(t) + up * c * cos(t) / sqrt(radius**2 - up * up) + (k + p * sin(t)) / cos(t) ** 2

    def both(unknown):
        one, two = (slope(t, *unknown) for t in pair)
        return one, (two - one) / (pair[1] - pair[0])

    (c, radius), told, _, _ = fsolve(both, (32.7, 47.3), full_output=True, xtol=1e-15)
    assert np.abs(told["fvec"]).max() < 1e-9
    # Pegs of radius 3; the foot is 35 about the origin.
    corners = [[3.0 - p, 10.0, 0.0], [3.0 - p, -20.0, 0.0]]
    for x, size, low, high in ((0.0, 35.0, -85.0, -30.0), (c, radius - 3.0, 10.0, 50.0)):
        corners += [[x + size * cos(radians(low)), size * sin(radians(low)), tan(radians(high - low) / 4.0)]]
        corners += [[x + size * cos(radians(high)), size * sin(radians(high)), 0.0]]
    toolkit = Fence(pitch=20, peg_radius=3, wall_offset=10, directions=["-x"])
    return placed(Workpiece.from_loops("two", [corners]), toolkit, (0.0, 35.0 + k), (100.0, 35.0 + k)), pair


def test_two_balances_less_than_a_twentieth_of_a_degree_apart_are_both_found():
    """One a minimum of S over the orientation, the other a maximum; both press, and neither is in doubt."""
    (fence, closing), pair = made_with_two()
    found = fence.find_three_contacts()
    found[:, THETA] = (found[:, THETA] + pi) % (2.0 * pi) - pi
    near = found[np.argsort(found[:, THETA])]
    near = near[np.abs(near[:, THETA] - pair[0]) < 0.01]
    assert near[:, THETA] == pytest.approx(pair, abs=1e-8) and (near[:, DOUBT] == 0.0).all()
    assert near[0, SECOND] * near[1, SECOND] < 0.0 and np.abs(near[:, SECOND]).max() < 1.0
    write_forces_on_wall(near, closing.boundary, closing.pattern, closing.size)
    assert (near[:, RESIDUAL] < 1e-7).all() and near[:, FORCE : FORCE + 3].min() > 0.0


@pytest.mark.parametrize("seed", SEEDS)
def test_candidates_of_three_contacts_are_stationary(seed):
    """S does not change, to first order, along the motion that is told, and changes by its second derivative."""
    fence = random_fence(seed)
    found = fence.find_three_contacts()
    assert len(found) and (found[:, CONTACTS] == 3.0).all() and not found[:, DOUBT].any()
    for row in found:
        piece, step = int(row[PIECE + 2]) - len(fence.boundary.rows), 1e-4
        thetas = row[THETA] + np.array([-step, 0.0, step])
        both = [[(int(row[at]), side) for side in (1.0, -1.0)] for at in (PIECE, PIECE + 1)]
        told = [separations(fence, piece, one, two, thetas)[0] for one in both[0] for two in both[1]]
        at = min(told, key=lambda s: abs(s[1] - row[3]) if np.isfinite(s).all() else np.inf)
        if not np.isfinite(at).all() or abs(row[SECOND]) > 1e4:
            continue
        assert at[1] == pytest.approx(row[3], abs=1e-9)
        assert (at[2] - at[0]) / (2.0 * step) == pytest.approx(
            0.0, abs=1e-3 * (1.0 + abs(row[SECOND])) * step * 100
        )
        assert (at[2] - 2.0 * at[1] + at[0]) / step**2 == pytest.approx(row[SECOND], rel=1e-2, abs=1e-3)
        # Both on the wall and at the locator the part stays.
        ux, uy, _ = fence.half_plane
        c, s = cos(row[THETA]), sin(row[THETA])
        hx, hy = fence.boundary.hull.rows[piece, :2]
        vx, vy = row[MOTION + 1] - (s * hx + c * hy), row[MOTION + 2] + (c * hx - s * hy)
        assert ux * vx + uy * vy == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("way", ["+x", "-y"])
def test_the_tip_is_in_a_pocket_wherever_the_locator_touches_too(way):
    """On a part with inner corners: where the locator's distance from a face changes its sign as the part turns."""
    toolkit = Fence(pitch=20, peg_radius=3, wall_offset=10, directions=[way])
    fence, _ = placed(NOTCHED, toolkit, (30.0, 20.0), (60.0, 45.0) if way == "-y" else (-30.0, 45.0))
    found, count, (ux, uy, off) = fence.find_tip_in_pocket(), 0, fence.half_plane
    (lx, ly), (_, ty) = fence.pattern.pegs
    touched = found[(found[:, CONTACTS] == 4.0) & (found[:, PEG] == LOCATOR)]
    assert not touched[:, DOUBT].any() and (touched[:, PEG + 2 : PEG + 4] == TIP).all()
    rows, boundary = fence.boundary.rows, fence.boundary
    for (vx, vy), pieces in zip(boundary.pockets[:, :2], boundary.pocket_pieces, strict=True):
        if not boundary.can_touch(1, int(pieces[0])):
            continue
        for piece, low, high in fence.runs:
            thetas = np.linspace(low, high, 3000)
            c, s = np.cos(thetas), np.sin(thetas)
            hull = boundary.hull.rows[piece]
            if ux:
                x, y = ux * (off + hull[2]) - (c * hull[0] - s * hull[1]), ty - (s * vx + c * vy)
                qx, qy = c * (lx - x) + s * (ly - y), c * (ly - y) - s * (lx - x)
            for number in range(*boundary.parts[0]):
                row = rows[number]
                if not ux:
                    # The wall and the tip alone tell the orientation.
                    values = uy * (off + hull[2]) - (s * hull[0] + c * hull[1]) + s * vx + c * vy - ty
                    on = np.ones(len(thetas), bool)
                elif row[IS_ARC]:
                    values = np.hypot(qx - row[X], qy - row[Y]) - row[RADIUS]
                    turn = np.arctan2(qy - row[Y], qx - row[X]) - np.arctan2(row[AXIS_Y], row[AXIS_X])
                    on = np.abs((turn + pi) % (2 * pi) - pi) < row[HALF_EXTENT] - 0.01
                else:
                    values = (qx - row[X]) * row[AXIS_Y] - (qy - row[Y]) * row[AXIS_X]
                    on = (
                        np.abs((qx - row[X]) * row[AXIS_X] + (qy - row[Y]) * row[AXIS_Y])
                        < row[HALF_EXTENT] - 0.1
                    )
                for k in np.flatnonzero((values[1:] * values[:-1] < 0.0) & on[1:]):
                    y = uy * (off + hull[2]) - (s[k] * hull[0] + c[k] * hull[1])
                    if not ux and not any(
                        np.isfinite(crossings(row, side, thetas[k : k + 1], ly - y)[0][0])
                        for side in (1.0, -1.0)
                    ):
                        continue
                    same = (touched[:, PIECE] == number) & (touched[:, PIECE + 1] == len(rows) + piece)
                    same &= (touched[:, PIECE + 2 : PIECE + 4] == pieces).all(axis=1)
                    assert (
                        same & (np.abs(touched[:, THETA] - thetas[k]) < 2.0 * (thetas[1] - thetas[0]))
                    ).any()
                    count += 1
    assert count > 0 and len(touched) >= count


def test_no_two_fixtures_of_a_design_are_in_doubt():
    """What was to be settled by other means is: of the pattern of a listed fixture no balance is in doubt."""
    toolkit = Fence(pitch=20, peg_radius=3, wall_offset=10)
    for fixture in workhold.design(PART, toolkit, best=3, rank_by=FIGURE_RANKING):
        pattern = Pattern.from_fixture(fixture, toolkit)
        fence = WallEquilibria(SeatingSolver(PART, toolkit).make_closing(pattern, False).boundary, pattern)
        assert not fence.find_three_contacts()[:, DOUBT].any()
