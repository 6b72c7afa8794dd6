"""Hypothesis strategies shared by the tests: random workpieces and vises.

An outline is drawn star-shaped about (0, 0): corners at sorted angles and random radii, bulged edges between them. Edges
whose bulge makes the outline meet itself are straightened one after the other, so that nearly every draw is a part; what
is refused even then is rejected. Shape comes from a seed, so that every example is as rich as any other; the number of
sides, arcs and holes come from hypothesis, so that examples shrink to simple parts.
"""

from __future__ import annotations

from math import cos, pi, sin, tau
from random import Random

from hypothesis import assume
from hypothesis import strategies as st

from workhold import Vise, Workpiece
from workhold.errors import InputError

__all__ = ["outlines", "random_outline", "random_row", "seeds", "vises"]

Loop = list[list[float]]

seeds = st.integers(0, 2**32 - 1)


def accepted(*loops: Loop) -> Workpiece | None:
    """The workpiece of some loops, or None when they are refused."""
    try:
        return Workpiece.from_loops("random part", loops)
    except InputError:
        return None


def straightened(loop: Loop) -> Workpiece | None:
    """A workpiece of one loop, with arcs made lines from the last on until it is accepted."""
    loop = [list(vertex) for vertex in loop]
    part = accepted(loop)
    for vertex in reversed(loop):
        if part is None and vertex[2] != 0.0:
            vertex[2] = 0.0
            part = accepted(loop)
    return part


def star(random: Random, count: int, arcs: bool) -> Loop:
    """A counter-clockwise loop of (x, y, bulge) about (0, 0), corners 10 to 60 mm from it."""
    shares = [random.uniform(0.45, 1.0) for _ in range(count)]
    angle, total, loop = random.uniform(0.0, tau), sum(shares), []
    for share in shares:
        radius = random.uniform(10.0, 60.0)
        bulge = round(random.uniform(-0.7, 1.2), 3) if arcs and random.random() < 0.5 else 0.0
        loop.append([round(radius * cos(angle), 3), round(radius * sin(angle), 3), bulge])
        angle += tau * share / total
    return loop


def hole_about_middle(random: Random, arcs: bool) -> Loop:
    """A round or polygonal hole about a point near (0, 0), run either way."""
    x, y, radius = (
        round(random.uniform(-3, 3), 3),
        round(random.uniform(-3, 3), 3),
        round(random.uniform(1.0, 9.0), 3),
    )
    way = random.choice([1.0, -1.0])
    if arcs and random.random() < 0.5:
        return [[x - radius, y, way], [x + radius, y, way]]
    count, turn = random.randint(3, 5), random.uniform(0.0, tau)
    angles = [turn + way * tau * k / count for k in range(count)]
    bulge = way * random.choice([0.0, 0.3, -0.2]) if arcs else 0.0
    return [[round(x + radius * cos(a), 3), round(y + radius * sin(a), 3), bulge] for a in angles]


def outline(random: Random, count: int, curved: bool, pierced: bool, arcs: bool = True) -> Workpiece | None:
    """A workpiece of ``count`` sides, with arcs if ``curved``, with a hole if ``pierced`` and it fits; seldom None."""
    part = straightened(star(random, count, curved))
    if part is not None and pierced:
        part = accepted(part.loops[0].tolist(), hole_about_middle(random, arcs)) or part
    return part


def random_outline(random: Random, count: int) -> Workpiece:
    """A random workpiece of ``count`` sides, two thirds with arcs, a third with a hole."""
    while True:
        part = outline(random, count, random.random() < 0.67, random.random() < 0.33)
        if part is not None:
            return part


@st.composite
def outlines(
    draw: st.DrawFn, min_faces: int = 3, max_faces: int = 8, arcs: bool = True, holes: bool = True
) -> Workpiece:
    """Random workpieces of about 20 to 120 mm across.

    Parameters
    ----------
    min_faces, max_faces : sides of the outer loop.
    arcs : whether sides may be arcs, convex and concave.
    holes : whether there may be a hole (it is left out where it does not fit).
    """
    count = draw(st.integers(min_faces, max_faces))
    curved, pierced = arcs and draw(st.booleans()), holes and draw(st.booleans())
    part = outline(Random(draw(seeds)), count, curved, pierced, arcs)
    assume(part is not None)
    assert part is not None
    return part


@st.composite
def vises(draw: st.DrawFn, max_columns: int = 3) -> Vise:
    """Random vises of pitch 8 to 20 mm, up to three columns, pegs of radius 0 to 3 mm."""
    lengths = st.floats(8.0, 20.0).map(lambda x: round(x, 3))
    return Vise(
        pitch=draw(st.one_of(lengths, st.tuples(lengths, lengths))),
        columns=draw(st.integers(1, max_columns)),
        peg_radius=draw(st.one_of(st.just(0.0), st.floats(0.0, 3.0).map(lambda x: round(x, 3)))),
        row_offset=draw(st.sampled_from([0.0, 4.0, 1.7])),
    )


def random_row(random: Random, kind: str) -> tuple[float, ...]:
    """A random feature row (see ``make_segment_rows``) within some 20 mm of (0, 0); ``kind`` is line, arc or circle."""
    x, y, angle = random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-pi, pi)
    if kind == "line":
        return (0.0, x, y, cos(angle), sin(angle), random.uniform(2.0, 25.0), 0.0, 1.0, 0.0, 0.0)
    half = pi if kind == "circle" else random.uniform(0.3, 3.1)
    radius, sign = random.uniform(1.0, 20.0), random.choice([1.0, -1.0])
    return (1.0, x, y, cos(angle), sin(angle), half, radius, sign, 0.0, 0.0)
