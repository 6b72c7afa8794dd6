"""A kind of toolkit that no source file knows, described by its carriers alone: the rules are put together for it.

A machine vise with one flat jaw: the fixed jaw is a wall, and a lattice of pegs on the jaw that moves presses the part onto
it. Its complete sets come from an independent method.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from copy import deepcopy
from math import cos, pi, radians, sin
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from attrs import evolve, frozen

from judged import known_in, place_in_order, rules_in
from workhold import Fixture, InputError, Workpiece
from workhold.fixels.support_hardware import PinLimits
from workhold.fixels.toolkit import Arrangement, Carrier, Symmetry, Toolkit, ToolkitLimit, Travel
from workhold.geometry.segment import Line, measure_distance_to_segment
from workhold.verification import Ruling, verify_fixture
from workhold.verification.reading import read_fixtures
from workhold.verification.repeats import describe_stance
from workhold.verification.seating import find_stop

Data = dict[str, Any]
Edit = Callable[[Data], object]
TRUTH = Path(__file__).parent.parent / "data" / "toolkits"
COUNTS = {"flat_kite_10": 62, "flat_rocker_8": 120}


@frozen
class FlatJaw(Toolkit):
    """A wall that stands still, and a lattice with two pegs that slides along y and clamps towards it."""

    kind: ClassVar[str] = "flat-jaw"
    noun: ClassVar[str] = "vise"
    arrangements: ClassVar[tuple[Arrangement, ...]] = (Arrangement("flat", (2, 2)),)
    clamping: ClassVar[int] = 1
    symmetries: ClassVar[tuple[Symmetry, ...]] = ()

    pitch: tuple[float, float]
    peg_radius: float
    min_gap: float
    columns: int | None = None
    rows: int | None = None
    max_opening: float | None = None
    pins: PinLimits | None = None

    @property
    def carriers(self) -> tuple[Carrier, Carrier]:
        """The fixed jaw, and the jaw that moves."""
        size, radius = (self.pitch, self.columns, self.rows), self.peg_radius
        travel = Travel(pi / 2, self.min_gap, self.max_opening)
        return (
            Carrier("wall", *size, 0.0, 0.0, noun="fixed jaw", peg="end", is_wall=True),
            Carrier("jaw", *size, radius, radius, travel=travel, noun="jaw"),
        )

    @property
    def gap(self) -> None:
        """Both pegs stand on one carrier."""
        return None

    @property
    def limits(self) -> tuple[ToolkitLimit, ...]:
        """None that matter here."""
        return ()


@frozen
class Known:
    """A complete set: the part, the toolkit, and its fixtures as they are written."""

    workpiece: Workpiece
    toolkit: FlatJaw
    items: list[Data]

    def read(self, item: Data) -> Fixture:
        """A fixture from its JSON object."""
        (fixture,) = read_fixtures([item], Path("truth"))
        return rules_in(self.toolkit).complete_fixture(fixture)

    def ruling(self, item: Data, **fields: Any) -> Ruling:
        """What is shown of a fixture, perhaps in a toolkit with other fields."""
        return verify_fixture(self.read(item), self.workpiece, evolve(self.toolkit, **fields))


@pytest.fixture(scope="module", params=COUNTS)
def known(request: pytest.FixtureRequest) -> Known:
    """The set of a file, with the faces that lie on the wall, which it leaves to be worked out."""
    data = json.loads((TRUTH / f"{request.param}.json").read_text())
    workpiece = Workpiece.from_loops("part", data["workpiece"]["loops"])
    fields = {key: value for key, value in data["toolkit"].items() if key != "kind"}
    toolkit = FlatJaw(**fields | {"pitch": tuple(fields["pitch"])})
    items = [item | {"quality": {}, "wall": on_faces(item, workpiece)} for item in data["fixtures"]]
    assert len(items) == COUNTS[request.param] and not any(item["marginal"] for item in items)
    return Known(workpiece, toolkit, items)


def on_faces(item: Data, workpiece: Workpiece) -> Data:
    """The wall of a fixture with the faces at both of its ends: that which lies along it, or the lowest number."""
    pose, numbers = item["pose"], []
    turn = radians(pose["theta_deg"])
    for x, y in (item["wall"]["from"], item["wall"]["to"]):
        dx, dy = x - pose["x"], y - pose["y"]
        point = cos(turn) * dx + sin(turn) * dy, cos(turn) * dy - sin(turn) * dx
        touched = [f for f in workpiece.faces if measure_distance_to_segment(point, f.segment) < 1e-6]
        flush = [
            f.number
            for f in touched
            if isinstance(f.segment, Line) and abs(f.segment.compute_normal()[0] + sin(turn)) < 1e-6
        ]
        numbers.append(min(flush or [f.number for f in touched]))
    return item["wall"] | {"segments": numbers}


@pytest.mark.thorough
def test_every_true_fixture_is_proven(known: Known) -> None:
    """At the lowest precision, and no two are the same."""
    seen = known_in(known.toolkit)
    for number, item in enumerate(known.items):
        ruling = known.ruling(item)
        assert (ruling.verdict, ruling.bits) == ("proven", 128), (number, ruling)
        assert seen.add(number, known.read(item)) is None
    assert rules_in(known.toolkit).names == (
        "the fixed jaw at its left end",
        "the fixed jaw at its right end",
        "peg 1",
        "peg 2",
    )


def plus(values: Any, place: Any, by: float) -> None:
    """A number of a list or an object made larger."""
    values[place] += by


def shifted(item: Data, columns: int, rows: int, pitch: float) -> None:
    """A fixture with both pegs moved by whole holes: along the wall with the part, away from it by jaws that open less."""
    for peg in item["pegs"]:
        peg["column"] += columns
        peg["row"] += rows
        peg["x"] += columns * pitch
    for end in ("from", "to"):
        item["wall"][end][0] += columns * pitch
    item["pose"]["x"] += columns * pitch
    item["jaw_separation"] -= rows * pitch


NUMBERS: list[tuple[Edit, str]] = [
    (lambda f: plus(f["pose"], "theta_deg", 1e-5), "touch"),
    (lambda f: plus(f["pose"], "x", 1e-5), "touch"),
    (lambda f: plus(f["pose"], "y", 1e-5), "touch"),
    (lambda f: plus(f, "jaw_separation", 1e-5), "the y of peg 1 is"),
    (lambda f: plus(f["pegs"][0], "x", 1e-5), "the x of peg 1 is"),
    (lambda f: plus(f["pegs"][1], "y", -1e-5), "the y of peg 2 is"),
    (lambda f: plus(f["pegs"][1], "row", 1), "the y of peg 2 is"),
    (lambda f: plus(f["pegs"][1], "column", 1), "the x of peg 2 is"),
    (lambda f: plus(f["pegs"][0], "force", 1e-5), "the force of peg 1 is"),
    (lambda f: f["pegs"][0].update(segment=f["wall"]["segments"][0]), "peg 1 is"),
    (lambda f: f["pegs"][0].update(segment=99), "peg 1 is on segment 99, which does not name a face"),
    (lambda f: plus(f["wall"]["forces"], 0, 1e-5), "the force of the fixed jaw at its left end is"),
    (lambda f: plus(f["wall"]["to"], 0, 1e-5), "the x of the fixed jaw at its right end is"),
    (lambda f: plus(f["wall"]["from"], 1, 1e-5), "the y of the fixed jaw at its left end is"),
    (
        lambda f: f["wall"]["segments"].__setitem__(1, f["pegs"][0]["segment"]),
        "the fixed jaw at its right end touches face",
    ),
    (lambda f: f["pegs"].__setitem__(1, dict(f["pegs"][0])), "two pegs are in the same hole"),
]


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("edit", "words"), NUMBERS, ids=[f"{n} {words}" for n, (_, words) in enumerate(NUMBERS)]
)
def test_a_number_that_is_another_one_is_found(known: Known, edit: Edit, words: str) -> None:
    """In some fixtures of the set, each of which is refuted, most of them for that number."""
    rulings = []
    for item in known.items[::9]:
        changed = deepcopy(item)
        edit(changed)
        rulings.append(known.ruling(changed))
    assert {ruling.verdict for ruling in rulings} == {"refuted"}
    assert sum(words in ruling.reason for ruling in rulings) > len(rulings) / 2, rulings


def test_the_gap_and_the_opening_are_kept(known: Known) -> None:
    """Each fixture stands just where its separation is between the two."""
    for item in known.items[::5]:
        apart = item["jaw_separation"]
        assert known.ruling(item, min_gap=apart - 1e-6, max_opening=apart + 1e-6).verdict == "proven"
        assert "is below the smallest gap" in known.ruling(item, min_gap=apart + 1e-6).reason
        assert "is above the largest opening" in known.ruling(item, max_opening=apart - 1e-6).reason


@pytest.mark.thorough
def test_columns_and_rows_are_there_and_counted(known: Known) -> None:
    """A jaw with fewer has no such hole, and pegs stand in the first column and in the nearest row."""
    (pitch, _), looked_at = known.toolkit.pitch, 0
    for item in known.items[::5]:
        columns, rows = (max(peg[noun] for peg in item["pegs"]) for noun in ("column", "row"))
        assert known.ruling(item, columns=columns + 1, rows=rows + 1).verdict == "proven"
        if columns:
            assert (
                f"is in column {columns} of a jaw with {columns} columns"
                in known.ruling(item, columns=columns).reason
            )
        if rows:
            assert f"is in row {rows} of a jaw with {rows} rows" in known.ruling(item, rows=rows).reason
        beside, behind = deepcopy(item), deepcopy(item)
        shifted(beside, 1, 0, pitch)
        assert known.ruling(beside).reason == "its lowest column is 1, and not 0"
        shifted(behind, 0, 1, pitch)
        apart = item["jaw_separation"]
        if apart - pitch > known.toolkit.min_gap:
            # Only where the opening of the row before is too large do the pegs move back.
            assert "would take one nearer" in known.ruling(behind).reason
            assert "would take one nearer" in known.ruling(behind, max_opening=apart + 1e-6).reason
            assert known.ruling(behind, max_opening=apart - 1e-6).verdict == "proven"
            looked_at += 1
    assert looked_at > 3


def test_what_does_not_close_or_clamp_is_refuted(known: Known) -> None:
    """A jaw that clamps as it opens; and pegs that both push the part along the wall the same way."""

    class Opening(FlatJaw):
        """One that would pull the part off the wall."""

        clamping: ClassVar[int] = -1

    toolkit = Opening(known.toolkit.pitch, known.toolkit.peg_radius, known.toolkit.min_gap)
    ruling = verify_fixture(known.read(known.items[0]), known.workpiece, toolkit)
    assert ruling.verdict == "refuted" and "does not clamp" in ruling.reason
    # Pegs on the top and the right side, both of which lean to the right, push the part to the left.
    loop, radius = [[0.0, 0.0, 0.0], [60.0, 0.0, 0.0], [50.0, 30.0, 0.0], [10.0, 40.0, 0.0]], 3.0
    top, right = np.array([10.0, 40.0]) / np.sqrt(1700.0), np.array([30.0, 10.0]) / np.sqrt(1000.0)
    levels = [top @ [50.0, 30.0] + radius, right @ [60.0, 0.0] + radius - right @ [30.0, -20.0]]
    x, y = np.linalg.solve(np.array([top, right]), levels).tolist()
    item = {
        "type": "flat",
        "wall": {"from": [-x, 0.0], "to": [60.0 - x, 0.0], "forces": [0.5, 0.5], "segments": [0, 0]},
        "pegs": [
            {"role": "jaw", "column": 0, "row": 2, "x": 0.0, "y": y, "segment": 2, "force": 0.5},
            {"role": "jaw", "column": 3, "row": 0, "x": 30.0, "y": y - 20.0, "segment": 1, "force": 0.5},
        ],
        "pose": {"theta_deg": 0.0, "x": -x, "y": 0.0},
        "jaw_separation": y - 20.0,
        "quality": {},
    }
    part = Workpiece.from_loops("part", [loop])
    free = Known(part, FlatJaw((10.0, 10.0), radius, radius), [item]).ruling(item)
    assert free.verdict == "refuted" and "do not hold the part" in free.reason, free


def test_the_part_lies_on_the_wall_and_off_the_pegs(known: Known) -> None:
    """Neither tilted on it, nor through it, nor above it."""
    fixture = known.read(known.items[0])
    for change in (
        {"theta_deg": fixture.pose.theta_deg + 3.0},
        {"y": fixture.pose.y - 2.0},
        {"y": fixture.pose.y + 2.0},
    ):
        moved = evolve(fixture, pose=evolve(fixture.pose, **change))
        assert verify_fixture(moved, known.workpiece, known.toolkit).verdict == "refuted"


def test_the_same_fixture_is_known_again(known: Known) -> None:
    """With both pegs moved by whole holes, the jaw with them, or their names exchanged; not turned half way round."""
    seen, (pitch, _) = known_in(known.toolkit), known.toolkit.pitch
    for number, item in enumerate(known.items):
        seen.add(number, known.read(item))
    for number, item in enumerate(known.items):
        other = deepcopy(item)
        shifted(other, 2, 3, pitch)
        other["pegs"].reverse()
        assert seen.find(known.read(other)) == number
        assert place_in_order(known.read(item), known.toolkit)[2] == [
            *item["wall"]["segments"],
            *(p["segment"] for p in item["pegs"]),
        ]
        fixture = known.read(item)
        turned = evolve(fixture, pose=evolve(fixture.pose, theta_deg=fixture.pose.theta_deg + 180.0))
        assert seen.find(turned) is None


def test_its_seating_knows_where_it_stops_and_which_pegs_stand_alike(known: Known) -> None:
    """The jaw stops at its smallest gap; fixtures on one pattern of pegs differ by its height and along the wall."""
    alike: dict[Any, list[tuple[tuple[float, ...], float]]] = {}
    for item in known.items:
        fixture = known.read(item)
        assert find_stop(fixture.pegs, known.toolkit, fixture.travel) == pytest.approx(3.0)
        here = describe_stance(fixture, known.toolkit)
        assert here.anchor == (0.0, 0.0) and here.apart == pytest.approx(
            min((p["x"], p["y"]) for p in item["pegs"])[1]
        )
        (first, second) = ((peg["column"], peg["row"]) for peg in item["pegs"])
        step = second[0] - first[0], second[1] - first[1]
        alike.setdefault(here.key, []).append((step, here.apart))
    assert all(len({step for step, _ in group}) == 1 for group in alike.values())
    assert len(alike) == len({group[0][0] for group in alike.values()}) < len(known.items)


def test_what_is_on_something_else_is_not_read(known: Known) -> None:
    item = deepcopy(known.items[0])
    with pytest.raises(InputError, match="its type is not flat"):
        known.read(item | {"type": "I"})
    item["pegs"][0] = {key: value for key, value in item["pegs"][0].items() if key != "role"} | {
        "jaw": "left"
    }
    with pytest.raises(InputError, match="a peg's jaw is not wall or jaw"):
        known.read(item)
