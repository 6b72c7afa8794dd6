"""Open CASCADE (OCCT), the library that reads and writes STEP files: loaded only when one is read or written.

It is the package ``OCP`` of the distribution that the extra ``step`` asks for, which links to the system's
libGL and libX11.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, TypeVar

from workhold.errors import InputError

__all__ = [
    "AXES",
    "REQUIREMENT",
    "turn_axis_up",
    "check_axis_name",
    "compute_bounding_box",
    "read_guarded",
    "load_step_library",
    "occ",
    "raise_shape",
    "list_sub_shapes",
    "turn_along",
]

T = TypeVar("T")
# What becomes x, y and up for each axis: the part is seen from the axis's far end, right-handed.
AXES = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}
# A point: x, y and z in mm.
Corner = tuple[float, float, float]

# What the extra asks for; nobody else's distribution can be had by its name.
REQUIREMENT = "cadquery-ocp-novtk>=8"

# Debian's packages of the shared libraries that the wheel expects from the system.
SYSTEM_PACKAGES = {"libGL.so.1": "libgl1", "libX11.so.6": "libx11-6"}


class OpenCascade:
    """The library's names as attributes, imported when they are first asked for, as ``occ.gp_Pnt``.

    The part of a name before its first underscore is the package of ``OCP`` that has it.
    """

    def __getattr__(self, name: str) -> Any:
        # Doctest asks every object for ``__wrapped__``, also where the library is not installed.
        if name.startswith("_"):
            raise AttributeError(name)
        import OCP

        found = getattr(getattr(OCP, name.partition("_")[0]), name)
        setattr(self, name, found)
        return found


occ = OpenCascade()


def load_step_library() -> None:
    """Load Open CASCADE and keep it from writing its progress to the terminal, where a result file may go.

    Raises
    ------
    InputError
        When the extra is not installed, or a system library that it needs is missing; with the remedy.
    """
    try:
        from OCP.Message import Message
    except ImportError as error:
        raise InputError(explain_missing_library(error)) from error
    Message.DefaultMessenger_s().ChangePrinters().Clear()


def explain_missing_library(error: ImportError) -> str:
    """Return a sentence on why the library cannot be imported, with the remedy."""
    if isinstance(error, ModuleNotFoundError):
        return f"STEP files need a library that is not installed: pip install '{REQUIREMENT}'."
    missing = re.match(r"(lib\S+?\.so[.\d]*): cannot open shared object file", str(error))
    if missing:
        name = missing[1]
        package = SYSTEM_PACKAGES.get(name, " ".join(SYSTEM_PACKAGES.values()))
        return f"STEP files need the system library {name}, which is missing: apt install {package}."
    why = " ".join(str(error).split())[:160].rstrip(".")
    return (
        f"the library for STEP files cannot be loaded ({why}): pip install --force-reinstall '{REQUIREMENT}'."
    )


def read_guarded(read: Callable[[], T], *further: type[Exception]) -> T:
    """Return the result of ``read()``; raise InputError if the library, or
    later arithmetic, fails because of a damaged file.

    ``further`` are more exception types that count as such failures. All other exceptions, and InputError,
    pass unchanged.
    """
    try:
        return read()
    except InputError:
        raise
    except Exception as error:
        damaged = isinstance(error, ArithmeticError | LookupError | RuntimeError | TypeError)
        if not (damaged or isinstance(error, further)) and not type(error).__module__.startswith("OCP"):
            raise
        raise InputError("the STEP file is damaged: open it in a CAD program and export it again.") from error


def list_sub_shapes(shape: Any, kind: str) -> list[Any]:
    """Return the sub-shapes of one kind of a shape in the library's order, each as often as it is used.

    Parameters
    ----------
    kind : "SOLID", "FACE", "WIRE", "EDGE" or "VERTEX".
    """
    cast = getattr(occ.TopoDS, kind.capitalize())
    explorer = occ.TopExp_Explorer(shape, getattr(occ, f"TopAbs_{kind}"))
    found = []
    while explorer.More():
        found.append(cast(explorer.Current()))
        explorer.Next()
    return found


def compute_bounding_box(shape: Any) -> tuple[Corner, Corner]:
    """Return the least and the greatest corner (x, y, z) of
    a shape's bounding box in mm, without a tolerance added.
    """
    box = occ.Bnd_Box()
    occ.BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    return (low.X(), low.Y(), low.Z()), (high.X(), high.Y(), high.Z())


def raise_shape(shape: Any, height: float) -> Any:
    """Return a shape moved up by a height in mm."""
    move = occ.gp_Trsf()
    move.SetTranslation(occ.gp_Vec(0.0, 0.0, height))
    return shape.Moved(occ.TopLoc_Location(move))


def check_axis_name(axis: str | None) -> str:
    """Return the name of an axis in lower case, without "+"; "z" for None.

    Raises
    ------
    InputError
        Unless the axis is x, y or z, with or without a sign.
    """
    name = "z" if axis is None else axis.strip().lower().removeprefix("+")
    if name.removeprefix("-") not in AXES:
        raise InputError(f"the axis '{name[:40]}' is not known: give x, y or z, or -x, -y or -z.")
    return name


def turn_axis_up(shape: Any, axis: str) -> Any:
    """Return a shape turned so that an axis of the file points up; see :func:`turn_along`."""
    return shape.Moved(occ.TopLoc_Location(turn_along(axis)))


def turn_along(axis: str) -> Any:
    """Return Open CASCADE's rotation that makes an axis of the file ("x" or "-x" …) point up.

    Coordinates only change places and signs. With a minus the part lies on its other side, turned over like a
    page: what pointed to x points to -x.
    """
    signs = (-1.0, 1.0, -1.0) if axis.startswith("-") else (1.0, 1.0, 1.0)
    sources = zip(signs, AXES[axis.lstrip("-")], strict=True)
    rows = [[sign if column == source else 0.0 for column in range(3)] + [0.0] for sign, source in sources]
    turn = occ.gp_Trsf()
    turn.SetValues(*rows[0], *rows[1], *rows[2])
    return turn
