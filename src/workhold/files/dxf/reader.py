"""DXF drawings, from bytes to chains in mm.

The library ezdxf reads the file; the geometry is computed here, exactly and without approximation by Béziers.

Glossary
--------
hidden layer : frozen, switched off, or Defpoints, which is never printed. Read only when named.
label : entity kind and handle (the hexadecimal name that every CAD program shows), then the INSERTs that
    placed it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import islice
from math import isfinite
from pathlib import Path
from typing import Any

from attrs import evolve

from workhold.errors import InputError, make_printable, shorten_middle
from workhold.files.budget import LIMITS, Budget
from workhold.files.dxf.walk import BlockNesting, DxfWalk
from workhold.files.outline.chain import Drawing, Placement
from workhold.files.outline.diagnostics import make_unit_question
from workhold.files.questions import DRAWING_UNIT
from workhold.limits import read_number
from workhold.units import find_unit

__all__ = ["normalize_unit_code", "read_document", "read_dxf"]

# $INSUNITS (DXF reference, header variables): name and millimetres.
INSUNITS = {
    1: ("inch", 25.4),
    2: ("feet", 304.8),
    4: ("mm", 1.0),
    5: ("cm", 10.0),
    6: ("m", 1000.0),
    8: ("microinches", 25.4e-6),
    9: ("mils", 25.4e-3),
    10: ("yards", 914.4),
    13: ("microns", 1e-3),
    14: ("decimetres", 100.0),
    21: ("US survey feet", 1200e3 / 3937),
    22: ("US survey inches", 100e3 / 3937),
}


BINARY = b"AutoCAD Binary DXF"


def read_dxf(
    path: Path,
    content: bytes,
    *,
    unit: str | None,
    usual_unit: str | None = None,
    layers: Sequence[str] | None,
    fit: float | None = None,
    budget: Budget | None = None,
) -> Drawing:
    """Return the drawing, in mm, of the outline entities of a DXF file's model space.

    Parameters
    ----------
    path : the file, which ezdxf opens by itself.
    content : its bytes.
    unit : overrides the file's unit.
    usual_unit : the unit of a file that does not give one.
    layers : layers to read; all visible ones when None.
    fit : largest distance in mm of lines and arcs from true curves; with None such curves are replaced
        provisionally, see ``Drawing``.
    budget : work and time that may still be spent on the file; None gives the usual budget for a file of this
        size.

    Raises
    ------
    InputError
        For files that are not DXF or damaged, unknown units, unknown layers, and entities that are refused.
    """
    refuse_other_formats(content)
    budget = budget or Budget(LIMITS["dxf"], len(content))
    refuse_crowded(content, budget)
    document, remarks = open_document(path)
    budget.check_time()
    code = read_unit_code(document, content)
    drawing = read_document(
        document, code, unit=unit, usual_unit=usual_unit, layers=layers, fit=fit, budget=budget
    )
    return evolve(drawing, remarks=(*remarks, *drawing.remarks))


def read_document(
    document: Any,
    code: int | str,
    *,
    unit: str | None,
    usual_unit: str | None = None,
    layers: Sequence[str] | None,
    fit: float | None = None,
    budget: Budget | None = None,
) -> Drawing:
    """Return the drawing, in mm, of the model space of a document of ezdxf; see :func:`read_dxf`.

    ``code`` is the document's ``$INSUNITS``. Raises UnitAskedError when neither ``code`` nor an argument
    gives a unit.
    """
    known = choose_scale(code, unit, usual_unit)
    scale, unit_remarks = known or (1.0, [])
    try:
        walk = DxfWalk(document, layers, fit, budget or Budget(LIMITS["dxf"]))
        space = document.modelspace()
    except Exception as error:  # tables and layouts of a damaged file may fail in any way
        raise make_damage_error(error) from error
    try:
        walk.visit_all(space, BlockNesting(Placement(a=scale, d=scale, height_scale=scale)))
        walk.refuse_missing_layers()
    except InputError:
        if known is not None:
            raise
        walk.chains = []
    if known is None:
        lacking = (
            f"is not one for parts ($INSUNITS {shorten_middle(make_printable(str(code)), 40)})"
            if code
            else "is not said"
        )
        raise make_unit_question(f"the drawing's unit {lacking}", walk.chains)
    remarks = (*unit_remarks, *walk.list_remarks())
    return Drawing(tuple(walk.chains), remarks, walk.curves.found, walk.layers, looks=walk.looks)


def refuse_other_formats(content: bytes) -> None:
    """Raise InputError for bytes that are not DXF or are cut short, so
    that ezdxf does not try to repair them.
    """
    if content[:4] == b"AC10" or content[:2] == b"MC":
        raise InputError("this is a DWG drawing, not a DXF file: save it as DXF.")
    if content.startswith(BINARY):
        return
    if b"SECTION" not in content[:65536]:
        raise InputError("this is not a DXF file: export the part's outline as DXF.")
    if not content[-4096:].rstrip(b" \t\r\n\x00\x1a").endswith(b"EOF") and b"\nEOF" not in content[-65536:]:
        raise InputError("the DXF file is cut short (it has no end mark): export or copy it again.")


def open_document(path: Path) -> tuple[Any, list[str]]:
    """Return the ezdxf document, and a list with a remark if the file had to be repaired.

    Raises InputError for a file beyond repair.
    """
    from ezdxf import recover
    from ezdxf.filemanagement import readfile

    try:
        return readfile(path), []
    except Exception as first:  # a damaged file may fail anywhere inside
        try:
            document, _ = recover.readfile(path)
        except Exception:
            raise make_damage_error(first) from first
        return document, [
            f"The DXF file was damaged and had to be repaired ({shorten_to_one_line(first)}); check the outline."
        ]


def make_damage_error(error: Exception) -> InputError:
    """Return an InputError for a file that the library cannot read, with the library's error in it."""
    reason = "it has no model space" if isinstance(error, KeyError) else shorten_to_one_line(error)
    return InputError(f"the DXF file is damaged ({reason}): open it in a CAD program and export it again.")


# What a text file says its unit is.
INSUNITS_WRITTEN = re.compile(rb"\$INSUNITS[ \t]*\r?\n[ \t]*70[ \t]*\r?\n([^\r\n]*)")
# Where an entity, a vertex of an old polyline or an entry of a table begins.
BEGINS = re.compile(rb"\n[ \t]*0[ \t]*\r?\n[ \t]*[A-Z]")
# Bytes of a file that has too few entities to be worth a look, and of each tag of a binary one.
FEW_BYTES, TAG_BYTES = 1_000_000, 10
# Tags (a group code and its value) for each entity and vertex that a drawing may have: few have more than ten.
MOST_TAGS = 15


def refuse_crowded(content: bytes, budget: Budget) -> None:
    """Raise OverBudgetError for a file with more entities than the budget
    allows, so that the library does not read it.

    The budget itself is not spent.
    """
    most = budget.limits.most_elements
    if most is None or len(content) <= FEW_BYTES:
        return
    is_binary = content.startswith(BINARY)
    tags = len(content) // TAG_BYTES if is_binary else content.count(b"\n") // 2
    found = 0 if is_binary else sum(1 for _ in islice(BEGINS.finditer(content), most + 1))
    Budget(budget.limits).spend(max(found, tags // MOST_TAGS))


def shorten_to_one_line(error: Exception) -> str:
    """Return an error's text on one line, cut to 120 characters and without a full stop."""
    text = " ".join(str(error).split()) or type(error).__name__
    return text[:120].rstrip(".")


def read_unit_code(document: Any, content: bytes) -> int | str:
    """Return the ``$INSUNITS`` of a document: a whole
    number, text if it is not one, 0 where the file has none.
    """
    if written := INSUNITS_WRITTEN.search(content):
        # Of a number that is none the library's repair takes the digits with which it begins.
        return normalize_unit_code(written[1].decode("ascii", "replace").strip())
    # Into a file without a header ezdxf writes one of its own, with metres in it.
    return normalize_unit_code(document.header.get("$INSUNITS", 0)) if b"$INSUNITS" in content else 0


def normalize_unit_code(value: Any) -> int | str:
    """Return a value of ``$INSUNITS`` as an int, or as text if it is not a whole number."""
    number = read_number(value)
    return int(number) if isfinite(number) and number == int(number) else str(value)


def choose_scale(code: int | str, unit: str | None, usual_unit: str | None) -> tuple[float, list[str]] | None:
    """Return the millimetres per drawing unit, and a list with a remark if the user's unit differs from the
    file's, otherwise an empty list.

    None when neither the file nor the user gives a unit.

    Parameters
    ----------
    code : the file's ``$INSUNITS``.
    unit : overrides the file's unit.
    usual_unit : used where the file has none.
    """
    name, scale = INSUNITS.get(code, ("", None)) if isinstance(code, int) else ("", None)
    asked = unit if unit is not None or scale is not None else usual_unit
    if asked is not None:
        millimetres = find_unit(asked).millimetres
        differs = scale is not None and scale != millimetres
        said = f"The file says its unit is {name}; it was read in {unit} as asked."
        return millimetres, [said] if differs else []
    if scale is None:
        return None
    if usual_unit is not None and scale != find_unit(usual_unit).millimetres:
        # Whoever gave the unit for the drawing's sake learns here that it did not count.
        return scale, [f"The file says its unit is {name}; it was read so ({DRAWING_UNIT} overrides it)."]
    return scale, []
