"""Verification of supports: every triple of a file is derived again from the six equations of balance.

The code of ``workhold.supports`` is not used. Pads and tip are compared with the faces segment by segment.
Forces are solved from the balance in space together with the push on the moving carrier, at both ends of
every band and at the stationary directions of every load. No barycentric coordinate, no worst height and no
place of a clamp is taken from the list under test. Points of a grid are tried to test that there is no better
place of the clamp. Numbers are doubles, and must agree to a relative 1e-6. For a complete list all other
triples are tried too (``verification.support_listing``).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import product
from math import inf, pi, radians
from pathlib import Path

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.files.result.parts import check_head
from workhold.files.supports_forms import (
    FORMAT,
    ReadFigures,
    ReadTriple,
    read_supports_part,
)
from workhold.fixels.contacts import CLAMP_TIP
from workhold.geometry.segment import Arc, Segment
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.support_request import SpatialLoad, SupportRequest
from workhold.verification.reading import read_fixtures
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.support_listing import (
    Hole,
    SupportPlaces,
    find_missing_triples,
    measure_depth_inside,
)
from workhold.verification.verify import Judge, Unproven, Verification

__all__ = ["SupportsJudge", "find_band_faults", "is_supports_file", "verify_supports_file"]

Array = NDArray[np.float64]
# mm, or parts of a figure: what is written agrees with what is derived to this.
AGREEMENT = 1e-6
# Written heights agree with those of the solid to this, in mm.
SAME_HEIGHT = 1e-6
# Points tried along each side of a triangle.
GRID = 12


def is_supports_file(path: str | Path) -> bool:
    """Return whether a file names the supports format in its first 200 bytes; False where it cannot be
    read.
    """
    path = Path(path)
    if not path.is_file():
        return False
    try:
        with path.open("rb") as stream:
            return FORMAT.encode() in stream.read(200)
    except OSError:
        return False


@frozen(eq=False)
class SupportsJudge(SupportPlaces):
    """Judges triples over one planar fixture.

    Parameters
    ----------
    loads, jaw_force : the file's loads and jaw force, in N.
    """

    loads: tuple[SpatialLoad, ...]
    jaw_force: float

    @cached_property
    def pushes(self) -> Array:
        """The unit vectors (P, 2) along which the pegs push the part, in the part's frame."""
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
            nx, ny = face.compute_normal(face.find_parameter((x, y)))
            pushes.append((-nx, -ny))
        return np.array(pushes)

    def solve_balances(self, supports: Array) -> Array:
        """Return the support forces (K, 3, 7) that balance each of 7 unit right sides, for K choices of band
        ends.

        In each choice every peg presses at the lower or the upper end of its band. The unknowns are the
        forces of the contacts. The 7 equations are three forces, three moments, and the push on what moves.
        With two clamps there are two such pushes, so 8 equations and shape (K, 3, 8).
        """
        toolkit, count = self.toolkit, len(self.fixture.pegs)
        bands = self.request.list_peg_bands(count)
        rows = 6 + toolkit.travel_count
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
                carrier = toolkit.find_carrier(peg.carrier)
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

    def make_right_side(
        self, point: Sequence[float], force: Sequence[float], moment: Sequence[float], jaw: float
    ) -> Array:
        """Return the right side (7,) of the balance under a force at a point, a moment and a jaw force.

        With two clamps it is (8,): the jaw force is split over them at their working ratio. Force and moment
        enter with reversed sign.
        """
        pair = self.fixture.pair
        share = (
            [1.0]
            if pair is None
            else [1 / (1 + pair.working_ratio), pair.working_ratio / (1 + pair.working_ratio)]
        )
        turning = np.cross(point, force) + np.asarray(moment)
        return np.concatenate([-np.asarray(force, float), -turning, jaw * np.array(share)])

    def find_extremes(self, solved: Array) -> tuple[Array, Array]:
        """Return (least (3,), greatest (3,)) forces in N of the three supports without the clamp, over all
        loads and heights.
        """
        least, most = np.full(3, inf), np.full(3, -inf)
        for load in self.loads:
            low, high = map(radians, load.directions)
            heights = load.heights or (self.request.thickness,) * 2
            for place, z, axial in product(load.points or ((0.0, 0.0),), set(heights), set(load.axial)):
                at = [*place, z]
                still = solved @ self.make_right_side(
                    at, [0, 0, -axial], [*load.tilt, load.moment], self.jaw_force
                )
                x = solved @ self.make_right_side(at, [load.force, 0, 0], [0, 0, 0], 0.0)
                y = solved @ self.make_right_side(at, [0, load.force, 0], [0, 0, 0], 0.0)
                peak = np.arctan2(y, x)
                angles = [np.full(x.shape, low), np.full(x.shape, high)]
                for turn in (peak, peak + pi):
                    angles.append(np.where((turn - low) % (2 * pi) <= high - low, turn, low))
                values = [still + x * np.cos(one) + y * np.sin(one) for one in angles]
                least = np.minimum(least, np.min(values, axis=(0, 1)))
                most = np.maximum(most, np.max(values, axis=(0, 1)))
        return least, most

    def compute_shares(self, solved: Array, point: Sequence[float]) -> Array:
        """Return the force (3,) on each support per unit of clamp force at a point of the part's frame."""
        return np.asarray((solved @ self.make_right_side([*point, 0.0], [0, 0, -1.0], [0, 0, 0], 0.0))[0])

    def find_faults(self, part: ReadTriple) -> Iterator[str]:
        """Yield one sentence, without full stop, for each fault of a triple."""
        holes = [(str(a), b, c) for a, b, c in part.holes]
        names = {plate.name for plate in self.toolkit.plates}
        if any(name not in names for name, _, _ in holes) or len(set(holes)) != 3:
            yield "it does not stand in three holes of the plates"
            return
        for hole in holes:
            if self.compute_pad_room(hole) < -AGREEMENT:
                yield f"the pad in {hole} breaks its rules by {-self.compute_pad_room(hole):.3g} mm"
        fits, opened = self.find_travel(holes)
        if not fits:
            yield "pegs and supports do not fit the columns, the rows or the gap"
        elif (opened is None) != (part.jaw_separation is None) or (
            opened is not None and abs(opened - (part.jaw_separation or 0.0)) > AGREEMENT
        ):
            yield f"the jaw separation is {opened}, and is written as {part.jaw_separation}"
        supports = np.array([self.find_hole_place(hole) for hole in holes])
        if abs(np.linalg.det(np.column_stack([supports, np.ones(3)]))) < AGREEMENT:
            yield "its supports are on one line"
            return
        yield from self.find_figure_faults(part, supports)

    def find_figure_faults(self, part: ReadTriple, supports: Array) -> Iterator[str]:
        """Yield one sentence for each figure of a triple that differs from the derived one, or for a better
        place of the clamp.

        ``supports`` (3, 2) are the places of the triple's supports in the part's frame.
        """
        solved = self.solve_balances(supports)
        least, most = self.find_extremes(solved) if self.loads else (np.zeros(3), np.zeros(3))
        jaw = solved @ self.make_right_side([0, 0, 0], [0, 0, 0], [0, 0, 0], 1.0)
        places: list[tuple[str, ReadFigures, Sequence[float] | None]] = [("best", part.best, part.best.at)]
        if part.given is not None:
            places.append(("given", part.given, list(self.request.point or ())))
        for name, figures, at in places:
            if at is None or len(at) != 2:
                yield f"the {name} clamp point is missing"
                continue
            shares, arm = self.compute_shares(solved, at), measure_depth_inside(supports, *at)
            hangs = [
                self.classify_hanging_at((at[0], at[1]), slack) == 2 for slack in (-AGREEMENT, AGREEMENT)
            ]
            if figures.hangs not in hangs:
                yield f"the {name} clamp point is{' not' if figures.hangs else ''} over air, and is written otherwise"
            if self.compute_tip_room((at[0], at[1])) < -AGREEMENT or arm < self.request.inside - AGREEMENT:
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
            yield from compare_figures(name, figures, known)
        center = measure_depth_inside(supports, *compute_area_center(self.query.workpiece.loop_segments))
        if differs(part.standing, center):
            yield f"standing is {center:.9g}, and is written as {part.standing:.9g}"
        points = [point for load in self.loads for point in load.points]
        if points:
            over = max(-measure_depth_inside(supports, *point) for point in points)
            if differs(part.overhang, over):
                yield f"overhang is {over:.9g}, and is written as {part.overhang}"
        if self.compute_tip_room((part.arm_at[0], part.arm_at[1])) < -AGREEMENT or differs(
            part.arm, measure_depth_inside(supports, *part.arm_at)
        ):
            yield f"the arm is not {part.arm:.9g}"
        yield from self.find_better_places(part, supports, solved, least)

    def classify_hanging(self, part: ReadTriple) -> int:
        """Return the worse class of the tip at a triple's two clamp places, see
        :meth:`classify_hanging_at`.
        """
        places = (part.best.at or part.arm_at, part.arm_at)
        return max(self.classify_hanging_at((x, y), AGREEMENT) for x, y in places)

    def make_order_key(self, part: ReadTriple) -> tuple[int, int, int]:
        """Return the part of a triple's sort key that precedes its figures: (falls over, lacks the place
        asked for, class of the tip).
        """
        falls = int(part.standing < -AGREEMENT)
        given = self.request.point if part.given is not None else None
        late = int(self.request.point is not None and given is None)
        return (
            falls,
            late,
            self.classify_hanging(part) if given is None else self.classify_hanging_at(given, AGREEMENT),
        )

    def find_better_places(
        self, part: ReadTriple, supports: Array, solved: Array, least: Array
    ) -> Iterator[str]:
        """Yield one sentence for the first grid point inside the triangle at which the clamp is better placed
        than written.

        A place over the part is better than one over air. Among places of one class a smaller clamp force or
        a longer arm is better.
        """
        highest = self.classify_hanging(part)
        for i, j in product(range(1, GRID), repeat=2):
            if i + j >= GRID:
                continue
            x, y = np.array([i, j, GRID - i - j]) / GRID @ supports
            arm = measure_depth_inside(supports, x, y)
            if arm < self.request.inside:
                continue
            need = max(0.0, float((-least / self.compute_shares(solved, (x, y))).max()))
            cheaper = need < part.best.clamp_needed * (1 - AGREEMENT) - AGREEMENT
            farther = arm > part.arm * (1 + AGREEMENT) + AGREEMENT
            if not (cheaper or farther or highest) or self.compute_tip_room((x, y)) <= 0:
                continue
            hanging = self.classify_hanging_at((x, y), -AGREEMENT)
            if hanging < highest or (hanging == highest and (cheaper or farther)):
                yield f"the clamp is better placed at ({x:.6g}, {y:.6g})"
                return


def differs(written: float | None, own: float) -> bool:
    """Return whether a written number is missing (None), or differs from the derived one by more than
    ``AGREEMENT``.
    """
    return written is None or abs(written - own) > AGREEMENT * max(1.0, abs(own))


def compare_figures(name: str, figures: ReadFigures, known: dict[str, float]) -> Iterator[str]:
    """Yield one sentence for each written figure that differs from the derived one; ``name`` is the clamp
    point's, for messages.
    """
    for key, value in known.items():
        if differs(getattr(figures, key), value):
            yield f"{key} at the {name} point is {value:.9g}, and is written as {getattr(figures, key)}"


def compute_area_center(loops: Sequence[Sequence[Segment]]) -> tuple[float, float]:
    """Return the part's centre of area in mm, from integrals along its border
    (Gauss-Legendre along each segment).
    """
    nodes, weights = np.polynomial.legendre.leggauss(24)
    area = first = second = 0.0
    for one in (segment for loop in loops for segment in loop):
        if isinstance(one, Arc):
            low = one.mid_angle - one.sign * one.half_sweep
            sweep = 2 * one.sign * one.half_sweep
            angle = low + sweep * (nodes + 1) / 2
            x, y = one.center[0] + one.radius * np.cos(angle), one.center[1] + one.radius * np.sin(angle)
            dx, dy = -one.radius * np.sin(angle) * sweep / 2, one.radius * np.cos(angle) * sweep / 2
        else:
            (x0, y0), (x1, y1) = one.start, one.end
            x, y = x0 + (x1 - x0) * (nodes + 1) / 2, y0 + (y1 - y0) * (nodes + 1) / 2
            dx, dy = np.full(len(nodes), (x1 - x0) / 2), np.full(len(nodes), (y1 - y0) / 2)
        area += float(weights @ (x * dy))
        first += float(weights @ (x * x * dy)) / 2
        second -= float(weights @ (y * y * dx)) / 2
    return first / area, second / area


def find_band_faults(query: Query, fixture: Fixture, request: SupportRequest) -> Iterator[str]:
    """Yield one sentence for each peg whose written band of heights differs from the band of the solid's face
    it touches.

    Yields nothing if there is no solid or no band is written.
    """
    bands, numbered = request.bands, query.workpiece.numbered
    if query.workpiece.solid is None or bands is None:
        return
    for peg, written in zip(fixture.pegs, bands, strict=True):
        point = fixture.pose.inverse.apply(peg.x, peg.y)
        faces = [
            numbered.find_pressed_band(number, point)
            for number in (peg.face, peg.beside)
            if number is not None
        ]
        known = [band for band in faces if band is not None]
        own = [min(low for low, _ in known), max(high for _, high in known)] if known else []
        own = [min(height, request.thickness) for height in own]
        if len(own) != len(written or ()) or any(
            abs(a - b) > SAME_HEIGHT for a, b in zip(written or (), own, strict=True)
        ):
            has = "no band" if written is None else f"the band {written[0]:g} to {written[1]:g}"
            solids = f"{own[0]:g} to {own[1]:g}" if own else "none"
            yield f"a peg on face {peg.face} has {has}, and that of the solid is {solids}"


def verify_supports_file(path: str | Path) -> Verification:
    """Derive the planar fixture and every triple of a file of supports again.

    Raises
    ------
    InputError
        When the file cannot be read, or describes no usable part or toolkit.
    """
    path = Path(path)
    part = read_supports_part(path)
    head = check_head(part.to_head(), path)
    try:
        query, request = head.to_query(), part.to_request()
        loads = tuple(load.to_load(request.thickness) for load in part.loads)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    fixture = ToolkitRules.from_query(query).complete_fixture(read_fixtures([part.fixture], path)[0])
    planar = Judge(query).rule_on(evolve(fixture, quality={}))
    judge = SupportsJudge(query, fixture, request, loads, part.jaw_force)
    unproven, faults, seen = list[Unproven](), list[str](), set[frozenset[Hole]]()
    before = (0, 0, 0)
    if planar.verdict != "proven":
        faults.append(f"its planar fixture is {planar.verdict}: {planar.reason}")
    for place, triple in enumerate(part.triples):
        reasons = [*judge.find_faults(triple)]
        key = frozenset((str(a), b, c) for a, b, c in triple.holes)
        reasons += ["it is listed twice"] if key in seen else []
        seen.add(key)
        order = judge.make_order_key(triple) if not reasons else before
        if order < before:
            reasons.append(
                "it comes after one from which the part falls over, or with a worse place of the clamp"
            )
        before = max(before, order)
        if reasons:
            unproven.append(Unproven(place, "refuted", reasons[0]))
    faults += find_band_faults(query, fixture, request)
    counted, undecided = part.counts.triples, 0
    if counted != len(part.triples) if part.complete else (counted or inf) < len(part.triples):
        faults.append(f"counts say {counted} triples, but {len(part.triples)} are listed")
    if part.complete and planar.verdict == "proven":
        missing, undecided = find_missing_triples(judge, seen, part.counts.positions)
        faults += missing
    refuted = len(unproven)
    return Verification(
        len(part.triples) - refuted, refuted, undecided, tuple(unproven), tuple(faults), planar.bits
    )
