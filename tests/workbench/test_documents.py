"""The workbench without a window: a fixture stands in the document, and is found again when the part changes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

Scripted = Callable[..., dict[str, Any]]
HELD = """
held = fixture.make(document, block, "z", "two-clamp-plate-20mm")
held.PegHeight = 8
"""


def test_bodies_stand_about_the_part_and_are_found_again(scripted: Scripted) -> None:
    """A longer part keeps its fixture; the document keeps it when it is closed and opened."""
    answer = scripted(
        HELD
        + """
first = fixture.design(held)
before, distance = fixture.chosen_holes(held), distances(held)
block.Length = 64
document.recompute()
changed = held.State
again = fixture.design(held)
same = fixture.chosen_holes(held) == before
longer = distances(held)
fixture.choose(held, 3)
document.saveAs("held.FCStd")
App.closeDocument("held")
opened = App.openDocument("held.FCStd").getObject("Fixture")
answered(first=first, changed=changed, again=again, same=same, distance=distance, longer=longer,
         opened=[opened.State, len(opened.Group), isinstance(opened.Proxy, fixture.Fixture)],
         rows=len(fixture.rows(opened)))
"""
    )
    assert answer["first"] == "Fixture 1 of 20."
    assert answer["changed"] == "The part has changed: design again."
    assert (answer["again"], answer["same"]) == ("Fixture 1 of 20.", True)
    for distances in (answer["distance"], answer["longer"]):
        touching = {name: far for name, far in distances.items() if not name.startswith("bolt")}
        assert len(touching) == 6 and set(touching.values()) == {0.0}
    assert answer["opened"] == ["Fixture 3 of 20.", 8, True]
    assert answer["rows"] == 20


def test_a_fixture_that_is_none_any_more_says_so(scripted: Scripted) -> None:
    answer = scripted(
        HELD
        + """
held.Best = 3
fixture.design(held)
fixture.choose(held, 3)
block.Length, block.Width = 91, 33
document.recompute()
lower = fixture.design(held)
block.Length, block.Width = 50, 30
document.recompute()
lost = fixture.design(held)
block.Length = 3
document.recompute()
answered(lower=lower, lost=lost, none=fixture.design(held), bodies=len(held.Group))
"""
    )
    gone = "The fixture that was chosen is not among the best 3 any more: "
    assert answer["lower"].startswith(gone + "it is number ")
    assert answer["lost"].startswith(gone + "in these holes nothing holds the part as it is now. The first")
    assert answer["none"].startswith("No fixture: ") and answer["bodies"] == 0


def test_faces_are_named_by_clicking(scripted: Scripted) -> None:
    """No contact lies on a face to leave alone; a face that lies level is refused."""
    answer = scripted(
        """
held = fixture.make(document, block, "z", "plate-20mm")
import json
def sides():
    found = json.loads(held.ResultText)["fixtures"]
    return sorted({peg["segment"] for one in found for peg in one["pegs"]})
fixture.design(held)
every = sides()
path = solid.export(solid.shape_of(block), ".")
numbers = {}
for k, face in enumerate(block.Shape.Faces, 1):
    try:
        numbers["Face%d" % k] = solid.face_numbers(path, solid.shape_of(block), ["Face%d" % k], "z", [])[0]
    except child.Refusal as refusal:
        numbers["Face%d" % k] = str(refusal)
names = [name for name, number in numbers.items() if isinstance(number, list)]
held.Avoid = [names[0]]
fixture.design(held)
answered(every=every, numbers=numbers, left=sides(), axis=[solid.axis_of_face(f) for f in block.Shape.Faces])
"""
    )
    named = [number for number in answer["numbers"].values() if isinstance(number, list)]
    assert sorted(number for numbers in named for number in numbers) == [0, 1, 2, 3]
    refused = [number for number in answer["numbers"].values() if isinstance(number, str)]
    assert len(refused) == 2 and all("nothing touches it anyway" in words for words in refused)
    assert answer["every"] == [0, 1, 2, 3] and named[0][0] not in answer["left"]
    assert sorted(answer["axis"]) == ["-x", "-y", "-z", "x", "y", "z"]


def test_what_cannot_be_done_is_a_sentence(scripted: Scripted, tmp_path: Path) -> None:
    answer = scripted(
        """
said = []
def attempt(work):
    try:
        work()
    except child.Refusal as refusal:
        said.append(str(refusal))
held = fixture.make(document, block, "z", "no-such-toolkit")
attempt(lambda: fixture.design(held))
attempt(lambda: fixture.choose(held, 1))
attempt(lambda: child.use("/nowhere"))
block.Placement.Rotation = App.Rotation(App.Vector(1, 1, 0), 30)
document.recompute()
attempt(lambda: solid.axis_of_face(block.Shape.Faces[5]))
held.HeldPart = None
attempt(lambda: fixture.design(held))
answered(said=said)
"""
    )
    toolkit, rank, place, axis, part = answer["said"]
    assert "no-such-toolkit" in toolkit
    assert rank == "There is no fixture 1 in the list: design first."
    assert place.startswith("There is no command workhold in /nowhere")
    assert axis.endswith("turn the part first.")
    assert part == "The fixture holds no part: choose one."


def test_the_sheet_and_a_job_of_the_cam_workbench(scripted: Scripted, tmp_path: Path) -> None:
    """The job's G-code becomes the program that the tools have to pass with."""
    (tmp_path / "job.nc").write_text("G21 G90\nT1 M6\nG0 X112 Y40 Z30\nG1 Z9 F100\nG1 X148\nG0 Z30\nM30\n")
    answer = scripted(
        HELD
        + """
from workhold_workbench import cam
fixture.design(held)
fixture.save_sheet(held, "sheet.pdf")
fixture.save_picture(held, 2, "second.png")
try:
    cam.take_program(held)
except child.Refusal as refusal:
    early = str(refusal)
sent = cam.send(held)
job = cam.job_of(held)
job.PostProcessorOutputFile = App.ActiveDocument.Name and __import__("os").path.abspath("job.nc")
answered(early=early, sent=sent, taken=cam.take_program(held), tools=open(held.Tools).read(),
         near=fixture.rows(held)[0].get("program_clearance"))
"""
    )
    assert (tmp_path / "sheet.pdf").read_bytes().startswith(b"%PDF")
    assert (tmp_path / "second.png").read_bytes().startswith(b"\x89PNG")
    assert answer["early"].startswith("No job has this part as its model")
    assert answer["sent"].startswith("Job of Block has 8 bodies")
    assert answer["taken"].startswith("Fixture ")
    assert answer["tools"].startswith("tool,diameter\n1,")
    # From the first cut to the left side 12 mm, less the radius of the default end mill; holes are never nearer.
    assert 9.5 <= answer["near"] < 11


def test_the_window_shows_the_list_and_the_picture(scripted: Scripted, tmp_path: Path) -> None:
    """With a window under Xvfb: the selected face lies up, the panel designs, and bodies come in."""
    answer = scripted(
        f"""
import os, traceback
import FreeCADGui as Gui
from PySide import QtCore, QtGui
shot = {str(tmp_path / "window.png")!r}
def go():
    try:
        start = os.path.join(os.path.dirname(os.path.dirname(child.__file__)), "InitGui.py")
        exec(open(start).read(), {{"__name__": "InitGui"}})
        Gui.activateWorkbench("WorkholdWorkbench")
        Gui.Selection.addSelection("held", "Block", "Face6")
        Gui.runCommand("Workhold_Design")
        from workhold_workbench import commands
        held = document.getObject("Fixture")
        panel = commands.shown_panel()
        panel.toolkit.setEditText("two-clamp-plate-20mm")
        panel.height.setProperty("quantity", App.Units.Quantity("8 mm"))
        panel.design()
        panel.table.selectRow(1)
        panel.put_in()
        Gui.getMainWindow().grab().save(shot)
        answered(up=held.Up, rows=panel.table.rowCount(), state=panel.state.text(), bodies=len(held.Group),
                 picture=panel.picture.pixmap().width())
    except BaseException:
        answered(fault=traceback.format_exc())
    finally:
        sys.stdout.flush()
        os._exit(0)
QtCore.QTimer.singleShot(1000, go)
""",
        ("xvfb-run", "-a", "-s", "-screen 0 1400x1000x24", "freecad"),
        QTWEBENGINE_DISABLE_SANDBOX="1",
    )
    assert answer["up"] == "z" and answer["rows"] == 20
    assert answer["state"] == "Fixture 2 of 20." and answer["bodies"] == 8
    assert answer["picture"] == 420 and (tmp_path / "window.png").stat().st_size > 10_000
