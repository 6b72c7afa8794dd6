"""Seats under straps: complete against a slow enumeration and counts by hand, with straps, files and refusals."""

from __future__ import annotations

import json
from math import comb

import numpy as np
import pytest

import workhold
from polygon_seats import polygon_seats
from slow_seats import faces_of, slow_seats
from strap_program import force_by_other_program
from workhold import InputError, Load, Plate, Query, Restrictions, StrapPlate, Workpiece, circle_zone
from workhold.model.jaw_hold import find_largest_force
from workhold.model.pose import Pose
from workhold.search.seat_search import find_seats
from workhold.supports.straps import StrapSearch, make_question
from workhold.supports.straps_over_supports import PadPlaces, StrappedTriple, SupportedStraps
from workhold.supports.words_of_straps import describe_assumptions

BLOCK = Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
TRIANGLE = Workpiece.from_points("triangle", [(0, 0), (61, 0), (20, 47)])
ELL = Workpiece.from_points("ell", [(0, 0), (60, 0), (60, 22), (24, 22), (24, 58), (0, 58)])
OBLONG = Workpiece.from_loops("oblong", [[[0, 0, 0], [50, 0, 1], [50, 23, 0], [0, 23, 1]]])
LENS = Workpiece.from_loops("lens", [[[0, 0, 0.3], [52, 3, 0.55], [31, 40, 0]]])
LOAD = Load(points=(50, 30), force=300, directions=20)
# Lopsided holes for bolts, so that no half turn makes two seats the same.
LOPSIDED = {"bolt_pitch": 20, "bolt_offset": (3, 0)}


def seats_of(part, pitch=20, columns=4, rows=4, **further):
    """The seats as the slow way has them: holes, faces and angle."""
    if further.pop("is_lopsided", True):
        further |= {"bolt_pitch": pitch, "bolt_offset": (pitch / 7, 0)}
    found = find_seats(Query(part, StrapPlate(pitch, 3, columns, rows, **further)))
    table = found.table
    return found, [
        (tuple(zip(c, r, strict=True)), tuple(f), t)
        for c, r, f, t in zip(
            table.column.tolist(),
            table.row.tolist(),
            table.face.tolist(),
            np.degrees(table.theta % (2 * np.pi)).tolist(),
            strict=True,
        )
    ]


def is_among(one, others):
    holes, faces, theta = one
    return any(h == holes and f == faces and abs((t - theta + 180) % 360 - 180) < 1e-4 for h, f, t in others)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("part", "pitch", "size"),
    [(TRIANGLE, 20, 3), (ELL, 25, 3), (OBLONG, 20, 3), (LENS, 20, 3)],
    ids=lambda one: getattr(one, "name", None),
)
def test_seats_are_those_of_a_slow_enumeration(part, pitch, size):
    """Each that is found there, and is not a contact at an end and no double root, is listed, and nothing else is."""
    found, ours = seats_of(part, pitch, size, size)
    assert not found.proof.undecided
    theirs = list(slow_seats(part, 3.0, pitch, size, size))
    for holes, faces, theta, determinant, is_sure in theirs:
        if is_sure and determinant > 1e-5:
            assert is_among((holes, faces, theta), ours), (holes, faces, theta, determinant)
    plate, faces = (
        StrapPlate(pitch, 3, size, size).plates[0],
        {one.number: one for one in faces_of(part, 3.0)},
    )
    for k in range(len(found.table)):
        pose = Pose(np.degrees(found.table.theta[k]), *found.table.position[k])
        for column, row, face in zip(
            *(v[k] for v in (found.table.column, found.table.row, found.table.face)), strict=True
        ):
            point = np.array(pose.inverse.apply(*map(float, plate.compute_hole_center(column, row))))
            assert abs(faces[face].gap(point[None])[0]) < 1e-7 and faces[face].has(point) >= 0
    assert len(ours) > 20


WINDOW = Workpiece.from_loops(
    "window",
    [
        [[0, 0, 0], [71, 0, 0], [71, 54, 0], [0, 54, 0]],
        [[10, 10, 0], [10, 44, 0], [59, 42, 0], [61, 10, 0]],
    ],
)
SLOTTED = Workpiece.from_points(
    "slotted", [(0, 0), (70, 0), (70, 40), (50, 40), (50, 14), (20, 14), (20, 40), (0, 40)]
)
KITE = Workpiece.from_points("kite", [(0, 0), (56, 6), (48, 44), (10, 37)])
# The part, the locators' radius, pitch, columns and rows, and how many seats are known to be there.
COUNTED = (
    (BLOCK, 3.0, (20, 20), (8, 6), 4072),
    (ELL, 3.0, (20, 20), (8, 6), 1036),
    (WINDOW, 2.5, (20, 16), (4, 5), None),
    (SLOTTED, 4.0, (20, 20), (5, 5), None),
    (KITE, 3.0, (16, 16), (5, 5), None),
)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("part", "radius", "pitch", "holes", "count"), COUNTED, ids=[one[0].name for one in COUNTED]
)
def test_seats_of_straight_sides_are_those_of_closed_forms(part, radius, pitch, holes, count):
    """One by one: each whose locators are inside their sides and that is not a double root, and nothing else."""
    table = find_seats(
        Query(part, StrapPlate(pitch, radius, *holes, bolt_pitch=pitch, bolt_offset=(3, 0)))
    ).table
    ours = dict[tuple, list[float]]()
    for k in range(len(table)):
        contacts = zip(*(one[k].tolist() for one in (table.column, table.row, table.face)), strict=True)
        ours.setdefault(tuple(sorted(contacts)), []).append(np.degrees(table.theta[k]))
    theirs = list(polygon_seats(part, radius, pitch, *holes))
    matched = 0
    for one in theirs:
        off = [abs((angle - one.theta + 180) % 360 - 180) for angle in ours.get(one.contacts, [])]
        is_listed = min(off, default=360) < 1e-4
        if one.room > 1e-6 and one.determinant > 1e-5:
            assert is_listed, one
        elif one.room < 1e-7 or one.determinant < 1e-7:
            assert not is_listed, one
        matched += is_listed
    assert matched == len(table) == (count or len(table)) > 100


@pytest.mark.thorough
def test_a_locator_in_an_inner_corner_makes_no_seat():
    """It touches two sides there, four contacts of three locators: eight poses of the L, which are left out."""
    at_ends = [one for one in polygon_seats(ELL, 3.0, (20, 20), 8, 6) if one.room < 1e-6]
    assert len(at_ends) == 16
    assert len({(tuple(hole[:2] for hole in one.contacts), round(one.theta, 3)) for one in at_ends}) == 8
    for one in at_ends:
        assert np.hypot(*(one.points - (27, 25)).T).min() < 1e-9


@pytest.mark.parametrize(("wide", "high", "pitch"), [(100, 60, 20), (62, 33, 10), (47, 31, 15)])
def test_a_rectangle_square_to_the_plate_is_counted_by_hand(wide, high, pitch):
    """Two locators on one side and one on a side across it: both pairs of sides, and the part as drawn or across."""
    part = Workpiece.from_points("rectangle", [(0, 0), (wide, 0), (wide, high), (0, high)])
    table = find_seats(Query(part, StrapPlate(pitch, 3))).table
    n, m = (sum(3 < k * pitch < size + 3 for k in range(1, 100)) for size in (wide, high))
    per_way = 4 * (comb(n, 2) * m + n * comb(m, 2))
    square = np.abs((np.degrees(table.theta) + 45) % 90 - 45) < 1e-6
    assert square.sum() == 2 * per_way


@pytest.mark.thorough
def test_half_a_turn_makes_no_other_seat_unless_it_moves_bolts():
    """The contract's 4,072 seats of a rectangle, and half of them where a half turn changes nothing."""
    asked = {"columns": 8, "rows": 6}
    assert len(find_seats(Query(BLOCK, StrapPlate(20, 3, **asked))).table) == 2036
    assert (
        len(find_seats(Query(BLOCK, StrapPlate(20, 3, bolt_pitch=10, bolt_offset=5, **asked))).table) == 2036
    )
    assert len(find_seats(Query(BLOCK, StrapPlate(20, 3, **asked, **LOPSIDED))).table) == 4072


@pytest.mark.thorough
def test_seats_of_clamps_are_among_them():
    """Whatever three locators a clamp presses a part against, or two do."""
    _, ours = seats_of(ELL, 20, 8, 6)
    for clamps, directions in ((1, ("-x", "+y")), (2, [("-x", "-y")])):
        plate = Plate(20, 3, 8, 6, clamps=clamps, directions=directions)
        for fixture in workhold.design(ELL, plate):
            pegs = sorted((peg.column, peg.row, peg.face) for peg in fixture.pegs[:3])
            low = [min(peg[k] for peg in pegs) for k in (0, 1)]
            holes = tuple((a - low[0], b - low[1]) for a, b, _ in pegs)
            assert is_among((holes, tuple(peg[2] for peg in pegs), fixture.pose.theta_deg), ours)


@pytest.mark.thorough
def test_seats_follow_the_part_and_fewer_holes_are_a_subset():
    _, small = seats_of(ELL, 20, 4, 4)
    _, large = seats_of(ELL, 20, 5, 4)
    assert all(is_among(one, large) for one in small) and len(large) > len(small)
    moved = Workpiece.from_points("moved", [(x + 31.7, y - 12.3) for x, y, _ in ELL.loops[0].tolist()])
    _, there = seats_of(moved, 20, 4, 4)
    assert len(there) == len(small) and all(is_among(one, there) for one in small)


@pytest.mark.thorough
def test_rules_leave_fewer_seats():
    plate = StrapPlate(20, 3, 8, 6)
    every = len(find_seats(Query(BLOCK, plate)).table)
    for asked in (
        {"restrictions": Restrictions(avoid=(0,))},
        {"restrictions": Restrictions(angles=((-5, 5),))},
        {"restrictions": Restrictions(touch=(0, 3))},
        {"restrictions": Restrictions(zones=(circle_zone(0, 30, 12),))},
        {"contact_margin": 12.0},
    ):
        table = find_seats(Query(BLOCK, plate, **asked)).table
        assert 0 < len(table) < every
    angled = find_seats(Query(BLOCK, plate, restrictions=Restrictions(angles=((175, 185),)))).table
    assert np.all(np.abs(np.degrees(angled.theta) - 180) <= 5 + 1e-6) and len(angled) > 0


@pytest.fixture(scope="module")
def block():
    asked = {"loads": [LOAD], "thickness": 25, "strapped": 3, "best": 12}
    return workhold.design(BLOCK, StrapPlate(20, 3, 8, 6), **asked)


@pytest.mark.thorough
def test_the_first_seats_have_the_straps_that_need_least(block):
    """As many as asked, in order; straps as the report on a fixture finds them."""
    assert block.found == {"strapped": 2036} and len(block) == 12
    looked_at = [fixture.hold.is_looked_at for fixture in block]
    assert looked_at == [True] * 3 + [False] * 9
    needs = [fixture.hold.clamp_needed for fixture in block[:3]]
    coarse = [float(f"{need:.1e}") for need in needs]
    assert coarse == sorted(coarse)
    first = block[0]
    found = first.straps(25, count=2)
    assert found.clamp_needed == pytest.approx(first.hold.clamp_needed, rel=1e-9)
    assert [one.hole for one in found.straps] == [one.hole for one in first.hold.straps]


@pytest.mark.thorough
def test_the_force_is_that_of_a_program_that_shares_nothing(block):
    for fixture in block[:3]:
        search = StrapSearch(fixture, block.query, make_question(block.query))
        turn = np.radians(LOAD.directions[0] + fixture.pose.theta_deg)
        at = [*fixture.pose.apply(50, 30), 25.0]
        force = np.array([600 * np.cos(turn), 600 * np.sin(turn), 0.0])
        tips = [one.at for one in fixture.hold.straps]
        loops = [np.array(loop) for loop in search.foot.loops]
        theirs = force_by_other_program(fixture, loops, tips, [(at, force)])
        assert fixture.hold.clamp_needed == pytest.approx(theirs, rel=0.03)


@pytest.mark.thorough
def test_answers_do_not_depend_on_threads_or_the_file(block, tmp_path):
    """The same bytes from one thread and two, and from a result that was read."""
    texts = []
    for threads in (1, 2):
        made = workhold.answer(block.query, threads=threads)
        workhold.save(made, tmp_path / "made.json", overwrite=True)
        texts.append((tmp_path / "made.json").read_bytes())
    workhold.save(workhold.open(tmp_path / "made.json"), tmp_path / "again.json")
    assert texts[0] == texts[1] == (tmp_path / "again.json").read_bytes()
    written = json.loads(texts[0])
    assert written["toolkit"]["kind"] == "strapped" and written["counts"] == {"strapped": 12}
    first = written["fixtures"][0]
    assert first["type"] == "strapped" and len(first["pegs"]) == 3 and first["supports"] == []
    assert {"hole", "at", "over", "heel"} <= first["straps"][0].keys() and first["push"]["at"]
    workhold.save(block, tmp_path / "made.csv")
    assert len((tmp_path / "made.csv").read_text().splitlines()) == 13


@pytest.mark.thorough
def test_a_plate_without_ends_has_no_hole_below_its_first():
    result = workhold.design(BLOCK, StrapPlate(20, 3), loads=[LOAD], thickness=25, strapped=3, best=3)
    for fixture in result:
        holes = [(peg.column, peg.row) for peg in fixture.pegs] + [one.hole for one in fixture.hold.straps]
        assert min(min(hole) for hole in holes) >= 0
        assert fixture.contact_points.shape == (3, 2)


@pytest.mark.thorough
@pytest.mark.parametrize(("count", "pitch"), [(1, 20), (2, 20), (3, 20)])
def test_straps_over_supports_need_the_least_force_of_all_sets(count, pitch):
    """Every three holes under the part, with every choice of those under straps, is asked for its force."""
    plate = StrapPlate(pitch, 3, 8, 6, straps=count, over="supports", supports={"height": 10})
    loads = [LOAD, Load(points=(20, 20), force=120, directions=(0, 60), moment=900, height=20)]
    result = workhold.design(BLOCK, plate, loads=loads, thickness=25, strapped=2, best=2)
    for fixture in result:
        search = StrapSearch(fixture, result.query, make_question(result.query))
        found = SupportedStraps(search, PadPlaces.from_search(search))
        pads, strapped = found.list_sets()
        needs = [
            max(need)
            for some, number in zip(pads.tolist(), strapped.tolist(), strict=True)
            if found.find_stable(np.array([some]))[0]
            and None
            not in (need := found.compute_needs(StrappedTriple(tuple(some), found.combinations[number])))
        ]
        hold = fixture.hold
        assert len(needs) > 10 and hold.clamp_needed == pytest.approx(min(needs), rel=1e-9)
        assert len(hold.supports) == 3 and len({one.hole for one in hold.straps}) == count
        for one in hold.straps:
            assert one.over in hold.supports and one.height == 35
            assert one.at == plate.plates[0].compute_hole_center(*one.over)


@pytest.mark.thorough
def test_friction_of_supports_counts_under_straps_and_that_of_the_plate_does_not():
    def need(**friction):
        plate = StrapPlate(20, 3, 8, 6, over="supports")
        asked = {"loads": [LOAD], "thickness": 25, "strapped": 1, "best": 1, "friction": friction}
        return workhold.design(BLOCK, plate, **asked)[0].hold.clamp_needed

    assert need(plate=0.3) == need() > need(support=0.3)


@pytest.mark.thorough
def test_friction_is_named_of_what_is_below():
    for over in ("plate", "supports"):
        result = workhold.design(BLOCK, StrapPlate(20, 3, 8, 6, over=over), thickness=25, strapped=1, best=1)
        words = describe_assumptions(make_question(result.query))
        assert ("support and milled steel" in words) == (over == "supports")


def test_the_largest_force_is_unknown_where_one_is():
    assert find_largest_force([3.0, 7.0, 5.0]) == 7.0
    assert find_largest_force([3.0, None]) is find_largest_force([]) is None


@pytest.mark.thorough
def test_a_plate_without_ends_has_its_supports_in_holes_with_names():
    plate = StrapPlate(20, 3, over="supports")
    for fixture in workhold.design(BLOCK, plate, loads=[LOAD], thickness=25, strapped=4, best=4):
        assert min(min(hole) for hole in fixture.hold.supports) >= 0
        assert {one.over for one in fixture.hold.straps} <= set(fixture.hold.supports)


@pytest.mark.thorough
def test_pads_that_find_no_three_holes_leave_no_straps():
    plate = StrapPlate(20, 3, 8, 6, over="supports", supports={"pad_radius": 9, "pad_margin": 15})
    result = workhold.design(BLOCK, plate, loads=[LOAD], thickness=25, strapped=1, best=3000)
    (hold,) = (one for one in result.holds if one.is_looked_at)
    assert hold.straps == () and hold.holds_nothing and hold.places < 3
    assert "The best seat is not held: there are no three supports" in str(result.notes[-1])


@pytest.mark.thorough
def test_bolts_stand_in_holes_of_their_own():
    plate = StrapPlate(20, 3, 8, 6, bolt_pitch=20, bolt_offset=10)
    result = workhold.design(BLOCK, plate, loads=[LOAD], thickness=25, strapped=1, best=1)
    bolts = plate.strap_set.bolts
    for one in result[0].hold.straps:
        x, y = bolts.compute_hole_center(*one.hole)
        assert (x % 20, y % 20) == (10, 10)
        assert 20 - 1e-9 <= np.hypot(one.at[0] - x, one.at[1] - y) <= 60 + 1e-9
        assert bolts.name_place(*one.hole).startswith("B-")


@pytest.mark.thorough
def test_without_loads_there_are_seats_and_a_push_alone():
    result = workhold.design(BLOCK, StrapPlate(20, 3, 8, 6), best=4)
    assert all(fixture.hold.push and not fixture.hold.straps for fixture in result)
    assert any("give a load" in str(note) for note in result.notes)


@pytest.mark.thorough
def test_a_disc_and_faces_that_are_avoided_leave_no_seat():
    """Three normals through one centre leave a disc free to turn."""
    disc = Workpiece.from_loops("disc", [[[-20, 0, 1], [20, 0, 1]]])
    result = workhold.design(disc, StrapPlate(10, 3))
    assert len(result) == 0 and "can still slide or turn" in str(result.notes[0])
    none = workhold.design(BLOCK, StrapPlate(20, 3), restrictions=Restrictions(avoid=(0, 1, 2)))
    why = none.why_none()
    assert (len(none) == 0 and "seats" in str(why)) or why is not None


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"seating": 5}, "seating is not looked at with straps"),
        ({"loads": [LOAD], "thickness": None}, "how thick the part is decides what straps hold"),
        ({"rank_by": "closure-margin"}, "is not a figure of straps to rank by"),
    ],
)
def test_what_is_not_done_is_refused_in_a_sentence(asked, words):
    with pytest.raises(InputError, match=words):
        workhold.design(BLOCK, StrapPlate(20, 3), **asked)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"straps": 5}, "has 1 or 2 or 3 or 4"),
        ({"reach": (60, 20)}, "not possible|give the smaller"),
        ({"bolt_pitch": 15}, "do not repeat with dowel holes"),
        ({"bolt_offset": 5}, "bolts have no holes of their own"),
        ({"bolt_pitch": 10, "bolt_offset": 12}, "less than the bolts' pitch"),
        ({"straps": 4, "over": "supports"}, "4 straps do not find a support each"),
        ({"over": "air"}, "plate"),
        ({"tip_radius": 0}, "tip radius 0.0 is not a positive length"),
    ],
)
def test_a_plate_that_cannot_be_is_refused_in_a_sentence(fields, words):
    with pytest.raises(InputError, match=words):
        StrapPlate(20, 3, **fields)


@pytest.mark.parametrize(("name", "value"), [("weight", 5.0), ("strapped", 3)])
def test_what_only_straps_feel_is_refused_elsewhere(name, value):
    with pytest.raises(InputError, match="counts where straps hold the part"):
        workhold.design(BLOCK, Plate(20, 3), **{name: value})
