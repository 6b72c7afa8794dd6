"""A certificate's radius holds the exact solution, and no other is within the distance told."""

from __future__ import annotations

from math import cos, pi, sin
from random import Random

import numpy as np
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

from exact_chords import exact_solution, exactly
from holdfast.listing.certificate import ROUNDINGS, Certificate, certificate, coordinates
from holdfast.listing.polish import Contacts, contacts_at, polish
from strategies import seeds

LENGTH = 30.0
Places = tuple[np.ndarray, np.ndarray]


def planted(random: Random, tilt: float) -> tuple[Contacts, Places]:
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
            rows.append([0.0, middle.real, middle.imag, tangent.real, tangent.imag, 20.0, 0.0, 1.0])
        else:
            radius = 10.0 ** random.uniform(0, 2)
            center = place + radius * normal
            rows.append([1.0, center.real, center.imag, 1.0, 0.0, pi, radius, 1.0])
    places = np.array([offsets]), np.array([slides])
    start = (np.array([psi]), np.array([[x, y]]), np.array([apart]))
    return polish(np.array([rows]), *start, *places, LENGTH), places


def certified(contacts: Contacts) -> Certificate:
    """The certificate for equations computed in double precision."""
    return certificate(contacts, LENGTH, ROUNDINGS * coordinates(contacts))


def away(contacts: Contacts, places: Places, start: list[float]) -> float:
    """Largest difference in mm of an unknown from the exact solution that Newton's method finds from a start, or inf."""
    with exactly():
        z = exact_solution(contacts.rows[0].tolist(), places[0][0].tolist(), places[1][0].tolist(), start)
        if z is None:
            return float("inf")
        off = [LENGTH * (z[0] - float(contacts.psi[0]))]
        off += [v - float(w) for v, w in zip(z[1:], (*contacts.tail[0], contacts.apart[0]), strict=True)]
        return max(float(abs(v).upper()) for v in map(arb, off))


def start_at(contacts: Contacts, shift: list[float]) -> list[float]:
    """The unknowns moved by a shift in mm."""
    numbers = [float(contacts.psi[0]), *map(float, contacts.tail[0]), float(contacts.apart[0])]
    return [n + (s / LENGTH if k == 0 else s) for k, (n, s) in enumerate(zip(numbers, shift, strict=True))]


@given(seeds, st.floats(0.0, 6.0).map(lambda exponent: 10.0**-exponent))
def test_the_exact_solution_is_within_the_radius(seed: int, tilt: float) -> None:
    """Where there is a certificate, Newton's method at 200 bits ends within the radius told; near singular ones too."""
    random = Random(seed)
    for _ in range(10):
        contacts, places = planted(random, tilt)
        told = certified(contacts)
        if np.isfinite(told.radius[0]):
            assert away(contacts, places, start_at(contacts, [0.0] * 4)) <= told.radius[0]


@given(seeds)
def test_ordinary_contacts_have_a_small_certificate(seed: int) -> None:
    """The certificate is of use: most contacts in general position are known to 1e-11 mm."""
    random = Random(seed)
    radii = np.array([certified(planted(random, 1.0)[0]).radius[0] for _ in range(40)])
    assert (radii < 1e-11).mean() > 0.75


@given(seeds, st.floats(0.0, 4.0).map(lambda exponent: 10.0**-exponent))
def test_no_other_solution_is_within_the_distance_told(seed: int, tilt: float) -> None:
    """Newton's method started anywhere within ``unique`` finds the same solution, or leaves."""
    random = Random(seed)
    for _ in range(5):
        contacts, places = planted(random, tilt)
        told = certified(contacts)
        unique = float(told.unique[0])
        if unique == 0.0:
            continue
        for _ in range(4):
            off = away(contacts, places, start_at(contacts, [random.uniform(-unique, unique) for _ in range(4)]))
            assert off <= told.radius[0] or off > unique


@given(seeds)
def test_a_start_moved_off_the_solution_has_a_radius_that_reaches_it(seed: int) -> None:
    """The radius follows from the values of the equations: contacts moved aside by some micrometres reach back."""
    random = Random(seed)
    for _ in range(10):
        contacts, places = planted(random, 1.0)
        psi, x, y, apart = start_at(contacts, [random.uniform(-1e-4, 1e-4) for _ in range(4)])
        moved = contacts_at(contacts.rows, np.array([psi]), np.array([[x, y]]), np.array([apart]), *places, LENGTH)
        told = certified(moved)
        if np.isfinite(told.radius[0]):
            assert 0.0 < away(moved, places, [psi, x, y, apart]) <= told.radius[0]


def test_concurrent_lines_of_action_have_no_certificate() -> None:
    """Where all four meet in one point the part may turn: the equations are singular."""
    random = Random(5)
    for _ in range(50):
        assert not np.isfinite(certified(planted(random, 0.0)[0]).radius[0])
