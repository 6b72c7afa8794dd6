"""A plain vise can be asked for over HTTP, and what it finds is listed, drawn and written."""

import pytest
from running_server import RunningServer

from jaw_examples import rectangle

PART = {"name": "block", "loops": [loop.tolist() for loop in rectangle().loops]}
VISE = {
    "kind": "plain-vise",
    "jaw_width": 152,
    "jaw_height": 44,
    "max_opening": 150,
    "parallels": [20, 32],
    "stop": "left",
}
LOAD = {"points": [[50, 30]], "force": 300, "upward": 80, "height": 23}
ASKED = {
    "workpiece": PART,
    "toolkit": VISE,
    "thickness": 25,
    "friction": {"jaw": 0.15},
    "safety": 2,
    "loads": [LOAD],
}


@pytest.fixture(scope="module")
def job(server: RunningServer) -> str:
    return server.done(ASKED)


@pytest.mark.thorough
def test_fixtures_are_listed_with_what_the_jaws_touch(server: RunningServer, job: str) -> None:
    state = server.client.get(job).json()
    assert state["found"] == 8 and state["complete"]
    rows = server.client.get(f"{job}/fixtures", params={"limit": 20}).json()["rows"]
    assert len(rows) == 8 and rows[0]["title"] == "On 20 mm parallels, stop left"
    assert rows[0]["hold"]["fixed"]["rectangles"] == [[0.0, 100.0, 0.0, 24.0]]
    assert rows[0]["quality"]["clamp_needed"] == max(rows[0]["hold"]["clamp_needed_each"]) > 0


@pytest.mark.thorough
def test_fixture_is_drawn_and_has_a_sheet(server: RunningServer, job: str) -> None:
    answer = server.client.get(f"{job}/fixtures/1")
    assert answer.status_code == 200, answer.text
    assert answer.json()["hold"]["stop"] == "left" and "svg" in str(answer.json()["picture"])
    for ending in ("pdf", "svg"):
        paper = server.client.get(f"{job}/fixtures/1/sheet.{ending}")
        assert paper.status_code == 200, paper.text
    for name in ("result.json", "result.csv"):
        assert server.client.get(f"{job}/{name}").status_code == 200


def test_reason_is_told_where_there_is_none(server: RunningServer) -> None:
    none = server.done({**ASKED, "toolkit": {**VISE, "max_opening": 20}})
    assert server.client.get(none).json()["found"] == 0


def test_presets_and_their_fields_are_there(server: RunningServer) -> None:
    names = [one["name"] for one in server.client.get("/api/presets").json()]
    assert {"plain-vise-4-inch", "plain-vise-6-inch", "plain-vise-5-inch", "plain-vise-toolmaker"} <= set(
        names
    )


@pytest.mark.thorough
def test_raw_block_is_asked_for_and_described(server: RunningServer) -> None:
    asked = {**ASKED, "raw": {"side": 3, "top": 2, "bottom": 5}}
    job = server.done(asked)
    told = server.client.get(f"{job}/fixtures/1").json()
    assert told["hold"]["steps"][0].startswith("Raw block of 106 × 66 × 32 mm.")
    assert 'class="finished"' in str(told["picture"])
    wrong = server.client.post("/api/v1/jobs", json={**ASKED, "raw": {"left": 3}})
    assert wrong.status_code == 400 and "a raw block has no 'left'" in wrong.text


@pytest.mark.thorough
def test_drill_that_comes_through_is_told_with_what_it_passes(server: RunningServer) -> None:
    text = "G21 G90\nT1 M6\nS2000 M3\nG0 X20. Y6. Z10.\nG81 X20. Y6. Z-28. R2. F200\nG80\nM30\n"
    program = {"name": "drill.nc", "text": text, "tools": {"name": "t.csv", "text": "tool,diameter\n1,6\n"}}
    job = server.done({**ASKED, "program": {**program, "thickness": 25}})
    told = server.client.get(f"{job}/fixtures/1").json()
    assert told["hold"]["parallel_offsets"] == [10.0, 0.0]
    assert "one 10 mm from the fixed jaw" in told["hold"]["steps"][0]
    assert told["vise_clearance"][0].startswith("T1 comes 3.000 mm below the part in line 5")
