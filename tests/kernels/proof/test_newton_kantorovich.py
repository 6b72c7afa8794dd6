"""A certificate's radius holds the exact solution, and no other is within the distance told."""

from __future__ import annotations

from math import cos, pi, sin
from random import Random

import numpy as np
import pytest
from attrs import define
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

from exact_chords import exact_solution, exactly
from strategies import seeds
from workhold.kernels.contact.record import UNKNOWNS, WORK_LENGTH, write_contact_equations
from workhold.kernels.proof import newton_kantorovich as kernel

LENGTH = 30.0


@define(eq=False)
class Planted:
    """Four pegs in place on features through them.

    Parameters
    ----------
    features : (4, 10) rows, one for each peg.
    offsets, slides : the pegs' places from the first, and which move with the right jaw.
    work, points : the kernel's work space, see ``kernels.contact.record``.
    """

    features: np.ndarray
    offsets: list[tuple[float, float]]
    slides: list[float]
    work: np.ndarray
    points: np.ndarray

    @property
    def record(self) -> np.ndarray:
        """A record that names the features."""
        return np.array([1.0, *range(4), *[0.0] * 14])

    def unknowns(self) -> list[float]:
        """psi, tail x, tail y and apart."""
        return [float(v) for v in self.work[UNKNOWNS]]


def planted(random: Random, tilt: float) -> Planted:
    """Four pegs in place on random features through them, polished; lines of action turned by ``tilt`` from meeting in one
    point, where the equations are singular."""
    psi, x, y = random.uniform(-pi, pi), random.uniform(-20, 20), random.uniform(-20, 20)
    lefts, apart = random.choice([2, 3]), random.uniform(15, 50)
    offsets = [(0.0, 0.0), *((random.uniform(-15, 15), random.uniform(-30, 30)) for _ in range(3))]
    slides = [float(k >= lefts) for k in range(4)]
    meeting = complex(random.uniform(-20, 20), random.uniform(-20, 20))
    rows = []
    for (dx, dy), slide in zip(offsets, slides, strict=True):
        place = complex(x, y) + complex(dx + slide * apart, dy) * complex(cos(psi), sin(psi))
        normal = (meeting - place) / abs(meeting - place) * np.exp(1j * random.uniform(-tilt, tilt))
        if random.random() < 0.5:
            tangent = normal * 1j
            middle = place + tangent * random.uniform(-5, 5)
            rows.append(
                [
                    0.0,
                    middle.real,
                    middle.imag,
                    tangent.real,
                    tangent.imag,
                    20.0,
                    0.0,
                    1.0,
                    0.0,
                    0.0,
                    0.0,
                    0.0,
                ]
            )
        else:
            radius = 10.0 ** random.uniform(0, 2)
            center = place + radius * normal
            rows.append([1.0, center.real, center.imag, 1.0, 0.0, pi, radius, 1.0, 0.0, 0.0, 0.0, 0.0])
    work = np.zeros((WORK_LENGTH, 4))
    work[:4] = [psi, x, y, apart], slides, [o[0] for o in offsets], [o[1] for o in offsets]
    contacts = Planted(np.array(rows), offsets, slides, work, np.zeros((4, 2)))
    kernel.polish_unknowns(contacts.record, contacts.features, LENGTH, work, contacts.points)
    return contacts


def certified(contacts: Planted) -> tuple[float, float]:
    """Radius and distance told of the contacts in place."""
    size, smallest = kernel.measure_sizes(contacts.record, contacts.features, contacts.points)
    return kernel.certify_contacts(contacts.work, size, smallest, LENGTH, 0.0)


def away(contacts: Planted, start: list[float]) -> float:
    """Largest difference in mm of an unknown from the exact solution that Newton's method finds from a start, or inf."""
    with exactly():
        z = exact_solution(contacts.features[:, :10].tolist(), contacts.offsets, contacts.slides, start)
        if z is None:
            return float("inf")
        off = [
            (v - w) * (LENGTH if k == 0 else 1)
            for k, (v, w) in enumerate(zip(z, contacts.unknowns(), strict=True))
        ]
        return max(float(abs(v).upper()) for v in map(arb, off))


def start_at(contacts: Planted, shift: list[float]) -> list[float]:
    """The unknowns moved by a shift in mm."""
    return [
        n + (s / LENGTH if k == 0 else s)
        for k, (n, s) in enumerate(zip(contacts.unknowns(), shift, strict=True))
    ]


@pytest.mark.thorough
@given(seeds, st.floats(0.0, 6.0).map(lambda exponent: 10.0**-exponent))
def test_the_exact_solution_is_within_the_radius(seed: int, tilt: float) -> None:
    """Where there is a certificate, Newton's method at 200 bits ends within the radius told; near singular ones too."""
    random = Random(seed)
    for _ in range(10):
        contacts = planted(random, tilt)
        radius, _ = certified(contacts)
        if np.isfinite(radius):
            assert away(contacts, start_at(contacts, [0.0] * 4)) <= radius


@pytest.mark.thorough
@given(seeds)
def test_ordinary_contacts_have_a_small_certificate(seed: int) -> None:
    """The certificate is of use: most contacts in general position are known to 1e-11 mm."""
    random = Random(seed)
    radii = np.array([certified(planted(random, 1.0))[0] for _ in range(40)])
    assert (radii < 1e-11).mean() > 0.75


@pytest.mark.thorough
@given(seeds, st.floats(0.0, 4.0).map(lambda exponent: 10.0**-exponent))
def test_no_other_solution_is_within_the_distance_told(seed: int, tilt: float) -> None:
    """Newton's method started anywhere within ``unique`` finds the same solution, or leaves."""
    random = Random(seed)
    for _ in range(5):
        contacts = planted(random, tilt)
        radius, unique = certified(contacts)
        if unique == 0.0:
            continue
        for _ in range(4):
            off = away(contacts, start_at(contacts, [random.uniform(-unique, unique) for _ in range(4)]))
            assert off <= radius or off > unique


@pytest.mark.thorough
@given(seeds)
def test_a_start_moved_off_the_solution_has_a_radius_that_reaches_it(seed: int) -> None:
    """The radius follows from the values of the equations: contacts moved aside by some micrometres reach back, which
    a radius without the Newton step would not."""
    random = Random(seed)
    for _ in range(10):
        contacts = planted(random, 1.0)
        moved = start_at(contacts, [random.uniform(-1e-4, 1e-4) for _ in range(4)])
        contacts.work[UNKNOWNS] = moved
        write_contact_equations(contacts.record, contacts.features, LENGTH, contacts.work, contacts.points)
        radius, _ = certified(contacts)
        if np.isfinite(radius):
            assert 0.0 < away(contacts, moved) <= radius


def test_concurrent_lines_of_action_have_no_certificate() -> None:
    """Where all four meet in one point the part may turn: the equations are singular."""
    random = Random(5)
    for _ in range(50):
        assert not np.isfinite(certified(planted(random, 0.0))[0])
