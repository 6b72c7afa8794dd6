"""Carriers with heights of their own in a batch: the same fixtures as for one part, and records that keep outlines."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from step_shapes import box, filleted, fused, upright, write_step
from typer.testing import CliRunner

import workhold
from own_heights import BASE, ROOF, STEM, stepped
from workhold import Plate, design, load
from workhold.batch.store import make_part_record, parse_record, read_workpiece_record
from workhold.cli.main import app
from workhold.files.part.load import read_workpiece

CLAMP, LOW = (14.0, 24.0), (3.0, 9.0)
TOML = 'kind = "translating-clamp"\nunit = "mm"\npitch = 20\npeg_radius = 3\nclamp_radius = 5\nclamp_heights = [{}, {}]\n'


@pytest.fixture(scope="module")
def block(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A base of 100 x 70 x 12 mm with a boss of 60 x 40 x 18 mm on it, which is all that the clamp reaches."""
    shape = fused(filleted(box(100, 70, 12), 8, upright), box(60, 40, 18, (20, 15, 12)))
    return write_step(tmp_path_factory.mktemp("blocks") / "block.step", shape)


def toolkit_file(folder: Path, name: str, heights: tuple[float, float]) -> Path:
    """A plate whose clamp touches between two heights."""
    path = folder / f"{name}.toml"
    path.write_text(TOML.format(*heights))
    return path


def test_a_batch_finds_what_one_search_finds(block: Path, tmp_path: Path) -> None:
    """As many fixtures, and the best of them with the same holes; the file has the clamp's outline."""
    toolkit = Plate(20, 3, clamp_radius=5, clamp_heights=CLAMP)
    alone = design(load(block, peg_height=8, heights=toolkit.heights), toolkit)
    words = ["batch", block, "--toolkit", toolkit_file(tmp_path, "high", CLAMP), "--peg-height", 8]
    words += ["--out", tmp_path / "out", "--workers", 1, "--best", 3]
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exit_code == 0, done.stderr
    assert done.stdout.startswith("1 job: 1 held.")
    (found,) = (p for p in (tmp_path / "out").rglob("*.json") if '"workhold-result' in p.read_text()[:60])
    assert list(json.loads(found.read_text())["outlines"]) == ["clamp"]
    result = workhold.open(found)
    assert result.found == alone.found and len(alone) > len(result) == 3
    for one, other in zip(result, alone, strict=False):
        assert [(peg.hole, peg.face) for peg in one.pegs] == [(peg.hole, peg.face) for peg in other.pegs]
    assert result[0].pegs[-1].face >= len(result.workpiece.segments)


def test_a_part_is_told_of_as_the_toolkit_meets_it(block: Path, tmp_path: Path) -> None:
    """With pegs no higher than they must be, which is not how it is read where nothing holds it."""
    words = ["features", block, "--toolkit", toolkit_file(tmp_path, "high", CLAMP), "--json"]
    told = json.loads(CliRunner().invoke(app, [str(word) for word in words]).stdout)["solid"]
    met = read_workpiece(str(block), heights={"clamp": CLAMP}, peg_diameter=6).workpiece.solid
    alone = read_workpiece(str(block)).workpiece.solid
    assert met is not None and alone is not None
    assert told["peg_height"] == met.peg_height != alone.peg_height


def test_toolkits_of_two_heights_are_refused(block: Path, tmp_path: Path) -> None:
    """A part is read once for all of them; the sentence names the carrier."""
    both = f"{toolkit_file(tmp_path, 'high', CLAMP)},{toolkit_file(tmp_path, 'low', LOW)}"
    done = CliRunner().invoke(app, ["batch", str(block), "--toolkit", both, "--out", str(tmp_path / "out")])
    assert done.exit_code == 2 and "two heights of the clamp" in done.stderr


def test_records_keep_outlines() -> None:
    """A record that is read again is of the same part: outlines, heights, bands."""
    for own in (
        {},
        {"clamp": ((12.0, 20.0), STEM)},
        {"clamp": ((12.0, 20.0), STEM), "wall": ((0.0, 40.0), ROOF)},
    ):
        part = stepped(own, BASE, clamp=[1])
        again = read_workpiece_record(parse_record(make_part_record(part, ["a remark"])))
        assert [role for role, _ in again.outlines] == list(own)
        for (_, one), (_, other) in zip(again.outlines, part.outlines, strict=True):
            assert all((a == b).all() for a, b in zip(one.loops, other.loops, strict=True))
            assert one.solid is not None and other.solid is not None
            assert (one.solid.low, one.solid.peg_height) == (other.solid.low, other.solid.peg_height)
            assert one.solid.bands == other.solid.bands
