"""Results of a plate with two clamps: true ones are proven, each rule that is broken is named, and so is a worse pair."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import pairwise
from math import degrees, inf
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest
from flint import arb

import workhold
from judged import faults_of, known_in, posed, rules_in
from toolkit_results import assert_all_proven, part, verify_edited
from undecided_examples import pairs_undecided
from workhold import (
    Fixture,
    InputError,
    Load,
    Peg,
    Plate,
    Query,
    Restrictions,
    Result,
    Workpiece,
    circle_zone,
    design,
)
from workhold.model.fixture import ClampPair
from workhold.model.notes import NoPair
from workhold.model.search_report import AT_AN_EDGE, UndecidedCandidate
from workhold.verification import Verification, verify, verify_fixture
from workhold.verification.account import has_too_few_contacts
from workhold.verification.ball_geometry import BallOutline
from workhold.verification.contacts import BallContact
from workhold.verification.contacts import BallPose as Balls
from workhold.verification.listing import collect_claims
from workhold.verification.rules.travel import WAYS, ClampStroke, name_clamp_place
from workhold.verification.seat import (
    ClampPush,
    LocatorWrenches,
    SeatBalance,
    compute_closure_margin,
    find_ratio,
)
from workhold.verification.seat_clamps import SeatClamp, SeatOnPlate

Data = dict[str, Any]
Edit = Callable[[Data], object]

BLOCK = [[0, 0, 0], [46, 0, 0], [46, 30, 0], [0, 30, 0]]
ANGLE = [[0, 0, 0], [60, 0, 0], [60, 20, 0], [22, 20, 0], [22, 58, 0], [0, 58, 0]]
EAR = [[0, 0, 0], [50, 0, 0], [50, 30, 1], [0, 30, 0]]
SMALL: Data = {"pitch": (20, 16), "peg_radius": 3, "columns": 4, "rows": 4}


def plate(**fields: Any) -> Plate:
    """A small plate with two clamps."""
    given: Data = {"clamps": 2, "directions": [("-x", "-y")]} | SMALL | fields
    return Plate(**given)


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("loop", "toolkit", "asked"),
    [
        (BLOCK, plate(), {}),
        (BLOCK, plate(), {"listing": "all"}),
        (
            BLOCK,
            plate(clamp_radius=5, travel=(4, 30), directions=[("-x", "-x"), ("-y", "+y"), ("-x", "+y")]),
            {},
        ),
        (ANGLE, plate(travel=(6, 26)), {"listing": "all", "contact_margin": 0.5}),
        (EAR, plate(clamp_radius=2), {"loads": [Load(((25.0, 10.0),), 200.0)], "jaw_force": 300.0}),
        (
            ANGLE,
            plate(columns=5, rows=5),
            {
                "restrictions": Restrictions((3,), (circle_zone(40.0, 23.0, 3.0),), ((-100.0, 95.0),)),
                "best": 30,
            },
        ),
    ],
)
def test_everything_a_search_lists_is_proven(loop: Any, toolkit: Plate, asked: Data, tmp_path: Path) -> None:
    """With how many pairs there are at each seat and that none is better; in files of both forms, and searched again."""
    result = design(part(loop), toolkit, **asked)
    assert len(result) >= 10
    assert_all_proven(result, tmp_path)


def test_a_part_that_is_never_held_has_a_note() -> None:
    """A disc cannot be kept from turning; why nothing is listed is held to the numbers of the search."""
    disc = part([[0, 0, 1], [40, 0, 1]])
    result = design(disc, plate())
    assert len(result) == 0 and result.notes
    assert verify(result).faults == ()
    assert "the note is missing" in verify(attrs.evolve(result, notes=())).faults[0]
    wrong = NoPair(1, 12345)
    assert any("does not follow" in fault for fault in verify(attrs.evolve(result, notes=(wrong,))).faults)


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    """Of a block, bolted clamps: the best pair of each seat, and all."""
    toolkit = plate(travel=(4, 40), columns=5, rows=5)
    return {listing: design(part(BLOCK), toolkit, listing=listing) for listing in ("best", "all")}


@pytest.fixture(scope="module")
def data(results: dict[str, Result], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Data]:
    """The JSON of their files, that of the first as if only so many had been asked for."""
    out = {}
    for listing, result in results.items():
        if listing == "best":
            query, table = attrs.evolve(result.query, best=12), result.table.take(np.arange(12))
            result = attrs.evolve(result, query=query, table=table)
        path = tmp_path_factory.mktemp("pairs") / "r.json"
        workhold.save(result, path)
        out[listing] = json.loads(path.read_text())
    return out


@pytest.fixture
def edited(data: dict[str, Data], tmp_path: Path) -> Callable[..., Verification]:
    """Verify such a file after an edit of its JSON."""

    def verified(edit: Edit, listing: str = "best") -> Verification:
        return verify_edited(data[listing], edit, tmp_path)

    return verified


def added(values: list[float], place: int, by: float) -> None:
    """A number of a list made larger."""
    values[place] += by


def swapped(fixture: Data) -> None:
    """The ratio the other way round: the first force over the second."""
    low, high = fixture["ratio"]
    fixture["ratio"] = [0.0 if high is None else 1 / high, 1 / low if low else None]
    if fixture["ratio"] == [low, high]:
        fixture["ratio"] = [0.5, 2.0]


def elsewhere(fixture: Data, clamp: int, holes: int) -> None:
    """A clamp bolted so many holes farther from its tip, everything moved so that the lowest column and row are 0."""
    peg = fixture["pegs"][clamp]
    axis = 0 if peg["direction"].endswith("x") else 1
    peg["hole"][axis] += holes * (1 if peg["direction"].startswith("-") else -1)


BROKEN: list[tuple[Callable[[Data], object], str]] = [
    (lambda f: added(f["pegs"][0]["force"], 1, 1e-5), "the force of locator 1 under clamp 2"),
    (lambda f: added(f["pegs"][4]["force"], 1, 1e-5), "the force of clamp 2 under clamp 2"),
    (lambda f: added(f["pegs"][3]["force"], 1, 1e-5), "the force of clamp 1 under clamp 2"),
    (swapped, "end of its ratio"),
    (lambda f: f.update(ratio=[0.3, f["ratio"][1]]), "the lower end of its ratio"),
    (lambda f: f.update(pairs=f["pairs"] + 1), "pairs of clamps, and there are"),
    (lambda f: f.update(pairs=f["pairs"] - 1), "pairs of clamps, and there are"),
    (lambda f: added(f["quality"], "clamp_freedom", -1e-4), "its clamp freedom is"),  # type: ignore[arg-type]
    (lambda f: added(f["quality"], "closure_margin", 1e-6), "its closure margin is"),  # type: ignore[arg-type]
    (lambda f: added(f["quality"], "wrench_radius", 1e-6), "its wrench radius is"),  # type: ignore[arg-type]
    (lambda f: added(f["quality"], "location_error", 1e-6), "its location error is"),  # type: ignore[arg-type]
    (lambda f: f["quality"].pop("clamp_freedom"), "its clamp freedom is missing"),
    (lambda f: f["pegs"].reverse(), "its pegs are not three locators and then two clamps"),
    (lambda f: f["directions"].reverse(), "its pegs are not three locators and then two clamps"),
    (lambda f: f["pegs"].__setitem__(1, dict(f["pegs"][0])), "two locators are in the same hole"),
    (lambda f: f["pegs"][3].update(x=f["pegs"][3]["x"] + 0.5), "clamp 1 is"),
    (lambda f: f["pegs"][4].update(y=f["pegs"][4]["y"] + 3e-6), "clamp 2 is"),
    (lambda f: f["pegs"][4].update(hole=None), "clamp 2 is not named by the hole in which it is bolted"),
    (lambda f: f["pegs"][2].update(segment=f["pegs"][3]["segment"]), "locator 3 is"),
    (lambda f: f["pose"].update(theta_deg=f["pose"]["theta_deg"] + 3e-6), "away from touching face"),
]


@pytest.mark.parametrize(
    ("found", "pairs", "seats"), [(10, 3, 2), (3, 10, 2), (3, 3, 2), (11, 3, 2), (3, 11, 2), (3, 3, 3)]
)
def test_contacts_make_no_more_seats_and_pairs_than_there_can_be(
    results: dict[str, Result], found: int, pairs: int, seats: int
) -> None:
    """Five make ten pairs, and each seat with its one pair of directions takes two."""
    listing, proof = collect_claims(results["all"]), results["all"].proof
    assert proof is not None and len(results["all"].toolkit.directions) == 1  # type: ignore[attr-defined]
    claimed = attrs.evolve(listing, found={"clamp2": found}, pairs=pairs, seats=seats)
    few = has_too_few_contacts(claimed, attrs.evolve(proof, verified=5))
    assert few == (max(found, pairs) > 10 or seats > 2)


@pytest.mark.thinned(6)
@pytest.mark.parametrize(
    ("edit", "words"), BROKEN, ids=[f"{n} {words}" for n, (_, words) in enumerate(BROKEN)]
)
def test_what_is_broken_by_hand_is_named(edited: Any, edit: Callable[[Data], object], words: str) -> None:
    """Of the first fixture; the others stay proven."""
    outcome = edited(lambda content: edit(content["fixtures"][0]))
    ((index, verdict, reason),) = [attrs.astuple(item) for item in outcome.unproven]
    assert (index, verdict) == (0, "refuted") and words in reason
    assert outcome.proven == 11


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda f: f.update(directions=["-x"]), "its directions are not two of -x"),
        (lambda f: f.update(directions=["-x", ["-y"]]), "its directions are not two of -x"),
        (lambda f: f["pegs"].pop(), "it does not have five pegs"),
        (lambda f: f["pegs"][0].update(force=0.5), "force is 0.5, not two numbers"),
        (lambda f: f["pegs"][0].update(force=[0.5, None]), "force is None, not a number"),
        (lambda f: f["pegs"][4].update(direction="up"), "the direction of a clamp is not -x or"),
        (lambda f: f["pegs"][4].pop("direction"), "the key direction is missing"),
        (lambda f: f.update(ratio=[None, 1.0]), "ratio is None, not a number"),
        (lambda f: f.pop("ratio"), "the key ratio is missing"),
        (lambda f: f.pop("pairs"), "the key pairs is missing"),
        (lambda f: f.pop("directions"), "it does not have four pegs"),
        (lambda f: f.update(type="clamp"), "its type is not clamp2"),
    ],
)
def test_files_with_something_unusable(edited: Any, edit: Callable[[Data], object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        edited(lambda content: edit(content["fixtures"][0]))


@pytest.mark.thorough
def test_the_account_is_held_to_what_is_listed(edited: Any) -> None:
    """Pairs, seats, repetitions and the order, of both listings."""

    def told(edit: Edit, listing: str = "best") -> str:
        outcome: Verification = edited(edit, listing)
        return "; ".join((*outcome.faults, *(item.reason for item in outcome.unproven)))

    assert told(lambda content: None) == told(lambda content: None, "all") == ""
    assert "seats says 3, but found says" in told(lambda content: content.update(seats=3))
    assert "pairs says 12, but the fixtures listed stand for" in told(
        lambda content: content.update(pairs=12)
    )
    assert "at how many seats" in told(lambda content: content.pop("seats"))
    assert "it has the seat and the directions of fixture 1" in told(
        lambda content: content["fixtures"].__setitem__(11, content["fixtures"][0])
    )
    assert "the one before it" in told(lambda content: content["fixtures"].reverse(), "all")
    assert "fixtures were found" in told(lambda content: content["proof"].update(verified=2))
    assert "but the fixtures listed are at" in told(
        lambda content: content.update(seats=content["seats"] - 1), "all"
    )
    assert "pairs says 5, but found says" in told(lambda content: content.update(pairs=5), "all")
    assert "it is the same as fixture 1" in told(
        lambda content: content["fixtures"].append(content["fixtures"][0]), "all"
    )
    assert "it stands for 2 pairs" in told(lambda content: content["fixtures"][0].update(pairs=2), "all")


@pytest.mark.thorough
def test_a_pair_left_out_of_all_is_missed(results: dict[str, Result]) -> None:
    """With all counts adjusted: the pairs of each seat are derived."""
    result = results["all"]
    seen = known_in(result.toolkit)
    again = [index for index, fixture in enumerate(result) if seen.add(index, fixture) is not None]
    kept = np.delete(np.arange(len(result)), again[0])
    less = len(result) - 1
    counts = {"clamp2": less}
    short = attrs.evolve(
        result,
        table=result.table.take(kept),
        found=counts,
        distinct={"clamp2": 1},
        pairs=less,
        query=result.query,
    )
    faults = [fault for fault in verify(short).faults if not fault.startswith("distinct")]
    assert len(faults) == 1 and "pairs of clamps at the seat of fixture" in faults[0]


@pytest.mark.thorough
def test_another_pair_of_the_seat_is_not_the_best(results: dict[str, Result]) -> None:
    """Each pair of a seat in place of its best: proven just where it is as good."""
    best, every = results["best"], results["all"]
    seen = known_in(best.toolkit)
    for index, fixture in enumerate(best):
        seen.add(index, fixture)
    refuted = 0
    for place in range(0, len(every), 7):
        fixture = every[place]
        there = seen.find(fixture)
        assert there is not None and fixture.pair is not None
        listed = best[there]
        assert listed.pair is not None
        swap = attrs.evolve(fixture, pair=attrs.evolve(fixture.pair, count=listed.pair.count))
        ruling = verify_fixture(swap, best.workpiece, best.toolkit)
        worse = listed.quality["clamp_freedom"] - fixture.quality["clamp_freedom"] > 1e-3
        worse |= listed.quality["closure_margin"] - fixture.quality["closure_margin"] > 1e-6
        assert ruling.verdict == ("refuted" if worse else "proven"), (place, ruling)
        assert "pair of clamps at its seat has a" in ruling.reason or not worse
        refuted += worse
    assert refuted > 3


def standing(fixture: Fixture, workpiece: Workpiece, toolkit: Plate) -> SeatOnPlate:
    """The seat of a fixture, at its pose as it is written."""
    rules, outline = rules_in(toolkit), BallOutline.from_workpiece(workpiece)
    pose = Balls.from_turn_and_place(
        arb(fixture.pose.theta_deg) * arb.pi() / 180, arb(fixture.pose.x), arb(fixture.pose.y), arb(0)
    )
    locators = [rules.make_contact(peg, outline.faces[peg.face]) for peg in fixture.pegs[:3]]
    return SeatOnPlate.from_fixture(fixture, locators, pose, Query(workpiece, toolkit), rules, outline)


def with_clamps(fixture: Fixture, *clamps: SeatClamp) -> Fixture:
    """A fixture's seat with two clamps that are tips alone; its ratio and forces are not looked at."""
    pegs = list(fixture.pegs[:3])
    for clamp in clamps:
        along_x = clamp.direction.endswith("x")
        column, row = (0, clamp.line) if along_x else (clamp.line, 0)
        x, y = (float(value.mid()) for value in clamp.tip)
        called = name_clamp_place("plate", clamp.direction, column, row, False)
        pegs.append(Peg(f"clamp {clamp.direction}", column, row, x, y, clamp.face, 0.0, called))
    travels = tuple(
        sum(v * w for v, w in zip((peg.x, peg.y), WAYS[clamp.direction], strict=True))
        for peg, clamp in zip(pegs[3:], clamps, strict=True)
    )
    pair = ClampPair((travels[0], travels[1]), (0.0, inf), ((0.0, 0.0),) * 5, 1)
    directions = " ".join(clamp.direction for clamp in clamps)
    return attrs.evolve(fixture, type="clamp2", pegs=tuple(pegs), direction=directions, pair=pair)


def test_a_clamp_that_holds_alone_needs_no_other() -> None:
    """A fixture with one clamp and any second is none of this kind."""
    workpiece = part(ANGLE)
    single = design(workpiece, Plate((20, 20), 3, columns=8, rows=6))
    toolkit = Plate((20, 20), 3, columns=8, rows=6, clamps=2, directions=[("-x", "-y")])
    looked_at = 0
    for fixture in single[:40]:
        if (
            fixture.direction != "-x"
            or min(peg.column for peg in fixture.pegs[:3])
            or min(p.row for p in fixture.pegs)
        ):
            continue
        seat = standing(fixture, workpiece, toolkit)
        assert fixture.pegs[3].place is not None
        alone = fixture.pegs[3]
        second = next(iter(seat.list_clamps("-y")), None)
        if second is None:
            continue
        first = attrs.evolve(
            second, direction="-x", line=alone.row, face=alone.face, tip=(arb(alone.x), arb(alone.y))
        )
        ruling = verify_fixture(with_clamps(fixture, first, second), workpiece, toolkit)
        assert ruling.verdict == "refuted"
        assert "clamp 1 holds the part without the other" in ruling.reason, ruling
        # Nor is it among the clamps of the seat.
        assert all((clamp.line, clamp.face) != (alone.row, alone.face) for clamp in seat.list_clamps("-x"))
        looked_at += 1
    assert looked_at > 3


@pytest.mark.thorough
def test_clamps_that_touch_each_other_are_none() -> None:
    """Two tips side by side on one face, nearer than both their radii."""
    workpiece = part(BLOCK)
    thin = Plate(
        (20, 10), 3, columns=6, rows=8, clamps=2, clamp_radius=4.9, directions=[("-x", "-x"), ("-x", "-y")]
    )
    fat = attrs.evolve(thin, clamp_radius=5.1, peg_radius=3)
    words = []
    for toolkit in (thin, fat):
        for fixture in design(workpiece, toolkit, best=60):
            seat = standing(fixture, workpiece, toolkit)
            clamps = sorted(seat.list_clamps("-x"), key=lambda clamp: clamp.line)
            beside = [pair for pair in pairwise(clamps) if pair[1].line - pair[0].line == 1]
            if fixture.pose.theta_deg % 90 == 0 and beside:
                words.append(verify_fixture(with_clamps(fixture, *beside[0]), workpiece, toolkit).reason)
                break
    assert "the clamps meet: they overlap by 0.2 mm" not in words[0] and "they overlap by 0.2 mm" in words[1]


@pytest.mark.parametrize(("radius", "overlap"), [(4.999, False), (5.001, True)])
def test_bodies_of_clamps_keep_clear_of_each_other_as_well(radius: float, overlap: bool) -> None:
    """One along a row from its hole at x = 30 to its tip at 0, and a tip 10 mm above the middle of that."""
    pose = posed(-30, -40)
    side, thick = BallOutline.from_workpiece(part(BLOCK)).faces[0], arb(radius)
    lying = BallContact((arb(30), arb(0)), (arb(1), arb(0)), side, thick)
    upright = BallContact((arb(20), arb(50)), (arb(0), arb(1)), side, thick, travel=1)
    found = [
        finding.reason
        for finding in ClampStroke((10.0, 50.0), None).judge_clearance_between(lying, upright, pose)
    ]
    assert found == (["the clamps meet: they overlap by 0.002 mm"] if overlap else [])
    assert list(ClampStroke(None, None).judge_clearance_between(lying, upright, pose)) == []


def push(taken: tuple[float, float, float], share: float = 1.0) -> ClampPush:
    """A clamp of which the locators take up so much."""
    a, b, c = (arb(value) for value in taken)
    return ClampPush((a, b, c), arb(share))


@pytest.mark.parametrize(
    ("apart", "first", "words"),
    [
        (1e-5, push((0.5, -0.5, 0.5)), ""),
        (
            1e-7,
            push((0.5, -0.5, 0.5)),
            "the locators do not fix the pose: their wrenches have a determinant of only 1e-07",
        ),
        (40.0, push((9e5, -0.5, 0.5)), ""),
        (40.0, push((2e6, -0.5, 0.5)), "clamp 1 presses a locator with 2e+06 times its own force"),
        (40.0, push((0.5, -0.5, 0.5), 1e-7), "clamp 1 does not push the part"),
        (40.0, push((0.5, 0.5, 0.5)), "clamp 1 holds the part without the other"),
    ],
)
def test_what_clamps_may_do_at_a_seat(apart: float, first: ClampPush, words: str) -> None:
    """Two locators so far apart below the part and one beside it, whose determinant that is; another clamp keeps all."""
    points = [(arb(0), arb(0)), (arb(apart), arb(0)), (arb(0), arb(5))]
    normals = [(arb(0), arb(1)), (arb(0), arb(1)), (arb(1), arb(0))]
    seat, second = LocatorWrenches(points, normals), push((0.5, -0.5, 0.5))
    balance = SeatBalance(points, normals, seat, (first, second), find_ratio(first, second))
    found = [finding.reason for finding in balance.judge_pushes(1.0)]
    assert found == [] if not words else words in found[0]


def test_ratio_and_margin_in_closed_form() -> None:
    """The textbook's 3-2-1, a pair that needs both at once, and one that closes at no ratio."""
    side, between = push((1.0, 0.0, 0.0)), push((0.0, 0.5, 0.5))
    ratio = find_ratio(side, between)
    assert ratio is not None and ratio.high is None and ratio.low == 0 and abs(ratio.freedom - 90) < 1e-12
    assert abs(compute_closure_margin(side, between) - arb(1) / 6) < 1e-12
    lifting = push((1.0, -0.5, 1.0)), push((-0.25, 1.0, 0.0))
    ratio = find_ratio(*lifting)
    assert ratio is not None and ratio.high is not None and ratio.low == 0.5 and ratio.high == 4
    assert compute_closure_margin(*lifting) > 0.05
    apart = find_ratio(push((1.0, -1.0, 1.0)), push((-1.0, 0.5, 0.0)))
    assert apart is not None and apart.freedom < 0
    assert compute_closure_margin(push((1.0, -1.0, 1.0)), push((-1.0, 0.5, 0.0))) == 0
    # Less than 1e-9 is nothing, and just that is undecided.
    nothing = find_ratio(push((1.0, -5e-10, 0.0)), push((0.0, 0.5, 0.5)))
    assert nothing is not None and nothing.low == 0
    edge = ClampPush((arb(1), arb(-1e-9, 1e-20), arb(0)), arb(1))
    assert find_ratio(edge, between) is None


@pytest.mark.parametrize("seed", range(20))
def test_the_margin_is_the_largest_least_share(seed: int) -> None:
    """Beside a fine grid of shares of both clamps, which it is never below and hardly above."""
    chance = np.random.default_rng(seed)
    one, other = chance.normal(size=(2, 3)) + 0.4
    margin = float(compute_closure_margin(push(tuple(one)), push(tuple(other))).mid())
    share = np.linspace(0, 1, 20001)[:, None]
    rows = (1 - share) * [*one, 1, 0] + share * [*other, 0, 1]
    total = rows.sum(axis=1)
    grid = np.where(total > 0, rows.min(axis=1) / np.where(total > 0, total, 1), 0).max(initial=0)
    assert grid <= margin + 1e-12 and margin - grid < 2e-3


def test_an_undecided_pair_is_a_place_or_a_fault(results: dict[str, Result]) -> None:
    """Its locators with each of its clamps."""
    result = results["best"]
    table = result.table.take(np.arange(3))
    entries = pairs_undecided(table, result.toolkit)
    assert all(entry.reason == AT_AN_EDGE and len(entry.faces) == 5 for entry in entries)
    assert faults_of(entries, result.query) == []
    for edit in (
        {"theta_deg": (entries[0].theta_deg + 5.0) % 360},
        {"faces": (entries[0].faces[2], *entries[0].faces[1:])},
        {"type": "clamp2 -x +x"},
        {"type": "clamp -x"},
        {"faces": entries[0].faces[:4]},
    ):
        entry: UndecidedCandidate = attrs.evolve(entries[0], **edit)
        assert len(faults_of([entry], result.query)) == 1, edit
    assert degrees(table.theta[0]) % 360 == pytest.approx(entries[0].theta_deg)
    assert {peg.carrier for peg in result[0].pegs[:3]} == {"plate"}
