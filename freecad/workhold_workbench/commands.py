"""The commands of the workbench, and how a fixture shows itself in the tree."""

from pathlib import Path

import FreeCAD as App
import FreeCADGui as Gui
from PySide import QtCore, QtGui

from . import cam, child, fixture
from .solid import axis_of_face, body_of, shape_of

__all__ = ["FixtureView", "register", "shown_panel"]

ICON = str(Path(__file__).resolve().parent.parent / "resources" / "workhold.svg")


class FixtureView:
    """How a fixture shows itself: its icon, and its panel on a double click."""

    def __init__(self, view):
        view.Proxy = self

    def getIcon(self):
        """The icon in the tree."""
        return ICON

    def doubleClicked(self, view):
        """Opens the panel."""
        open_panel(view.Object)
        return True

    def __getstate__(self):
        return None

    def __setstate__(self, state):
        return None

    dumps, loads = __getstate__, __setstate__


SHOWN = []


def open_panel(obj):
    """Opens the task panel of a fixture."""
    from .panel import Panel

    Gui.Control.closeDialog()
    SHOWN[:] = [Panel(obj)]
    Gui.Control.showDialog(SHOWN[0])


def shown_panel():
    """The panel that was opened last; None before."""
    return SHOWN[0] if SHOWN else None


def say(sentence):
    """Shows a sentence in a window, and in the report."""
    App.Console.PrintWarning(sentence + "\n")
    QtGui.QMessageBox.information(Gui.getMainWindow(), "Workhold", sentence)


def selected_part():
    """The selected body and the axis of the document that its selected face looks along, else z.

    Raises
    ------
    Refusal
        Where nothing usable is selected.
    """
    for chosen in Gui.Selection.getSelectionEx():
        if getattr(chosen.Object, "Shape", None) is not None and chosen.Object.Shape.Solids:
            part = body_of(chosen.Object)
            faces = [name for name in chosen.SubElementNames if name.startswith("Face")]
            up = axis_of_face(shape_of(part).getElement(faces[0])) if faces else "z"
            return part, up
    raise child.Refusal("Select a body, or the face of it that lies up, and choose the command again.")


class Command:
    """A command of the toolbar: words, and what it does."""

    words, tip, icon = "", "", ICON
    needs_fixture = True

    def GetResources(self):
        """What FreeCAD shows of it."""
        return {"Pixmap": self.icon, "MenuText": self.words, "ToolTip": self.tip}

    def IsActive(self):
        """Whether it can be chosen."""
        if not App.ActiveDocument:
            return False
        return not self.needs_fixture or fixture.fixture_of(Gui.Selection.getSelection()) is not None

    def Activated(self):
        """Does it, and says why where it cannot be done."""
        try:
            self.act(fixture.fixture_of(Gui.Selection.getSelection()))
        except child.Refusal as refusal:
            say(str(refusal))


class Design(Command):
    """Adds a fixture for the selected body and opens its panel."""

    words = QtCore.QT_TRANSLATE_NOOP("Workhold", "Design fixture")
    tip = QtCore.QT_TRANSLATE_NOOP(
        "Workhold", "Find every way to hold the selected body; its selected face lies up"
    )
    needs_fixture = False

    def act(self, obj):
        """Opens the panel of the selected fixture, or of a new one for the selected body."""
        if obj is None:
            part, up = selected_part()
            App.ActiveDocument.openTransaction("Fixture")
            obj = fixture.make(App.ActiveDocument, part, up)
            App.ActiveDocument.commitTransaction()
        open_panel(obj)


class Redesign(Command):
    """Designs again after the part has changed."""

    words = QtCore.QT_TRANSLATE_NOOP("Workhold", "Redesign")
    tip = QtCore.QT_TRANSLATE_NOOP("Workhold", "Find the chosen fixture again for the part as it is now")
    icon = "view-refresh"

    def act(self, obj):
        """Designs, and says what came of it."""
        say(fixture.design(obj, wait=QtGui.QApplication.processEvents))


class SendToCam(Command):
    """Puts the fixture's bodies beside a Path job, and takes its program along."""

    words = QtCore.QT_TRANSLATE_NOOP("Workhold", "Send to CAM")
    tip = QtCore.QT_TRANSLATE_NOOP("Workhold", "Make a job of the part with the fixture's bodies beside it")
    icon = "document-save-as"

    def act(self, obj):
        """Makes the job."""
        say(cam.send(obj))


class TakeProgram(Command):
    """Takes the G-code of the part's job as the program that tools must pass with."""

    words = QtCore.QT_TRANSLATE_NOOP("Workhold", "Take the job's program")
    tip = QtCore.QT_TRANSLATE_NOOP(
        "Workhold", "Design again so that the tools of the job's program pass everything"
    )
    icon = "document-open"

    def act(self, obj):
        """Takes the program and designs again."""
        say(cam.take_program(obj))


class Sheet(Command):
    """Writes the setup sheet."""

    words = QtCore.QT_TRANSLATE_NOOP("Workhold", "Setup sheet")
    tip = QtCore.QT_TRANSLATE_NOOP("Workhold", "Write the setup sheet of the fixture as a PDF")
    icon = "document-print"

    def act(self, obj):
        """Asks for a path and writes it."""
        path, _ = QtGui.QFileDialog.getSaveFileName(
            Gui.getMainWindow(), "Setup sheet", "{}.pdf".format(obj.Label), "PDF (*.pdf)"
        )
        if path:
            fixture.save_sheet(obj, path)


class Environment(Command):
    """Chooses the Python environment that has workhold."""

    words = QtCore.QT_TRANSLATE_NOOP("Workhold", "Environment ...")
    tip = QtCore.QT_TRANSLATE_NOOP(
        "Workhold", "Choose the command workhold, or the folder of the environment with it"
    )
    icon = "preferences-system"
    needs_fixture = False

    def IsActive(self):
        """Always, as it is needed first."""
        return True

    def act(self, obj):
        """Asks for it."""
        path, _ = QtGui.QFileDialog.getOpenFileName(Gui.getMainWindow(), "The command workhold")
        if path:
            used = child.use(path)
            said = child.run("--version").strip()
            if not said.startswith("workhold"):
                child.forget()
                raise child.Refusal(
                    "{} is not workhold: choose the file workhold of an environment that has it.".format(used)
                )
            say("{} answers from {}.".format(said, used))


COMMANDS = (Design, Redesign, SendToCam, TakeProgram, Sheet, Environment)


def register():
    """Registers the commands and returns their names."""
    names = []
    for kind in COMMANDS:
        names.append("Workhold_" + kind.__name__)
        Gui.addCommand(names[-1], kind())
    return names
