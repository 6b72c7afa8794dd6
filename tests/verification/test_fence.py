"""Results of a fence: true ones are proven, and each rule that is broken is named."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from attrs import evolve
from numpy.typing import NDArray

import workhold
from judged import faults_of, posed
from toolkit_results import assert_all_proven, part, verify_edited
from workhold import Fence, Load, Query, Restrictions, Result, Workpiece, answer, circle_zone, design
from workhold import verify as verify_completely
from workhold.model.search_report import AT_AN_EDGE, UndecidedCandidate
from workhold.search.wall_contacts import PinContacts
from workhold.search.wall_search import WallSearch
from workhold.verification import Verification, verify, verify_fixture
from workhold.verification.ball_geometry import BallOutline
from workhold.verification.rules.wall import check_flush, make_wall_contacts

Data = dict[str, Any]
Edit = Callable[[Data], object]

KITE = [[0, 0, 0], [56, 6, 0], [48, 44, 0], [10, 37, 0.2]]
NOTCHED = [[0, 0, 0], [58, 0, 0], [58, 26, 0], [44, 40, 0], [20, 40, 0.3], [0, 40, 0]]
# It lies on two corners whose other faces the pegs push.
CUT = [[50, 0, 0], [58, 40, 0], [-6, 36, 0], [0, 0, 0], [25, 12, 0]]
ARCH = [[0, 0, 0], [40, 0, 0], [40, 20, 1], [0, 20, 0]]
LIMITED = Fence((10, 8), 3, columns=7, rows=7, clamp_radius=2.5, travel=(4, 26), wall_offset=6)


@pytest.fixture(scope="module")
def result() -> Result:
    """The fixtures of a part on a fence with limits, a stroke and a clamp of another radius."""
    return design(part(NOTCHED), LIMITED)


@pytest.fixture
def edited(result: Result, tmp_path: Path) -> Callable[[Edit], Verification]:
    """Verify its file after an edit of its JSON."""
    workhold.save(result, tmp_path / "r.json")
    data = json.loads((tmp_path / "r.json").read_text())

    return lambda edit: verify_edited(data, edit, tmp_path)


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("loop", "fields", "asked"),
    [
        (KITE, {"pitch": 10}, {}),
        (CUT, {"pitch": (8, 7)}, {}),
        (NOTCHED, {"pitch": (12, 9), "clamp_radius": 4.5}, {"contact_margin": 0.5}),
        (KITE, {"pitch": (8, 10), "directions": ("+x", "+y")}, {"best": 8, "rank_by": "location-error"}),
        (NOTCHED, {"pitch": 10, "columns": 6, "rows": 6, "travel": (4, 24)}, {}),
        (ARCH, {"pitch": 8}, {"loads": [Load(((30.0, 10.0),), 200.0)]}),
        (
            NOTCHED,
            {"pitch": 8, "travel": (0, 30)},
            {"restrictions": Restrictions((2,), (circle_zone(10.0, -5.0, 4.0),), ((100.0, 360.0),))},
        ),
    ],
)
def test_everything_a_search_lists_is_proven(loop: Any, fields: Data, asked: Data, tmp_path: Path) -> None:
    """As a result and in files of both forms, which say the same; and so it is when it is searched again."""
    result = design(part(loop), Fence(peg_radius=3, wall_offset=5, **fields), **asked)
    assert len(result) >= 5
    assert_all_proven(result, tmp_path, search_files=True)


def clamp(data: Data) -> Data:
    """The clamp of the first fixture."""
    return data["fixtures"][0]["pegs"][1]


def locator(data: Data) -> Data:
    """The locator of the first fixture."""
    return data["fixtures"][0]["pegs"][0]


def raised(data: Data, by: float) -> None:
    """The first fixture off the wall."""
    first = data["fixtures"][0]
    first["pose"]["y"] += by
    for peg in first["pegs"]:
        peg["y"] += by


def moved(data: Data, by: int) -> None:
    """The first fixture so many columns to the right."""
    first = data["fixtures"][0]
    for peg in first["pegs"]:
        peg["x"] += 10.0 * by
        if "column" in peg:
            peg["column"] += by
        if peg.get("hole"):
            peg["hole"][0] += by
    for end in ("from", "to"):
        first["wall"][end][0] += 10.0 * by
    first["pose"]["x"] += 10.0 * by


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda d: d["fixtures"][0]["wall"]["from"].__setitem__(0, 1.0), "from where the part touches"),
        (lambda d: d["fixtures"][0]["wall"]["to"].__setitem__(1, 0.01), "from where the part touches"),
        (
            lambda d: d["fixtures"][0]["wall"]["forces"].__setitem__(1, 0.1),
            "the force of the fence at its right end",
        ),
        (
            lambda d: d["fixtures"][0]["wall"]["segments"].__setitem__(0, 4),
            "the fence at its left end touches face",
        ),
        (
            lambda d: d["fixtures"][0]["pose"].__setitem__(
                "theta_deg", d["fixtures"][0]["pose"]["theta_deg"] + 0.01
            ),
            "touch",
        ),
        (lambda d: raised(d, 1.0), "the y of"),
        (lambda d: (moved(d, 1), d["toolkit"].__setitem__("columns", 20)), "its lowest column is 1"),
        (lambda d: locator(d).__setitem__("row", 5), "the y of the locator"),
        (lambda d: locator(d).__setitem__("force", 0.5), "the force of the locator"),
        (lambda d: locator(d).__setitem__("segment", 4), "away from touching"),
        (lambda d: d["toolkit"].__setitem__("rows", 1), "is in row"),
        (lambda d: d["toolkit"].__setitem__("columns", 1), "is in column"),
        (lambda d: d["toolkit"].__setitem__("travel", [4.0, 5.0]), "beyond the 5 mm of its stroke"),
        (lambda d: d["toolkit"].__setitem__("travel", [13.0, 26.0]), "nearer than the 13 mm of its stroke"),
        (lambda d: d["toolkit"].__setitem__("directions", ["+y"]), "which is not asked for"),
        (lambda d: d["fixtures"][0]["quality"].__setitem__("location_error", 0.001), "location error"),
        (lambda d: d["fixtures"][0]["quality"].__setitem__("smallest_face", 1.0), "smallest face"),
        (lambda d: d["fixtures"].__setitem__(1, d["fixtures"][0]), "it is the same as fixture 1"),
    ],
)
def test_what_is_wrong_is_refuted_by_name(
    edited: Callable[[Edit], Verification], edit: Edit, words: str
) -> None:
    """One edit of a true file each."""
    outcome = edited(edit)
    assert not outcome.holds
    assert any(words in item.reason for item in outcome.unproven), [item.reason for item in outcome.unproven][
        :3
    ]


@pytest.mark.thorough
@pytest.mark.thinned(5)
@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda d: d["statistics"].__setitem__("hull_edges", 3), "hull edges"),
        (lambda d: d["statistics"].pop("locator_places"), "the statistics are not"),
        (lambda d: d["fixtures"].reverse(), "fixture 2"),
        (lambda d: d["distinct"].__setitem__("edge", 1), "distinct says 1"),
        (lambda d: d["toolkit"].pop("wall_offset"), "wall_offset"),
    ],
)
def test_contradictions_of_the_head_are_told(
    edited: Callable[[Edit], Verification], edit: Edit, words: str
) -> None:
    """As faults, or as a file that cannot be verified."""
    try:
        outcome = edited(edit)
    except workhold.InputError as error:
        assert words in str(error)
        return
    assert not outcome.holds and any(words in fault for fault in outcome.faults), outcome.faults


@pytest.mark.thorough
def test_a_fixture_left_out_is_found_by_searching_again(result: Result, tmp_path: Path) -> None:
    """Only the search of the query can show it."""
    lacking = evolve(
        result,
        table=result.table.take(slice(1, None)),
        found={"edge": len(result) - 1},
        distinct={"edge": len(result) - 1},
        notes=(),
    )
    assert verify(lacking).holds
    outcome = verify_completely(lacking, complete=True)
    assert any("that it does not list" in fault for fault in outcome.faults)


@pytest.mark.thorough
def test_restrictions_are_kept_by_the_wall(result: Result) -> None:
    """A result of a wider query breaks them by name."""
    for asked, words in (
        (Restrictions((0,)), "the part lies on the fence with face 0, which is to be avoided"),
        (Restrictions(zones=(circle_zone(30.0, -6.0, 4.0),)), "the fence stands in a keep-out zone"),
        (Restrictions(angles=((10.0, 11.0),)), "outside the angles asked for"),
    ):
        outcome = verify(evolve(result, query=evolve(result.query, restrictions=asked)))
        assert any(words in item.reason for item in outcome.unproven), outcome.unproven[:3]


def test_a_part_tilted_on_the_wall_or_through_it_is_refuted(result: Result) -> None:
    """Whatever its pegs say."""
    fixture = result[0]
    here = result.query
    assert verify_fixture(fixture, here.workpiece, here.toolkit).verdict == "proven"
    for pose in (
        evolve(fixture.pose, theta_deg=fixture.pose.theta_deg + 3.0),
        evolve(fixture.pose, theta_deg=fixture.pose.theta_deg + 180.0),
        evolve(fixture.pose, y=fixture.pose.y - 2.0),
    ):
        assert verify_fixture(evolve(fixture, pose=pose), here.workpiece, here.toolkit).verdict == "refuted"


def test_undecided_entries_must_name_faces_and_reasons() -> None:
    """Their places are not looked at."""
    query = Query(part(KITE), Fence(10, 3, wall_offset=5))
    entry = UndecidedCandidate("edge -x", (1, 0, 0, 3), (0, 0, 0, 0), (0, 0, 0, 2), 0.0, AT_AN_EDGE, 0.0)
    assert faults_of([entry], query) == []
    assert len(faults_of([evolve(entry, faces=(9, 0, 0, 3))], query)) == 1
    assert answer(query).proof is not None


def test_a_tip_in_the_fence_is_refuted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a search that does not keep it out."""

    def pushing(self: WallSearch, places: PinContacts) -> NDArray[np.bool_]:
        return np.asarray(-(places.normal @ np.array(self.push)) > 0.0)

    query = Query(part(KITE), Fence((10, 8), 2, clamp_radius=6, wall_offset=3))
    true = {one_of(fixture) for fixture in answer(query)}
    monkeypatch.setattr(WallSearch, "find_pressing_tips", pushing)
    low = [fixture for fixture in answer(query) if one_of(fixture) not in true]
    assert low
    for fixture in low:
        ruling = verify_fixture(fixture, query.workpiece, query.toolkit)
        assert ruling.verdict == "refuted" and "the clamp enters the fence by" in ruling.reason


def one_of(fixture: workhold.Fixture) -> tuple[Any, ...]:
    """What tells a fixture of a list from the others."""
    return fixture.direction, *((peg.column, peg.row, peg.face, round(peg.x, 6)) for peg in fixture.pegs)


def test_a_foot_lower_than_the_two_that_the_part_is_said_to_lie_on_is_refuted() -> None:
    """By a few thousandths of a micrometre more than drawings are rounded by."""

    def on_feet(low: float) -> Workpiece:
        feet = [
            [0, 0, 0],
            [8, 0, 0],
            [8, 4, 0],
            [24, 4, 0],
            [24, -low, 0],
            [32, -low, 0],
            [32, 4, 0],
            [48, 4, 0],
            [48, 0, 0],
        ]
        return part([*feet, [56, 0, 0], [50, 30, 0], [4, 34, 0]])

    fence = Fence(10, 2, wall_offset=7)
    result = design(on_feet(0.0), fence, restrictions=Restrictions(angles=((-1.0, 1.0),)))
    assert len(result) > 0
    for low, verdict in ((0.0, "proven"), (3e-6, "refuted")):
        ruling = verify_fixture(result[0], on_feet(low), fence)
        assert ruling.verdict == verdict, ruling.reason
    assert "enters the fence" in ruling.reason


def test_a_foot_beyond_the_ends_that_are_told_is_found() -> None:
    """Ends at the outer feet leave none beyond; with the right one at the middle foot the third is."""
    feet = [
        [0, 0, 0],
        [8, 0, 0],
        [8, 4, 0],
        [24, 4, 0],
        [24, 0, 0],
        [32, 0, 0],
        [32, 4, 0],
        [48, 4, 0],
        [48, 0, 0],
    ]
    workpiece = part([*feet, [56, 0, 0], [50, 30, 0], [4, 34, 0]])
    outline, pose = BallOutline.from_workpiece(workpiece), posed(0)
    left, right = make_wall_contacts([outline.faces[0], outline.faces[8]], outline, pose)
    inner = evolve(right, piece=evolve(right.piece, center=outline.faces[5].start), faces=(4,))
    pegs = [workhold.Peg("wall", 0, 0, x, 0.0, face, 0.5) for x, face in ((0.0, 0), (56.0, 8), (32.0, 4))]
    whole = [("left", pegs[0], left), ("right", pegs[1], right)]
    assert list(check_flush("fence", whole, pose, outline)) == []
    short = [("left", pegs[0], left), ("right", pegs[2], inner)]
    (found, *_) = check_flush("fence", short, pose, outline)
    assert "lies on the fence at face 7, beyond its stated ends" in found.reason
    one_foot = [("left", pegs[0], left), ("right", pegs[0], left)]
    assert "the part does not lie flush on the fence" in [
        f.reason for f in check_flush("fence", one_foot, pose, outline)
    ]
