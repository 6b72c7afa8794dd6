"""Programs of all kinds about a part, and a slow walk along them: how near each tool comes to each fixture.

The walk looks at points of every move, a fiftieth of a millimetre apart, and knows nothing of swept pieces.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from math import ceil, cos, hypot, inf, radians, sin
from random import Random
from typing import Any

import numpy as np
from numpy.typing import NDArray

from workhold import Fence, FlatJaw, OpeningVise, Plate, Vise
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.moves import Moves
from workhold.model.program import Cylinder, Program, Tool
from workhold.model.workpiece import Workpiece

Array = NDArray[np.float64]
Row = tuple[Any, ...]

STEP = 0.02
# The walk passes within half a step of everything; heights end pieces within a step.
OFF = 0.02
END_MILL, FACE_MILL, DRILL = 1, 2, 3
TOOLS = {
    END_MILL: Tool(END_MILL, [Cylinder(0, 12, 3), Cylinder(12, 30, 5), Cylinder(30, 60, 20)], 6),
    FACE_MILL: Tool(FACE_MILL, [Cylinder(0, 8, 16), Cylinder(8, 50, 8)], 32),
    DRILL: Tool(DRILL, [Cylinder(0, 40, 2), Cylinder(40, 70, 10)], 4),
}
# Of the part, and of the pegs.
THICKNESS, PEG_HEIGHT = 12.0, 9.0


def program_of(rows: list[Row], clearance: float = 1.0, rapid: str = "straight") -> Program:
    """A program from rows of tool, cutting, start, end and bulge; each is a line of its own."""
    moves = [(3 + k, *row, 0.0, 0.0) for k, row in enumerate(rows)]
    return Program(
        "made.nc",
        "0" * 64,
        "mm",
        (0.0, 0.0),
        0.0,
        clearance=clearance,
        rapid=rapid,  # type: ignore[arg-type]
        tools=TOOLS,
        moves=Moves.from_rows(moves),
    )


def path(tool: int, points: list[tuple[float, float, float]], bulges: list[float] | None = None) -> list[Row]:
    """Cutting moves through points, with rapid ones down to the first and up from the last."""
    first, last, high = points[0], points[-1], THICKNESS + 3.0
    rows: list[Row] = [(tool, False, (first[0], first[1], high), first, 0.0)]
    for k, (a, b) in enumerate(pairwise(points)):
        rows.append((tool, True, a, b, 0.0 if bulges is None else bulges[k]))
    return [*rows, (tool, False, last, (last[0], last[1], high), 0.0)]


def box_of(part: Workpiece) -> tuple[float, float, float, float]:
    """The box around a part's joints."""
    x, y = part.loops[0][:, 0], part.loops[0][:, 1]
    return float(x.min()), float(y.min()), float(x.max()), float(y.max())


def contour(random: Random, part: Workpiece) -> list[Row]:
    """Along two sides of the part's box, with an arc around the corner."""
    x0, y0, x1, y1 = box_of(part)
    off, z = random.uniform(1.0, 4.0), random.uniform(1.0, 8.0)
    turn = 0.41421356237309503
    points = [(x0, y0 - off, z), (x1, y0 - off, z), (x1 + off, y0, z), (x1 + off, (y0 + y1) / 2, z)]
    return path(END_MILL, points, [0.0, turn, 0.0])


def pocket(random: Random, part: Workpiece) -> list[Row]:
    """Passes to and fro within the part's box, perhaps open to one side."""
    x0, y0, x1, y1 = box_of(part)
    z, wide = random.uniform(2.0, 9.5), x1 - x0
    low, high = y0 + random.uniform(-6.0, 8.0), (y0 + y1) / 2
    points = []
    for k in range(4):
        y = low + (high - low) * k / 3
        ends = [(x0 + wide * 0.3, y, z), (x0 + wide * 0.6, y, z)]
        points += ends if k % 2 else ends[::-1]
    return path(END_MILL, points)


def facing(random: Random, part: Workpiece) -> list[Row]:
    """A broad cutter over the upper side, which hangs over; sometimes lower than the pegs at one end."""
    x0, y0, x1, y1 = box_of(part)
    z, y = random.choice([THICKNESS - 0.5, PEG_HEIGHT - 1.0]), y0 + random.uniform(0.1, 0.9) * (y1 - y0)
    return path(FACE_MILL, [(x0 - 4.0, y, z), ((x0 + x1) / 2, y, z)])


def drilling(random: Random, part: Workpiece) -> list[Row]:
    """Some holes, through or blind."""
    x0, y0, x1, y1 = box_of(part)
    rows: list[Row] = []
    for _ in range(3):
        x, y = random.uniform(x0 - 3, x1 + 3), random.uniform(y0 - 3, y1 + 3)
        depth = random.choice([-2.0, 6.0])
        rows += path(DRILL, [(x, y, THICKNESS + 1.0), (x, y, depth)])
    return rows


def helix(random: Random, part: Workpiece) -> list[Row]:
    """A helix from above the pegs down among them."""
    x0, y0, x1, y1 = box_of(part)
    x, y = random.uniform(x0, x1), random.uniform(y0, y1)
    r, z, points, bulges = random.uniform(2.0, 8.0), THICKNESS + 1.0, [], []
    for k in range(9):
        side = 1 if k % 2 else -1
        points.append((x + side * r, y, z - 1.6 * k))
        bulges.append(1.0)
    return path(END_MILL, points, bulges)


def ramp(random: Random, part: Workpiece) -> list[Row]:
    """A slope across the part's border, from above the pegs to below their upper ends."""
    x0, y0, x1, y1 = box_of(part)
    y = random.uniform(y0, y1)
    return path(
        END_MILL, [(x0 - 12.0, y, THICKNESS + 1.0), ((x0 + x1) / 2, y + 6.0, random.uniform(2.0, 8.0))]
    )


WORK: dict[str, Callable[[Random, Workpiece], list[Row]]] = {
    "contour": contour,
    "pocket": pocket,
    "facing": facing,
    "drilling": drilling,
    "helix": helix,
    "ramp": ramp,
}


def random_program(random: Random, part: Workpiece, clearance: float = 1.0) -> Program:
    """A program of one kind of work, or of two."""
    kinds = random.sample(sorted(WORK), random.choice([1, 1, 2]))
    rows = [row for kind in kinds for row in WORK[kind](random, part)]
    return program_of(rows, clearance)


def walked(program: Program) -> tuple[Array, NDArray[np.int64]]:
    """Points x, y, z (W, 3) of the tip on all moves, and the numbers (W,) of the moves."""
    moves, points, numbers = program.moves, [], []
    for k in range(len(moves)):
        start, end, bulge = moves.start[k], moves.end[k], float(moves.bulge[k])
        flat, rise = hypot(*(end - start)[:2]), abs(end[2] - start[2])
        half = 2 * np.arctan(abs(bulge))
        radius = flat / (2 * np.sin(half)) if bulge else 0.0
        long = hypot(2 * half * radius if bulge else flat, rise)
        count = max(ceil(long / STEP), 1)
        share = np.linspace(0.0, 1.0, count + 1)[:, None]
        if bulge:
            # A point of a circle from the tangents of a quarter of the sweep, as any book on them has it.
            chord = (end - start)[:2]
            left = np.array([-chord[1], chord[0]])
            center = start[:2] + chord / 2 + left * (1 - bulge * bulge) / (4 * bulge)
            turn = 4 * np.arctan(bulge) * share
            arm = start[:2] - center
            plane = center + np.hstack(
                [np.cos(turn) * arm[0] - np.sin(turn) * arm[1], np.sin(turn) * arm[0] + np.cos(turn) * arm[1]]
            )
        else:
            plane = start[:2] + share * (end - start)[:2]
        points.append(np.hstack([plane, start[2] + share * rise * np.sign(end[2] - start[2])]))
        numbers += [k] * (count + 1)
    return np.concatenate(points), np.array(numbers)


def low_points(program: Program, peg_height: float) -> list[tuple[Array, float]]:
    """The points (V, 2) at which each cylinder of each tool is no higher than pegs, with its radius."""
    points, numbers = walked(program)
    out = []
    for tool in np.unique(program.moves.tool).tolist():
        mine = points[program.moves.tool[numbers] == tool]
        for cylinder in TOOLS[tool].cylinders:
            there = mine[mine[:, 2] + cylinder.low <= peg_height]
            if len(there):
                out.append((there[:, :2], cylinder.radius))
    return out


def slow_clearance(fixture: Fixture, toolkit: Toolkit, low: list[tuple[Array, float]]) -> float:
    """The least distance less radius that a walk meets, over all that holds the part; mm."""
    angle, (x, y) = radians(fixture.pose.theta_deg), (fixture.pose.x, fixture.pose.y)
    carriers = {carrier.name: carrier for carrier in toolkit.carriers}
    least = inf
    for points, radius in low:
        u = cos(angle) * points[:, 0] - sin(angle) * points[:, 1] + x
        v = sin(angle) * points[:, 0] + cos(angle) * points[:, 1] + y
        for peg in fixture.pegs:
            carrier = carriers[peg.carrier]
            if carrier.is_wall:
                least = min(least, float(np.maximum(v, 0.0).min()) - radius)
                continue
            from_x, from_y = peg.x, peg.y
            if carrier.on is not None and carrier.travel is not None and carrier.travel.most is not None:
                from_x, from_y = carrier.compute_hole_center(peg.column, peg.row)
            dx, dy = from_x - peg.x, from_y - peg.y
            long = dx * dx + dy * dy
            share = ((u - peg.x) * dx + (v - peg.y) * dy) / long if long else np.zeros(len(u))
            share = np.clip(share, 0.0, 1.0)
            away = np.hypot(u - peg.x - share * dx, v - peg.y - share * dy).min()
            least = min(least, float(away) - radius - carrier.peg_radius)
    return least


def kinds_of_toolkit(pitch: float) -> dict[str, Toolkit]:
    """A toolkit of each kind, with one thing that moves or two, and with bodies behind tips or without."""
    plate = {"pitch": pitch, "peg_radius": 3.0, "columns": 6, "rows": 6, "clamp_radius": 4.0}
    small = plate | {"columns": 4, "rows": 4}
    fence = {"pitch": pitch, "peg_radius": 3.0, "wall_offset": 6.0, "clamp_radius": 4.0}
    return {
        "vise": Vise(pitch, 2, 3.0),
        "gripper": Vise(pitch, 1, 2.0),
        "opening": OpeningVise(pitch=pitch, columns=2, peg_radius=2.0, min_gap=5.0),
        "plate": Plate(**small, directions=["-x", "+y"]),
        "bolted": Plate(**plate, directions=["-x"], travel=(6.0, 30.0)),
        "pair": Plate(**small, directions=[("-x", "-y")], clamps=2),
        "bolted pair": Plate(**plate, directions=[("-x", "-y")], clamps=2, travel=(4.0, 30.0)),
        "fence": Fence(**fence),
        "bolted fence": Fence(**fence, travel=(6.0, 30.0)),
        "fence pair": Fence(**fence, clamps=2, travel=(4.0, 30.0), columns=8, rows=8),
        "flat": FlatJaw(pitch=pitch, columns=2, peg_radius=3.0),
    }
