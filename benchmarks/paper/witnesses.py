"""What shows that a claim does not hold: counted, drawn, and written as result files that ``workhold verify`` accepts."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import sampling
import workhold
from designs import PEG_RADIUS
from paper.sketches import card
from workhold.contact.problem import Problem
from workhold.drawing.bench import make_outline_path
from workhold.drawing.scene import BLACK, Box, Scene, View

__all__ = [
    "bar",
    "clamp_counts",
    "found_by_naive_roots",
    "missing",
    "sliding_fixture",
    "small_result",
    "what_sampling_misses",
]

# Degrees on either side of a fixture that a small result file about it covers.
AROUND = 0.05
# What counts as a real root: distance of |exp(i psi)| from one, for roots computed in doubles.
TOLERANCES = (1e-12, 1e-10, 1e-8, 1e-6, 1e-4)
# The part of which four contacts with force closure can be slid apart: a bar with a cross bar, pegs in a vise's holes.
BAR = [[0, -30, 0], [4, -30, 0], [4, -7, 0], [60, -7, 0], [60, 7, 0], [4, 7, 0], [4, 30, 0], [0, 30, 0]]


def small_result(result: Any, fixture: Any) -> tuple[str, int]:
    """The text of a complete result of the orientations about one fixture, and the fixture's number in it."""
    theta = fixture.pose.theta_deg
    angles = [((theta - AROUND), (theta + AROUND))]
    few = workhold.design(
        result.workpiece, result.toolkit, restrictions=workhold.Restrictions(angles=angles), threads=1
    )
    with TemporaryDirectory() as folder:
        path = Path(folder) / "result.json"
        workhold.save(few, path)
        text = path.read_text(encoding="utf-8")
    wanted = [(peg.carrier, peg.column, peg.row, peg.face) for peg in fixture.pegs]
    numbers = [
        number
        for number, one in enumerate(few, 1)
        if [(peg.carrier, peg.column, peg.row, peg.face) for peg in one.pegs] == wanted
        and abs(one.pose.theta_deg - theta) < 1e-6
    ]
    return text, numbers[0]


def clamp_counts(part: Any, pitch: float, gap: float) -> tuple[dict[str, int], Any, Any]:
    """How many fixtures of a translating clamp along -x a vise can hold; the result, and one that none can.

    In a vise every right peg stands the gap or more to the right of every left peg, whatever the columns.
    """
    plate = workhold.Plate(pitch=pitch, peg_radius=PEG_RADIUS, directions=["-x"])
    result = workhold.design(part, plate, threads=1)
    room = [fixture.pegs[-1].x - max(peg.x for peg in fixture.pegs[:-1]) for fixture in result]
    span = [max(p.column for p in f.pegs[:-1]) - min(p.column for p in f.pegs[:-1]) for f in result]
    held = [one >= gap - 1e-9 for one in room]
    counts = {"clamp": len(room), "held": sum(held), "none": len(room) - sum(held)}
    counts |= {
        f"columns_{c}": sum(h and s < c for h, s in zip(held, span, strict=True)) for c in (1, 2, 3, 4)
    }
    # The first that is refused by more than rounding.
    lost = next((f for f, one in zip(result, room, strict=True) if one < 0.0), None)
    return counts, result, lost


def naive_roots(tolerance: float) -> Callable[..., Any]:
    """In place of the algebra's search for orientations: roots in doubles, real if they are within a tolerance."""
    from workhold.algebra.resultants import compute_resultant_coefficients

    def orientations(contacts: Any, case: Any, sectors: Any) -> tuple[Any, Any, Any]:
        """Indices of systems and orientations; none is undecided."""
        owners, found = [np.zeros(0, np.int64)], [np.zeros(0, np.complex128)]
        for k, row in enumerate(compute_resultant_coefficients(contacts, case)[0]):
            if np.abs(row).max() > 0.0:
                roots = np.roots(row[::-1])
                real = roots[np.abs(np.abs(roots) - 1.0) <= tolerance]
                owners.append(np.full(len(real), k))
                found.append(real)
        owner, root = np.concatenate(owners), np.concatenate(found)
        return owner, np.mod(np.angle(root), 2.0 * np.pi), np.zeros(0, np.int64)

    return orientations


def found_by_naive_roots(result: Any, tolerance: float) -> Any:
    """What the algebra lists with roots in doubles; every other step is proven as always."""
    from workhold.algebra import engine

    kept = vars(engine)["find_candidate_orientations"]
    vars(engine)["find_candidate_orientations"] = naive_roots(tolerance)
    try:
        return engine.find_fixtures_by_algebra(result.query)
    finally:
        vars(engine)["find_candidate_orientations"] = kept


def missing(result: Any, few: Any) -> list[Any]:
    """The fixtures of a result that another lacks."""
    from workhold.verification.listing import collect_claims
    from workhold.verification.repeats import KnownFixtures

    listing = collect_claims(few)
    seen = KnownFixtures(listing.hardware)
    for index, fixture in enumerate(listing.fixtures):
        seen.add(index, fixture)
    return [fixture for fixture in result if seen.find(fixture) is None]


def what_sampling_misses(name: str, pitch: float, columns: int, samples: tuple[int, ...]) -> dict[str, Any]:
    """Type I fixtures on chord curves that samples of the orientation do not show, see ``sampling``."""
    vise = workhold.Vise(pitch=pitch, columns=columns, peg_radius=PEG_RADIUS)
    result = workhold.design(workhold.load(name), vise, types=["I"], threads=1)
    problem, wanted = Problem.from_query(result.query), sampling.expected(result)
    chords = sampling.Chords.of(problem)
    out: dict[str, Any] = {"part": name, "pitch": pitch, "columns": columns, "there": len(wanted), "lost": []}
    for count in samples:
        with np.errstate(invalid="ignore", divide="ignore"):
            found = sampling.sampled(problem, chords, count)
        hits = sum(any(abs(p - psi) < 1e-6 for p in found.get(key, ())) for key, psi in wanted)
        out["lost"].append({"samples": count, "lost": len(wanted) - hits, "share": 1.0 - hits / len(wanted)})
    return out


def bar() -> Any:
    """The part that can be slid apart."""
    return workhold.Workpiece.from_loops("bar", [BAR])


def sliding_fixture(separation: int) -> dict[str, Any]:
    """Four contacts with the bar in rational numbers: their misfits, which are zero, and the forces that close.

    Two left pegs hold the upright from both sides, two right pegs the cross bar from above and below. Whatever the
    separation, all four touch and their wrenches span the space with positive forces; none of these works against the jaw.
    """
    one, radius = Fraction(1), Fraction(3)
    # Peg, outward normal of its face, and the face's distance along that normal.
    contacts = (
        ((-3 * one, -20 * one), (-one, 0 * one), 0 * one),
        ((7 * one, 20 * one), (one, 0 * one), 4 * one),
        ((separation + 10 * one, 10 * one), (0 * one, one), 7 * one),
        ((separation * one, -10 * one), (0 * one, -one), 7 * one),
    )
    misfits = [p[0] * n[0] + p[1] * n[1] - distance - radius for p, n, distance in contacts]
    arm_left = contacts[1][0][1] - contacts[0][0][1]
    arm_right = contacts[2][0][0] - contacts[3][0][0]
    # Each jaw's two forces make a couple; the couples balance.
    total = 2 * (arm_left + arm_right)
    forces = [arm_right / total, arm_right / total, arm_left / total, arm_left / total]
    pull = sum((f * -n[0] for f, (_, n, _) in zip(forces[:2], contacts[:2], strict=True)), Fraction(0))
    turn = sum(
        (f * -(p[0] * n[1] - p[1] * n[0]) for f, (p, n, _) in zip(forces, contacts, strict=True)), Fraction(0)
    )
    assert turn == 0 and all(force > 0 for force in forces)
    return {
        "separation": separation,
        "largest_misfit": float(max(map(abs, misfits))),
        "forces": [float(force) for force in forces],
        "jaw_force": float(pull),
        "moment": float(turn),
    }


def sliding_picture(separations: tuple[int, int]) -> str:
    """The bar with its four pegs, the right ones at two separations."""
    scene = Scene.make_page((520.0, 340.0), "four contacts with force closure that slide apart")
    part = bar()
    view = View.fit_box(Box(*part.bounds).grow(9.0), Box(12.0, 12.0, 508.0, 328.0))
    scene.add_path(make_outline_path(part.loop_segments, view), BLACK, 1.6, "#fff7d1", fill_rule="evenodd")
    radius = PEG_RADIUS * view.scale
    for place in ((-3.0, -20.0), (7.0, 20.0)):
        scene.add_circle(view(place), radius, "#b3122a", BLACK, 1.0)
    for separation, fill in zip(separations, ("#b3122a", "none"), strict=True):
        for place in ((separation + 10.0, 10.0), (float(separation), -10.0)):
            scene.add_circle(view(place), radius, fill, "#b3122a", 1.4)
    scene.add_arrow(view((separations[0] + 15.0, 20.0)), view((separations[1] + 5.0, 20.0)), BLACK, 1.6, 12.0)
    return scene.to_svg()


def picture(result: Any, fixture: Any, words: str) -> str:
    """A small picture of a witness."""
    return card(result, fixture, words)
