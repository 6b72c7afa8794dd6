"""Parts, pegs and fixtures of which the seats are known, and ways to look at them that share nothing with the program."""

from __future__ import annotations

import json
from functools import cache
from math import atan2, cos, hypot, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from workhold import Fixture, Peg, Pose, Vise, Workpiece, load
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Line
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import CONFIG, PAIR, PEG, PIECE
from workhold.model.seating import Seating
from workhold.seating.closing import ClosingMotion
from workhold.seating.equilibria import Equilibria, find_equilibria
from workhold.seating.solver import SeatingSolver
from workhold.seating.two_contact_curves import TwoContactCurves

Array = NDArray[np.float64]
SAMPLED = json.loads((Path(__file__).parent / "data" / "seating" / "sampled.json").read_text())["cases"]
LEFT, RIGHT = "left", "right"
# Two parallel faces, and two corners in which a peg has room: pairs, triples, slides and pockets.
STEP = Workpiece.from_loops(
    "step", [[[0, 0, 0], [50, 0, 0], [50, 20, 0], [28, 20, 0], [28, 44, 0], [0, 36, 0]]]
)


def held(
    pegs: list[tuple[str, float, float]], pose: tuple[float, float, float], separation: float
) -> Fixture:
    """A fixture of which only what seating needs is told."""
    placed = tuple(Peg(carrier, 0, 0, x, y, 0, 0.0) for carrier, x, y in pegs)
    return Fixture("I", placed, Pose(*pose), separation, {})


def case_fixture(case: dict[str, Any]) -> tuple[Workpiece, Vise, Fixture]:
    """The part, vise and fixture of a sampled case."""
    part = load("widget") if case["loops"] is None else Workpiece.from_loops(case["part"], case["loops"])
    pegs = [(peg["jaw"], peg["x"], peg["y"]) for peg in case["pegs"]]
    pose = tuple(case["pose"][k] for k in ("theta_deg", "x", "y"))
    return part, Vise(**case["vise"]), held(pegs, pose, case["jaw_separation"])


@cache
def solved(number: int) -> tuple[SeatingSolver, Fixture, Seating]:
    """A sampled case, solved once for all tests."""
    part, vise, fixture = case_fixture(SAMPLED[number])
    solver = SeatingSolver(part, vise)
    return solver, fixture, solver.solve(fixture)


def moved(fixture: Fixture, order: list[int], half_turn: bool, shift: tuple[float, float]) -> Fixture:
    """The same fixture with its pegs named otherwise, turned by half a turn, or moved."""
    sign = -1.0 if half_turn else 1.0
    pegs = []
    for k in order:
        peg = fixture.pegs[k]
        carrier = peg.carrier if not half_turn else (LEFT if peg.carrier == RIGHT else RIGHT)
        pegs.append(Peg(carrier, 0, 0, sign * peg.x + shift[0], sign * peg.y + shift[1], 0, 0.0))
    pose = Pose(
        fixture.pose.theta_deg + (180.0 if half_turn else 0.0),
        sign * fixture.pose.x + shift[0],
        sign * fixture.pose.y + shift[1],
    )
    # The pegs at separation 0 stand where they stood: the separation stays as it is told.
    return Fixture("I", tuple(pegs), pose, fixture.travel, {})


def equilibria_of(closing: ClosingMotion) -> Equilibria:
    """Where the pegs of a closing hold the part."""
    return find_equilibria(closing.boundary, closing.pattern, closing.size)


def two_contacts_of(closing: ClosingMotion) -> TwoContactCurves:
    """Where two contacts of a closing hold the part, each about a single angle."""
    return TwoContactCurves.from_pattern(closing.boundary, closing.pattern)


class Obstacle:
    """A part and pegs whose clearances and their slopes are told from the outline by elementary geometry."""

    def __init__(self, part: Workpiece, fixture: Fixture, radius: float) -> None:
        self.faces = [face.segment for face in part.faces]
        self.radii, self.center = np.full(len(fixture.pegs), radius), np.array(part.center)
        self.right = np.array([float(peg.carrier == RIGHT) for peg in fixture.pegs])
        # Which way each peg moves as S grows, and whether a smaller S clamps.
        self.ways, self.clamping, self.has_wall = np.outer(self.right, [1.0, 0.0]), 1, False
        self.pegs = np.array([[peg.x, peg.y] for peg in fixture.pegs]) - self.ways * fixture.travel

    @classmethod
    def about(cls, part: Workpiece, fixture: Fixture, toolkit: Toolkit) -> Obstacle:
        """The same in any toolkit: S is the travel, along whichever way that goes."""
        out = cls(part, fixture, 0.0)
        pegs = [peg for peg in fixture.pegs if not peg.is_on_wall]
        out.has_wall = len(pegs) < len(fixture.pegs)
        carriers = [toolkit.find_carrier(peg.carrier) for peg in pegs]
        out.radii = np.array([carrier.peg_radius for carrier in carriers])
        out.ways = np.array([carrier.travel.unit if carrier.travel else (0.0, 0.0) for carrier in carriers])
        out.pegs = np.array([[peg.x, peg.y] for peg in pegs]) - out.ways * fixture.travel
        out.clamping = toolkit.clamping
        return out

    def start(self, fixture: Fixture) -> Array:
        """theta, x and y of the middle of the part's box, and S."""
        x, y = fixture.pose.apply(*self.center)
        return np.array([np.radians(fixture.pose.theta_deg), x, y, fixture.travel])

    def near(self, config: Array, reach: float) -> list[tuple[float, Array]]:
        """Clearances below a reach, with their slopes over theta, x, y and S."""
        theta, x, y, s = config
        c, d = cos(theta), sin(theta)
        out = []
        for radius, (wx, wy), (px, py) in zip(self.radii, self.ways, self.pegs, strict=True):
            qx, qy = px + wx * s - x, py + wy * s - y
            at = np.array([c * qx + d * qy, c * qy - d * qx])
            for face in self.faces:
                for touch in touched(face, at + self.center):
                    away = at + self.center - touch
                    size = hypot(*away)
                    if size - radius < reach:
                        n = away / max(size, 1e-12)
                        vx, vy = c * n[0] - d * n[1], d * n[0] + c * n[1]
                        slope = np.array([n[0] * at[1] - n[1] * at[0], -vx, -vy, vx * wx + vy * wy])
                        out.append((size - radius, slope))
        return out + [(d, g) for d, g in self.above_wall(config) if d < reach]

    def above_wall(self, config: Array) -> list[tuple[float, Array]]:
        """Heights above a fence at y = 0 of the part's corners and of the lowest points of its arcs, with their slopes."""
        out = []
        for face in self.faces if self.has_wall else ():
            lowest = -pi / 2 - config[0]
            low = (
                []
                if isinstance(face, Line)
                else touched(face, face.center + np.array([cos(lowest), sin(lowest)]))
            )
            # A whole circle, a hole, has no corner and never is the lowest.
            for x, y in [np.array(face.compute_point(-face.half_extent)), *low] - self.center:
                up = sin(config[0]) * x + cos(config[0]) * y
                out.append(
                    (config[2] + up, np.array([cos(config[0]) * x - sin(config[0]) * y, 0.0, 1.0, 0.0]))
                )
        return out

    def free(self, config: Array) -> float:
        """The least clearance."""
        return min(d for d, _ in self.near(config, np.inf))


def touched(face: Any, point: Array) -> list[Array]:
    """The nearest point of a face, inside its ends or at one."""
    if isinstance(face, Line):
        t = min(max(face.find_parameter(tuple(point)), -face.half_extent), face.half_extent)
        return [np.array(face.compute_point(t))]
    angle = atan2(point[1] - face.center[1], point[0] - face.center[0]) - face.mid_angle
    angle = (angle + pi) % (2 * pi) - pi
    if abs(angle) <= face.half_sweep:
        return [np.array(face.compute_point(angle))]
    return [np.array(face.compute_point(face.half_sweep if angle > 0 else -face.half_sweep))]


def closed(obstacle: Obstacle, config: Array, size: float, stop: float) -> Array:
    """Where closing, or opening, ends by small linear programs of scipy: each step lowers S most within a box."""
    from scipy.optimize import linprog

    trust, sign = 0.05, obstacle.clamping
    scale = np.array([1.0 / size, 1.0, 1.0, 1.0])
    for _ in range(600):
        near = obstacle.near(config, 8.0 * trust)
        slopes = np.array([g * scale for _, g in near]).reshape(-1, 4)
        room = np.array([max(d, 0.0) for d, _ in near])
        told = linprog(
            [0, 0, 0, sign],
            -slopes if len(near) else None,
            room if len(near) else None,
            bounds=[(-trust, trust)] * 4,
        )
        step = told.x * scale
        gain = -sign * told.x[3]
        after = config + step
        # Out again of what was entered to second order.
        for _ in range(80):
            entered = obstacle.near(after, -1e-12)
            if not entered:
                break
            for d, g in entered:
                after = after - g * scale**2 * (d - 1e-12) / ((g * scale) @ (g * scale))
        if gain > 1e-9 and sign * after[3] < sign * config[3] - 0.1 * gain and obstacle.free(after) > -1e-7:
            config, trust = after, min(2.0 * trust, 0.4)
        else:
            trust *= 0.3
            if trust < 1e-6 or sign * config[3] < sign * stop + 1e-6:
                return config
    return config


def cells_by_pair(holdings: TwoContactCurves, right: int) -> tuple[Array, Array]:
    """The cells of one jaw's holdings and their middles, heights from its own first peg."""
    known, before, _ = holdings.jaws[right]
    cells = np.array(known.cells)
    cells[:, PAIR] += before
    return cells, known.middles


def on_pieces(row, given, config):
    """The pieces of a candidate's three contacts, each with where its peg is in a configuration, seen from its middle or
    centre."""
    theta, x, y, s = config
    for k in range(3):
        peg, piece = int(row[PEG + k]), given.rows[int(row[PIECE + k])]
        qx, qy = given.pegs[peg, 0] + given.right[peg] * s - x, given.pegs[peg, 1] - y
        yield (
            piece,
            cos(theta) * qx + sin(theta) * qy - piece[X],
            cos(theta) * qy - sin(theta) * qx - piece[Y],
        )


def touching(row, given, config):
    """How far the three pegs of a candidate are from the lines and circles of their pieces in a configuration."""
    return np.array(
        [
            dx * piece[AXIS_Y] - dy * piece[AXIS_X]
            if piece[IS_ARC] == 0.0
            else piece[SIGN] * (hypot(dx, dy) - piece[RADIUS])
            for piece, dx, dy in on_pieces(row, given, config)
        ]
    )


def at_angle(row, given, theta):
    """The separation at which the three pegs touch, the part turned a little farther."""
    found = root(lambda u: touching(row, given, (theta, *u)), row[CONFIG][1:], tol=1e-13)
    assert np.abs(found.fun).max() < 1e-10
    return found.x[2]
