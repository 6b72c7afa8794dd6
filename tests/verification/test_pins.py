"""How far pegs bend is derived anew, by arithmetic of its own, and a forged figure is refuted."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from workhold import Plate, Vise, Workpiece, design, save
from workhold.fixels.support_hardware import PinLimits
from workhold.model.quality import PIN_KEYS
from workhold.model.solid import SolidOutline, interpolate_run
from workhold.verification import Verification, verify_file
from workhold.verification.pins import interpolate_cubic

LOOPS = [[[-17, -17, 0], [17, -17, 0], [17, 17, 0], [-17, 17, 0]]]
SQUARE = Workpiece.from_loops("square", LOOPS)
SLIDES = ((0.0, 0.0, 10.0), (1 / 3, 0.0, 16.0), (2 / 3, 0.0, 22.0), (1.0, 0.0, 28.0))
SOLID = SolidOutline(
    "z", 40.0, 30.0, 0.5, 1.0, [[0, 10], [4, 20], [0, 30], [0, 6]], runs=[SLIDES, [], [], []]
)
VISE = Vise(pitch=10, columns=2, peg_radius=3, pins=PinLimits(stress_limit=300))
CASES = {
    "drawing": (SQUARE, VISE, {"thickness": 76, "jaw_force": 500}),
    "per kN": (SQUARE, VISE, {"peg_height": 20}),
    "solid": (Workpiece.from_loops("square", LOOPS, solid=SOLID), VISE, {"jaw_force": 900}),
    "plate": (
        Workpiece.from_loops("kite", [[[0, 0, 0], [70, -8, 0.1], [88, 40, 0], [22, 66, 0]]]),
        Plate(pitch=15, peg_radius=3),
        {"thickness": 12, "jaw_force": 900},
    ),
    "two clamps": (
        Workpiece.from_loops("kite", [[[0, 0, 0], [70, -8, 0.1], [88, 40, 0], [22, 66, 0]]]),
        Plate(pitch=15, peg_radius=3, clamps=2),
        {"thickness": 12, "jaw_force": 900},
    ),
}


def outcome_of(case: str, folder: Path, edit: Callable[[dict[str, Any]], object]) -> Verification:
    """What is shown of a result of the best three, after a change of its file."""
    part, toolkit, asked = CASES[case]
    path = folder / "result.json"
    save(design(part, toolkit, best=3, **asked), path)
    data = json.loads(path.read_text())
    edit(data)
    path.write_text(json.dumps(data))
    return verify_file(path)


@pytest.mark.thinned(3)
@pytest.mark.parametrize("case", CASES)
def test_what_is_written_is_proven(case: str, tmp_path: Path) -> None:
    outcome = outcome_of(case, tmp_path, lambda data: None)
    assert (outcome.refuted, outcome.undecided, outcome.faults) == (0, 0, ())
    assert outcome.proven == outcome.fixtures > 0


@pytest.mark.thinned(6)
@pytest.mark.parametrize("case", ["drawing", "solid", "two clamps"])
@pytest.mark.parametrize("key", [*PIN_KEYS, "warnings"])
def test_a_forged_figure_is_refuted(case: str, key: str, tmp_path: Path) -> None:
    """By a millionth more or less it is another one, and one warning fewer is one hidden."""

    def edit(data: dict[str, Any]) -> None:
        quality = data["fixtures"][0]["quality"]
        quality[key] = quality[key] - 1 if key == "warnings" else quality[key] * (1 + 1e-5)

    assert outcome_of(case, tmp_path, edit).refuted == 1


def test_a_file_from_before_there_were_these_figures_still_holds(tmp_path: Path) -> None:
    """It states none, and may have counted no warning of them; some of them alone are too few."""

    def before(data: dict[str, Any]) -> None:
        for fixture in data["fixtures"]:
            for key in PIN_KEYS:
                del fixture["quality"][key]
            fixture["quality"]["warnings"] -= 2

    assert outcome_of("drawing", tmp_path, before).holds
    assert not outcome_of(
        "drawing", tmp_path, lambda data: data["fixtures"][0]["quality"].pop("pin_stress")
    ).holds


def test_figures_without_heights_are_superfluous(tmp_path: Path) -> None:
    outcome = outcome_of("per kN", tmp_path, lambda data: data.pop("peg_height"))
    assert not outcome.holds


def test_runs_are_followed_along_their_segments() -> None:
    for share in (0.0, 0.1, 0.5, 0.77, 1.0):
        low, high = interpolate_run(SLIDES, share)
        assert (interpolate_cubic(SLIDES, share, 1), interpolate_cubic(SLIDES, share, 2)) == pytest.approx(
            (low, high), abs=1e-12
        )
