"""The command ``supports``, from a result file to a table and a file that ``verify`` accepts."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import Result as Outcome

import workhold
from workhold import Plate, Workpiece
from workhold.model.solid import SolidOutline
from workhold.supports.asking import find_fixture_supports

Run = Callable[..., Outcome]
KITE = Workpiece.from_loops("kite", [[[0, 0, 0], [70, -8, 0.1], [88, 40, 0], [22, 66, 0]]])


@pytest.fixture(scope="module")
def result_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The result of a part on a plate."""
    path = tmp_path_factory.mktemp("supports") / "kite.json"
    workhold.save(workhold.design(KITE, Plate(pitch=15, peg_radius=3), best=3), path)
    return path


@pytest.mark.thorough
def test_best_sets_and_a_file_that_verify_accepts(result_file: Path, tmp_path: Path, run: Run) -> None:
    """The table has the first sets of all; the file has all, and every one is proven."""
    out = tmp_path / "supports.json"
    words = (
        "supports",
        result_file,
        "1",
        "--thickness",
        "20",
        "--load",
        "at=40,25 axial=300",
        "--triples",
        "2",
    )
    shown = run(*words, "--out", out)
    assert shown.exit_code == 0, shown.stderr
    written = json.loads(out.read_text())
    assert written["complete"] and f"the best 2 of {len(written['triples'])} sets" in shown.stdout
    verified = run("verify", out)
    assert verified.exit_code == 0 and f"{len(written['triples'])} proven, 0 refuted" in verified.stdout
    plain = json.loads(run(*words, "--json").stdout)
    assert [one["best"]["clamp_needed"] for one in plain["triples"]] == [
        one["best"]["clamp_needed"] for one in written["triples"][:2]
    ]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ((), "the thickness of the part is not known: give --thickness."),
        (("--thickness", "0"), "--thickness"),
        (("--thickness", "12", "--band", "3"), "give 2 lengths with ':' between them"),
        (("--thickness", "12", "--band", "3:20"), "cannot press at heights 3 to 20"),
        (("--thickness", "12", "--pad-radius", "9"), "pads of radius 9 would overlap"),
        (("--thickness", "12", "--load", "z=3 force=x at=1,1"), "force"),
        (("--thickness", "12", "--load", "at=1,1 axial=a..b"), "give a number, or a range LOW..HIGH"),
        (("--thickness", "12", "--load", "at=1,1 axial=5 jump=3"), "unknown key 'jump'"),
        (("--thickness", "12", "--reach", "1,2,3"), "give 4 lengths"),
        (("--thickness", "12", "--glb", "a.step"), "let the name end in .glb"),
        (("--thickness", "12", "--support-height", "5"), "give --glb or --step too"),
    ],
)
def test_refusals(result_file: Path, run: Run, words: tuple[str, ...], sentence: str) -> None:
    """What cannot be is one sentence, and exit code 2."""
    shown = run("supports", result_file, "1", *words)
    assert shown.exit_code == 2 and sentence in shown.stderr
    assert "force=1" not in shown.stderr and shown.stderr.count("\n") == 1


def test_words_of_a_load(result_file: Path, tmp_path: Path, run: Run) -> None:
    """Heights, axial force and tilt stand beside the words of a load in the plane."""
    out = tmp_path / "supports.json"
    typed = "force=80 at=1,2 z=3..4 axial=-5..6 tilt=7,-8 moment=9 direction=0..90"
    words = ("--load", typed, "--load", "at=1,2 axial=300")
    assert run("supports", result_file, 1, "--thickness", 12, *words, "--out", out).exit_code == 0
    load, drill = json.loads(out.read_text())["loads"]
    assert (load["force"], load["heights"], load["axial"], load["tilt"]) == (80, [3, 4], [-5, 6], [7, -8])
    assert (load["moment"], load["directions"], load["points"]) == (9, [0, 90], [[1, 2]])
    assert (drill["force"], drill["heights"], drill["axial"]) == (0, [12, 12], [300, 300])


def test_part_that_no_three_supports_hold_up(tmp_path: Path, run: Run) -> None:
    """Where no set fits, the command says why, and what would help."""
    kite = Workpiece.from_loops("kite", [[[0, 0, 0], [34, -4, 0.1], [44, 20, 0], [11, 33, 0]]])
    path = tmp_path / "kite.json"
    workhold.save(workhold.design(kite, Plate(pitch=20, peg_radius=3), best=1), path)
    shown = run("supports", path, "1", "--thickness", "10")
    assert shown.exit_code == 0 and "No three supports hold the part" in shown.stdout
    assert "room for a pad of radius 2.000 mm, and fewer than three" in " ".join(shown.stdout.split())
    # Where a file of bodies is asked for, there is nothing to write, and the sentence is the error.
    asked = run("supports", path, "1", "--thickness", "10", "--glb", tmp_path / "kite.glb")
    assert asked.exit_code == 2 and not (tmp_path / "kite.glb").exists()
    assert "error: no three supports hold the part" in asked.stderr
    assert "room for a pad of radius 2.000 mm, and fewer than three" in " ".join(asked.stderr.split())


def test_search_with_supports(run: Run, tmp_path: Path) -> None:
    """A search tells of its best fixtures which three supports hold the part up best, as the command does."""
    part = tmp_path / "kite.json"
    loops = [loop.tolist() for loop in KITE.loops]
    part.write_text(json.dumps({"name": "kite", "units": "mm", "loops": loops}))
    words = ("design", part, "--toolkit", "plate", "--pitch", "15", "--peg-radius", "3", "--best", "4")
    shown = run(*words, "--supports", "--thickness", "20", "--out", tmp_path / "r.json")
    assert shown.exit_code == 0, shown.stderr
    rows = [line.split() for line in shown.stdout.split("rank   supports")[-1].splitlines()]
    first = next(row for row in rows if row and row[0] == "1")
    alone = run("supports", tmp_path / "r.json", "1", "--thickness", "20")
    again = next(line.split() for line in alone.stdout.splitlines() if line.strip().startswith("1 "))
    assert first == again


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--supports",), "the thickness of the part is not known: give --thickness."),
        (("--supports", "--thickness", "4", "--json"), "--supports prints a table: leave --json out"),
        (("--not-on-faces-cut-in", "RESULT"), "needs the faces of the same solid in both set-ups"),
    ],
)
def test_search_with_supports_refuses(
    run: Run, result_file: Path, words: tuple[str, ...], sentence: str
) -> None:
    """What a search cannot do about supports and other set-ups is one sentence."""
    given = [result_file if word == "RESULT" else word for word in words]
    shown = run(
        "design", "widget", "--pitch", "10", "--columns", "2", "--peg-radius", "3", "--best", "1", *given
    )
    assert shown.exit_code == 2 and sentence in shown.stderr


def test_files_in_three_dimensions(result_file: Path, tmp_path: Path, run: Run) -> None:
    """The best set stands in a GLB file with its supports and the clamp on top."""
    path = tmp_path / "kite.glb"
    shown = run("supports", result_file, "1", "--thickness", "20", "--glb", path, "--support-height", "9")
    assert shown.exit_code == 0, shown.stderr
    names = next(line.split()[1:4] for line in shown.stdout.splitlines() if line.strip().startswith("1 "))
    content = path.read_bytes()
    assert all(f"support {name}".encode() in content for name in names) and b"clamp on top" in content


@pytest.mark.thorough
def test_show_and_sheet_write_the_best_supports_of_the_usual_sizes(
    result_file: Path, tmp_path: Path, run: Run
) -> None:
    """GLB and STEP of ``show --supports``, and the .step of ``sheet --supports``, have the same bodies."""
    pytest.importorskip("OCP", reason="the extra 'step' is not installed")
    glb, step, sheet = (tmp_path / name for name in ("a.glb", "a.step", "b.step"))
    words = ("--supports", "--thickness", "20")
    shown = run("show", result_file, "1", "--glb", glb, "--step", step, *words)
    assert shown.exit_code == 0, shown.stderr
    assert f"Drawn in {glb}." in shown.stdout and f"Drawn in {step}." in shown.stdout
    assert run("sheet", result_file, "1", "--out", sheet, *words).exit_code == 0
    assert step.read_bytes() == sheet.read_bytes()
    assert glb.read_bytes().count(b"support ") == 2 * 3 and b"clamp on top" in step.read_bytes()
    run("show", result_file, "1", "--step", step, "--thickness", "20", "--force")
    assert b"clamp on top" not in step.read_bytes()
    refused = run("show", result_file, "1", "--step", tmp_path / "c.step", "--supports")
    assert refused.exit_code == 2 and "give --thickness" in refused.stderr
    refused = run("show", result_file, "1", "--part", "a.step")
    assert refused.exit_code == 2 and "--part belongs to a file in three dimensions" in refused.stderr
    refused = run("show", result_file, "1", "--glb", tmp_path / "d.glb", "--part", step)
    assert refused.exit_code == 2 and "was not read from a solid" in " ".join(refused.stderr.split())
    refused = run("show", result_file, "1", "--supports")
    assert refused.exit_code == 2 and "--supports belongs to a file in three dimensions" in refused.stderr


def test_supports_of_a_result_in_python() -> None:
    """A result answers for its best fixtures what each fixture answers by itself."""
    result = workhold.design(KITE, Plate(pitch=15, peg_radius=3), best=4)
    every = result.supports(20, best=3, each=2, tip_radius=4)
    assert [one.triples for one in every] == [
        fixture.supports(20, best=2, tip_radius=4).triples for fixture in result[:3]
    ]
    assert every[0].request.inside == 4.0 and every[0].request.pad_radius == 4.0
    with pytest.raises(workhold.InputError, match="supports have no 'pads': give some of pad_radius"):
        find_fixture_supports(result[0], 20, pads=3)
    with pytest.raises(workhold.InputError, match="the thickness of the part is not known"):
        result.supports()


@pytest.mark.thorough
def test_friction_is_a_line_of_its_own_and_ranks_nothing(result_file: Path, run: Run) -> None:
    """The table stays as it is; without loads, and for what is not a coefficient, a sentence says so."""
    words = ("supports", result_file, "1", "--thickness", "20", "--load", "at=40,25 force=200 axial=-30..60")
    plain, more = run(*words), run(*words, "--friction", "0.2")
    assert more.exit_code == 0 and more.stdout.startswith(plain.stdout.rstrip())
    line = more.stdout[len(plain.stdout.rstrip()) :]
    assert (
        "With a friction of 0.2 at every contact the clamp of these sets, in their order, could hold" in line
    )
    told = json.loads(run(*words, "--friction", "0.2", "--json").stdout)
    assert told["friction"] == 0.2 and len(told["needed_with_friction"]) == len(told["triples"]) == 3
    for force, one in zip(told["needed_with_friction"], told["triples"], strict=True):
        assert 0 <= force < one["best"]["clamp_needed"]
        assert f"{force:.0f} N" in line
    assert "friction" not in json.loads(run(*words, "--json").stdout)
    for wrong, sentence in (("0", "--friction '0' is not a positive number"), ("1e6", "give a coefficient")):
        refused = run(*words, "--friction", wrong)
        assert refused.exit_code == 2 and sentence in refused.stderr
    bare = run(*words[:5], "--friction", "0.2")
    assert bare.exit_code == 2 and "--friction needs loads: give --load too" in bare.stderr


@pytest.mark.thorough
def test_forces_are_pounds_with_inches(result_file: Path, run: Run) -> None:
    """In the columns alone, in sentences with newtons beside them; the numbers are the same forces."""
    words = ("supports", result_file, "1", "--thickness", "20mm", "--friction", "0.2")
    load = {"mm": "at=40,25", "inch": f"at={40 / 25.4},{25 / 25.4}"}
    newtons, pounds = (
        run(*words, "--load", f"{at} force=200 axial=-30..60", "--unit", unit).stdout
        for unit, at in load.items()
    )
    assert "clamp force N   support force N" in newtons and "clamp force lbf   support force lbf" in pounds
    (first, *_), (other, *_) = (
        [row.split(")")[1].split() for row in shown.splitlines() if row.lstrip().startswith("1 ")]
        for shown in (newtons, pounds)
    )
    for own, size in zip(first[:2], other[:2], strict=True):
        assert float(own) == pytest.approx(float(size) * 4.4482, abs=3)
    assert (
        "All figures are for a closing force of" in pounds
        and "lbf (" in pounds.split("All figures are for a closing force of")[1]
    )
    assert not re.search(r"\bN\b(?!\))", pounds)


@pytest.mark.thorough
def test_no_pad_stands_under_a_solid_that_lies_on_no_face(tmp_path: Path, run: Run) -> None:
    """Nor where other places are kept out too; smaller sizes have their own distance inside the triangle."""
    loop = [(0.0, 0.0, 0.0), (90.0, 2.0, 0.0), (88.0, 21.0, 0.0), (1.0, 20.0, 0.0)]
    path = tmp_path / "slim.json"
    for bottom in ([], [loop]):
        solid = SolidOutline("z", 9.0, 9.0, 0.5, 1.0, [(0.0, 9.0)] * 4, bottom=bottom, top=[loop])
        part = Workpiece.from_loops("slim", [loop], solid=solid)
        workhold.save(workhold.design(part, Plate(pitch=20, peg_radius=3), best=30), path)
        shown = [run("supports", path, n, "--keep-out-below", "circle=0,0,1") for n in range(1, 31)]
        held = [one for one in shown if "clamp at mm" in one.stdout]
        assert bool(held) is bool(bottom)
        smaller = (
            "the usual sizes find no place, so the pads have a radius of 3.000 mm and the tip one of 4.000 mm"
        )
        assert not bottom or any(smaller in one.stderr for one in held)
