"""The Workhold workbench of FreeCAD: its name, its icon and its commands."""

import FreeCADGui as Gui


class WorkholdWorkbench(Gui.Workbench):
    """Commands that design a fixture for a body, and keep it when the body changes."""

    MenuText = "Workhold"
    ToolTip = "Find every way to hold a part, and put the chosen one into the document"

    def __init__(self):
        from pathlib import Path

        import workhold_workbench

        folder = Path(workhold_workbench.__file__).resolve().parent.parent
        self.__class__.Icon = str(folder / "resources" / "workhold.svg")

    def Initialize(self):
        """Registers the commands; FreeCAD calls it when the workbench is first chosen."""
        from workhold_workbench import commands

        names = commands.register()
        self.appendToolbar("Workhold", names)
        self.appendMenu("Workhold", names)

    def GetClassName(self):
        """The kind of a workbench that is written in Python."""
        return "Gui::PythonWorkbench"


Gui.addWorkbench(WorkholdWorkbench())
