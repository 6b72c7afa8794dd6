"""``workhold show``, ``features`` and ``parts``, and the help."""

from __future__ import annotations

import subprocess
import sys
from inspect import cleandoc
from pathlib import Path
from typing import Any

import pytest

from fakes import fake_result
from glb_reading import fixture_glb
from workhold import __version__, save
from workhold import open as open_result
from workhold.cli.main import COMMANDS, import_command
from workhold.model.bodies import BodySizes


@pytest.fixture
def result_file(tmp_path: Path) -> Path:
    """A result file of six fixtures."""
    save(fake_result(6), tmp_path / "r.json")
    return tmp_path / "r.json"


def test_show_tells_all_that_has_to_be_set(run: Any, result_file: Path) -> None:
    outcome = run("show", result_file, 2)
    assert outcome.exit_code == 0
    fixture = fake_result(6)[1]
    assert f"Fixture 2 of 6, type {fixture.type}" in outcome.stdout
    assert f"Opening S {fixture.travel:.3f} mm" in outcome.stdout
    assert f"turned by {fixture.pose.theta_deg:.3f} degrees" in outcome.stdout
    for peg in fixture.pegs:
        row = next(line for line in outcome.stdout.splitlines() if line.split()[:1] == [peg.hole])
        assert row.split() == [
            *(peg.hole, peg.carrier, f"{peg.x:.3f}", f"{peg.y:.3f}", str(peg.face), f"{peg.force:.3f}")
        ]


@pytest.mark.parametrize(("name", "start"), [("a.svg", b"<"), ("a.PNG", b"\x89PNG")])
def test_show_draws(run: Any, result_file: Path, tmp_path: Path, name: str, start: bytes) -> None:
    outcome = run("show", result_file, 1, "--draw", tmp_path / name)
    assert outcome.exit_code == 0, outcome.stderr
    assert (tmp_path / name).read_bytes().startswith(start)


@pytest.mark.thorough
def test_show_writes_bodies(run: Any, result_file: Path, tmp_path: Path) -> None:
    """The fixture's own file, over one that workhold wrote; the height that nobody said is told."""
    result = open_result(result_file)
    held = result[1], result.workpiece, result.toolkit
    for thickness, given in ((10.0, ()), (25.4, ("--thickness", "1", "--unit", "inch"))):
        outcome = run("show", result_file, 2, "--glb", tmp_path / "a.glb", *given)
        assert outcome.exit_code == 0, outcome.stderr
        assert f"Drawn in {tmp_path / 'a.glb'}." in outcome.stdout
        assert ("10.000 mm high, because no thickness is given" in " ".join(outcome.stderr.split())) == (
            not given
        )
        sizes = BodySizes.from_workpiece(result.workpiece, thickness)
        assert (tmp_path / "a.glb").read_bytes() == fixture_glb(*held, sizes)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("r.json", "1", "--glb", "a.gltf"), "let the name end in .glb"),
        (("r.json", "1", "--thickness", "5"), "give --glb or --step too"),
        (("r.json", "0"), "there is no fixture 0: fixtures are counted from 1"),
        (("r.json", "7"), "lists 6 fixtures: there is no fixture 7"),
        (("r.json", "best"), "fixture 'best' is not a whole number"),
        (("none.json", "1"), "none.json cannot be read: No such file"),
        ((".", "1"), "is not a file: give a result file"),
        (("r.json", "1", "--draw", "a.pdf"), "let the name end in .svg or .png"),
        (("r.json", "1", "--draw", "missing/a.svg"), "there is no folder missing"),
        (
            ("r.json", "1", "--jaw", "loose"),
            "jaw 'loose' is not known: give screw, constant, or how many times as stiff",
        ),
        (("r.json",), "Missing argument 'N'"),
    ],
)
def test_show_refuses(
    run: Any, result_file: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], message: str
) -> None:
    monkeypatch.chdir(result_file.parent)
    outcome = run("show", *arguments)
    assert outcome.exit_code == 2
    assert message in outcome.stderr
    assert outcome.stderr.count("\n") == 1


def test_features_lists_every_face(run: Any, tmp_path: Path) -> None:
    part = tmp_path / "plate.json"
    part.write_text(
        '{"name": "plate", "units": "mm", "loops": [[[0,0,0],[60,0,0.1],[60,40,0],[0,40,-0.2]],'
        " [[20,20,-1],[30,20,-1]]]}"
    )
    outcome = run("features", part, "--draw", tmp_path / "f.svg", "--peg-radius", 3)
    assert outcome.exit_code == 0, outcome.stderr
    assert "5 faces" in outcome.stdout
    words = [line.split() for line in outcome.stdout.splitlines()]
    assert ["0", "line", "length", "60.000", "outer", "(0.000,", "0.000)", "(60.000,", "0.000)"] in words
    assert any(row[:3] == ["1", "arc,", "convex"] for row in words)
    assert any(row[:3] == ["3", "arc,", "concave"] for row in words)
    circle = next(row for row in words if row[:1] == ["4"])
    assert "full circle hole 1 about (25.000, 20.000)" in " ".join(circle)
    assert (tmp_path / "f.svg").exists()


def test_parts_lists_the_built_in_parts(run: Any) -> None:
    outcome = run("parts")
    assert outcome.exit_code == 0
    names = [line.split()[0] for line in outcome.stdout.splitlines()[2:]]
    assert names == [
        "8Handle",
        "flange",
        "large4Handle",
        "oblongPart",
        "small4Handle",
        "thin4Handle",
        "widget",
    ]


def test_version_and_help(run: Any) -> None:
    assert run("--version").stdout == f"workhold {__version__}\n"
    outcome = run("--help")
    assert outcome.exit_code == 0
    for word in ("design", "show", "features", "parts", "Examples", "millimetres"):
        assert word in outcome.stdout
    for command in ("design", "show", "features", "parts"):
        outcome = run(command, "--help")
        assert outcome.exit_code == 0
        assert "Example: workhold" in outcome.stdout


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_of_all_begins_like_that_of_each(run: Any, name: str) -> None:
    """What stands for a command that is not imported is what the command says of itself."""
    function = import_command(name)
    assert " ".join(cleandoc(function.__doc__).split("\n\n")[0].split()) == COMMANDS[name]
    assert COMMANDS[name].split()[:3] == run(name, "--help").stdout.split("\n\n")[1].split()[:3]


def test_the_help_imports_no_command() -> None:
    words = "import sys; from workhold.cli.main import app; app(['--help'], standalone_mode=False); "
    words += "sys.exit(any(name.endswith(('_command', '_commands')) for name in sys.modules))"
    assert subprocess.run([sys.executable, "-c", words], capture_output=True, check=False).returncode == 0


@pytest.mark.thorough
def test_a_search_loads_nothing_that_it_does_not_need() -> None:
    """Neither ball arithmetic, which searches on fences need, nor what works out seating."""
    words = "import sys; from workhold import Query, Vise, answer, load; "
    words += "answer(Query(load('widget'), Vise(pitch=20, columns=1, peg_radius=3), best=1)); "
    words += "sys.exit(any(name in sys.modules for name in ('flint', 'workhold.seating.solver')))"
    assert subprocess.run([sys.executable, "-c", words], capture_output=True, check=False).returncode == 0


def test_no_command_and_an_unknown_one(run: Any) -> None:
    outcome = run()
    assert outcome.exit_code == 2
    assert "Examples" in outcome.output
    outcome = run("desing")
    assert outcome.exit_code == 2
    assert (
        outcome.stderr
        == "workhold: error: No such command 'desing'. Did you mean 'design'?; see workhold --help.\n"
    )


def test_a_result_goes_from_one_form_to_the_other_and_back(run: Any, tmp_path: Path) -> None:
    """The same bytes come back; every command opens either form by its content."""
    save(fake_result(5), tmp_path / "a.json")
    for source, target in (("a.json", "b"), ("b", "c.json"), ("b", "c.csv"), ("c.json", "d.npz")):
        form = () if "." in target else ("--format", "npz")
        outcome = run("convert", tmp_path / source, tmp_path / target, *form)
        assert outcome.exit_code == 0 and "5 fixtures written to" in outcome.stdout
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "c.json").read_bytes()
    assert (
        (tmp_path / "b").read_bytes()
        == (tmp_path / "d.npz").read_bytes()
        != (tmp_path / "a.json").read_bytes()
    )
    assert run("convert", tmp_path / "b", "-").stdout == (tmp_path / "a.json").read_text()
    shown = [run("show", tmp_path / name, 4).stdout for name in ("a.json", "b")]
    assert shown[0] == shown[1] and "Fixture 4 of 5" in shown[0]
    refused = run("convert", tmp_path / "a.json", "-", "--format", "npz")
    assert refused.exit_code == 2 and "--format npz needs a file" in refused.stderr
