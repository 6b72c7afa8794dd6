"""A verification derives seats under straps, their push and the force, and sees a fault in each rule."""

import json
from math import cos, radians, sin

import pytest

import workhold
from workhold import Load, Program, Restrictions, StrapPlate, Workpiece, circle_zone
from workhold.verification import verify, verify_file

BLOCK = Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
ROUNDED = Workpiece.from_loops(
    "rounded", [[[0, 0, 0], [70, 0, 1], [70, 50, 0], [0, 50, 0]], [[30, 25, -1], [46, 25, -1]]]
)
LOADS = (
    Load(points=(50, 30), force=300, directions=20),
    Load(points=(20, 20), force=120, directions=(0, 60), moment=900, height=20),
    Load(points=(40, 25), force=50, directions=90, upward=60),
)
PLATE = StrapPlate(20, 3, 8, 6)
RAISED = StrapPlate(20, 3, 8, 6, straps=2, over="supports", supports={"pad_radius": 5, "height": 12})


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("part", "plate", "asked"),
    [
        (BLOCK, PLATE, {}),
        (BLOCK, StrapPlate(20, 3, straps=1), {"weight": 12.0}),
        (BLOCK, StrapPlate(20, 3, 8, 6, bolt_pitch=10, bolt_offset=5, straps=3), {"friction": {"tip": 0.2}}),
        (ROUNDED, PLATE, {"safety": 1.5}),
        (BLOCK, PLATE, {"restrictions": Restrictions(zones=(circle_zone(50, 30, 14),), avoid=(1,))}),
        (BLOCK, RAISED, {"weight": 12.0}),
        (ROUNDED, RAISED, {"friction": {"support": 0.2}}),
        (BLOCK, StrapPlate(20, 3, straps=1, over="supports", bolt_pitch=10, bolt_offset=5), {}),
    ],
    ids=[
        "block",
        "one strap",
        "own bolts",
        "rounded",
        "zone",
        "raised",
        "rounded raised",
        "raised, one strap",
    ],
)
def test_every_seat_is_proven(part, plate, asked):
    result = workhold.design(part, plate, loads=LOADS, thickness=25, strapped=2, best=60, **asked)
    assert result[0].hold.clamp_needed
    outcome = verify(result)
    assert outcome.holds and outcome.proven == outcome.fixtures > 0, outcome.unproven[:2] or outcome.faults


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    result = workhold.design(BLOCK, PLATE, loads=LOADS, thickness=25, strapped=2, best=6)
    path = tmp_path_factory.mktemp("straps") / "block.json"
    workhold.save(result, path)
    return path


def turn_pose(fixture):
    fixture["pose"]["theta_deg"] += 0.01


def move_hole(fixture):
    peg = fixture["pegs"][2]
    peg["column"], peg["x"] = peg["column"] + 1, peg["x"] + 20


def change_face(fixture):
    fixture["pegs"][0]["segment"] = 1


def push_elsewhere(fixture):
    fixture["push"]["at"][0] += 4.0
    fixture["push"]["at"][1] += 4.0


def push_away(fixture):
    fixture["push"]["direction_deg"] = (fixture["push"]["direction_deg"] + 120.0) % 360


def share_hole(fixture):
    fixture["straps"][1]["hole"] = fixture["straps"][0]["hole"]


def lift_heel(fixture):
    fixture["straps"][0]["heel"] += 2.0


def move_tip(fixture):
    fixture["straps"][0]["at"][0] += 3.0


def need_less(fixture):
    need = fixture["quality"]["clamp_needed_each"]
    need[0] *= 0.97


def hold_all(fixture):
    fixture["quality"]["clamp_needed_each"][2] = None


def overlap_tips(fixture):
    fixture["straps"][1]["at"] = [fixture["straps"][0]["at"][0] + 5.0, fixture["straps"][0]["at"][1]]


@pytest.mark.thorough
@pytest.mark.parametrize(
    "fault",
    [
        turn_pose,
        move_hole,
        change_face,
        push_elsewhere,
        push_away,
        share_hole,
        lift_heel,
        move_tip,
        need_less,
        hold_all,
        overlap_tips,
    ],
    ids=lambda fault: fault.__name__,
)
def test_a_fault_in_a_file_is_seen(written, tmp_path, fault):
    data = json.loads(written.read_text())
    fault(data["fixtures"][0])
    path = tmp_path / "faulty.json"
    path.write_text(json.dumps(data))
    outcome = verify_file(path)
    assert not outcome.holds and [one.index for one in outcome.unproven] == [0], outcome


@pytest.fixture(scope="module")
def raised(tmp_path_factory):
    result = workhold.design(BLOCK, RAISED, loads=LOADS, thickness=25, strapped=2, best=6)
    path = tmp_path_factory.mktemp("raised") / "block.json"
    workhold.save(result, path)
    return path


def move_support(fixture):
    """Under the part's border."""
    fixture["supports"][spare_support(fixture)] = [fixture["pegs"][0]["column"], fixture["pegs"][0]["row"]]


def line_supports_up(fixture):
    fixture["supports"][2] = [2 * b - a for a, b in zip(*fixture["supports"][:2], strict=True)]


def lie_on_two(fixture):
    del fixture["supports"][spare_support(fixture)]


def lie_on_the_plate(fixture):
    fixture["supports"] = []
    for strap in fixture["straps"]:
        strap["over"] = "plate"


def press_beside_support(fixture):
    fixture["straps"][0]["at"][0] += 5.1


def lower_heel_to_part(fixture):
    for strap in fixture["straps"]:
        strap["heel"] -= 12.0


def spare_support(fixture):
    over = [strap["over"] for strap in fixture["straps"]]
    return next(k for k, one in enumerate(fixture["supports"]) if one not in over)


@pytest.mark.thorough
@pytest.mark.parametrize(
    "fault",
    [
        move_support,
        line_supports_up,
        lie_on_two,
        lie_on_the_plate,
        press_beside_support,
        lower_heel_to_part,
        need_less,
        share_hole,
    ],
    ids=lambda fault: fault.__name__,
)
def test_a_fault_over_supports_is_seen(raised, tmp_path, fault):
    data = json.loads(raised.read_text())
    fault(data["fixtures"][0])
    path = tmp_path / "faulty.json"
    path.write_text(json.dumps(data))
    outcome = verify_file(path)
    assert not outcome.holds and [one.index for one in outcome.unproven] == [0], outcome


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    """A pocket in the middle of the block, and one of its corners cut off."""
    folder = tmp_path_factory.mktemp("pocket")
    (folder / "p.nc").write_text(
        "G21 G90\nG0 X30. Y20. Z70.\nT1 M6\nZ5.\nG1 Z-3. F200\nX70. F600\nG3 X70. Y40. J10.\nG1 X30.\nY20.\nG0 Z70.\n"
        "X104. Y64.\nZ2.\nG1 Z-14.\nX90.\nG0 Z70.\nM30\n"
    )
    (folder / "tools.toml").write_text(
        "tool.1 = {diameter = 10, flute_length = 30, stickout = 40, holder_diameter = 40, cutting_force = 180}\n"
    )
    return Program.read(folder / "p.nc", folder / "tools.toml", thickness=25, start=(30, 20, 70))


@pytest.fixture(scope="module", params=["plate", "supports"])
def cut(request, program):
    plate = StrapPlate(20, 3, 8, 6, over=request.param, supports={"pad_radius": 5, "height": 12})
    asked = {"program": program, "peg_height": 15, "weight": 12.0, "strapped": 2, "best": 400}
    return workhold.design(BLOCK, plate, thickness=25, loads=LOADS[:1], **asked)


@pytest.mark.thorough
def test_a_program_is_passed_by_locators_and_straps_and_held(cut, tmp_path):
    """The walk along its moves, and loads of its tools, show it in another way."""
    outcome = verify(cut)
    assert outcome.holds and outcome.proven == outcome.fixtures > 50, outcome.unproven[:2] or outcome.faults
    hold = cut[0].hold
    assert hold.program_need.force and hold.clamp_needed == max(hold.needs)
    assert cut.found["strapped"] < 2036
    workhold.save(cut, tmp_path / "cut.json")
    workhold.save(workhold.open(tmp_path / "cut.json"), tmp_path / "again.json")
    assert (tmp_path / "cut.json").read_bytes() == (tmp_path / "again.json").read_bytes()


def move_strap_into_the_cut(fixture):
    """Its tip stands over the pocket's border."""
    turn, pose = radians(fixture["pose"]["theta_deg"]), fixture["pose"]
    x, y = 50.0, 20.0
    at = [pose["x"] + cos(turn) * x - sin(turn) * y, pose["y"] + sin(turn) * x + cos(turn) * y]
    fixture["straps"][0]["at"] = at


def ask_less_for_the_program(fixture):
    fixture["program_force"]["force"] *= 0.97


def name_another_line(fixture):
    fixture["program_force"]["line"] = 5


def leave_program_out(fixture):
    del fixture["program_force"]


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("fault", "words"),
    [
        (move_strap_into_the_cut, "brings a tool within"),
        (ask_less_for_the_program, "the program asks for"),
        (name_another_line, "line 5"),
        (leave_program_out, "force of the straps of its program is missing"),
    ],
    ids=lambda one: getattr(one, "__name__", ""),
)
def test_a_fault_with_a_program_is_seen(cut, tmp_path, fault, words):
    workhold.save(cut, tmp_path / "cut.json")
    data = json.loads((tmp_path / "cut.json").read_text())
    fault(data["fixtures"][0])
    (tmp_path / "faulty.json").write_text(json.dumps(data))
    outcome = verify_file(tmp_path / "faulty.json")
    assert [one.index for one in outcome.unproven] == [0] and words in str(outcome.unproven[0].reason)


@pytest.mark.thorough
def test_lower_straps_find_more_places_beside_a_program(program):
    """Rapid moves 70 mm above the part are in the way of straps that reach so high."""
    counts = []
    for height in (1.0, 36.0, 200.0):
        plate = StrapPlate(20, 3, 8, 6, strap_height=height)
        asked = {"program": program, "peg_height": 15, "strapped": 1, "best": 3000}
        result = workhold.design(BLOCK, plate, thickness=25, **asked)
        (hold,) = (one for one in result.holds if one.is_looked_at)
        counts.append(hold.places)
    assert counts[0] >= counts[1] > counts[2]


@pytest.mark.thorough
def test_a_seat_listed_twice_and_a_wrong_order_are_seen(written, tmp_path):
    data = json.loads(written.read_text())
    data["fixtures"][5] = data["fixtures"][4]
    path = tmp_path / "twice.json"
    path.write_text(json.dumps(data))
    assert "same as fixture 5" in verify_file(path).unproven[0].reason
    data = json.loads(written.read_text())
    data["fixtures"][1], data["fixtures"][4] = data["fixtures"][4], data["fixtures"][1]
    path.write_text(json.dumps(data))
    assert any("better than the one before" in fault for fault in verify_file(path).faults)


@pytest.mark.thorough
def test_a_complete_verification_finds_what_is_missing_and_better_straps(written, tmp_path):
    """Answering the query again compares seats, counts and the best force."""
    assert workhold.verify(workhold.open(written)).holds
    data = json.loads(written.read_text())
    data["found"]["strapped"] -= 1
    path = tmp_path / "fewer.json"
    path.write_text(json.dumps(data))
    assert not workhold.verify(workhold.open(path), complete=True).holds
