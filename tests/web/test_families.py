"""Families of parts over HTTP: the curve, the plan on paper, and what is refused."""

from __future__ import annotations

import json
from typing import Any

import pytest
from running_server import LONG, RunningServer, request

from family_parts import shop_parts
from workhold import Query, Vise
from workhold.family.family import MemberRequest, format_family_json, make_family
from workhold.family.members import RANKINGS

pytest.importorskip("scipy", reason="the extra [batch] is not installed")

VISE = {"pitch": [10, 10], "columns": 1, "peg_radius": 3}
DISC = {"name": "disc", "loops": [[[0, 0, 1], [40, 0, 1]]]}
PARTS = shop_parts(3)


def forms() -> list[dict[str, Any]]:
    """The parts as they are sent."""
    return [{"name": part.name, "loops": [loop.tolist() for loop in part.loops]} for part in PARTS]


def asked(**changes: Any) -> dict[str, Any]:
    """A family, with some values changed."""
    return {"workpieces": [*forms(), DISC], "toolkit": VISE, **changes}


@pytest.fixture(scope="module")
def job(server: RunningServer) -> str:
    """The address of a family that is found."""
    return server.done(asked(), "/api/families")


@pytest.mark.thorough
def test_the_curve_is_that_of_the_program(server: RunningServer, job: str) -> None:
    state = server.client.get(job).json()
    assert (state["kind"], state["state"], state["fraction"], state["complete"]) == (
        "family",
        "done",
        1.0,
        True,
    )
    answer = server.client.get(f"{job}/family").json()
    vise = Vise(pitch=10, columns=1, peg_radius=3)
    family = make_family(
        [MemberRequest(part.name, Query(part, vise, rank_by=RANKINGS[1])) for part in PARTS], threads=1
    )
    assert [(one["setups"], one["loss"]) for one in answer["points"]] == [
        (p.setups, p.loss) for p in family.points
    ]
    assert [one["pegs_moved"] for one in answer["points"]] == [plan.moved for plan in family.plans]
    assert len(family.points) > 1
    for one, plan in zip(answer["points"], family.plans, strict=True):
        worst = [held for setup in plan.setups for held in setup.holdings if held.loss == plan.point.loss]
        assert (one["worst"], one["figure"]) in [(held.member.name, held.figure) for held in worst]
    assert answer["figure"] == "location_error" and answer["parts"] == [part.name for part in PARTS]
    assert answer["left_out"] == [{"name": "disc", "reason": "it has no fixture in this vise"}]
    told = json.loads(server.client.get(f"{job}/family/plans.json").text)["family"]
    assert told["curve"] == json.loads(format_family_json(family))["family"]["curve"]


@pytest.mark.thorough
def test_curve_and_sheets_are_made(server: RunningServer, job: str) -> None:
    curve = server.client.get(f"{job}/family/curve.svg", params={"setups": 2})
    assert curve.headers["content-type"].startswith("image/svg+xml") and "3 parts" in curve.text
    sheets = server.client.get(f"{job}/family/sheets.svg", params={"unit": "inch", "date": "2026-03-31"})
    assert (
        "Set-up 1 of" in sheets.text
        and "2026-03-31" in sheets.text
        and all(part.name in sheets.text for part in PARTS)
    )
    assert sheets.text.count("Set-up 1 of 1") and "Set-up 1 of 2" not in sheets.text
    more = server.client.get(f"{job}/family/sheets.svg", params={"setups": 2})
    assert "Set-up 2 of 2" in more.text
    # The point that was picked is marked.
    assert curve.text != server.client.get(f"{job}/family/curve.svg").text
    paper = server.client.get(f"{job}/family/sheets.pdf", params={"setups": 9})
    assert paper.content.startswith(b"%PDF") and "attachment" in paper.headers["content-disposition"]


@pytest.mark.thorough
def test_what_cannot_be_is_told(server: RunningServer, job: str) -> None:
    client = server.client
    for body in (
        {"workpieces": []},
        {"toolkit": None},
        {"workpieces": [{"name": "a", "loops": [[[0, 0, 0]]]}]},
        {"more": 1},
    ):
        answer = client.post("/api/families", json=asked(**body))
        assert answer.status_code == 400 and answer.json()["error"].endswith(".")
    for address in (f"{job}/fixtures", f"{job}/result.json", f"{job}/explanation"):
        answer = client.get(address)
        assert answer.status_code == 409 or address.endswith("fixtures"), address
    other = server.done(request())
    assert client.get(f"{other}/family").status_code == 409
    assert "not of several parts" in client.get(f"{other}/family/curve.svg").json()["error"]
    nothing = server.done(asked(workpieces=[DISC]), "/api/families")
    assert client.get(f"{nothing}/family").json()["points"] == []
    assert "No pattern" in client.get(f"{nothing}/family/sheets.svg").json()["error"]


@pytest.mark.thorough
def test_a_family_is_stopped(server: RunningServer) -> None:
    url = server.submit({"workpieces": [LONG["workpiece"]] * 2, "toolkit": LONG["toolkit"]}, "/api/families")
    assert server.client.get(f"{url}/family").json()["error"] == "The search is not over yet."
    server.state_when(url, lambda state: state["state"] == "running")
    server.client.post(f"{url}/cancel")
    state = server.state_when(url, lambda state: state["state"] == "cancelled")
    assert state["complete"] is False
    assert "ended without a result" in server.client.get(f"{url}/family").json()["error"]


@pytest.mark.thorough
def test_parts_of_one_name_are_told_apart(server: RunningServer) -> None:
    url = server.done(asked(workpieces=[forms()[0], forms()[0]]), "/api/families")
    answer = server.client.get(f"{url}/family").json()
    assert answer["parts"] == ["ell-1", "ell-1 (2)"]
    assert [one["setups"] for one in answer["points"]] == [1]


BLOCKS = [
    {"name": name, "loops": [[[0, 0, 0], [width, 0, 0], [width, 40, 0], [0, 40, 0]]]}
    for name, width in (("low", 90), ("high", 60))
]
PLAIN = {"kind": "plain-vise", "jaw_width": 152, "jaw_height": 44, "parallels": [20, 32], "stop": "left"}


@pytest.mark.thorough
def test_blocks_in_a_plain_vise_have_their_own_thickness(server: RunningServer) -> None:
    """The loss is of the grip, and changes of parallels and stop are counted."""
    body = {"workpieces": BLOCKS, "toolkit": PLAIN, "thicknesses": [16, 45]}
    url = server.done(body, "/api/families")
    answer = server.client.get(f"{url}/family").json()
    assert answer["figure"] == "grip" and not answer["left_out"]
    assert [(one["setups"], one["loss"], one["changes"]) for one in answer["points"]] == [
        (1, 2.0, 0),
        (2, 1.0, 1),
    ]
    sheets = server.client.get(f"{url}/family/sheets.svg", params={"setups": 2}).text
    assert "Parallels of 20 mm" in sheets and "change the parallels, the stop stays" in sheets
    plan = json.loads(server.client.get(f"{url}/family/plans.json").text)["family"]["curve"][1]["plan"]
    assert [setup["parallels"] for setup in plan] == [20, 32]


def test_a_thickness_that_is_missing_is_named(server: RunningServer) -> None:
    url = server.submit({"workpieces": BLOCKS, "toolkit": PLAIN, "thicknesses": [16]}, "/api/families")
    server.wait(url) if hasattr(server, "wait") else None
    state = server.client.get(url).json()
    while state["state"] not in ("done", "failed", "cancelled"):
        state = server.client.get(url).json()
    assert "high: how thick it is decides" in state["error"] and "--" not in state["error"]
