"""Pegs with a flat: what they find is told by round ones, both engines agree, and every fixture is proven."""

from __future__ import annotations

import csv
import json
from itertools import pairwise
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from attrs import evolve

import workhold
from toolkit_results import NOTCHED, assert_all_proven, part
from workhold import Fence, Fixture, InputError, Load, Plate, Query, Vise, design
from workhold.algebra import find_fixtures_by_algebra
from workhold.contact.features import list_contact_features
from workhold.files.toolkit_file import load_toolkit
from workhold.fixels.pegs import PegFlat, compute_standoff, convert_flat
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.offset import list_trimmed_offsets
from workhold.geometry.segment import Arc, Line
from workhold.statics.loads import compute_load_cases
from workhold.verification import verify_file, verify_fixture

TRIANGLE = [[0, 0, 0], [60, 0, 0], [20, 45, 0]]
# An acute tooth: behind it the body of a peg whose flat lies on one side comes near to the other.
TOOTH = [[0, 0, 0], [64, 4, 0], [30, 18, 0], [36, 44, 0], [2, 40, 0]]
EAR = [[0, 0, 0], [50, 0, 0], [50, 30, 1], [0, 30, 0]]
RADIUS, DISTANCE = 3.0, 1.5


def key(fixture: Fixture) -> tuple[Any, ...]:
    """What tells fixtures apart."""
    pegs = tuple((peg.carrier, peg.column, peg.row, peg.face) for peg in fixture.pegs)
    return (
        fixture.direction,
        pegs,
        round(fixture.pose.theta_deg, 5),
        round(fixture.pose.x, 5),
        round(fixture.pose.y, 5),
    )


def body_is_clear(fixture: Fixture, loop: list[list[float]]) -> bool:
    """Whether discs of the peg radius about the pegs in holes keep clear of all faces that they do not touch."""
    inverse, corners = fixture.pose.inverse, [np.array(corner[:2]) for corner in loop]
    for peg in fixture.pegs:
        if peg.carrier == "wall" or peg.carrier.startswith("clamp"):
            continue
        center = np.array(inverse.apply(peg.x, peg.y), float)
        for number, (start, end) in enumerate(pairwise([*corners, corners[0]])):
            if number != peg.face:
                share = np.clip((center - start) @ (end - start) / ((end - start) @ (end - start)), 0.0, 1.0)
                if np.hypot(*(center - start - share * (end - start))) < RADIUS:
                    return False
    return True


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("loop", [TRIANGLE, TOOTH])
@pytest.mark.parametrize(
    ("flat", "thin"),
    [
        (Vise(9, 2, RADIUS, min_gap=9, flat=DISTANCE), Vise(9, 2, DISTANCE, min_gap=9)),
        (
            Plate((15, 12), RADIUS, columns=5, rows=5, clamp_radius=2, flat=DISTANCE),
            Plate((15, 12), DISTANCE, columns=5, rows=5, clamp_radius=2),
        ),
        (
            Fence((9, 8), RADIUS, wall_offset=7, clamp_radius=2, flat=DISTANCE),
            Fence((9, 8), DISTANCE, wall_offset=7, clamp_radius=2),
        ),
    ],
)
def test_on_straight_faces_they_are_thinner_round_ones_that_keep_clear(
    loop: Any, flat: Toolkit, thin: Toolkit
) -> None:
    """All fixtures of pegs as thin as the flat's distance but those whose thicker body comes near another face."""
    found = {key(fixture) for fixture in design(part(loop), flat)}
    thinner = list(design(part(loop), thin))
    # On a plate the tip of a clamp keeps off thicker locators, too.
    apart = RADIUS + 2.0 if isinstance(flat, Plate) else 0.0
    wanted = {key(one) for one in thinner if body_is_clear(one, loop) and tip_is_off(one, apart)}
    assert 10 < len(wanted) < len(thinner)
    assert found == wanted


def tip_is_off(fixture: Fixture, apart: float) -> bool:
    """Whether the tip of the clamp is so far in mm from all locators."""
    *locators, tip = (peg for peg in fixture.pegs if peg.carrier != "wall")
    return not apart or all(np.hypot(peg.x - tip.x, peg.y - tip.y) >= apart for peg in locators)


@pytest.mark.thorough
def test_a_flat_at_the_radius_is_none() -> None:
    """Nothing but the angles differs from round pegs."""
    round_one, flat = (design(part(NOTCHED), Vise(9, 2, 3, flat=flat)) for flat in (None, 3))
    assert [key(one) for one in round_one] == [key(one) for one in flat] and len(flat) > 20
    assert all(one.quality == other.quality for one, other in zip(round_one, flat, strict=True))
    assert any(peg.flat_deg is not None for peg in flat[0].pegs)
    assert all(peg.flat_deg is None for fixture in round_one for peg in fixture.pegs)


@pytest.mark.thorough
@pytest.mark.parametrize("loop", [pytest.param(NOTCHED, marks=pytest.mark.prove), EAR])
def test_both_engines_agree(loop: Any) -> None:
    """The curves and the paper's algebra, which share no solver, on lines and arcs."""
    vise = Vise((9, 8), 2, 2.5, flat=(1.5, 1.0))
    curves, algebra = design(part(loop), vise), find_fixtures_by_algebra(Query(part(loop), vise))
    assert len(curves) > 20 and {key(one) for one in curves} == {key(one) for one in algebra}


TOOLKITS = [
    Vise((9, 8), 2, 2.5, flat=(1.5, 1.0)),
    Plate((16, 14), 3, flat=2.2, columns=5, rows=5, travel=(4, 40)),
    Plate((16, 14), 3, flat=2.2, columns=5, rows=5, clamps=2),
    Fence((10, 10), 3, flat=2, wall_offset=6),
    Fence((10, 10), 3, flat=2, wall_offset=6, clamps=2),
]


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("toolkit", TOOLKITS, ids=lambda one: f"{one.kind}-{getattr(one, 'clamps', 0)}")
def test_everything_listed_is_proven_and_written(toolkit: Toolkit, tmp_path: Path) -> None:
    """In files of both forms; the angles in the file are those at which the flats lie on their faces."""
    result = design(part(NOTCHED), toolkit, best=25)
    assert_all_proven(result, tmp_path)
    for again in map(workhold.open, (tmp_path / "r.json", tmp_path / "r.npz")):
        assert [key(one) for one in again] == [key(one) for one in result] and again.toolkit == toolkit
    data = json.loads((tmp_path / "r.json").read_text())
    standing = [peg for peg in result[0].pegs if peg.carrier != "wall"]
    assert data["fixtures"][0]["flats"] == [peg.flat_deg for peg in standing]
    assert (data.get("vise") or data["toolkit"])["flat"]["distance"] == toolkit.carriers[0].least_standoff
    for peg, angle in zip(standing, data["fixtures"][0]["flats"], strict=True):
        face = {one.number: one.segment for one in result.workpiece.faces}[peg.face]
        assert (angle is None) == (not isinstance(face, Line) or peg.carrier.startswith("clamp"))
        if angle is not None:
            normal = np.array(result[0].pose.turn(*face.compute_normal()))
            assert np.allclose([np.cos(np.radians(angle)), np.sin(np.radians(angle))], -normal, atol=1e-9)
            # So far from the face as the flat is from the centre.
            start = np.array(result[0].pose.apply(*face.start))
            off = (np.array([peg.x, peg.y]) - start) @ normal
            assert off == pytest.approx(toolkit.carriers[0].least_standoff, abs=1e-8)


def test_wrong_angles_in_a_file_are_refuted(tmp_path: Path) -> None:
    """Another angle, one too many, one too few, and what is not a list of angles."""
    path = tmp_path / "r.json"
    workhold.save(design(part(NOTCHED), TOOLKITS[0], best=5), path)
    data = json.loads(path.read_text())
    flats = data["fixtures"][0]["flats"]
    first = next(k for k, angle in enumerate(flats) if angle is not None)
    for value, words in ((flats[first] + 0.01, "degrees past its face"), (None, "has a flat on its face")):
        data["fixtures"][0]["flats"] = [value if k == first else angle for k, angle in enumerate(flats)]
        path.write_text(json.dumps(data))
        (item,) = verify_file(path).unproven
        assert item.verdict == "refuted" and words in item.reason
    data["fixtures"][0]["flats"] = flats
    data["vise"]["flat"] = None
    path.write_text(json.dumps(data))
    assert verify_file(path).refuted == 5
    data["fixtures"][0]["flats"] = flats[:2]
    path.write_text(json.dumps(data))
    with pytest.raises(InputError, match="flats is not one number or null for each peg"):
        verify_file(path)


def test_features_of_flats_end_where_the_body_meets_another_face() -> None:
    """On a square block: at a corner the round body would touch the next face, sqrt(rho^2 - distance^2) along."""
    block = part([[0, 0, 0], [40, 0, 0], [40, 30, 0], [0, 30, 0]])
    reach = sqrt(RADIUS**2 - DISTANCE**2)
    for feature in list_contact_features(block, RADIUS, PegFlat(DISTANCE)):
        face = block.faces[feature.face].segment
        assert isinstance(face, Line) and isinstance(feature.segment, Line)
        assert feature.segment.length == pytest.approx(face.length - 2 * reach)
    arcs = [
        f
        for f in list_contact_features(part(EAR), RADIUS, PegFlat(DISTANCE))
        if not isinstance(f.segment, Line)
    ]
    (arc,) = arcs
    assert arc.segment.radius == pytest.approx(25 + RADIUS)
    segments = [face.segment for face in block.faces]
    assert list_trimmed_offsets(segments, RADIUS, RADIUS) == list_trimmed_offsets(segments, RADIUS)


def test_keeping_their_place() -> None:
    """A vise's and a plate's flat, in what way it is given; and what is refused."""
    wide = Vise(9, 2, 3, flat=1.5)
    assert wide.flat == PegFlat(1.5, sqrt(9 - 2.25)) and Vise(9, 2, 3, flat=(1.5, 1)).flat == PegFlat(
        1.5, 1.0
    )
    assert convert_flat({"distance": 2, "half_width": 1}) == PegFlat(2.0, 1.0) and convert_flat(None) is None
    assert evolve(wide, columns=3).flat == wide.flat
    for value, words in (
        (3.5, "a peg of radius 3 mm cannot have a flat 3.5 mm from its centre"),
        (-1, "-1 mm from its centre"),
        ((1.5, 2.7), "half a width of 2.7 mm"),
        ((1.5, -1), "half a width of -1 mm"),
        ("wide", "flat 'wide' cannot be used"),
        ((1, 2, 3), "cannot be used"),
        ({"width": 2}, "cannot be used"),
        (float("nan"), "nan mm from its centre"),
    ):
        for made in (lambda flat: Vise(9, 2, 3, flat=flat), lambda flat: Plate(9, 3, flat=flat)):
            with pytest.raises(InputError, match=words):
                made(value)


@pytest.mark.parametrize("distance", [0.0, 1.0, 3.0, 3.9])
def test_the_widest_flat_that_is_named_can_be_made(distance: float) -> None:
    """Half its width is an irrational number most often, and is rounded down."""
    with pytest.raises(InputError, match=r"give up to ([\d.]+)\.$") as told:
        Vise(9, 2, 4, flat=(distance, 4.5))
    named = float(str(told.value).split("give up to ")[1][:-1])
    assert Vise(9, 2, 4, flat=(distance, named)).flat == PegFlat(distance, named)


def test_a_toolkit_file_and_a_table(tmp_path: Path) -> None:
    """In inches; in a spreadsheet each peg's angle stands behind all else."""
    path = tmp_path / "flat.toml"
    path.write_text(
        'unit = "inch"\nkind = "plate"\npitch = 0.75\npeg_radius = 0.125\nflat = [0.1, 0.05]\nclamps = 2\n'
    )
    fields = load_toolkit(path).fields
    toolkit = Plate(**fields, columns=4, rows=4)
    assert toolkit.flat == PegFlat(2.54, 1.27)
    result = design(part(NOTCHED), toolkit, best=3)
    workhold.save(result, tmp_path / "r.csv")
    rows = list(csv.DictReader((tmp_path / "r.csv").open()))
    for row, fixture in zip(rows, result, strict=True):
        told = [row[f"flat{number}_deg"] for number in range(1, 6)]
        assert told == ["" if peg.flat_deg is None else repr(peg.flat_deg) for peg in fixture.pegs]
        assert told[3:] == ["", ""]


def test_a_frame_has_the_angles() -> None:
    """As the table for a spreadsheet has them; NaN where there is none."""
    pytest.importorskip("pandas", reason="the extra 'tables' is not installed")
    result = design(part(NOTCHED), TOOLKITS[4], best=3)
    frame = result.to_pandas()
    for number in range(1, 4):
        assert f"flat{number}_deg" in frame.columns
    for row, fixture in zip(frame.to_dict("records"), result, strict=True):
        told = [row[f"flat{number}_deg"] for number in range(1, 4)]
        wanted = [peg.flat_deg for peg in fixture.pegs if peg.carrier != "wall"]
        assert [None if np.isnan(angle) else angle for angle in told] == wanted


def test_the_margin_counts_from_where_the_body_meets_another_face() -> None:
    """A verification knows the ends of a flat's way as the search does."""
    vise = Vise(9, 2, RADIUS, flat=DISTANCE)
    for fixture in design(part(TRIANGLE), vise, best=5):
        distance = fixture.quality["end_distance"]
        verdicts = [
            verify_fixture(fixture, part(TRIANGLE), vise, contact_margin=distance + more).verdict
            for more in (-0.01, 0.01)
        ]
        assert verdicts == ["proven", "refuted"]


def test_forces_act_where_the_flat_lies() -> None:
    """The centre stands so far from a line and from an arc; with friction that is where the lever is counted from."""
    line, arc = (
        next(f.segment for f in part(EAR).faces if isinstance(f.segment, kind)) for kind in (Line, Arc)
    )
    assert (
        compute_standoff(3.0, PegFlat(1.5), line),
        compute_standoff(3.0, PegFlat(1.5), arc),
        compute_standoff(3.0, None, line),
    ) == (
        1.5,
        3.0,
        3.0,
    )
    thick, thin = (Vise(9, 2, radius, min_gap=9, flat=DISTANCE) for radius in (RADIUS, DISTANCE))
    fixture = evolve(design(part(TRIANGLE), thick, best=1)[0], listed=None)
    loads = [Load(((20.0, 10.0),), 100.0)]
    told = [compute_load_cases(fixture, part(TRIANGLE), vise, loads, None, 0.2)[0] for vise in (thick, thin)]
    assert told[0].needed_with_friction == pytest.approx(told[1].needed_with_friction)
