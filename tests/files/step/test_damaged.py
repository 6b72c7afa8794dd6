"""Damaged STEP files: whatever is wrong with one, it is read or refused in one sentence, and the program goes on."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from damaged_step import damaged
from step_shapes import at_height, box, cut, cylinder, filleted, upright, write_step

from solid_examples import bridge
from workhold.errors import InputError
from workhold.files.part.load import read_workpiece


@pytest.fixture(scope="module")
def plate(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The file of a plate with round corners and two holes."""
    shape = cut(
        filleted(box(60, 40, 20), 5, upright), cylinder(6, 40, (20, 20, -5)), box(10, 10, 30, (35, 15, -1))
    )
    return write_step(tmp_path_factory.mktemp("step") / "plate.step", shape).read_bytes()


def outcome(folder: Path, content: bytes, seed: int, peg_height: float | None = None) -> str:
    """What becomes of a damaged file: "read", or the sentence by which it is refused."""
    path = folder / f"damaged-{seed}.step"
    path.write_bytes(damaged(content, seed))
    try:
        read_workpiece(path, peg_height=peg_height)
    except InputError as error:
        return str(error)
    return "read"


def check(folder: Path, content: bytes, seeds: range, peg_height: float | None = None) -> None:
    """Every damage is survived, and whatever is said is one sentence."""
    with ThreadPoolExecutor(2) as pool:
        said = list(pool.map(lambda seed: outcome(folder, content, seed, peg_height), seeds))
    for sentence in set(said) - {"read"}:
        assert sentence.startswith("damaged-") and sentence.endswith((".", ")")) and "\n" not in sentence
    # The damage is neither harmless nor so great that nothing of the reader is tried.
    assert 0 < said.count("read") < len(said)


def test_four_damaged_files_are_read_or_refused(tmp_path: Path, plate: bytes) -> None:
    """Seed 7 ends the library in a segmentation fault."""
    check(tmp_path, plate, range(4, 8))


@pytest.mark.prove
def test_two_thousand_damaged_files_are_read_or_refused(tmp_path: Path, plate: bytes) -> None:
    """Also those that keep the library busy until its time is over."""
    check(tmp_path, plate, range(2030))


@pytest.mark.prove
def test_two_hundred_damaged_files_are_read_or_refused_by_height(tmp_path: Path) -> None:
    """Of a part with fillets, steps and two feet, seen below its deck."""
    shape = filleted(bridge(), 2.0, at_height(22.0))
    content = write_step(tmp_path / "bridge.step", shape).read_bytes()
    check(tmp_path, content, range(200), peg_height=13.0)


def test_the_command_line_outlives_a_file_that_brings_the_library_down(tmp_path: Path, plate: bytes) -> None:
    """The damage is a single wrong reference; the command says one sentence and ends with 2."""
    path = tmp_path / "part.step"
    path.write_bytes(damaged(plate, 27))
    done = subprocess.run(
        [sys.executable, "-m", "workhold", "features", path], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)


def test_a_script_without_a_main_guard_reads_a_part(tmp_path: Path, plate: bytes) -> None:
    """The process that reads is not a copy of the script, so that nothing runs twice."""
    (tmp_path / "part.step").write_bytes(plate)
    script = tmp_path / "script.py"
    script.write_text("import workhold\nprint('once')\nprint(len(workhold.load('part.step').loops))\n")
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("once\n3\n", "")
