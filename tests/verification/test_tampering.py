"""A file edited by hand is caught, whatever number was changed and however little above the rounding of the file."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from toolkit_results import verify_edited
from workhold import FlatJaw, Vise, Workpiece, design, load, save
from workhold.model.quality import CLAMP_FREEDOM, FIGURES, JAW_CONTACT, PIN_FIGURES, PIN_KEYS
from workhold.verification import Verification

Verify = Callable[[Callable[[dict[str, Any]], object]], Verification]

# Just above what is allowed for rounding (1e-6), and large.
SLIGHT, LARGE = 2e-6, 0.37


def test_the_file_as_written_is_proven(verified: Verify) -> None:
    outcome = verified(lambda data: None)
    assert (outcome.proven, outcome.refuted, outcome.undecided, outcome.faults) == (12, 0, 0, ())
    assert outcome.holds
    assert outcome.bits == 128


def test_rounding_of_the_file_is_allowed(verified: Verify) -> None:
    """Numbers off by a tenth of the allowance are still the same numbers."""

    def edit(data: dict[str, Any]) -> None:
        for fixture in data["fixtures"]:
            fixture["pose"]["x"] += 1e-7
            fixture["pegs"][2]["y"] -= 1e-7

    assert verified(edit).proven == 12


@pytest.mark.thinned(3)
@pytest.mark.parametrize("change", [SLIGHT, -SLIGHT, LARGE, -LARGE, 1e5])
@pytest.mark.parametrize(
    "place", ["x", "y", "force", "theta_deg", "pose x", "pose y", "jaw_separation", "closure_margin"]
)
def test_every_real_number_of_a_fixture(verified: Verify, place: str, change: float) -> None:
    def edit(data: dict[str, Any]) -> None:
        for number, fixture in enumerate(data["fixtures"]):
            peg = fixture["pegs"][number % 4]
            if place in ("x", "y"):
                peg[place] += change
            elif place == "force":
                peg[place] += change * max(1.0, peg[place])
            elif place == "closure_margin":
                fixture["quality"][place] += change
            elif place == "jaw_separation":
                fixture[place] += change
            else:
                fixture["pose"][place.removeprefix("pose ")] += change

    outcome = verified(edit)
    assert outcome.refuted == 12
    assert not outcome.holds


# Figures that a fixture in a vise of pegs has without loads, two clamps, ends of a jaw and heights. Those that need these
# are tampered with where they are known: below, in test_asked.py and in test_two_clamps.py.
OTHERS = {FIGURES[number] for number in (CLAMP_FREEDOM, JAW_CONTACT, *PIN_FIGURES)}
KEYS = [figure.key for figure in FIGURES if figure.unit != "N" and figure not in OTHERS]


@pytest.mark.thinned(4)
@pytest.mark.parametrize("change", [1e-6, -1e-6])
@pytest.mark.parametrize("key", ["force", *KEYS])
def test_a_millionth_of_a_force_or_a_figure(verified: Verify, key: str, change: float) -> None:
    """Each is derived again to more digits than that."""

    def edit(data: dict[str, Any]) -> None:
        for number, fixture in enumerate(data["fixtures"]):
            numbers = fixture["pegs"][number % 4] if key == "force" else fixture["quality"]
            numbers[key] += change * max(numbers[key], 1.0)

    assert verified(edit).refuted == 12


@pytest.mark.parametrize("key", ["location_error", "penalty", "closure_margin"])
def test_a_figure_left_out(tmp_path: Path, key: str) -> None:
    """A fixture that lacks a figure is refuted, also where the order of the list depends on the figure."""
    path = tmp_path / "r.json"
    save(design(load("widget"), Vise(pitch=8, columns=1, peg_radius=3), best=4), path)
    data = json.loads(path.read_text())
    outcome = verify_edited(data, lambda content: content["fixtures"][1]["quality"].pop(key), tmp_path)
    assert (outcome.proven, outcome.refuted, outcome.faults) == (3, 1, ())


@pytest.fixture(scope="module")
def on_a_jaw(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The file of fixtures on a flat jaw that has ends, whose heights are known."""
    kite = Workpiece.from_loops("kite", [[[0, 0, 0], [56, 6, 0], [48, 44, 0], [10, 37, 0]]])
    path = tmp_path_factory.mktemp("jaw") / "r.json"
    vise = FlatJaw(pitch=10, peg_radius=3, columns=6, jaw_width=30)
    save(design(kite, vise, best=6, thickness=20, jaw_force=500), path)
    data: dict[str, Any] = json.loads(path.read_text())
    return data


@pytest.mark.parametrize("change", [1e-6, -1e-6, 0.0])
@pytest.mark.parametrize("key", [FIGURES[JAW_CONTACT].key, *PIN_KEYS])
def test_a_millionth_of_a_figure_of_ends_or_bending(
    on_a_jaw: dict[str, Any], key: str, change: float, tmp_path: Path
) -> None:
    """Where the jaw has ends and heights are known, they are derived again to as many digits."""

    def edit(data: dict[str, Any]) -> None:
        for fixture in data["fixtures"]:
            fixture["quality"][key] += change * max(fixture["quality"][key], 1.0)

    outcome = verify_edited(on_a_jaw, edit, tmp_path)
    assert (outcome.fixtures, outcome.refuted) == (6, 6 if change else 0)
    assert all(f"its {key.replace('_', ' ')} is" in item.reason for item in outcome.unproven)


@pytest.mark.parametrize("change", [1, -1, 7])
@pytest.mark.parametrize("place", ["column", "row", "segment"])
def test_every_whole_number_of_a_fixture(verified: Verify, place: str, change: int) -> None:
    """Also when x and y are changed with the hole."""

    def edit(data: dict[str, Any]) -> None:
        for number, fixture in enumerate(data["fixtures"]):
            peg = fixture["pegs"][number % 4]
            peg[place] += change
            if number % 2:
                peg["x"] += 8.0 * change * (place == "column")
                peg["y"] += 8.0 * change * (place == "row")

    assert verified(edit).refuted == 12


def test_a_full_turn_of_the_pose_changes_nothing(verified: Verify) -> None:
    def edit(data: dict[str, Any]) -> None:
        data["fixtures"][0]["pose"]["theta_deg"] -= 360.0

    assert verified(edit).proven == 12


def swap_jaws(fixture: dict[str, Any]) -> None:
    for peg in fixture["pegs"]:
        peg["jaw"] = "right" if peg["jaw"] == "left" else "left"


def swap_faces(fixture: dict[str, Any]) -> None:
    first = fixture["pegs"][0]
    second = next(peg for peg in fixture["pegs"] if peg["segment"] != first["segment"])
    first["segment"], second["segment"] = second["segment"], first["segment"]


def one_hole(fixture: dict[str, Any]) -> None:
    fixture["pegs"][1] = dict(fixture["pegs"][0])


def all_left(fixture: dict[str, Any]) -> None:
    for peg in fixture["pegs"]:
        peg["jaw"] = "left"


def other_type(fixture: dict[str, Any]) -> None:
    fixture["type"] = "II" if fixture["type"] == "I" else "I"


@pytest.mark.parametrize("edit_one", [swap_jaws, swap_faces, one_hole, all_left, other_type])
def test_mixed_up_pegs(verified: Verify, edit_one: Callable[[dict[str, Any]], None]) -> None:
    outcome = verified(lambda data: [edit_one(fixture) for fixture in data["fixtures"]])
    assert outcome.refuted == 12


def test_all_fixtures_moved_by_one_row_still_hold(verified: Verify) -> None:
    """The contract fixes pegs only relative to each other."""

    def edit(data: dict[str, Any]) -> None:
        fixture = data["fixtures"][3]
        fixture["pose"]["y"] += 8.0
        for peg in fixture["pegs"]:
            peg["row"] += 1
            peg["y"] += 8.0

    assert verified(edit).proven == 12


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("peg_radius", 2.9),
        ("pitch", [8.00001, 8.0]),
        ("row_offset", 0.001),
        ("min_gap", 500.0),
        ("max_opening", 8.5),
    ],
)
def test_another_vise(verified: Verify, key: str, value: object) -> None:
    assert verified(lambda data: data["vise"].update({key: value})).refuted > 0


def test_fewer_rows_and_columns(verified: Verify) -> None:
    assert verified(lambda data: data["vise"].update(columns=1)).refuted > 0
    assert verified(lambda data: data["vise"].update(rows=2)).refuted > 0


def moved_left_pegs(fixture: dict[str, Any]) -> None:
    """The same fixture with the left pegs one column nearer to the opening, everything else moved with them."""
    fixture["jaw_separation"] += 8.0
    fixture["pose"]["x"] += 8.0
    for peg in fixture["pegs"]:
        peg["x"] += 8.0
        peg["column"] += peg["jaw"] == "left"


def test_columns_and_rows_beyond_the_vise(verified: Verify) -> None:
    """In files that agree in everything else with a vise that has them."""
    outcome = verified(lambda data: [moved_left_pegs(fixture) for fixture in data["fixtures"]])
    assert outcome.refuted == 12
    assert all("is in column 2 of a jaw with 2" in fixture.reason for fixture in outcome.unproven)

    def edit(data: dict[str, Any]) -> None:
        for fixture in data["fixtures"]:
            fixture["pose"]["y"] -= 8.0
            for peg in fixture["pegs"]:
                peg["row"] -= 1
                peg["y"] -= 8.0

    outcome = verified(edit)
    assert outcome.refuted == 12
    assert all(
        "is in row -1 of a jaw with rows from 0 upward" in fixture.reason for fixture in outcome.unproven
    )


def test_another_workpiece(verified: Verify) -> None:
    """Every face moves when the outline is stretched by a hundredth of a micrometre per millimetre."""

    def edit(data: dict[str, Any]) -> None:
        for loop in data["workpiece"]["loops"]:
            for vertex in loop:
                vertex[0] *= 1.00001

    assert verified(edit).refuted == 12


def test_a_larger_contact_margin(verified: Verify) -> None:
    assert verified(lambda data: data.update(contact_margin=30.0)).refuted == 12


@pytest.mark.parametrize("key", ["counts", "found", "distinct"])
def test_counts(verified: Verify, key: str) -> None:
    def edit(data: dict[str, Any]) -> None:
        data[key]["I"] = {"counts": 11, "found": 5, "distinct": 10**6}[key]

    outcome = verified(edit)
    assert outcome.refuted == 0
    assert any(key in fault for fault in outcome.faults)
    assert not outcome.holds


def test_a_fixture_struck_out_or_listed_twice(verified: Verify) -> None:
    outcome = verified(lambda data: data["fixtures"].pop())
    assert "are listed" in outcome.faults[0]
    outcome = verified(lambda data: data["fixtures"].append(data["fixtures"][2]))
    assert [(u.index, u.verdict, u.reason) for u in outcome.unproven] == [
        (12, "refuted", "it is the same as fixture 3")
    ]


def test_loops_run_the_wrong_way(verified: Verify) -> None:
    """Their segments would be numbered otherwise, so the file does not say which faces it means."""

    def edit(data: dict[str, Any]) -> None:
        loop = data["workpiece"]["loops"][0]
        turned = [loop[0], *loop[:0:-1]]
        bulges = [-vertex[2] for vertex in loop[::-1]]
        data["workpiece"]["loops"][0] = [[x, y, b] for (x, y, _), b in zip(turned, bulges, strict=True)]

    assert verified(edit).faults == ("loop 0 does not have the material on its left",)
