"""What differs between the versions of FreeCAD, in one place: from 0.20 with PySide2 to 1.1 with PySide6.

- FreeCAD 1.0 calls the Path workbench CAM, and its modules lie in the package ``Path`` (``Path.Main.Job``).
- FreeCAD 1.0 keeps the colour of a body in a list of materials, ``ShapeAppearance``.
- PySide6 has buttons that are not numbers; FreeCAD's module ``PySide`` stands for either.
- The file that a job was post-processed into may be named by its property of the last output only.
"""

import importlib
from pathlib import Path

from .child import Refusal

__all__ = ["button_number", "job_module", "paint", "program_of"]

# Where the module that makes jobs has been, the newest first.
JOB_MODULES = ("Path.Main.Job", "PathScripts.PathJob")


def job_module():
    """The module that makes jobs.

    Raises
    ------
    Refusal
        When this FreeCAD has none.
    """
    for name in JOB_MODULES:
        try:
            return importlib.import_module(name)
        except ImportError:
            continue
    raise Refusal("This FreeCAD has no CAM workbench: install the one that belongs to it.")


def button_number(button):
    """The number of a standard button, as FreeCAD wants it of a panel."""
    return getattr(button, "value", None) or int(button)


def paint(view, colour, transparency=0):
    """Gives a body its colour, red, green and blue from 0 to 1, and its transparency in per cent."""
    if hasattr(view, "ShapeAppearance"):
        material = view.ShapeAppearance[0]
        material.DiffuseColor = colour
        view.ShapeAppearance = (material,)
    else:
        view.ShapeColor = colour
    view.Transparency = transparency


def program_of(job):
    """The path of the one file that a job was post-processed into.

    Raises
    ------
    Refusal
        Where there is none, and where there are several.
    """
    # The first may still hold the pattern of a name, such as %D/%d.nc.
    for words in (job.PostProcessorOutputFile, getattr(job, "LastPostProcessOutput", "")):
        paths = [path.strip() for path in (words or "").splitlines() if path.strip()]
        there = [path for path in paths if Path(path).is_file()]
        if len(there) > 1:
            raise Refusal(
                "{} was post-processed into {} files: switch the splitting of its output off, and "
                "post-process it again.".format(job.Label, len(there))
            )
        if there:
            return there[0]
    raise Refusal(
        "{} has no file with G-code yet: post-process it, and choose the command again.".format(job.Label)
    )
