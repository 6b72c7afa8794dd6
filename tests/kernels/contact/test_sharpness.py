"""The constants by which contacts break a rule wherever they may be are needed: a tenth of each drops some that keep it."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from math import cos, inf, pi, sin
from random import Random
from typing import Any

import numpy as np
import pytest

from contact_examples import held, limits
from rounding import Rounded, error_of
from sharpness import Constant, changed, check_sharpness, interpreted
from workhold.contact.curves import EVERYWHERE
from workhold.conventions import GAP_SLACK
from workhold.kernels.base.tables import Features
from workhold.kernels.contact import rules
from workhold.kernels.curves import moving_pegs
from workhold.search.toolkit_search import ANY_ERROR

Array = np.ndarray[Any, np.dtype[np.float64]]
Kernel = Callable[..., Any]

OFF = 1e-6
QUARTER = np.array([[0.0, 1.0], [-1.0, 0.0]])
FREE = {"LEAST_SPAN": -9.0, "LEAST_CLOSURE": -9.0, "LEAST_CLAMPING": -9.0}


def minors_off(turned: bool) -> Callable[[Random, Kernel], float]:
    """Change of the minors when normals turn, or when points move, over the band told."""

    def ratio(random: Random, kernel: Kernel) -> float:
        length, null, again = 30.0, np.zeros(4), np.zeros(4)
        # Places up to the corner of a square box, normals square to the rays or anyhow, mostly near one line.
        places = [random.uniform(-pi, pi) for _ in range(4)]
        points = 1.41 * length * np.array([(cos(p), sin(p)) for p in places])
        spread, square = random.choice([0.02, 0.3, 3.0]), random.choice([0.0, pi / 2])
        angles = [
            random.choice([p + square, places[0] + square]) + random.uniform(-spread, spread) for p in places
        ]
        worst = 0.0
        rules.write_minors(points, np.array([(cos(a), sin(a)) for a in angles]), length, null)
        for signs in product((-1.0, 1.0), repeat=4):
            normals = np.array([(cos(a), sin(a)) for a in angles])
            there = points.copy()
            if turned:
                tilted = [a + s * OFF for a, s in zip(angles, signs, strict=True)]
                normals = np.array([(cos(a), sin(a)) for a in tilted])
            else:
                there += OFF * np.array(signs)[:, None] * np.stack([-normals[:, 1], normals[:, 0]], axis=1)
            rules.write_minors(there, normals, length, again)
            worst = max(worst, np.abs(null - again).max())
        return worst / float(kernel(OFF if turned else 0.0, 0.0 if turned else OFF, length))

    return ratio


def minors_rounded(random: Random, kernel: Kernel) -> float:
    """Rounding of a minor of four wrenches, counted by machine, over what is told for it."""
    length = random.uniform(5, 50)
    points = [[Rounded(length * random.uniform(-1, 1)) for _ in range(2)] for _ in range(4)]
    angles = [random.uniform(-pi, pi) for _ in range(4)]
    out: list[Any] = [0.0] * 4
    ROUNDED_MINORS(Rows(points), Rows([[Rounded(cos(a)), Rounded(sin(a))] for a in angles]), length, out)
    return max(map(error_of, out)) / float(kernel(0.0, 0.0, length))


class Rows(list):  # type: ignore[type-arg]
    """Rows of numbers of any kind, read as a kernel reads an array."""

    def __getitem__(self, place: Any) -> Any:
        return list.__getitem__(self, place[0])[place[1]]


ROUNDED_MINORS = changed(rules.write_minors, cross=interpreted(rules.cross))


def needed(keeps: Callable[[float], bool]) -> float:
    """The least radius, in parts of ``OFF``, with which contacts that are off by ``OFF`` are kept."""
    if not keeps(OFF):
        return inf
    low, high = 0.0, OFF
    for _ in range(12):
        middle = (low + high) / 2
        low, high = (low, middle) if keeps(middle) else (middle, high)
    return high / OFF


def at_the_edge(rule: str) -> Callable[[Random, Callable[..., Kernel]], float]:
    """Contacts exactly on the edge of a rule, moved by ``OFF``, orientation included, so that they seem to break it: the
    least radius that must be told for them to be kept."""

    def ratio(random: Random, form: Kernel) -> float:
        contacts = held(random, True)
        psi = contacts.unknowns[0]
        points, _ = contacts.in_place()
        null, size, push, gap = contacts.forces(points, psi)
        edges = {"gap": gap, "clamp": push / size}
        if not (edges[rule] > 1e-3 and null.min() > 1e-3) or (rule == "clamp" and edges[rule] > 0.02):
            return 0.0
        names = {**FREE, "LEAST_CLAMPING": edges["clamp"] * (1 - 1e-9)} if rule == "clamp" else FREE
        least = gap + GAP_SLACK - 1e-12 if rule == "gap" else -1e9
        asked = limits(contacts.length, least, 0.0)
        features = Features(contacts.rows, contacts.rows, (0, 4), (0, 4), ANY_ERROR, EVERYWHERE)
        kernel = changed(form, **names)
        worst = 0.0
        for _ in range(8):
            turn = psi + (random.choice([-1, 0, 1]) * OFF / contacts.length if rule == "gap" else 0.0)
            # Along the lines, where moments change, or along the jaws' motion.
            ways = contacts.normals(points) @ QUARTER if rule == "clamp" else [(cos(psi), sin(psi))] * 4
            angles = [np.arctan2(y, x) + random.choice([0.0, pi]) for x, y in ways]
            there = points + OFF * np.array([(cos(a), sin(a)) for a in angles])

            def keeps(radius: float, there: Array = there, turn: float = turn) -> bool:
                pegs = np.column_stack([there, range(4), np.zeros((4, 2)), np.full(4, radius)])
                reach = abs(turn - psi) * radius / OFF
                work, out = np.zeros((8, 2)), np.zeros(4)
                verdict, _ = kernel(
                    pegs,
                    float(contacts.standing),
                    (turn, cos(turn), sin(turn)),
                    reach,
                    features,
                    asked,
                    work,
                    out,
                )
                return bool(verdict == 2)

            worst = max(worst, needed(keeps))
        return worst

    return ratio


def past_the_end(random: Random, kernel: Kernel) -> float:
    """A contact at the end of an arc, moved along it by ``OFF`` of a few degrees: the radius that must be told."""
    radius = 10 ** random.uniform(-1, 2)
    off = radius * random.uniform(0.01, 0.7)
    half = random.uniform(0.3, 2.0)
    angle = half + random.choice([1.0, random.uniform(0, 1)]) * 2 * np.arcsin(off / 2 / radius)
    row = np.array([1.0, 0.0, 0.0, 1.0, 0.0, half, radius, 1.0, 0.0, 0.0, 0.0, 0.0])
    place = radius * cos(angle), radius * sin(angle)

    def keeps(part: float) -> bool:
        return bool(kernel(row, *place, 0.0, off * part / OFF))

    return needed(keeps)


def row_met(lines: bool) -> Callable[[Random, Kernel], float]:
    """Where a row meets a feature when its height is off by an error, over how far it may be as told."""

    def ratio(random: Random, kernel: Kernel) -> float:
        radius, error = 10 ** random.uniform(0, 2), 10 ** random.uniform(-9, -2)
        tilt = random.uniform(-pi, pi)
        if lines:
            row = np.array([0.0, 0.0, 0.0, cos(tilt), sin(tilt), 50.0, 0.0, 1.0, 0.0, 0.0])
            height = random.uniform(-20, 20)
        else:
            row = np.array([1.0, 0.0, 0.0, 1.0, 0.0, pi, radius, 1.0, 0.0, 0.0])
            height = random.choice([-1, 1]) * radius * (1 - 10 ** random.uniform(-8, -0.1))
        ax, ay, side = 0.0, 1.0, random.choice([1.0, -1.0])
        meets, x, y, off = kernel(row, ax, ay, height, error, side)
        worst = 0.0
        for part in (-1, -0.5, 0.5, 1):
            one, px, py, _ = moving_pegs.intersect_at_height(row, ax, ay, height + part * error, 0.0, side)
            if one and not meets:
                return inf
            if one and meets:
                worst = max(worst, np.hypot(px - x, py - y) / off)
        return float(worst)

    return ratio


CONSTANTS = [
    Constant("minor, 20 swing", rules.bound_minor_error, minors_off(True), 20.0, draws=400),
    Constant("minor, 4 away / L", rules.bound_minor_error, minors_off(False), 4.0, draws=400),
    Constant("minor, rounding", rules.bound_minor_error, minors_rounded, symbol="ROUNDING"),
    Constant("contact past the end, 1.2", rules.is_within, past_the_end, 1.2),
    Constant("gap, 2 radii", rules.is_fixture, at_the_edge("gap"), 2.0, 0, draws=60),
    Constant("clamping, 3 bands", rules.is_fixture, at_the_edge("clamp"), 3.0, 0, draws=1500),
    Constant("row and line, 1.1", moving_pegs.intersect_at_height, row_met(True), 1.1, draws=600),
    Constant("row and arc, 2.2 R", moving_pegs.intersect_at_height, row_met(False), 2.2, draws=600),
    Constant("row and arc, 1.3", moving_pegs.intersect_at_height, row_met(False), 1.3, draws=600),
    Constant("row and arc, 16 R", moving_pegs.intersect_at_height, row_met(False), 16.0, draws=600),
    Constant("row and arc, 2 roots", moving_pegs.intersect_at_height, row_met(False), 2.0, draws=600),
]


@pytest.mark.parametrize("constant", CONSTANTS, ids=lambda constant: constant.name)
@pytest.mark.prove
def test_a_tenth_of_a_constant_would_not_do(constant: Constant) -> None:
    """What keeps a rule is kept, and with a tenth of the constant it is not."""
    check_sharpness(constant)
