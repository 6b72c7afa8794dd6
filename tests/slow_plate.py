"""A slow search of a plate with one clamp or two that shares no arithmetic with the program's.

Three locators on three faces: two of them fix the part up to its orientation, in closed form, and the third's distance from
its face is a function of the orientation alone. Its zeros are found on a fine grid, between the exact ends of where the
function exists, and by halving. Clamps follow in closed form, and closure from the locators' reactions (plates.md: closure
is lo < hi). Clamps are tips alone: strokes are not looked at.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, product
from math import cos, inf, pi, sin, tau
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from slow_fence import WAYS, distances
from workhold import Plate, Result, Workpiece
from workhold.geometry.loop import Face
from workhold.geometry.segment import Line

Array = NDArray[np.float64]
STEPS = 5760
# mm. A centre may be nearer to the part than the radius by this much.
SLACK = 1e-7
# mm. A contact this near to an end of its face may be listed or not (marginal).
MARGINAL = 1e-6
LEAST_SEAT, LEAST_PUSH, NO_REACTION = 1e-6, 1e-6, 1e-9


@frozen(eq=False)
class Carrier:
    """What a peg's centre is on while the peg touches a face: a line n . q = d, or a circle about a point."""

    face: Face
    is_line: bool
    point: Array
    size: float
    sign: float

    @classmethod
    def of(cls, face: Face, radius: float) -> Carrier:
        """The carrier of a peg of some radius."""
        segment = face.segment
        if isinstance(segment, Line):
            normal = np.array(segment.compute_normal())
            return cls(face, True, normal, float(normal @ np.array(segment.middle)) + radius, 1.0)
        return cls(
            face, False, np.array(segment.center), segment.radius + segment.sign * radius, segment.sign
        )

    def misfit(self, points: Array) -> Array:
        """Signed distance (...) in mm of points (..., 2) from the carrier."""
        if self.is_line:
            return np.asarray(points @ self.point - self.size)
        return np.asarray(np.linalg.norm(points - self.point, axis=-1) - self.size)

    def normal(self, point: Array) -> Array:
        """The outward normal (2,) at a point of the carrier."""
        return self.point if self.is_line else self.sign * (point - self.point) / self.size


def turns(psi: Array) -> Array:
    """Rotations (N, 2, 2) by angles (N,)."""
    return np.moveaxis(np.array([[np.cos(psi), -np.sin(psi)], [np.sin(psi), np.cos(psi)]]), -1, 0)


def on_both(one: Carrier, other: Carrier, shift: Array, branch: int) -> Array:
    """Points u (N, 2) on one carrier with u + shift on the other, for shifts (N, 2); NaN where there is none."""
    with np.errstate(invalid="ignore", divide="ignore"):
        if one.is_line and other.is_line:
            if branch:
                return np.full_like(shift, np.nan)
            return np.asarray(
                np.linalg.solve(
                    np.broadcast_to(np.array([one.point, other.point]), (len(shift), 2, 2)),
                    np.stack([np.full(len(shift), one.size), other.size - shift @ other.point], axis=1)[
                        ..., None
                    ],
                )[..., 0]
            )
        if one.is_line or other.is_line:
            line, circle = (one, other) if one.is_line else (other, one)
            size = line.size if one.is_line else line.size - shift @ line.point
            center = circle.point - shift if one.is_line else np.broadcast_to(circle.point, shift.shape)
            across = size - center @ line.point
            along = np.array([-line.point[1], line.point[0]])
            half = np.sqrt(circle.size**2 - across**2) * (1.0 if branch else -1.0)
            return np.asarray(center + across[:, None] * line.point + half[:, None] * along)
        center = other.point - shift
        apart = center - one.point
        length = np.linalg.norm(apart, axis=1)
        along = (length**2 + one.size**2 - other.size**2) / (2 * length)
        half = np.sqrt(one.size**2 - along**2) * (1.0 if branch else -1.0)
        unit = apart / length[:, None]
        return np.asarray(
            one.point + along[:, None] * unit + half[:, None] * np.stack([-unit[:, 1], unit[:, 0]], axis=1)
        )


def are_degenerate(one: Carrier, other: Carrier, chord: float) -> bool:
    """Whether two pegs, so far apart in mm, may slide on both carriers at one orientation: parallel lines do, and circles
    that are equal and as far apart as the pegs."""
    if one.is_line and other.is_line:
        return abs(one.point[0] * other.point[1] - one.point[1] * other.point[0]) < 1e-9
    if one.is_line or other.is_line or abs(one.size - other.size) > 1e-9:
        return False
    return abs(float(np.linalg.norm(one.point - other.point)) - chord) < 1e-9


def zeros(function: Any, grid: Array) -> list[float]:
    """Zeros of a function of angles (N,) that is NaN where it does not exist, from angles on a grid; some may be none."""
    values = function(grid)
    # Where the function begins or ends, its ends are cut in.
    is_there = np.isfinite(values)
    change = np.flatnonzero(is_there[1:] != is_there[:-1])
    first = is_there[change]
    a, b = np.where(first, grid[change], grid[change + 1]), np.where(first, grid[change + 1], grid[change])
    for _ in range(50):
        middle = (a + b) / 2
        there = np.isfinite(function(middle))
        a, b = np.where(there, middle, a), np.where(there, b, middle)
    # Where it nearly touches zero between two angles, it is looked at more closely.
    size = np.abs(values)
    with np.errstate(invalid="ignore"):
        low = 1 + np.flatnonzero((size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:]) & (size[1:-1] < 1.0))
    fine = (grid[low, None] + np.linspace(-1.0, 1.0, 65) * (tau / STEPS)).ravel()
    grid = np.sort(np.concatenate([grid, a, fine]))
    values = function(grid)
    found = grid[values == 0.0].tolist()
    with np.errstate(invalid="ignore"):
        change = np.flatnonzero(values[1:] * values[:-1] < 0.0)
    a, b, sign = grid[change], grid[change + 1], np.sign(values[change])
    for _ in range(60):
        middle = (a + b) / 2
        same = np.sign(function(middle)) == sign
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    return [*found, *a.tolist()]


@frozen(eq=False)
class Seat:
    """Three locators in holes, the pose of the part, and the wrenches of the locators, one in each column."""

    holes: tuple[tuple[int, int], ...]
    psi: float
    tail: Array
    wrenches: Array


class Searched:
    """A part on a plate, searched slowly; clamps may meet another outline than locators."""

    def __init__(self, part: Workpiece, plate: Plate, met_by_clamps: Workpiece | None = None) -> None:
        assert plate.columns is not None and plate.rows is not None and plate.travel is None
        self.part, self.plate = part, plate
        self.pitch = np.array(plate.pitch)
        self.center = np.array(part.center)
        low_x, low_y, high_x, high_y = part.bounds
        self.met = part if met_by_clamps is None else met_by_clamps
        self.length = np.hypot(high_x - low_x, high_y - low_y) / 2 + plate.peg_radius
        self.carriers = [Carrier.of(face, plate.peg_radius) for face in part.faces if has_band(part, face)]
        self.grid = 0.2345 + np.arange(STEPS) * (tau / STEPS)
        self.turns = turns(self.grid)
        self.chords: dict[Any, tuple[Array, NDArray[np.bool_]]] = {}
        self.tips = [
            Carrier.of(face, plate.clamp_radius) for face in self.met.faces if has_band(self.met, face)
        ]

    def touches(self, carrier: Carrier, point: Array, radius: float, part: Workpiece | None = None) -> bool:
        """Whether a peg at a point touches inside its face and enters no other.

        What touches another face too is at an end, and marginal, unless the faces are tangent there.
        """
        place, segment, normal = (
            (float(point[0]), float(point[1])),
            carrier.face.segment,
            carrier.normal(point),
        )
        if abs(segment.find_parameter(place)) > segment.half_extent + 1e-9:
            return False
        for face in (part or self.part).faces:
            apart = distances(point[None], face.segment)[0]
            if apart < radius - SLACK:
                return False
            if apart < radius + MARGINAL:
                most = face.segment.half_extent
                there = face.segment.compute_normal(min(max(face.segment.find_parameter(place), -most), most))
                if float(normal @ np.array(there)) < 1.0 - 1e-9:
                    return False
        return True

    def wrench(self, carrier: Carrier, point: Array) -> Array:
        """The wrench (3,) at a contact."""
        n, arm = carrier.normal(point), point - self.center
        return np.array([n[0], n[1], (arm[0] * n[1] - arm[1] * n[0]) / self.length])

    def near(self, carrier: Carrier, points: Array, slack: float) -> NDArray[np.bool_]:
        """Which points (N, 2) are within some mm of a face's stretch of its carrier, beyond its ends and across."""
        return np.asarray(np.abs(distances(points, carrier.face.segment) - self.plate.peg_radius) <= slack)

    def placed(
        self, i: int, j: int, chord: tuple[float, float], branch: int
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Places (N, 2) on the grid of a chord's tail on two carriers, and beside where both pegs may touch."""
        key = i, j, chord, branch
        if key not in self.chords:
            one, other, shift = self.carriers[i], self.carriers[j], self.turns @ np.array(chord)
            u = on_both(one, other, shift, branch)
            with np.errstate(invalid="ignore"):
                u[~(self.near(one, u, 1e-3) & self.near(other, u + shift, 1e-3))] = np.nan
            # An end of the stretch may be between two angles.
            there = np.isfinite(u[:, 0])
            beside = there | np.roll(there, 1) | np.roll(there, -1)
            self.chords[key] = on_both(one, other, shift, branch), beside
        return self.chords[key]

    def orientations(self, pegs: Array, chosen: tuple[int, ...]) -> Iterator[tuple[float, Array]]:
        """Turns psi of the pegs (3, 2), and places of the first, at which each may be on its carrier."""
        for i, j, k in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
            chord, reach = pegs[j] - pegs[i], pegs[k] - pegs[i]
            one, other, third = (self.carriers[chosen[n]] for n in (i, j, k))
            if are_degenerate(one, other, float(np.hypot(*chord))):
                continue
            for branch in (0, 1):
                u, beside = self.placed(chosen[i], chosen[j], (float(chord[0]), float(chord[1])), branch)
                if not beside.any():
                    continue
                with np.errstate(invalid="ignore"):
                    near = beside & ~(~self.near(third, u + self.turns @ reach, 6.0) & np.isfinite(u[:, 0]))
                if not near.any():
                    continue
                near = near | np.roll(near, 1) | np.roll(near, -1)

                def place(
                    psi: Array,
                    one: Carrier = one,
                    other: Carrier = other,
                    chord: Array = chord,
                    branch: int = branch,
                ) -> Array:
                    return on_both(one, other, turns(psi) @ chord, branch)

                def misfit(
                    psi: Array, place: Any = place, third: Carrier = third, reach: Array = reach
                ) -> Array:
                    return third.misfit(place(psi) + turns(psi) @ reach)

                for psi in zeros(misfit, self.grid[near]):
                    at = np.array([psi])
                    yield psi, place(at)[0] + turns(at)[0] @ (pegs[0] - pegs[i])
            return

    def seats(self) -> Iterator[Seat]:
        """Every seat, each once."""
        places = list(product(range(self.plate.columns), range(self.plate.rows)))
        for holes in combinations(places, 3):
            if min(i for i, _ in holes) or min(j for _, j in holes):
                continue
            known = set[tuple[float, ...]]()
            pegs = np.array(holes) * self.pitch
            for chosen in product(range(len(self.carriers)), repeat=3):
                carriers = [self.carriers[n] for n in chosen]
                for psi, tail in self.orientations(pegs, chosen):
                    centers = tail + (pegs - pegs[0]) @ turns(np.array([psi]))[0].T
                    pairs = list(zip(carriers, centers, strict=True))
                    if not all(
                        abs(c.misfit(q)) < 1e-7 and self.touches(c, q, self.plate.peg_radius)
                        for c, q in pairs
                    ):
                        continue
                    wrenches = np.stack([self.wrench(c, q) for c, q in pairs], axis=1)
                    key = tuple(np.round([cos(psi), sin(psi), *tail], 5) + 0.0)
                    if abs(np.linalg.det(wrenches)) > LEAST_SEAT and key not in known:
                        known.add(key)
                        yield Seat(holes, psi, tail, wrenches)

    def clamps(self, seat: Seat) -> Iterator[tuple[str, int, float, Array]]:
        """Clamps of a seat: direction, line, place along it in mm from hole (0, 0), and reactions of the locators times
        the push, (3,)."""
        turn, pegs = turns(np.array([seat.psi]))[0], np.array(seat.holes) * self.pitch
        names = sorted(
            {name for pair in self.plate.directions for name in ([pair] if isinstance(pair, str) else pair)}
        )
        for name in names:
            way, axis = np.array(WAYS[name]), "xy".index(name[1])
            most = (self.plate.rows, self.plate.columns)[axis]
            for line in range(1 - most, most):
                start = np.zeros(2)
                start[1 - axis] = line * self.pitch[1 - axis]
                origin, along = seat.tail + turn @ (start - pegs[0]), turn @ np.abs(way)
                seen = set[float]()
                for carrier in self.tips:
                    for s in met(carrier, origin, along):
                        tip = origin + s * along
                        push = -float(carrier.normal(tip) @ turn @ way)
                        apart = np.linalg.norm(pegs - (start + s * np.abs(way)), axis=1).min()
                        if (
                            push <= LEAST_PUSH
                            or apart < self.plate.peg_radius + self.plate.clamp_radius - 1e-9
                        ):
                            continue
                        if round(s, 5) not in seen and self.touches(
                            carrier, tip, self.plate.clamp_radius, self.met
                        ):
                            seen.add(round(s, 5))
                            force = -np.linalg.solve(seat.wrenches, self.wrench(carrier, tip))
                            yield name, line, s, np.where(np.abs(force / push) < NO_REACTION, 0.0, force)

    def fits(self, seat: Seat, clamps: tuple[Any, ...]) -> bool:
        """Whether holes and lines fit the plate."""
        columns, rows = ([hole[k] for hole in seat.holes] for k in (0, 1))
        for name, line, *_ in clamps:
            (rows if name[1] == "x" else columns).append(line)
        limits = (columns, self.plate.columns), (rows, self.plate.rows)
        return all(max(numbers) - min(numbers) < most for numbers, most in limits)

    def fixtures(self) -> set[tuple[Any, ...]]:
        """Every fixture, as :func:`seen` tells those of a result."""
        found = set[tuple[Any, ...]]()
        for seat in self.seats():
            clamps = list(self.clamps(seat))
            chosen: Any = ((c,) for c in clamps) if self.plate.clamps == 1 else combinations(clamps, 2)
            for some in chosen:
                names = tuple(sorted((c[0] for c in some), key=list(WAYS).index))
                if self.plate.clamps == 2 and names not in self.plate.directions:
                    continue
                if self.closes(some) and self.fits(seat, some) and self.are_apart(some):
                    tail = seat.tail - turns(np.array([seat.psi]))[0] @ (np.array(seat.holes[0]) * self.pitch)
                    found.add(key_of(-seat.psi, tail, seat.holes, [c[:3] for c in some]))
        return found

    def closes(self, clamps: tuple[Any, ...]) -> bool:
        """Whether locators and clamps close, and of two clamps neither alone."""
        alone = [float(np.min(c[3])) / (1.0 + float(np.abs(c[3]).sum())) > NO_REACTION for c in clamps]
        if len(clamps) == 1:
            return alone[0]
        (*_, one), (*_, other) = clamps
        low, high = 0.0, inf
        for a, b in zip(one.tolist(), other.tolist(), strict=True):
            if b > 0.0:
                low = max(low, -a / b)
            elif b < 0.0:
                high = min(high, -a / b)
            elif a <= 0.0:
                return False
        return not any(alone) and high - low > 1e-9 * (1.0 + low)

    def are_apart(self, clamps: tuple[Any, ...]) -> bool:
        """Whether the tips of two clamps have room."""
        tips = []
        for name, line, s, _ in clamps:
            axis = "xy".index(name[1])
            tip = [line * self.pitch[1 - axis]] * 2
            tip[axis] = s
            tips.append(tip)
        return len(tips) < 2 or bool(np.hypot(*np.subtract(*tips)) >= 2 * self.plate.clamp_radius - 1e-9)


def met(carrier: Carrier, origin: Array, along: Array) -> list[float]:
    """Where a line, from a point in mm, meets a carrier."""
    if carrier.is_line:
        rise = float(carrier.point @ along)
        return [] if abs(rise) < 1e-12 else [(carrier.size - float(carrier.point @ origin)) / rise]
    middle = float((carrier.point - origin) @ along)
    across = float(np.linalg.norm(carrier.point - origin - middle * along))
    if across > carrier.size or carrier.size <= 0.0:
        return []
    half = float(np.sqrt(carrier.size**2 - across**2))
    return [middle - half, middle + half]


def key_of(theta: float, tail: Array, holes: Any, clamps: Any) -> tuple[Any, ...]:
    """What tells fixtures apart: holes and lines from the lowest locator's, the angle, where hole (0, 0) is on the part, and
    the tips, rounded."""
    angle = round((theta + 0.1234) % tau, 4) % round(tau, 4)
    place = tuple(round(float(v) + 0.01234, 3) for v in tail)
    tips = tuple(sorted((name, line, round(float(s) + 0.01234, 3)) for name, line, s in clamps))
    return tuple(sorted(holes)), angle, place, tips


def seen(result: Result) -> set[tuple[Any, ...]]:
    """Fixtures of a result, in the same words."""
    found = set()
    for fixture in result:
        plate, pegs = result.toolkit, fixture.pegs
        column, row = (min(getattr(peg, name) for peg in pegs[:3]) for name in ("column", "row"))
        corner = column * plate.pitch[0], row * plate.pitch[1]
        holes = [(peg.column - column, peg.row - row) for peg in pegs[:3]]
        tail = np.array(fixture.pose.inverse.apply(*corner))
        clamps = []
        for peg in pegs[3:]:
            name = peg.carrier.removeprefix("clamp ") if plate.clamps == 2 else fixture.direction
            along_x = name[1] == "x"
            line = peg.row - row if along_x else peg.column - column
            clamps.append((name, line, peg.x - corner[0] if along_x else peg.y - corner[1]))
        found.add(key_of(fixture.pose.theta_deg * pi / 180.0, tail, holes, clamps))
    return found


def has_band(part: Workpiece, face: Face) -> bool:
    """Whether something may touch a face."""
    return part.solid is None or part.solid.bands[face.number] is not None


def slow_plate(part: Workpiece, plate: Plate, met_by_clamps: Workpiece | None = None) -> set[tuple[Any, ...]]:
    """Every fixture of a part on a plate with limits and without strokes, one clamp or two.

    Parameters
    ----------
    met_by_clamps : the outline that clamps meet; that of the locators if None.
    """
    return Searched(part, plate, met_by_clamps).fixtures()
