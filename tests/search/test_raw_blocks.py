"""A raw block between flat jaws: what is found is what a block of that size gives, with the part and its program in it."""

import pickle

import pytest
from attrs import evolve

import workhold
from jaw_examples import ELL, held, rectangle, vise
from slow_program import program_of
from workhold import InputError, Load, Workpiece
from workhold.files.result.reader import read_result
from workhold.model.hold_words import list_hold_reasons, write_setup_sentences
from workhold.model.raw_block import raise_program
from workhold.model.raw_words import list_raw_sentences
from workhold.units import MILLIMETRE
from workhold.verification import verify, verify_file

RAW = {"side": 3, "top": 2, "bottom": 5}
# The box around ELL, from (0, 0) to (60, 58), grown by 3 mm.
BLOCK = Workpiece.from_points("ell", [(-3, -3), (63, -3), (63, 61), (-3, 61)])
TOOLKIT = vise(parallels=[20, 32], stop="both", max_force=26000)
LOADS = (Load(points=(50, 10), force=300, height=10), Load(points=(10, 40), force=200, upward=40))


def by_place(result):
    return {(round(one.pose.theta_deg, 6), one.hold.parallels, one.hold.stop): one for one in result}


@pytest.mark.thorough
def test_jaws_hold_what_they_would_of_a_block_of_that_size():
    """The block of 66 by 64 by 32 mm; loads act as much higher as the part lies in it."""
    raw = held(ELL, TOOLKIT, thickness=25.0, raw=RAW, loads=LOADS)
    higher = (evolve(LOADS[0], height=15), LOADS[1])
    block = held(BLOCK, TOOLKIT, thickness=32.0, loads=higher)
    one, other = by_place(raw), by_place(block)
    assert one.keys() == other.keys() and len(one) == 16
    for place, fixture in one.items():
        assert evolve(fixture.hold, warnings=()) == evolve(other[place].hold, warnings=())
        assert (fixture.pose.x, fixture.pose.y) == (other[place].pose.x, other[place].pose.y)
    assert verify(raw).holds


@pytest.mark.thorough
def test_query_is_that_of_the_block_and_keeps_the_part():
    query = held(ELL, TOOLKIT, thickness=25.0, raw=RAW, loads=LOADS).query
    assert query.workpiece.is_alike(evolve(BLOCK, finished=query.workpiece.finished))
    assert query.workpiece.finished.is_alike(ELL) and query.workpiece.as_finished.is_alike(ELL)
    assert query.part_height == 32.0 and [load.height for load in query.loads] == [15.0, None]
    # Another program, another way to rank: the block is laid around the part once.
    assert evolve(query, rank_by=["grip"]).workpiece.bounds == (-3.0, -3.0, 63.0, 61.0)
    assert pickle.loads(pickle.dumps(query)) == query


def cut_beside(y, z, x=(-20.0, 80.0)):
    """A cut of an end mill of 6 mm along x, z above the part's lower side."""
    return program_of([(1, True, (x[0], y, z), (x[1], y, z), 0.0)])


@pytest.mark.parametrize(("z", "is_clear"), [(7.01, True), (7.0, False)])
def test_program_runs_where_the_part_lies_in_the_block(z, is_clear):
    """Jaws 12 mm above the block's lower side are 7 mm above the part's; the fixed one stands at y = -3."""
    asked = {"thickness": 25.0, "raw": RAW, "restrictions": workhold.Restrictions(angles=[(0, 0)])}
    found = held(ELL, vise(parallels=[32]), program=cut_beside(-4.0, z), **asked)
    assert bool(len(found)) == is_clear
    assert found.query.program.raised == 5.0 and found.query.program.moves.start[0, 2] == z + 5.0
    assert verify(found).holds
    # A program that is there already is raised no further, and another one is raised as far.
    again = evolve(found.query, rank_by=["grip"]).program
    assert again.moves.start[0, 2] == z + 5.0
    assert evolve(found.query, program=cut_beside(0.0, 1.0)).program.moves.start[0, 2] == 6.0
    assert raise_program(found.query.program, 7.0, 34.0).moves.start[0, 2] == z + 7.0


def test_drill_that_stays_in_the_block_spares_the_parallels():
    """5 mm are left below the part: 3 mm through it is not through the block, and 5 mm are."""
    for depth, moved in ((-3.0, False), (-5.0, True)):
        program = program_of([(3, True, (30.0, 2.0, 30.0), (30.0, 2.0, depth), 0.0)])
        found = held(ELL, vise(parallels=[32]), thickness=25.0, raw=RAW, program=program)
        one = by_place(found)[0.0, 32.0, None]
        assert one.hold.has_moved_parallels == moved


@pytest.mark.thorough
def test_tools_cut_the_block_and_nothing_beside_it(tmp_path):
    """Forces count where a tool meets the block: 3 mm beside the part, up to 2 mm above it."""
    text = "G21 G90\nT1 M6\nS2000 M3\nG0 X-50. Y-10. Z60.\nG1 {} F300\nG1 X80.\nG0 Z60.\nM30\n"
    needs = {}
    for name, at in (("in it", "Y10. Z1."), ("above it", "Y10. Z2.5"), ("beside it", "Y-6.5 Z1.")):
        file = tmp_path / "cut.nc"
        file.write_text(text.format(at))
        program = workhold.Program.read(file, {1: 6}, thickness=25, cutting={"cutting_force": 100})
        found = held(ELL, vise(parallels=[32]), thickness=25.0, raw=RAW, program=program)
        needs[name] = found[0].hold.program_need
    assert needs["in it"] is not None and needs["in it"].force > 0
    assert needs["above it"] is None or not needs["above it"].force
    assert needs["beside it"] is None or not needs["beside it"].force


def test_set_ups_come_first_whose_jaws_stay_below_the_part():
    """Jaws 44 mm high on parallels of 40 reach 4 mm up, and 5 mm are left below the part; on 32 they reach 12."""
    found = held(ELL, vise(parallels=[32, 36, 40]), thickness=25.0, raw=RAW)
    assert [one.hold.parallels for one in found] == [40.0] * 4 + [36.0] * 4 + [32.0] * 4
    assert "the jaws stay below the part" in list_hold_reasons(found[0], MILLIMETRE)
    assert "the jaws reach 3 mm over the part's lower side" in list_hold_reasons(found[4], MILLIMETRE)
    # Between those that stay below it the area decides, as ever.
    low = held(ELL, vise(parallels=[32, 40]), thickness=25.0, raw={"bottom": 14})
    assert low[0].hold.parallels == 32.0


def test_turns_that_the_part_has_and_not_the_block_are_told_apart():
    assert sum(held(ELL, vise(), thickness=25.0, raw=RAW).distinct.values()) == 8
    assert sum(held(rectangle(), vise(), thickness=25.0, raw=RAW).distinct.values()) == 4


@pytest.mark.thorough
def test_file_keeps_the_block_and_the_part(tmp_path):
    program = cut_beside(30.0, 9.0)
    found = held(ELL, TOOLKIT, thickness=25.0, raw=RAW, loads=LOADS, program=program)
    workhold.save(found, tmp_path / "raw.json")
    query = read_result(tmp_path / "raw.json").query
    assert query.workpiece == found.query.workpiece and query.raw == found.query.raw
    assert (query.program.moves.start == found.query.program.moves.start).all()
    assert query.program.raised == 5.0 and query.loads == found.query.loads and query.thickness == 32.0
    outcome = verify_file(tmp_path / "raw.json")
    assert outcome.holds and not outcome.faults
    # As a part the file is the finished part.
    assert workhold.load(tmp_path / "raw.json").is_alike(ELL)
    text = (tmp_path / "raw.json").read_text()
    for was, now, words in (
        ('"side": 3.0', '"side": 4.0', "is not the raw block around its finished part"),
        ('"finished"', '"inside"', "has no finished part"),
        ('"raw": {"side"', '"rough": {"side"', "say by how much it is larger"),
    ):
        assert was in text
        (tmp_path / "other.json").write_text(text.replace(was, now))
        with pytest.raises(InputError, match=words):
            read_result(tmp_path / "other.json")


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"toolkit": workhold.Vise(pitch=10, columns=2, peg_radius=3)}, "flat jaws of a plain vise"),
        ({"thickness": None}, "how high its raw block is: give its thickness"),
        ({"raw": {"side": -1}}, "side -1 is not a length"),
        ({"raw": {"left": 1}}, "no 'left': give side, top and bottom"),
        ({"raw": 3}, "give its side, top and bottom in mm by name"),
        ({"restrictions": workhold.Restrictions(avoid=[5])}, "face 5 is not there yet"),
        ({"restrictions": workhold.Restrictions(touch=[0, 4])}, "face 4 is not there yet"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_sentence(changed, words):
    usual = {"toolkit": TOOLKIT, "thickness": 25.0, "raw": RAW}
    toolkit = {**usual, **changed}.pop("toolkit")
    asked = {name: value for name, value in {**usual, **changed}.items() if name != "toolkit"}
    with pytest.raises(InputError, match=words):
        workhold.design(ELL, toolkit, **asked)


def test_another_stock_beside_the_block_is_refused(tmp_path):
    (tmp_path / "cut.nc").write_text("G21 G90\nT1 M6\nS2000 M3\nG0 X0 Y0 Z60.\nG1 Z20. F300\nM30\n")
    cutting = {"cutting_force": 100}
    program = workhold.Program.read(tmp_path / "cut.nc", {1: 6}, thickness=25, cutting=cutting, stock="block")
    for raw in (RAW, {"side": 3}):
        with pytest.raises(InputError, match="leave the stock out"):
            held(ELL, TOOLKIT, thickness=25.0, raw=raw, program=program)


def test_words_say_what_lies_in_the_vise_and_what_to_touch_off():
    program = evolve(cut_beside(30.0, 20.0), z_zero=25.0)
    found = held(ELL, vise(parallels=[32], stop="left"), thickness=25.0, raw=RAW, program=program)
    one = next(one for one in found if one.pose.theta_deg == 90)
    said = list_raw_sentences(one, found.query, MILLIMETRE)
    assert said[:3] == [
        "Raw block of 66 × 64 × 32 mm. The part inside is 60 × 58 × 25 mm: 3 mm to cut off on each side, 2 mm on top, "
        "5 mm below.",
        "The jaws reach 7 mm over the part's lower side: beside them the lowest 7 mm of its sides are left for the next "
        "set-up.",
        "Z0 is 30.000 mm above what the block lies on, 2.000 mm below the raw top.",
    ]
    steps = list(write_setup_sentences(one, found.query, MILLIMETRE))
    assert any("the raw block in turned by 90°, the 64 mm side (face 3) flush" in step for step in steps)
    assert list_raw_sentences(one, found.query, MILLIMETRE)[3].startswith(
        "Saw-cut sides are neither flat nor"
    )
    assert not any("stands out" in step for step in steps)
    narrow = held(ELL, vise(parallels=[32], stop="right", jaw_width=60), thickness=25.0, raw=RAW)
    drawn = next(one for one in narrow if not one.pose.theta_deg)
    steps = list(write_setup_sentences(drawn, narrow.query, MILLIMETRE))
    assert any(step.endswith(", and it stands out 6.000 mm beyond their left end") for step in steps)
    whole = held(ELL, vise(parallels=[40]), thickness=25.0, raw={"bottom": 4})
    said = list_raw_sentences(whole[0], whole.query, MILLIMETRE)
    assert "nothing to cut off on each side, nothing on top, 4 mm below" in said[0]
    # Its sides are not from the saw.
    assert len(said) == 3
    assert (
        said[1] == "The part's lower side is level with the jaws' top: its sides can be cut all the way down."
    )


def test_bodies_are_the_block_with_the_part_inside():
    found = held(ELL, TOOLKIT, thickness=25.0, raw=RAW)
    from workhold.presenting.assembly import Assembly

    block, part, *_ = Assembly.from_fixture(found[0], found, {}).bodies
    assert (block.name, part.name) == ("raw block of ell", "ell")
    assert [(one.low, one.high) for one in (*block.slabs, *part.slabs)] == [(0.0, 32.0), (5.0, 30.0)]
