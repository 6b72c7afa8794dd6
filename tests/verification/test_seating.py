"""What a file tells of seating is derived again: what is so holds, and any number or word that is off is refuted."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

import attrs
import pytest

import workhold
from toolkit_results import verify_edited
from workhold import Fence, OpeningVise, Peg, Plate, Pose, Result, Vise, Workpiece
from workhold.completeness import find_first_difference
from workhold.fixels.carrier import WALL
from workhold.seating.solver import SeatingSolver
from workhold.verification.ball_geometry import BallOutline
from workhold.verification.judging import find_order_faults
from workhold.verification.listing import WrittenListing, make_claim, read_listing
from workhold.verification.repeats import describe_stance, find_pattern_faults
from workhold.verification.seating import (
    FloatOutline,
    PartPlacement,
    SeatingJudge,
    StatedSeating,
    find_stop,
    make_wall_contact,
)
from workhold.verification.verify import list_not_shown

WEDGE = Workpiece.from_loops("wedge", [[[0, 0, 0], [70, 0, 0], [25, 55, 0]]])
# With an arc, an inner corner and loose rest.
NOTCH = Workpiece.from_loops(
    "notch", [[[0, 0, 0], [60, 0, 0], [60, 25, 0.3], [35, 30, 0], [35, 45, 0], [0, 45, 0]]]
)
VISE = Vise(pitch=20, columns=2, peg_radius=3)
NOTCH_VISE = Vise(15, 2, 2)
PLATE = Plate(pitch=20, peg_radius=3, columns=6, rows=6)
# With arcs on its hull; the clamp's stroke ends, or its tip meets the fence.
BOWED = Workpiece.from_loops(
    "bowed", [[[0, 0, 0], [60, 0, 0.3], [66, 25, 0.2], [35, 30, 0], [30, 48, 0.4], [4, 45, 0]]]
)
FENCE = Fence(pitch=12, peg_radius=2.5, wall_offset=5, clamp_radius=4, travel=(5, 40))
Fields = dict[str, Any]


@pytest.fixture(scope="module")
def result() -> Result:
    """Some fixtures with the seating of the first."""
    return workhold.design(WEDGE, VISE, seating=4, best=4)


@pytest.fixture(scope="module")
def judge(result: Result) -> SeatingJudge:
    """What knows the wedge and its vise."""
    return SeatingJudge(result.query)


def written(result: Result, path: Path) -> WrittenListing:
    """A result as its file is read."""
    workhold.save(result, path)
    return read_listing(path)


@pytest.fixture(scope="module")
def listing(result: Result, tmp_path_factory: pytest.TempPathFactory) -> WrittenListing:
    """The same as it is read from a file."""
    return written(result, tmp_path_factory.mktemp("seating") / "r.json")


def fault(
    listing: WrittenListing, judge: SeatingJudge, change: Callable[[Fields], Any], index: int = 0
) -> str:
    """What is wrong with the seating of a fixture after a change of its fields."""
    fixture = listing.fixtures[index]
    fields = deepcopy(dict(fixture.seating.fields))
    change(fields)
    claim = attrs.evolve(fixture.seating, fields=fields, seating=told(fields, fixture))
    return judge.find_fault(attrs.evolve(fixture, seating=claim))


def told(fields: Fields, fixture: Any) -> Any:
    """The seating of fields."""
    return type(fixture.seating.seating).from_fields(fields, fixture.pose)


@pytest.mark.thorough
@pytest.mark.parametrize("form", ["json", "npz"])
@pytest.mark.parametrize(
    ("part", "toolkit"),
    [(WEDGE, VISE), (NOTCH, NOTCH_VISE), (WEDGE, PLATE), (BOWED, FENCE)],
    ids=["wedge", "notch", "plate", "fence"],
)
def test_what_is_so_holds(part: Workpiece, toolkit: Any, form: str, tmp_path: Path) -> None:
    made = solved(part, toolkit)
    assert len(made.seating) == 2
    workhold.save(made, tmp_path / f"r.{form}")
    outcome = workhold.verify(tmp_path / f"r.{form}")
    assert outcome.holds and outcome.proven == 2, (outcome.faults, outcome.unproven)


def solved(part: Workpiece, toolkit: Any, known: dict[int, Result] = {}) -> Result:  # noqa: B006
    """Two fixtures with seating, made once."""
    if id(toolkit) not in known:
        known[id(toolkit)] = workhold.design(part, toolkit, seating=2, best=2)
    return known[id(toolkit)]


def leaves(value: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any]]:
    """All numbers and words of fields, and where they are."""
    if isinstance(value, dict | list):
        for key, one in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(one, (*place, key))
    else:
        yield place, value


# What a file alone shows within bounds only: how far something goes.
BOUNDED = ("way_out", "cage", "cage_short", "placing", "depth")


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("part", "toolkit"), [(WEDGE, VISE), (WEDGE, PLATE), (BOWED, FENCE)], ids=["vise", "plate", "fence"]
)
def test_every_number_that_is_off_a_little_is_refuted(part: Workpiece, toolkit: Any, tmp_path: Path) -> None:
    listing = written(solved(part, toolkit), tmp_path / "r.json")
    judge, fields = SeatingJudge(listing.query), listing.fixtures[0].seating.fields
    assert judge.find_fault(listing.fixtures[0]) == ""
    missed = []
    for place, value in leaves(fields):
        if place[0] in BOUNDED or place[-1] in BOUNDED or isinstance(value, str):
            continue
        other = {bool: lambda v: not v, int: lambda v: (v + 1) % 4, type(None): lambda v: 1.0}.get(
            type(value), lambda v: v + 1e-3
        )(value)

        def change(edited: Fields, place: tuple[Any, ...] = place, other: Any = other) -> None:
            for key in place[:-1]:
                edited = edited[key]
            edited[place[-1]] = other

        if not fault(listing, judge, change):
            missed.append((place, value))
    assert not missed


@pytest.mark.thorough
def test_words_and_whole_parts_that_are_off_are_refuted(listing: WrittenListing, judge: SeatingJudge) -> None:
    fields = listing.fixtures[0].seating.fields
    own = next(k for k, seat in enumerate(listing.fixtures[0].seating.seating.seats) if seat.is_own)
    other = next(k for k, seat in enumerate(fields["seats"]) if k != own and seat["kind"] == "fixture")
    opening = fields["capture_opening"]
    for change, words in (
        (lambda f: f["seats"].pop(own), "it has 0 seats in the fixture's own pose"),
        (lambda f: f["seats"].append(f["seats"][own]), "2 seats"),
        (lambda f: f["seats"][other].update(kind="corner"), "is called corner"),
        (lambda f: f["seats"][other].update(kind="unsettled"), "is unsettled, and unsettled does not say so"),
        (lambda f: f["seats"][other]["contacts"].pop(), "is called fixture"),
        (lambda f: f["seats"].pop(other), "wrong_seats says"),
        (lambda f: f.update(capture_opening=None, drop_room=None, way_out=None), "a pass without"),
        (lambda f: f.update({"pass": None}), "a capture opening without a pass"),
        (lambda f: f["pass"]["contacts"].append(f["pass"]["contacts"][0]), "pass"),
        (lambda f: f.update(way_out=opening - 0.01), "way out is nearer"),
        (lambda f: f.update(placing=f["placing"] + 50.0), "placing is farther"),
        (lambda f: f["cage"].update(x=[0.1, 0.2]), "cage leaves out"),
        (lambda f: f["seats"].reverse(), "order"),
    ):
        assert words in fault(listing, judge, change), words


@pytest.mark.thorough
def test_a_fixture_on_the_same_pegs_must_be_among_the_seats(tmp_path: Path) -> None:
    """A seat left out with all counts adjusted is seen where the list has that fixture."""
    result = workhold.design(WEDGE, VISE, types="I", seating=3)
    listing = written(result, tmp_path / "r.json")
    assert not list(find_pattern_faults(listing.fixtures, listing.query))

    def alike(fixture: Any) -> list[Fields]:
        seats = fixture.seating.fields["seats"]
        return [seat for seat in seats if seat["kind"] == "fixture" and not seat["mirrored"]]

    # The first on whose pegs others stand, too.
    place = next(k for k in range(3) if len(alike(listing.fixtures[k])) > 2)
    fixture, found = listing.fixtures[place], 0
    fields = deepcopy(dict(fixture.seating.fields))
    for seat in alike(fixture):
        cut = fields | {"seats": [one for one in fields["seats"] if one != seat]}
        assert len(cut["seats"]) == len(fields["seats"]) - 1
        changed = list(listing.fixtures)
        changed[place] = attrs.evolve(fixture, seating=attrs.evolve(fixture.seating, fields=cut))
        faults = list(find_pattern_faults(changed, listing.query))
        assert all(f"stands on the pegs of fixture {place + 1}," in words for words in faults)
        found += bool(faults)
    assert found > 1


def test_of_a_clamp_whose_direction_is_not_asked_for_no_seat_is_looked_for(tmp_path: Path) -> None:
    """Such a fixture is refuted by name, and stops nothing that is said of the others."""
    workhold.save(solved(WEDGE, PLATE), tmp_path / "r.json")
    data = json.loads((tmp_path / "r.json").read_text())
    listed = {fixture["direction"] for fixture in data["fixtures"]}

    def edit(content: Fields) -> None:
        content["toolkit"]["directions"] = sorted({"-x", "+x", "-y", "+y"} - listed)

    outcome = verify_edited(data, edit, tmp_path)
    assert outcome.refuted == 2
    assert all("which is not asked for" in item.reason for item in outcome.unproven)


def stepped(fixture: Any, toolkit: Any) -> Any:
    """The same fixture two columns and, where nothing keeps it, three rows farther."""
    rows = 0 if toolkit.wall is not None else 3
    (px, py), pegs = toolkit.carriers[0].pitch, []
    for peg in fixture.pegs:
        moved = attrs.evolve(peg, x=peg.x + 2 * px, y=peg.y + rows * py)
        pegs.append(
            moved if peg.is_on_wall else attrs.evolve(moved, column=peg.column + 2, row=peg.row + rows)
        )
    pose = attrs.evolve(fixture.pose, x=fixture.pose.x + 2 * px, y=fixture.pose.y + rows * py)
    return attrs.evolve(fixture, pegs=tuple(pegs), pose=pose)


@pytest.mark.thorough
@pytest.mark.parametrize(("part", "toolkit"), [(WEDGE, PLATE), (BOWED, FENCE)], ids=["plate", "fence"])
def test_what_stands_on_the_same_pegs_is_told_of_every_toolkit(part: Workpiece, toolkit: Any) -> None:
    """The first fixture on whose pegs others stand: all of them are its seats, and none may be left out."""
    every = list(workhold.design(part, toolkit))
    keys = [describe_stance(fixture, toolkit).key for fixture in every]
    place = next(k for k, key in enumerate(keys) if keys.count(key) > 1)
    first, query = every[place], workhold.Query(part, toolkit, seating=1)
    told = SeatingSolver(part, toolkit).solve(first, with_cage=False).to_fields()
    others = [stepped(every[k], toolkit) for k in range(len(every)) if k != place]
    assert describe_stance(stepped(first, toolkit), toolkit).key == keys[place]

    def faults(fields: Fields) -> list[str]:
        claim = make_claim(fields, first.pose, query, "the result", 1)
        return list(find_pattern_faults([attrs.evolve(first, seating=claim), *others], query))

    assert not faults(told)
    missing = [
        faults(told | {"seats": [one for one in told["seats"] if one is not seat]}) for seat in told["seats"]
    ]
    assert sum(map(bool, missing)) >= 2, "the fixture itself, and another"
    assert all("stands on the pegs of fixture 1" in words for found in missing for words in found)


@pytest.mark.thorough
def test_the_order_is_that_of_the_seating(listing: WrittenListing) -> None:
    """Two fixtures with different warnings exchanged, and one told only behind others."""
    fixtures = list(listing.fixtures)
    hardly = attrs.evolve(fixtures[0].seating.seating, capture_opening=0.5)
    worse = attrs.evolve(fixtures[0], seating=attrs.evolve(fixtures[0].seating, seating=hardly))
    untold = attrs.evolve(fixtures[0], seating=None)

    def fault_with(first: Any) -> str:
        asked = listing.query, listing.hardware, listing.least_effective_error
        return next(find_order_faults([first, *fixtures[1:]], *asked), "")

    assert fault_with(fixtures[0]) == ""
    assert "is better than" in fault_with(worse)
    assert "not that of all before it" in fault_with(untold)


@pytest.mark.thorough
def test_a_search_compares_what_a_file_alone_cannot_show(result: Result, tmp_path: Path) -> None:
    path = tmp_path / "r.json"
    workhold.save(result, path)
    assert workhold.verify(path, complete=True).holds
    text = path.read_text()
    fields = result.seating[1].to_fields()
    path.write_text(
        text.replace(f'"way_out": {fields["way_out"]}', f'"way_out": {fields["way_out"] + 0.5}', 1)
    )
    assert path.read_text() != text and workhold.verify(path).holds
    outcome = workhold.verify(path, complete=True)
    assert any("another way_out of the seating" in words for words in outcome.faults)
    assert any("lower pass" in words for words in list_not_shown(VISE, True))
    assert not any("lower pass" in words for words in list_not_shown(VISE))


def test_the_first_other_key_is_told() -> None:
    one: Fields = {"a": 1.0, "b": [{"c": 2.0, "d": None}], "e": "word"}
    assert find_first_difference(one, one) == ""
    assert find_first_difference(one, one | {"a": 1.0 + 1e-5}) == "a"
    assert find_first_difference(one | {"b": [{"c": 2.0, "d": 3.0}]}, one) == "b"
    assert find_first_difference(one | {"b": []}, one) == "b"
    assert find_first_difference(one | {"e": "other"}, one) == "e"


@pytest.mark.thorough
def test_rules_and_counts_of_the_first_must_agree(result: Result, tmp_path: Path) -> None:
    """Of a file whose rules none of its fixtures keeps, or that tells of fewer than were asked."""
    path = tmp_path / "r.json"
    workhold.save(result, path)
    text = path.read_text()
    for count, words in (
        (3, "the seating of more fixtures is stated than of the 3"),
        (2, "the seating of more fixtures is stated than of the 2"),
    ):
        path.write_text(text.replace('"seating": 4,', f'"seating": {count},', 1))
        assert any(words in fault for fault in workhold.verify(path).faults)
    fewer = attrs.evolve(result, seating=result.seating[:3])
    workhold.save(fewer, path)
    assert any("asked for, but it is stated of 3" in fault for fault in workhold.verify(path).faults)
    ruled = attrs.evolve(fewer, query=attrs.evolve(result.query, foolproof=True))
    workhold.save(ruled, path)
    faults = workhold.verify(path).faults
    assert any("are listed for their seating, but it is stated of 3" in fault for fault in faults)
    assert any("the note is missing" in fault for fault in faults)


@pytest.mark.thorough
def test_a_seat_with_a_peg_in_the_part_is_refuted(tmp_path: Path) -> None:
    """Two faces slide between two pegs, and a third peg would be inside, below an inner corner."""
    listing = written(solved(NOTCH, NOTCH_VISE), tmp_path / "r.json")
    judge, own = SeatingJudge(listing.query), {"jaw_separation": 16.246149047}
    pose = {"theta_deg": 232.247998694, "x": 9.972944769, "y": 39.612640625}
    contacts = [{"peg": 1, "face": 0}, {"peg": 3, "face": 4}]
    seat = {"kind": "loose", "pose": pose, "difference": 7.496592209, "mirrored": False, "same_place": False}
    seat |= {"jaw_separation": 23.742741256, "contacts": contacts, "forces": []}
    # On the pegs of one of the two, which are the same part held twice, turned by half.
    found = [
        list(StatedSeating(judge, one, one.seating).find_seat_faults(seat, own)) for one in listing.fixtures
    ]
    assert ["has a peg in the part"] in found


def test_on_a_fence_contacts_touch_it_and_nothing_is_below(tmp_path: Path) -> None:
    """Of a part let down into it, of an arc that does not reach down, of ends exchanged, and of travels all off alike."""
    listing = written(solved(BOWED, FENCE), tmp_path / "r.json")
    judge, fixture = SeatingJudge(listing.query), listing.fixtures[0]
    fields = fixture.seating.fields
    own = next(
        seat for seat, told in zip(fields["seats"], fixture.seating.seating.seats, strict=True) if told.is_own
    )

    def faults(**changes: Any) -> list[str]:
        return list(StatedSeating(judge, fixture, fixture.seating).find_seat_faults(own | changes, own))

    assert not faults()
    for off in (-1e-3, 1e-3):
        words = faults(pose=own["pose"] | {"y": own["pose"]["y"] + off})
        assert {"has peg 1 not where it is said to touch", "has peg 2 not where it is said to touch"} <= set(
            words
        )
        assert ("has the part in the fence" in words) == (off < 0.0)
    # Its lowest point would be beyond its end, which is at the corner.
    arcs = Workpiece.from_loops("arcs", [[[0, 0, 0], [60, 0, 0.1], [60, 40, 0], [0, 40, 0]]])
    for theta, is_inside in ((0.0, False), (-80.0, True), (-90.0, True), (-150.0, False)):
        place = PartPlacement(theta, 0.0, 0.0)
        touched = make_wall_contact(BallOutline.from_workpiece(arcs), {"peg": 1, "face": 1}, place)
        assert touched.is_inside == is_inside, theta
    ends = {one["peg"]: one for one in own["contacts"] if one["peg"] in (1, 2)}
    exchanged = [
        ends[3 - one["peg"]] | {"peg": one["peg"]} if one["peg"] in ends else one for one in own["contacts"]
    ]

    def exchange(edited: Fields) -> None:
        next(seat for seat in edited["seats"] if seat == own)["contacts"] = exchanged

    assert "does not have the fixture's contacts" in fault(listing, judge, exchange)

    def shift(edited: Fields) -> None:
        for told in (*edited["seats"], edited["pass"]):
            told["jaw_separation"] += 1e-3
        edited["stop"] += 1e-3

    assert "is not the fixture's" in fault(listing, judge, shift)


@pytest.mark.parametrize("mirrored", [False, True])
def test_the_lowest_point_of_a_part_is_that_of_its_box(mirrored: bool) -> None:
    rough = FloatOutline.from_segments(BallOutline.from_workpiece(BOWED).segments, BOWED)
    part = BOWED.turned_over if mirrored else BOWED
    for theta in range(0, 360, 7):
        low = part.apply_pose(Pose(theta, 3.0, 5.0)).bounds[1]
        assert rough.compute_lowest_height(PartPlacement(theta, 3.0, 5.0, mirrored)) == pytest.approx(
            low, abs=1e-9
        )


def test_what_stops_a_clamp_or_jaws() -> None:
    """The end of the stroke, a locator in its way, the fence below its tip; of jaws the gap, or the largest opening."""
    fence = Fence(pitch=20, peg_radius=3, wall_offset=10, clamp_radius=4, travel=(5, 50), directions=["-y"])
    locator, on_wall = Peg("plate", 0, 0, 0.0, 10.0, 0, 0.0), Peg(WALL, 0, 0, 5.0, 0.0, 0, 0.0)

    def stop(toolkit: Any, tip: Peg) -> float | None:
        return find_stop([locator, *([on_wall] if toolkit is fence else []), tip], toolkit, -20.0)

    assert stop(fence, Peg("clamp -y", 1, 3, 20.0, 50.0, 0, 0.0)) == -50.0
    # From hole 2 up at 50, the tip at 30: it goes 26 farther.
    assert stop(fence, Peg("clamp -y", 1, 2, 20.0, 30.0, 0, 0.0)) == pytest.approx(-46.0)
    # Straight above the locator, from 30: it goes 13 farther.
    assert stop(fence, Peg("clamp -y", 0, 2, 0.0, 30.0, 0, 0.0)) == pytest.approx(-33.0)
    plate = Plate(pitch=20, peg_radius=3, directions=["+x"])
    # Nothing before it, and a locator behind it.
    assert stop(plate, Peg("clamp +x", 0, 2, 10.0, 10.0, 0, 0.0)) is None
    assert stop(plate, Peg("clamp +x", 0, 2, -10.0, 14.0, 0, 0.0)) == pytest.approx(-20.0 - 10.0 + 20.0**0.5)
    jaws = [Peg("left", 0, 0, 0.0, 0.0, 0, 0.0), Peg("right", 0, 0, 40.0, 0.0, 0, 0.0)]
    assert find_stop(jaws, Vise(20, 2, 3, min_gap=15), 18.0) == pytest.approx(-7.0)
    assert find_stop(jaws, OpeningVise(20, 2, 3, max_opening=70), 18.0) == 70.0
    assert find_stop(jaws, OpeningVise(20, 2, 3), 18.0) is None
