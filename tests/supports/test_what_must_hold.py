"""What SUPPORTS, "What must hold", says of lists of supports."""

from __future__ import annotations

import pytest
from attrs import evolve
from hypothesis import given
from hypothesis import strategies as st

from supports.cases import NAMES, case
from workhold.errors import InputError
from workhold.model.support_request import SpatialLoad, SupportRequest
from workhold.supports.listing import supports_of

CASES = {name: case(name) for name in NAMES}


def named(triple):
    return tuple((one.carrier, one.column, one.row) for one in triple.supports)


def found(one, request=None, loads=None, force=None, best=None):
    asked = one.request if request is None else request
    return supports_of(one.fixture, one.query, asked, one.loads if loads is None else loads, force, best)


@pytest.mark.parametrize("name", NAMES)
@given(height=st.floats(0.5, 11), more=st.floats(0, 1000))
def test_with_all_bands_at_one_height_the_jaw_force_changes_nothing(name, height, more):
    one = CASES[name]
    request = evolve(one.request, band=(height, height))
    low, high = (found(one, request, force=one.jaw_force + extra, best=2) for extra in (0, more))
    for a, b in zip(low.triples, high.triples, strict=True):
        assert a.best.clamp_needed == pytest.approx(b.best.clamp_needed, rel=1e-6, abs=1e-6)
        assert a.best.lift == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("name", NAMES)
@given(up=st.floats(0, 30))
def test_nothing_changes_when_bands_and_loads_are_raised_alike(name, up):
    one = CASES[name]
    low, high = one.request.band
    loads = [evolve(load, heights=tuple(z + up for z in load.heights)) for load in one.loads]
    raised = evolve(one.request, thickness=one.request.thickness + up, band=(low + up, high + up))
    before, after = found(one, force=one.jaw_force, best=3), found(one, raised, loads, one.jaw_force, best=3)
    for a, b in zip(before.triples, after.triples, strict=True):
        assert a.best.clamp_needed == pytest.approx(b.best.clamp_needed, rel=1e-6, abs=1e-6)


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


@pytest.mark.parametrize("name", NAMES)
@given(more=st.floats(0, 3))
def test_a_larger_pad_never_adds_a_triple(name, more):
    one = CASES[name]
    radius = min(one.request.pad_radius + more, min(one.query.toolkit.pitch) / 2)
    before, after = found(one, loads=()), found(one, evolve(one.request, pad_radius=radius), loads=())
    assert {named(t) for t in after.triples} <= {named(t) for t in before.triples}


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
