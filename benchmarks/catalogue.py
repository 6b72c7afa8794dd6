"""A catalogue of parts as a shop's, of any length: the twenty of ``shop_parts`` and further ones of five families.

Nobody's parts are in it: families and sizes are made up by a seed.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import count, islice

from shop_parts import PARTS, Loop, chamfered, circle, lever, rectangle, slot
from workhold.model.workpiece import Workpiece

__all__ = ["catalogue"]

SEED = 1996


def catalogue(length: int) -> list[Workpiece]:
    """So many parts, the same ones each time."""
    return list(
        islice((*(one.make() for one in PARTS), *islice(further(), max(length - len(PARTS), 0))), length)
    )


def further() -> Iterator[Workpiece]:
    """Parts without end: plates with rounded corners and a bore, chamfered ones, levers, wedges, plates with a slot."""
    chance = random.Random(SEED)
    for number in count(1):
        a, b = chance.uniform(30, 110), chance.uniform(25, 80)
        families: tuple[list[Loop], ...] = (
            [rectangle(a, b, chance.uniform(2, 8)), circle(0, 0, chance.uniform(8, 20))],
            [chamfered(a, b, chance.uniform(3, 10))],
            [lever(a, chance.uniform(12, 20), chance.uniform(6, 11))],
            [
                [
                    (0, 0, 0),
                    (a, 0, 0),
                    (a * chance.uniform(0.6, 0.9), b, 0),
                    (a * 0.2, b * chance.uniform(0.7, 1), 0),
                ]
            ],
            [rectangle(a, b), slot(0, 0, a * 0.3, 8)],
        )
        yield Workpiece.from_loops(f"part-{number}", families[number % len(families)])
