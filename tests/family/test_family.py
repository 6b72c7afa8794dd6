"""Families of real parts: every plan proven part by part, and the fewest by trying everything."""

from __future__ import annotations

import json
from collections import defaultdict
from itertools import combinations
from math import inf

import numpy as np
import pytest
from attrs import evolve

from family_parts import shop_parts
from workhold import Fence, Peg, Plate, Query, Restrictions, Vise, Workpiece, answer
from workhold.errors import InputError
from workhold.family.family import Family, MemberRequest, format_family_json, make_family, make_peg_entry
from workhold.family.members import RANKINGS, add_half_turns, compute_losses, make_member, make_threshold
from workhold.family.patterns import list_holes, rotate_fixtures_by_half_turn, shift_fixture
from workhold.family.plan import Holding
from workhold.fixels.toolkit import Toolkit
from workhold.listing.ranking import measure_table
from workhold.model.fixture_table import FixtureTable, make_fixture_of_row
from workhold.model.quality import CLOSURE_MARGIN, FIGURES, LOCATION_ERROR
from workhold.statics.effective_error import EffectiveErrors
from workhold.statics.judging import are_unfit
from workhold.verification import Judge
from workhold.verification.first_choice import EffectiveJudge

pytest.importorskip("scipy", reason="the extra [batch] is not installed")

VISE, WIDE = Vise(pitch=10, columns=1, peg_radius=3), Vise(pitch=10, columns=2, peg_radius=3)
TWENTY = shop_parts(20)


def asked(parts: list[Workpiece], toolkit: Toolkit, **more: object) -> list[MemberRequest]:
    """Parts to be members, ranked by location error first."""
    ranking = RANKINGS[toolkit.travel_count]
    return [MemberRequest(part.name, Query(part, toolkit, **{"rank_by": ranking, **more})) for part in parts]  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def twenty() -> Family:
    """Twenty parts of a shop in a vise with two columns."""
    return make_family(asked(TWENTY, WIDE), threads=1)


def as_listed(one: Holding) -> FixtureTable:
    """A holding back where a list has it: on a plate with the lowest column and row 0."""
    toolkit = one.member.query.toolkit
    if isinstance(toolkit, Vise):
        return one.row
    columns, rows = (
        min(hole[axis] for hole in list_holes(one.row, toolkit) if hole[axis] < 1 << 40) for axis in (1, 2)
    )
    return shift_fixture(one.row, toolkit, {0: -columns}, 0 if toolkit.wall is not None else -rows)


def prove(family: Family) -> None:
    """Prove every plan part by part, with all its figures, and that its set-ups are what they say."""
    judges = {id(member): Judge(member.query) for member in family.members}
    for plan in family.plans:
        held = [one for setup in plan.setups for one in setup.holdings]
        assert sorted(one.member.name for one in held) == sorted(member.name for member in family.members)
        assert max(one.loss for one in held) == plan.point.loss
        assert len(plan.setups) == plan.point.setups
        for setup in plan.setups:
            for one in setup.holdings:
                fixture = make_fixture_of_row(as_listed(one), family.toolkit, 0, one.member.query.workpiece)
                ruling = judges[id(one.member)].rule_on(fixture)
                assert ruling.verdict == "proven", ruling.reason
                low, high = EffectiveJudge(one.member.query, None).compute_effective_error(fixture)
                error = (low + high) / 2e9 if family.figure.key == "location_error" else one.figure
                # On a plate with ends a pattern that stands elsewhere may hang over where the list's does not.
                hanging = (1.0,) if family.toolkit.rows is None else (1.0, 1.1, 1 / 1.1)
                ratio = error / one.member.best
                assert any(ratio == pytest.approx(one.loss * factor, rel=1e-6) for factor in hanging)
                if one.in_place:
                    assert list_holes(one.row, family.toolkit) == list_holes(
                        setup.standing.row, family.toolkit
                    )


@pytest.mark.thorough
def test_the_curve_of_twenty_parts(twenty: Family) -> None:
    assert len(twenty.members) == 20 and not twenty.left_out
    within = {
        bound: min(p.setups for p in twenty.points if p.loss <= bound)
        for bound in (inf, 2, 1.5, 1.25, 1.1, 1.0)
    }
    assert within == {inf: 1, 2: 2, 1.5: 5, 1.25: 5, 1.1: 8, 1.0: 14}
    assert [point.loss for point in twenty.points] == sorted(
        (point.loss for point in twenty.points), reverse=True
    )
    assert all(point.is_least and point.at_least == point.setups for point in twenty.points)


@pytest.mark.thorough
def test_every_plan_of_twenty_parts_is_proven(twenty: Family) -> None:
    prove(twenty)


@pytest.mark.thorough
def test_numbers_are_those_of_the_list(twenty: Family) -> None:
    for one in (one for setup in twenty.plans[0].setups for one in setup.holdings):
        result = answer(one.member.query, threads=1)
        listed = result.table.take(slice(one.number - 1, one.number))
        if one.turned:
            listed = measured_again(rotate_fixtures_by_half_turn(listed, WIDE), one)
        assert float(listed.quality[0, LOCATION_ERROR]) == one.figure
        assert sorted(listed.face[0]) == sorted(one.row.face[0])
        assert len(result) == one.member.fixtures


def measured_again(table: FixtureTable, one: Holding) -> FixtureTable:
    """A table with its figures."""
    from workhold.contact.problem import Problem

    return measure_table(table, Problem.from_query(one.member.query))


@pytest.mark.thorough
@pytest.mark.parametrize("first", [0, 7])
def test_the_fewest_of_six_parts_by_trying_everything(first: int) -> None:
    parts = TWENTY[first : first + 6]
    family = make_family(asked(parts, VISE), threads=1)
    best: dict[tuple[object, ...], list[float]] = defaultdict(lambda: [inf] * 6)
    for number, one in enumerate(asked(parts, VISE)):
        result = answer(one.query, threads=1)
        table, _ = add_half_turns(result.table, one.query)
        table = table.take(np.flatnonzero(~are_unfit(table.quality, one.query.tolerance)))
        errors = np.round(EffectiveErrors.from_query(one.query).compute_errors(table), 9)
        for row, error in enumerate(errors.tolist()):
            left, right = (
                [r for c, r in zip(range(4), table.row[row], strict=True) if jaw(table, row, c) == k]
                for k in (0, 1)
            )
            base = min(*left, *right)
            key = tuple(sorted(r - base for r in left)), tuple(sorted(r - base for r in right))
            best[key][number] = min(best[key][number], round(error / errors.min(), 9))
    # Patterns that another one is no worse than for every part are of no use.
    rows = np.unique(np.array(list(best.values())), axis=0)
    rows = np.array([a for a in rows if not any((b <= a).all() and (b < a).any() for b in rows)])
    expected, last = {}, inf
    for size in range(1, 7):
        loss = min(float(rows[list(some)].min(axis=0).max()) for some in combinations(range(len(rows)), size))
        if loss < last:
            expected[size] = last = loss
        if loss == 1.0:
            break
    assert {point.setups: point.loss for point in family.points} == pytest.approx(expected)


def jaw(table: FixtureTable, row: int, peg: int) -> int:
    """The jaw of a peg: of type I two stand on each, of type II three on the left."""
    return int(peg >= (2 if table.arrangement[row] == 0 else 3))


TOOLKITS: dict[str, Toolkit] = {
    "rows and a largest opening": Vise(pitch=10, columns=3, peg_radius=3, rows=10, max_opening=45),
    "plate": Plate(pitch=20, peg_radius=3),
    "plate with a stroke": Plate(pitch=20, peg_radius=3, travel=(10, 35)),
    "two clamps": Plate(pitch=20, peg_radius=3, clamps=2),
    "fence": Fence(pitch=10, peg_radius=3, wall_offset=5, directions=["-x", "-y"]),
    "two clamps on a fence": Fence(pitch=20, peg_radius=3, wall_offset=10, clamps=2),
}


@pytest.mark.thorough
@pytest.mark.parametrize("name", TOOLKITS)
def test_plans_in_every_toolkit_are_proven(name: str) -> None:
    family = make_family(asked(TWENTY[:4], TOOLKITS[name]), threads=1)
    assert len(family.members) >= 2
    assert len(family.members) + len(family.left_out) == 4
    prove(family)


def test_what_no_pattern_holds_is_named() -> None:
    disc = Workpiece.from_loops("disc", [[[0, 0, 1], [40, 0, 1]]])
    family = make_family(asked([TWENTY[0], disc], VISE), threads=1)
    assert [one.name for one in family.members] == [TWENTY[0].name]
    assert [(one.name, one.reason) for one in family.left_out] == [("disc", "it has no fixture in this vise")]
    nothing = make_family(asked([disc], VISE), threads=1)
    assert nothing.points == () and nothing.plans == ()
    with pytest.raises(InputError, match="no pattern holds any"):
        nothing.plan(2)


@pytest.mark.thorough
def test_rules_restrict_what_is_used() -> None:
    parts = TWENTY[:4]
    free = make_family(asked(parts, VISE), threads=1)
    error = free.figure.key
    least = {member.name: float(member.table.quality[:, LOCATION_ERROR].min()) for member in free.members}
    limit = sorted(least.values())[1] + 1e-6
    strict = make_family(asked(parts, VISE), thresholds=[make_threshold(error, limit)], threads=1)
    assert sorted(one.name for one in strict.left_out) == sorted(
        name for name, value in least.items() if value > limit
    )
    assert all("may be used" in one.reason for one in strict.left_out)
    bounded = make_family(asked(parts, VISE), most_loss=1.001, threads=1)
    assert all(point.loss <= 1.001 for point in bounded.points)
    faces = Restrictions(avoid=(2,))
    other = make_family(asked(parts, VISE, restrictions=faces), threads=1)
    touched = {
        int(face)
        for plan in other.plans
        for s in plan.setups
        for one in s.holdings
        for face in one.row.face[0]
    }
    assert 2 not in touched and touched
    with pytest.raises(InputError, match="every loss is 1 or more"):
        make_family(asked(parts, VISE), most_loss=0.5)


def test_angles_hold_after_the_half_turn_too() -> None:
    within = Restrictions(angles=((0.0, 170.0),))
    family = make_family(asked(TWENTY[:4], VISE, restrictions=within), threads=1)
    table, number = add_half_turns(
        answer(asked(TWENTY[:1], VISE)[0].query, threads=1).table, family.members[0].query
    )
    assert (np.degrees(table.theta[len(set(number.tolist())) :]) % 360.0 <= 170.0 + 1e-9).all()
    for plan in family.plans:
        for one in (one for setup in plan.setups for one in setup.holdings):
            assert -1e-9 <= one.fixture.pose.theta_deg <= 170.0 + 1e-9
    blocked = Query(TWENTY[0], Vise(pitch=10, columns=2, peg_radius=3, blocked=["L-A1"]))
    result = answer(blocked, threads=1)
    assert len(add_half_turns(result.table, blocked)[0]) == len(result) > 0


def test_losses_are_ratios_whichever_way_is_better() -> None:
    error, margin = (next(f for f in FIGURES if f.key == key) for key in ("location_error", "closure_margin"))
    assert compute_losses(np.array([0.04, 0.02, np.nan, np.inf]), error).tolist() == [2.0, 1.0, inf, inf]
    assert compute_losses(np.array([0.1, 0.2, 0.0]), margin).tolist() == [2.0, 1.0, inf]
    assert compute_losses(np.array([0.0, 1.0, 0.0]), error).tolist() == [1.0, inf, 1.0]
    assert compute_losses(np.full(2, np.nan), error).tolist() == [inf, inf]


@pytest.mark.parametrize("toolkit", [VISE, Plate(pitch=20, peg_radius=3, columns=6, rows=5, clamps=2)])
def test_a_plan_is_made_of_all_fixtures_whatever_a_list_would_show(toolkit: Toolkit) -> None:
    """Of two clamps of every pair, too."""
    part = TWENTY[:1]
    every = answer(
        asked(part, toolkit, **({"listing": "all"} if toolkit.travel_count > 1 else {}))[0].query, threads=1
    )
    member = make_family(asked(part, toolkit, best=1), threads=1).members[0]
    assert member.fixtures == len(every) > 1


def test_unfit_fixtures_are_used_when_asked_for() -> None:
    result = answer(asked(TWENTY[:1], Vise(pitch=10, columns=2, peg_radius=3))[0].query, threads=1)
    bad = are_unfit(result.table.quality, result.query.tolerance)
    assert bad.any()
    with_all, usual = make_member("a", result, unfit=True), make_member("a", result)
    assert len(with_all.words) > len(usual.words)
    assert not are_unfit(usual.table.quality, result.query.tolerance).any()
    assert with_all.fixtures == usual.fixtures == len(result)


def test_the_best_that_a_part_has_is_none_that_is_unfit() -> None:
    result = answer(asked(TWENTY[:1], VISE)[0].query, threads=1)
    quality = result.table.quality.copy()
    # The best fixture hardly holds, so that it is none for a workshop.
    quality[np.argmin(quality[:, LOCATION_ERROR]), CLOSURE_MARGIN] = 1e-6
    changed = evolve(result, table=evolve(result.table, quality=quality))
    fit = ~are_unfit(quality, result.query.tolerance)
    table, _ = add_half_turns(changed.table.take(np.flatnonzero(fit)), result.query)
    member = make_member("a", changed)
    assert member.best == pytest.approx(
        EffectiveErrors.from_query(result.query).compute_errors(table).min(), abs=1e-12
    )
    assert member.loss.min() == 1.0
    assert make_member("a", changed, unfit=True).best < member.best


def test_many_fixtures_are_kept_on_the_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    from workhold.family import members as module

    result = answer(asked(TWENTY[:1], VISE)[0].query, threads=1)
    kept = make_member("a", result)
    monkeypatch.setattr(module, "IN_MEMORY", 0)
    spilled = make_member("a", result)
    assert spilled.table == kept.table and (spilled.words == kept.words).all()


@pytest.mark.thorough
def test_the_file_is_what_the_contract_says(twenty: Family) -> None:
    text = format_family_json(twenty)
    assert text == format_family_json(make_family(asked(TWENTY, WIDE), threads=2))
    data = json.loads(text)
    assert data["format"] == "workhold-family/1"
    family = data["family"]
    assert family["toolkit"]["kind"] == "vise" and family["figure"] == "location_error"
    assert [part["name"] for part in family["parts"]] == [part.name for part in TWENTY]
    for entry, plan in zip(family["curve"], twenty.plans, strict=True):
        assert (entry["setups"], entry["lower_bound"]) == (len(entry["plan"]), plan.point.setups)
        held = [one["part"] for setup in entry["plan"] for one in setup["parts"]]
        assert sorted(held) == list(range(20))
        assert max(one["loss"] for setup in entry["plan"] for one in setup["parts"]) == entry["loss"]
        assert sum(setup["pegs_to_place"] for setup in entry["plan"][1:]) == entry["pegs_moved"]
        for setup in entry["plan"]:
            assert len(setup["pattern"]["pegs"]) == 4
        for setup, planned in zip(entry["plan"], plan.setups, strict=True):
            for told, one in zip(setup["parts"], planned.holdings, strict=True):
                assert {"fixture", "pose", "opening", "loss"} <= told.keys()
                assert (told["fixture"], told["turned"]) == (one.number, one.turned)
                assert told["zero"] == pytest.approx(one.fixture.pose.apply(*one.member.zero.point), abs=1e-8)
    assert {one["turned"] for entry in family["curve"] for s in entry["plan"] for one in s["parts"]} == {
        False,
        True,
    }


@pytest.mark.thorough
def test_pegs_of_a_part_that_stand_elsewhere_and_its_zero_are_told(twenty: Family) -> None:
    """A largest opening, or a smallest gap, may ask for other columns than those of the set-up."""
    from workhold.family.family import make_holding_entry

    one = twenty.plans[0].setups[0].holdings[0]
    assert "pegs" not in make_holding_entry(one, WIDE, 0)
    told = make_holding_entry(evolve(one, in_place=False), WIDE, 0)
    elsewhere = evolve(one.member, zero=evolve(one.member.zero, point=(3.0, 4.0)))
    zero = make_holding_entry(evolve(one, member=elsewhere), WIDE, 0)["zero"]
    assert zero == pytest.approx(one.fixture.pose.apply(3.0, 4.0), abs=1e-8)
    assert told["pegs"] == [{"jaw": p.carrier, "column": p.column, "row": p.row} for p in one.fixture.pegs]


def test_one_and_its_half_turn_are_one_pattern() -> None:
    result = answer(asked(TWENTY[:1], VISE)[0].query, threads=1)
    names = set()
    for row in range(len(result)):
        rows = result.table.row[row].tolist()
        split = 2 if result.table.arrangement[row] == 0 else 3
        forms = [(sorted(rows[:split]), sorted(rows[split:]))]
        if split == 2:
            forms.append((sorted(-r for r in rows[split:]), sorted(-r for r in rows[:split])))
        names.add(min(str([[r - min(*a, *b) for r in some] for some in (a, b)]) for a, b in forms))
    assert make_member("a", result, unfit=True).patterns == len(names)


@pytest.mark.thorough
def test_numbers_of_plans(twenty: Family) -> None:
    assert twenty.plan().point == twenty.points[0]
    assert twenty.plan(20).point == twenty.points[-1]
    assert twenty.plan(2).point.setups <= 2
    only = evolve(twenty.points[0], setups=3)
    lacking = Family(
        twenty.toolkit, twenty.figure, twenty.members, (), (only, *twenty.points[3:]), twenty.table
    )
    with pytest.raises(InputError, match="2 set-ups cannot hold all parts"):
        lacking.plan(2)


# A family's file says where every peg stands, in the words of the carrier that it stands on.
BOLTED = Plate(pitch=20, peg_radius=3, travel=(5, 30))
FENCE = Fence(pitch=20, peg_radius=3, wall_offset=8)


@pytest.mark.parametrize(
    ("toolkit", "carrier", "written"),
    [
        (Vise(pitch=10, columns=2, peg_radius=3), "right", '{"jaw": "right", "column": 4, "row": 1}'),
        (FENCE, "plate", '{"role": "locator", "column": 4, "row": 1}'),
        (FENCE, "wall", '{"role": "locator", "column": 4, "row": 1}'),
        (FENCE, "clamp -x", '{"role": "clamp", "direction": "-x", "row": 1, "hole": null}'),
        (FENCE, "clamp +y", '{"role": "clamp", "direction": "+y", "column": 4, "hole": null}'),
        (BOLTED, "clamp -x", '{"role": "clamp", "direction": "-x", "row": 1, "hole": [4, 1]}'),
    ],
)
def test_a_peg_is_written_by_its_carrier(toolkit: Toolkit, carrier: str, written: str) -> None:
    """The ends of a wall have the role of locators, and a clamp its line, and its hole where that is known."""
    assert json.dumps(make_peg_entry(Peg(carrier, 4, 1, 0.0, 0.0, 0, 1.0), toolkit)) == written
