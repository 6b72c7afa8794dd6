"""Carriers with heights of their own over HTTP: the part is read with them, sent with them, and held as elsewhere."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from running_server import RunningServer, request
from step_shapes import box, filleted, fused, upright, write_step
from test_parts import refused

import workhold

CLAMP = [14.0, 24.0]
PLATE = {"kind": "translating-clamp", "pitch": [20, 20], "peg_radius": 3, "clamp_radius": 5}


@pytest.fixture(scope="module")
def block(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A base of 100 x 70 x 12 mm with a boss of 60 x 40 x 18 mm on it, which is all that the clamp reaches."""
    shape = fused(filleted(box(100, 70, 12), 8, upright), box(60, 40, 18, (20, 15, 12)))
    return write_step(tmp_path_factory.mktemp("blocks") / "block.step", shape)


def read(server: RunningServer, file: Path, heights: Any) -> Any:
    """What is answered to a file that is read with heights."""
    params = {"peg_height": 8, "heights": heights if isinstance(heights, str) else json.dumps(heights)}
    return server.client.post(
        "/api/parts", params=params, content=file.read_bytes(), headers={"X-Filename": file.name}
    )


@pytest.fixture(scope="module")
def part(server: RunningServer, block: Path) -> dict[str, Any]:
    """The part as the page sends it."""
    told = read(server, block, {"clamp": CLAMP}).json()
    return {name: told[name] for name in ("name", "loops", "solid", "outlines")}


@pytest.mark.thorough
def test_the_part_is_held_as_the_program_holds_it(
    server: RunningServer, block: Path, part: dict[str, Any]
) -> None:
    """The same fixtures; the clamp touches faces that are numbered after those of the outline of pegs."""
    toolkit = workhold.Plate(20, 3, clamp_radius=5, clamp_heights=CLAMP)
    alone = workhold.design(workhold.load(block, peg_height=8, heights=toolkit.heights), toolkit)
    assert list(part["outlines"]) == ["clamp"] and part["outlines"]["clamp"]["heights"] == CLAMP
    url = server.done(request(workpiece=part, toolkit={**PLATE, "clamp_heights": CLAMP}))
    rows = server.client.get(f"{url}/fixtures", params={"limit": 20}).json()
    assert rows["total"] > 0 and server.client.get(url).json()["found"] == sum(alone.found.values())
    assert [row["holes"] for row in rows["rows"]] == [
        [peg.hole for peg in fixture.pegs] for _, fixture in zip(rows["rows"], alone, strict=False)
    ]
    assert rows["rows"][0]["faces"][-1] >= len(alone.workpiece.segments)
    for paper in ("picture.svg", "assembly.glb", "sheet.pdf"):
        assert server.client.get(f"{url}/fixtures/1/{paper}").status_code == 200
    assert server.client.get(f"{url}/fixtures/1").status_code == 200


@pytest.mark.thorough
def test_a_part_that_is_checked_keeps_its_outlines(server: RunningServer, part: dict[str, Any]) -> None:
    """A link holds them, and gets them back."""
    told = server.client.post("/api/parts/check", json=part).json()
    assert told["outlines"] == part["outlines"]
    assert min(told["own_faces"]["clamp"]) == len(told["segments"])


@pytest.mark.thorough
def test_what_cannot_be_is_refused(server: RunningServer, block: Path, part: dict[str, Any]) -> None:
    """Heights that are none, or where nothing is; a part without its outlines, with others, or with too many."""
    for heights, words in (
        ({"clamp": [9, 4]}, "give the lower end first"),
        ({"clamp": [-9, -4]}, "upper one above 0"),
        ({"clamp": [40, 50]}, "there is nothing of the part"),
        ({"clamp": [1]}, "heights"),
        ("[1, 2]", "heights"),
        ("{", "not valid JSON"),
    ):
        assert words in refused(read(server, block, heights)), words
    asked = {**PLATE, "clamp_heights": CLAMP}

    def answer(workpiece: dict[str, Any]) -> str:
        return refused(server.client.post("/api/jobs", json=request(workpiece=workpiece, toolkit=asked)))

    assert "was read without these heights" in answer({**part, "outlines": {}})
    own = part["outlines"]["clamp"]
    assert "was read without these heights" in answer(
        {**part, "outlines": {"clamp": {**own, "heights": [1, 9]}}}
    )
    assert "bands" in answer({**part, "outlines": {"clamp": {**own, "bands": own["bands"][1:]}}})
    many = [[float(x), 0.0 if x % 2 else 1.0, 0.0] for x in range(3000)]
    assert "more than the 2000" in answer({**part, "outlines": {"clamp": {**own, "loops": [many]}}})
    assert "no solid" in answer({**part, "solid": None})
