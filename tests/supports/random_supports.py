"""Random fixtures of all kinds of toolkits with random demands on their supports; a seed says which."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, sin
from random import Random

from workhold import Fence, Fixture, FlatJaw, OpeningVise, Plate, Query, Vise, Workpiece, circle_zone, design
from workhold.fixels.toolkit import Toolkit
from workhold.model.support_request import SpatialLoad, SupportRequest

__all__ = ["random_demand", "random_fixtures"]

TOOLKITS: tuple[Toolkit, ...] = (
    Vise(pitch=15, columns=4, peg_radius=3),
    Vise(pitch=12, columns=5, peg_radius=2, rows=7, max_opening=50, row_offset=4, blocked=("L-C2", "R-A")),
    OpeningVise(pitch=12, columns=6, peg_radius=2, min_gap=8),
    Plate(pitch=15, peg_radius=3, columns=6, rows=5),
    Plate(pitch=15, peg_radius=3, travel=(10, 40), columns=8, rows=8),
    Plate(pitch=18, peg_radius=3, clamps=2),
    Fence(pitch=15, wall_offset=8, peg_radius=3),
    Fence(pitch=15, wall_offset=8, peg_radius=3, clamps=2),
    FlatJaw(pitch=15, peg_radius=3, max_opening=40),
)


def convex_part(random: Random) -> Workpiece:
    """A polygon with its corners on an ellipse."""
    count, wide, high = random.randrange(3, 7), random.uniform(26, 52), random.uniform(22, 40)
    turns = sorted((k + random.uniform(-0.3, 0.3)) * 2 * pi / count for k in range(count))
    corners = [(round(wide * cos(turn), 2), round(high * sin(turn), 2), 0.0) for turn in turns]
    return Workpiece.from_loops("part", [corners])


def random_fixtures(seed: int, of_each: int = 5) -> Iterator[tuple[Random, Query, Fixture]]:
    """A few fixtures of a random part in each toolkit."""
    random = Random(seed)
    for toolkit in TOOLKITS:
        result = design(convex_part(random), toolkit, best=40)
        for place in sorted(random.sample(range(len(result)), min(of_each, len(result)))):
            yield random, result.query, result[place]


def random_demand(
    random: Random, workpiece: Workpiece, has_loads: bool = True
) -> tuple[SupportRequest, tuple[SpatialLoad, ...]]:
    """What is asked of supports, and up to two loads in a direction each."""
    x0, y0, x1, y1 = workpiece.bounds

    def place() -> tuple[float, float]:
        return random.uniform(x0, x1), random.uniform(y0, y1)

    low = random.uniform(0, 6)
    request = SupportRequest(
        random.uniform(10, 20),
        random.uniform(1, 4),
        random.uniform(2, 4),
        band=None if random.random() < 0.3 else (low, low + random.choice((0.0, 4.0))),
        pad_margin=random.choice((0.0, 1.5)),
        inside=random.uniform(1, 4),
        bottom_zones=[circle_zone(*place(), 5)] if random.random() < 0.3 else (),
        top_zones=[circle_zone(*place(), 9)] if random.random() < 0.5 else (),
        point=place() if random.random() < 0.3 else None,
    )
    loads = []
    for _ in range(random.randrange(0, 3) if has_loads else 0):
        turn, height = random.uniform(0, 350), random.uniform(0, 10)
        loads.append(
            SpatialLoad(
                points=[place() for _ in range(random.randrange(1, 3))],
                force=random.choice((0.0, 80.0)),
                directions=(turn, turn + random.choice((0.0, 90.0))),
                heights=(height, height + random.choice((0.0, 5.0))),
                axial=(random.uniform(-30, 0), random.uniform(1, 300)),
                moment=random.choice((0.0, 900.0)),
                tilt=(random.uniform(-200, 200), 100.0),
            )
        )
    return request, tuple(loads)
