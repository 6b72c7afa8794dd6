"""Proof of supports after the fact: every triple of a file derived again from the six equations of balance.

Nothing of ``workhold.supports`` is used. Pads and tip are held against the faces segment by segment. Forces
are solved from the balance in space together with the push on what moves. That is done at both ends of every
band and at the stationary directions of every load. No barycentric coordinate, no worst height and no place
of a clamp is taken from what is judged. That there is no better place of the clamp is
tried at points of a grid. Numbers are doubles, and have to agree to 1e-6 of themselves.
Of a complete list all other triples are tried too (``verification.support_listing``).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import product
from math import ceil, hypot, inf, pi, radians
from pathlib import Path

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.files.result.parts import checked_head
from workhold.files.supports_forms import (
    FORMAT,
    ClampFiguresPart,
    TriplePart,
    read_supports_part,
)
from workhold.fixels.contacts import CLAMP_TIP
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.support_request import SpatialLoad, SupportRequest
from workhold.verification.reading import fixtures_of
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.support_listing import (
    Hole,
    area_center,
    band_faults,
    inside_of,
    missing_triples,
    opened_clear_of_blocked,
    room_on,
)
from workhold.verification.verify import Judge, Unproven, Verification

__all__ = ["SupportsJudge", "is_supports_file", "verify_supports_file"]

Array = NDArray[np.float64]
# mm, or parts of a figure: what is written agrees with what is derived to this.
AGREEMENT = 1e-6
# Points tried along each side of a triangle.
GRID = 12


def is_supports_file(path: str | Path) -> bool:
    """Whether a file says at its beginning that it is one of supports."""
    try:
        with Path(path).open("rb") as stream:
            return FORMAT.encode() in stream.read(200)
    except OSError:
        return False


@frozen(eq=False)
class SupportsJudge:
    """Judges triples over one planar fixture.

    Parameters
    ----------
    query, fixture, request, loads, jaw_force : what a file says.
    """

    query: Query
    fixture: Fixture
    request: SupportRequest
    loads: tuple[SpatialLoad, ...]
    jaw_force: float

    @cached_property
    def pegs(self) -> Array:
        """Places (P, 2) of the pegs, and of the ends on a wall, in the part's coordinates."""
        inverse = self.fixture.pose.inverse
        return np.array([inverse.apply(peg.x, peg.y) for peg in self.fixture.pegs])

    @cached_property
    def pushes(self) -> Array:
        """Unit vectors (P, 2) along which they push the part."""
        # Of a file without its solid, segments that continue one line are one face.
        faces = self.query.workpiece.numbered.faces
        segments = {number: face.segment for face in faces for number in face.segments}
        pushes = []
        for peg, (x, y) in zip(self.fixture.pegs, self.pegs.tolist(), strict=True):
            if peg not in self.fixture.placed:
                # A wall runs along x with the part above it.
                pushes.append(self.fixture.pose.inverse.turn(0.0, 1.0))
                continue
            face = segments[peg.face]
            nx, ny = face.normal(face.parameter((x, y)))
            pushes.append((-nx, -ny))
        return np.array(pushes)

    @property
    def toolkit(self) -> Toolkit:
        """What holds the part."""
        return self.query.toolkit

    def point_of(self, hole: Hole) -> tuple[float, float]:
        """The place of a hole in the part's coordinates."""
        name, column, row = hole
        place = self.toolkit.carrier(name).place(column, row, self.fixture.jaw_separation)
        x, y = self.fixture.pose.inverse.apply(*place)
        return float(x), float(y)

    def pad_room(self, hole: Hole) -> float:
        """The slack in mm by which a pad keeps its rules."""
        asked, point = self.request, self.point_of(hole)
        loops = self.query.workpiece.loops if asked.bottom is None else asked.bottom
        room = room_on(loops, [zone.loop for zone in asked.bottom_zones], point)
        room -= asked.pad_radius + asked.pad_margin
        for peg, place in zip(self.fixture.pegs, self.pegs, strict=True):
            if peg in self.fixture.placed:
                body = self.toolkit.carrier(peg.carrier).body_radius
                room = min(room, hypot(point[0] - place[0], point[1] - place[1]) - asked.pad_radius - body)
        return room

    def tip_room(self, point: tuple[float, float]) -> float:
        """The slack in mm by which the tip keeps the rules of the top."""
        asked = self.request
        loops = self.query.workpiece.loops if asked.top is None else asked.top
        room = room_on(loops, [zone.loop for zone in asked.top_zones], point) - asked.tip_radius
        if asked.reach is not None:
            x, y = self.fixture.pose.apply(*point)
            rings = [
                min(hypot(x - a, y - b) - low, high - hypot(x - a, y - b)) for a, b, low, high in asked.reach
            ]
            room = min(room, max(rings, default=-inf))
        return room

    def travel(self, holes: Sequence[Hole]) -> tuple[bool, float | None]:
        """Whether pegs and supports fit their plates, and the opening of what moves."""
        toolkit, plates = self.toolkit, self.toolkit.plates
        taken: dict[str, list[tuple[int, int]]] = {plate.name: [] for plate in plates}
        for name, column, row in holes:
            taken[name].append((column, row))
        lines = {
            name: ([column for column, _ in places], [row for _, row in places])
            for name, places in taken.items()
        }
        for peg in self.fixture.pegs:
            carrier = toolkit.carrier(peg.carrier)
            for axis, number in enumerate((peg.column, peg.row)):
                if carrier.stands_on in lines and carrier.counted[axis]:
                    lines[carrier.stands_on][axis].append(number)
        fits = True
        every_row = [row for one in lines.values() for row in one[1]]
        for plate in plates:
            columns = lines[plate.name][0]
            if plate.columns is not None and columns:
                fits &= max(columns) - min(columns) < plate.columns
            if plate.rows is not None:
                fits &= max(every_row) - min(every_row) < plate.rows
            if toolkit.wall is not None and plate.travel is None:
                fits &= min(every_row) >= 0 and (plate.rows is None or max(every_row) < plate.rows)
        moving = next((plate for plate in plates if plate.travel is not None), None)
        if moving is None or moving.travel is None:
            return fits, None
        axis = 0 if len(plates) > 1 else 1
        step, own = moving.pitch[axis], lines[moving.name][axis]
        opened = self.fixture.jaw_separation + min(own) * step
        count = (moving.columns, moving.rows)[axis]
        room = inf if count is None else count - 1 - max(own) + min(own)
        for plate in plates:
            if plate is not moving and plate.name != moving.name:
                other = lines[plate.name][axis]
                opened += ((plate.columns or 0) - 1 - max(other)) * step
                room += (plate.columns or 0) - 1 - max(other) + min(other)
        most = moving.travel.most
        back = 0 if most is None else max(ceil((opened - most - 1e-9) / step), 0)
        opened -= back * step
        fits = fits and back <= room and opened >= moving.travel.least - AGREEMENT
        if fits and len(plates) > 1 and any(plate.blocked for plate in plates):
            clear = opened_clear_of_blocked(toolkit, self.fixture, [*holes])
            return clear is not None, clear
        return fits, opened

    def balances(self, supports: Array) -> Array:
        """Support forces (K, 3, 7) per unit of each right side of the balance, at the corners of the bands.

        The columns of the balance are the contacts. Its rows are three forces, three moments, and the push on
        what moves; with two clamps the push of each stands for itself.
        """
        toolkit, count = self.toolkit, len(self.fixture.pegs)
        bands = self.request.peg_bands(count)
        rows = 6 + toolkit.travels
        out = []
        for corner in product((0, 1), repeat=count):
            heights = bands[np.arange(count), corner]
            matrix = np.zeros((rows, count + 3))
            number = 6
            for k, (peg, place, push) in enumerate(
                zip(self.fixture.pegs, self.pegs, self.pushes, strict=True)
            ):
                at, way = np.array([*place, heights[k]]), np.array([*push, 0.0])
                matrix[:3, k], matrix[3:6, k] = way, np.cross(at, way)
                carrier = toolkit.carrier(peg.carrier)
                if carrier.travel is None:
                    continue
                x, y = carrier.travel.unit
                along = self.fixture.pose.inverse.turn(-x * toolkit.clamping, -y * toolkit.clamping)
                matrix[number, k] = float(push @ np.array(along))
                if carrier.contact is CLAMP_TIP:
                    number += 1
            for k, place in enumerate(supports):
                matrix[2, count + k] = 1.0
                matrix[3:6, count + k] = np.cross([*place, 0.0], [0.0, 0.0, 1.0])
            out.append(np.linalg.inv(matrix)[count:])
        return np.array(out)

    def right_side(
        self, point: Sequence[float], force: Sequence[float], moment: Sequence[float], jaw: float
    ) -> Array:
        """What the contacts have to balance: a force at a point, a moment, and the push on what moves."""
        pair = self.fixture.pair
        share = (
            [1.0]
            if pair is None
            else [1 / (1 + pair.working_ratio), pair.working_ratio / (1 + pair.working_ratio)]
        )
        turning = np.cross(point, force) + np.asarray(moment)
        return np.concatenate([-np.asarray(force, float), -turning, jaw * np.array(share)])

    def extremes(self, solved: Array) -> tuple[Array, Array]:
        """Least and greatest support forces without the clamp, over all loads and heights."""
        least, most = np.full(3, inf), np.full(3, -inf)
        for load in self.loads:
            low, high = map(radians, load.directions)
            heights = load.heights or (self.request.thickness,) * 2
            for place, z, axial in product(load.points or ((0.0, 0.0),), set(heights), set(load.axial)):
                at = [*place, z]
                still = solved @ self.right_side(
                    at, [0, 0, -axial], [*load.tilt, load.moment], self.jaw_force
                )
                x = solved @ self.right_side(at, [load.force, 0, 0], [0, 0, 0], 0.0)
                y = solved @ self.right_side(at, [0, load.force, 0], [0, 0, 0], 0.0)
                peak = np.arctan2(y, x)
                angles = [np.full(x.shape, low), np.full(x.shape, high)]
                for turn in (peak, peak + pi):
                    angles.append(np.where((turn - low) % (2 * pi) <= high - low, turn, low))
                values = [still + x * np.cos(one) + y * np.sin(one) for one in angles]
                least = np.minimum(least, np.min(values, axis=(0, 1)))
                most = np.maximum(most, np.max(values, axis=(0, 1)))
        return least, most

    def shares(self, solved: Array, point: Sequence[float]) -> Array:
        """What each support takes of a unit of clamp force at a point."""
        return np.asarray((solved @ self.right_side([*point, 0.0], [0, 0, -1.0], [0, 0, 0], 0.0))[0])

    def faults(self, part: TriplePart) -> Iterator[str]:
        """Everything that speaks against a triple, one sentence each, without a full stop."""
        holes = [(str(a), b, c) for a, b, c in part.holes]
        names = {plate.name for plate in self.toolkit.plates}
        if any(name not in names for name, _, _ in holes) or len(set(holes)) != 3:
            yield "it does not stand in three holes of the plates"
            return
        for hole in holes:
            if self.pad_room(hole) < -AGREEMENT:
                yield f"the pad in {hole} breaks its rules by {-self.pad_room(hole):.3g} mm"
        fits, opened = self.travel(holes)
        if not fits:
            yield "pegs and supports do not fit the columns, the rows or the gap"
        elif (opened is None) != (part.jaw_separation is None) or (
            opened is not None and abs(opened - (part.jaw_separation or 0.0)) > AGREEMENT
        ):
            yield f"the jaw separation is {opened}, and is written as {part.jaw_separation}"
        supports = np.array([self.point_of(hole) for hole in holes])
        if abs(np.linalg.det(np.column_stack([supports, np.ones(3)]))) < AGREEMENT:
            yield "its supports are on one line"
            return
        yield from self.figure_faults(part, supports)

    def figure_faults(self, part: TriplePart, supports: Array) -> Iterator[str]:
        """Whether figures are those of the balance, and no clamp place that is tried is better."""
        solved = self.balances(supports)
        least, most = self.extremes(solved) if self.loads else (np.zeros(3), np.zeros(3))
        jaw = solved @ self.right_side([0, 0, 0], [0, 0, 0], [0, 0, 0], 1.0)
        places = [("best", part.best, part.best.at)]
        if part.given is not None:
            places.append(("given", part.given, list(self.request.point or ())))
        for name, figures, at in places:
            if at is None or len(at) != 2:
                yield f"the {name} clamp point is missing"
                continue
            shares, arm = self.shares(solved, at), inside_of(supports, *at)
            if self.tip_room((at[0], at[1])) < -AGREEMENT or arm < self.request.inside - AGREEMENT:
                yield f"the clamp may not stand at the {name} point"
                continue
            need = max(0.0, float((-least / shares).max()))
            known = {
                "clamp_needed": need,
                "arm": arm,
                "share": float(shares.min()),
                "lift": max(0.0, float((-jaw.min(axis=0) / shares).max())),
            }
            if self.loads:
                known["support_force"] = max(0.0, float((need * shares + most).max()))
            yield from other_figures(name, figures, known)
        center = inside_of(supports, *area_center(self.query.workpiece.loop_segments))
        if differs(part.standing, center):
            yield f"standing is {center:.9g}, and is written as {part.standing:.9g}"
        points = [point for load in self.loads for point in load.points]
        if points:
            over = max(-inside_of(supports, *point) for point in points)
            if differs(part.overhang, over):
                yield f"overhang is {over:.9g}, and is written as {part.overhang}"
        if self.tip_room((part.arm_at[0], part.arm_at[1])) < -AGREEMENT or differs(
            part.arm, inside_of(supports, *part.arm_at)
        ):
            yield f"the arm is not {part.arm:.9g}"
        yield from self.better_places(part, supports, solved, least)

    def better_places(self, part: TriplePart, supports: Array, solved: Array, least: Array) -> Iterator[str]:
        """A fault where a place of a grid over the triangle is better than the one written."""
        for i, j in product(range(1, GRID), repeat=2):
            if i + j >= GRID:
                continue
            x, y = np.array([i, j, GRID - i - j]) / GRID @ supports
            arm = inside_of(supports, x, y)
            if arm < self.request.inside:
                continue
            need = max(0.0, float((-least / self.shares(solved, (x, y))).max()))
            cheaper = need < part.best.clamp_needed * (1 - AGREEMENT) - AGREEMENT
            if (cheaper or arm > part.arm * (1 + AGREEMENT) + AGREEMENT) and self.tip_room((x, y)) > 0:
                yield f"the clamp is better placed at ({x:.6g}, {y:.6g})"
                return


def differs(written: float | None, own: float) -> bool:
    """Whether a number is missing or another one."""
    return written is None or abs(written - own) > AGREEMENT * max(1.0, abs(own))


def other_figures(name: str, figures: ClampFiguresPart, known: dict[str, float]) -> Iterator[str]:
    """A fault for each figure that is another one."""
    for key, value in known.items():
        if differs(getattr(figures, key), value):
            yield f"{key} at the {name} point is {value:.9g}, and is written as {getattr(figures, key)}"


def verify_supports_file(path: str | Path) -> Verification:
    """Derives the planar fixture and every triple of a file of supports again.

    Raises
    ------
    InputError
        When the file cannot be read, or describes no usable part or toolkit.
    """
    path = Path(path)
    part = read_supports_part(path)
    head = checked_head(part.head(), path)
    try:
        query, request = head.query(), part.request()
        loads = tuple(load.load(request.thickness) for load in part.loads)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    fixture = ToolkitRules.of(query).taken(fixtures_of([part.fixture], path)[0])
    planar = Judge(query).rule_on(evolve(fixture, quality={}))
    judge = SupportsJudge(query, fixture, request, loads, part.jaw_force)
    unproven, faults, seen = list[Unproven](), list[str](), set[frozenset[Hole]]()
    if planar.verdict != "proven":
        faults.append(f"its planar fixture is {planar.verdict}: {planar.reason}")
    for place, triple in enumerate(part.triples):
        reasons = [*judge.faults(triple)]
        key = frozenset((str(a), b, c) for a, b, c in triple.holes)
        reasons += ["it is listed twice"] if key in seen else []
        seen.add(key)
        if reasons:
            unproven.append(Unproven(place, "refuted", reasons[0]))
    faults += band_faults(query, fixture, request)
    counted, undecided = part.counts.triples, 0
    if counted != len(part.triples) if part.complete else (counted or inf) < len(part.triples):
        faults.append(f"counts say {counted} triples, but {len(part.triples)} are listed")
    if part.complete and planar.verdict == "proven":
        missing, undecided = missing_triples(judge, seen, part.counts.positions)
        faults += missing
    refuted = len(unproven)
    return Verification(
        len(part.triples) - refuted, refuted, undecided, tuple(unproven), tuple(faults), planar.bits
    )
