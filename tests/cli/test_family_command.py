"""``workhold family``: what it says, writes and refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from family_parts import shop_parts
from workhold.cli import family_command
from workhold.family.members import format_loss

pytest.importorskip("scipy", reason="the extra [batch] is not installed")

VISE = ("--pitch", "10", "--columns", "1", "--peg-radius", "3")


@pytest.fixture(scope="module")
def drawings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of four parts, one of them a disc that nothing holds, and of a file that is none."""
    folder = tmp_path_factory.mktemp("drawings")
    for part in shop_parts(3):
        loops = [loop.tolist() for loop in part.loops]
        (folder / f"{part.name}.json").write_text(
            json.dumps({"name": part.name, "units": "mm", "loops": loops})
        )
    disc = {"name": "disc", "units": "mm", "loops": [[[0, 0, 1], [40, 0, 1]]]}
    (folder / "disc.json").write_text(json.dumps(disc))
    (folder / "odd.dxf").write_text("0\nSECTION\n")
    return folder


def test_curve_plan_and_file(
    run: Any, drawings: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "f.json"
    monkeypatch.setattr("workhold.cli.table.find_terminal_width", lambda stream: 80)
    outcome = run("family", drawings, *VISE, "--setups", 2, "--out", out)
    assert outcome.exit_code == 0, outcome.stderr
    assert "disc.json is left out: it has no fixture in this vise." in outcome.stderr
    assert "odd.dxf is left out: odd.dxf: " in outcome.stderr
    lines = outcome.stdout.splitlines()
    assert max(map(len, lines)) <= 80
    data = json.loads(out.read_text())["family"]
    rows = [line.split() for line in lines[2 : 2 + len(data["curve"])]]
    for row, point in zip(rows, data["curve"], strict=True):
        assert row[:3] == [str(point["setups"]), format_loss(point["loss"]), str(point["pegs_moved"])]
    assert "3 parts, " in outcome.stdout
    shown = [point for point in data["curve"] if point["setups"] <= 2][-1]
    assert sum(line.startswith("Set-up ") for line in lines) == shown["setups"]
    held = [data["parts"][one["part"]]["name"] for setup in shown["plan"] for one in setup["parts"]]
    assert sorted(held) == sorted(["ell-1.json", "bracket-2.json", "rectangle-3.json"])
    for name in held:
        assert any(line.split()[:1] == [name] for line in lines)
    assert {part["name"] for part in data["left_out"]} == {"disc.json", "odd.dxf"}
    assert all(len(part["hash"]) == 64 for part in data["parts"])
    # The same again is the same, and may be written over.
    text = out.read_bytes()
    assert run("family", drawings, *VISE, "--out", out, "--threads", 1).exit_code == 0
    assert out.read_bytes() == text


def test_a_largest_loss_picks_the_fewest_within_it(run: Any, drawings: Path) -> None:
    files = [drawings / f"{part.name}.json" for part in shop_parts(3)]
    outcome = run("family", *files, *VISE, "--max-loss", "1")
    assert outcome.exit_code == 0, outcome.stderr
    lines = outcome.stdout.splitlines()
    assert lines[2].split()[1] == "1.000" and not lines[3][:1].isspace()
    assert "Set-up 1 of " in outcome.stdout
    assert "See the plan" not in outcome.stdout


def test_without_a_choice_it_is_told_how_to_choose(run: Any, drawings: Path) -> None:
    outcome = run("family", drawings / "ell-1.json", *VISE)
    assert "Show the plan of a line with --setups K" in outcome.stdout
    assert "Set-up" not in outcome.stdout


@pytest.mark.thorough
def test_curve_and_sheets_are_drawn(run: Any, drawings: Path, tmp_path: Path) -> None:
    curve, sheets = tmp_path / "c.png", tmp_path / "s.pdf"
    part = drawings / "ell-1.json"
    for _ in range(2):
        outcome = run("family", part, *VISE, "--setups", 1, "--draw", curve, "--sheets", sheets)
        assert outcome.exit_code == 0, outcome.stderr
    assert curve.read_bytes().startswith(b"\x89PNG") and sheets.read_bytes().startswith(b"%PDF")
    assert f"Written to {curve}, {sheets}." in outcome.stdout
    assert run("family", part, *VISE, "--max-loss", 2, "--sheets", tmp_path / "s.svg").exit_code == 0
    assert "<!-- workhold -->" in (tmp_path / "s.svg").read_text()


def test_rules_reach_every_part(run: Any, drawings: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = asked_by(monkeypatch)
    outcome = run(
        *(
            "family",
            drawings,
            *VISE,
            "--avoid",
            "1",
            "--angle",
            "0..90",
            "--keep-out",
            "circle=1,2,3",
            "--type",
            "II",
        ),
        *(
            "--contact-margin",
            "0.5",
            "--rank-by",
            "closure-margin,tilt",
            "--limit",
            "location-error=0.05",
            "--unfit",
        ),
        *("--time-limit", "3", "--tolerance", "0.02", "--max-loss", "1.5", "--threads", "1"),
    )
    assert outcome.exit_code == 130
    assert len(seen["asked"]) == 4
    for query in (one.query for one in seen["asked"]):
        assert query.restrictions.avoid == (1,) and query.restrictions.angles == ((0.0, 90.0),)
        assert len(query.restrictions.zones) == 1 and query.types == ("II",) and query.contact_margin == 0.5
        assert query.rank_by == ("closure_margin", "tilt") and query.tolerance.peg == 0.02
    (limit,) = seen["thresholds"]
    assert (limit.figure.key, limit.value) == ("location_error", 0.05)
    assert (seen["unfit"], seen["most_loss"], seen["seconds"], seen["threads"]) == (True, 1.5, 3.0, 1)
    assert [one.name for one in seen["left_out"]] == ["odd.dxf"]


def asked_by(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Keep what a family is asked for, and end there."""
    seen: dict[str, Any] = {}

    def family_of(asked: Any, **options: Any) -> Any:
        seen.update(options, asked=asked)
        raise KeyboardInterrupt

    monkeypatch.setattr("workhold.family.family.make_family", family_of)
    return seen


def test_jobs_bring_rules_of_their_own(
    run: Any, drawings: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen = asked_by(monkeypatch)
    jobs = tmp_path / "jobs.toml"
    part = drawings / "ell-1.json"
    jobs.write_text(f'[[job]]\npart = "{part}"\navoid = [2]\n[[job]]\npart = "{part}"\nangle = ["0..90"]\n')
    assert run("family", drawings / "bracket-2.json", jobs, *VISE, "--avoid", "1").exit_code == 130
    told = [(one.name, one.query.restrictions.avoid, one.query.restrictions.angles) for one in seen["asked"]]
    assert told == [
        ("bracket-2.json", (1,), ()),
        ("ell-1.json", (2,), ()),
        ("ell-1.json (2)", (1,), ((0.0, 90.0),)),
    ]
    jobs.write_text(f'toolkit = "plate-20mm"\n[[job]]\npart = "{part}"\n')
    outcome = run("family", jobs, *VISE)
    assert (
        outcome.exit_code == 2
        and "all parts of a family use the toolkit of the command line" in outcome.stderr
    )
    jobs.write_text(f'[[job]]\npart = "{part}"\nrank_by = "tilt"\n[[job]]\npart = "{part}"\n')
    monkeypatch.undo()
    outcome = run("family", jobs, *VISE)
    assert outcome.exit_code == 2 and "the losses of a family are of one figure" in outcome.stderr


def test_both_sides_and_the_zero(run: Any, drawings: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = asked_by(monkeypatch)
    part = drawings / "ell-1.json"
    assert run("family", part, *VISE, "--both-sides", "--same-zero", "--zero", "5,6").exit_code == 130
    one, other = seen["asked"]
    assert (one.name, one.zero.point) == ("ell-1.json", (5.0, 6.0))
    assert (other.name, other.zero.point) == ("ell-1.json, side 2", (-5.0, 6.0))
    assert other.query.workpiece.bounds[0] == -one.query.workpiece.bounds[2]
    assert seen["same_zero"] is True
    assert run("family", part, *VISE).exit_code == 130
    assert len(seen["asked"]) == 1 and seen["same_zero"] is False
    outcome = run("family", part, *VISE, "--zero", "hole 3")
    assert outcome.exit_code == 2 and "ell-1.json: part zero 'hole 3' cannot be used" in outcome.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("none.dxf", *VISE), "file not found"),
        (("widget",), "distance between holes is not given"),
        (("widget", *VISE, "--max-loss", "0.9"), "--max-loss '0.9' is not a loss"),
        (("widget", *VISE, "--limit", "location-error"), "is not a limit: give a figure and its value"),
        (("widget", *VISE, "--limit", "beauty=3"), "'beauty' is not a figure"),
        (("widget", *VISE, "--setups", "0"), "--setups"),
        (("widget", *VISE, "--time-limit", "-1"), "not a positive number"),
        (("widget", *VISE, "--rank-by", "beauty"), "is not a figure to rank by"),
        (("widget", *VISE, "--out", "missing/f.json"), "there is no folder missing"),
        (("widget", *VISE, "--draw", "c.pdf"), "let the name end in .svg or .png"),
        (("widget", *VISE, "--setups", "1", "--sheets", "s.txt"), "let the name end in .pdf, .svg or .png"),
        (("widget", *VISE, "--sheets", "s.pdf"), "--sheets needs a plan: choose one"),
        (("widget", *VISE, "--out", "f.svg", "--draw", "./f.svg"), "named for two outputs"),
        (("odd.dxf", *VISE), "none of the parts can be used: odd.dxf: "),
        (("widget", *VISE, "--type", "III"), "--type"),
    ],
)
def test_refusals(
    run: Any, drawings: Path, monkeypatch: pytest.MonkeyPatch, arguments: Any, message: str
) -> None:
    monkeypatch.chdir(drawings)
    outcome = run("family", *arguments)
    assert outcome.exit_code == 2
    assert message in outcome.stderr and "Traceback" not in outcome.stderr
    assert outcome.stdout == ""


def test_an_input_is_never_written_over(run: Any, drawings: Path) -> None:
    part = drawings / "ell-1.json"
    before = part.read_bytes()
    for arguments in ((drawings, "--out", part, "--force"), ("widget", "--out", drawings / "disc.json")):
        outcome = run("family", *arguments, *VISE)
        assert outcome.exit_code == 2, outcome.stdout
    assert part.read_bytes() == before


def test_too_few_set_ups_are_refused_with_how_many_are_needed(
    run: Any, drawings: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    outcome = run("family", drawings, *VISE, "--max-loss", "1", "--setups", "1")
    assert outcome.exit_code == 2
    assert "1 set-ups cannot hold all parts: at least" in outcome.stderr


def test_losses_are_shown_as_bounds_that_hold() -> None:
    assert [format_loss(loss) for loss in (1.0, 1.0000000001, 1.1871, 2.5, float("inf"))] == [
        *("1.000", "1.000", "1.188", "2.500", "any")
    ]
    assert family_command.read_largest_loss("1.25") == 1.25
