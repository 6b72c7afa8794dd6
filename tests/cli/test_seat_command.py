"""``workhold seat``: words that fit a terminal, the same figures as JSON, pictures, and refusals."""

from __future__ import annotations

import json
from math import inf
from pathlib import Path
from typing import Any

import pytest
from attrs import evolve

import workhold
from workhold import OpeningVise, Plate, Vise, Workpiece
from workhold.drawing.scene import LengthUnit
from workhold.drawing.seating_words import SeatingSentences
from workhold.model.quality import FIGURE_RANKING
from workhold.seating.solver import SeatingSolver
from workhold.units import INCH, MILLIMETRE

WEDGE = Workpiece.from_loops("wedge", [[[0, 0, 0], [70, 0, 0], [25, 55, 0]]])


@pytest.fixture(scope="module")
def result_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The best fixtures of a wedge."""
    path = tmp_path_factory.mktemp("seat") / "r.json"
    vise = Vise(pitch=20, columns=2, peg_radius=3)
    workhold.save(workhold.design(WEDGE, vise, best=12, rank_by=FIGURE_RANKING), path)
    return path


def test_it_says_where_nothing_is_known_of_how_a_part_is_caught(run: Any, tmp_path: Path) -> None:
    """Of a fixture that was not found among its own seats; the sheet says so too."""
    result = workhold.design(WEDGE, Vise(pitch=20, columns=2, peg_radius=3), best=1, seating=1)
    [told] = result.seating
    untold = evolve(
        told,
        capture_opening=0.0,
        lowest_pass=None,
        way_out=0.0,
        cage=None,
        placing=None,
        unsettled=("This fixture was not found among the seats of its own pegs, a fault of the program.",),
    )
    path = tmp_path / "r.json"
    workhold.save(evolve(result, seating=(untold,)), path)
    outcome = run("seat", path, 1)
    text = " ".join(outcome.stdout.split())
    assert outcome.exit_code == 0 and "a fault of the program" in " ".join(outcome.stderr.split())
    assert "It is not known how far you may open: put the part in its place, hold it there" in text
    assert (
        "of room" not in text and "Open the jaws to" not in text and "When the part is in its place" in text
    )
    assert "Beware: it is not known how far you may open without losing the part." in " ".join(
        run("show", path, 1).stdout.split()
    )
    words = SeatingSentences(
        untold, result[0], result.toolkit, LengthUnit.from_typical_length(MILLIMETRE, 20.0)
    )
    assert "is not known" in words.list_steps(WEDGE)[0] and "is not known" in words.list_cautions()[0][1]


def test_it_tells_what_to_do_and_what_to_read(
    run: Any, result_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Within 80 columns; the fixture's own seat first, then every other with its reading."""
    monkeypatch.setenv("COLUMNS", "80")
    outcome = run("seat", result_file, 1)
    assert outcome.exit_code == 0, outcome.stderr
    lines = outcome.stdout.splitlines()
    assert max(map(len, lines)) <= 80
    result = workhold.open(result_file)
    [told] = workhold.seatings(result)
    text = " ".join(outcome.stdout.split())
    right = f"{result[0].travel:.3f} mm"
    assert f"When the part is in its place, the opening S is {right}. While it is more" in text
    assert f"which is {told.capture_opening:.3f} mm from where they hold the part" in text
    assert f"With a friction below {told.sticking_friction:.3f}" in text
    reads = [line.split()[1] for line in lines if line.split()[:1] and line.split()[0].isdigit()]
    assert reads[0] == right.split()[0]
    rest = [f"{seat.jaw_separation:.3f}" for seat in told.seats if not seat.is_own]
    assert reads[1:] == rest
    assert f"in {len(told.list_wrong_seats())} wrong places" in text


@pytest.mark.thorough
def test_a_design_tells_it_of_the_first_and_lists_what_is_as_asked(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the table, in the file, and in words of ``show``, which are those of ``seat``."""
    monkeypatch.setenv("COLUMNS", "80")
    part, out = tmp_path / "wedge.json", tmp_path / "r.json"
    part.write_text(json.dumps({"name": "wedge", "units": "mm", "loops": [WEDGE.loops[0].tolist()]}))
    asked = ("design", part, "--pitch", 20, "--columns", 2, "--peg-radius", 3, "--best", 6, "--seating", 6)
    outcome = run(*asked, "--out", out)
    assert outcome.exit_code == 0, outcome.stderr
    lines = outcome.stdout.splitlines()
    assert max(map(len, lines)) <= 80
    result = workhold.open(out)
    assert len(result.seating) == 6
    first = next(line.split() for line in lines if line.split()[:1] == ["1"])
    for figure in ("capture_opening", "reading"):
        assert f"{result[0].figures[figure]:.2f}" in first
    shown, told = (" ".join(run(command, out, 1).stdout.split()) for command in ("show", "seat"))
    sentence = f"When the part is in its place, the opening S is {result[0].travel:.3f} mm."
    assert sentence in shown and sentence in told
    data = json.loads(run("show", out, 1, "--json").stdout)
    assert data["fixture"]["seating"] == json.loads(json.dumps(result.seating[0].to_fields()))
    opening = min(one.capture_opening or 0.0 for one in result.seating)
    opened = run(*asked, "--opening", opening, "--foolproof", "--rank-by", "reading", "--out", out, "--force")
    assert opened.exit_code == 0, opened.stderr
    query = workhold.open(out).query
    assert (query.opening, query.foolproof, query.rank_by) == (opening, True, ("reading",))
    assert "listed for their seating" in " ".join(opened.stdout.split()) and "as asked" in opened.stderr
    alone = run("design", "widget", "--pitch", 8, "--columns", 1, "--peg-radius", 3, "--foolproof")
    assert alone.exit_code == 2 and "need --seating K" in alone.stderr


@pytest.mark.thorough
def test_one_side_and_one_opening_leave_seats_out(run: Any, result_file: Path) -> None:
    drawn = run("seat", result_file, 1, "--side", "drawn").stdout
    over = run("seat", result_file, 1, "--side", "turned-over").stdout
    assert drawn.count(" over ") == 0 < over.count(" over ")
    every = workhold.seatings(workhold.open(result_file), 12, with_cage=False)
    rank, told = next(
        (k, one) for k, one in enumerate(every, 1) if any(seat.difference > 0.1 for seat in one.seats)
    )
    level = min(seat.difference for seat in told.seats if seat.difference > 0.1) - 0.05
    opened = told.list_wrong_seats(level)
    assert len(opened) < len(told.list_wrong_seats())
    text = " ".join(run("seat", result_file, rank, "--opening", f"{level}mm").stdout.split())
    assert (f"in {len(opened)} wrong place" if len(opened) != 1 else "in one wrong place") in text
    assert told.find_least_reading(level) == min(abs(seat.difference) for seat in opened)


@pytest.mark.thorough
def test_json_has_the_fields(run: Any, result_file: Path, tmp_path: Path) -> None:
    """The fields of the manual, in mm, and the picture that was drawn."""
    picture = tmp_path / "seats.svg"
    outcome = run("seat", result_file, 2, "--json", "--unit", "inch", "--draw", picture)
    assert outcome.exit_code == 0, outcome.stderr
    content = json.loads(outcome.stdout)
    result = workhold.open(result_file)
    told = SeatingSolver(result.workpiece, result.toolkit).solve(result[1])
    assert content == {"rank": 2, "seating": told.to_fields(), "written": [str(picture)]}
    fields = content["seating"]
    manual = (Path(__file__).parents[2] / "docs" / "seating.md").read_text()
    assert all(f"`{name}`" in manual for name in fields)
    assert fields["wrong_seats"] == len(told.list_wrong_seats()) and fields["reading"] > 0
    assert {"kind", "pose", "difference", "mirrored", "same_place", "contacts", "forces"} <= set(
        fields["seats"][0]
    )
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
def test_refusals_are_one_sentence(
    run: Any, result_file: Path, arguments: tuple[str, ...], message: str
) -> None:
    outcome = run("seat", result_file, *arguments)
    assert outcome.exit_code == 2
    assert message in outcome.stderr and outcome.stderr.count("\n") == 1


@pytest.mark.thorough
def test_with_two_clamps_it_says_what_to_do_by_hand(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As an answer within 80 columns, its steps numbered, with lengths in the unit asked for, the same as JSON and with a
    picture: of fixtures of which either clamp may be first, one of them, or none."""
    monkeypatch.setenv("COLUMNS", "80")
    plate, square = (
        Plate(pitch=20, peg_radius=3, clamps=2, columns=4, rows=3),
        [[0, 0, 0], [70, 0, 0], [70, 45, 0], [0, 45, 0]],
    )
    made = workhold.design(Workpiece.from_loops("square", [square]), plate)
    workhold.save(made, tmp_path / "p.json")
    seen = set()
    for rank, fixture in enumerate(made, 1):
        low, high = fixture.pair.ratio
        if (kind := (low == 0.0, high == inf)) in seen:
            continue
        seen.add(kind)
        outcome, picture = run("seat", tmp_path / "p.json", rank, "--unit", "inch"), tmp_path / f"{rank}.svg"
        assert outcome.exit_code == 0 and not outcome.stderr
        assert max(map(len, outcome.stdout.splitlines())) <= 80
        [told], text = workhold.seatings(made, [fixture]), " ".join(outcome.stdout.split())
        steps = told.list_steps(INCH.format_length)
        assert (
            f"Seating of fixture {rank} of {len(made)}: square Neither of the two clamps holds the part alone"
            in text
        )
        assert " ".join(f"{number}. {step}" for number, step in enumerate(steps, 1)) in text
        shown = json.loads(
            run("seat", tmp_path / "p.json", rank, "--json", "--draw", picture, "--unit", "inch").stdout
        )
        assert shown == {
            "rank": rank,
            "seating": None,
            "by_hand": told.to_fields(INCH.format_length),
            "written": [str(picture)],
        }
        assert shown["by_hand"]["steps"] == steps and " in at clamp" in steps[-1]
        assert f"Fixture {rank}" in picture.read_text()
        outcome = run("seat", tmp_path / "p.json", rank, "--draw", picture, "--force")
        assert str(picture) in "".join(outcome.stdout.split())
    assert len(seen) == 4


@pytest.mark.thorough
def test_a_search_for_seating_with_two_clamps_is_told_by_show(run: Any, tmp_path: Path) -> None:
    """Of the first fixtures, as many as were asked, in words and as JSON; the search says so, and what it cannot do."""
    (tmp_path / "square.json").write_text(
        '{"name": "square", "units": "mm", "loops": [[[0, 0, 0], [70, 0, 0], [70, 45, 0], [0, 45, 0]]]}'
    )
    asked = [
        "design",
        tmp_path / "square.json",
        "--toolkit",
        "two-clamp-plate-20mm",
        "--best",
        3,
        "--seating",
        2,
    ]
    outcome = run(*asked, "--out", tmp_path / "r.json")
    assert outcome.exit_code == 0 and "pushed against its locators by hand" in " ".join(
        outcome.stderr.split()
    )
    result = workhold.open(tmp_path / "r.json")
    for rank, [told] in ((rank, workhold.seatings(result, [result[rank - 1]])) for rank in (2, 3)):
        text = " ".join(run("show", tmp_path / "r.json", rank).stdout.split())
        shown = json.loads(run("show", tmp_path / "r.json", rank, "--json").stdout)["fixture"]
        assert all((step in text) == (rank == 2) for step in told.list_steps()[:2])
        assert shown.get("by_hand") == (told.to_fields() if rank == 2 else None)
    refused = run(*asked, "--foolproof")
    assert refused.exit_code == 2 and "ask for the seating alone" in refused.stderr


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("travel", "words"),
    [
        (
            None,
            "Draw the clamp back to a tip y of more than {wide} mm, which is {by} mm from where it holds the part.",
        ),
        (
            (5, 40),
            "Draw the clamp back to a stroke of more than {wide} mm, which is {by} mm from where it holds the part.",
        ),
    ],
    ids=["tip", "stroke"],
)
def test_a_clamp_is_drawn_back(
    run: Any, tmp_path: Path, travel: tuple[float, float] | None, words: str
) -> None:
    """What is read is the tip's place or the stroke; a tip that pushes up is drawn down, and both get less."""
    plate = Plate(pitch=20, peg_radius=3, directions=["+y"], travel=travel)
    workhold.save(workhold.design(WEDGE, plate, best=1), tmp_path / "p.json")
    result = workhold.open(tmp_path / "p.json")
    [told] = workhold.seatings(result)
    outcome = run("seat", tmp_path / "p.json", 1, "--draw", tmp_path / "seats.svg")
    text = " ".join(outcome.stdout.split())
    right = result[0].pegs[-1].y if travel is None else -result[0].travel
    assert words.format(wide=f"{right - told.capture_opening:.3f}", by=f"{told.capture_opening:.3f}") in text
    assert f"is {right:.3f} mm. While it is less, the part is stuck" in text
    reads = [
        line.split()[1]
        for line in outcome.stdout.splitlines()
        if line.split()[:1] and line.split()[0].isdigit()
    ]
    rest = [right - (seat.jaw_separation - result[0].travel) for seat in told.seats if not seat.is_own]
    shown = [
        one for one in told.seats if not one.is_own and (travel is None or one.jaw_separation <= -travel[0])
    ]
    assert len(reads) == 1 + len(shown) and set(reads[1:]) <= {f"{one:.3f}" for one in rest}
    assert f"reads {right:.3f} mm" in (tmp_path / "seats.svg").read_text()


@pytest.mark.thorough
def test_an_opening_vise_is_closed_to_put_the_part_in(run: Any, tmp_path: Path) -> None:
    holed = Workpiece.from_loops(
        "holed",
        [
            [[0, 0, 0], [80, 0, 0], [80, 70, 0], [0, 70, 0]],
            [[20, 20, 0], [60, 14, 0], [62, 50, 0], [26, 52, 0]],
        ],
    )
    vise = OpeningVise(pitch=15, columns=1, peg_radius=3, min_gap=6)
    workhold.save(workhold.design(holed, vise, best=1), tmp_path / "o.json")
    result = workhold.open(tmp_path / "o.json")
    [told] = workhold.seatings(result)
    text = " ".join(run("seat", tmp_path / "o.json", 1).stdout.split())
    right = result[0].travel
    assert f"Close the jaws to more than {right - told.capture_opening:.3f} mm" in text
    assert f"the opening S is {right:.3f} mm. While it is less" in text
