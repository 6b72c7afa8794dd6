"""The constants of the certificate and of interval Newton are needed: a tenth of each proves too much, or loses contacts."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from math import cos, inf, isfinite, sin
from random import Random
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from contact_examples import RECORD, Held, held, setting
from exact_chords import exact_solution, exactly
from rounding import ROUNDED, error_of
from sharpness import Constant, changed, check_sharpness
from workhold.conventions import GAP_SLACK
from workhold.kernels.contact.record import INVERSE, OFF, SLOPES, UNKNOWNS, write_contact_equations
from workhold.kernels.proof import newton_kantorovich as kantorovich
from workhold.kernels.proof import variation
from workhold.kernels.proof.newton_kantorovich import OPEN

Array = np.ndarray[Any, np.dtype[np.float64]]
Kernel = Callable[..., Any]

SIGNS = np.array(list(product((-1.0, 1.0), repeat=4)))


def second_derivative(contacts: Held, shift: Array) -> float:
    """Largest |u' F'' v| of a contact equation over all u and v with entries up to 1, the unknowns moved by a shift."""
    points, arms = contacts.in_place(shift)
    psi, length, worst = contacts.unknowns[0] + shift[0] / contacts.length, contacts.length, 0.0
    for row, slide, point, arm in zip(contacts.rows, contacts.slides, points, arms, strict=True):
        x, y = np.array([cos(psi), sin(psi)]), np.array([-sin(psi), cos(psi)])
        speeds = np.array([[-arm[1] / length, arm[0] / length], [1, 0], [0, 1], slide * x])
        curved = np.zeros((4, 4, 2))
        curved[0, 0], curved[0, 3] = -arm / length**2, slide * y / length
        curved[3, 0] = curved[0, 3]
        if row[0] == 0.0:
            hessian = curved @ np.array([row[4], -row[3]])
        else:
            size = np.hypot(*(point - row[1:3]))
            normal = (point - row[1:3]) / size
            along = speeds @ np.array([-normal[1], normal[0]])
            hessian = curved @ normal + np.outer(along, along) / size
        worst = max(worst, np.abs(SIGNS @ hessian @ SIGNS.T).max())
    return float(worst)


def second_derivative_told(lines: bool) -> Callable[[Random, Kernel], float]:
    """The same over the bound that follows from how far a certificate holds, anywhere as far as that."""

    def ratio(random: Random, kernel: Kernel) -> float:
        contacts = held(random, lines)
        work, points = contacts.work()
        work[OFF] = 0.0
        size, smallest = kantorovich.measure_sizes(RECORD, contacts.rows, points)
        _, unique = kernel(work, size, smallest, contacts.length, 0.0)
        if not 0.0 < unique < smallest / 16.0 * 0.999:
            return 0.0
        told = 0.99 / (unique * norm(work))
        worst = 0.0
        for part in (0.0, 1.0, 1.0, 1.0):
            shift = part * unique * np.array([random.choice([-1, 0, 1]) for _ in range(4)])
            worst = max(worst, second_derivative(contacts, shift))
        return worst / told

    return ratio


def norm(work: Array) -> float:
    """Largest absolute row sum of the inverse in a work space."""
    return float(np.abs(work[INVERSE : INVERSE + 4]).sum(axis=1).max())


def from_aside(random: Random, kernel: Kernel) -> float:
    """How far the exact solution is from unknowns beside it, over the radius told."""
    contacts = held(random)
    work, points = contacts.work()
    start = work[UNKNOWNS].copy()
    move = np.array([random.uniform(-1, 1) for _ in range(4)]) * 10 ** random.uniform(-6, -1)
    work[UNKNOWNS] += move / [contacts.length, 1, 1, 1]
    write_contact_equations(RECORD, contacts.rows, contacts.length, work, points)
    radius, _ = kernel(work, *kantorovich.measure_sizes(RECORD, contacts.rows, points), contacts.length, 0.0)
    if not isfinite(radius):
        return 0.0
    with exactly():
        solution = exact_solution(
            contacts.rows[:, :10].tolist(), contacts.offsets, contacts.slides, start.tolist()
        )
        assert solution is not None
        away = [float(abs(v - float(w)).upper()) for v, w in zip(solution, work[UNKNOWNS], strict=True)]
    return max(away[0] * contacts.length, *away[1:]) / float(radius)


class Rows:
    """A work space of numbers of any kind."""

    def __init__(self, values: Any) -> None:
        self.rows = [list(map(float, row)) for row in values]

    def __getitem__(self, place: Any) -> Any:
        return self.rows[place[0]][place[1]]

    def __setitem__(self, place: Any, value: Any) -> None:
        self.rows[place[0]][place[1]] = value


ROUNDED_TOUCH = changed(write_contact_equations, **ROUNDED)


def jacobian_rounded(random: Random, kernel: Kernel) -> float:
    """Largest rounding of a row of the Jacobian, counted by machine, over what a certificate allows for in I - A J, where
    lines are touched."""
    contacts = held(random, True)
    work, points = contacts.work()
    rows, centers = Rows(work), Rows(points)
    ROUNDED_TOUCH([int(v) for v in RECORD], contacts.rows.tolist(), contacts.length, rows, centers)
    off = max(sum(error_of(rows[SLOPES + k, j]) for j in range(4)) for k in range(4))
    # With an inverse of 1 what is told to be the only solution's reach falls by as much as I - A J may be off; it is
    # looked at with a thousandfold rounding.
    work[OFF], sizes = 0.0, kantorovich.measure_sizes(RECORD, contacts.rows, points)
    work[SLOPES : SLOPES + 4] = work[INVERSE : INVERSE + 4] = np.eye(4)
    exact, less = (
        changed(kernel, ROUNDINGS=scale * kantorovich.ROUNDINGS, invert=lambda _: 1.0)(
            work, *sizes, contacts.length, 0.0
        )
        for scale in (0.0, 1e3)
    )
    return 1e3 * off / float(1.0 - less[1] / exact[1])


def far_from_an_arc(random: Random, kernel: Kernel) -> float:
    """Largest second derivative of a contact equation as far away as a solution may be told to be the only one, over its
    bound: all of the way counts where the arc is small."""
    contacts = held(random, False)
    work, points = contacts.work()
    work[OFF] = 0.0
    _, smallest = kantorovich.measure_sizes(RECORD, contacts.rows, points)
    # An inverse so small that the arc alone limits how far that is.
    work[INVERSE : INVERSE + 4], work[SLOPES : SLOPES + 4] = 1e-3 * np.eye(4), 1e3 * np.eye(4)
    _, unique = changed(kernel, invert=lambda _: 1.0)(work, 0.0, smallest, contacts.length, 0.0)
    told = 2.0 * 4.42**2 / smallest + 4.0 / contacts.length
    shifts = (0.999 * unique * np.array([random.choice([-1, 1]) for _ in range(4)]) for _ in range(4))
    return max(second_derivative(contacts, shift) for shift in shifts) / told


def equations_rounded(contacts: Held) -> float:
    """Largest rounding in mm of a contact equation's value, counted by machine."""
    work, points = contacts.work()
    rows, centers = Rows(work), Rows(points)
    ROUNDED_TOUCH([int(v) for v in RECORD], contacts.rows.tolist(), contacts.length, rows, centers)
    return max(error_of(rows[OFF, k]) for k in range(4))


def rounding_certified(random: Random, kernel: Kernel) -> float:
    """The same over what the radius of a certificate allows for, where the equations' values are 0."""
    contacts = held(random)
    work, points = contacts.work()
    work[OFF] = 0.0
    radius, _ = kernel(work, *kantorovich.measure_sizes(RECORD, contacts.rows, points), contacts.length, 0.0)
    return 1.01 * equations_rounded(contacts) * norm(work) / float(radius) if isfinite(radius) else 0.0


def boxed(random: Random, about: bool) -> tuple[Held, Array, Array]:
    """Contacts with a frame and half widths of a part of their box; ``about``, the part turns about one of the pegs, whose
    place then varies in second order only."""
    contacts = held(random)
    frame = np.zeros((2, 4, 4))
    frame[0] = np.eye(4)
    columns = np.array([[random.gauss(0, 1) for _ in range(4)] for _ in range(4)])
    widths = [10 ** random.uniform(-6, -1) for _ in range(4)]
    if about:
        _, arms = contacts.in_place()
        arm = arms[random.randrange(1, 4)] / contacts.length
        columns[:, 0] = 1.0, arm[1], -arm[0], 0.0
        widths = [10 ** random.uniform(-3, 0.5), 1e-9, 1e-9, 1e-9]
    frame[1] = np.linalg.qr(columns)[0]
    return contacts, frame, np.array([np.zeros(4), widths])


def varies(column: int, about: bool = False) -> Callable[[Random, Kernel], float]:
    """How much a number of the pegs varies to the corners of a part of a box, over how much it may as told."""

    def ratio(random: Random, kernel: Kernel) -> float:
        contacts, frame, place = boxed(random, about)
        work, points = contacts.work()
        pairs, told = np.zeros((3, 4, 2)), np.zeros((variation.NUMBERS, 4))
        pairs[0] = points
        size, _ = kantorovich.measure_sizes(RECORD, contacts.rows, points)
        kernel(RECORD, contacts.rows, size, setting(contacts.length), place, frame, work, pairs, told)
        here = numbers(contacts, np.zeros(4))[column]
        worst = 0.0
        for signs in SIGNS[::3]:
            off = numbers(contacts, frame[1] @ (signs * place[1]))[column] - here
            size_off = np.abs(off) if off.ndim == 1 else np.hypot(off[:, 0], off[:, 1])
            known = told[column] > 0.0
            worst = max(worst, (size_off[known] / told[column][known]).max(initial=0.0))
        return float(worst)

    return ratio


def numbers(contacts: Held, shift: Array) -> dict[int, Array]:
    """What varies over a part: centres, normals, arms, moments and pushes."""
    points, arms = contacts.in_place(shift)
    normals = contacts.normals(points)
    psi = contacts.unknowns[0] + shift[0] / contacts.length
    moments = (arms[:, 0] * normals[:, 1] - arms[:, 1] * normals[:, 0]) / contacts.length
    return {
        variation.VARIATION: points,
        variation.TILT: normals,
        variation.ARM_BAND: arms,
        variation.MOMENT_BAND: moments,
        variation.FORCE_BAND: normals @ np.array([cos(psi), sin(psi)]),
    }


VARYING = [
    variation.VARIATION,
    variation.TILT,
    variation.ARM_BAND,
    variation.MOMENT_BAND,
    variation.FORCE_BAND,
]


@pytest.mark.thorough
@pytest.mark.thinned(5)
@pytest.mark.parametrize("about", [False, True])
@pytest.mark.parametrize("column", VARYING)
def test_what_varies_over_a_part_of_a_box_is_bounded_to_its_second_order(column: int, about: bool) -> None:
    """Centres, normals, arms, moments and pushes at the corners of a part are within their variations, also where the first
    order is 0 because the part turns about a peg; and the bounds are no more than ten times as wide as needed."""
    random, ratio = Random(7), varies(column, about)
    worst = max(ratio(random, variation.write_variation) for _ in range(200))
    assert 0.1 < worst <= 1.0 + 1e-6


def equation_error(random: Random, kernel: Kernel) -> float:
    """Rounding of a contact equation, counted by machine, over what a part of a box allows for."""
    contacts = held(random)
    work, points = contacts.work()
    pairs, told = np.zeros((3, 4, 2)), np.zeros((variation.NUMBERS, 4))
    pairs[0] = points
    kernel(
        RECORD,
        contacts.rows,
        0.0,
        setting(contacts.length),
        np.zeros((2, 4)),
        np.zeros((2, 4, 4)),
        work,
        pairs,
        told,
    )
    rows, centers = Rows(work), Rows(points)
    ROUNDED_TOUCH([int(v) for v in RECORD], contacts.rows.tolist(), contacts.length, rows, centers)
    return max(error_of(rows[OFF, k]) / told[variation.ERROR, k] for k in range(4))


def judged_from_aside(rule: str, lines: bool) -> Callable[[Random, Kernel], float]:
    """Contacts exactly on the edge of a rule, looked at from unknowns that are off by so many mm: they must not be judged
    while it is told, and least of it that leaves them open is the ratio."""

    def ratio(random: Random, kernel: Kernel) -> float:
        contacts = held(random, lines)
        psi, off = contacts.unknowns[0], 1e-6
        points, _ = contacts.in_place()
        _, size, _, gap = contacts.forces(points, psi)
        others = {"LEAST_SPAN": -9.0, "LEAST_CLOSURE": -9.0, "LEAST_CLAMPING": -9.0}
        asked = setting(contacts.length)
        if rule == "gap":
            asked = setting(contacts.length, gap=gap + GAP_SLACK)
        elif rule == "end":
            peg = random.randrange(4)
            row = contacts.rows[peg]
            row[5] = 1.0 if lines else 0.8
            row[1:5] = ended(row, points[peg], random.choice([1.0, -1.0]))
            asked = setting(contacts.length, margin=0.0)
        elif rule == "span":
            others["LEAST_SPAN"] = size
        else:
            others["LEAST_CLOSURE"] = float(contacts.forces(points, psi)[0].min()) / size
            if not others["LEAST_CLOSURE"] > 0.0:
                return 0.0
        judge = changed(kernel, **others)
        smallest = float(np.where(contacts.rows[:, 0] == 0.0, inf, contacts.rows[:, 6]).min())
        worst = 0.0
        for _ in range(16):
            shift = off * np.array([random.choice([-1, 1]) for _ in range(4)]) / [contacts.length, 1, 1, 1]
            moved = evolve(contacts, unknowns=[v + s for v, s in zip(contacts.unknowns, shift, strict=True)])
            work, there = moved.work()
            pairs = np.zeros((3, 4, 2))
            pairs[0] = there

            def is_open(part: float, moved: Held = moved, work: Array = work, pairs: Array = pairs) -> bool:
                return bool(judge(RECORD, moved.rows, asked, off * part, smallest, work, pairs) == OPEN)

            if not is_open(1.0):
                return inf
            low, high = 0.0, 1.0
            for _ in range(10):
                middle = (low + high) / 2
                low, high = (low, middle) if is_open(middle) else (middle, high)
            worst = max(worst, high)
        return worst

    return ratio


def ended(row: Array, point: Array, side: float) -> list[float]:
    """Middle and tangent (or centre and middle direction) of a feature moved along itself so that it ends at a point."""
    if row[0] == 0.0:
        return [*(point - side * row[5] * row[3:5]), *row[3:5]]
    ray = complex(*(point - row[1:3])) / abs(complex(*(point - row[1:3])))
    way = ray * complex(cos(side * row[5]), -sin(side * row[5]))
    return [*row[1:3], way.real, way.imag]


CONSTANTS = [
    Constant("certificate, 2 v² / R", kantorovich.certify_contacts, second_derivative_told(False), 2.0, 0),
    Constant("certificate, v = 4.42", kantorovich.certify_contacts, second_derivative_told(False), 4.42),
    Constant("certificate, 4 / L", kantorovich.certify_contacts, second_derivative_told(True), 4.0, 0),
    Constant("certificate, radius", kantorovich.certify_contacts, from_aside, 1.01),
    Constant(
        "contact equation, 16 half units",
        kantorovich.certify_contacts,
        rounding_certified,
        symbol="ROUNDINGS",
    ),
    Constant("contact equation in a box", variation.write_variation, equation_error, symbol="HALF_UNIT"),
    Constant("judged, end 1.2", kantorovich.judge_contacts, judged_from_aside("end", True), 1.2, draws=20),
    Constant("judged, gap 1.5", kantorovich.judge_contacts, judged_from_aside("gap", True), 1.5, 0, draws=20),
    Constant("judged, reach 4.5", kantorovich.judge_contacts, judged_from_aside("end", True), 4.5, draws=20),
    Constant("certificate, R / 16", kantorovich.certify_contacts, far_from_an_arc, 16.0),
    Constant(
        "judged, closure 1.1 bands",
        kantorovich.judge_contacts,
        judged_from_aside("closure", True),
        1.1,
        draws=200,
    ),
    Constant(
        "judged, span 4 bands", kantorovich.judge_contacts, judged_from_aside("span", True), 4.0, 0, draws=20
    ),
]


@pytest.mark.thorough
def test_the_rounding_of_a_jacobian_is_allowed_for() -> None:
    """What a certificate adds to I - A J holds the roundings of a row, and is no more than twenty times as much."""
    random = Random(9)
    assert 0.05 < max(jacobian_rounded(random, kantorovich.certify_contacts) for _ in range(60)) <= 1.0


@pytest.mark.parametrize("constant", CONSTANTS, ids=lambda constant: constant.name)
@pytest.mark.prove
def test_a_tenth_of_a_constant_would_not_do(constant: Constant) -> None:
    """The bound holds on every input, and with a tenth of the constant it does not."""
    check_sharpness(constant)
