"""A toolkit described in TOML: a preset of the program's own, or a file of the user's. All lengths come out in mm.

Glossary
--------
entry : a key of the file and its value.
fields : the keyword arguments of the toolkit's class that the file gives.
fit : limits of pin and hole and the position of the hole, from which the peg's tolerance follows.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from attrs import frozen

from workhold.errors import InputError
from workhold.files.text import read_text, toml_table
from workhold.files.toolkit.dowels import dowel_size
from workhold.fixels.fields import OPTIONS
from workhold.fixels.kinds import USUAL, kind_of, toolkit_of
from workhold.fixels.table import Form
from workhold.fixels.toolkit import Toolkit
from workhold.model.dowel import Fit, Limits, peg_error, refuse_limits
from workhold.model.tolerance import Tolerance
from workhold.units import Unit, unit_named

__all__ = ["LoadedToolkit", "described_toolkit", "read_toolkit_file"]

# Bytes; a toolkit takes a few hundred.
LARGEST_FILE = 1_000_000
# Where nobody says how well the holes are placed: what a tolerance is when nothing is said, see Tolerance.
ASSUMED_POSITION = Tolerance().peg


@frozen
class LoadedToolkit:
    """A toolkit as its file describes it.

    Parameters
    ----------
    name : the preset's name, or the file's.
    title : what it is, in a line; empty where the file gives none.
    source : where the figures are from; empty where the file does not say.
    unit : in which the file gives its lengths.
    kind : of toolkit, see ``fixels.kinds``.
    fields : keyword arguments of its class, in mm; those not in the file are left out.
    tolerance : of its pegs and of the faces they touch.
    fit : what the tolerance of the pegs follows from; None where the file gives no pin or hole.
    assumed : entries for which there is no source, as the file says.
    """

    name: str
    title: str
    source: str
    unit: Unit
    kind: str
    fields: dict[str, Any]
    tolerance: Tolerance
    fit: Fit | None
    assumed: tuple[str, ...] = ()

    @property
    def toolkit(self) -> Toolkit:
        """The toolkit with nothing changed."""
        return toolkit_of(self.kind, self.fields)


def read_toolkit_file(path: Path) -> LoadedToolkit:
    """The toolkit of a user's file.

    Raises
    ------
    InputError
        For a file that cannot be read or used, naming the entry.
    """
    from workhold.files.toolkit.form import checked

    try:
        return described_toolkit(path.stem, checked(toml_table(read_text(path, LARGEST_FILE, "a toolkit"))))
    except InputError as error:
        raise InputError(f"{path.name or path}: {error}") from error


def described_toolkit(name: str, entries: Mapping[str, Any]) -> LoadedToolkit:
    """The toolkit of a file's entries, which are of the right types.

    Raises
    ------
    InputError
        For values that no toolkit can have.
    """
    unit = unit_named(entries["unit"])
    if unit.name not in ("mm", "inch"):
        raise InputError('the unit of a toolkit is "mm" or "inch".')
    kind, said = kind_of(entries.get("kind", USUAL))
    given = {row.name: in_mm(row.form, entries[row.name], unit) for row in OPTIONS if row.name in entries}
    fields: dict[str, Any] = {**said, **given}
    toolkit_of(kind, fields)
    fit = fit_of(entries, unit, fields["peg_radius"])
    return LoadedToolkit(
        name=name,
        title=entries.get("title", ""),
        source=entries.get("source", ""),
        unit=unit,
        kind=kind,
        fields=fields,
        tolerance=tolerance_of(entries, unit, fit, fields["peg_radius"]),
        fit=fit,
        assumed=tuple(entries.get("assumed", ())),
    )


def in_mm(form: Form, value: Any, unit: Unit) -> Any:
    """Convert what an entry gives for a field to the constructor's argument, with lengths in mm."""
    if form in ("count", "directions"):
        return value
    if form == "holes":
        return tuple(value)
    lengths = tuple(map(unit.length, value if isinstance(value, list) else [value]))
    if form == "length":
        return lengths[0]
    return 2 * lengths if form == "pitch" and len(lengths) == 1 else lengths


def fit_of(entries: Mapping[str, Any], unit: Unit, peg_radius: float) -> Fit | None:
    """Pin and hole as the file gives them, or as the standard it names does; None when it gives neither.

    Raises
    ------
    InputError
        For one without the other, and for limits that are not those of the peg.
    """
    limits: dict[str, Limits | None] = {"pin_diameter": None, "hole_diameter": None}
    if "dowel" in entries:
        size = dowel_size(entries["dowel"], 2 * peg_radius)
        limits = {"pin_diameter": size.pin, "hole_diameter": size.hole}
    for key in limits:
        if key in entries:
            low, high = entries[key]
            limits[key] = (unit.length(low), unit.length(high))
    pin, hole = limits["pin_diameter"], limits["hole_diameter"]
    if pin is None and hole is None:
        if "hole_position" in entries:
            raise InputError(
                "hole_position is given without the pin: add dowel, or pin_diameter and hole_diameter, or give "
                "peg_tolerance alone."
            )
        return None
    if pin is None:
        raise InputError("hole_diameter is given without the pin: add pin_diameter or dowel.")
    if hole is None:
        raise InputError("the pin is given without its hole: add hole_diameter, smallest and largest.")
    refuse_limits("pin_diameter", pin, peg_radius)
    refuse_limits("hole_diameter", hole, peg_radius)
    position = entries.get("hole_position")
    if position is not None and position < 0:
        raise InputError(f"hole_position {position:g} is negative: give 0 or more.")
    length = ASSUMED_POSITION if position is None else unit.length(position)
    return Fit(pin, hole, length, position is None, entries.get("dowel", ""))


def tolerance_of(entries: Mapping[str, Any], unit: Unit, fit: Fit | None, peg_radius: float) -> Tolerance:
    """The tolerance that the file gives, or that follows from its pin and hole, or else the usual one.

    Raises
    ------
    InputError
        For negative lengths.
    """
    usual = Tolerance()
    # Rounded to where a difference of decimal figures is exact again.
    peg = usual.peg if fit is None else round(peg_error(peg_radius, fit.pin, fit.hole, fit.position), 9)
    given = {key: unit.length(entries[key]) for key in ("peg_tolerance", "face_tolerance") if key in entries}
    return Tolerance(given.get("peg_tolerance", peg), given.get("face_tolerance", usual.face), fit)
