"""Bending in result files: written, read, converted, shown, put in order, and refused where it contradicts itself."""

from __future__ import annotations

import csv
import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from attrs import evolve
from typer.testing import CliRunner

import workhold
from bent_bodies import need_elements
from workhold import Load
from workhold.bending import meshing
from workhold.cli.main import app
from workhold.errors import InputError
from workhold.model.elastic_material import ElasticMaterial, find_material
from workhold.model.part_bending import BENDING_COLUMNS, BendingFigures, BentPlace, LargestStress
from workhold.model.result import Result
from workhold.presenting import bent
from workhold.verification import verify, verify_file
from workhold.verification.bending import checking

PART = [(0, 0), (80, 0), (80, 30), (50, 60), (0, 60)]


def make_figures(size: float, give: float | None = 0.004, **other: Any) -> BendingFigures:
    """Figures of a part that is bent by ``size`` mm."""
    known: dict[str, Any] = {
        "material": find_material("mild-steel"),
        "thickness": 8.0,
        "jaw_force": 2500.0,
        "is_assumed": False,
        "stiffness": np.inf,
        "faces": (),
        "below": None,
        "clamp_distortion": BentPlace(size, size / 10, (1.0, 2.5, 8.0)),
        "give": None if give is None else BentPlace(give, give / 20, (60.0, 20.0, 8.0), load=1),
        "stress": LargestStress(150.0, 70.0, (3.0, 0.0, 4.0)),
        "elements": 987,
    }
    return BendingFigures(**known | other)


def design(**asked: Any) -> Result:
    part = workhold.Workpiece.from_points("plate", PART)
    vise = workhold.Vise(pitch=10, columns=3, peg_radius=3)
    return workhold.design(part, vise, best=6, loads=[Load(points=[(60, 20)], force=150)], **asked)


@pytest.fixture(scope="module")
def plain() -> Result:
    return design()


@pytest.fixture
def partly(plain: Result) -> Result:
    """The second and the fourth fixture are bent."""
    faces: tuple[int | str, ...] = ("top", 2)
    other = make_figures(0.01, stiffness=0.5, faces=faces, is_assumed=True, jaw_force=1000.0)
    return plain.add_bending({1: make_figures(0.02), 3: other})


@pytest.mark.parametrize("form", ["json", "npz"])
def test_what_is_saved_is_read(partly: Result, form: str, tmp_path: Path) -> None:
    path = tmp_path / f"bent.{form}"
    workhold.save(partly, path)
    read = workhold.open(path)
    assert read.bending == partly.bending and list(read.bending) == [1, 3]
    assert read[0].bent is None and read[1].bent == partly[1].bent
    assert read[1].bent is not None and read[1].bent.yields is True and partly.bending[3].yields is None
    assert "2 with how far they bend the part" in repr(read)


def test_a_file_without_bending_says_nothing_of_it(plain: Result, partly: Result, tmp_path: Path) -> None:
    workhold.save(plain, tmp_path / "plain.json")
    workhold.save(partly, tmp_path / "bent.json")
    before, after = ((tmp_path / f"{name}.json").read_text().splitlines() for name in ("plain", "bent"))
    differ = [k for k, (one, other) in enumerate(zip(before, after, strict=True)) if one != other]
    assert len(differ) == 2 and all('"bending": ' in after[k] for k in differ)
    assert not any("bending" in line or "bent_by" in line for line in before)


def test_forms_go_into_each_other(partly: Result, tmp_path: Path) -> None:
    names = [tmp_path / name for name in ("one.json", "two.npz", "three.json")]
    workhold.save(partly.add_bending({}, "clamp_distortion"), names[0])
    for source, target in pairwise(names):
        workhold.save(workhold.open(source), target)
    assert names[0].read_bytes() == names[2].read_bytes()
    assert workhold.open(names[1]).bent_by == "clamp_distortion"


def test_a_table_has_columns_of_bending(partly: Result, plain: Result, tmp_path: Path) -> None:
    workhold.save(partly, tmp_path / "bent.csv")
    rows = list(csv.DictReader((tmp_path / "bent.csv").open()))
    assert [row["clamp_distortion"] for row in rows] == ["", "0.02", "", "0.01", "", ""]
    said = {name: rows[1][name] for name in BENDING_COLUMNS}
    values = ("0.02", "0.002", "0.004", "0.0002", "150.0", "70.0", "2500.0")
    assert tuple(said.values()) == values
    workhold.save(plain, tmp_path / "plain.csv")
    assert "clamp_stress" not in (tmp_path / "plain.csv").read_text()
    frame = partly.to_pandas()
    assert frame["clamp_stress"].tolist()[1] == 150.0 and np.isnan(frame["give"][0])


def test_the_least_bent_comes_first(partly: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checking, "has_elements", lambda: False)
    ordered = partly.add_bending({5: make_figures(0.015)}, "clamp-distortion")
    ordered_by = [None if one.bent is None else one.bent.clamp_distortion.value for one in ordered]
    assert ordered_by == [0.01, 0.015, 0.02, None, None, None]
    assert [ordered[k].pegs for k in range(6)] == [partly[k].pegs for k in (3, 5, 1, 0, 2, 4)]
    again = ordered.add_bending({3: make_figures(0.001)})
    assert again.bent_by == "clamp_distortion" and again[0].pegs == partly[0].pegs
    assert verify(again).holds
    assert [one.bent is None for one in ordered[2:4]] == [False, True]
    with pytest.raises(InputError, match="there is nothing to rank by the give"):
        partly.add_bending({0: make_figures(0.1, give=None)}, "give")


def test_seated_fixtures_stay_first() -> None:
    seated = design(seating=2)
    assert len(seated.seating) == 2
    ordered = seated.add_bending({0: make_figures(0.02), 1: make_figures(0.01)}, "clamp_distortion")
    assert ordered[0].pegs == seated[1].pegs and ordered[0].seating == seated[1].seating
    with pytest.raises(InputError, match="the first 2 fixtures are in the order of their seating"):
        seated.add_bending({3: make_figures(0.01)}, "clamp_distortion")


def test_verification_looks_at_the_order_of_bending(partly: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    # These figures are made up.
    monkeypatch.setattr(checking, "has_elements", lambda: False)
    ordered = partly.add_bending({5: make_figures(0.015)}, "clamp_distortion")
    assert verify(ordered).holds
    wrong = evolve(ordered, bending={**ordered.bending, 1: make_figures(0.005)})
    assert "fixture 2 has a smaller clamp_distortion" in " ".join(verify(wrong).faults)
    lacking = evolve(ordered, bending={0: ordered.bending[0], 2: ordered.bending[2]})
    assert "fixture 2 does not have it" in " ".join(verify(lacking).faults)
    assert "none has it" in " ".join(verify(evolve(ordered, bending={})).faults)
    behind = evolve(ordered, table=ordered.table.take(np.array([0, 1, 2, 3, 5, 4])))
    assert "fixture 6 is better than the one before it" in " ".join(verify(behind).faults)


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("material", 3, "bending.material"),
        ("elastic_modulus", -1.0, "bending.elastic_modulus"),
        ("jaw", "glue", "bending.jaw"),
        ("faces", ["left"], "bending.faces"),
        ("yields", False, "what it says of yielding contradicts its stress"),
        ("clamp_distortion", {"value": 0.02}, "bending.clamp_distortion.error"),
        ("stress", {"value": 1.0, "error": 1.0, "unit": "psi", "at": [0.0, 0.0, 0.0]}, "bending.stress.unit"),
    ],
)
def test_what_cannot_be_is_refused(partly: Result, key: str, value: Any, said: str, tmp_path: Path) -> None:
    path = tmp_path / "bent.json"
    workhold.save(partly, path)
    data = json.loads(path.read_text())
    data["fixtures"][1]["bending"][key] = value
    path.write_text(json.dumps(data))
    for look in (workhold.open, verify_file):
        with pytest.raises(InputError, match="fixture 2 cannot be used") as caught:
            look(path)
        assert said in str(caught.value)


def test_an_order_that_nobody_has_is_refused(plain: Result, tmp_path: Path) -> None:
    path = tmp_path / "bent.json"
    workhold.save(evolve(plain, bent_by="give"), path)
    with pytest.raises(InputError, match="bent_by names give, which fixtures with bending do not have"):
        workhold.open(path)


def test_a_choice_keeps_the_bending_of_its_fixtures(partly: Result) -> None:
    chosen = partly[[1, 2, 3]]
    assert list(chosen.bending) == [0, 2] and chosen[2].bent == partly[3].bent
    assert partly.slice_rows(slice(3, 4)).bending == {0: partly.bending[3]}


def test_a_material_of_a_file_is_that_of_the_table_or_its_own(partly: Result, tmp_path: Path) -> None:
    own = ElasticMaterial("my alloy", 70000.0, 0.3, 2800.0)
    path = tmp_path / "bent.json"
    workhold.save(partly.add_bending({1: make_figures(0.02, material=own)}), path)
    read = workhold.open(path)
    assert read.bending[3].material == find_material("mild-steel")
    told = read.bending[1].material
    assert (told.name, told.elastic_modulus, told.poisson, told.strength) == ("my alloy", 70000.0, 0.3, None)


def test_show_and_the_sheet_say_what_the_file_says(
    partly: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: Any) -> None:
        raise InputError("nothing can be meshed.")

    monkeypatch.setattr(bent, "find_bendings", refuse)
    path, sheet = tmp_path / "bent.json", tmp_path / "sheet.svg"
    workhold.save(partly, path)
    shown = CliRunner().invoke(app, ["show", str(path), "2"])
    assert "At a jaw force of 2500 N clamping bends the part by 20 µm" in shown.stdout
    assert "Beware: The part might yield" in shown.stdout
    told = json.loads(CliRunner().invoke(app, ["show", str(path), "2", "--json"]).stdout)
    assert told["fixture"]["bending"]["clamp_distortion"]["value"] == 0.02
    done = CliRunner().invoke(app, ["sheet", str(path), "2", "-o", str(sheet), "--bend", "0.01"])
    assert done.exit_code == 0, done.stderr
    text = sheet.read_text()
    assert "How clamping bends the part" in text and "mild-steel" in text and "20 µm" in text
    assert "Beware: Clamping bends the part by 20 µm, more than 10 µm" in text
    assert "First: of the fixtures" not in shown.stdout


@pytest.mark.thorough
def test_the_command_writes_what_python_computes(
    plain: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    need_elements()
    monkeypatch.setattr(meshing, "TETRAHEDRA", 150)
    source, out, table = (tmp_path / name for name in ("plate.json", "bent.json", "bent.csv"))
    workhold.save(plain, source)
    words = ["bend", str(source), "--thickness", "8", "--jaw-force", "3000", "--best", "3"]
    done = CliRunner().invoke(app, [*words, "--rank-by", "clamp-distortion", "--out", str(out)])
    assert done.exit_code == 0, done.stderr
    assert "in the order of clamp_distortion" in done.stdout
    read = workhold.open(out)
    mine = plain.bend(thickness=8, jaw_force=3000, best=3, rank_by="clamp_distortion")
    assert read.bending == mine.bending and sorted(read.bending) == [0, 1, 2] and len(read) == 6
    assert [[peg.hole for peg in one.pegs] for one in read] == [
        [peg.hole for peg in one.pegs] for one in mine
    ]
    shown = CliRunner().invoke(app, ["show", str(out), "1"])
    assert "First: of the fixtures whose bending was computed, its part is bent least" in shown.stdout
    one = CliRunner().invoke(app, [*words[:-2], "2", "--out", str(table)])
    assert one.exit_code == 0, one.stderr
    rows = list(csv.DictReader(table.open()))
    assert [row["clamp_distortion"] != "" for row in rows] == [False, True, False, False, False, False]
    refused = CliRunner().invoke(app, [*words, "--out", str(source)])
    assert refused.exit_code and "input" in refused.stderr
    both = CliRunner().invoke(app, [*words, "--out", "-", "--json"])
    assert "would both go to the terminal" in both.stderr
    piped = CliRunner().invoke(app, [*words, "--out", "-"])
    assert json.loads(piped.stdout)["fixtures"][0]["bending"]["jaw_force"] == 3000.0
    sheet = tmp_path / "sheet.svg"
    assert CliRunner().invoke(app, ["sheet", str(out), "1", "-o", str(sheet)]).exit_code == 0
    assert "Ring: most." in sheet.read_text() and "These figures are" not in sheet.read_text()


def test_figures_in_files_have_six_digits() -> None:
    place = {"value": 0.333333, "error": 0.0666667, "at": [1.333333, -0.1, 0.0]}
    told = BentPlace(1 / 3, 1 / 15, (4 / 3, -0.1, -1e-9), load=2)
    assert told.to_data() == place | {"unit": "mm", "line": None, "tool": None, "load": 2}
    assert told.rounded == BentPlace(0.333333, 0.0666667, (1.333333, -0.1, 0.0), load=2)
    assert LargestStress(1 / 3, 1 / 15, (4 / 3, -0.1, -1e-9)).to_data() == place | {"unit": "MPa"}


def test_a_question_has_all_that_is_given() -> None:
    asked = bent.make_question("brass", 8.0, 2000.0, 0.5, ["top", 3])
    assert (asked.thickness, asked.jaw_force, asked.faces, asked.stiffness) == (8.0, 2000.0, ("top", 3), 0.5)
    assert asked.material == find_material("brass") and not asked.below and not asked.straps
    assert bent.make_question(asked.material, None, None, "screw", ()).material is asked.material
