"""Every way to hold a part between two flat jaws."""

from math import sqrt

import numpy as np
import pytest
from attrs import evolve

import workhold
from jaw_examples import DISC, ELL, LOADS, TRIANGLE, held, rectangle, vise
from workhold import InputError, Load, PlainVise, Restrictions, Workpiece
from workhold.search.explaining import explain


def poses(result):
    return {(round(one.pose.theta_deg, 6), one.hold.parallels, one.hold.stop) for one in result}


def test_rectangle_has_a_fixture_for_each_side_and_parallels():
    result = held()
    assert result.counts == {"plain": 8}
    assert result.distinct == {"plain": 4}
    assert poses(result) == {
        (turn, high, None) for turn in (0.0, 90.0, 180.0, 270.0) for high in (20.0, 32.0)
    }
    assert {one.hold.opening for one in result} == {60.0, 100.0}


def test_jaws_touch_what_their_height_leaves_above_the_parallels():
    for one in held():
        ((x0, x1, z0, z1),) = one.hold.fixed.rectangles
        assert (z0, z1) == (0.0, 44 - one.hold.parallels)
        assert (x0 + x1) / 2 == pytest.approx(76)
        assert one.hold.grip + one.hold.above == pytest.approx(25)
        assert one.hold.contact_area == pytest.approx((x1 - x0) * z1)


def test_part_on_the_bed_lower_than_the_jaws_is_told():
    (first, *_) = held(toolkit=vise(parallels=[]))
    assert first.hold.grip == 25 and first.hold.above == 0
    assert any("nothing of the part stands above" in words for words in first.hold.warnings)


@pytest.mark.parametrize(("stop", "ends"), [("left", (5.0, 105.0)), ("right", (47.0, 147.0))])
def test_stop_sets_where_the_part_lies_along_the_jaws(stop, ends):
    result = held(
        toolkit=vise(stop=stop, stop_offset=5, parallels=[20]), restrictions=Restrictions(angles=[(0, 0)])
    )
    assert [one.hold.fixed.ends for one in result] == [pytest.approx(ends)]


def test_both_stops_are_a_fixture_each_and_none_is_without():
    result = held(toolkit=vise(stop="both"))
    assert len(result) == 16 and {one.hold.stop for one in result} == {"left", "right"}


def test_disc_stands_once_on_two_lines():
    (only,) = held(DISC, vise(parallels=[20]))
    assert only.pose.theta_deg == 0.0 and only.hold.opening == pytest.approx(40)
    for patch in (only.hold.fixed, only.hold.moving):
        assert patch.is_line and not patch.is_corner and patch.ends == pytest.approx((76, 76))


def test_triangle_has_three_fixtures_all_unfit():
    result = held(TRIANGLE, vise(parallels=[20]))
    assert len(result) == 3
    assert all(one.hold.moving.is_corner and not one.hold.moving.segments for one in result)
    assert all(any("unfit" in words for words in one.hold.warnings) for one in result)


def test_hull_edge_over_a_gap_touches_two_corners():
    bridged = [one for one in held(ELL, vise(parallels=[20])) if one.hold.fixed.is_corner]
    assert [round(one.pose.theta_deg, 3) for one in bridged] == [225.0]
    assert len(bridged[0].hold.fixed.rectangles) == 2


def test_step_touches_two_rectangles_with_a_gap():
    stepped = Workpiece.from_points(
        "stepped", [(0, 0), (30, 0), (30, 8), (50, 8), (50, 0), (90, 0), (90, 40), (0, 40)]
    )
    (one,) = [one for one in held(stepped, vise(parallels=[20])) if one.pose.theta_deg == 0.0]
    assert [row[:2] for row in one.hold.fixed.rectangles] == [
        pytest.approx((31, 61)),
        pytest.approx((81, 121)),
    ]
    assert one.hold.fixed.segments == (0, 4)


def test_part_longer_than_the_jaws_is_touched_as_far_as_they_reach():
    one = held(rectangle(300, 60), vise(parallels=[20]), restrictions=Restrictions(angles=[(0, 0)]))[0]
    assert one.hold.fixed.ends == (0.0, 152.0)
    assert any("end of the jaws" in words for words in one.hold.warnings)


def test_a_part_at_a_stop_reaches_to_that_end_without_a_warning():
    """A stop at the end of the jaws is there for it; at the other end the part is warned of."""
    for stop in ("left", "right"):
        for width, warned in ((100.0, False), (152.0, True)):
            result = held(
                rectangle(width, 60),
                vise(parallels=[20], stop=stop, jaw_width=152),
                restrictions=Restrictions(angles=[(0, 0)]),
            )
            assert any("end of the jaws" in words for words in result[0].hold.warnings) == warned


def test_turned_drawing_with_six_decimals_still_has_parallel_sides():
    turn = np.radians(17.0)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    corners = (np.array([(0, 0), (100, 0), (100, 60), (0, 60)]) @ matrix.T).round(6)
    result = held(Workpiece.from_points("turned", corners), vise(parallels=[20]))
    assert len(result) == 4 and not any(one.hold.is_unfit for one in result)


def test_mirrored_part_and_loads_ask_for_the_same_forces():
    result = held(ELL, vise(parallels=[20]), loads=LOADS[:1], thickness=20)
    mirrored = Workpiece.from_points(
        "ell", [(-x, y) for x, y in [(0, 0), (0, 58), (24, 58), (24, 22), (60, 22), (60, 0)]]
    )
    load = Load(points=(-50, 30), force=500, directions=180, height=23)
    other = held(mirrored, vise(parallels=[20]), loads=[load], thickness=20)
    forces = [
        sorted(str(one.hold.clamp_needed and round(one.hold.clamp_needed, 4)) for one in each)
        for each in (result, other)
    ]
    assert forces[0] == forces[1]


def test_block_along_the_jaws_slips_at_twice_the_friction():
    middle = Load(points=(50, 30), force=300, directions=0, height=12)
    result = held(loads=[middle], restrictions=Restrictions(angles=[(0, 0)]), toolkit=vise(parallels=[20]))
    assert result[0].hold.clamp_needed == pytest.approx(2 * 300 / (2 * 0.15), rel=1e-9)


@pytest.mark.thorough
def test_any_direction_is_the_worst_of_all():
    around = held(loads=[Load(points=(58, 25), force=300, height=20)], toolkit=vise(parallels=[20]))
    for one in around:
        each = [
            held(
                loads=[Load(points=(58, 25), force=300, directions=turn, height=20)],
                toolkit=vise(parallels=[20]),
            )
            for turn in (0, 70, 200)
        ]
        for result in each:
            (same,) = [other for other in result if other.pose == one.pose]
            assert same.hold.clamp_needed <= one.hold.clamp_needed * (1 + 1e-9)


def test_wide_jaw_on_a_short_face_lifts_at_one_end():
    for one in held(ELL, vise(parallels=[20]), loads=LOADS, thickness=20):
        if not one.hold.full_contact:
            assert one.hold.clamp_needed_each == (None, None, None)
            assert any("lifts off" in words for words in one.hold.warnings)


def test_order_has_unfit_last_and_the_larger_grip_first():
    result = held(ELL, vise(), thickness=25)
    assert [one.hold.is_unfit for one in result] == sorted(one.hold.is_unfit for one in result)
    areas = [round(one.hold.contact_area, 6) for one in held()]
    assert areas == sorted(areas, reverse=True)


@pytest.mark.thorough
def test_beyond_the_rating_is_warned_of_and_last():
    result = held(loads=LOADS, toolkit=vise(max_force=3000))
    weak = [one.hold.is_beyond_rating for one in result]
    assert any(weak) and not all(weak) and weak == sorted(weak)
    assert all(
        any("rated" in words for words in one.hold.warnings) == one.hold.is_beyond_rating for one in result
    )


def test_ranking_by_a_figure():
    result = held(rank_by="above")
    assert [one.hold.above for one in result] == sorted((one.hold.above for one in result), reverse=True)
    with pytest.raises(InputError, match="choose among clamp-needed"):
        held(rank_by="location-error")


@pytest.mark.parametrize(
    ("toolkit", "part", "rule"),
    [
        (vise(parallels=[42]), rectangle(), "grip"),
        (vise(max_opening=50), rectangle(), "opening"),
        (vise(), Workpiece.from_points("lean", [(0, 0), (30, 0), (120, 60), (90, 60)]), "opposite"),
    ],
)
def test_reason_names_the_rule_that_left_none(toolkit, part, rule):
    result = held(part, toolkit, restrictions=Restrictions(angles=[(0, 0)]))
    assert not result.table and len(result.notes) == 2
    assert rule in explain(result.query).last_rule


def test_change_that_helps_is_named():
    result = held(toolkit=vise(max_opening=50))
    assert next(help.change for help in explain(result.query).helps) == "with a larger opening"


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        ({"seating": 3}, "seating is asked of pegs"),
        ({"contact_margin": 1}, "contact margin is asked of pegs"),
        ({"friction": {"jaws": 0.1}}, "friction of 'jaws'"),
        ({"friction": {"jaw": -1}}, "cannot be used"),
        ({"thickness": None, "loads": LOADS}, "give its thickness"),
    ],
)
def test_refusals(asked, sentence):
    with pytest.raises(InputError, match=sentence):
        held(**asked)


def test_pegs_refuse_what_friction_asks():
    pegs = workhold.Vise(pitch=10, columns=2, peg_radius=3)
    for asked, sentence in (
        ({"friction": {"jaw": 0.1}}, "friction counts"),
        ({"safety": 2}, "safety factor counts"),
        ({"loads": LOADS}, "acts along z"),
    ):
        with pytest.raises(InputError, match=sentence):
            workhold.Query(rectangle(), pegs, **asked)


def test_faces_to_avoid_and_to_touch():
    result = held(toolkit=vise(parallels=[20]), restrictions=Restrictions(avoid=[0]))
    assert poses(result) == {(90.0, 20.0, None), (270.0, 20.0, None)}
    result = held(toolkit=vise(parallels=[20]), restrictions=Restrictions(touch=[0]))
    assert poses(result) == {(0.0, 20.0, None), (180.0, 20.0, None)}


@pytest.mark.thorough
def test_result_does_not_depend_on_threads():
    texts = []
    for threads in (1, 2):
        result = held(loads=LOADS, threads=threads)
        texts.append([one.hold for one in result])
    assert texts[0] == texts[1]


def test_hexagon_stands_on_each_of_its_flats():
    corners = [(20 * np.cos(np.pi / 3 * k), 20 * np.sin(np.pi / 3 * k)) for k in range(6)]
    result = held(Workpiece.from_points("hexagon", corners), vise(parallels=[20]))
    assert len(result) == 6 and result.distinct == {"plain": 1}
    assert all(one.hold.opening == pytest.approx(20 * sqrt(3)) for one in result)


def test_vise_refuses_parallels_as_high_as_its_jaws():
    with pytest.raises(InputError, match="do not reach above"):
        PlainVise(jaw_width=100, jaw_height=20, parallels=[20])


def test_jaw_force_given_holds_the_loads_as_often_as_it_says():
    """Loads so many times as large, without a safety factor, ask for just that force."""
    (load, *_) = LOADS
    first = held(loads=[load], jaw_force=4000)[0].hold
    times = first.safety_reached
    again = evolve(load, force=load.force * times, upward=load.upward * times)
    assert held(loads=[again], safety=1)[0].hold.clamp_needed == pytest.approx(4000, rel=1e-6)


@pytest.mark.thorough
def test_jaw_force_too_small_is_told():
    enough, less = (
        next(one for one in held(loads=LOADS, jaw_force=force) if one.pose.theta_deg == 0.0)
        for force in (1e6, 100.0)
    )
    words = "closed with 100 N the jaws hold the loads"
    assert not any(one.startswith("closed with") for one in enough.hold.warnings)
    assert sum(one.startswith(words) for one in less.hold.warnings) == 1
    assert enough.hold.safety_reached == pytest.approx(1e4 * less.hold.safety_reached)


def test_a_part_that_stands_out_comes_before_one_sunk_between_the_jaws():
    """Low parallels grip more of it, but nothing of it stands above the jaws."""
    result = held(rectangle(), vise(jaw_height=44, parallels=[8, 32]))
    assert [one.hold.above > 0.0 for one in result] == [True] * 4 + [False] * 4
    assert result[0].hold.grip < result[-1].hold.grip


def test_of_parts_below_the_jaws_the_least_sunk_comes_first():
    """A plate thinner than what the highest parallels leave of the jaws lies as high as it can."""
    result = held(rectangle(80, 40), vise(parallels=[10, 20, 32]), thickness=9.0)
    parallels = [one.hold.parallels for one in result]
    assert parallels == sorted(parallels, reverse=True) and set(parallels) == {10, 20, 32}


def test_nobody_turns_a_part_for_a_percent_of_jaw_force():
    """Of two ways round that need almost the same force, the part as drawn comes first; not if it needs far more."""
    load = Load(points=(52, 30), force=500, height=24)
    result = held(rectangle(), vise(parallels=[20], stop="left"), loads=[load])
    needs = {round(one.pose.theta_deg): one.hold.clamp_needed for one in result}
    assert needs[180] < needs[0] < 1.05 * needs[180] and result[0].pose.written_deg == 0
    far = Load(points=(97, 30), force=500, height=24, directions=90)
    result = held(rectangle(), vise(parallels=[20], stop="left"), loads=[far])
    needs = {round(one.pose.theta_deg): one.hold.clamp_needed for one in result}
    assert result[0].pose.written_deg == (0 if needs[0] < 1.05 * needs[180] else 180)
