"""Fixtures with a program are those without it, less every one that a slow walk along its moves comes too near."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from slow_program import (
    DRILL,
    END_MILL,
    OFF,
    PEG_HEIGHT,
    THICKNESS,
    box_of,
    kinds_of_toolkit,
    low_points,
    path,
    program_of,
    random_program,
    slow_clearance,
)
from strategies import random_outline
from workhold import Fence, Fixture, InputError, Plate, Program, Query, Result, Vise, Workpiece, answer, load
from workhold.algebra import find_fixtures_by_algebra
from workhold.fixels.toolkit import Toolkit
from workhold.search.explaining import explain
from workhold.statics.judging import are_unfit

KINDS = tuple(kinds_of_toolkit(10.0))
Key = tuple[object, ...]


def asked(part: Workpiece, toolkit: Toolkit, program: Program | None, **more: Any) -> Query:
    """A query whose fixtures can be compared one by one."""
    listing = "all" if toolkit.travel_count > 1 else None
    return Query(part, toolkit, listing=listing, program=program, peg_height=PEG_HEIGHT, **more)


def listed(query: Query) -> Result:
    """The answer, or an empty one where nothing is left to touch."""
    try:
        return answer(query, threads=1)
    except InputError as error:
        assert "the program's tools pass every place" in str(error)
        return answer(query.without_program, threads=1).slice_rows(slice(0))


def key_of(fixture: Fixture) -> Key:
    """A fixture by its faces, and where its pegs are on the part, whichever way round it is listed."""
    back = fixture.pose.inverse
    pegs = [(peg.face, *(round(float(v), 3) + 0.0 for v in back.apply(peg.x, peg.y))) for peg in fixture.pegs]
    return fixture.type, fixture.direction, tuple(sorted(pegs))


def keys(result: Result) -> set[Key]:
    """The fixtures of a result."""
    return {key_of(fixture) for fixture in result}


def random_case(seed: int, kind: str) -> tuple[Workpiece, Toolkit, Program]:
    """A random part and program, and a toolkit of a kind."""
    random = Random(seed)
    part = random_outline(random, random.choice([4, 5, 6, 8]))
    toolkit = kinds_of_toolkit(random.choice([10.0, 12.5]))[kind]
    return part, toolkit, random_program(random, part)


def differences(seed: int, kind: str) -> tuple[list[str], int, int]:
    """What is wrong with the list of a random case, how many fixtures it has, and of how many."""
    part, toolkit, program = random_case(seed, kind)
    full, some = listed(asked(part, toolkit, None)), listed(asked(part, toolkit, program))
    low, kept, wrong = low_points(program, PEG_HEIGHT), keys(some), list[str]()
    for fixture in full:
        key, clear = key_of(fixture), slow_clearance(fixture, toolkit, low)
        if key in kept:
            kept.remove(key)
            if clear < program.clearance - 1e-6:
                wrong.append(f"listed at {clear:.6f}: {key}")
        elif clear > program.clearance + OFF:
            wrong.append(f"left out at {clear:.6f}: {key}")
    wrong += [f"only with the program: {key}" for key in kept]
    for fixture in some[:20]:
        clear = slow_clearance(fixture, toolkit, low)
        said = fixture.quality.get("program_clearance", np.inf)
        if not said - 1e-9 <= clear <= said + OFF and not np.isinf(said):
            wrong.append(f"says {said:.6f}, and the walk {clear:.6f}")
    return wrong, len(some), len(full)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_listed_is_what_a_slow_walk_leaves(kind: str) -> None:
    wrong, some, full = differences(5 if kind != "opening" else 2, kind)
    assert wrong == []
    assert 0 < some < full


@pytest.mark.prove
@pytest.mark.parametrize("kind", KINDS)
def test_of_fifteen_random_pairs_as_well(kind: str) -> None:
    cases = [differences(seed, kind) for seed in (2, 5, *range(100, 113))]
    assert [wrong for wrong, _, _ in cases if wrong] == []
    assert sum(0 < some < full for _, some, full in cases) >= 5


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", KINDS)
def test_more_clearance_adds_no_fixture(kind: str) -> None:
    part, toolkit, program = random_case(5, kind)
    lists = [keys(listed(asked(part, toolkit, evolve(program, clearance=c)))) for c in (0.0, 0.5, 2.0, 6.0)]
    assert all(more <= less for less, more in pairwise(lists)) and (lists[0] or kind == "opening")
    assert len(lists[-1]) < len(lists[0]) or kind == "opening"


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", KINDS)
def test_a_program_high_above_all_pegs_changes_nothing(kind: str) -> None:
    part, toolkit, _ = random_case(2, kind)
    x0, y0, x1, y1 = box_of(part)
    high = program_of(path(END_MILL, [(x0, y0, PEG_HEIGHT + 0.01), (x1, y1, PEG_HEIGHT + 0.01)]))
    free, some = answer(asked(part, toolkit, None), threads=1), answer(asked(part, toolkit, high), threads=1)
    assert [fixture.pegs for fixture in some] == [fixture.pegs for fixture in free] and len(free)
    assert not any("program_clearance" in fixture.quality for fixture in some)


def test_a_tool_that_comes_down_to_the_height_of_pegs_counts() -> None:
    part, toolkit, _ = random_case(2, "vise")
    x0, y0, x1, y1 = box_of(part)
    at = [(x0, y0, PEG_HEIGHT), (x1, y1, PEG_HEIGHT)]
    assert len(listed(asked(part, toolkit, program_of(path(END_MILL, at))))) < len(
        listed(asked(part, toolkit, None))
    )


PROGRAM = """(T1 D=6 - end mill)
G21 G90
T1 M6
G0 X{0} Y{1} Z20
G1 Z-6
G1 X{2}
G2 X{3} Y{4} I0 J3
G0 Z20
M30
"""


@pytest.mark.thorough
def test_a_program_shifted_with_its_zero_is_the_same(tmp_path: Path) -> None:
    part, toolkit, places = load("widget"), Vise(8, 2, 3), (-20.0, -18.0, 25.0, 28.0, -15.0)
    found = []
    for x, y in ((0.0, 0.0), (12.5, -7.0)):
        file = tmp_path / "program.nc"
        shifted = [place - (y if k in (1, 4) else x) for k, place in enumerate(places)]
        file.write_text(PROGRAM.format(*shifted))
        program = Program.read(file, zero=(x, y), thickness=THICKNESS)
        found.append(answer(asked(part, toolkit, program), threads=1))
    one, other = found
    assert 0 < len(one) < len(answer(asked(part, toolkit, None), threads=1)) and keys(one) == keys(other)
    np.testing.assert_allclose(one.table.quality, other.table.quality, atol=1e-9)


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", KINDS)
def test_a_rapid_move_in_a_box_counts_as_all_that_is_in_it(kind: str) -> None:
    part, toolkit, _ = random_case(5, kind)
    x0, y0, _, _ = box_of(part)
    (left, low), (right, high) = (x0 - 20.0, y0 - 20.0), (x0 + 6.0, y0 + 8.0)
    start, end = (left, low, 5.0), (right, high, 5.0)
    rapid = program_of([(DRILL, False, start, end, 0.0)])
    # Passes nearer to each other than the tool is thick leave nothing between them.
    corners = [(left, low), (right, low), (right, high), (left, high), (left, low)]
    points = [(x, y, 5.0) for x, y in corners]
    points += [(x, y, 5.0) for y in np.arange(low, high, 1.5).tolist() for x in (left, right)]
    filled = program_of([(DRILL, True, a, b, 0.0) for a, b in pairwise(points)])
    box = keys(listed(asked(part, toolkit, evolve(rapid, rapid="box"))))
    straight = keys(listed(asked(part, toolkit, rapid)))
    assert box == keys(listed(asked(part, toolkit, filled))) and box <= straight
    assert kind not in ("vise", "plate") or box < straight


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(4))
def test_no_contact_is_on_a_face_that_is_cut_away(seed: int) -> None:
    """A cut within the tool's radius of a face leaves no contact there, nor within the clearance of its ends."""
    part, toolkit, program = random_case(seed, "vise")
    low = low_points(evolve(program, moves=cuts_of(program)), PEG_HEIGHT)
    for fixture in listed(asked(part, toolkit, program)):
        for peg in fixture.pegs:
            (face,) = [one for one in part.faces if one.number == peg.face]
            x, y = (float(v) for v in fixture.pose.inverse.apply(peg.x, peg.y))
            u, v = face.segment.compute_point(face.segment.find_parameter((x, y)))
            for points, radius in low:
                away = np.hypot(points[:, 0] - u, points[:, 1] - v).min()
                assert away > radius + program.clearance - 2 * OFF


def cuts_of(program: Program) -> Any:
    """The moves at a feed alone."""
    moves, cut = program.moves, program.moves.cutting
    names = ("line", "tool", "cutting", "start", "end", "bulge", "feed", "spindle", "cycle")
    return evolve(moves, **{name: getattr(moves, name)[cut] for name in names})


@pytest.mark.thorough
def test_both_engines_list_the_same() -> None:
    part, _, program = random_case(5, "vise")
    query = asked(part, Vise(12.5, 2, 3), program, types="II")
    assert keys(answer(query, threads=1)) == keys(find_fixtures_by_algebra(query))


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["vise", "bolted", "bolted pair", "fence pair", "flat"])
def test_the_best_are_the_first_of_all(kind: str) -> None:
    part, toolkit, program = random_case(5, kind)
    query = asked(part, toolkit, program, rank_by=["program-clearance", "closure-margin"])
    every, best = answer(query, threads=1), answer(evolve(query, best=6), threads=1)
    assert [fixture.pegs for fixture in best] == [fixture.pegs for fixture in every[:6]]
    # What is none for a workshop stands behind all others.
    fit = int((~are_unfit(every.table.quality, query.tolerance)).sum())
    said = [fixture.quality["program_clearance"] for fixture in every[:fit]]
    assert np.diff([float(f"{value:.1e}") for value in said]).max() <= 0.0


def test_a_shoulder_below_the_part_keeps_clear_of_what_is_swept_there() -> None:
    part, x = random_outline(Random(5), 6), 0.0
    x0, y0, x1, _ = box_of(part)
    plain, shouldered = Vise(20.0, 2, 3.0), Vise(20.0, 2, 3.0, body_radius=8.0)
    above = program_of(path(END_MILL, [(x0, y0 - 9.0 + x, 0.5), (x1, y0 - 9.0, 0.5)]))
    below = program_of(path(END_MILL, [(x0, y0 - 9.0, -0.5), (x1, y0 - 9.0, -0.5)]))
    free = keys(listed(asked(part, shouldered, None)))
    plain_above, plain_below = (keys(listed(asked(part, plain, one))) for one in (above, below))
    assert plain_above == plain_below
    assert keys(listed(asked(part, shouldered, above))) == plain_above & free
    assert keys(listed(asked(part, shouldered, below))) < plain_below & free


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["fence", "bolted fence", "fence pair", "flat"])
def test_a_wall_is_kept_clear_however_far_from_the_pegs_a_tool_comes_down(kind: str) -> None:
    part, toolkit, _ = random_case(5, kind)
    free = answer(asked(part, toolkit, None), threads=1)
    for fixture in free[:: max(len(free) // 6, 1)]:
        # Half a millimetre above the wall, where nothing else of the fixture is.
        x, y = (float(v) for v in fixture.pose.inverse.apply(500.0, 3.5))
        for clearance, is_listed in ((0.6, False), (0.4, True)):
            program = program_of(path(END_MILL, [(x, y, 5.0)]), clearance=clearance)
            some = listed(asked(part, toolkit, program))
            assert (key_of(fixture) in keys(some)) == is_listed
            if is_listed:
                (mine,) = [one for one in some if key_of(one) == key_of(fixture)]
                assert mine.quality["program_clearance"] == pytest.approx(0.5, abs=1e-9)


def around(part: Workpiece, off: float) -> list[tuple[float, float, float]]:
    """Places around a part's box, at half the height of pegs."""
    x0, y0, x1, y1 = box_of(part)
    corners = [(x0 - off, y0 - off), (x1 + off, y0 - off), (x1 + off, y1 + off), (x0 - off, y1 + off)]
    return [(x, y, 4.0) for x, y in (*corners, corners[0])]


def test_a_program_that_leaves_no_place_is_named_with_its_line() -> None:
    part = random_outline(Random(5), 6)
    program = program_of(path(END_MILL, around(part, 2.0)), clearance=40.0)
    with pytest.raises(InputError, match=r"pass every place along .*, line [4-7] most of them"):
        answer(asked(part, Vise(10.0, 2, 3.0), program), threads=1)


@pytest.mark.thorough
@pytest.mark.parametrize("toolkit", [Fence(10.0, 3.0, wall_offset=6.0), Vise(10.0, 1, 3.0)])
def test_an_explanation_names_the_program_and_its_line(toolkit: Toolkit) -> None:
    part = random_outline(Random(5), 6)
    cuts = around(part, 2.0)[:4] if isinstance(toolkit, Vise) else around(part, 2.0)[:3]
    for clearance in (8.0, 14.0, 18.0, 22.0):
        query = asked(part, toolkit, program_of(path(END_MILL, cuts), clearance=clearance))
        if not len(listed(query)):
            break
    why = explain(query, threads=1)
    assert any(removal.rule.startswith("tools of the program, most in line ") for removal in why.removals)
    assert any(help.change.startswith("without the program, of which line ") for help in why.helps)


EYES = [[[16.1245154965971, -8, 0], [53.8754845034029, -8, 4.265564437074636]]]
EYES[0] += [[53.8754845034029, 8, 0], [16.1245154965971, 8, 4.265564437074636]]


@pytest.mark.parametrize("low", [4.0, 40.0])
def test_a_program_that_leaves_faces_that_hold_nothing_is_the_reason(low: float) -> None:
    """Of two eyes on a web the tools leave one; high above the pegs they leave all, and are not named."""
    part = Workpiece.from_loops("eyes", EYES)
    cuts = path(END_MILL, [(10, -13, low), (70, -23, low), (70, 23, low), (10, 13, low)], [0.0, 1.0, 0.0])
    result = answer(asked(part, Vise(12.0, 1, 3.0), program_of(cuts, clearance=3.0)), threads=1)
    if low > THICKNESS:
        assert len(result)
    else:
        reason = str(result.notes[0])
        assert reason.startswith(
            "Every face that the program's tools leave, of which line 5 takes the most, is an arc"
        )


@pytest.mark.parametrize("toolkit", [Vise(20.0, 2, 3.0), Fence(20.0, 3.0, wall_offset=6.0)])
def test_a_reason_says_that_the_tools_take_places_away(toolkit: Toolkit) -> None:
    """Also where pegs still touch, or lie beside a wall; a program that takes nothing is not named."""
    points = [(0, 0), (60, 0), (60, 30), (40, 44), (0, 40)]
    part = Workpiece.from_points("plate", points)
    x0, y0, x1, y1 = box_of(part)
    around_most = [(x0 - 12, y0 - 2, 4.0), (x1 + 2, y0 - 2, 4.0), (x1 + 2, y1 + 2, 4.0)]
    none = answer(asked(part, toolkit, program_of(path(END_MILL, around_most), clearance=9.0)), threads=1)
    assert not len(none)
    assert "clear of the program's tools, of which line " in str(
        none.notes[0]
    ) and "is most in the way" in str(none.notes[0])
    round_part = Workpiece.from_loops("disc", [[[10, 0, 1], [-10, 0, 1]]])
    above = program_of(path(END_MILL, [(0.0, -11.0, 4.0), (3.0, -11.0, 4.0)]))
    blamed = answer(asked(round_part, Vise(10.0, 1, 3.0), above), threads=1)
    assert str(blamed.notes[0]).startswith("Every face is an arc about one centre")


def test_heights_are_asked_for_where_nobody_knows_them() -> None:
    part, program = random_outline(Random(5), 6), program_of(path(END_MILL, [(0.0, 0.0, 1.0)]))
    with pytest.raises(InputError, match="give its thickness, and the peg height"):
        Query(part, Vise(10.0, 1, 3.0), program=program)
    with pytest.raises(InputError, match="peg height -1 is not a length"):
        Query(part, Vise(10.0, 1, 3.0), program=program, peg_height=-1.0)
    with pytest.raises(InputError, match="there is no program to rank by"):
        Query(part, Vise(10.0, 1, 3.0), rank_by=["program-clearance"])


@pytest.mark.thorough
def test_an_explanation_says_that_tools_hit_the_body_of_a_clamp() -> None:
    """A path between tips and bolts leaves every peg and takes every clamp; farther out it takes nothing."""
    part = Workpiece.from_points("plate", [(0, 0), (60, 0), (60, 40), (0, 40)])
    plate = Plate(10.0, 3.0, clamp_radius=4.0, columns=12, rows=12, directions=["-x"], travel=(6, 30))
    near, far = (program_of(path(END_MILL, around(part, off))) for off in (12.4, 60.0))
    assert len(answer(Query(part, plate, program=far, peg_height=9.0, best=1), threads=1))
    query = Query(part, plate, program=near, peg_height=9.0)
    result = answer(query, threads=1)
    assert not len(result) and "its body clear of the program's tools" in str(result.reasons[0])
    why = explain(query, threads=1)
    rules = {removal.rule: removal for removal in why.removals}
    (hit,) = [
        removal for rule, removal in rules.items() if "body of the clamp clear of the program's tools" in rule
    ]
    assert hit.before > 0 and hit.after == 0
    assert rules["tools of the program"].removed == 0
