"""Searches over HTTP give what the program gives."""

from __future__ import annotations

import csv
import html
import json
import re
from math import cos, isclose, radians, sin
from typing import Any

import httpx
import pytest
from running_server import LONG, PATIENCE, SQUARE, VISE, WIDGET, RunningServer, request
from test_parts import refused

from workhold import Load, Result, Tolerance, Vise, design, load
from workhold.files.result.fixture_text import write_result_csv
from workhold.files.result.writer import write_result_text
from workhold.model.quality import FIGURES, PIN_KEYS
from workhold.statics.loads import compute_load_cases

LOAD = {"points": [[10, 5]], "force": 200, "directions": [-30, 30]}


@pytest.fixture(scope="module")
def result() -> Result:
    """What the program finds for the usual request."""
    return design(load("widget"), Vise(**VISE))


@pytest.fixture(scope="module")
def job(server: RunningServer) -> str:
    """The address of the usual job, done."""
    return server.done(request())


def rows(server: RunningServer, job: str, **query: Any) -> list[dict[str, Any]]:
    """A page of fixtures."""
    answer = server.client.get(f"{job}/fixtures", params={"limit": 1000, **query})
    assert answer.status_code == 200, answer.text
    return list(answer.json()["rows"])


def events(server: RunningServer, job: str) -> list[dict[str, Any]]:
    """All events of a job until it is over."""
    out = []
    with server.client.stream("GET", f"{job}/events") as stream:
        assert stream.headers["content-type"].startswith("text/event-stream")
        for line in stream.iter_lines():
            if line.startswith("data: "):
                out.append(json.loads(line.removeprefix("data: ")))
    return out


@pytest.mark.thorough
def test_a_job_finds_what_the_program_finds(server: RunningServer, job: str, result: Result) -> None:
    state = server.client.get(job).json()
    assert state["counts"] == result.counts and state["found"] == len(result)
    assert state["complete"] and state["fraction"] == 1.0 and state["error"] is None
    assert state["proof"]["verified"] == result.proof.verified  # type: ignore[union-attr]
    assert state["request"]["toolkit"]["pitch"] == [8, 8]
    listed = rows(server, job)
    assert [row["rank"] for row in listed] == list(range(1, len(result) + 1))
    for row, fixture in zip(listed, result, strict=True):
        assert row["holes"] == [peg.hole for peg in fixture.pegs]
        assert row["faces"] == [peg.face for peg in fixture.pegs]
        assert row["theta_deg"] == pytest.approx(fixture.pose.theta_deg, abs=1e-9)
        assert row["quality"] == pytest.approx(dict(fixture.quality))


@pytest.mark.thorough
def test_downloads_are_the_files_the_program_writes(server: RunningServer, job: str, result: Result) -> None:
    for ending, text_of in (("json", write_result_text), ("csv", write_result_csv)):
        answer = server.client.get(f"{job}/result.{ending}")
        assert answer.text == "".join(text_of(result))
        assert answer.headers["content-disposition"] == f'attachment; filename="widget.{ending}"'


@pytest.mark.thorough
def test_pages_join_to_the_whole_list(server: RunningServer, job: str) -> None:
    whole = rows(server, job)
    pages = [
        row for offset in range(0, len(whole) + 50, 50) for row in rows(server, job, offset=offset, limit=50)
    ]
    assert pages == whole


# Those of loads, of two clamps, of a jaw with ends and of known heights are of other searches.
ELSEWHERE = ("clamp_freedom", "jaw_contact")


@pytest.mark.thorough
def test_what_is_not_known_leaves_the_order_of_ranks(server: RunningServer, job: str) -> None:
    """Nobody says how high pegs press here, and there is one clamp."""
    for key in (*ELSEWHERE, *PIN_KEYS):
        assert [row["rank"] for row in rows(server, job, sort=key)] == [
            row["rank"] for row in rows(server, job)
        ]


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "key", [one.key for one in FIGURES if one.unit != "N" and one.key not in (*ELSEWHERE, *PIN_KEYS)]
)
@pytest.mark.parametrize("descending", [False, True])
def test_lists_are_sorted_by_any_figure(server: RunningServer, job: str, key: str, descending: bool) -> None:
    listed = rows(server, job, sort=key, descending=descending)
    values = [row["quality"][key] for row in listed]
    assert values == sorted(values, reverse=descending)
    assert sorted(row["rank"] for row in listed) == list(range(1, len(listed) + 1))


@pytest.mark.thorough
def test_filters_keep_exactly_what_they_say(server: RunningServer, job: str) -> None:
    whole = rows(server, job)
    assert rows(server, job, type="II") == [row for row in whole if row["type"] == "II"]
    assert rows(server, job, face=9) == [row for row in whole if 9 in row["faces"]]
    turned = rows(server, job, angle="-20..45")
    assert turned == [row for row in whole if row["theta_deg"] >= 340 or row["theta_deg"] <= 45] != []
    some = server.client.get(f"{job}/fixtures", params={"type": "I", "face": 9, "limit": 3}).json()
    assert len(some["rows"]) == 3 and some["total"] == sum(
        row["type"] == "I" and 9 in row["faces"] for row in whole
    )


@pytest.mark.parametrize(
    "query",
    [
        "limit=0",
        "limit=5000",
        "offset=-1",
        "sort=beauty",
        "type=III",
        "angle=10",
        "angle=5..1",
        "angle=a..b",
        "face=x",
    ],
)
def test_queries_that_mean_nothing_are_refused(server: RunningServer, job: str, query: str) -> None:
    refused(server.client.get(f"{job}/fixtures?{query}"))


def test_contacts_are_a_peg_radius_away_and_forces_balance(server: RunningServer, job: str) -> None:
    for rank in (1, 100, 505):
        fixture = server.client.get(f"{job}/fixtures/{rank}").json()
        total = [0.0, 0.0]
        for k in range(4):
            (nx, ny), (x, y), (cx, cy) = fixture["normals"][k], fixture["pegs"][k], fixture["contacts"][k]
            assert isclose(nx * nx + ny * ny, 1.0)
            assert (x - cx, y - cy) == pytest.approx((3 * nx, 3 * ny), abs=1e-9)
            total = [total[0] + fixture["forces"][k] * nx, total[1] + fixture["forces"][k] * ny]
        assert total == pytest.approx([0, 0], abs=1e-6)
        # The contact lies on the part: back in its coordinates it is on the face's line or circle.
        c, s = cos(radians(fixture["theta_deg"])), sin(radians(fixture["theta_deg"]))
        part = server.client.get("/api/parts/widget").json()
        for (cx, cy), face in zip(fixture["contacts"], fixture["faces"], strict=True):
            dx, dy = cx - fixture["x"], cy - fixture["y"]
            qx, qy = c * dx + s * dy, c * dy - s * dx
            segment = next(item for item in part["segments"] if item["number"] == face)
            if segment["radius"] is not None:
                off = (qx - segment["center"][0]) ** 2 + (qy - segment["center"][1]) ** 2
                assert off == pytest.approx(segment["radius"] ** 2, abs=1e-6)
            else:
                (ax, ay), (bx, by) = segment["start"], segment["end"]
                assert (bx - ax) * (qy - ay) - (by - ay) * (qx - ax) == pytest.approx(0, abs=1e-6)


def test_there_is_no_fixture_beyond_the_last(server: RunningServer, job: str) -> None:
    refused(server.client.get(f"{job}/fixtures/506"), 404)
    refused(server.client.get(f"{job}/fixtures/0"))
    refused(server.client.get(f"{job}/fixtures/506/sheet.pdf"), 404)
    refused(server.client.get(f"{job}/fixtures/1?revision=99"), 409)


def test_loads_are_answered_as_by_the_program(server: RunningServer, job: str, result: Result) -> None:
    body = {"loads": [LOAD], "jaw_force": 1000, "friction": 0.1}
    answer = server.client.post(f"{job}/fixtures/7/loads", json=body).json()
    load_asked = Load(points=[(10, 5)], force=200, directions=(-30, 30))
    (case,) = compute_load_cases(result[6], result.workpiece, result.toolkit, [load_asked], 1000, 0.1)
    (told,) = answer["cases"]
    assert told["smallest"] == pytest.approx(list(case.smallest)) and told["largest"] == pytest.approx(
        list(case.largest)
    )
    assert (
        told["needed"]["value"] == pytest.approx(case.needed.value)
        and told["needed"]["peg"] == case.needed.peg
    )
    assert told["needed_with_friction"] == pytest.approx(case.needed_with_friction)


@pytest.mark.thorough
def test_those_that_resist_best_are_first_of_a_search_ranked_by_the_reaction(
    server: RunningServer, job: str
) -> None:
    best = server.client.post(f"{job}/resist", json={"loads": [LOAD]}).json()["best"]
    ranked = server.done(request(loads=[LOAD], ranking=["load_reaction"]))
    expected = [row["quality"]["load_reaction"] for row in rows(server, ranked, limit=10)]
    assert [row["load_reaction"] for row in best] == pytest.approx(expected)


@pytest.mark.parametrize(
    "body",
    [
        {"loads": []},
        {"loads": [{"force": 5}]},
        {"loads": [{"force": -5, "points": [[0, 0]]}]},
        {"loads": [LOAD], "jaw_force": -1},
        {"loads": [LOAD], "friction": "much"},
        {"loads": [{**LOAD, "directions": [0, 900]}]},
    ],
)
def test_loads_that_are_none_are_refused(server: RunningServer, job: str, body: dict[str, Any]) -> None:
    refused(server.client.post(f"{job}/fixtures/1/loads", json=body))
    if "jaw_force" not in body:
        refused(server.client.post(f"{job}/resist", json=body))


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("kind", "start", "content_type"),
    [
        ("sheet.pdf?unit=inch&paper=letter&day=2026-03-31&jaw_force=500", b"%PDF", "application/pdf"),
        ("sheet.svg?date=2026-03-31", b"<svg", "image/svg+xml"),
        ("setup.dxf", b"  0\nSECTION", "image/vnd.dxf"),
        ("picture.svg", b"<svg", "image/svg+xml"),
    ],
)
def test_papers_are_made_and_the_same_each_time(
    server: RunningServer, job: str, kind: str, start: bytes, content_type: str
) -> None:
    answer = server.client.get(f"{job}/fixtures/2/{kind}")
    assert answer.status_code == 200, answer.text
    assert start in answer.content[:200] and answer.headers["content-type"].startswith(content_type)
    assert server.client.get(f"{job}/fixtures/2/{kind}").content == answer.content


@pytest.mark.thorough
def test_the_sheet_has_the_loads_jaw_and_sizes_of_its_address(server: RunningServer, job: str) -> None:
    """A force pushed on the page, the jaw force, what the jaw is, thickness, dowel: all stand on the sheet."""
    load = {
        "name": "pushed",
        "points": [[1.0, 2.0]],
        "force": 150.0,
        "directions": [30.0, 30.0],
        "moment": 0.0,
    }
    query = {
        "loads": json.dumps([load]),
        "jaw_force": 750,
        "jaw": "2.5",
        "unit": "inch",
        "thickness": 0.5,
        "dowel": "m6 in H7",
        "part_name": "door handle",
    }
    words = " ".join(
        re.findall(r">([^<>]+)</text>", server.client.get(f"{job}/fixtures/1/sheet.svg", params=query).text)
    )
    for wanted in (
        "pushed",
        "33.7 lbf (150 N) at x 0.0394, y 0.0787 in, towards 30°",
        "at 169 lbf",
        "2.5 times as stiff as a contact",
    ):
        assert wanted in words
    assert "0.5000 in" in words and "m6 in H7" in words and "door handle" in words
    pins = server.client.get(f"{job}/fixtures/1/pins.csv", params={**query, "peg_length": 1.25}).text
    rows = list(csv.DictReader(pins.splitlines()))
    shown = server.client.get(f"{job}/fixtures/1").json()
    assert [row["hole"] for row in rows] == shown["holes"]
    assert {(row["dowel"], row["length"], row["unit"]) for row in rows} == {("m6 in H7", "1.25", "in")}
    forces = {}
    for jaw in ("screw", "constant"):
        params = {"loads": json.dumps([load]), "jaw_force": 750, "jaw": jaw}
        sheet = server.client.get(f"{job}/fixtures/1/sheet.svg", params=params).text
        forces[jaw] = " ".join(re.findall(r">([^<>]+)</text>", sheet))
    assert (
        "a jaw that keeps its force" in forces["constant"]
        and "a jaw that keeps its force" not in forces["screw"]
    )


@pytest.mark.thorough
def test_warnings_are_the_sentences_of_the_sheet(server: RunningServer, job: str) -> None:
    """Every fixture's sheet has them and no others; a load too large for the jaw force adds one."""
    load = json.dumps([{**LOAD, "force": 5000.0}])
    for rank in (1, 4, 9):
        told = server.client.get(f"{job}/fixtures/{rank}/warnings").json()["warnings"]
        more = server.client.get(
            f"{job}/fixtures/{rank}/warnings", params={"loads": load, "jaw_force": 1}
        ).json()["warnings"]
        assert {one["kind"] for one in more} == {one["kind"] for one in told} | {"load"}
        sheet = server.client.get(f"{job}/fixtures/{rank}/sheet.svg").text
        words = " ".join(re.findall(r">([^<>]+)</text>", sheet))
        assert sheet.count("▲") == len(told)
        assert all(html.escape(one["sentence"], quote=False) in words for one in told)


@pytest.mark.parametrize(
    "query",
    ["loads=x", "loads=[{}]", 'loads=[{"force": 5}]', "jaw=soft", "jaw=-1", "jaw_force=0", "unit=foot"],
)
def test_warnings_of_what_cannot_be_are_refused(server: RunningServer, job: str, query: str) -> None:
    refused(server.client.get(f"{job}/fixtures/1/warnings?{query}"))
    refused(server.client.get(f"{job}/fixtures/1/sheet.svg?{query}"))


@pytest.mark.parametrize(
    "query", ["sheet.pdf?paper=a3", "sheet.pdf?unit=foot", "sheet.pdf?day=today", "sheet.exe"]
)
def test_papers_that_there_are_not_are_refused(server: RunningServer, job: str, query: str) -> None:
    refused(server.client.get(f"{job}/fixtures/1/{query}"))


def test_events_end_with_the_job_and_tell_its_state(server: RunningServer) -> None:
    url = server.submit(request(contact_margin=0.5))
    told = events(server, url)
    assert told[-1]["state"] == "done"
    final = server.client.get(url).json()
    final.pop("request")
    assert told[-1] == final
    assert [event["revision"] for event in told] == sorted(event["revision"] for event in told)


@pytest.mark.thorough
def test_restrictions_ranking_and_tolerance_are_heeded(server: RunningServer) -> None:
    zone = [[-60, -60, 0], [0, -60, 0], [0, -10, 0], [-60, -10, 0]]
    asked = request(
        restrictions={"avoid": [9], "zones": [zone], "angles": [[0, 180]]},
        ranking=["wrench_radius"],
        tolerance={"peg": 0.02, "face": 0},
        types=["I"],
    )
    url = server.done(asked)
    listed = rows(server, url)
    assert listed
    values = [row["quality"]["wrench_radius"] for row in listed]
    assert values == sorted(values, reverse=True)
    for row in listed:
        assert row["type"] == "I" and 9 not in row["faces"] and row["theta_deg"] <= 180 + 1e-6
    assert server.state.jobs.by_name[url.rpartition("/")[2]].asked.query.tolerance == Tolerance(0.02, 0.0)


@pytest.mark.parametrize(
    "change",
    [
        {"toolkit": {**VISE, "pitch": [8]}},
        {"toolkit": {**VISE, "pitch": [8, -8]}},
        {"toolkit": {**VISE, "columns": 0}},
        {"toolkit": {**VISE, "columns": 1.5}},
        {"toolkit": {**VISE, "peg_radius": 5}},
        {"toolkit": {**VISE, "blocked": ["hole 3"]}},
        {"toolkit": {**VISE, "colour": "red"}},
        {"toolkit": None},
        {"workpiece": {"name": "x", "loops": []}},
        {"types": ["III"]},
        {"types": []},
        {"contact_margin": -1},
        {"restrictions": {"avoid": [999]}},
        {"restrictions": {"avoid": list(range(16))}},
        {"restrictions": {"zones": [[[0, 0, 0], [1, 1, 0]]]}},
        {"restrictions": {"angles": [[10, 0]]}},
        {"ranking": ["beauty"]},
        {"ranking": ["load_reaction"]},
        {"loads": [{"force": 1}]},
        {"tolerance": {"peg": -1, "face": 0}},
        {"unknown": 1},
    ],
)
def test_searches_that_cannot_be_are_refused_before_they_begin(
    server: RunningServer, change: dict[str, Any]
) -> None:
    before = len(server.state.jobs.by_name)
    refused(server.client.post("/api/jobs", json=request(**change)))
    assert len(server.state.jobs.by_name) == before


@pytest.mark.thorough
def test_no_fixture_is_explained(server: RunningServer, job: str) -> None:
    url = server.done(
        {
            "workpiece": {"name": "s", "loops": [SQUARE]},
            "toolkit": {"pitch": [50, 50], "columns": 1, "peg_radius": 3},
        }
    )
    state = server.client.get(url).json()
    assert state["found"] == 0 and state["notes"]
    explanation = server.client.get(f"{url}/explanation").json()
    assert set(explanation) >= {"contacts", "removals", "nearest", "helps"}
    assert explanation == server.client.get(f"{url}/explanation").json()
    refused(server.client.get(f"{job}/explanation"), 409)


@pytest.mark.thorough
def test_all_kinds_are_compared_and_others_refused(server: RunningServer) -> None:
    """A plate and a fence have fields of their own; those of a vise they do not take, whatever name is given."""
    plate = {"kind": "translating-clamp", "pitch": [20, 20], "peg_radius": 3, "title": "plate"}
    fence = {**plate, "kind": "edge", "wall_offset": 10, "title": "fence"}
    asked = {"workpiece": WIDGET, "toolkits": [{**VISE, "title": "vise"}, plate, fence]}
    table = server.client.get(server.done(asked, "/api/explore")).json()["table"]
    assert [(row["title"], sum(row["counts"].values()) > 0) for row in table] == [
        ("vise", True),
        ("plate", True),
        ("fence", True),
    ]
    assert [row["toolkit"]["kind"] for row in table] == ["vise", "translating-clamp", "edge"]
    for kind in ("plate", "edge"):
        other = {**VISE, "kind": kind}
        refused(server.client.post("/api/jobs", json=request(toolkit=other)))
        refused(server.client.post("/api/explore", json={"workpiece": WIDGET, "toolkits": [other]}))


@pytest.mark.thorough
def test_toolkits_are_compared(server: RunningServer) -> None:
    toolkits = [
        {**VISE, "title": "one"},
        {**VISE, "pitch": [12, 12], "title": "two"},
        {**VISE, "pitch": [500, 500]},
    ]
    url = server.done({"workpiece": WIDGET, "toolkits": toolkits}, "/api/explore")
    state = server.client.get(url).json()
    assert [row["title"] for row in state["table"]] == ["one", "two", ""]
    assert state["table"][0]["counts"] == {"I": 459, "II": 46}
    listed = rows(server, server.done(request()))
    assert state["table"][0]["figures"] == listed[0]["quality"] and state["table"][0]["fit"]
    assert state["table"][2]["counts"] == {"I": 0, "II": 0} and state["table"][2]["note"]
    refused(server.client.get(f"{url}/result.json"), 409)
    refused(server.client.get(f"{url}/fixtures/1"), 409)


@pytest.mark.thorough
def test_fixtures_show_while_the_search_runs_and_stay_when_it_is_cancelled(server: RunningServer) -> None:
    url = server.submit(LONG)
    running = server.state_when(url, lambda state: state["revision"] > 0)
    assert running["state"] == "running" and not running["complete"] and running["counts"] is None
    assert rows(server, url, limit=5)
    assert server.client.get(f"{url}/fixtures/1").status_code == 200
    assert server.client.get(f"{url}/fixtures/1/picture.svg").status_code == 200
    refused(server.client.get(f"{url}/result.json"), 409)
    refused(server.client.get(f"{url}/fixtures/1/sheet.pdf"), 409)
    assert server.client.post(f"{url}/cancel").status_code == 202
    stopped = server.outcome(url)
    assert stopped["state"] == "cancelled" and not stopped["complete"]
    assert rows(server, url, limit=5)


@pytest.mark.thorough
def test_a_deleted_job_is_gone_and_its_worker_free(server: RunningServer) -> None:
    url = server.submit(LONG)
    server.state_when(url, lambda state: state["state"] == "running")
    waiting = server.submit(request())
    assert server.client.get(waiting).json()["state"] == "queued"
    assert server.client.delete(url).status_code == 204
    assert server.client.delete(url).status_code == 204
    for path in (
        "",
        "/events",
        "/fixtures",
        "/fixtures/1",
        "/result.json",
        "/explanation",
        "/fixtures/1/sheet.pdf",
    ):
        refused(server.client.get(url + path), 404)
    assert server.outcome(waiting)["state"] == "done"


@pytest.mark.thorough
def test_one_that_waits_can_be_deleted(server: RunningServer) -> None:
    first, second = server.submit(LONG), server.submit(LONG)
    server.client.delete(second)
    server.client.delete(first)
    assert not server.state.searchers.waiting
    assert server.outcome(server.submit(request()))["state"] == "done"


@pytest.mark.thorough
def test_names_of_jobs_are_long_and_never_the_same(server: RunningServer) -> None:
    names = {server.submit(request()).rpartition("/")[2] for _ in range(5)}
    assert len(names) == 5 and all(len(name) >= 22 for name in names)
    for path in ("/api/jobs", "/api/jobs/"):
        refused(server.client.get(path), 405 if path == "/api/jobs" else 404)


def test_a_stream_of_events_that_is_left_does_not_stay(server: RunningServer) -> None:
    url = server.submit(LONG)
    with (
        httpx.Client(base_url=server.client.base_url, timeout=PATIENCE) as other,
        other.stream("GET", f"{url}/events") as stream,
    ):
        lines = stream.iter_lines()
        next(lines)
        # Those of earlier tests may only just have ended.
        server.wait_until(lambda: server.state.streams == 1)
    server.wait_until(lambda: server.state.streams == 0)
    server.client.delete(url)
