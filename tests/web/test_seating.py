"""Where the part ends up, over HTTP: the figures that the program tells, closings of every kind, and who hangs up."""

from __future__ import annotations

import json
import os
import signal
import socket
from threading import Event
from typing import Any

import pytest
from running_server import RunningServer, request
from test_parts import refused

import workhold
from workhold import Plate, Result, Vise, Workpiece
from workhold.model.notes import PushedByHand
from workhold.model.seating import Seating
from workhold.web.fixture_tasks import ClosingForm, ClosingOrder, simulate_closing
from workhold.web.worker import TaskContext

CORNERS = [[0, 0, 0], [70, 0, 0], [25, 55, 0]]
WEDGE = {"name": "wedge", "loops": [CORNERS]}
VISE = {"pitch": [20, 20], "columns": 2, "peg_radius": 3}


@pytest.fixture(scope="module")
def result() -> Result:
    """What the program finds."""
    return workhold.design(Workpiece.from_loops("wedge", [CORNERS]), Vise(**VISE))


@pytest.fixture(scope="module")
def told(result: Result) -> Seating:
    """The seating of its second fixture."""
    return workhold.seatings(result, [result[1]])[0]


@pytest.fixture(scope="module")
def place(server: RunningServer) -> str:
    """The address of the second fixture."""
    return f"{server.done(request(workpiece=WEDGE, toolkit=VISE))}/fixtures/2"


def put(result: Result, turn: float, dx: float, dy: float, turned_over: bool = False) -> dict[str, Any]:
    """Where the part is that is turned about its middle, shifted, and perhaps turned over about an upright line."""
    fixture, (x, y) = result[1], result.workpiece.center
    own = result.workpiece.turned_over.center if turned_over else (x, y)
    theta = (-fixture.pose.theta_deg if turned_over else fixture.pose.theta_deg) + turn
    at, lies = fixture.pose.apply(x, y), workhold.Pose(theta, 0.0, 0.0).apply(*own)
    return {
        "theta_deg": theta,
        "x": float(at[0] - lies[0]) + dx,
        "y": float(at[1] - lies[1]) + dy,
        "turned_over": turned_over,
    }


@pytest.mark.thorough
def test_figures_and_sentences_are_the_programs(server: RunningServer, place: str, told: Seating) -> None:
    answer = server.client.get(f"{place}/seating").json()
    fields = told.to_fields()
    assert {key: answer[key] for key in fields} == json.loads(json.dumps(fields))
    assert told.seats[answer["own"]].is_own
    off = [abs(answer["seats"][k]["difference"]) for k in answer["nearest"]]
    assert off == sorted(off) and len(off) == fields["wrong_seats"]
    assert answer["captions"][answer["own"]] == [
        f"S = {told.seats[answer['own']].jaw_separation:.3f} mm",
        "right",
    ]
    assert answer["done"] == "Opened"
    assert all(sentence.endswith(".") for sentence in (*answer["steps"], *answer["words"]))
    inches = server.client.get(f"{place}/seating", params={"unit": "inch"}).json()
    assert " in at most" in inches["steps"][0] and inches["capture_opening"] == answer["capture_opening"]


@pytest.mark.thorough
def test_a_search_tells_the_seating_of_its_first_fixtures(server: RunningServer, result: Result) -> None:
    """As the program does, in the order that it gives them; what cannot be asked is refused before it begins."""
    made = workhold.design(result.workpiece, result.toolkit, seating=3, opening=0.5)
    job = server.done(request(workpiece=WEDGE, toolkit=VISE, seating=3, opening=0.5))
    told = json.loads(server.client.get(f"{job}/result.json").content)
    assert (told["seating"], told["opening"], told["foolproof"]) == (3, 0.5, False)
    fields = [fixture["seating"] for fixture in told["fixtures"]]
    assert fields == json.loads(json.dumps([one.to_fields() for one in made.seating])) and len(fields) > 1
    rows = server.client.get(f"{job}/fixtures", params={"limit": 9}).json()["rows"]
    openings = [one["capture_opening"] for one in fields]
    assert [row["caught"] for row in rows] == [{"opening": one} for one in openings]
    plate = {"kind": "translating-clamp", "pitch": [20, 20], "peg_radius": 3, "clamps": 2}
    for asked in ({"opening": 1.0}, {"foolproof": True}, {"seating": 0}, {"seating": 3, "opening": -1}):
        refused(server.client.post("/api/jobs", json=request(workpiece=WEDGE, toolkit=VISE, **asked)), 400)
    for asked in ({"opening": 1.0}, {"foolproof": True}):
        refused(
            server.client.post("/api/jobs", json=request(workpiece=WEDGE, toolkit=plate, seating=3, **asked)),
            400,
        )


@pytest.mark.thorough
def test_with_two_clamps_it_is_told_what_to_do_by_hand(server: RunningServer) -> None:
    """In the unit asked for, on the sheet too; a search may ask for it, and no closing is played."""
    plate = {"kind": "translating-clamp", "pitch": [20, 20], "peg_radius": 3, "clamps": 2}
    job = server.done(request(workpiece=WEDGE, toolkit=plate, seating=3))
    made = workhold.design(Workpiece.from_loops("wedge", [CORNERS]), Plate(20, 3, clamps=2), seating=3)
    [told] = workhold.seatings(made, [made[1]])
    answer = server.client.get(f"{job}/fixtures/2/seating").json()
    assert answer == {"rank": 2, "by_hand": json.loads(json.dumps(told.to_fields()))}
    inches = server.client.get(f"{job}/fixtures/2/seating", params={"unit": "inch"}).json()["by_hand"]
    assert " in at clamp" in inches["steps"][-1] and inches["steps"][:-1] == answer["by_hand"]["steps"][:-1]
    assert PushedByHand().words in server.client.get(job).json()["notes"]
    sheet = server.client.get(f"{job}/fixtures/2/sheet.svg")
    assert sheet.status_code == 200 and "Does the part end up there?" in sheet.text
    start = {"theta_deg": 0.0, "x": 0.0, "y": 0.0, "opening": 1.0}
    answer = server.client.post(f"{job}/fixtures/2/closing", json=start)
    refused(answer, 400)
    assert "push the part against its locators by hand" in answer.text


@pytest.mark.thorough
def test_a_closing_comes_home_from_the_cage(
    server: RunningServer, place: str, result: Result, told: Seating
) -> None:
    """A way from where the part was put to where the fixture has it; the jaws only close."""
    opening = 0.5 * (told.capture_opening or 0.0)
    asked = {**put(result, 1.0, 0.4 * opening, 0.0), "opening": opening}
    answer = server.client.post(f"{place}/closing", json=asked).json()
    assert answer["ending"] == "right" and told.seats[answer["seat"]].is_own
    assert answer["words"].startswith("The part is in its place: S = ")
    pose, way = result[1].pose, answer["way"]
    assert way[-1] == pytest.approx([pose.theta_deg, pose.x, pose.y, 0.0], abs=1e-4)
    opened = [row[3] for row in way]
    assert opened[0] == pytest.approx(opening) and sorted(opened)[::-1] == opened
    assert len(way) > 30


def test_a_closing_ends_in_the_wrong_seat_that_it_is_put_over(
    server: RunningServer, place: str, result: Result, told: Seating
) -> None:
    """Also turned over; the sentence tells how the reading differs, in the unit asked for."""
    for mirrored in (False, True):
        index, seat = next(
            (k, one)
            for k, one in enumerate(told.seats)
            if one.is_wrong
            and one.mirrored == mirrored
            and (one.depth or 0.0) > max(-one.difference, 0.0) + 0.02
        )
        pose = {"theta_deg": seat.pose.theta_deg, "x": seat.pose.x, "y": seat.pose.y, "turned_over": mirrored}
        asked = {**pose, "opening": max(seat.difference, 0.0) + 0.01, "unit": "inch"}
        answer = server.client.post(f"{place}/closing", json=asked).json()
        assert (answer["ending"], answer["seat"]) == ("wrong", index)
        off = f"{abs(seat.difference) / 25.4:.4f} in {'more' if seat.difference > 0.0 else 'less'}"
        assert f"{off} than in the right place." in answer["words"]


def test_a_part_beside_the_pegs_is_told_to_slip_out(
    server: RunningServer, place: str, result: Result
) -> None:
    answer = server.client.post(
        f"{place}/closing", json={**put(result, 0.0, 0.0, 900.0), "opening": 3.0}
    ).json()
    assert (answer["ending"], answer["seat"]) == ("outside", None) and "slips out" in answer["words"]


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"opening": -1.0}, 400),
        ({"opening": 1e12}, 400),
        ({"theta_deg": "a lot"}, 400),
        ({"speed": 3}, 400),
        ({"x": None}, 400),
        ({"unit": "foot"}, 400),
    ],
)
def test_bad_starts_are_refused(
    server: RunningServer, place: str, result: Result, change: Any, status: int
) -> None:
    refused(
        server.client.post(f"{place}/closing", json={**put(result, 0, 0, 0), "opening": 1.0, **change}),
        status,
    )


def test_a_peg_in_the_part_is_told_by_its_hole(server: RunningServer, place: str, result: Result) -> None:
    sentence = refused(
        server.client.post(f"{place}/closing", json={**put(result, 0.0, -15.0, 0.0), "opening": 0.1})
    )
    assert "stands in the part there" in sentence and any(peg.hole in sentence for peg in result[1].pegs)


def test_what_there_is_not_is_404_or_409(server: RunningServer, place: str, result: Result) -> None:
    job = place.rpartition("/fixtures")[0]
    for rank in (len(result) + 1, 10**6):
        refused(server.client.get(f"{job}/fixtures/{rank}/seating"), 404)
    refused(server.client.get("/api/jobs/none/fixtures/1/seating"), 404)
    refused(server.client.get(f"{place}/seating", params={"revision": 999}), 409)


@pytest.mark.thorough
def test_what_cannot_be_told_is_refused_in_the_programs_words(server: RunningServer) -> None:
    points = server.done(request(workpiece=WEDGE, toolkit={**VISE, "peg_radius": 0}))
    assert "radius 0" in refused(server.client.get(f"{points}/fixtures/1/seating"))


def test_few_seatings_are_kept_of_a_job(server: RunningServer, place: str, told: Seating) -> None:
    """The newest; asking again does not work them out again."""
    job = server.state.jobs.by_name[place.split("/")[3]]
    assert server.client.get(f"{place}/seating").status_code == 200
    kept = job.seatings[(job.revision, 2)]
    assert (
        server.client.get(f"{place}/seating").status_code == 200 and job.seatings[(job.revision, 2)] is kept
    )
    for number in range(100):
        job.keep_seating((-1, number), told)
    assert len(job.seatings) < 100 and (-1, 99) in job.seatings and (-1, 0) not in job.seatings


@pytest.mark.thorough
def test_the_sheet_of_the_page_tells_it_when_asked(server: RunningServer, place: str) -> None:
    assert (
        "Does the part end up there?"
        in server.client.get(f"{place}/sheet.svg", params={"seating": True}).text
    )
    assert "Does the part end up there?" not in server.client.get(f"{place}/sheet.svg").text


@pytest.mark.thorough
def test_a_closing_that_nobody_waits_for_is_not_begun(
    server: RunningServer, place: str, result: Result
) -> None:
    """Who hangs up while the desk is busy leaves its queue, and the next one is answered."""
    assert server.client.get(f"{place}/seating").status_code == 200
    body = json.dumps({**put(result, 1.0, 1.0, 0.0), "opening": 3.0}).encode()
    head = f"POST {place}/closing HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
    lines = f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body
    desks = server.state.desks
    (desk,) = desks.workers.values()
    os.kill(desk.process.pid, signal.SIGSTOP)
    try:
        with socket.create_connection(server.address) as first:
            first.sendall(lines)
            server.wait_until(lambda: desks.busy == 1)
            with socket.create_connection(server.address) as second:
                second.sendall(lines)
                server.wait_until(lambda: len(desks.waiting) == 1)
            server.wait_until(lambda: not desks.waiting)
            # The first is still heard, and so it is not stopped.
            assert desks.busy == 1
            os.kill(desk.process.pid, signal.SIGCONT)
            assert b" 200 " in first.recv(200)
    finally:
        os.kill(desk.process.pid, signal.SIGCONT)
    assert server.client.post(f"{place}/closing", json=json.loads(body)).json()["ending"] == "right"


def test_a_closing_that_is_stopped_has_no_answer(result: Result, told: Seating) -> None:
    stopped = Event()
    held = result[1], result.workpiece, result.toolkit
    form = ClosingForm(**put(result, 1.0, 1.0, 0.0), opening=3.0)
    order = TaskContext(lambda _: None, stopped, 1.0)
    answer = simulate_closing(ClosingOrder(held, told, form), order)
    assert answer is not None and answer["ending"] == "right"
    stopped.set()
    assert simulate_closing(ClosingOrder(held, told, form), order) is None


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("vise", "widest"),
    [
        ({**VISE, "max_opening": 60}, lambda row: 60 - row["jaw_separation"]),
        (
            {"kind": "translating-clamp", "pitch": [20, 20], "peg_radius": 3, "travel": [5, 40]},
            lambda row: row["stroke"] - 5,
        ),
    ],
    ids=["vise", "clamp"],
)
def test_it_is_told_how_far_what_moves_can_be_opened(server: RunningServer, vise: Any, widest: Any) -> None:
    job = server.done(request(workpiece=WEDGE, toolkit=vise))
    row = server.client.get(f"{job}/fixtures/1").json()
    row["stroke"] = row["settings"][0]["length"]
    answer = server.client.get(f"{job}/fixtures/1/seating").json()
    assert answer["widest"] == pytest.approx(widest(row))
