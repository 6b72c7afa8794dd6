"""Parts, toolkits and figures over HTTP."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from running_server import SQUARE, WIDGET, RunningServer

from workhold.files.part.load import list_builtin_parts, read_workpiece
from workhold.files.toolkit_file import list_preset_names, load_toolkit
from workhold.fixels.kinds import make_toolkit
from workhold.model.jaw_hold import HOLD_FIGURES
from workhold.model.quality import FIGURES

BRACKET = Path(__file__).parents[2] / "examples" / "bracket.dxf"


def refused(answer: Any, status: int = 400) -> str:
    """The sentence of a refusal, which must be one."""
    assert answer.status_code == status, answer.text
    body = answer.json()
    assert set(body) == {"error", "place"}
    assert body["error"].endswith(".") and "\n" not in body["error"] and "Traceback" not in body["error"]
    return str(body["error"])


def upload(server: RunningServer, content: bytes, name: str, **query: str) -> Any:
    """The answer to a file."""
    return server.client.post("/api/parts", content=content, headers={"X-Filename": name}, params=query)


def test_about_tells_the_limits_in_force(server: RunningServer) -> None:
    about = server.client.get("/api/about").json()
    limits = server.state.limits
    assert about["limits"]["upload_bytes"] == limits.upload_bytes
    assert about["limits"]["fixtures"] == limits.fixtures
    assert isinstance(about["step"], bool)


@pytest.mark.thorough
def test_every_builtin_part_is_listed_and_read(server: RunningServer) -> None:
    listed = server.client.get("/api/parts").json()
    assert [part["name"] for part in listed] == [part.name for part in list_builtin_parts()]
    for part in listed:
        answer = server.client.get(f"/api/parts/{part['name']}").json()
        workpiece = read_workpiece(part["name"]).workpiece
        assert answer["loops"] == [loop.tolist() for loop in workpiece.loops]
        assert answer["bounds"] == list(workpiece.bounds)
        assert [face["number"] for face in answer["faces"]] == [face.number for face in workpiece.faces]


@pytest.mark.thorough
@pytest.mark.parametrize(
    "name", ["nothing", "..%2F..%2Fetc%2Fpasswd", "%2Fetc%2Fpasswd", "widget.json", "con%00"]
)
def test_only_builtin_names_are_parts(server: RunningServer, name: str) -> None:
    refused(server.client.get(f"/api/parts/{name}"), 404)


def test_segments_join_and_belong_to_faces(server: RunningServer) -> None:
    part = server.client.get("/api/parts/widget").json()
    for loop in range(len(part["loops"])):
        run = [segment for segment in part["segments"] if segment["loop"] == loop]
        for one, other in zip(run, run[1:] + run[:1], strict=True):
            assert one["end"] == pytest.approx(other["start"], abs=1e-9)
    faces = {face["number"]: face for face in part["faces"]}
    for segment in part["segments"]:
        face = faces[segment["face"]]
        assert (face["kind"] == "arc") == (segment["radius"] is not None)


def test_a_drawing_becomes_the_part_the_program_reads(server: RunningServer) -> None:
    answer = upload(server, BRACKET.read_bytes(), "my%20br%C3%A4cket.dxf").json()
    workpiece = read_workpiece(BRACKET).workpiece
    assert answer["loops"] == [loop.tolist() for loop in workpiece.loops]
    assert answer["name"] == "my bräcket"
    # The answer can be sent back as it is.
    again = server.client.post("/api/parts/check", json={"name": answer["name"], "loops": answer["loops"]})
    assert again.json()["segments"] == answer["segments"]


@pytest.mark.thorough
def test_units_and_parts_of_a_drawing_can_be_chosen(server: RunningServer) -> None:
    svg = b'<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0H20V10H0Z"/><path d="M50 0H60V5H50Z"/></svg>'
    wide = upload(server, svg, "two.svg", unit="inch").json()
    assert wide["bounds"][2] - wide["bounds"][0] == pytest.approx(20 * 25.4)
    small = upload(server, svg, "two.svg", unit="mm", part_number="2").json()
    assert small["bounds"][2] - small["bounds"][0] == pytest.approx(10)
    assert any("2 separate parts" in remark for remark in small["remarks"])
    refused(upload(server, svg, "two.svg", unit="mm", part_number="3"))
    refused(upload(server, svg, "two.svg", unit="furlong"))
    refused(upload(server, svg, "two.svg", unit="mm", part_number="0"))


@pytest.mark.parametrize(
    "name", ["../../../etc/passwd", "..%2f..%2fx.json", "C%3A%5Cx.json", "", "%00.json", "a" * 500]
)
def test_a_files_name_is_never_a_path(server: RunningServer, name: str) -> None:
    content = json.dumps({"units": "mm", "loops": [SQUARE]}).encode()
    answer = upload(server, content, name)
    assert answer.status_code == 200, answer.text
    assert "/" not in answer.json()["name"] and "\\" not in answer.json()["name"]


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("content", "name"),
    [
        (b"", "empty.dxf"),
        (b"PK\x03\x04" + bytes(200), "zipped.dxf"),
        (b"\x1f\x8b" + bytes(200), "zipped.svg"),
        (b"hello", "note.txt"),
        (b"{" * 100_000, "deep.json"),
        (b"<svg xmlns='http://www.w3.org/2000/svg'/>", "none.svg"),
        (b"ISO-10303-21;garbage", "part.step"),
        (b"\xff\xfe\x00" * 50, "part.json"),
        (
            json.dumps({"units": "mm", "loops": [[[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]]]}).encode(),
            "bow.json",
        ),
    ],
)
def test_what_is_no_part_is_refused_in_a_sentence(server: RunningServer, content: bytes, name: str) -> None:
    sentence = refused(upload(server, content, name))
    assert "/tmp" not in sentence and "part.json:" not in sentence


def test_entities_of_xml_do_not_grow(server: RunningServer) -> None:
    levels = "".join(f'<!ENTITY a{k + 1} "{f"&a{k};" * 10}">' for k in range(12))
    bomb = f'<!DOCTYPE svg [<!ENTITY a0 "ha">{levels}]><svg xmlns="http://www.w3.org/2000/svg"><text>&a12;</text></svg>'
    refused(upload(server, bomb.encode(), "bomb.svg", unit="mm"))


def test_an_outline_that_crosses_itself_is_refused_with_the_place(server: RunningServer) -> None:
    bow = [[0, 0, 0], [20, 20, 0], [20, 0, 0], [0, 20, 0]]
    answer = server.client.post("/api/parts/check", json={"name": "bow", "loops": [bow]})
    refused(answer)
    assert answer.json()["place"] == {"x": 10.0, "y": 10.0}


@pytest.mark.parametrize(
    "change",
    [
        {"loops": []},
        {"loops": [[]]},
        {"loops": [[[0, 0]]]},
        {"loops": [[[0, 0, "0"]]]},
        {"loops": [[[1e300, 0, 0], [0, 1e300, 0], [0, 0, 0]]]},
        {"loops": "round"},
        {"name": 5},
        {"more": 1},
    ],
)
def test_wrong_shapes_are_refused(server: RunningServer, change: dict[str, Any]) -> None:
    refused(server.client.post("/api/parts/check", json={**WIDGET, **change}))


@pytest.mark.parametrize("body", [b"", b"{", b"[1e999]", b"null", b"\xff"])
def test_what_is_no_json_is_refused(server: RunningServer, body: bytes) -> None:
    headers = {"content-type": "application/json"}
    refused(server.client.post("/api/parts/check", content=body, headers=headers))


def test_presets_are_told_and_can_be_asked_for(server: RunningServer) -> None:
    presets = server.client.get("/api/presets").json()
    assert [vise["name"] for vise in presets] == list(list_preset_names())
    for vise in presets:
        assert make_toolkit(vise["kind"], vise["fields"]) == load_toolkit(vise["name"]).toolkit


def test_figures_are_all_told(server: RunningServer) -> None:
    figures = server.client.get("/api/figures").json()
    assert [figure["key"] for figure in figures] == [figure.key for figure in (*FIGURES, *HOLD_FIGURES)]


def test_there_is_nothing_elsewhere(server: RunningServer) -> None:
    for path in (
        "/static/../limits.py",
        "/static/%2e%2e/limits.py",
        "/static/",
        "/api/none",
        "/docs",
        "/etc/passwd",
    ):
        refused(server.client.get(path), 404)
    refused(server.client.put("/api/parts"), 405)


def survey(server: RunningServer, content: bytes, name: str, **query: Any) -> dict[str, Any]:
    """What a file leaves open."""
    answer = server.client.post(
        "/api/parts/survey", content=content, headers={"X-Filename": name}, params=query
    )
    assert answer.status_code == 200, answer.text
    told: dict[str, Any] = answer.json()
    return told


@pytest.mark.thorough
def test_a_survey_has_the_part_or_what_is_asked(server: RunningServer) -> None:
    """The same part as reading gives, or the sentence and its question, with all that is drawn."""
    told = survey(server, BRACKET.read_bytes(), "bracket.dxf")
    assert told["part"] == upload(server, BRACKET.read_bytes(), "bracket.dxf").json()
    assert (told["error"], told["asked"]) == (None, [])
    svg = b'<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0H20V10H0Z"/><path d="M50 0H60V5H50Z"/></svg>'
    told = survey(server, svg, "two.svg")
    assert told["part"] is None and told["asked"] == ["unit"] and told["size"] == [60, 10]
    assert told["error"] == refused(upload(server, svg, "two.svg"))
    assert [len(stroke) for stroke in told["strokes"]] == [5, 5]
    told = survey(server, svg, "two.svg", unit="mm", part_number=2)
    assert told["part"]["name"] == "two" and told["part"]["bounds"][2] == 60
    assert [(part["number"], part["holes"]) for part in told["parts"]] == [(1, 0), (2, 0)]


@pytest.mark.thorough
def test_a_survey_tells_what_a_drawing_is_in_pixels(server: RunningServer) -> None:
    """Only where there are pixels, and its unit is asked; the answers are units as any other."""
    svg = b'<svg xmlns="http://www.w3.org/2000/svg" width="60px" viewBox="0 0 30 9"><path d="M1 1H21V8H1Z"/></svg>'
    told = survey(server, svg, "plate.svg")
    assert (told["size"], told["pixels"]) == ([20, 7], [40, 14])
    assert '"File drawn in" px72, px90 or px96' in told["error"]
    for count in (72, 90, 96):
        told = survey(server, svg, "plate.svg", unit=f"px{count}")
        x0, _, x1, _ = told["part"]["bounds"]
        assert x1 - x0 == pytest.approx(40 * 25.4 / count)
        assert told["pixels"] is None
    assert survey(server, BRACKET.read_bytes(), "bracket.dxf")["pixels"] is None


@pytest.mark.thorough
def test_gaps_are_joined_and_layers_chosen_as_asked(server: RunningServer) -> None:
    """Over HTTP, as in a file that leaves them open."""
    lines = ["M0 0H20", "M20.3 0V10", "M20 10H0V0"]
    svg = "".join(f'<path fill="none" stroke="#000" d="{line}"/>' for line in lines)
    content = f'<svg xmlns="http://www.w3.org/2000/svg">{svg}</svg>'.encode()
    told = survey(server, content, "open.svg", unit="mm")
    assert told["part"] is None and told["asked"] == ["join_tolerance"] and told["gaps"] == [0.3]
    assert survey(server, content, "open.svg", unit="mm", join_tolerance=0.31)["part"]["faces"]
    assert upload(server, content, "open.svg", unit="mm", join_tolerance="0.31").status_code == 200
    layers = {"layers": ["OUTLINE", "nothing"]}
    assert "nothing" in str(survey(server, BRACKET.read_bytes(), "bracket.dxf", **layers)["error"])


@pytest.mark.parametrize("name", ["empty.dxf", "part.json", "note.txt"])
def test_a_survey_of_no_part_is_a_sentence(server: RunningServer, name: str) -> None:
    """Without the path of the file, whatever it is."""
    answer = server.client.post("/api/parts/survey", content=b"{hello", headers={"X-Filename": name})
    told = answer.json()
    assert told["error"].endswith(".") and "/tmp" not in told["error"] and "part." not in told["error"]
    assert answer.status_code == 400 or told["part"] is None


def test_a_survey_may_be_as_large_as_a_file(server: RunningServer) -> None:
    """The limit of files counts, not that of other requests."""
    limits = server.state.limits
    content = b"{" + b" " * (limits.request_bytes + 1000)
    assert survey(server, content, "large.json")["part"] is None
