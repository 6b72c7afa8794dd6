"""Comparing sets of fixtures: identity up to lattice steps, peg names and the half turn, apart from marginal ones."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from functools import cache
from math import dist, pi, radians, tau
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import check_toolkit
from workhold import Result, Vise, Workpiece, design
from workhold.fixels.vise import OpeningVise
from workhold.model.fixture import Fixture

Listed = dict[str, Any]
COMPLETE = Path(__file__).parent / "data" / "complete"
# The sets that take longest; ``make prove`` compares them.
LARGEST = ("small4Handle_10_10", "widget_8_1")
SETS = [
    pytest.param(path.stem, marks=pytest.mark.prove if path.stem in LARGEST else ())
    for path in sorted(COMPLETE.glob("*.json"))
]


@cache
def complete_set(name: str) -> tuple[dict[str, Any], Result]:
    """A complete set and the search's result for its part and vise, which each process of the tests solves once."""
    truth = json.loads((COMPLETE / f"{name}.json").read_text())
    part = truth["workpiece"]
    return truth, design(Workpiece.from_loops(part["name"], part["loops"]), vise_of(truth))


def listed(fixtures: Iterable[Fixture]) -> list[Listed]:
    """Fixtures in the form of the result file."""
    return [
        {
            "type": f.type,
            "pegs": [
                {"jaw": p.carrier, "column": p.column, "row": p.row, "x": p.x, "y": p.y, "segment": p.face}
                for p in f.pegs
            ],
            "pose": {"theta_deg": f.pose.theta_deg, "x": f.pose.x, "y": f.pose.y},
            "jaw_separation": f.travel,
        }
        for f in fixtures
    ]


def vise_of(truth: dict[str, Any]) -> Vise:
    """The vise of a complete set."""
    if "vise" in truth:
        return Vise(**truth["vise"])
    fields = dict(truth["toolkit"])
    assert fields.pop("kind") == OpeningVise.kind
    return OpeningVise(**fields)


def vise_fields(vise: Vise) -> dict[str, Any]:
    """A vise in the form of the result file."""
    return {
        "pitch": list(vise.pitch),
        "columns": vise.columns,
        "rows": vise.rows,
        "peg_radius": vise.peg_radius,
        "min_gap": vise.min_gap,
        "max_opening": vise.max_opening,
        "row_offset": vise.row_offset,
        "kind": vise.kind,
    }


class Judge:
    """The independent checker, bound to one workpiece and one vise."""

    def __init__(self, workpiece: Workpiece, vise: Vise) -> None:
        self.vise = vise_fields(vise)
        self.part = check_toolkit.Part([loop.tolist() for loop in workpiece.loops])

    def check(self, fixture: Listed) -> tuple[list[str], bool]:
        """Faults of a fixture, and whether it is within 1e-6 of a rule's edge."""
        return check_toolkit.check_vise(fixture, self.vise, self.part)  # type: ignore[no-any-return]

    def identity(self, fixture: Listed) -> tuple[Any, float, tuple[float, float]]:
        """What names a fixture: its pattern of faces and holes, its orientation in radians, its place on the part in mm."""
        key, theta, place = check_toolkit.identity(fixture, self.vise, self.part.rep)
        return key, theta % tau, tuple(place)


def near_an_end(judge: Judge, fixture: Listed, within: float = 1e-6) -> bool:
    """Whether a contact is at an end of its trimmed feature: the peg touches two faces, or stands at a corner."""
    theta = radians(fixture["pose"]["theta_deg"])
    turn = np.array([[np.cos(theta), np.sin(theta)], [-np.sin(theta), np.cos(theta)]])
    for peg in fixture["pegs"]:
        point = turn @ (np.array([peg["x"], peg["y"]]) - [fixture["pose"]["x"], fixture["pose"]["y"]])
        face = judge.part.rep[peg["segment"]]
        others = [s for k, s in enumerate(judge.part.segs) if judge.part.rep[k] != face]
        if min(check_toolkit.nearest(point, s)[0] for s in others) < judge.vise["peg_radius"] + within:
            return True
    return False


Named = list[tuple[Listed, tuple[Any, float, tuple[float, float]]]]


def missing(ours: list[Listed], expected: list[Listed], judge: Judge) -> list[Listed]:
    """Expected fixtures that are not among ours and are not marginal; both are given for the judge's part and vise.

    Only ours that lie as an expected one does, up to the half turn, are named: naming takes the time.
    """
    angles = np.array([fixture["pose"]["theta_deg"] for fixture in expected])
    alike = [
        fixture
        for fixture in ours
        if np.any(np.abs((angles - fixture["pose"]["theta_deg"] + 90.0) % 180.0 - 90.0) < 0.01)
    ]
    return lost(named(alike, judge), named(expected, judge), judge)


def named(fixtures: list[Listed], judge: Judge) -> Named:
    """Fixtures with what names them."""
    return [(fixture, judge.identity(fixture)) for fixture in fixtures]


def lost(ours: Named, expected: Named, judge: Judge) -> list[Listed]:
    """Those expected that are not among ours and are not marginal."""
    have: dict[Any, list[tuple[float, tuple[float, float]]]] = {}
    for _, (key, *pose) in ours:
        have.setdefault(key, []).append(tuple(pose))
    return [
        fixture
        for fixture, (key, theta, place) in expected
        if not any(
            abs((theta - t + pi) % tau - pi) < 1e-5 and dist(place, p) < 1e-5 for t, p in have.get(key, [])
        )
        and not judge.check(fixture)[1]
        and not near_an_end(judge, fixture)
    ]


def assert_same(ours: list[Listed], theirs: list[Listed], judge: Judge) -> None:
    """Both lists hold the same fixtures, apart from marginal ones."""
    one, other = named(ours, judge), named(theirs, judge)
    assert lost(one, other, judge) == []
    assert lost(other, one, judge) == []


def turned(fixtures: list[Listed], angle: float, face: Callable[[int], int] = lambda k: k) -> list[Listed]:
    """What the fixtures become when the part is redrawn turned by an angle in radians: the pose turns back."""
    return [
        fixture
        | {
            "pegs": [peg | {"segment": face(peg["segment"])} for peg in fixture["pegs"]],
            "pose": fixture["pose"] | {"theta_deg": fixture["pose"]["theta_deg"] - np.degrees(angle)},
        }
        for fixture in fixtures
    ]


def mirrored(fixtures: list[Listed], face: Callable[[int], int]) -> list[Listed]:
    """What the fixtures become when part and vise are mirrored at the vise's x axis."""
    return [
        fixture
        | {
            "pegs": [
                peg | {"segment": face(peg["segment"]), "y": -peg["y"], "row": -peg["row"]}
                for peg in fixture["pegs"]
            ],
            "pose": {
                "theta_deg": -fixture["pose"]["theta_deg"],
                "x": fixture["pose"]["x"],
                "y": -fixture["pose"]["y"],
            },
        }
        for fixture in fixtures
    ]
