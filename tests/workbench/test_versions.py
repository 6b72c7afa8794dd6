"""The add-on with the names of each version of FreeCAD: stand-ins for what 0.20 and 1.1 have."""

from __future__ import annotations

import enum
import importlib
import sys
import types
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]


class NumberedButton(enum.IntFlag):
    """Buttons as PySide2 has them: numbers."""

    Close = 0x00200000


class PlainButton(enum.Flag):
    """Buttons as PySide6 has them: no numbers."""

    Close = 0x00200000


@pytest.fixture
def compat(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module of the add-on, with a FreeCAD that has nothing."""
    monkeypatch.syspath_prepend(str(ROOT / "freecad"))
    monkeypatch.setitem(sys.modules, "FreeCAD", types.ModuleType("FreeCAD"))
    for name in [name for name in sys.modules if name.startswith("workhold_workbench")]:
        monkeypatch.delitem(sys.modules, name)
    yield importlib.import_module("workhold_workbench.compat")
    for name in [name for name in sys.modules if name.startswith("workhold_workbench")]:
        del sys.modules[name]


@pytest.mark.parametrize("button", [NumberedButton.Close, PlainButton.Close, 0x00200000], ids=type)
def test_a_button_is_a_number_for_freecad(compat: Any, button: Any) -> None:
    number = compat.button_number(button)
    assert number == 0x00200000 and type(number) in (int, NumberedButton)


@pytest.mark.parametrize("name", ["Path.Main.Job", "PathScripts.PathJob"])
def test_jobs_are_made_by_the_module_there_is(
    compat: Any, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    package, _, _ = name.rpartition(".")
    for part in {package.partition(".")[0], package}:
        made = types.ModuleType(part)
        made.__path__ = []
        monkeypatch.setitem(sys.modules, part, made)
    module = types.ModuleType(name)
    monkeypatch.setitem(sys.modules, name, module)
    assert compat.job_module() is module


def test_the_newer_module_is_taken_where_both_are(compat: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """As in FreeCAD 0.21, which keeps the older names and warns of them."""
    monkeypatch.setattr(compat.importlib, "import_module", lambda name: name)
    assert compat.job_module() == "Path.Main.Job"


def test_no_cam_workbench_is_a_sentence(compat: Any) -> None:
    with pytest.raises(compat.Refusal, match="has no CAM workbench"):
        compat.job_module()


def test_a_body_is_painted_in_either_way(compat: Any) -> None:
    """1.0 has materials, of which a copy is changed and handed back; an older one has a colour."""
    old, colour = types.SimpleNamespace(), (0.1, 0.2, 0.3)
    compat.paint(old, colour, 60)
    assert (old.ShapeColor, old.Transparency) == (colour, 60)
    material = types.SimpleNamespace(DiffuseColor=None)
    new = types.SimpleNamespace(ShapeAppearance=(material, "of another face"))
    compat.paint(new, colour)
    assert new.ShapeAppearance == (material,) and material.DiffuseColor == colour
    assert new.Transparency == 0 and not hasattr(new, "ShapeColor")


def test_the_file_of_a_job_is_found(compat: Any, tmp_path: Path) -> None:
    """By its name, or where that is a pattern by that of the last output; several are not a program."""
    first, second = tmp_path / "a.nc", tmp_path / "b.nc"
    first.write_text("M30\n")
    second.write_text("M30\n")
    job = types.SimpleNamespace(Label="Job", PostProcessorOutputFile=str(first))
    assert compat.program_of(job) == str(first)
    job.PostProcessorOutputFile = "%D/%d.nc"
    with pytest.raises(compat.Refusal, match="Job has no file with G-code yet"):
        compat.program_of(job)
    job.LastPostProcessOutput = f"{second} \n"
    assert compat.program_of(job) == str(second)
    job.LastPostProcessOutput = f"{first} \n{second}"
    with pytest.raises(compat.Refusal, match="into 2 files"):
        compat.program_of(job)
    job.PostProcessorOutputFile, job.LastPostProcessOutput = "", None
    with pytest.raises(compat.Refusal, match="no file with G-code"):
        compat.program_of(job)


def test_only_one_file_asks_for_the_version() -> None:
    """The names that differ between versions stand in the one file that knows them."""
    for path in (ROOT / "freecad").rglob("*.py"):
        if path.name == "compat.py":
            continue
        text = path.read_text(encoding="utf-8")
        for name in ("PathScripts", "Path.Main", "ShapeColor", "ShapeAppearance", "PySide2", "PySide6"):
            assert name not in text, path
        assert "int(QtGui" not in text, path


@pytest.mark.parametrize(
    "sentence, words",
    [
        (
            "the thickness of the part is not known: give --thickness.",
            "The thickness of the part is not known: give the thickness.",
        ),
        (
            "give its --thickness, and --peg-height where pegs are not as high.",
            "Give the thickness, and the peg height where pegs are not as high.",
        ),
        (
            "the vise's pitch is not given: add --pitch, or name a vise with --toolkit (see workhold toolkits).",
            "The vise's pitch is not given: add the pitch, or name a vise with the toolkit.",
        ),
        (
            "this is not known: give --start X,Y,Z.",
            "This is not known: give the place of the tip at its start.",
        ),
        ("No such option: -x; see workhold workbench --help.", "No such option: -x."),
    ],
)
def test_no_option_of_the_command_reaches_the_report_view(compat: Any, sentence: str, words: str) -> None:
    child = importlib.import_module("workhold_workbench.child")
    assert child.in_words_of_the_panel(sentence) == words
