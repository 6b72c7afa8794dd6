"""Vises of FreeCAD's CAM workbench: written by hand in FreeCAD's format, and hostile files."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr
from zipfile import ZIP_DEFLATED, ZipFile

import pytest
from attrs import evolve

import workhold
from workhold.errors import InputError
from workhold.files.budget import LIMITS
from workhold.files.toolkit_file import load_toolkit

# How FreeCAD writes the value of a property, by the type of the property.
TAGS = {"Length": "Float", "Bool": "Bool", "Integer": "Integer", "String": "String"}
VISE = {
    "Opening": ("Length", 50.0),
    "JawHeight": ("Length", 31.37),
    "JawWidth": ("Length", 101.60000000000001),
    "MaxOpening": ("Length", 228.6),
}


def write_property(name: str, kind: str, value: Any) -> str:
    text = str(value).lower() if isinstance(value, bool) else str(value)
    return (
        f'<Property name="{name}" type="App::Property{kind}" group="Vise" doc="" attr="0" ro="0" hide="0" '
        f'status="2097156">\n<{TAGS[kind]} value={quoteattr(text)}/>\n</Property>'
    )


def write_document(objects: dict[str, tuple[str, dict[str, tuple[str, Any]]]], before: str = "") -> str:
    """The XML of a document: by name of the object its type and its properties."""
    heads = "".join(
        f'<Object type="{kind}" name="{name}" id="{k}" />\n'
        for k, (name, (kind, _)) in enumerate(objects.items(), 1)
    )
    bodies = "".join(
        f'<Object name="{name}">\n<Properties Count="{len(some)}" TransientCount="0">\n'
        + "\n".join(write_property(one, *value) for one, value in some.items())
        + "\n</Properties>\n</Object>\n"
        for name, (_, some) in objects.items()
    )
    return (
        f"<?xml version='1.0' encoding='utf-8'?>\n{before}<Document SchemaVersion=\"4\" FileVersion=\"1\">\n"
        f'<Properties Count="1" TransientCount="0"><Property name="Label" type="App::PropertyString">'
        f'<String value="document"/></Property></Properties>\n'
        f'<Objects Count="{len(objects)}" Dependencies="1">\n{heads}</Objects>\n'
        f'<ObjectData Count="{len(objects)}">\n{bodies}</ObjectData>\n</Document>\n'
    )


def save(folder: Path, xml: str, name: str = "vise.FCStd", member: str = "Document.xml") -> Path:
    path = folder / name
    with ZipFile(path, "w", ZIP_DEFLATED) as archive:
        archive.writestr(member, xml)
        archive.writestr("GuiDocument.xml", "<Document/>")
    return path


def vise_file(folder: Path, **changes: Any) -> Path:
    """A file with a vise; None takes a setting away."""
    given = {name: value for name, value in {**VISE, **changes}.items() if value is not None}
    part = "App::Part", {"Label": ("String", "Kurt 3400V vise")}
    body = "Part::Feature", {"Label": ("String", "Body"), "JawWidth": ("Length", 7.0)}
    return save(folder, write_document({"Body": body, "Vise": part, "Settings": ("App::VarSet", given)}))


def test_a_vise_is_read(tmp_path: Path) -> None:
    loaded = load_toolkit(vise_file(tmp_path))
    assert loaded.kind == "plain-vise" and loaded.title == "Kurt 3400V vise" and loaded.name == "vise"
    assert loaded.fields == {"jaw_width": 101.6, "jaw_height": 31.37, "max_opening": 228.6}
    assert workhold.PlainVise.preset(str(tmp_path / "vise.FCStd"), parallels=[10]).parallels == (10.0,)
    toolkit = loaded.toolkit
    assert toolkit.jaw_width == 101.6 and toolkit.parallels == ()
    assert "FreeCAD" in loaded.source


def test_what_the_part_stands_on_is_a_height_of_parallels(tmp_path: Path) -> None:
    for changes, expected in (
        ({"SeatHeight": ("Length", 12.7)}, (12.7,)),
        ({"SeatHeight": ("Length", 0.0)}, None),
        ({"SeatHeight": ("Length", 12.7), "TakesParallels": ("Bool", False)}, None),
        ({"Parallels": ("Length", 20.0), "OnParallels": ("Bool", True)}, (20.0,)),
        ({"Parallels": ("Length", 20.0), "OnParallels": ("Bool", False)}, None),
    ):
        assert load_toolkit(vise_file(tmp_path, **changes)).fields.get("parallels") == expected


def test_a_vise_in_a_job_holds_its_settings_itself(tmp_path: Path) -> None:
    held = "App::GeometryPython", {**VISE, "Label": ("String", "in the job")}
    path = save(tmp_path, write_document({"Job": ("Path::FeaturePython", {}), "Vise": held}))
    assert load_toolkit(path).fields["max_opening"] == 228.6
    # A set of variables goes before it.
    other = "App::VarSet", {**VISE, "MaxOpening": ("Length", 150.0)}
    path = save(tmp_path, write_document({"Vise": held, "Set": other}))
    assert load_toolkit(path).fields["max_opening"] == 150.0
    # And settings may be spread over two.
    first = "App::VarSet", {"Opening": VISE["Opening"], "JawWidth": ("Length", 90.0)}
    rest = "App::VarSet", {name: VISE[name] for name in ("JawHeight", "JawWidth")}
    path = save(tmp_path, write_document({"A": first, "B": rest}))
    assert load_toolkit(path).fields == {"jaw_width": 90.0, "jaw_height": 31.37}
    # What stands in the document's own properties is of no vise.
    own = "".join(write_property(name, *value) for name, value in VISE.items())
    path = save(tmp_path, write_document({}).replace("</Properties>", f"{own}</Properties>", 1))
    with pytest.raises(InputError, match="has no vise"):
        load_toolkit(path)


def test_where_it_is_from_is_told(tmp_path: Path) -> None:
    about = {"Model": ("String", "3400V  AngLock"), "Source": ("String", "https://a.example/")}
    loaded = load_toolkit(vise_file(tmp_path, **about, Stations=("Integer", 2), ViseSchema=("Integer", 2)))
    assert loaded.title == "3400V AngLock" and "https://a.example/" in loaded.source
    assert "of its stations the first is meant" in loaded.source


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"SelfCentering": ("Bool", True)}, "both jaws of this vise move"),
        ({"ViseSchema": ("Integer", 3)}, "laid out for a newer FreeCAD"),
        ({"JawWidth": ("Length", "wide")}, "JawWidth of the vise is 'wide', not a number"),
        ({"JawHeight": ("Length", "nan")}, "JawHeight of the vise is 'nan'"),
        ({"JawHeight": ("Length", "inf")}, "JawHeight of the vise is 'inf'"),
        ({"MaxOpening": ("Length", -3)}, "not a number of 0 or more"),
        ({"Opening": None, "Kind": ("String", "HoldDown")}, "a clamp of FreeCAD's CAM workbench, not a vise"),
        ({"Opening": None}, "has no vise of the CAM workbench"),
    ],
)
def test_what_is_no_plain_vise_is_refused(changes: Any, message: str, tmp_path: Path) -> None:
    path = vise_file(tmp_path, **changes)
    with pytest.raises(InputError, match=r"^vise\.FCStd: ") as told:
        load_toolkit(path)
    assert message in str(told.value)


def test_damaged_and_hostile_files_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a sentence, with bounded work: no archive, none of FreeCAD, bombs, entities, deep and broken XML."""

    def told(path: Path) -> str:
        with pytest.raises(InputError) as error:
            load_toolkit(path)
        return str(error.value)

    good = vise_file(tmp_path).read_bytes()
    cases = {
        "text.FCStd": b"not an archive",
        "cut.FCStd": good[: len(good) // 2],
        "empty.FCStd": b"",
    }
    for name, content in cases.items():
        (tmp_path / name).write_bytes(content)
        assert "not a FreeCAD document, or it is damaged" in told(tmp_path / name)
    damaged = bytearray(good)
    damaged[60:80] = bytes(20)
    (tmp_path / "bad.FCStd").write_bytes(damaged)
    assert "damaged" in told(tmp_path / "bad.FCStd") or "not valid XML" in told(tmp_path / "bad.FCStd")
    assert "without Document.xml" in told(save(tmp_path, "x", member="Other.xml"))
    assert "not valid XML (line 1)" in told(save(tmp_path, "<Document"))
    bomb = '<!DOCTYPE d [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]>\n'
    assert "declares a document type" in told(save(tmp_path, write_document({}, bomb)))
    assert "nested more than 100 levels" in told(save(tmp_path, "<a>" * 500))
    assert "encoding" in told(save(tmp_path, "<?xml version='1.0' encoding='klingon'?><a/>"))
    assert "not a file" in told(folder_named(tmp_path))
    monkeypatch.setitem(LIMITS, "freecad", evolve(LIMITS["freecad"], most_elements=50))
    assert "more than the 50 elements" in told(
        save(tmp_path, write_document({f"O{k}": ("A", {}) for k in range(60)}))
    )
    monkeypatch.setitem(LIMITS, "freecad", evolve(LIMITS["freecad"], most_bytes=100_000, most_elements=None))
    small = save(tmp_path, " " * 10_000_000)
    assert small.stat().st_size < 100_000
    assert "more than 0.1 MB unpacked" in told(small)
    (tmp_path / "large.FCStd").write_bytes(bytes(100_001))
    assert "more than the 0.1 MB" in told(tmp_path / "large.FCStd")


def folder_named(folder: Path) -> Path:
    (folder / "folder.FCStd").mkdir()
    return folder / "folder.FCStd"
