"""A plate with straps can be asked for over HTTP, and what it finds is listed, drawn and written."""

import pytest
from running_server import RunningServer

from jaw_examples import rectangle

PART = {"name": "block", "loops": [loop.tolist() for loop in rectangle().loops]}
PLATE = {"kind": "strapped", "pitch": [20, 20], "peg_radius": 3, "columns": 8, "rows": 6, "straps": 2}
LOAD = {"points": [[50, 30]], "force": 300, "directions": [0, 0], "upward": 40, "height": 23}
ASKED = {
    "workpiece": PART,
    "toolkit": PLATE,
    "thickness": 25,
    "friction": {"tip": 0.15, "plate": 0.12},
    "strapped": 2,
    "weight": 11,
    "loads": [LOAD],
    "best": 30,
}


@pytest.fixture(scope="module")
def job(server: RunningServer) -> str:
    return server.done(ASKED)


@pytest.mark.thorough
def test_seats_are_listed_with_their_straps(server: RunningServer, job: str) -> None:
    """The first two have straps; of the others it is said that nobody looked for them."""
    state = server.client.get(job).json()
    assert state["found"] == 2036 and state["complete"]
    rows = server.client.get(f"{job}/fixtures", params={"limit": 40}).json()["rows"]
    assert len(rows) == 30
    assert [len(row["hold"]["straps"]) for row in rows[:3]] == [2, 2, 0]
    assert rows[0]["quality"]["clamp_needed"] == rows[0]["hold"]["clamp_needed_each"][0] > 0
    assert rows[0]["hold"]["looked_at"] and not rows[2]["hold"]["looked_at"]


@pytest.mark.thorough
def test_seat_is_drawn_and_has_a_sheet(server: RunningServer, job: str) -> None:
    answer = server.client.get(f"{job}/fixtures/1")
    assert answer.status_code == 200, answer.text
    said = answer.json()
    assert said["hold"]["push"] and 'class="strap"' in str(said["picture"])
    assert "tighten the straps" in " ".join(said["hold"]["steps"])
    for ending in ("pdf", "svg"):
        paper = server.client.get(f"{job}/fixtures/1/sheet.{ending}")
        assert paper.status_code == 200, paper.text
    for name in ("result.json", "result.csv"):
        assert server.client.get(f"{job}/{name}").status_code == 200


@pytest.mark.thorough
def test_straps_over_supports_pass_a_program(server: RunningServer) -> None:
    """The answer names the supports, and says what the tools ask of each strap, with the line."""
    text = "G21 G90\nG0 X30. Y20. Z70.\nT1 M6\nZ5.\nG1 Z-3. F200\nX70. F600\nG0 Z70.\nM30\n"
    program = {
        "name": "slot.nc",
        "text": text,
        "tools": {
            "name": "tools.toml",
            "text": "tool.1 = {diameter = 10, flute_length = 30, stickout = 40}\n",
        },
        "start": [30, 20, 70],
        "thickness": 25,
        "peg_height": 12,
        "cutting": {"cutting_force": 200},
    }
    plate = {**PLATE, "over": "supports", "supports": {"height": 15}}
    asked = {**ASKED, "toolkit": plate, "loads": [], "program": program, "best": 3}
    job = server.done(asked)
    said = server.client.get(f"{job}/fixtures/1").json()
    assert len(said["hold"]["supports"]) == 3 and 'class="support"' in str(said["picture"])
    assert said["program_forces"]["line"] in (5, 6) and "of each strap" in said["program_forces"]["words"][0]
    assert said["quality"]["clamp_needed"] == pytest.approx(said["program_forces"]["force"])
    for ending in ("sheet.pdf", "sheet.svg"):
        assert server.client.get(f"{job}/fixtures/1/{ending}").status_code == 200


@pytest.mark.thorough
def test_reason_is_told_where_there_is_none(server: RunningServer) -> None:
    none = server.done({**ASKED, "loads": [], "restrictions": {"avoid": [0, 1, 2]}})
    assert server.client.get(none).json()["found"] == 0
    why = server.client.get(f"{none}/explanation")
    assert why.status_code in (200, 202), why.text


def test_what_is_not_done_is_refused_in_a_sentence(server: RunningServer) -> None:
    answer = server.client.post("/api/jobs", json={**ASKED, "seating": 5})
    assert answer.status_code == 400 and "is not looked at with straps" in answer.text


def test_presets_are_there(server: RunningServer) -> None:
    names = [one["name"] for one in server.client.get("/api/presets").json()]
    assert {"strap-plate-20mm", "strap-plate-one-inch", "strap-table-50mm"} <= set(names)
