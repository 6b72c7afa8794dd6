"""Results of a plate with a translating clamp: true ones are proven, and each rule that is broken is named."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import attrs
import pytest

import check_toolkit
import workhold
from judged import faults_of, known_in, place_in_order, posed, rules_in
from strategies import random_outline
from toolkit_results import assert_all_proven, part, verify_edited
from undecided_examples import as_undecided
from workhold import (
    Fixture,
    InputError,
    Load,
    Plate,
    Pose,
    Query,
    Restrictions,
    Result,
    answer,
    circle_zone,
    design,
)
from workhold.files.result.writer import make_notes_entry
from workhold.listing.results import join_ways
from workhold.model.notes import STAGES, LeftUndecided, NoFixture
from workhold.model.quality import FIGURE_RANKING
from workhold.model.search_report import GIVEN_UP, UndecidedCandidate
from workhold.verification import Verification, verify, verify_file, verify_fixture
from workhold.verification.ball_geometry import BallOutline

Data = dict[str, Any]
Edit = Callable[[Data], object]

NOTCHED = [[0, 0, 0], [58, 0, 0], [58, 26, 0], [44, 40, 0], [20, 40, 0.3], [0, 40, 0]]
POCKETED = [
    [0, 0, 0],
    [70, 0, 0],
    [76, 44, 0],
    [52, 44, 0],
    [52, 20, 0],
    [24, 20, 0],
    [20, 44, 0],
    [-3, 44, 0],
]
LIMITED = Plate((20, 16), 3, columns=7, rows=7, clamp_radius=4, travel=(4, 26), directions=("-x", "+y"))


@pytest.fixture(scope="module")
def result() -> Result:
    """The best fixtures of a part on a plate with limits, a stroke, a thick clamp and two directions."""
    return design(part(NOTCHED), LIMITED, best=40)


@pytest.fixture(scope="module")
def data(result: Result, tmp_path_factory: pytest.TempPathFactory) -> Data:
    """The JSON of its file."""
    return written(result, tmp_path_factory.mktemp("plate") / "r.json")


def written(result: Result, path: Path) -> Data:
    """The JSON of the file of a result."""
    workhold.save(result, path)
    content: Data = json.loads(path.read_text())
    return content


@pytest.fixture
def edited(data: Data, tmp_path: Path) -> Callable[[Edit], Verification]:
    """Verify that file after an edit of its JSON."""

    return lambda edit: verify_edited(data, edit, tmp_path)


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("loop", "fields", "asked"),
    [
        (NOTCHED, {"pitch": 20}, {}),
        (NOTCHED, {"pitch": (20, 16), "clamp_radius": 6.5}, {"contact_margin": 0.5}),
        (NOTCHED, {"pitch": (20, 16), "directions": ("+x", "+y")}, {"best": 25, "rank_by": "location-error"}),
        (NOTCHED, {"pitch": 20, "columns": 4, "rows": 3, "travel": (4, 24)}, {"best": 60}),
        (POCKETED, {"pitch": 12, "clamp_radius": 1.5, "travel": (0, 40), "directions": "+y"}, {"best": 60}),
        (POCKETED, {"pitch": 16, "travel": (20, 30)}, {"loads": [Load(((30.0, 10.0),), 200.0)], "best": 60}),
        (
            NOTCHED,
            {"pitch": 20, "travel": (0, 30)},
            {"restrictions": Restrictions((3,), (circle_zone(58.0, 12.0, 4.0),), ((-170.0, 60.0),))},
        ),
    ],
)
def test_everything_a_search_lists_is_proven(loop: Any, fields: Data, asked: Data, tmp_path: Path) -> None:
    """As a result and in files of both forms, which say the same; and so it is when it is searched again."""
    result = design(part(loop), Plate(peg_radius=3, **fields), **asked)
    assert len(result) >= 10
    assert_all_proven(result, tmp_path, search_files=True)


def fixture_with(data: Data, direction: str) -> Data:
    """The first fixture whose clamp moves in a direction."""
    found: Data = next(fixture for fixture in data["fixtures"] if fixture["direction"] == direction)
    return found


def shifted(fixture: Data, columns: int, rows: int) -> None:
    """A fixture moved by whole holes, with the holes that are told."""
    for peg in fixture["pegs"]:
        peg["x"] += 20.0 * columns
        peg["y"] += 16.0 * rows
        for name, by in (("column", columns), ("row", rows)):
            if name in peg:
                peg[name] += by
    fixture["pegs"][3]["hole"][0] += columns
    fixture["pegs"][3]["hole"][1] += rows
    fixture["pose"]["x"] += 20.0 * columns
    fixture["pose"]["y"] += 16.0 * rows


def bolted_elsewhere(fixture: Data, holes: int) -> None:
    """The clamp bolted so many holes farther from its tip; everything moved so that the lowest numbers are 0."""
    axis = 0 if fixture["direction"][1] == "x" else 1
    fixture["pegs"][3]["hole"][axis] += holes * (1 if fixture["direction"][0] == "-" else -1)
    numbers = [peg[("column", "row")[axis]] for peg in fixture["pegs"][:3]] + [
        fixture["pegs"][3]["hole"][axis]
    ]
    shifted(fixture, *((-min(numbers), 0) if axis == 0 else (0, -min(numbers))))


def swap_roles(fixture: Data) -> None:
    """The pegs in another order."""
    fixture["pegs"] = fixture["pegs"][1:] + fixture["pegs"][:1]


BROKEN: list[tuple[Callable[[Data], object], str]] = [
    (lambda f: f["pegs"].__setitem__(1, dict(f["pegs"][0])), "two locators are in the same hole"),
    (swap_roles, "its pegs are not three locators and then a clamp"),
    (lambda f: f["pegs"][1].update(x=f["pegs"][1]["x"] + 2e-6), "the x of locator 2 is"),
    (lambda f: f["pegs"][2].update(row=f["pegs"][2]["row"] + 1), "the y of locator 3 is"),
    (lambda f: f["pegs"][3].update(y=f["pegs"][3]["y"] + 2e-6), "the y of the clamp is"),
    (
        lambda f: f["pegs"][3].update(x=f["pegs"][3]["x"] + 3e-6),
        "the place of the clamp's tip on its line in the file is 3e-06 mm from the one that touches",
    ),
    (lambda f: f["pegs"][3].update(x=f["pegs"][3]["x"] + 1e-5), "the clamp is"),
    (lambda f: f["pegs"][3].update(x=f["pegs"][3]["x"] + 0.5), "the clamp is"),
    (lambda f: f["pegs"][3].update(hole=None), "the clamp is not named by the hole in which it is bolted"),
    (lambda f: shifted(f, 1, 0), "its lowest column is 1, and not 0"),
    (lambda f: shifted(f, 0, 1), "its lowest row is 1, and not 0"),
    (lambda f: shifted(f, -1, 0), "is in column -1 of a plate with 7 columns"),
    (lambda f: f["pegs"][0].update(segment=77), "locator 1 is on segment 77, which does not name a face"),
    (lambda f: f["pegs"][0].update(segment=f["pegs"][3]["segment"]), "locator 1 is"),
    (lambda f: f["pegs"][0].update(force=f["pegs"][0]["force"] + 1e-5), "the force of locator 1 is"),
    (lambda f: f["pegs"][3].update(force=f["pegs"][3]["force"] + 1e-5), "the force of the clamp is"),
    (
        lambda f: f["pose"].update(theta_deg=f["pose"]["theta_deg"] + 2e-6),
        "degrees from the one that touches",
    ),
    (lambda f: f["pose"].update(x=f["pose"]["x"] + 3e-6), "mm away from touching face"),
    (
        lambda f: f["quality"].update(closure_margin=f["quality"]["closure_margin"] + 1e-6),
        "its closure margin is",
    ),
    (lambda f: bolted_elsewhere(f, 2), "beyond the 26 mm of its stroke"),
    (lambda f: bolted_elsewhere(f, -2), "nearer than the 4 mm of its stroke"),
]


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("edit", "words"), BROKEN, ids=[f"{n} {words}" for n, (_, words) in enumerate(BROKEN)]
)
def test_what_is_broken_by_hand_is_named(
    edited: Any, data: Data, edit: Callable[[Data], object], words: str
) -> None:
    """Of one fixture of those whose clamp moves in -x; the others stay proven."""
    outcome = edited(lambda content: edit(fixture_with(content, "-x")))
    first = data["fixtures"].index(fixture_with(data, "-x"))
    ((index, verdict, reason),) = [attrs.astuple(item) for item in outcome.unproven]
    assert (index, verdict) == (first, "refuted")
    assert words in reason
    assert outcome.proven == len(data["fixtures"]) - 1


TOOLKITS: list[tuple[Data, str]] = [
    ({"columns": 2}, "of a plate with 2 columns"),
    ({"rows": 2}, "of a plate with 2 rows"),
    ({"pitch": [20.00001, 16.0]}, "mm from that of its hole"),
    ({"peg_radius": 3.001}, "away from touching face"),
    ({"clamp_radius": 4.001}, "the clamp is -0.001 mm away from touching face"),
    ({"directions": ["-x"]}, "its clamp moves in +y, which is not asked for"),
    ({"directions": ["+y"]}, "its clamp moves in -x, which is not asked for"),
    ({"travel": None}, "the clamp is not named by the line alone, since it has no travel"),
    ({"travel": [25.9, 26.0]}, "nearer than the 25.9 mm of its stroke"),
    ({"travel": [4.0, 4.1]}, "beyond the 4.1 mm of its stroke"),
    ({"travel": [0.0, 26.0]}, "the clamp could be bolted one hole nearer"),
]


@pytest.mark.thorough
@pytest.mark.parametrize(("fields", "words"), TOOLKITS, ids=[str(fields) for fields, _ in TOOLKITS])
def test_another_plate(edited: Any, fields: Data, words: str) -> None:
    """What is listed does not stand on it, and the sentence says why."""
    outcome = edited(lambda content: content["toolkit"].update(fields))
    assert any(words in item.reason and item.verdict == "refuted" for item in outcome.unproven), (
        outcome.unproven
    )


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda f: f.pop("direction"), "the key jaw is missing"),
        (lambda f: f.update(direction="x"), r"its direction is not -x or \+x or -y or \+y"),
        (lambda f: f.update(type="I"), "its type is not clamp"),
        (lambda f: f["pegs"][3].pop("hole"), "the key hole is missing"),
        (lambda f: f["pegs"][3].update(hole=[1]), "is not a column and a row"),
        (lambda f: f["pegs"][3].update(hole=[1, 0.5]), "row is 0.5, not a whole number"),
        (
            lambda f: f["pegs"][3].update(row=f["pegs"][3]["row"] + 1),
            "the row of its clamp is not that of its hole",
        ),
        (lambda f: f["pegs"][1].update(role="stop"), "neither locator nor clamp"),
        (lambda f: f["pegs"][1].pop("column"), "the key column is missing"),
        (lambda f: f["pegs"].pop(), "it does not have four pegs"),
    ],
)
def test_files_with_something_unusable(edited: Any, edit: Callable[[Data], object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        edited(lambda content: edit(fixture_with(content, "-x")))


def test_a_vise_does_not_list_clamps(edited: Any) -> None:
    """Nor a plate what stands in jaws."""
    vise = {"kind": "opening-vise", "pitch": [20, 16], "columns": 5, "peg_radius": 3}

    def edit(content: Data) -> None:
        content.update(toolkit=vise, types=["I", "II"])
        for key in ("counts", "found", "distinct"):
            content[key] = {"I": 0, "II": 0}

    with pytest.raises(InputError, match="fixture 1 cannot be used: its type is not I or II"):
        edited(edit)


@pytest.mark.thorough
def test_the_account_is_held_to_what_is_listed(edited: Any) -> None:
    """Counts, order, repetitions, notes and the proof."""

    def told(edit: Edit) -> str:
        outcome: Verification = edited(edit)
        return "; ".join((*outcome.faults, *(item.reason for item in outcome.unproven)))

    assert told(lambda content: None) == ""
    assert "counts say 41 fixtures of type clamp" in told(lambda content: content["counts"].update(clamp=41))
    assert "found says 5 fixtures" in told(lambda content: content["found"].update(clamp=5))
    assert "is the same as fixture 1" in told(
        lambda content: content["fixtures"].append(content["fixtures"][0])
    )
    assert "is better than the one before it" in told(lambda content: content["fixtures"].reverse())
    assert "candidates, but" in told(lambda content: content["proof"].update(verified=3))
    reasons = [NoFixture(stage, LIMITED.wording) for stage in STAGES]
    wrong = make_notes_entry(reasons[3:])
    assert "does not follow" in told(lambda content: [content[key].extend(wrong[key]) for key in wrong])
    assert "jaw" not in "".join(map(str, reasons)) and "gap" not in str(reasons[3])


def as_listed(fixture: Fixture, bolted: bool) -> Data:
    """A fixture in the form of the result file, for the independent checker."""
    direction = fixture.direction or ""
    pegs = [
        {
            "role": "locator",
            "column": p.column,
            "row": p.row,
            "x": p.x,
            "y": p.y,
            "segment": p.face,
            "force": p.force,
        }
        for p in fixture.pegs[:3]
    ]
    clamp = fixture.pegs[3]
    line = {"row": clamp.row} if direction[1] == "x" else {"column": clamp.column}
    hole = [clamp.column, clamp.row] if bolted else None
    pegs.append(
        line
        | {
            "role": "clamp",
            "hole": hole,
            "x": clamp.x,
            "y": clamp.y,
            "segment": clamp.face,
            "force": clamp.force,
        }
    )
    pose = {"theta_deg": fixture.pose.theta_deg, "x": fixture.pose.x, "y": fixture.pose.y}
    return {"type": "clamp", "direction": direction, "pegs": pegs, "pose": pose}


def fields_of(plate: Plate) -> Data:
    """A plate in the form of the result file."""
    return {"kind": plate.kind} | attrs.asdict(plate)


def bolted_in(fixture: Fixture, hole: tuple[int, int], plate: Plate) -> Fixture:
    """A fixture of a clamp without a hole, bolted in one, the lowest column and row of all 0."""
    columns = min(hole[0], *(peg.column for peg in fixture.pegs[:3]))
    rows = min(hole[1], *(peg.row for peg in fixture.pegs[:3]))
    x, y = plate.pitch[0] * columns, plate.pitch[1] * rows
    moved = [
        attrs.evolve(peg, column=column - columns, row=row - rows, x=peg.x - x, y=peg.y - y)
        for peg in fixture.pegs
        for column, row in [hole if peg is fixture.pegs[3] else (peg.column, peg.row)]
    ]
    clamp, carrier = moved[3], plate.find_carrier(moved[3].carrier)
    at_hole = carrier.compute_hole_center(clamp.column, clamp.row)
    along, across = carrier.travel.unit  # type: ignore[union-attr]
    travel = (clamp.x - at_hole[0]) * along + (clamp.y - at_hole[1]) * across
    if min(clamp.column, clamp.row) >= 0:
        moved[3] = attrs.evolve(clamp, place=carrier.name_place(clamp.column, clamp.row))
    pose = attrs.evolve(fixture.pose, x=fixture.pose.x - x, y=fixture.pose.y - y)
    return attrs.evolve(fixture, pegs=tuple(moved), pose=pose, travel=travel, quality={})


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("loop", "limits"),
    [
        (POCKETED, {"travel": (0.0, 60.0), "clamp_radius": 6.0}),
        (POCKETED, {"travel": (7.0, 70.0), "columns": 5, "rows": 5}),
        (NOTCHED, {"travel": (0.0, 60.0), "columns": 5, "rows": 5, "clamp_radius": 5.0}),
    ],
)
def test_in_which_hole_a_clamp_is_bolted(loop: Any, limits: Data) -> None:
    """Of all holes behind the tips of fixtures without a stroke, proven is just the nearest of those from which
    the independent checker lets the clamp reach its place: its body in the part or in a locator, holes off the plate."""
    free = Plate((16, 14), 3, directions=("-x", "+y"), clamp_radius=limits.get("clamp_radius"))
    plate = attrs.evolve(free, **limits)
    workpiece, fields, outline = part(loop), fields_of(plate), check_toolkit.Part(loops_of(loop))
    seen, random = {"proven": 0, "none": 0, "not the nearest": 0}, Random(3)
    fixtures = list(design(workpiece, free, rank_by=FIGURE_RANKING))
    for fixture in random.sample(fixtures, 60):
        tip, way = fixture.pegs[3], (1, 0) if fixture.direction == "-x" else (0, -1)
        axis = 0 if way[0] else 1
        first = round((tip.x, tip.y)[axis] / plate.pitch[axis])
        fitting = None
        for step in range(-1, 6):
            hole = (first + step * way[0], tip.row) if axis == 0 else (tip.column, first + step * way[1])
            one = bolted_in(fixture, hole, plate)
            faults, marginal = check_toolkit.check_clamp(as_listed(one, True), fields, outline)
            ruling = verify_fixture(one, workpiece, plate)
            if marginal and not faults:
                continue
            expected = "refuted" if faults or fitting is not None else "proven"
            assert ruling.verdict == expected, (one, faults, ruling)
            if fitting is not None and not faults:
                assert "could be bolted one hole nearer" in ruling.reason
                seen["not the nearest"] += 1
            if not faults and fitting is None:
                fitting = hole
        seen["proven" if fitting else "none"] += 1
    assert min(seen.values()) >= 3, seen


def loops_of(loop: list[list[float]]) -> list[list[list[float]]]:
    """The loops of a part as it is used."""
    return [used.tolist() for used in part(loop).loops]


def test_the_half_turn_and_other_names_are_the_same(result: Result) -> None:
    """A fixture moved by whole holes, with its locators renamed, or on the plate turned half way round, is the same."""
    seen = known_in(result.toolkit)
    for index, fixture in enumerate(result):
        assert seen.add(index, fixture) is None
    opposite = {"-x": "+x", "+x": "-x", "-y": "+y", "+y": "-y"}
    for index, fixture in enumerate(result):
        *locators, clamp = fixture.pegs
        renamed = attrs.evolve(fixture, pegs=(*locators[::-1], clamp))
        assert seen.find(renamed) == index
        pegs = [attrs.evolve(p, column=-p.column, row=-p.row, x=-p.x, y=-p.y) for p in fixture.pegs]
        direction = opposite[fixture.direction or ""]
        pegs[3] = attrs.evolve(pegs[3], carrier=f"clamp {direction}")
        pose = Pose(fixture.pose.theta_deg + 180.0, -fixture.pose.x, -fixture.pose.y)
        turned = attrs.evolve(fixture, pegs=tuple(pegs), pose=pose, direction=direction)
        assert seen.find(turned) == index
        moved = attrs.evolve(fixture, pose=attrs.evolve(fixture.pose, x=fixture.pose.x + 0.01))
        assert seen.find(moved) is None
        assert seen.find(attrs.evolve(fixture, direction=direction)) is None


def test_a_clamp_that_would_have_to_pull_is_refuted() -> None:
    """The same contacts with the clamp moving the other way along its line."""
    workpiece = part(NOTCHED)
    plate, turned = (Plate(20, 3, directions=direction) for direction in ("-x", "+x"))
    fixtures = list(design(workpiece, plate))[:10]
    for fixture in fixtures:
        clamp = attrs.evolve(fixture.pegs[3], carrier="clamp +x")
        pegs = (*fixture.pegs[:3], clamp)
        other = attrs.evolve(fixture, pegs=pegs, direction="+x", travel=-fixture.travel, quality={})
        assert verify_fixture(fixture, workpiece, plate).verdict == "proven"
        assert "the clamp does not push the part" in verify_fixture(other, workpiece, turned).reason
        assert "which is not asked for" in verify_fixture(other, workpiece, plate).reason


@pytest.mark.parametrize(
    ("column", "row", "pitch_y", "radius", "meets"),
    [
        (5, 1, 5.0, 3.0, False),
        (5, 1, 4.999, 3.0, True),
        (4, 0, 5.0, 8.0, False),
        (4, 0, 5.0, 8.001, True),
        (7, 0, 5.0, 8.0, False),
        (7, 0, 5.0, 8.001, True),
    ],
)
def test_a_clamp_keeps_its_distance_from_locators(
    column: int, row: int, pitch_y: float, radius: float, meets: bool
) -> None:
    """A locator of 2 mm beside the body from hole G1 at x = 60 to the tip at 50, before the tip and behind the hole."""
    hardware = rules_in(Plate((10, pitch_y), 2, clamp_radius=radius, travel=(0, 30)))
    pegs = [workhold.Peg("plate", k, 40, 0.0, 0.0, 0, 1.0) for k in (0, 1)]
    pegs += [
        workhold.Peg("plate", column, row, 0.0, 0.0, 0, 1.0),
        workhold.Peg("clamp -x", 6, 0, 50.0, 0.0, 0, 1.0),
    ]
    fixture = Fixture("clamp", tuple(pegs), Pose(0.0, 0.0, 0.0), -10.0, {}, "-x")
    outline = BallOutline.from_workpiece(part([[x + 500.0, y, b] for x, y, b in NOTCHED]))
    contacts = [hardware.make_contact(peg, outline.faces[0]) for peg in pegs]
    at = posed(-10)
    said = [found.reason for found in hardware.judge_standing(fixture, contacts, at, outline)]
    # It could be bolted at its tip, in F1.
    assert [reason for reason in said if "locator 3" in reason] == [
        reason for reason in said if "meets" in reason
    ]
    assert any("meets locator 3" in reason for reason in said) == meets, said


def test_the_order_is_that_of_the_plate_turned_to_the_clamp() -> None:
    """A clamp along -y on one pitch stands in the order of one along -x on the other."""
    workpiece = part(NOTCHED)
    upright, lying = Plate((14, 20), 3, directions="-y"), Plate((20, 14), 3, directions="-x")
    one, other = (
        [place_in_order(f, plate) for f in design(workpiece, plate, rank_by=FIGURE_RANKING)]
        for plate in (upright, lying)
    )
    assert len(one) == len(other) > 10
    for ((_, kind, *holes), angle, faces), ((_, second, *others), theta, touched) in zip(
        one, other, strict=True
    ):
        assert (kind, second) == (2, 0)
        assert (holes, faces) == (others, touched)
        assert angle == pytest.approx(theta, abs=1e-9)


def test_undecided_entries_are_real_places(result: Result) -> None:
    """Where fixtures are there may be undecided ones; not at another orientation, in other holes or of another type."""

    def faults(entry: UndecidedCandidate) -> list[str]:
        return faults_of([entry], result.query)

    tried = 0
    for fixture in result:
        entry = as_undecided(fixture)
        assert faults(entry) == []
        assert (
            "is not a place where"
            in faults(attrs.evolve(entry, theta_deg=(entry.theta_deg + 1e-3) % 360.0))[0]
        )
        # Two locators on one face, or on parallel ones, may slide together, and the third one then fits in other holes, too.
        square = abs((fixture.pose.theta_deg + 45.0) % 90.0 - 45.0) < 1e-6
        slides = square or len(set(entry.faces[:3])) < 3
        for key, peg in ((key, peg) for key in ("columns", "rows") for peg in (1, 2) if not slides):
            numbers = list(getattr(entry, key))
            numbers[peg] += 1
            assert faults(attrs.evolve(entry, **{key: tuple(numbers)}))
            tried += 1
        chords = attrs.evolve(
            entry,
            faces=tuple(entry.faces[k] for k in (0, 1, 0, 2)),
            columns=tuple(entry.columns[k] for k in (0, 1, 0, 2)),
            rows=tuple(entry.rows[k] for k in (0, 1, 0, 2)),
            reason=GIVEN_UP,
        )
        assert faults(chords) == []
        other = "clamp +y" if fixture.direction == "-x" else "clamp -x"
        assert faults(attrs.evolve(entry, type=other))
        for kind in ("clamp", "clamp -y", "I"):
            assert f"is of type {kind}, which is not asked for" in faults(attrs.evolve(entry, type=kind))[0]
        far = attrs.evolve(entry, columns=(0, 9, *entry.columns[2:]))
        assert any(f"spans 10 {noun} of a plate with 7" in faults(far)[0] for noun in ("columns", "rows"))
    assert tried >= 8


@pytest.mark.thorough
def test_results_of_several_directions_say_what_is_so_of_all() -> None:
    """What is undecided is counted together; a direction without a fixture is not told where another has some."""
    query = Query(part(NOTCHED), LIMITED)
    one, other = (answer(attrs.evolve(query, toolkit=way)) for way in LIMITED.ways)
    assert one.proof is not None and other.proof is not None
    lost = [
        attrs.evolve(
            r,
            notes=(LeftUndecided(1),),
            proof=attrs.evolve(
                r.proof, undecided=(as_undecided(r[0]),), candidates=r.proof.candidates + 1, escalated=9
            ),
        )
        for r in (one, other)
    ]
    both = join_ways(lost, query)
    assert both.notes == (LeftUndecided(2),)
    assert verify(both).faults == ()
    reason, counts = (NoFixture("hold", LIMITED.wording),), {"clamp": 0}
    none = attrs.evolve(one, table=one.table.take(slice(0, 0)), found=counts, distinct=counts, notes=reason)
    assert join_ways([none, other], query).notes == ()
    nothing = [attrs.evolve(none, proof=attrs.evolve(one.proof, verified=0))] * 2
    assert join_ways(nothing, query).notes == reason


def agrees_with_the_checker(seed: int, path: Path) -> int:
    """How many fixtures of a random part on a random plate there are; all are proven, and pass the independent checker."""
    random = Random(seed)
    workpiece = random_outline(random, 3 + seed % 6)
    pitch = random.choice([(20.0, 20.0), (16.0, 22.0), (25.0, 25.0)])
    radius = random.choice([0.5, 2.0, 3.5])
    plate = Plate(
        pitch,
        radius,
        columns=random.choice([None, None, 4, 6]),
        rows=random.choice([None, None, 3, 5]),
        clamp_radius=random.choice([None, 1.0, 6.0]),
        travel=random.choice([None, (0.0, 30.0), (6.0, 40.0), (15.0, 15.0)]),
        directions=random.choice([None, ["-y"], ["+x", "+y"]]),
    )
    try:
        result = design(workpiece, plate, contact_margin=random.choice([0.0, 0.0, 0.7]), best=150)
    except InputError:
        return 0
    workhold.save(result, path)
    outcome = verify_file(path)
    assert (outcome.proven, outcome.faults) == (len(result), ()), (seed, outcome.faults, outcome.unproven[:3])
    listed = json.loads(path.read_text())
    outline = check_toolkit.Part(listed["workpiece"]["loops"])
    for fixture in listed["fixtures"]:
        assert check_toolkit.check_clamp(fixture, listed["toolkit"], outline)[0] == []
    return len(result)


@pytest.mark.thorough
def test_what_is_found_on_random_parts_is_proven(tmp_path: Path) -> None:
    assert sum(agrees_with_the_checker(seed, tmp_path / "r.json") > 0 for seed in range(8)) >= 4


@pytest.mark.prove
def test_what_is_found_on_many_random_parts_is_proven(tmp_path: Path) -> None:
    assert sum(agrees_with_the_checker(seed, tmp_path / "r.json") > 0 for seed in range(8, 300)) >= 150
