"""``workhold seat``: words that fit a terminal, the same figures as JSON, pictures, and refusals."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import workhold
from workhold import Plate, Vise, Workpiece
from workhold.seating.seating import Solver

WEDGE = Workpiece.from_loops("wedge", [[[0, 0, 0], [70, 0, 0], [25, 55, 0]]])


@pytest.fixture(scope="module")
def result_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The best fixtures of a wedge."""
    path = tmp_path_factory.mktemp("seat") / "r.json"
    workhold.save(workhold.design(WEDGE, Vise(pitch=20, columns=2, peg_radius=3), best=12), path)
    return path


def test_it_tells_what_to_do_and_what_to_read(run: Any, result_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Within 80 columns; the fixture's own seat first, then every other with its reading."""
    monkeypatch.setenv("COLUMNS", "80")
    outcome = run("seat", result_file, 1)
    assert outcome.exit_code == 0, outcome.stderr
    lines = outcome.stdout.splitlines()
    assert max(map(len, lines)) <= 80
    result = workhold.open(result_file)
    [told] = workhold.seatings(result)
    text = " ".join(outcome.stdout.split())
    right = f"{result[0].jaw_separation:.3f} mm"
    assert f"When it has come home the jaws read {right}." in text
    assert f"which is {told.capture_opening:.3f} mm more than they close to" in text
    assert f"With a friction below {told.sticking_friction:.3f}" in text
    reads = [line.split()[1] for line in lines if line.split()[:1] and line.split()[0].isdigit()]
    assert reads[0] == right.split()[0]
    rest = [f"{seat.jaw_separation:.3f}" for seat in told.seats if not seat.is_own]
    assert reads[1:] == rest
    assert f"in {len(told.wrong_within())} wrong places" in text


def test_one_side_and_one_opening_leave_seats_out(run: Any, result_file: Path) -> None:
    drawn = run("seat", result_file, 1, "--side", "drawn").stdout
    over = run("seat", result_file, 1, "--side", "turned-over").stdout
    assert drawn.count(" over ") == 0 < over.count(" over ")
    every = workhold.seatings(workhold.open(result_file), 12, with_cage=False)
    rank, told = next((k, one) for k, one in enumerate(every, 1) if any(seat.difference > 0.1 for seat in one.seats))
    level = min(seat.difference for seat in told.seats if seat.difference > 0.1) - 0.05
    opened = told.wrong_within(level)
    assert len(opened) < len(told.wrong_within())
    text = " ".join(run("seat", result_file, rank, "--opening", f"{level}mm").stdout.split())
    assert (f"in {len(opened)} wrong place" if len(opened) != 1 else "in one wrong place") in text
    assert told.reading_of(level) == min(abs(seat.difference) for seat in opened)


def test_json_has_the_fields(run: Any, result_file: Path, tmp_path: Path) -> None:
    """The fields of the manual, in mm, and the picture that was drawn."""
    picture = tmp_path / "seats.svg"
    outcome = run("seat", result_file, 2, "--json", "--unit", "inch", "--draw", picture)
    assert outcome.exit_code == 0, outcome.stderr
    content = json.loads(outcome.stdout)
    result = workhold.open(result_file)
    told = Solver(result.workpiece, result.toolkit).of(result[1])
    assert content == {"rank": 2, "seating": told.as_fields(), "written": [str(picture)]}
    fields = content["seating"]
    manual = (Path(__file__).parents[2] / "docs" / "seating.md").read_text()
    assert all(f"`{name}`" in manual for name in fields)
    assert fields["wrong_seats"] == len(told.wrong_within()) and fields["reading"] > 0
    assert {"kind", "pose", "difference", "mirrored", "same_place", "contacts", "forces"} <= set(fields["seats"][0])
    drawn = picture.read_text()
    assert drawn.count('class="seat"') == min(len(told.seats), 12) and "1  right" in drawn


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("1", "--side", "up"), "--side 'up' is not known"),
        (("1", "--opening", "-1"), "--opening"),
        (("13",), "there is no fixture 13"),
        (("1", "--draw", "a.pdf"), "let the name end in .svg or .png"),
    ],
)
def test_refusals_are_one_sentence(run: Any, result_file: Path, arguments: tuple[str, ...], message: str) -> None:
    outcome = run("seat", result_file, *arguments)
    assert outcome.exit_code == 2
    assert message in outcome.stderr and outcome.stderr.count("\n") == 1


def test_another_toolkit_is_refused(run: Any, tmp_path: Path) -> None:
    workhold.save(workhold.design(WEDGE, Plate(pitch=20, peg_radius=3), best=1), tmp_path / "p.json")
    outcome = run("seat", tmp_path / "p.json", 1)
    assert outcome.exit_code == 2 and "a vise that closes" in outcome.stderr
