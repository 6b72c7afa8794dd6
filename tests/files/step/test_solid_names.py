"""Solids of a file with several are listed and chosen by their names: of bodies, of products, of neither."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRep import BRep_Builder
from OCP.gp import gp_Trsf, gp_Vec
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound
from OCP.XCAFDoc import XCAFDoc_DocumentTool
from step_shapes import box, write_step

from workhold import InputError, load, solids_in
from workhold.files.part.survey import survey_part_file
from workhold.files.step.solids import clean_name, read_name

BOXES = (box(60, 40, 10), box(20, 20, 5, (0, 0, 20)), box(12, 10, 5, (30, 0, 20)), box(8, 5, 5, (45, 0, 20)))


def assembly(path: Path) -> Path:
    """A base, and a bolt that is used three times in an assembly within the assembly; the product is named, its body too."""
    document = TDocStd_Document(TCollection_ExtendedString("names"))
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())

    def product(name: str, shape: Any) -> Any:
        label = tool.AddShape(shape, False)
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
        return label

    def placed(whole: Any, part: Any, name: str, at: tuple[float, float, float]) -> None:
        move = gp_Trsf()
        move.SetTranslation(gp_Vec(*at))
        label = tool.AddComponent(whole, part, TopLoc_Location(move))
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))

    top, bolts = (tool.NewShape() for _ in range(2))
    TDataStd_Name.Set_s(top, TCollection_ExtendedString("machine"))
    TDataStd_Name.Set_s(bolts, TCollection_ExtendedString("bolts of the base"))
    base, bolt = product("base plate", BOXES[0]), product("bolt M8", box(6, 6, 20))
    for k in range(3):
        placed(bolts, bolt, f"bolt {k}", (10.0 * k, 0.0, 0.0))
    placed(top, base, "the base", (0.0, 0.0, 0.0))
    placed(top, bolts, "NAUO2", (5.0, 7.0, 10.0))
    tool.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.Transfer(document)
    writer.Write(str(path))
    return path


def bodies(path: Path, *names: str) -> Path:
    """One product with several bodies, which are named as given in the order in which they are written."""
    whole, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(whole)
    for shape in BOXES:
        builder.Add(whole, shape)
    text, given = write_step(path, whole).read_text(), iter(names)
    named = re.sub(r"MANIFOLD_SOLID_BREP\(''", lambda _: f"MANIFOLD_SOLID_BREP('{next(given)}'", text)
    assert next(given, None) is None
    path.write_text(named)
    return path


def test_products_of_an_assembly_are_listed(tmp_path: Path) -> None:
    """Each solid where the assembly places it, by its product; duplicates have one name and their own numbers."""
    listed = solids_in(assembly(tmp_path / "machine.step"))
    assert [solid.name for solid in listed] == ["base plate", *["bolt M8"] * 3]
    assert [solid.number for solid in listed] == [1, 2, 3, 4]
    assert listed[0].size == pytest.approx((60, 40, 10))
    assert sorted(solid.low for solid in listed[1:]) == [pytest.approx((5 + 10 * k, 7, 10)) for k in range(3)]


def test_bodies_of_one_product_are_listed(tmp_path: Path) -> None:
    """Each by its own name; one that has none, or one that says nothing, has no name."""
    listed = solids_in(bodies(tmp_path / "part.step", "base", "Boss-Extrude1", "NONE", ""))
    assert [solid.name for solid in listed] == ["base", "Boss-Extrude1", "", ""]


@pytest.mark.parametrize("height", [None, 4.0])
def test_a_solid_is_chosen_by_its_name(tmp_path: Path, height: float | None) -> None:
    """As it is written, else in any mixture of capitals, as its number chooses it; at any height of the pegs."""
    path = bodies(tmp_path / "part.step", "base", "lug", "Lug", "Eye")
    for name, wide in (("base", 60), ("lug", 20), ("Lug", 12), ("EYE", 8), ("4", 8), (4, 8)):
        x0, _, x1, _ = load(path, part_number=name, peg_height=height).bounds
        assert x1 - x0 == pytest.approx(wide), name
    assert load(path, part_number="lug", section=2).bounds == load(path, part_number=2, section=2).bounds


def test_a_part_is_named_after_its_solid_too(tmp_path: Path) -> None:
    """Whichever way it was read and chosen; one of no name, of the file's own, or alone, after the file only."""
    path, eye = bodies(tmp_path / "part.step", "base", "lug", "", "Part"), "base of part"
    views = ({}, {"peg_height": 4.0}, {"section": 2.0})
    assert [load(path, **view).name for view in views] == [eye] * 3
    named = {"BASE": eye, "2": "lug of part", 2: "lug of part", 3: "part", 4: "Part of part"}
    assert {one: load(path, part_number=one).name for one in named} == named
    other = bodies(tmp_path / "base.step", "base", "lug", "Lug", "Eye")
    assert load(other).name == "base"
    assert [load(other, part_number=one).name for one in ("lug", "Lug")] == ["lug of base", "Lug of base"]
    assert load(path, name="mine").name == "mine"
    assert load(write_step(tmp_path / "one.step", BOXES[0])).name == "one"
    own = load(path, part_number="lug", heights={"clamp": (1.0, 4.0)}).outlines
    assert [one.name for _, one in own] == ["outline from 1 to 4 mm"]


def test_names_that_choose_nothing_are_refused(tmp_path: Path) -> None:
    """Unknown ones with those that are close, duplicates with their numbers, and files without names."""
    path = bodies(tmp_path / "part.step", "base plate", "lug", "lug", "eye")
    for name, words in (
        (
            "base plat",
            "No solid of the file is called 'base plat': give a number, or a name such as base plate.",
        ),
        ("lug", "2 solids of the file are called 'lug': give the number of one of them, 2, 3."),
        ("LUG", "2 solids of the file are called 'lug': give the number of one of them, 2, 3."),
    ):
        with pytest.raises(InputError, match=re.escape(f"part.step: {words}")):
            load(path, part_number=name)
    nameless = bodies(tmp_path / "none.step", "", "", "", "")
    assert [solid.name for solid in solids_in(nameless)] == [""] * 4
    with pytest.raises(InputError, match=r"have no names: give a number from 1 to 4 instead of 'lug'"):
        load(nameless, part_number="lug")
    with pytest.raises(InputError, match=r"holds only one solid: leave part_number out"):
        load(write_step(tmp_path / "one.step", BOXES[0]), part_number="lug")
    with pytest.raises(InputError, match=r"only solids of a STEP file have names"):
        load("widget", part_number="lug")
    with pytest.raises(InputError, match=r"widget\.json: only STEP files have solids"):
        solids_in("widget")


def test_the_solids_are_told_with_what_is_read_and_with_what_is_not(tmp_path: Path) -> None:
    """A survey has them where the part is read and where it is refused; a remark names the first."""
    path = bodies(tmp_path / "part.step", "base plate", "lug", "", "eye")
    seen = survey_part_file(path)
    assert seen.loaded is not None
    assert [solid.name for solid in seen.solids] == ["base plate", "lug", "", "eye"]
    assert "solid 1, base plate, is 60 x 40 x 10 mm at (0, 0, 0); solid 2, lug, is" in seen.loaded.remarks[0]
    assert "solid 3 is 12 x 10 x 5 mm" in seen.loaded.remarks[0]
    refused = survey_part_file(path, part_number="spoon")
    assert refused.loaded is None and refused.solids == seen.solids


def test_names_are_made_fit_to_be_shown() -> None:
    """Of one line, without letters that steer a terminal, and not too long."""
    assert clean_name("a\x1b[31m\nb") == "a?[31m b"
    assert len(clean_name("x" * 500)) <= 80
    assert [
        clean_name(name)
        for name in ("=>[0:1:1:3]", "SOLID", "NAUO12", "7", "Open CASCADE STEP translator 8.0 1")
    ] == [""] * 5
    assert clean_name("Solid base") == "Solid base"


def test_the_nearest_name_is_taken() -> None:
    """The body's own among several of a product, else the product's; that of the whole assembly is none of a solid's."""

    class Entity:
        def __getattr__(self, name: str) -> Any:
            return lambda *_: "boss" if name == "ToCString" else self

    solid = box(1, 1, 1)
    for names, count, wanted in (
        (("machine", "machine", "the gear", "gear"), 1, "gear"),
        (("machine", "machine", "the gear", "gear"), 2, "boss"),
        (("machine", "machine", "", ""), 1, "boss"),
        (("gear", "gear"), 1, "gear"),
    ):
        assert read_name(solid, names, count, Entity()) == wanted
