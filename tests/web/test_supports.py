"""Supports over HTTP: what the program tells, places in the toolkit's frame, bodies, and who hangs up."""

from __future__ import annotations

import json
import os
import signal
import socket
from math import hypot
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from running_server import RunningServer, request
from test_parts import refused

import workhold
from glb_reading import ReadBody, read_glb
from workhold import Plate, Result, Workpiece
from workhold.model.support_request import SpatialLoad, SupportRequest
from workhold.model.support_triples import Supports
from workhold.supports.listing import find_supports

CORNERS = [[0, 0, 0], [100, 0, 0], [100, 60, 0], [10, 70, 0]]
BLOCK = {"name": "block", "loops": [CORNERS]}
PLATE = {"kind": "translating-clamp", "pitch": [20, 20], "peg_radius": 3}
LOAD = {"points": [[20, 15]], "force": 150.0, "heights": [8.0, 12.0], "axial": [-20.0, 60.0]}


@pytest.fixture(scope="module")
def result() -> Result:
    """What the program finds."""
    return workhold.design(Workpiece.from_loops("block", [CORNERS]), Plate(20, 3))


@pytest.fixture(scope="module")
def place(server: RunningServer) -> str:
    """The address of the second fixture."""
    return f"{server.done(request(workpiece=BLOCK, toolkit=PLATE))}/fixtures/2"


def found(result: Result, **more: Any) -> Supports:
    """The best three sets that the program finds under the second fixture."""
    asked = SupportRequest.from_workpiece(result.workpiece, 12.0, toolkit=result.toolkit)
    return find_supports(result[1], result.query, asked, [SpatialLoad(**LOAD)], best=3, **more)


def told(server: RunningServer, place: str, **form: Any) -> dict[str, Any]:
    """What the server answers."""
    answer = server.client.post(f"{place}/supports", json={"thickness": 12.0, **form})
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


@pytest.mark.thorough
def test_figures_are_the_programs(server: RunningServer, place: str, result: Result) -> None:
    """Forces, arm, standing and the clamp's point of each set, in its order."""
    made = found(result)
    answer = told(server, place, loads=[LOAD])
    assert len(answer["sets"]) == len(made.triples) == 3
    for one, triple in zip(answer["sets"], made.triples, strict=True):
        clamp = triple.clamp
        wanted = [clamp.clamp_needed, clamp.support_force, clamp.arm, triple.standing, *clamp.at]
        figures = [one["clamp_force"], one["support_force"], one["arm"], one["standing"], *one["at_part"]]
        assert figures == pytest.approx(wanted)
    assert answer["jaw_force"] == pytest.approx(made.jaw_force) and answer["positions"] == made.positions
    assert any("closing force" in note for note in answer["notes"])


def test_places_are_in_the_toolkits_frame(server: RunningServer, place: str, result: Result) -> None:
    """Pads stand in their holes, the clamp lies where the pose puts it, and the arm is its way to the border."""
    for one in told(server, place, loads=[LOAD])["sets"]:
        for name, (x, y) in zip(one["holes"], one["pads"], strict=True):
            if name[0].isalpha():
                column, row = ord(name[0]) - ord("A"), int(name[1:]) - 1
            else:
                column, row = (int(number) - 1 for number in name.strip("()").split(","))
            assert (x, y) == pytest.approx((20 * column, 20 * row))
        assert one["at"] == pytest.approx(result[1].pose.apply(*one["at_part"]))
        away = hypot(*(a - b for a, b in zip(one["at"], one["nearest"], strict=True)))
        assert away == pytest.approx(one["arm"])
        (px, py), *others = one["pads"]
        sides = zip([(px, py), *others], [*others, (px, py)], strict=True)
        (x, y) = one["nearest"]
        off = [abs((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) for a, b in sides]
        assert min(off) < 1e-6


def test_without_loads_the_arm_decides(server: RunningServer, place: str) -> None:
    """No force is told, and the clamp stands where its arm is longest; in inches the sentences are."""
    answer = told(server, place, loads=[])
    arms = [one["arm"] for one in answer["sets"]]
    assert arms == sorted(arms, reverse=True)
    assert {one["clamp_force"] for one in answer["sets"]} == {None}
    assert answer["jaw_force"] is None and not answer["with_loads"]


@pytest.mark.thorough
def test_keep_outs_and_a_point_are_kept(server: RunningServer, place: str) -> None:
    """No pad reaches into a zone below, the clamp into none above; a point asked for is that of the clamp."""
    whole = told(server, place, loads=[])
    (x, y), radius = whole["sets"][0]["at_part"], whole["tip_radius"]
    zone = [[x - 6, y, 1], [x + 6, y, 1]]
    for one in told(server, place, loads=[], top_zones=[zone])["sets"]:
        assert hypot(one["at_part"][0] - x, one["at_part"][1] - y) >= 6 + radius - 1e-6
    pads = told(server, place, loads=[], bottom_zones=[[[-5, -5, 0], [50, -5, 0], [50, 90, 0], [-5, 90, 0]]])
    assert pads["positions"] < whole["positions"]
    at = whole["sets"][0]["at_part"]
    assert told(server, place, loads=[], point=at)["sets"][0]["at_part"] == pytest.approx(at)


def test_what_shows_from_the_side(server: RunningServer, place: str, result: Result) -> None:
    """The boxes hold the part over its thickness, and a peg at its place."""
    answer = told(server, place, loads=[])
    [part] = [box for box in answer["boxes"][0] if box["kind"] == "part"]
    x0, y0, x1, y1 = result.workpiece.apply_pose(result[1].pose).bounds
    assert [*part["x"], *part["y"]] == pytest.approx([x0, x1, y0, y1])
    assert part["z"][1] - part["z"][0] == pytest.approx(12)
    pegs = {box["name"].rpartition(" ")[2]: box for box in answer["boxes"][0] if box["kind"] == "peg"}
    first = result[1].pegs[0]
    assert pegs[first.hole]["x"] == pytest.approx([first.x - 3, first.x + 3])
    assert answer["bands"] == [[0, 12]] * 4


def middle(body: ReadBody) -> NDArray[np.float64]:
    """The middle of a body's extent in the plane, in mm."""
    flat = body.positions[:, :2]
    return np.asarray((flat.min(axis=0) + flat.max(axis=0)) / 2)


@pytest.mark.thorough
def test_chosen_supports_are_bodies(server: RunningServer, place: str) -> None:
    """The file in three dimensions has the pads of the set that is asked for under the part, and the clamp on it."""
    form = {"thickness": 12.0, "loads": []}
    answer = told(server, place, **form)
    [drawn] = [box for box in answer["boxes"][0] if box["kind"] == "part"]
    for chosen in (1, 2):
        one = answer["sets"][chosen - 1]
        query = {"supports": json.dumps({**form, "chosen": chosen})}
        sent = server.client.get(f"{place}/assembly.glb", params=query)
        assert sent.status_code == 200, sent.text
        bodies = read_glb(sent.content)[1]
        for body in bodies:
            body.assert_closed()
        [part] = [body for body in bodies if body.kind == "part"]
        # Built in holes that have names, all of it may stand elsewhere on the plate.
        moved = middle(part) - [sum(drawn["x"]) / 2, sum(drawn["y"]) / 2]
        pads = [body for body in bodies if body.kind == "support"]
        holes = one["built"]["supports"] if one["built"] else one["holes"]
        assert [body.name for body in pads] == [f"support {hole}" for hole in holes]
        for body, at in zip(pads, one["pads"], strict=True):
            assert middle(body) - moved == pytest.approx(np.array(at), abs=0.05)
            assert body.heights == pytest.approx((-20, 0), abs=1e-4)
        [clamp] = [body for body in bodies if body.name == "clamp on top"]
        assert middle(clamp) - moved == pytest.approx(np.array(one["at"]), abs=0.05)
        assert (part.heights[0], clamp.heights[0]) == pytest.approx((0, 12), abs=1e-4)
        [plate] = [body for body in bodies if body.kind == "plate"]
        assert plate.heights == pytest.approx((-20, -10), abs=1e-4)
        pegs = [body for body in bodies if body.kind == "peg"]
        for body in pegs:
            assert body.heights == pytest.approx((-20, 12), abs=1e-4)
    bare = server.client.get(f"{place}/assembly.glb").content
    assert not [body for body in read_glb(bare)[1] if body.kind == "support"]
    for wrong in ('{"chosen": 50, "thickness": 12}', '{"best": "three"}', "{}", "["):
        refused(server.client.get(f"{place}/assembly.glb", params={"supports": wrong}))


@pytest.mark.parametrize(
    ("form", "words"),
    [
        ({"thickness": None}, "thick"),
        ({"thickness": 12, "pad_radius": 11}, "overlap"),
        ({"thickness": 12, "loads": [LOAD], "jaw_force": 1}, "jaw"),
        ({"thickness": 12, "tip_radius": -1}, "tip_radius"),
        ({"thickness": 12, "best": 1000}, "best"),
        ({"thickness": 12, "pads": 3}, "pads"),
        ({"thickness": 12, "loads": [{"axial": [5, 5]}]}, "point"),
    ],
)
def test_what_cannot_be_is_refused(
    server: RunningServer, place: str, form: dict[str, Any], words: str
) -> None:
    """In one sentence that names it."""
    assert words in refused(server.client.post(f"{place}/supports", json=form))


def test_none_is_said_where_there_is_none(server: RunningServer, place: str) -> None:
    """A tip as large as the part leaves no set, and a sentence says so."""
    answer = told(server, place, tip_radius=40.0, loads=[])
    assert answer["sets"] == [] and "No three supports" in answer["notes"][0]


@pytest.mark.thorough
def test_the_description_has_an_example(server: RunningServer, place: str) -> None:
    """The example of the description can be sent as it is."""
    description = server.client.get("/api/openapi.json").json()
    assert "/api/v1/jobs/{name}/fixtures/{rank}/supports" in description["paths"]
    (example,) = description["components"]["schemas"]["SupportsForm"]["examples"]
    assert server.client.post(f"{place}/supports", json=example).json()["sets"]


@pytest.mark.thorough
def test_who_hangs_up_is_not_worked_for(server: RunningServer, place: str) -> None:
    """A task whose client is gone is stopped, here with its deaf worker, and the next one is served."""
    text = json.dumps({"thickness": 12.0, "loads": [LOAD]})
    head = f"POST {place}/supports HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\n"
    desks = server.state.desks
    worker = desks.workers[0].process.pid
    os.kill(worker, signal.SIGSTOP)
    with socket.create_connection(server.address) as client:
        client.sendall(f"{head}Content-Length: {len(text)}\r\n\r\n{text}".encode())
        server.wait_until(lambda: desks.busy == 1)
    server.wait_until(lambda: desks.workers[0].process.pid != worker)
    assert told(server, place, loads=[])["sets"]


@pytest.mark.thorough
def test_the_sheet_carries_the_chosen_supports(server: RunningServer, place: str) -> None:
    """The holes in which the set is built and its clamp force; without the wish there are none."""
    form = {"thickness": 12.0, "loads": [LOAD]}
    one = told(server, place, **form)["sets"][1]
    holes = one["built"]["supports"] if one["built"] else one["holes"]
    query = {"supports": json.dumps({**form, "chosen": 2})}
    sheet = server.client.get(f"{place}/sheet.svg", params=query)
    assert sheet.status_code == 200, sheet.text
    for hole in holes:
        assert f">{hole}<" in sheet.text or f" {hole}" in sheet.text
    assert "upports" in sheet.text
    assert "upports" not in server.client.get(f"{place}/sheet.svg").text


def test_holes_without_a_name_are_told_as_built(server: RunningServer, place: str, result: Result) -> None:
    """Every set tells four pegs and three supports in holes that have names, as far apart as in the list."""
    for one in told(server, place, loads=[], best=50)["sets"]:
        if one["built"] is None:
            assert all(name[0].isalpha() for name in one["holes"])
            continue
        names = [*one["built"]["supports"], *one["built"]["pegs"][:3]]
        assert all(name[0].isalpha() and int(name[1:]) > 0 for name in names)
        places = [(20 * (ord(name[0]) - ord("A")), 20 * (int(name[1:]) - 1)) for name in names]
        was = [*one["pads"], *([peg.x, peg.y] for peg in result[1].pegs[:3])]
        moved = {(round(x - a), round(y - b)) for (x, y), (a, b) in zip(places, was, strict=True)}
        assert len(moved) == 1
