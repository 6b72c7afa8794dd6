"""The shape of a job's part over HTTP: bodies show the file's solid, other files and jobs are refused."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from running_server import VISE, RunningServer, request
from step_shapes import box, cut, cylinder, filleted, fused, upright, write_step
from test_parts import refused

from glb_reading import ReadBody, read_glb

# That of the clamp plate that comes with the program.
PLATE = {"kind": "translating-clamp", "pitch": [20, 20], "peg_radius": 3, "clamp_radius": 5}


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A base of 100 x 70 x 12 mm with a boss of 60 x 40 x 18 mm, bored from above to a height of 16 mm."""
    base = filleted(box(100, 70, 12), 8, upright)
    shape = cut(fused(base, box(60, 40, 18, (20, 15, 12))), cylinder(9, 40, (50, 35, 16)))
    return write_step(tmp_path_factory.mktemp("shapes") / "bossed.step", shape)


@pytest.fixture(scope="module")
def job(server: RunningServer, file: Path) -> str:
    """The address of a search for its fixtures, pegs being 8 mm high."""
    return server.done(request(workpiece=uploaded(server, file, "z"), toolkit=PLATE))


def uploaded(server: RunningServer, file: Path, axis: str) -> dict[str, Any]:
    """The part of a file as the page sends it."""
    answer = sent(server, file, "/api/parts", axis=axis, peg_height=8)
    assert answer.status_code == 200, answer.text
    told = answer.json()
    return {"name": told["name"], "loops": told["loops"], "solid": told["solid"]}


def sent(server: RunningServer, file: Path, path: str, **options: Any) -> Any:
    """What is answered to a file."""
    headers = {"X-Filename": file.name}
    return server.client.post(path, params=options, content=file.read_bytes(), headers=headers)


def bodies(server: RunningServer, job: str) -> list[ReadBody]:
    """The bodies of the best fixture."""
    answer = server.client.get(f"{job}/fixtures/1/assembly.glb")
    assert answer.status_code == 200, answer.text
    return read_glb(answer.content)[1]


def volume(body: ReadBody) -> float:
    """Volume in mm³ of a closed mesh, by the divergence theorem."""
    corners = body.positions[body.triangles]
    return float(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()) / 6


@pytest.mark.thorough
def test_the_part_is_a_prism_until_its_file_is_sent(server: RunningServer, job: str, file: Path) -> None:
    """Then it has the volume of the file's solid; all other bodies are as before, and so are both files."""
    before = bodies(server, job)
    before_step = server.client.get(f"{job}/fixtures/1/setup.step").content
    answer = sent(server, file, "/api/parts/shape", job=job.rpartition("/")[2])
    assert answer.status_code == 200, answer.text
    after = bodies(server, job)
    assert answer.json() == {"triangles": len(after[0].triangles)}
    area = 100 * 70 - (4 - np.pi) * 64
    assert volume(before[0]) == pytest.approx(area * 30, rel=1e-3)
    assert volume(after[0]) == pytest.approx(area * 12 + 60 * 40 * 18 - np.pi * 81 * 14, rel=1e-3)
    assert [(one.name, one.kind) for one in after] == [(one.name, one.kind) for one in before]
    assert all((a.positions == b.positions).all() for a, b in zip(after[1:], before[1:], strict=True))
    assert after[0].positions[:, 2].max() == pytest.approx(30)
    assert server.client.get(f"{job}/fixtures/1/setup.step").content != before_step


@pytest.mark.thorough
def test_the_second_side_has_a_shape_of_its_own(server: RunningServer, file: Path) -> None:
    """The same file turned over: the boss reaches down to the plate."""
    url = server.done(request(workpiece=uploaded(server, file, "-z"), toolkit=PLATE))
    answer = sent(server, file, "/api/parts/shape", job=url.rpartition("/")[2])
    assert answer.status_code == 200, answer.text
    foot = bodies(server, url)[0].positions
    low = foot[foot[:, 2] < 1e-3]
    apart = np.hypot(*(low[:, None, :2] - low[None, :, :2]).transpose(2, 0, 1))
    assert apart.max() == pytest.approx(np.hypot(60, 40), rel=1e-5)


def test_it_counts_as_kept(server: RunningServer, job: str, file: Path) -> None:
    """Its bytes are among those by which jobs are forgotten."""
    held = server.state.jobs.by_name[job.rpartition("/")[2]]
    sent(server, file, "/api/parts/shape", job=held.name)
    with_shape, held.shape = held.size, None
    assert with_shape - held.size > 10_000


@pytest.mark.thorough
def test_what_has_no_such_shape_is_refused(
    server: RunningServer, job: str, file: Path, tmp_path: Path
) -> None:
    """Another part, no STEP file, a drawing's search, a comparison, and a search that there is not."""
    name = job.rpartition("/")[2]
    other = write_step(tmp_path / "other.step", box(90, 60, 33))
    assert "other.step: no solid of the STEP file" in refused(
        sent(server, other, "/api/parts/shape", job=name), 400
    )
    broken = tmp_path / "broken.step"
    broken.write_bytes(b"solid")
    assert "broken.step: this is not a STEP file" in refused(
        sent(server, broken, "/api/parts/shape", job=name), 400
    )
    drawn = server.done(request(toolkit=VISE)).rpartition("/")[2]
    assert "was not read from a solid" in refused(sent(server, file, "/api/parts/shape", job=drawn), 400)
    assert "no such search" in refused(sent(server, file, "/api/parts/shape", job="none"), 404)
    compared = server.done({"workpiece": request()["workpiece"], "toolkits": [VISE]}, "/api/explore")
    assert "Only a search" in refused(
        sent(server, file, "/api/parts/shape", job=compared.rpartition("/")[2]), 409
    )


def test_a_part_is_named_after_the_file_that_was_sent_and_its_solid(
    server: RunningServer, tmp_path: Path
) -> None:
    """The server keeps the file under another name, which is never shown."""
    path = write_step(tmp_path / "machine part.step", fused(box(60, 40, 10), box(20, 20, 5, (0, 0, 20))))
    names = iter(("base", "lug"))
    named = re.sub(
        r"MANIFOLD_SOLID_BREP\(''", lambda _: f"MANIFOLD_SOLID_BREP('{next(names)}'", path.read_text()
    )
    path.write_text(named)
    for part, called in (("lug", "lug of machine part"), ("1", "base of machine part")):
        answer = sent(server, path, "/api/parts", part_number=part)
        assert answer.status_code == 200, answer.text
        assert answer.json()["name"] == called
    alone = write_step(tmp_path / "alone.step", box(60, 40, 10))
    assert sent(server, alone, "/api/parts").json()["name"] == "alone"
