"""Target 3: how far the search is from a floor, the same number of closure tests on stored contacts.

The floor does for each simultaneous contact of a row what no method can do without: the four signed minors of its wrenches
and their signs. Its contacts are taken at random on the features of the part, are stored beforehand and lie in the cache;
nothing is searched, proven, sorted or written.
"""

from __future__ import annotations

from math import inf
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs import LARGE, Design, larger_rows, loaded, timed
from report import Column, Section, measured, run_alone

MOST_TIMES = 5.0
STORED = 4096
REPEATS = 5

COLUMNS = (
    Column("part", 12, right=False),
    Column("pitch", 5),
    Column("columns", 7),
    Column("contacts A", 10),
    Column("floor s", 9),
    Column("ns a test", 9),
    Column("closing", 7),
    Column("seconds", 9),
    Column("times the floor", 15),
)

Array = NDArray[np.float64]


def make_random_contacts(part: str, peg_radius: float, count: int) -> tuple[Array, Array, float]:
    """Points (count, 4, 2) about the part's centre and outward normals (count, 4, 2) of quadruples; the part's half size."""
    from workhold.contact.features import list_contact_features

    workpiece, _ = loaded(part, 4 * peg_radius, 1, peg_radius)
    features = [feature.segment for feature in list_contact_features(workpiece, peg_radius)]
    random = np.random.default_rng(1996)
    chosen = random.integers(0, len(features), 4 * count)
    places = random.uniform(-1.0, 1.0, 4 * count) * np.array([features[k].half_extent for k in chosen])
    points = np.array([features[k].compute_point(place) for k, place in zip(chosen, places, strict=True)])
    normals = np.array([features[k].compute_normal(place) for k, place in zip(chosen, places, strict=True)])
    x0, y0, x1, y1 = workpiece.bounds
    return (points - workpiece.center).reshape(-1, 4, 2), normals.reshape(-1, 4, 2), max(x1 - x0, y1 - y0) / 2


def floor_seconds(part: str, peg_radius: float, tests: int) -> dict[str, Any]:
    """Task: seconds of so many closure tests, the fastest of five runs, and the part of them that close."""
    from numba import njit

    from workhold.kernels.base.compiling import OPTIONS
    from workhold.kernels.contact.rules import write_minors

    @njit(**OPTIONS)
    def closing(points: Array, normals: Array, length: float, tests: int, out: Array) -> int:
        """How many of so many contacts close, taken in turn from those stored; ``out`` (4,) is room for minors."""
        count, k = 0, 0
        for _ in range(tests):
            write_minors(points[k], normals[k], length, out)
            positive = out[0] > 0.0 and out[1] > 0.0 and out[2] > 0.0 and out[3] > 0.0
            negative = out[0] < 0.0 and out[1] < 0.0 and out[2] < 0.0 and out[3] < 0.0
            if positive or negative:
                count += 1
            k = k + 1 if k + 1 < len(points) else 0
        return count

    points, normals, length = make_random_contacts(part, peg_radius, STORED)
    out = np.empty(4)
    closing(points, normals, length, 1, out)
    fastest, found = inf, 0
    for _ in range(REPEATS):
        start = perf_counter()
        found = closing(points, normals, length, tests, out)
        fastest = min(fastest, perf_counter() - start)
    return {"seconds": fastest, "closing": found / tests}


def floor(design: Design, tests: int) -> dict[str, Any]:
    """The floor of a design, in a process of its own."""
    # Compiled on use: the loop of tests is compiled with a kernel in it, which a library built beforehand does not offer.
    task = "floor.floor_seconds", design.part, design.peg_radius, tests
    outcome: dict[str, Any] = measured(*task, WORKHOLD_KERNELS="callable")
    return outcome


def run(quick: bool) -> Section:
    """Measure the floor and the search of the larger rows of Table 1."""
    section = Section("floor", "The search beside its floor of closure tests, one thread", COLUMNS).begin()
    ratios = []
    for design, contacts in larger_rows(quick):
        lowest, ours = floor(design, contacts), timed(design)
        ratios.append(ours["seconds"] / lowest["seconds"])
        section.row(
            *design.words,
            f"{contacts:,}",
            f"{lowest['seconds']:.5f}",
            f"{1e9 * lowest['seconds'] / contacts:.1f}",
            f"{100 * lowest['closing']:.1f} %",
            f"{ours['seconds']:.4f}",
            f"{ratios[-1]:.1f}",
        )
    words = f"within {MOST_TIMES:g} times the floor on rows with more than {LARGE:,} contacts"
    section.target(3, words, f"{max(ratios):.1f} times at most", max(ratios) <= MOST_TIMES)
    return section


if __name__ == "__main__":
    run_alone(__doc__, run)
