"""Tools of a program keep clear of flat jaws, work stop, parallels and bed: by a walk along its moves, and by the
verification."""

from itertools import pairwise
from math import cos, inf, radians, sin
from random import Random

import numpy as np
import pytest
from attrs import evolve

import workhold
from jaw_examples import ELL, TRIANGLE, held, rectangle, vise
from slow_program import OFF, THICKNESS, box_of, low_points, program_of, random_program
from workhold.files.result.reader import read_result
from workhold.model.hold_words import write_setup_sentences
from workhold.search.explaining import explain
from workhold.statics.jaw_clearance import list_vise_sentences
from workhold.units import MILLIMETRE
from workhold.verification import verify

LOW = vise(parallels=[32, 40], jaw_thickness=18, stop="both", stop_width=12)
# Where a work stop touches each part, for the hull edges that lie on the fixed jaw: none has two faces farthest out.
PARTS = [rectangle(70, 40), ELL, TRIANGLE]


def placed_points(fixture, points):
    """Points (N, 2) of the part as they lie in the vise."""
    angle, pose = radians(fixture.pose.theta_deg), fixture.pose
    x = cos(angle) * points[:, 0] - sin(angle) * points[:, 1] + pose.x
    y = sin(angle) * points[:, 0] + cos(angle) * points[:, 1] + pose.y
    return x, y


def slow_reach(fixture, program, box, top):
    """The least distance less radius of a walk from a box up to a height, in mm; inside it is less than nothing."""
    x0, y0, x1, y1 = box
    least = inf
    for points, radius in low_points(program, top):
        x, y = placed_points(fixture, points)
        beside, across = np.maximum(x0 - x, x - x1), np.maximum(y0 - y, y - y1)
        off = np.hypot(np.maximum(beside, 0.0), np.maximum(across, 0.0))
        least = min(least, float(off.min()) - radius)
    return least


def slow_bodies(fixture, toolkit, part, parallels):
    """Box and top of each body of the vise, the parallels standing so far from their jaws."""
    hold, width = fixture.hold, toolkit.jaw_width
    top, far = toolkit.jaw_height - hold.parallels, hold.opening
    yield (0, -toolkit.jaw_thickness, width, 0), top
    yield (0, far, width, far + toolkit.jaw_thickness), top
    yield (0, 0, width, far), -hold.parallels
    wide = toolkit.parallel_thickness or min(8.0, far / 5)
    for y in (parallels[0], far - parallels[1] - wide):
        yield (0, y, width, y + wide), 0.0
    if hold.stop:
        corners = np.array([segment.start for segment in part.segments])
        x, y = placed_points(fixture, corners)
        outer = x < x.min() + 1e-6 if hold.stop == "left" else x > x.max() - 1e-6
        at = y[outer].min() / 2 + y[outer].max() / 2
        ends = (-1e4, 0) if hold.stop == "left" else (width, width + 1e4)
        yield (
            (ends[0], at - toolkit.stop_width / 2, ends[1], at + toolkit.stop_width / 2),
            min(top, THICKNESS),
        )


def is_slowly_clear(fixture, toolkit, part, program, parallels, off=0.0):
    """Whether a walk keeps the clearance from every body, to within ``off``."""
    return all(
        slow_reach(fixture, program, *body) > program.clearance + off
        for body in slow_bodies(fixture, toolkit, part, parallels)
    )


def keys(result):
    return {(round(one.pose.theta_deg, 6), one.hold.parallels, one.hold.stop) for one in result}


def two_of(result):
    """Turn and parallels of each fixture."""
    return {one[:2] for one in keys(result)}


def make_case(seed):
    """A part, and a program: of each third one holes and a slot right through the part."""
    random = Random(seed)
    part, clearance = random.choice(PARTS), random.choice([0.0, 1.0, 3.0])
    if seed % 3:
        return part, random_program(random, part, clearance)
    x0, y0, x1, y1 = box_of(part)

    def place():
        return random.uniform(x0 + 3, x1 - 3), random.uniform(y0 + 3, y1 - 3)

    rows = [(3, True, (x, y, 14.0), (x, y, -3.0), 0.0) for x, y in (place(), place())]
    return part, program_of([*rows, (3, True, (*place(), -1.0), (*place(), -1.0), 0.0)], clearance)


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(24))
def test_fixtures_are_those_that_a_walk_finds_clear(seed):
    """With the parallels where they were put; what is left out is not clear with parallels anywhere."""
    part, program = make_case(seed)
    every = held(part, LOW, thickness=THICKNESS)
    found = held(part, LOW, thickness=THICKNESS, program=program)
    assert keys(found) <= keys(every)
    for one in found:
        assert is_slowly_clear(one, LOW, part, program, one.hold.parallel_offsets, -OFF), one
        for place, other in enumerate(one.hold.parallel_offsets):
            beside = [0.0 if k == place else away for k, away in enumerate(one.hold.parallel_offsets)]
            assert not other or not is_slowly_clear(one, LOW, part, program, beside, OFF)
    for one in every:
        if (round(one.pose.theta_deg, 6), one.hold.parallels, one.hold.stop) in keys(found):
            continue
        wide = min(8.0, one.hold.opening / 5)
        places = np.arange(0.0, one.hold.opening / 2 - wide, 0.5)
        near = [place for place in places if is_parallel_clear(one, program, place, wide)]
        far = [
            place
            for place in places
            if is_parallel_clear(one, program, one.hold.opening - place - wide, wide)
        ]
        if near and far:
            assert not is_slowly_clear(one, LOW, part, program, (near[0], far[0]), OFF), one
    assert verify(found).holds


def is_parallel_clear(fixture, program, y, wide):
    """Whether a walk keeps clear of a parallel at y, with what an arc's box or a parallel's end may cost."""
    return slow_reach(fixture, program, (-9, y, LOW.jaw_width + 9, y + wide), 0.0) > program.clearance + 3.0


@pytest.mark.thorough
def test_walk_rules_some_out_and_leaves_some():
    left = taken = moved = 0
    for seed in range(24):
        part, program = make_case(seed)
        result = held(part, LOW, thickness=THICKNESS, program=program)
        found = sum(result.counts.values())
        left += found
        moved += sum(one.hold.has_moved_parallels for one in result)
        taken += sum(held(part, LOW, thickness=THICKNESS).counts.values()) - found
    assert left > 20 and taken > 20 and moved > 5, (left, taken, moved)


def cut_along(y, z, clearance=1.0):
    """A cut of an end mill of 6 mm along x."""
    return program_of([(1, True, (-10.0, y, z), (80.0, y, z), 0.0)], clearance)


def test_jaws_end_where_they_are_thick():
    """A cut beyond a thin jaw is clear of it, and beneath an endless one it is not."""
    program = cut_along(-20.0, 2.0)
    part = rectangle(70, 40)
    thin, thick, endless = (
        held(part, vise(parallels=[32], jaw_thickness=size), thickness=THICKNESS, program=program)
        for size in (15.9, 16.1, None)
    )
    assert (0.0, 32.0) in two_of(thin) and (0.0, 32.0) not in two_of(thick) | two_of(endless)


@pytest.mark.parametrize(("z", "is_clear"), [(12.01, True), (12.0, False), (11.99, False)])
def test_what_passes_above_the_jaws_is_clear(z, is_clear):
    found = held(rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS, program=cut_along(0.0, z))
    assert ((0.0, 32.0) in two_of(found)) == is_clear


def test_a_rapid_move_by_any_way_goes_through_a_jaw():
    """Its box has the jaw inside, though no end of it is there."""
    rows = [(1, False, (-500.0, -300.0, 2.0), (500.0, -8.0, 2.0), 0.0)]
    part, toolkit = rectangle(70, 40), vise(parallels=[32], jaw_thickness=18)
    straight, boxed = (
        held(part, toolkit, thickness=THICKNESS, program=program_of(rows, rapid=way))
        for way in ("straight", "box")
    )
    assert (0.0, 32.0) not in two_of(boxed)
    assert len(straight) >= len(boxed)
    assert verify(boxed).holds


def test_verification_sees_a_tool_in_a_jaw():
    clear = held(
        rectangle(70, 40), vise(parallels=[32, 40]), thickness=THICKNESS, program=cut_along(0.0, 6.0)
    )
    assert two_of(clear) == {(90.0, 40.0), (270.0, 40.0), (0.0, 40.0), (180.0, 40.0)}
    low = evolve(clear, query=evolve(clear.query, program=cut_along(0.0, 3.0)))
    outcome = verify(low)
    assert not outcome.holds
    assert any("of the program brings a tool within" in one.reason for one in outcome.unproven)


def test_reason_names_the_line_and_what_would_help():
    result = held(rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS, program=facing_all())
    assert not len(result)
    assert result.notes[0].words == (
        "Both jaws would press the part, but line 3 of the program runs T1 into a jaw. Lift the part with higher "
        "parallels."
    )
    explanation = explain(result.query)
    assert explanation.removals[-1].rule == "vise clear of the program"
    assert [one.change for one in explanation.helps] == ["without the program"]


def facing_all():
    """A border around the part, low."""
    ring = [(0.0, 0.0, 3.0), (70.0, 0.0, 3.0), (70.0, 40.0, 3.0), (0.0, 40.0, 3.0), (0.0, 0.0, 3.0)]
    return program_of([(1, True, a, b, 0.0) for a, b in pairwise(ring)])


def drilled(*places, z=-3.0, clearance=1.0):
    """Holes of 4 mm right through, at places of the part."""
    rows = [(3, True, (x, y, THICKNESS + 2.0), (x, y, z), 0.0) for x, y in places]
    return program_of(rows, clearance)


def as_drawn(result):
    """The fixture of a result that is not turned, by its stop."""
    return {one.hold.stop: one for one in result if not one.pose.theta_deg}


def test_parallels_stand_apart_where_a_drill_comes_through():
    """The hole's rim at 8 mm, a millimetre of clearance, the next whole one: 10 mm; the other stays at its jaw."""
    program = drilled((20.0, 6.2))
    found = held(rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS, program=program)
    one = as_drawn(found)[None]
    assert one.hold.parallel_offsets == (10.0, 0.0)
    turned = next(one for one in found if one.pose.theta_deg == 180)
    assert turned.hold.parallel_offsets == (0.0, 10.0)
    assert verify(found).holds
    high = held(
        rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS, program=drilled((20.0, 6.2), z=0.5)
    )
    assert as_drawn(high)[None].hold.parallel_offsets == (0.0, 0.0)


def test_holes_that_just_leave_a_whole_millimetre_take_it():
    """The rim at 8 mm, the clearance of 1 mm: 9 mm, not 10."""
    found = held(rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS, program=drilled((20.0, 6.0)))
    assert as_drawn(found)[None].hold.parallel_offsets == (9.0, 0.0)
    assert verify(found).holds


def test_parallels_beside_the_jaws_come_first_of_what_is_equal():
    """Of a square, the two sides on which no hole is above a parallel."""
    found = held(rectangle(60, 60), vise(parallels=[32]), thickness=THICKNESS, program=drilled((30.0, 6.2)))
    assert [one.hold.has_moved_parallels for one in found] == [False, False, True, True]


def test_thin_parallels_may_stay_where_thick_ones_cannot_stand():
    """A row of holes across the opening leaves 4 mm between them and their clearance, and 5 beside the jaws."""
    program = drilled(*((35.0, y) for y in (8.0, 18.0, 28.0)))
    part = rectangle(70, 36)
    thin, thick = (
        held(part, vise(parallels=[32], parallel_thickness=size), thickness=THICKNESS, program=program)
        for size in (4.5, 5.5)
    )
    assert as_drawn(thin)[None].hold.parallel_offsets == (0.0, 0.0)
    assert None not in as_drawn(thick)
    none = held(
        part,
        vise(parallels=[32], parallel_thickness=5.5),
        thickness=THICKNESS,
        program=program,
        restrictions=workhold.Restrictions(angles=[(0, 0)]),
    )
    assert none.notes[0].words == (
        "Both jaws would press the part, but line 3 of the program brings T3 within 0.5 mm of a parallel, where 1 mm "
        "are to be kept. Take parallels thinner than the 5.5 mm that they have."
    )


def test_stop_stands_where_no_tool_comes():
    """A cut beside the left end, lower than the jaws: the stop is at the right."""
    program = program_of([(1, True, (-12.0, 20.0, 4.0), (-4.0, 20.0, 4.0), 0.0)])
    found = held(rectangle(70, 40), vise(parallels=[32], stop="both"), thickness=THICKNESS, program=program)
    assert set(as_drawn(found)) == {"right"}
    assert found.notes[-1].words == (
        "6 set-ups are left out: line 3 of the program runs T1 into the work stop and a jaw."
    )
    at_side = held(
        rectangle(70, 40),
        vise(parallels=[32], stop="left"),
        thickness=THICKNESS,
        program=program,
        restrictions=workhold.Restrictions(angles=[(0, 0)]),
    )
    assert at_side.notes[0].words.endswith("Put the stop at the right end, or take it away.")


@pytest.mark.parametrize(("y", "is_clear"), [(29.6, False), (30.4, True)])
def test_stop_is_as_wide_as_it_is(y, is_clear):
    """Its middle at 20, half its width of 12, the clearance and the cutter's radius of 3: 30 mm."""
    program = program_of([(1, True, (-12.0, y, 4.0), (-4.0, y, 4.0), 0.0)])
    toolkit = vise(parallels=[32], stop="left", stop_width=12)
    found = held(rectangle(70, 40), toolkit, thickness=THICKNESS, program=program)
    assert ("left" in as_drawn(found)) == is_clear


@pytest.mark.parametrize(("z", "is_clear"), [(12.0, False), (12.01, True)])
def test_stop_is_no_higher_than_the_part(z, is_clear):
    """The part is 12 mm thick between jaws 24 mm above its lower side."""
    program = program_of([(1, True, (-12.0, 20.0, z), (-4.0, 20.0, z), 0.0)])
    found = held(rectangle(70, 40), vise(stop="left", parallels=[20]), thickness=THICKNESS, program=program)
    assert ("left" in as_drawn(found)) == is_clear


@pytest.mark.parametrize(("z", "is_clear"), [(-31.9, True), (-32.0, False)])
def test_tool_that_comes_down_to_the_bed_counts(z, is_clear):
    found = held(
        rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS, program=drilled((35.0, 20.0), z=z)
    )
    assert (None in as_drawn(found)) == is_clear
    if not is_clear:
        assert "into the bed of the vise. Take parallels higher than 32 mm" in found.notes[0].words


def test_moved_parallels_bear_less_far_apart():
    """A push down beside a jaw, outside the parallels, needs more force than inside them."""
    load = workhold.Load(points=(35.0, 1.0), force=0.0, upward=-900.0, height=THICKNESS)
    far = held(rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS, loads=[load])
    near = held(
        rectangle(70, 40),
        vise(parallels=[32]),
        thickness=THICKNESS,
        loads=[load],
        program=drilled((20.0, 6.2)),
    )
    before, after = (as_drawn(one)[None].hold.clamp_needed for one in (far, near))
    assert after > before + 1.0
    assert verify(near).holds


def test_verification_sees_parallels_in_the_way():
    found = held(rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS, program=drilled((20.0, 6.2)))
    for offsets, words in (
        ((0.0, 0.0), "a parallel"),
        ((9.0, 0.0), "a parallel"),
        ((14.0, 0.0), "not in that half"),
        ((-2.0, 0.0), "not in that half"),
    ):
        holds = tuple(evolve(one.hold, parallel_offsets=offsets) for one in found)
        outcome = verify(evolve(found, holds=holds))
        assert any(words in one.reason for one in outcome.unproven), offsets


def test_moved_parallels_are_kept_in_a_file(tmp_path):
    found = held(rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS, program=drilled((20.0, 6.2)))
    workhold.save(found, tmp_path / "r.json")
    again = read_result(tmp_path / "r.json")
    assert [one.hold.parallel_offsets for one in again] == [one.hold.parallel_offsets for one in found]
    assert '"parallel_offsets": [10.0, 0.0]' in (tmp_path / "r.json").read_text()
    plain = held(rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS)
    workhold.save(plain, tmp_path / "plain.json")
    assert not {"parallel_offsets", "parallel_thickness", "stop_width"} & set(
        (tmp_path / "plain.json").read_text().split('"')
    )


def test_words_say_where_parallels_stand_and_what_is_near():
    found = held(rectangle(70, 40), vise(parallels=[32]), thickness=THICKNESS, program=drilled((20.0, 6.2)))
    one = as_drawn(found)[None]
    steps = list(write_setup_sentences(one, found.query, MILLIMETRE))
    assert (
        steps[0] == "Take the parallels of 32 mm, one 10 mm from the fixed jaw and one beside the moving jaw"
    )
    assert list_vise_sentences(one, found.query, MILLIMETRE) == [
        "T3 comes 3.000 mm below the part in line 3, clear of the parallels and 29.000 mm above the bed.",
        "Nearest to the vise comes T3 in line 3: 1.800 mm from a parallel.",
    ]
