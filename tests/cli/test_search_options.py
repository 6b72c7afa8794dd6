"""What is ruled out, what loads act and how fixtures are ranked reaches the search as it was typed."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from workhold import Load, Tolerance
from workhold.fixels.carrier import HoleSelection
from workhold.model.requirements import ANY_DIRECTION

WIDGET = ("design", "widget", "--pitch", "10", "--columns", "2", "--peg-radius", "3")


def test_restrictions_reach_the_search(run: Any, searched: dict[str, Any]) -> None:
    """Faces, zones, angles, blocked holes and bodies; lengths in the unit that was asked for."""
    words = [
        "--avoid",
        "3,7",
        "--avoid",
        "1",
        "--keep-out",
        "circle=1,2,3",
        "--keep-out",
        "polygon=0,0;4,0;4,25.4mm",
    ]
    words += [
        "--angle",
        "-10..20",
        "--angle",
        "90",
        "--blocked",
        "L-B3,R-A",
        "--body-radius",
        "0.15",
        "--unit",
        "inch",
    ]
    inches = ("design", "widget", "--pitch", "0.4", "--columns", "2", "--peg-radius", "0.1")
    assert run(*inches, *words).exit_code == 0
    asked = searched["asked"]
    restrictions = asked.restrictions
    assert restrictions.avoid == (1, 3, 7)
    assert restrictions.angles == ((-10.0, 20.0), (90.0, 90.0))
    circle, polygon = (zone.loop for zone in restrictions.zones)
    assert circle[:, :2].tolist() == [pytest.approx([-50.8, 50.8]), pytest.approx([101.6, 50.8])]
    assert polygon[2, :2].tolist() == pytest.approx([101.6, 25.4])
    assert asked.toolkit.blocked == (HoleSelection("left", 1, 2), HoleSelection("right", 0, None))
    assert asked.toolkit.body_radius == pytest.approx(3.81)


def test_a_load_far_from_the_part_is_remarked_upon(run: Any, searched: dict[str, Any]) -> None:
    """One that acts a metre off, not one that acts just beside the part."""
    near, far = ("force=20 at=-5,-5", "force=20 path=10,5;1000,5")
    outcome = run(*WIDGET, "--load", near, "--load", far)
    assert outcome.exit_code == 0 and "Load 2 acts at (1000, 5)" in outcome.stderr
    assert "Load 1" not in outcome.stderr


def test_loads_ranking_and_tolerance_reach_the_search(
    run: Any, searched: dict[str, Any], tmp_path: Path
) -> None:
    """From the command line and from a file."""
    (tmp_path / "loads.toml").write_text('[[load]]\nname = "drill"\nmoment = 5000\n')
    words = ["--load", "force=200 at=10,5 direction=30..60", "--loads", tmp_path / "loads.toml"]
    assert (
        run(*WIDGET, *words, "--rank-by", "load-reaction,end-distance", "--tolerance", "0.02,0.05").exit_code
        == 0
    )
    asked = searched["asked"]
    first, second = asked.loads
    assert (first.force, first.points, first.directions) == (200.0, ((10.0, 5.0),), (30.0, 60.0))
    assert (second.name, second.moment) == ("drill", 5000.0)
    assert asked.rank_by == ("load_reaction", "end_distance")
    assert asked.tolerance == Tolerance(0.02, 0.05)


def test_a_named_vise_brings_its_tolerance_and_gives_way_to_options(
    run: Any, searched: dict[str, Any]
) -> None:
    """What is typed wins over what the vise says."""
    assert (
        run("design", "widget", "--vise", "plate-20mm", "--columns", "3", "--min-opening", "44").exit_code
        == 0
    )
    vise, tolerance = searched["asked"].toolkit, searched["asked"].tolerance
    assert (vise.pitch, vise.columns, vise.min_gap) == ((20.0, 20.0), 3, 44.0)
    assert tolerance != Tolerance()
    assert tolerance.fit is not None and tolerance.fit.standard == "ASME B18.8.5M"
    assert run("design", "widget", "--vise", "plate-20mm", "--tolerance", "0.02").exit_code == 0
    assert searched["asked"].tolerance == Tolerance(0.02, 0.02, tolerance.fit)
    assert run("design", "widget", "--vise", "plate-20mm", "--peg-radius", "4").exit_code == 0
    assert searched["asked"].tolerance.fit is None


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--avoid", "x"), "--avoid 'x' is not a whole number"),
        (("--keep-out", "square=1,2"), "--keep-out 'square=1,2' is not a zone: give circle=X,Y,RADIUS"),
        (("--keep-out", "circle=1,2,0"), "give a positive radius"),
        (("--keep-out", "circle=1,2,wide"), "--keep-out 'wide' is not a length"),
        (("--angle", "steep"), "--angle 'steep' is not a range of angles"),
        (("--angle", "20..10"), "give the smaller first"),
        (("--blocked", "B3"), "'B3' names no hole"),
        (("--blocked", "L-D1"), "L-D1 is blocked, but each jaw has only 2 columns"),
        (("--body-radius", "1"), "body radius 1 is less than the peg radius 3"),
        (("--rank-by", "beauty"), "'beauty' is not a figure to rank by"),
        (("--rank-by", "load-reaction"), "there is no load"),
        (("--tolerance", "1,2,3"), "has 3 numbers"),
        (("--tolerance", "-1"), "tolerance -1.0 is not a length"),
        (("--load", "force=200"), "load"),
        (("--loads", "none.toml"), "there is no file of that name"),
        (("--vise", "plate-21mm"), "plate-20mm"),
    ],
)
def test_what_cannot_be_asked_is_refused_in_a_sentence(
    run: Any, searched: dict[str, Any], words: tuple[str, ...], message: str
) -> None:
    """Before any search, with exit code 2."""
    outcome = run(*WIDGET, *words)
    assert outcome.exit_code == 2 and searched["asked"] is None
    assert message in outcome.stderr and outcome.stderr.count("\n") == 1


def test_a_vise_that_is_not_described_is_asked_for(run: Any) -> None:
    """Naming the option, and the other way."""
    outcome = run("design", "widget", "--pitch", "10", "--columns", "2")
    assert outcome.exit_code == 2
    assert "add --peg-radius, or name a vise with --toolkit" in outcome.stderr


@pytest.mark.parametrize(
    "words", [("--avoid", "99"), ("--keep-out", "circle=0,0,500"), ("--avoid", ",".join(map(str, range(16))))]
)
def test_nothing_left_to_touch_is_refused(run: Any, words: tuple[str, ...]) -> None:
    """Faces that do not exist and zones that cover everything: one sentence."""
    outcome = run(*WIDGET, *words)
    assert outcome.exit_code == 2
    assert outcome.stderr.count("\n") == 1 and outcome.stderr.startswith("workhold: error: ")


@pytest.mark.thorough
def test_no_fixture_is_explained_and_the_nearest_miss_drawn(run: Any, tmp_path: Path) -> None:
    """The rule that left nothing, and a picture of what came nearest."""
    outcome = run(*WIDGET, "--min-gap", "300", "--draw", tmp_path)
    assert outcome.exit_code == 0
    assert "The rule that removed the last of them: smallest gap." in outcome.stdout
    assert "with a smallest gap of 6 mm" in outcome.stdout
    assert sorted(path.name for path in tmp_path.iterdir()) == ["nearest-miss.png", "nearest-miss.svg"]


def test_explore_lists_every_toolkit(run: Any, tmp_path: Path) -> None:
    """With counts as a design of its own finds them, the toolkits that cannot be, and the best."""
    table = tmp_path / "table.csv"
    words = [
        "--pitch",
        "8,10x12,5",
        "--columns",
        "1",
        "--peg-radius",
        "3",
        "--out",
        table,
        "--rank-by",
        "end-distance",
    ]
    outcome = run("explore", "widget", *words)
    assert outcome.exit_code == 0
    rows = [line.split(",") for line in table.read_text().splitlines()]
    assert rows[0][:4] == ["toolkit", "fixtures", "estimated", "type_I"]
    assert len(rows) == 4
    assert "505" in outcome.stdout and "pegs of radius 3 overlap" in outcome.stdout
    assert "First choice: pitch" in outcome.stdout and re.search(
        r"its first fixture has end distance \d+\.\d+ mm, ", outcome.stdout
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--pitch", "8"), "a list of pitches alone makes no vise"),
        (("--pitch", "8,,9", "--columns", "1", "--peg-radius", "3"), "has an empty entry"),
        (("--vise", "plate-99mm"), "plate-99mm"),
        (("--avoid", "99"), "has no face 99"),
        (("--columns", ",".join(map(str, range(1, 400)))), "combine to"),
    ],
)
def test_explore_refuses_in_a_sentence(run: Any, words: tuple[str, ...], message: str) -> None:
    """Exit code 2 before any search."""
    outcome = run("explore", "widget", *words)
    assert outcome.exit_code == 2
    assert message in outcome.stderr and outcome.stderr.count("\n") == 1


# ``--load``: what a user may type, and what is said when it cannot be used.
@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    ("text", "load"),
    [
        ("force=200 at=10,5 direction=30..60", Load([(10, 5)], 200, (30, 60))),
        ("force=200 at=10,5", Load([(10, 5)], 200, ANY_DIRECTION)),
        ("force=200 at=10,5 direction=any", Load([(10, 5)], 200, ANY_DIRECTION)),
        ("force=200 at=10,5 direction=0..360", Load([(10, 5)], 200, ANY_DIRECTION)),
        ("force=200 at=10,5 direction=90", Load([(10, 5)], 200, (90, 90))),
        ("force=200 at=-10,.5 direction=-30..30", Load([(-10, 0.5)], 200, (330, 390))),
        ("force=200 at=10,5 direction=350..10", Load([(10, 5)], 200, (350, 370))),
        ("moment=5000", Load(moment=5000)),
        ("moment=-5N.m", Load(moment=-5000)),
        ("moment=5N·m", Load(moment=5000)),
        ("force=0.2kN at=1,2 moment=3", Load([(1, 2)], 200, moment=3)),
        ("force=150 path=0,0;40,0;40,20", Load([(0, 0), (40, 0), (40, 20)], 150)),
        ("name='rough cut' force=1.5e2 at=1,1", Load([(1, 1)], 150, name="rough cut")),
    ],
)
def test_what_may_be_typed(run: Any, searched: dict[str, Any], text: str, load: Load) -> None:
    """Each text is the load it describes."""
    assert run(*WIDGET, "--load", text).exit_code == 0
    assert searched["asked"].loads == (load,)


def test_lengths_are_in_the_users_unit(run: Any, searched: dict[str, Any]) -> None:
    """Points are scaled; force, direction and moment are not."""
    words = ("design", "widget", "--vise", "plate-20mm", "--unit", "inch")
    assert run(*words, "--load", "force=2 at=1,2 direction=30 moment=5").exit_code == 0
    assert searched["asked"].loads == (Load([(25.4, 50.8)], 2, (30, 30), 5),)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "does nothing"),
        ("force=200", "needs the point it acts at"),
        ("force=200 N at=1,1", "cannot be used at 'N'"),
        ("force=200 at=10", "at '10' is not a point"),
        ("force=200 at=10;5", "at '10;5' is not a point"),
        ("force=200 at=10mm,5", "is not a point"),
        ("force=200 at=10,5 direction=1..2..3", "direction '1..2..3' cannot be used"),
        ("force=200 at=10,5 direction=0..361", "at most 360 degrees"),
        ("force=two at=10,5", "force 'two' cannot be used"),
        ("force=200 force=300 at=10,5", "has force twice"),
        ("power=200", "unknown key 'power'"),
        ("direction=30", "has direction but no force"),
        ("name='rough", "quote that is not closed"),
        ("force=1_000 at=0,0", "force '1_000' cannot be used"),
        ("force=200 path=0,0", "path '0,0' is not a path"),
    ],
)
def test_bad_loads_are_refused_in_one_sentence(
    run: Any, searched: dict[str, Any], text: str, said: str
) -> None:
    """The message shows what was typed and says what to type."""
    message = run(*WIDGET, "--load", text).stderr.removeprefix("workhold: error: ")
    assert said in message and message.startswith(f'--load "{text}"')
    assert message.endswith(".\n") and message.count("\n") == 1 and searched["asked"] is None
