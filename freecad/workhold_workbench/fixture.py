"""The fixture of a part as an object of the document: what was asked, what was found, and its bodies.

The object is a group. Its properties say what was asked; the result of the search stands in it as text, so a
document that is opened elsewhere still has its fixture. When the part changes, the object says so, and a new
design finds the same fixture again or says why it is none any more.
"""

import json
import tempfile
from pathlib import Path

import FreeCAD as App

from .bodies import solids_of
from .child import STOPPED, Refusal, ordered, run
from .compat import paint
from .solid import export, face_places, foot_height, placing, shape_of, signature
from .thumbnails import keep_thumbnails

__all__ = ["Fixture", "choose", "design", "fixture_of", "make", "rows", "save_picture", "save_sheet"]

# Red, green and blue of the bodies, by the first word of their names.
COLOURS = {
    "peg": (0.85, 0.55, 0.15),
    "locator": (0.85, 0.55, 0.15),
    "clamp": (0.75, 0.25, 0.22),
    "bolt": (0.75, 0.25, 0.22),
    "support": (0.30, 0.62, 0.38),
    "fence": (0.45, 0.48, 0.52),
    "wall": (0.45, 0.48, 0.52),
}
PLATE = (0.72, 0.74, 0.76)
# Of plates, in per cent, so that the part below them is seen.
SEEN_THROUGH = 60
PROPERTIES = (
    ("App::PropertyLink", "HeldPart", "Part", "The part that is held"),
    ("App::PropertyEnumeration", "Up", "Part", "The axis of the document that points up"),
    (
        "App::PropertyLength",
        "PegHeight",
        "Part",
        "How far pegs reach above where the part lies; 0 is all of it",
    ),
    ("App::PropertyStringList", "Avoid", "Part", "Faces of the part that nothing may touch"),
    (
        "App::PropertyStringList",
        "Only",
        "Part",
        "The only faces of the part that may be touched, if any are named",
    ),
    (
        "App::PropertyString",
        "Toolkit",
        "Fixture",
        "A name of workhold's toolkits, a TOML file, or a vise of FreeCAD",
    ),
    ("App::PropertyInteger", "Best", "Fixture", "How many of the best fixtures are kept"),
    ("App::PropertyInteger", "Chosen", "Fixture", "Which of them stands in the document, from 1"),
    ("App::PropertyBool", "Supports", "Fixture", "Whether three supports and a clamp on top are put in"),
    ("App::PropertyFile", "Program", "Fixture", "A program for the mill that its tools have to pass with"),
    ("App::PropertyFile", "Tools", "Fixture", "The table of the program's tools"),
    ("App::PropertyString", "State", "Fixture", "What is known of the fixture"),
    ("App::PropertyString", "ResultText", "Hidden", "The result of the search"),
    ("App::PropertyString", "HeldBy", "Hidden", "Toolkit and axis of the result"),
    ("App::PropertyString", "Marks", "Hidden", "What the fixture that was chosen last is known by"),
    ("App::PropertyString", "Signature", "Hidden", "Numbers that change when the part does"),
    ("App::PropertyFileIncluded", "Glance", "Hidden", "Thumbnails of the first choices, or the nearest miss"),
    ("App::PropertyString", "Glanced", "Hidden", "Which choices these are, and where they stand"),
    ("App::PropertyFileIncluded", "Page", "Hidden", "The picture of the fixture that stands in the document"),
    ("App::PropertyInteger", "Paged", "Hidden", "Which fixture this is the picture of; 0 for none"),
)
HIDDEN = tuple(name for _, name, group, _ in PROPERTIES if group == "Hidden")
# Files of an order's folder: the result of the search, and the picture of the fixture that is put in.
RESULT, PAGE = "result.json", "chosen.png"
AXIS_NAMES = ["z", "-z", "x", "-x", "y", "-y"]
LOST = "in these holes nothing holds the part as it is now"
LOST_BY_WISH = "in these holes nothing holds the part with what is asked now"
CHANGED = "The part has changed: design again."


class Fixture:
    """Behaviour of the object: it notices that its part has changed."""

    def __init__(self, obj):
        obj.Proxy = self
        self.complete(obj)

    def complete(self, obj):
        """Gives the object the properties that it lacks, as one of an older document may."""
        have = obj.PropertiesList
        for kind, name, group, words in PROPERTIES:
            if name not in have:
                obj.addProperty(kind, name, group, words)
                if name == "Up":
                    obj.Up = AXIS_NAMES
        for name in HIDDEN:
            obj.setEditorMode(name, 2)
        obj.setEditorMode("State", 1)

    def onDocumentRestored(self, obj):
        """Called when a document was opened."""
        self.complete(obj)

    def execute(self, obj):
        """Called when the part or a property has changed."""
        if obj.Signature and obj.HeldPart is not None:
            try:
                same = signature(shape_of(obj.HeldPart)) == obj.Signature
            except Refusal as refusal:
                obj.State = str(refusal)
                return
            if not same and obj.State != CHANGED:
                obj.State = CHANGED
                App.Console.PrintWarning("{}: {}\n".format(obj.Label, CHANGED))

    # Nothing is kept besides the properties; older versions of FreeCAD ask by the first two names.
    def __getstate__(self):
        return None

    def __setstate__(self, state):
        return None

    dumps, loads = __getstate__, __setstate__


def make(document, part, up="z", toolkit="plate-20mm", name="Fixture"):
    """Adds the object for a part; nothing is searched yet."""
    obj = document.addObject("App::DocumentObjectGroupPython", name)
    Fixture(obj)
    obj.HeldPart, obj.Up, obj.Toolkit = part, up, toolkit
    obj.Best, obj.Chosen, obj.State = 20, 1, "Not designed yet."
    if App.GuiUp:
        from .commands import FixtureView

        FixtureView(obj.ViewObject)
    return obj


def fixture_of(objects):
    """The fixture among selected objects, or that holds one of them; None if there is none."""
    for obj in objects:
        for one in (obj, *obj.InListRecursive):
            if isinstance(getattr(one, "Proxy", None), Fixture):
                return one
    return None


def asked(obj, path, shape):
    """The order of a design that the object's properties make."""
    order = {
        "part": str(path),
        "name": obj.HeldPart.Label,
        "axis": obj.Up,
        "peg_height": obj.PegHeight.Value if obj.PegHeight.Value > 0 else None,
        "toolkit": obj.Toolkit,
        "best": obj.Best,
        "avoid": face_places(path, shape, obj.Avoid),
        "only": face_places(path, shape, obj.Only),
        "supports": obj.Supports,
    }
    if obj.Program:
        if obj.Up != "z":
            raise Refusal("A program of a job is written with z up: choose z, or leave the program out.")
        # A job's zero is the document's origin, in height too.
        order.update(program=obj.Program, tools=obj.Tools or None, z_zero=0.0 - foot_height(shape, obj.Up))
    return order


def design(obj, cancel=None, wait=None, pictures=False):
    """Searches for fixtures, and puts the one that was chosen before, or else the first, into the document.

    All of it is one process of the command, which reads the part once.

    Parameters
    ----------
    cancel, wait : as of :func:`workhold_workbench.child.run`.
    pictures : whether the first choices and the one that is put in are drawn, too.

    Returns
    -------
    A sentence: what was found, or why the fixture is none any more.

    Raises
    ------
    Refusal
        For a part or a wish that cannot be used, and a search that was stopped before it had found anything.
    """
    if obj.HeldPart is None:
        raise Refusal("The fixture holds no part: choose one.")
    held_by = "{} {}".format(obj.Toolkit, obj.Up)
    marks = obj.Marks if obj.HeldBy == held_by else ""
    shape = shape_of(obj.HeldPart)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        order = asked(obj, export(shape, folder, obj.HeldPart.Label), shape)
        seen = ordered(folder, cancel, wait, marks=marks, pictures=pictures, **order)
        found = (folder / RESULT).read_text(encoding="utf-8")
        count = len(json.loads(found)["fixtures"])
        if not count and not seen["complete"]:
            raise Refusal(STOPPED)
        obj.ResultText, obj.Paged = found, 0
        keep_thumbnails(obj, folder, seen["first"])
        gone = LOST_BY_WISH if signature(shape) == obj.Signature else LOST
        obj.Signature, obj.HeldBy = signature(shape), held_by
        if not count:
            clear(obj)
            obj.Marks = marks
            obj.State = "No fixture. {}".format(" ".join(seen["notes"]) or "nothing holds the part.")
            return obj.State
        put_in(obj, shape, seen, folder)
    if marks and not seen["found"]:
        lower = gone if seen["lower"] is None else "it is number {} now".format(seen["lower"])
        obj.State = (
            "The fixture that was chosen is not among the best {} any more: {}. "
            "The first of them is put in its place: {}.".format(count, lower, " ".join(seen["holes"]))
        )
    if not seen["complete"]:
        obj.State += " The search was stopped before its end: there may be better ones."
    return obj.State


def rows(obj):
    """The list: for each fixture its rank and its figures by name."""
    if not obj.ResultText:
        return []
    found = json.loads(obj.ResultText)["fixtures"]
    rows = []
    for rank, one in enumerate(found, 1):
        near = one.get("program_clearance")
        passing = (
            {}
            if near is None
            else {"program_clearance": near["distance"] if isinstance(near, dict) else near}
        )
        rows.append({"rank": rank, "type": one["type"], **one["quality"], **passing})
    return rows


def choose(obj, rank):
    """Puts a fixture of the list into the document as bodies, about the part.

    Raises
    ------
    Refusal
        For a rank that is not in the list.
    """
    if not 1 <= rank <= len(rows(obj)):
        raise Refusal("There is no fixture {} in the list: design first.".format(rank))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / RESULT).write_text(obj.ResultText, encoding="utf-8")
        seen = ordered(folder, chosen=rank, supports=obj.Supports)
        put_in(obj, shape_of(obj.HeldPart), seen, folder)


def put_in(obj, shape, seen, folder):
    """Puts the fixture that the command has answered into the document as bodies, about the part."""
    clear(obj)
    place = placing(shape, obj.Up, seen["pose"])
    for name, body in solids_of(seen["bodies"]):
        body.Placement = place.multiply(body.Placement)
        add_body(obj, name, body)
    obj.Chosen, obj.Marks = seen["rank"], seen["marks"]
    note = " {}".format(seen["note"]) if seen["note"] else ""
    obj.State = "Fixture {} of {}.{}".format(seen["rank"], len(rows(obj)), note)
    page = folder / PAGE
    if page.exists():
        obj.Page, obj.Paged = str(page), seen["rank"]
    obj.purgeTouched()


def add_body(obj, name, shape):
    """Adds a body to the group, under its name, or with the fixture's where another fixture has one of that name.

    FreeCAD would make them differ by a number, and A2001 is not a hole.
    """
    taken = obj.Document.getObjectsByLabel(name)
    body = obj.Document.addObject("Part::Feature", "Body")
    body.Label = "{} of {}".format(name, obj.Label) if taken else name
    body.Shape = shape
    obj.addObject(body)
    if App.GuiUp:
        what = name.split()[0]
        paint(body.ViewObject, COLOURS.get(what, PLATE), 0 if what in COLOURS else SEEN_THROUGH)
    body.purgeTouched()


def clear(obj):
    """Takes all bodies out of the group and the document."""
    for body in list(obj.Group):
        obj.Document.removeObject(body.Name)


def with_result(obj, work):
    """Calls a function with the path of the result, written into a folder for the time."""
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "result.json"
        result.write_text(obj.ResultText, encoding="utf-8")
        return work(result)


def save_sheet(obj, path):
    """Writes the setup sheet of the chosen fixture: a .pdf, .svg, .png, .dxf, .step or .csv.

    Raises
    ------
    Refusal
        When it cannot be written.
    """
    words = ("sheet", "-o", path, "--force")
    supports = (
        ["--supports"] if obj.Supports and any(one.Label.startswith("support") for one in obj.Group) else []
    )
    with_result(obj, lambda result: run(*words, result, obj.Chosen, *supports))


def save_picture(obj, rank, path):
    """Draws a fixture of the list into a .png or .svg."""
    with_result(obj, lambda result: run("show", result, rank, "--draw", path, "--force"))
