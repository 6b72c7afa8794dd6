"""Supports and the clamp on top as bodies: pads between plate and part, in holes that the plates have."""

from __future__ import annotations

from pathlib import Path

import pytest
from attrs import evolve

from supports.random_supports import TOOLKITS
from workhold import Vise, Workpiece, design
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc
from workhold.model.bodies import SUPPORT_HEIGHT, BodyKind, BodySizes, FixtureBody, make_part_slabs
from workhold.model.support_bodies import cut_room, list_bodies_with_supports, size_supported_bodies
from workhold.model.support_triples import ChosenSupports, RecountedSupports, Supports, Triple, recount_holes

KITE = Workpiece.from_loops("kite", [[[0, 0, 0], [70, -8, 0.1], [88, 40, 0], [22, 66, 0]]])


PLATE = Workpiece.from_loops("plate", [[[0, 0, 0], [100, 0, 0], [100, 60, 0], [0, 60, 0]]])


def found_in(toolkit: Toolkit, part: Workpiece = KITE) -> Supports:
    """The supports of the best fixture that has some."""
    every = design(part, toolkit, best=10).supports(15, each=40, pad_radius=3, tip_radius=4, inside=3)
    return next(one for one in every if one.triples)


def written_out(found: Supports, triple: Triple) -> RecountedSupports:
    """A set in holes that the plates have."""
    return recount_holes(found.fixture, found.query.toolkit, triple)


CASES = [*((KITE, toolkit) for toolkit in TOOLKITS), (PLATE, Vise(pitch=20, columns=5, peg_radius=3))]


def circles(body: FixtureBody) -> list[tuple[tuple[float, float], float, float, float]]:
    """Centre, radius and heights of the round slabs of a body."""
    out = []
    for slab in body.slabs:
        (one,) = slab.outer
        assert isinstance(one, Arc)
        out.append((one.center, one.radius, slab.low, slab.high))
    return out


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("part", "toolkit"), CASES, ids=lambda one: getattr(one, "kind", one.__class__.__name__)
)
def test_pads_stand_in_holes_of_the_plates_under_the_part(part: Workpiece, toolkit: Toolkit) -> None:
    """Written out, all holes are on the plates and not blocked, and all stays where it was on the part."""
    found = found_in(toolkit, part)
    if part is PLATE:
        assert {triple.travel for triple in found.triples} - {found.fixture.travel}
    for triple in found.triples:
        built = written_out(found, triple)
        fixture, pads = built.fixture, built.supports
        carriers = {one.name: one for one in toolkit.carriers}
        for pad, before in zip(pads, triple.supports, strict=True):
            carrier = carriers[pad.carrier]
            place = carrier.compute_hole_center(pad.column, pad.row, fixture.travel)
            assert place == pytest.approx(fixture.pose.apply(pad.x, pad.y), abs=1e-9)
            assert (pad.x, pad.y) == (before.x, before.y)
        for peg, old in zip(fixture.pegs, found.fixture.pegs, strict=True):
            assert fixture.pose.inverse.apply(peg.x, peg.y) == pytest.approx(
                found.fixture.pose.inverse.apply(old.x, old.y), abs=1e-9
            )
            if len(toolkit.plates) == 2:
                place = carriers[peg.carrier].compute_hole_center(peg.column, peg.row, fixture.travel)
                assert place == pytest.approx((peg.x, peg.y), abs=1e-9)
        if len(toolkit.plates) == 2:
            assert fixture.travel == triple.travel
            for one in (*fixture.pegs, *pads):
                carrier = carriers[one.carrier]
                assert 0 <= one.column < carrier.column_count and one.row >= 0
                assert carrier.rows is None or one.row < carrier.rows
                assert not carrier.is_blocked(one.column, one.row)


@pytest.mark.thorough
def test_heights_and_radii_of_the_bodies() -> None:
    """The part lies at 0 on pads; plates lie below, their holes around the pins; the screw presses on top."""
    found = found_in(Vise(pitch=15, columns=4, peg_radius=2.5))
    chosen = ChosenSupports.from_supports(found)
    triple, fixture, pads = chosen.triple, chosen.recounted.fixture, chosen.pads
    sizes = BodySizes.from_workpiece(KITE, 15, plate_thickness=8, support_height=5)
    bodies = list_bodies_with_supports(chosen, sizes)
    kinds = {kind: [body for body in bodies if body.kind is kind] for kind in BodyKind}
    assert [(slab.low, slab.high) for slab in kinds[BodyKind.PART][0].slabs] == [(0, 15)]
    assert {(slab.low, slab.high) for body in kinds[BodyKind.PLATE] for slab in body.slabs} == {(-13, -5)}
    assert {(slab.low, slab.high) for body in kinds[BodyKind.PEG] for slab in body.slabs} == {(-13, 15)}
    holes = [
        hole[0].center
        for body in kinds[BodyKind.PLATE]
        for hole in body.slabs[0].holes
        if isinstance(hole[0], Arc)
    ]
    for pad, body in zip(pads, kinds[BodyKind.SUPPORT], strict=True):
        pin, cap = circles(body)
        center = pytest.approx(fixture.pose.apply(pad.x, pad.y))
        assert pin == (center, 2.5, -13, -5) and cap == (center, 3.0, -5, 0)
        assert body.name == f"support {pad.hole}" and any(pytest.approx(hole) == pin[0] for hole in holes)
        assert (body.opens is None) == (pad.carrier == "left")
    (clamp,) = kinds[BodyKind.CLAMP]
    at = pytest.approx(fixture.pose.apply(*triple.clamp.at))
    tip, spindle, knob = circles(clamp)
    assert tip[:3] == (at, 4.0, 15) and tip[3] == spindle[2] and spindle[3] == knob[2]


@pytest.mark.parametrize(
    ("center", "holes"),
    [
        ((20, 20), [1, 2]),
        ((20, 4.9), [1]),
        ((70, 30), [1]),
        ((70, 22), [1]),
        ((120, 20), None),
        ((70, 30.5), [1]),
    ],
)
def test_room_for_the_clamp_is_a_well_or_all_above(
    center: tuple[float, float], holes: list[int] | None
) -> None:
    """A circle of 5 mm inside leaves a well; on the border or in a small hole nothing stays above; outside all does."""
    (slab,) = make_part_slabs(
        Workpiece.from_loops("holed", [*PLATE.loops, [[74, 30, -1], [66, 30, -1]]]), 30.0
    )
    pieces = list(cut_room(slab, center, 5.0, 12.0))
    if holes is None:
        assert pieces == [slab]
        return
    assert [len(piece.holes) for piece in pieces] == holes
    assert [piece.low for piece in pieces] == [0.0, 12.0][: len(holes)]
    assert pieces[-1].high == (30.0 if len(holes) == 2 else 12.0)
    assert list(cut_room(slab, center, 5.0, 30.0)) == [slab]


@pytest.mark.thorough
def test_what_has_no_body_and_a_set_that_is_not_there_are_refused(tmp_path: Path) -> None:
    """One sentence each; a GLB file holds the supports by name."""
    found = found_in(TOOLKITS[0])
    with pytest.raises(InputError, match="pads of radius 0 have no body"):
        list_bodies_with_supports(
            ChosenSupports.from_supports(evolve(found, request=evolve(found.request, pad_radius=0)))
        )
    with pytest.raises(InputError, match="there is no set 41 of supports: 40 are listed"):
        ChosenSupports.from_supports(found, 41)
    with pytest.raises(InputError, match="support height -1 is not a length"):
        BodySizes.from_workpiece(KITE, 15, support_height=-1)
    path = tmp_path / "kite.glb"
    found.fixture.save_glb(path, supports=found, best=2)
    pads = ChosenSupports.from_supports(found, 2).pads
    assert all(f"support {pad.hole}".encode() in path.read_bytes() for pad in pads)
    found.fixture.save_glb(path)
    assert b"support" not in path.read_bytes()


@pytest.mark.thorough
def test_pegs_are_as_high_above_the_plates_as_is_asked() -> None:
    """Pegs count from the plates, which lie below the part by the height of the supports."""
    found = found_in(TOOLKITS[0])
    sizes = size_supported_bodies(found, peg_height=17.0, support_height=6.0)
    assert (sizes.top, sizes.floor, sizes.thickness) == (11.0, -6.0, 15.0)
    assert size_supported_bodies(found).floor == -SUPPORT_HEIGHT
