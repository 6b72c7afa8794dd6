"""The workbench as its user meets it: what a click selects, pictures of the first choices, and the panel in a window."""

from __future__ import annotations

from pathlib import Path

from workbench.scripts import HELD, Scripted


def test_faces_are_named_by_clicking(scripted: Scripted) -> None:
    """No contact lies on a face to leave alone; a face that lies level is refused."""
    answer = scripted(
        """
import json, Part
corners = [App.Vector(*corner) for corner in ((0, 0), (70, 0), (70, 45), (25, 60), (0, 35), (0, 0))]
five = document.addObject("Part::Feature", "Five")
five.Shape = Part.Face(Part.makePolygon(corners)).extrude(App.Vector(0, 0, 12))
document.recompute()
held = fixture.make(document, five, "z", "plate-20mm")
def sides():
    found = json.loads(held.ResultText)["fixtures"]
    return sorted({peg["segment"] for one in found for peg in one["pegs"]})
fixture.design(held)
every = sides()
held.Best, numbers = 5000, {}
for k, face in enumerate(five.Shape.Faces, 1):
    held.Avoid = ["Face%d" % k]
    try:
        fixture.design(held)
        numbers["Face%d" % k] = sorted(set(every) - set(sides()))
    except child.Refusal as refusal:
        numbers["Face%d" % k] = str(refusal)
held.Best, held.Avoid = 20, []
fixture.design(held)
names = [name for name, number in numbers.items() if isinstance(number, list)]
held.Avoid = ["Face99"]
stale = said_by(lambda: fixture.design(held))
found = json.loads(held.ResultText)["fixtures"]
touching = [k for k, one in enumerate(found, 1) if numbers[names[3]][0] in [peg["segment"] for peg in one["pegs"]]]
fixture.choose(held, touching[0])
held.Avoid = [names[3]]
asked = fixture.design(held)
left, held.Avoid, held.Only = sides(), [], names[:3] + names[4:]
fixture.design(held)
answered(every=every, numbers=numbers, left=left, only=sides(), stale=stale, asked=asked,
         axis=[solid.axis_of_face(f) for f in block.Shape.Faces])
"""
    )
    named = [number for number in answer["numbers"].values() if isinstance(number, list)]
    # Without the first nothing holds the part at all; each other one is left alone by itself.
    assert named[0] == [0, 1, 2, 3, 4] and named[1:] == [[1], [2], [3], [4]]
    refused = [number for number in answer["numbers"].values() if isinstance(number, str)]
    assert len(refused) == 2 and all("nothing touches it anyway" in words for words in refused)
    assert answer["every"] == [0, 1, 2, 3, 4] and named[3][0] not in answer["left"]
    # To touch the others only is the same as to leave that one alone.
    assert answer["left"] and answer["only"] == answer["left"]
    assert sorted(answer["axis"]) == ["-x", "-y", "-z", "x", "y", "z"]
    # Of another question it is not the part that is said to have changed.
    assert "in these holes nothing holds the part with what is asked now" in answer["asked"]
    # A face that a change of the part has taken away.
    assert answer["stale"] == "refused: The part has no face Face99 as it is now: choose the faces again."


def test_a_feature_stands_for_its_body(scripted: Scripted) -> None:
    """A click selects the pad that is seen; held is the body, also with what is cut out of it afterwards."""
    answer = scripted(
        """
group = document.addObject("App::Part", "Unit")
body = group.newObject("PartDesign::Body", "Arm")
pad = body.newObject("PartDesign::AdditiveBox", "Pad")
pad.Length, pad.Width, pad.Height = 60, 40, 12
document.recompute()
group.Placement = App.Placement(App.Vector(5, 6, 7), App.Rotation(App.Vector(1, 0, 0), 90))
document.recompute()
sides = [solid.axis_of_face(solid.shape_of(body).getElement("Face%d" % k)) for k in range(1, 7)]
held = fixture.make(document, solid.body_of(pad), "-y", "two-clamp-plate-20mm")
held.Best = 3
first = fixture.design(held)
notch = body.newObject("PartDesign::SubtractiveBox", "Notch")
notch.Length, notch.Width, notch.Height = 25, 15, 12
document.recompute()
changed = held.State
again = fixture.design(held)
low = min(v.Y for v in solid.shape_of(body).Vertexes), max(v.Y for v in solid.shape_of(body).Vertexes)
answered(held=held.HeldPart.Name, itself=solid.body_of(block).Name, first=first, changed=changed, again=again,
         volumes=shared(held), sides=sides, low=low,
         plate=[one.Shape.BoundBox.YMin for one in held.Group if one.Label == "plate"])
"""
    )
    assert (answer["held"], answer["itself"]) == ("Arm", "Block")
    assert answer["first"] == "Fixture 1 of 3." and answer["changed"] == "The part has changed: design again."
    assert answer["again"].startswith(("Fixture ", "The fixture that was chosen is not among"))
    assert len(answer["volumes"]) == 8 and set(answer["volumes"].values()) == {0.0}
    # Where it lies in the document: turned with the unit that the body belongs to.
    assert sorted(answer["sides"]) == ["-x", "-y", "-z", "x", "y", "z"]
    assert abs(answer["plate"][0] - answer["low"][1]) < 1e-3


def test_the_first_choices_are_kept_as_pictures(scripted: Scripted) -> None:
    """One for each that differs from those before it, on one sheet; the document keeps them."""
    answer = scripted(
        HELD
        + """
fixture.design(held, pictures=True)
choices = json.loads(held.Glanced)
rows = len(fixture.rows(held))
document.saveAs("held.FCStd")
App.closeDocument("held")
opened = App.openDocument("held.FCStd").getObject("Fixture")
size = len(open(opened.Glance, "rb").read())
opened.HeldPart.Length = 3
opened.Document.recompute()
fixture.design(opened)
answered(choices=choices, rows=rows, size=size, plain=opened.Glanced)
"""
    )
    choices = answer["choices"]
    assert 1 < len(choices) <= 12 and choices[0]["rank"] == 1
    # Each fixture of the list is one of them or like one.
    ranks = [one["rank"] for one in choices]
    assert ranks == sorted(set(ranks))
    if len(choices) < 12:
        assert sum(1 + one["like"] for one in choices) == answer["rows"]
    # The boxes lie on the sheet and apart.
    boxes = [one["box"] for one in choices]
    for x, y, width, height in boxes:
        assert 0 < x < x + width < 1 and 0 < y < y + height < 1 and width > 0.1 and height > 0.1
    apart = {(x, y) for x, y, _, _ in boxes}
    assert len(apart) == len(boxes)
    assert answer["size"] > 10_000
    # Without pictures of the last search the old ones are not shown.
    assert answer["plain"] == ""


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
        body = document.addObject("PartDesign::Body", "Arm")
        pad = body.newObject("PartDesign::AdditiveBox", "Pad")
        pad.Length, pad.Width, pad.Height = 60, 40, 12
        document.recompute()
        # As a click does it: the feature that is seen, by its name in the body.
        Gui.Selection.addSelection("held", "Arm", "Pad.Face6")
        Gui.runCommand("Workhold_Design")
        from workhold_workbench import commands
        held = document.getObject("Fixture")
        panel = commands.shown_panel()
        panel.toolkit.setEditText("two-clamp-plate-20mm")
        panel.height.setProperty("quantity", App.Units.Quantity("8 mm"))
        # That an earlier search was stopped does not stop the next one.
        panel.cancel.set()
        panel.design()
        rows, held_part = panel.table.rowCount(), held.HeldPart
        # Numbers sort as numbers: the last of twenty is not the ninth.
        panel.table.sortItems(0, QtCore.Qt.DescendingOrder)
        panel.table.selectRow(0)
        last = panel.rank()
        second = panel.first.item(1).data(QtCore.Qt.UserRole)
        panel.select(second)
        clicked = panel.rank()
        panel.table.sortItems(0)
        panel.table.selectRow(1)
        panel.put_in()
        # From the screen: a grab of the window leaves out what OpenGL draws.
        wait = QtCore.QEventLoop()
        QtCore.QTimer.singleShot(500, wait.quit)
        wait.exec_()
        seen = QtGui.QApplication.primaryScreen().grabWindow(Gui.getMainWindow().winId())
        seen.save(shot)
        image = seen.toImage()
        across = range(image.width() // 2, image.width() - 100, 7)
        colours = len({{image.pixel(x, y) for x in across for y in range(200, image.height() - 200, 7)}})
        put_in, bodies = panel.state.text(), len(held.Group)
        least = panel.form.minimumSizeHint().width()
        panel.picture.resize(200, 200)
        narrow = panel.picture.pixmap().width()
        panel.take_selected("Avoid")
        faces = panel.faces["Avoid"].text()
        Gui.Selection.clearSelection()
        panel.take_selected("Avoid")
        nothing = panel.state.text()
        panel.faces["Only"].setText("Face1")
        panel.design()
        none = [panel.state.text(), panel.table.rowCount(), len(held.Group), panel.first.isVisible()]
        panel.faces["Only"].setText("")
        ball = document.addObject("Part::Sphere", "Ball")
        document.recompute()
        held.HeldPart = ball
        panel.design()
        answered(up=held.Up, part=held_part.Name, rows=rows, state=put_in, bodies=bodies, last=last, least=least,
                 ball=panel.state.text(), narrow=narrow, faces=faces, nothing=nothing, none=none,
                 clicked=[second, clicked], colours=colours)
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
    assert answer["up"] == "z" and answer["part"] == "Arm" and answer["rows"] == 20
    assert answer["state"] == "Fixture 2 of 20." and answer["bodies"] == 8 and answer["last"] == 20
    # What is not a prism is said in the panel.
    assert answer["ball"].startswith("Ball: ") and "upright" in answer["ball"]
    second, clicked = answer["clicked"]
    assert second == clicked > 1
    assert answer["faces"] == "Face6" and answer["nothing"].startswith("No face of Arm is selected")
    assert answer["none"][0].startswith("No fixture. ") and answer["none"][1:] == [0, 0, False]
    # The dock is 264 pixels wide at first, of which its frames and the bar to scroll by take 37.
    assert answer["least"] <= 227 and answer["narrow"] == 200
    # The document is drawn, too, not only the panel.
    assert answer["colours"] > 20
    assert (tmp_path / "window.png").stat().st_size > 10_000
