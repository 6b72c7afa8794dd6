"""Why there is no fixture: counts that add up, the rule that took the last away, a nearest miss, and help that helps."""

from __future__ import annotations

from itertools import pairwise
from math import isfinite
from threading import Event
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from workhold import (
    Fence,
    InputError,
    Plate,
    Query,
    Restrictions,
    Result,
    Vise,
    Workpiece,
    answer,
    circle_zone,
    count_contacts,
    design,
    load,
)
from workhold.model.notes import AskedFor, NoFixture, Note
from workhold.model.search_report import Explanation
from workhold.search import explaining
from workhold.search.explaining import explain
from workhold.units import MILLIMETRE
from workhold.verification import verify

PLAIN = Vise(pitch=8, columns=1, peg_radius=3)


def explained(vise: Vise, **asked: Any) -> Explanation:
    """The explanation for the widget, which has no fixture as asked."""
    widget, margin = load("widget"), asked.pop("contact_margin", 0.0)
    restrictions = Restrictions(**asked)
    assert len(design(widget, vise, restrictions=restrictions, contact_margin=margin)) == 0
    return explain(Query(widget, vise, restrictions=restrictions, contact_margin=margin))


HOLES = "holes that the jaws do not have, or too near for the bodies"
CASES: list[tuple[str, Vise, dict[str, Any]]] = [
    ("contact margin", PLAIN, {"contact_margin": 6.0}),
    ("smallest gap", evolve(PLAIN, min_gap=200.0), {}),
    ("closure", PLAIN, {"avoid": (0, 3, 7), "angles": ((100.0, 103.0),)}),
    ("angles of the part", PLAIN, {"angles": ((1.0, 1.001),)}),
    ("largest opening", evolve(PLAIN, max_opening=8.01), {}),
    (HOLES, evolve(PLAIN, rows=1), {}),
    ("bodies that would overlap", evolve(PLAIN, body_radius=22.0), {}),
    ("blocked holes", evolve(PLAIN, rows=4, blocked=["L-A1", "L-A2", "L-A3"]), {}),
    ("keep-out zones", PLAIN, {"zones": (circle_zone(30.0, 23.0, 42.0),)}),
]


@pytest.mark.thorough
@pytest.mark.parametrize(("rule", "vise", "asked"), CASES, ids=[case[0] for case in CASES])
def test_the_rules_take_all_away(rule: str, vise: Vise, asked: dict[str, Any]) -> None:
    """Each rule begins with what the one before it left, the last leaves nothing, and what was asked for is among them."""
    explanation = explained(vise, **asked)
    removals = explanation.removals
    assert explanation.contacts > 0 and removals[0].before == explanation.contacts
    assert all(one.after == next_.before for one, next_ in pairwise(removals))
    assert all(removal.after <= removal.before for removal in removals)
    assert removals[-1].after == 0 and explanation.last_rule == removals[-1].rule
    assert rule in [removal.rule for removal in removals]
    assert explanation.nearest is not None or removals[-1].rule in (
        "keep-out zones",
        "angles of the part",
        HOLES,
    )


@pytest.mark.thorough
def test_help_helps() -> None:
    """Each change that is named has as many fixtures as it says, the most first."""
    explanation = explained(PLAIN, avoid=(0, 1, 2, 3, 4))
    counts = [item.fixtures for item in explanation.helps]
    assert counts == sorted(counts, reverse=True) and counts[0] == len(design(load("widget"), PLAIN))
    one = next(item for item in explanation.helps if item.change == "touching face 1 too")
    rest = Restrictions(avoid=(0, 2, 3, 4))
    assert one.fixtures == len(design(load("widget"), PLAIN, restrictions=rest))


def test_a_change_that_takes_long_is_told_as_far_as_it_came(monkeypatch: pytest.MonkeyPatch) -> None:
    """It helps all the same; how many fixtures there are is then a lower bound, and said to be one."""
    events: list[Event] = []

    def interrupted(*arguments: Any, cancel: Event, **options: Any) -> Any:
        events.append(cancel)
        assert cancel.wait(120)
        return evolve(answer(*arguments, **options), complete=False)

    monkeypatch.setattr(explaining, "HELP_SECONDS", 0.01)
    monkeypatch.setattr(explaining, "answer", interrupted)
    explanation = explain(Query(load("widget"), evolve(PLAIN, min_gap=200.0)))
    assert len(events) > 1 and len(explanation.helps) > 0
    assert not any(item.complete for item in explanation.helps)


def test_the_nearest_miss_touches_with_all_four_pegs() -> None:
    """It breaks a rule, but the pegs touch their faces: the rectangle between jaws that are too far apart."""
    part = Workpiece.from_loops("rectangle", [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]])
    vise = Vise(pitch=10, columns=2, peg_radius=3, min_gap=100)
    explanation = explain(Query(part, vise))
    assert explanation.last_rule == "smallest gap"
    assert explanation.nearest is not None and "smallest gap is 100 mm" in explanation.nearest.words
    fixture = explanation.nearest.fixture
    angle = np.radians(fixture.pose.theta_deg)
    for peg in fixture.pegs:
        x, y = peg.x - fixture.pose.x, peg.y - fixture.pose.y
        x, y = np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x
        outside = np.hypot(max(-x, 0, x - 60), max(-y, 0, y - 40))
        assert outside == pytest.approx(3.0, abs=1e-6)


def test_parts_that_four_pegs_cannot_touch() -> None:
    """Nothing to remove, no nearest miss."""
    part = Workpiece.from_loops("pin", [[[-2, 0, 1], [2, 0, 1]]])
    explanation = explain(Query(part, Vise(pitch=50, columns=1, peg_radius=3)))
    assert (explanation.contacts, explanation.removals, explanation.nearest) == (0, (), None)
    assert explanation.last_rule is None


def test_contacts_are_among_those_counted() -> None:
    """A count of its own also has sets in which two pegs stand in one place, and those on a joint of two faces twice."""
    part, vise = load("widget"), evolve(PLAIN, min_gap=200.0)
    explanation = explain(Query(part, vise))
    counted = count_contacts(part, vise)
    assert 0.5 * counted <= explanation.contacts <= counted


RECTANGLE = Workpiece.from_loops("rectangle", [[[0, 0, 0], [100, 0, 0], [100, 60, 0], [0, 60, 0]]])


@pytest.mark.thorough
def test_why_two_clamps_hold_nothing() -> None:
    """Counts add up and end with the second clamp; no nearest miss, as each lacks a clamp; changes help as they say."""
    plate = Plate(pitch=20, peg_radius=3, clamp_radius=5, travel=(10, 40), columns=3, rows=3, clamps=2)
    explanation = explain(Query(RECTANGLE, plate))
    removals = explanation.removals
    assert explanation.contacts == removals[0].before and explanation.nearest is None
    assert all(one.after == next_.before for one, next_ in pairwise(removals)) and removals[-1].after == 0
    assert explanation.last_rule is not None and explanation.last_rule.startswith("a second clamp")
    counts = {item.change: item.fixtures for item in explanation.helps}
    assert counts["with a clamp of any stroke"] == len(design(RECTANGLE, evolve(plate, travel=None))) > 0


def test_why_two_clamps_hold_nothing_on_a_fence() -> None:
    """Counts add up over the restrictions and end with the second clamp; and a change helps as it says."""
    fence = Fence(pitch=20, peg_radius=3, wall_offset=10, travel=(1, 2), columns=4, rows=3, clamps=2)
    query = Query(RECTANGLE, fence, restrictions=Restrictions(angles=((-1, 91),)), contact_margin=2.0)
    assert len(answer(query)) == 0
    explanation = explain(query)
    removals = explanation.removals
    assert (
        explanation.contacts == removals[0].before > removals[-1].before > 0 and explanation.nearest is None
    )
    assert all(one.after == next_.before for one, next_ in pairwise(removals)) and removals[-1].after == 0
    rules = [removal.rule for removal in removals]
    assert rules[:-1] == ["angles of the part", "holes that the plate does not have", "contact margin"]
    assert rules[-1].startswith("a second clamp")
    counts = {item.change: item.fixtures for item in explanation.helps}
    longer = evolve(query, toolkit=evolve(fence, travel=None))
    assert counts["with a clamp of any stroke"] == len(answer(longer)) > 0


def test_what_comes_nearest_on_a_fence_has_forces() -> None:
    """Also where locator and clamp press along the fence alone, against no end of it."""
    corners = [(0, 0), (100, 0), (100, 60), (70, 60), (70, 30), (30, 30), (30, 60), (0, 60)]
    part = Workpiece.from_loops("block", [[[x, y, 0] for x, y in corners]])
    nearest = explain(Query(part, Fence(pitch=20, peg_radius=3, wall_offset=10))).nearest
    assert nearest is not None and "would not press" in nearest.words
    assert nearest.fixture.pegs[-1].force == pytest.approx(1.0) and all(
        isfinite(p.force) for p in nearest.fixture.pegs
    )


@pytest.mark.thorough
def test_another_number_of_clamps_helps() -> None:
    """A square rectangle takes a second clamp; a part that one clamp holds at every seat needs no second."""
    square = Restrictions(angles=((-0.001, 0.001),))
    one = Plate(pitch=20, peg_radius=3)
    helps = {item.change: item for item in explain(Query(RECTANGLE, one, restrictions=square)).helps}
    two = helps["with a second clamp"]
    assert two.fixtures == len(design(RECTANGLE, one.with_fields(two.fields or {}), restrictions=square)) > 0
    pairs = Query(
        RECTANGLE, evolve(one, clamps=2, directions=None, rows=2), rank_by="clamp-freedom", listing="all"
    )
    changed = [item for item in explaining.list_changes(pairs, MILLIMETRE) if item[0] == "with one clamp"]
    assert [item[1]().toolkit for item in changed] == [evolve(one, rows=2, directions=None)]


PLAIN_PLATE_LOOP = [[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]
PLAIN_PLATE = Workpiece.from_loops("plate", [PLAIN_PLATE_LOOP])
WIDE = Vise(pitch=20, columns=1, peg_radius=3)
TURNED = ((1.0, 1.001),)


def test_what_was_asked_for_is_named_where_closure_is_the_last_rule() -> None:
    """Four pegs that close touch the face to avoid: it takes the last fixture, not the part's shape."""
    query = Query(PLAIN_PLATE, WIDE, restrictions=Restrictions(avoid=(2,)))
    explanation = explain(query)
    assert (explanation.last_rule, explanation.taken_by) == ("closure", ("faces to avoid",))
    assert explanation.asked_words.endswith("What was asked for rules out the last fixtures: faces to avoid.")
    (item,) = (item for item in explanation.helps if item.rules)
    assert item.fixtures == len(design(PLAIN_PLATE, WIDE)) > 0


def test_nothing_that_was_asked_for_is_named_where_it_takes_nothing() -> None:
    """A large gap is a rule of the vise; a contact margin beside it does no harm."""
    explanation = explain(Query(PLAIN_PLATE, evolve(WIDE, min_gap=200.0), contact_margin=0.1))
    assert (explanation.taken_by, explanation.asked_words) == ((), "")


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("vise", "asked", "margin", "needed"),
    [
        (WIDE, {"avoid": (2,), "angles": TURNED}, 0.01, ("faces to avoid", "angles of the part")),
        (evolve(WIDE, rows=1), {"avoid": (2,)}, 0.01, ("faces to avoid", "rows of holes")),
        (
            evolve(WIDE, rows=1),
            {"angles": TURNED},
            15.0,
            ("angles of the part", "contact margin", "rows of holes"),
        ),
    ],
    ids=["faces, angles", "faces, rows", "angles, margin, rows"],
)
def test_what_takes_the_last_fixture_together_is_left_out_together(
    vise: Vise, asked: dict[str, Any], margin: float, needed: tuple[str, ...]
) -> None:
    """Each of them alone takes all, so no single change helps; a margin that takes nothing is not named."""
    explanation = explain(Query(PLAIN_PLATE, vise, restrictions=Restrictions(**asked), contact_margin=margin))
    (item,) = explanation.helps
    assert set(item.rules) == set(explanation.taken_by) == set(needed)
    assert explanation.asked_words.endswith("together.")
    rest: dict[str, Any] = {} if "contact margin" in needed else {"contact_margin": margin}
    assert item.fixtures == len(design(PLAIN_PLATE, WIDE, **rest)) > 0


def reasons(workpiece: Workpiece, toolkit: Any, margin: float = 0.0, **asked: Any) -> tuple[Note, ...]:
    """Why a search finds nothing, which a verification takes as what follows."""
    result = answer(Query(workpiece, toolkit, restrictions=Restrictions(**asked), contact_margin=margin))
    assert verify(result).faults == ()
    assert not any(result.found.values()) and result.complete
    return result.reasons


def test_a_search_names_what_was_asked_for_after_its_reason() -> None:
    """And nothing where nothing was; the reason itself is the same."""
    loose = NoFixture("hold", WIDE.wording)
    assert reasons(PLAIN_PLATE, WIDE, avoid=(2,)) == (loose, AskedFor(("faces to avoid",)))
    assert AskedFor(("angles of the part", "contact margin")) in reasons(
        PLAIN_PLATE, WIDE, 15.0, angles=TURNED
    )
    assert len(reasons(PLAIN_PLATE, evolve(WIDE, min_gap=200.0))) == 1


def test_a_part_is_called_round_only_if_it_is() -> None:
    """With its straight sides avoided a plate with a hole is none; a disc is one with any zone."""
    bored = Workpiece.from_loops("bored", [PLAIN_PLATE_LOOP, [[20, 20, 1], [40, 20, 1]]])
    disc, small = (
        Workpiece.from_loops("disc", [[[-20, 0, 1], [20, 0, 1]]]),
        Vise(pitch=8, columns=2, peg_radius=2),
    )
    concentric = NoFixture("shape", small.wording)
    (said, _) = reasons(bored, small, avoid=(0, 1, 2, 3))
    assert said != concentric and "faces to avoid" in str(said) and "one centre" in str(said)
    assert reasons(disc, small, zones=(circle_zone(20.0, 0.0, 3.0),))[0] == concentric


def test_the_pitch_is_to_blame_only_if_it_is() -> None:
    """Two pegs of one jaw reach the part in more rows than the one asked for; on a wide pitch they do not anyway."""
    too_far = NoFixture("pair", WIDE.wording)
    (said,) = reasons(PLAIN_PLATE, evolve(WIDE, rows=1))
    assert said != too_far and "rows of holes" in str(said) and "pitch" not in str(said)
    assert reasons(PLAIN_PLATE, evolve(WIDE, pitch=500, rows=1))[0] == too_far


def test_zones_and_faces_to_avoid_are_both_named_where_they_leave_nothing() -> None:
    """A zone over the one face that is not avoided; alone it is the zones."""
    side = circle_zone(0.0, 20.0, 25.0)
    for avoid, words in (
        ((0, 1, 2), "stand on another face: make them smaller, or avoid fewer faces"),
        ((), ""),
    ):
        zones = (side,) if avoid else (circle_zone(30.0, 20.0, 60.0),)
        with pytest.raises(InputError, match=words or r"stand: make them smaller\.$"):
            answer(Query(PLAIN_PLATE, WIDE, restrictions=Restrictions(avoid=avoid, zones=zones)))
    assert isinstance(answer(Query(PLAIN_PLATE, WIDE, restrictions=Restrictions(zones=(side,)))), Result)


@pytest.mark.thorough
def test_a_round_part_is_blamed_for_being_round() -> None:
    """Contacts of it are not counted, as nothing keeps it from turning; where holes are too far apart, these are."""
    disc = Workpiece.from_loops("disc", [[[-40, 0, 1], [40, 0, 1]]])
    why = explain(Query(disc, Plate(pitch=20, peg_radius=3)))
    assert why.contacts == 0 and why.no_contacts == NoFixture("shape", WIDE.wording)
    far = explain(Query(load("widget"), Vise(pitch=300, columns=1, peg_radius=3)))
    assert (
        far.contacts == 0
        and str(far.no_contacts) == "No four pegs of the two jaws can touch the part at the same time."
    )
    assert explained(PLAIN, angles=((1.0, 1.001),)).no_contacts is None
