"""Four pegs in place on random features through them, for the tests of what decides contacts."""

from __future__ import annotations

from math import cos, hypot, pi, sin
from random import Random
from typing import Any

import numpy as np
from attrs import define

from workhold.kernels.base.tables import Lattice, Limits, Setting
from workhold.kernels.contact.record import WORK_LENGTH, write_contact_equations
from workhold.kernels.contact.rules import compute_outward_normal, write_minors

Array = np.ndarray[Any, np.dtype[np.float64]]


def limits(length: float, gap: float = -1e9, margin: float = -1e9) -> Limits:
    """Limits that leave everything but what is asked for: L, smallest gap and contact margin in mm."""
    return Limits(gap, margin, length, 99.0, 1.0, -9.0, 0.0)


def setting(length: float, gap: float = -1e9, margin: float = -1e9) -> Setting:
    """A setting with such limits, and nothing else in it."""
    return Setting(Lattice(0.0, 0.0, 0.0), limits(length, gap, margin), 0.0, 0.0, 0.0)


# A record that names four features, one for each peg.
RECORD = np.array([1.0, *range(4), *[0.0] * 14])


@define(eq=False)
class Held:
    """Four pegs in place.

    Parameters
    ----------
    rows : (4, 10) features, without ends, one for each peg.
    offsets, slides : the pegs' places from the first in mm, and which are on the moving carrier.
    unknowns : psi, tail x, tail y and separation.
    length : L in mm, half the largest distance of two pegs.
    """

    rows: Array
    offsets: list[tuple[float, float]]
    slides: list[float]
    unknowns: list[float]
    length: float

    @property
    def standing(self) -> int:
        """How many pegs are on the carrier that stands still."""
        return self.slides.count(0.0)

    def in_place(self, shift: Any = (0.0, 0.0, 0.0, 0.0)) -> tuple[Array, Array]:
        """Centres (4, 2) and arms from the first peg, with the unknowns moved by a shift in mm."""
        psi, x, y, separation = (
            v + s / (self.length if k == 0 else 1.0)
            for k, (v, s) in enumerate(zip(self.unknowns, shift, strict=True))
        )
        steps = np.array(
            [(dx + slide * separation, dy) for (dx, dy), slide in zip(self.offsets, self.slides, strict=True)]
        )
        arms = steps @ np.array([[cos(psi), sin(psi)], [-sin(psi), cos(psi)]])
        return arms + np.array([x, y]), arms

    def normals(self, points: Array) -> Array:
        """Outward unit normals (4, 2) where the pegs' centres are, on their features or beside them."""
        found = np.array(
            [compute_outward_normal(row, *point) for row, point in zip(self.rows, points, strict=True)]
        )
        return np.asarray(found / np.hypot(found[:, 0], found[:, 1])[:, None])

    def work(self) -> tuple[Array, Array]:
        """The kernels' work space and centres, with the contacts in place."""
        work, points = np.zeros((WORK_LENGTH, 4)), np.zeros((4, 2))
        work[:4] = self.unknowns, self.slides, [o[0] for o in self.offsets], [o[1] for o in self.offsets]
        write_contact_equations(RECORD, self.rows, self.length, work, points)
        return work, points

    def forces(self, points: Array, psi: float) -> tuple[Array, float, float, float]:
        """Signed minors, the sum of their sizes, the push of the standing pegs and the gap of pegs about there."""
        normals, null = self.normals(points), np.zeros(4)
        size = write_minors(points, normals, self.length, null)
        null *= 1.0 if null.sum() > 0 else -1.0
        x = np.array([cos(psi), sin(psi)])
        along = points @ x
        left = self.standing
        return (
            null,
            size,
            -float(null[:left] @ normals[:left] @ x),
            float(along[left:].min() - along[:left].max()),
        )


def held(random: Random, lines: bool | None = None, spread: float = 20.0) -> Held:
    """Four pegs about (0, 0), on lines only, on arcs only, or on both."""
    psi, x, y, separation = random.uniform(-pi, pi), 0.0, 0.0, random.uniform(0.5, 1.5) * spread
    standing = random.choice([2, 3])
    offsets = [
        (0.0, 0.0),
        *((random.uniform(-spread, spread), random.uniform(-spread, spread)) for _ in range(3)),
    ]
    slides = [float(k >= standing) for k in range(4)]
    steps = [complex(dx + slide * separation, dy) for (dx, dy), slide in zip(offsets, slides, strict=True)]
    turn = complex(cos(psi), sin(psi))
    middle = sum(steps) * turn / 4
    x, y = -middle.real, -middle.imag
    rows = []
    for step in steps:
        place, angle = complex(x, y) + step * turn, random.uniform(-pi, pi)
        normal = complex(cos(angle), sin(angle))
        if random.random() < 0.5 if lines is None else lines:
            tangent = normal * 1j
            start = place + tangent * random.uniform(-5, 5)
            rows.append(
                [0.0, start.real, start.imag, tangent.real, tangent.imag, 1e3, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]
            )
        else:
            radius, sign = 10 ** random.uniform(0, 1.8), random.choice([1.0, -1.0])
            center = place - sign * radius * normal
            way = sign * normal
            rows.append(
                [1.0, center.real, center.imag, way.real, way.imag, pi, radius, sign, 0.0, 0.0, 0.0, 0.0]
            )
    length = max(hypot((a - b).real, (a - b).imag) for a in steps for b in steps) / 2
    return Held(np.array(rows), offsets, slides, [psi, x, y, separation], length)
