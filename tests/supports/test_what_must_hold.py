"""What SUPPORTS, "What must hold", says of lists of supports."""

from __future__ import annotations

import pytest
from attrs import evolve
from hypothesis import given, settings
from hypothesis import strategies as st

from supports.cases import NAMES, Case, case, case_of
from supports.turned_cases import half_turned, mirrored, turned
from workhold import circle_zone
from workhold.errors import InputError
from workhold.model.support_request import SpatialLoad, SupportRequest
from workhold.supports.listing import find_supports
from workhold.verification.supports import SupportsJudge

CASES = {name: case(name) for name in NAMES}


def named(triple):
    return tuple((one.carrier, one.column, one.row) for one in triple.supports)


def found(one, request=None, loads=None, force=None, best=None):
    asked = one.request if request is None else request
    return find_supports(one.fixture, one.query, asked, one.loads if loads is None else loads, force, best)


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
@given(height=st.floats(0.5, 11), more=st.floats(0, 1000))
@settings(max_examples=20)
def test_with_all_bands_at_one_height_the_jaw_force_changes_nothing(name, height, more):
    one = CASES[name]
    request = evolve(one.request, band=(height, height))
    low, high = (found(one, request, force=one.jaw_force + extra, best=2) for extra in (0, more))
    for a, b in zip(low.triples, high.triples, strict=True):
        assert a.best.clamp_needed == pytest.approx(b.best.clamp_needed, rel=1e-6, abs=1e-6)
        assert a.best.lift == pytest.approx(0, abs=1e-9)


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
@given(up=st.floats(0, 30))
@settings(max_examples=20)
def test_nothing_changes_when_bands_and_loads_are_raised_alike(name, up):
    one = CASES[name]
    low, high = one.request.band
    loads = [evolve(load, heights=tuple(z + up for z in load.heights)) for load in one.loads]
    raised = evolve(one.request, thickness=one.request.thickness + up, band=(low + up, high + up))
    before, after = found(one, force=one.jaw_force, best=3), found(one, raised, loads, one.jaw_force, best=3)
    for a, b in zip(before.triples, after.triples, strict=True):
        assert a.best.clamp_needed == pytest.approx(b.best.clamp_needed, rel=1e-6, abs=1e-6)


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_a_thrust_inside_the_triangle_alone_needs_no_clamp(name):
    one = CASES[name]
    everything = found(one, loads=())
    for triple in everything.triples[::25]:
        center = tuple(sum(pad[k] for pad in ((p.x, p.y) for p in triple.supports)) / 3 for k in (0, 1))
        thrust = [SpatialLoad(points=[center], axial=500)]
        loaded = {named(t): t for t in found(one, loads=thrust, force=0.0).triples}
        assert loaded[named(triple)].best.clamp_needed == 0
        assert loaded[named(triple)].best.support_force == pytest.approx(500 / 3)


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
@given(more=st.floats(0, 3))
@settings(max_examples=20)
def test_a_larger_pad_never_adds_a_triple(name, more):
    one = CASES[name]
    radius = min(one.request.pad_radius + more, min(one.query.toolkit.pitch) / 2)
    before, after = found(one, loads=()), found(one, evolve(one.request, pad_radius=radius), loads=())
    assert {named(t) for t in after.triples} <= {named(t) for t in before.triples}


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
@given(x=st.floats(0, 1), y=st.floats(0, 1), radius=st.floats(0, 12), more=st.floats(0, 6))
@settings(max_examples=8)
def test_a_larger_zone_never_adds_a_triple(name, x, y, radius, more):
    """Neither where supports may not stand nor where the clamp may not; a zone that is added is no less."""
    one = CASES[name]
    x0, y0, x1, y1 = one.query.workpiece.bounds
    place = (x0 + x * (x1 - x0), y0 + y * (y1 - y0))
    for key, own in (("bottom_zones", one.request.bottom_zones), ("top_zones", one.request.top_zones)):
        lists = [one.request] + [
            evolve(one.request, **{key: [*own, circle_zone(*place, r)]})
            for r in (radius + 0.1, radius + more + 0.1)
        ]
        names = [{named(t) for t in found(one, request, loads=()).triples} for request in lists]
        assert names[0] >= names[1] >= names[2]


@pytest.mark.parametrize("name", ["bracketL", "plate100"])
def test_half_the_pitch_with_all_holes_kept_never_loses_a_triple(name):
    """Every hole is one of the lattice of half the pitch with 2 c - 1 columns; its numbers are twice as large."""
    one = CASES[name]
    x0, _, x1, y1 = one.query.workpiece.bounds
    # So many triples of the fine lattice would take long: supports keep to a part of the underside.
    zones = [*one.request.bottom_zones, circle_zone(x0, y1, 0.45 * (x1 - x0))]
    radius = min(one.query.toolkit.pitch) / 4
    request = evolve(one.request, pad_radius=radius, pad_margin=radius / 2, bottom_zones=zones)
    truth, fixture = one.truth, one.truth["fixture"]
    vise = truth["vise"] | {
        "pitch": [length / 2 for length in truth["vise"]["pitch"]],
        "columns": 2 * truth["vise"]["columns"] - 1,
    }
    pegs = [peg | {"column": 2 * peg["column"], "row": 2 * peg["row"]} for peg in fixture["pegs"]]
    fine = case_of(name, truth | {"vise": vise, "fixture": fixture | {"pegs": pegs}})
    assert fine.query.toolkit.min_gap == one.query.toolkit.min_gap
    before, after = found(one, request, loads=()), found(fine, request, loads=())
    twice = {tuple((jaw, 2 * column, 2 * row) for jaw, column, row in named(t)) for t in before.triples}
    assert 0 < len(twice) < len(after.triples)
    assert twice <= {named(t) for t in after.triples}


def same_figures(one: Case, other: Case, renamed) -> None:
    """All triples of one case are those of the other under their other names, with the same figures."""
    before, after = found(one, force=one.jaw_force), found(other, force=other.jaw_force)
    mine = {frozenset(map(renamed, named(t))): t for t in before.triples}
    assert before.positions == after.positions
    assert mine.keys() == {frozenset(named(t)) for t in after.triples}
    for triple in after.triples:
        own = mine[frozenset(named(triple))]
        assert (triple.travel, triple.standing, triple.overhang, triple.arm) == pytest.approx(
            (own.travel, own.standing, own.overhang, own.arm), rel=1e-7, abs=1e-7
        )
        assert (triple.given is None) == (own.given is None)
        for a, b in ((own.best, triple.best), (own.given, triple.given)):
            if a is not None and b is not None:
                assert b.clamp_needed == pytest.approx(a.clamp_needed, rel=1e-6, abs=1e-6)
                assert b.support_force == pytest.approx(a.support_force, rel=1e-5, abs=1e-5)
    assert after.jaw_force == pytest.approx(before.jaw_force)


@pytest.mark.thorough
@pytest.mark.thinned(3)
@pytest.mark.parametrize("name", NAMES)
@given(angle=st.floats(-360, 360), x=st.floats(-300, 300), y=st.floats(-300, 300))
@settings(max_examples=4)
def test_a_part_turned_in_its_drawing_has_the_same_figures(name, angle, x, y):
    other, renamed = turned(CASES[name].truth, angle, (x, y))
    same_figures(CASES[name], case_of(name, other), renamed)


@pytest.mark.parametrize("name", NAMES)
def test_part_and_vise_in_a_mirror_have_the_same_figures(name):
    other, renamed = mirrored(CASES[name].truth)
    same_figures(CASES[name], case_of(name, other), renamed)


@pytest.mark.parametrize("name", ["large4Handle", "plate100"])
def test_a_vise_given_a_half_turn_has_the_same_figures(name):
    """With all pegs at one height: elsewhere it counts which of the jaws keeps its force."""
    own = CASES[name].truth
    truth = own | {"heights": own["heights"] | {"band": [5, 5]}}
    other, renamed = half_turned(truth)
    same_figures(case_of(name, truth), case_of(name, other), renamed)


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_at_the_clamp_force_needed_no_support_pulls_and_one_is_about_to_let_go(name):
    """The six equations of balance, solved anew at all corners of the bands under all loads."""
    one = CASES[name]
    everything = found(one, force=one.jaw_force)
    judge = SupportsJudge(one.query, one.fixture, everything.request, everything.loads, one.jaw_force)
    needed = 0
    for triple in everything.triples:
        solved = judge.solve_balances([(pad.x, pad.y) for pad in triple.supports])
        least, most = judge.find_extremes(solved)
        for figures in filter(None, (triple.best, triple.given)):
            clamped = figures.clamp_needed * judge.compute_shares(solved, figures.at)
            slack = 1e-7 * max(figures.clamp_needed, abs(most).max())
            assert (clamped + least).min() >= -slack
            assert (clamped + most).max() == pytest.approx(figures.support_force, rel=1e-6)
            if figures.clamp_needed > 0:
                assert (clamped + least).min() <= slack
                needed += 1
    assert needed > 10


@pytest.mark.parametrize(
    "wrong", [{"pad_radius": -1}, {"thickness": 0}, {"tip_radius": 0}, {"band": (9, 3)}, {"inside": 0}]
)
def test_what_cannot_be_is_refused_in_one_sentence(wrong):
    with pytest.raises(InputError, match="cannot"):
        SupportRequest(**({"thickness": 12, "pad_radius": 4, "tip_radius": 5} | wrong))


def test_pads_that_could_overlap_and_a_weak_jaw_are_refused():
    one = CASES["bracketL"]
    with pytest.raises(InputError, match="would overlap"):
        found(one, evolve(one.request, pad_radius=7))
    with pytest.raises(InputError, match="under the load 'side milling'"):
        found(one, force=one.truth["jaw_needed"] - 1)
