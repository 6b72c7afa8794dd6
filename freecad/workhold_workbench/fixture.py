"""The fixture of a part as an object of the document: what was asked, what was found, and its bodies.

The object is a group. Its properties say what was asked; the result of the search stands in it as text, so a
document that is opened elsewhere still has its fixture. When the part changes, the object says so, and a new
design finds the same fixture again or says why it is none any more.
"""

import json
import re
import tempfile
from pathlib import Path

import FreeCAD as App
import Part

from .child import Refusal, answer, run
from .compat import paint
from .recognition import marks_of, rank_in
from .solid import export, face_numbers, foot_height, placing, shape_of, signature
from .thumbnails import MOST_DRAWN, keep_thumbnails

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
# The uses of bodies in a STEP assembly, in their order, with their names.
USES = re.compile(r"NEXT_ASSEMBLY_USAGE_OCCURRENCE\('\d+','((?:[^']|'')*)'")
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
    ("App::PropertyString", "Toolkit", "Fixture", "A name of workhold's toolkits, or a TOML file"),
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
)
HIDDEN = tuple(name for _, name, group, _ in PROPERTIES if group == "Hidden")
AXIS_NAMES = ["z", "-z", "x", "-x", "y", "-y"]
# How far down the list a fixture that was chosen before is looked for.
MOST_SEARCHED = 5000
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
    """The words of the command that the object's properties make."""
    reading = ["--peg-height={:.6f}mm".format(obj.PegHeight.Value)] if obj.PegHeight.Value > 0 else []
    words = ["--axis=" + obj.Up, *reading, "--toolkit", obj.Toolkit]
    avoided = set()
    if obj.Avoid:
        avoided |= set(face_numbers(path, shape, obj.Avoid, obj.Up, reading)[0])
    if obj.Only:
        only, every = face_numbers(path, shape, obj.Only, obj.Up, reading)
        avoided |= set(every) - set(only)
    if avoided:
        words += ["--avoid", ",".join(map(str, sorted(avoided)))]
    if obj.Program:
        if obj.Up != "z":
            raise Refusal("A program of a job is written with z up: choose z, or leave the program out.")
        # A job's zero is the document's origin, in height too.
        zero = "--z-zero={:.6f}mm".format(0.0 - foot_height(shape, obj.Up))
        words += ["--program", obj.Program, zero, *(["--tools", obj.Tools] if obj.Tools else [])]
    return words


def design(obj, cancel=None, wait=None, pictures=False):
    """Searches for fixtures, and puts the one that was chosen before, or else the first, into the document.

    Parameters
    ----------
    cancel, wait : as of :func:`workhold_workbench.child.run`.
    pictures : whether the first choices are drawn, too.

    Returns
    -------
    A sentence: what was found, or why the fixture is none any more.

    Raises
    ------
    Refusal
        For a part or a wish that cannot be used.
    """
    if obj.HeldPart is None:
        raise Refusal("The fixture holds no part: choose one.")
    held_by = "{} {}".format(obj.Toolkit, obj.Up)
    marks = obj.Marks if obj.HeldBy == held_by else ""
    shape = shape_of(obj.HeldPart)
    lost = ""
    with tempfile.TemporaryDirectory() as folder:
        path = export(shape, folder, obj.HeldPart.Label)
        result = Path(folder) / "result.json"
        words = asked(obj, path, shape)
        drawing = ("--list", MOST_DRAWN, "--draw", folder) if pictures else ()
        wanted = (*words, "--best", obj.Best, "--out", result, *drawing)
        seen = answer("design", path, *wanted, cancel=cancel, wait=wait)
        obj.ResultText = result.read_text(encoding="utf-8")
        keep_thumbnails(obj, Path(folder), seen["fixtures"])
        fixtures = json.loads(obj.ResultText)["fixtures"]
        rank = rank_in(fixtures, marks) if marks else None
        if marks and fixtures and rank is None:
            more = ("--best", MOST_SEARCHED, "--out", result, "--force")
            answer("design", path, *words, *more, cancel=cancel, wait=wait)
            lower = rank_in(json.loads(result.read_text(encoding="utf-8"))["fixtures"], marks)
            gone = LOST_BY_WISH if signature(shape) == obj.Signature else LOST
            lost = gone if lower is None else "it is number {} now".format(lower)
    obj.Signature, obj.HeldBy = signature(shape), held_by
    if not fixtures:
        clear(obj)
        obj.Marks = marks
        obj.State = "No fixture. {}".format(" ".join(seen["notes"]) or "nothing holds the part.")
        return obj.State
    choose(obj, rank or 1)
    if lost:
        names = " ".join(peg["hole"] for peg in seen["fixtures"][0]["pegs"])
        obj.State = (
            "The fixture that was chosen is not among the best {} any more: {}. "
            "The first of them is put in its place: {}.".format(len(fixtures), lost, names)
        )
    if not json.loads(obj.ResultText)["complete"]:
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
    fixtures = json.loads(obj.ResultText)["fixtures"] if obj.ResultText else []
    if not 1 <= rank <= len(fixtures):
        raise Refusal("There is no fixture {} in the list: design first.".format(rank))
    shape = shape_of(obj.HeldPart)
    chosen = fixtures[rank - 1]
    with tempfile.TemporaryDirectory() as folder:
        result, assembly = Path(folder) / "result.json", Path(folder) / "setup.step"
        result.write_text(obj.ResultText, encoding="utf-8")
        note = ""
        if obj.Supports:
            try:
                run("supports", result, rank, "--step", assembly)
            except Refusal as refusal:
                note = " {}".format(refusal)
        if not assembly.exists():
            run("sheet", result, rank, "-o", assembly)
        bodies = read_bodies(assembly)
    clear(obj)
    dx, dy = moved_on(chosen["pegs"], bodies)
    pose = {**chosen["pose"], "x": chosen["pose"]["x"] + dx, "y": chosen["pose"]["y"] + dy}
    place = placing(shape, obj.Up, pose)
    # The first body is the part as a prism; the document has the part itself.
    for name, body in bodies[1:]:
        body.Placement = place.multiply(body.Placement)
        add_body(obj, name, body)
    obj.Chosen, obj.Marks = rank, marks_of(chosen)
    obj.State = "Fixture {} of {}.{}".format(rank, len(fixtures), note)
    obj.purgeTouched()


def moved_on(pegs, bodies):
    """How far in mm the set-up of an assembly stands from that of the list, along x and y of the toolkit.

    With supports all may stand a few holes further on, so that each hole is there.
    """
    peg = next((one for one in pegs if "column" in one and "row" in one), None)
    body = next((body for name, body in bodies if name.startswith(("peg ", "locator "))), None)
    if peg is None or body is None:
        return 0.0, 0.0
    center = body.BoundBox.Center
    # In whole micrometres: a box of a round body is a little off.
    return round(center.x - peg["x"], 3), round(center.y - peg["y"], 3)


def read_bodies(path):
    """The solids of an assembly with their names, in the order of the file."""
    shape = Part.Shape()
    shape.read(str(path))
    names = USES.findall(path.read_text(encoding="utf-8"))
    return list(zip(names, shape.Solids))


def add_body(obj, name, shape):
    """Adds a body to the group, under its name, or with the fixture's where another fixture has one of that name.

    FreeCAD would make them differ by a number, and A2001 is no hole.
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
