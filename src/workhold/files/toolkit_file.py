"""Toolkits described in TOML: the program's presets, and users' files.

All lengths come out in mm.

Each preset in ``data/toolkits`` names the source of its figures. A preset of a vise is a plate on each jaw,
as in the paper. No vise sold with a lattice of dowel holes on both jaws is known to us. Only its owner knows
how many columns a jaw has; a preset's number is only a typical one. Dowel pins of the standards are looked up
by nominal diameter; their figures and sources are in ``data/dowels.toml``.

Glossary
--------
entry : a key of the file and its value.
fields : the keyword arguments of the toolkit's class that the file gives.
fit : limits of pin and hole and the position of the hole, from which the peg's tolerance follows.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from math import inf
from pathlib import Path
from typing import Any

from attrs import evolve, frozen

from workhold.conventions import SAME_SIZE
from workhold.errors import InputError
from workhold.files.budget import LIMITS
from workhold.files.text import parse_toml, read_text
from workhold.fixels.fields import COLUMNS, OPTIONS, PEG_RADIUS, PITCH
from workhold.fixels.kinds import KINDS, USUAL, make_toolkit, resolve_kind
from workhold.fixels.support_hardware import HARDWARE, TOP_CLAMP, TopClamp, convert_hardware
from workhold.fixels.table import Form
from workhold.fixels.toolkit import Toolkit
from workhold.model.dowels import DowelFit, DowelSize, Limits, compute_peg_error, refuse_limits
from workhold.model.requirements import Tolerance
from workhold.units import Unit, find_unit

__all__ = [
    "DowelSeries",
    "LoadedToolkit",
    "make_described_toolkit",
    "load_dowel_series",
    "find_dowel_size",
    "is_sold",
    "load_toolkit",
    "load_preset",
    "load_preset_fields",
    "list_preset_names",
    "list_presets_of_kind",
    "load_preset_tolerance",
    "read_toolkit_file",
]


@frozen
class DowelSeries:
    """The pins of one standard.

    Parameters
    ----------
    name : the standard, and its tolerance class where it has several.
    unit : unit in which the standard gives its sizes.
    source : text that names the source of the figures.
    sizes : by increasing diameter, in mm.
    """

    name: str
    unit: Unit
    source: str
    sizes: tuple[DowelSize, ...]


@cache
def load_dowel_series() -> tuple[DowelSeries, ...]:
    """Return the dowel pin standards that the program knows, each with its pins; lengths in mm.

    Examples
    --------
    >>> [series.name for series in load_dowel_series()]
    ['ASME B18.8.5M', 'ASME B18.8.2', 'ISO 2338 m6', 'ISO 2338 h8']
    """
    text = (files("workhold") / "data" / "dowels.toml").read_text(encoding="utf-8")
    found = []
    for entry in tomllib.loads(text)["series"]:
        unit = find_unit(entry["unit"])
        sizes = []
        for row in entry["sizes"]:
            nominal, *limits = (unit.to_mm(number) for number in row)
            hole = (limits[2], limits[3]) if len(limits) == 4 else None
            sizes.append(DowelSize(nominal, (limits[0], limits[1]), hole))
        found.append(DowelSeries(entry["name"], unit, entry["source"], tuple(sizes)))
    return tuple(found)


def find_dowel_size(standard: str, diameter: float) -> DowelSize:
    """Return a standard's pin of a nominal diameter in mm.

    Raises
    ------
    InputError
        For a standard that is not known, and a diameter that it does not have.

    Examples
    --------
    >>> find_dowel_size("ASME B18.8.5M", 6.0).pin
    (6.003, 6.009)
    """
    for series in load_dowel_series():
        if series.name.lower() == " ".join(standard.lower().split()):
            for size in series.sizes:
                if abs(size.nominal - diameter) < SAME_SIZE:
                    return size
            sizes = ", ".join(series.unit.format_short_length(size.nominal) for size in series.sizes)
            raise InputError(
                f"{series.name} has no dowel of {series.unit.format_short_length(diameter)} {series.unit.abbreviation}: "
                f"its sizes are {sizes} {series.unit.abbreviation}."
            )
    names = ", ".join(series.name for series in load_dowel_series())
    raise InputError(f'dowel "{standard[:40]}" is not known: the standards are {names}.')


# Where nobody says how well the holes are placed: what a tolerance is when nothing is said, see Tolerance.
ASSUMED_POSITION = Tolerance().peg


@frozen
class LoadedToolkit:
    """A toolkit as its file describes it.

    Parameters
    ----------
    name : name of the preset or of the file.
    title : description in a line; empty where the file gives none.
    source : source of the figures; empty where the file does not say.
    unit : unit in which the file gives its lengths.
    kind : kind of toolkit, see ``fixels.kinds``.
    fields : keyword arguments of its class, in mm; those not in the file are left out.
    tolerance : tolerance of the pegs and of the faces that pegs touch; ``tolerance.fit`` is None where the
        file gives no pin or hole.
    assumed : entries for which there is no source, as the file says.
    """

    name: str
    title: str
    source: str
    unit: Unit
    kind: str
    fields: dict[str, Any]
    tolerance: Tolerance
    assumed: tuple[str, ...] = ()

    @property
    def toolkit(self) -> Toolkit:
        """The toolkit with exactly these fields and tolerance."""
        return make_toolkit(self.kind, {**self.fields, "tolerance": self.tolerance})


def read_toolkit_file(path: Path) -> LoadedToolkit:
    """Return the toolkit in a TOML file, or the vise in a file of FreeCAD; raise InputError for a file that cannot
    be used.
    """
    from workhold.files.freecad_vise import ENDING as FREECAD
    from workhold.files.freecad_vise import read_freecad_vise
    from workhold.files.input_forms import check_toolkit_entries

    try:
        if path.suffix.lower() == FREECAD:
            fields, title, source = read_freecad_vise(path)
            return LoadedToolkit(path.stem, title, source, find_unit("mm"), "plain-vise", fields, Tolerance())
        return make_described_toolkit(
            path.stem, check_toolkit_entries(parse_toml(read_text(path, LIMITS["toolkit"])))
        )
    except InputError as error:
        raise InputError(f"{path.name or path}: {error}") from error


def make_described_toolkit(name: str, entries: Mapping[str, Any]) -> LoadedToolkit:
    """Return the toolkit that a file's entries describe; they must have passed :func:`check_toolkit_entries`.

    Raises InputError for values that no toolkit can have.
    """
    unit = find_unit(entries["unit"])
    if unit.name not in ("mm", "inch"):
        raise InputError('the unit of a toolkit is "mm" or "inch".')
    kind, said = resolve_kind(entries.get("kind", USUAL))
    given = {
        row.name: convert_to_mm(row.form, entries[row.name], unit) for row in OPTIONS if row.name in entries
    }
    fields: dict[str, Any] = {**said, **given}
    for key in HARDWARE:
        if key in entries:
            stresses = {row.name for row in HARDWARE[key].table.fields if row.form == "stress"}
            figures = {
                figure: value if figure in stresses else convert_lengths_to_mm(value, unit)
                for figure, value in entries[key].items()
            }
            fields[key] = convert_hardware(key, figures)
    refuse_wide_pads(make_toolkit(kind, fields))
    return LoadedToolkit(
        name=name,
        title=entries.get("title", ""),
        source=entries.get("source", ""),
        unit=unit,
        kind=kind,
        fields=fields,
        tolerance=make_tolerance(entries, unit, fields.get(PEG_RADIUS.name, 0.0)),
        assumed=tuple(entries.get("assumed", ())),
    )


def convert_to_mm(form: Form, value: Any, unit: Unit) -> Any:
    """Return the value of an entry as an argument of the toolkit's constructor, with lengths converted from
    ``unit`` to mm.
    """
    if form in ("count", "directions", "choice", "force"):
        return value
    if form == "holes":
        return tuple(value)
    lengths = tuple(map(unit.to_mm, value if isinstance(value, list) else [value]))
    if form == "length":
        return lengths[0]
    return 2 * lengths if form == "pitch" and len(lengths) == 1 else lengths


def convert_lengths_to_mm(value: Any, unit: Unit) -> Any:
    """Return a length, or nested lists of lengths, converted from ``unit`` to mm."""
    return (
        [convert_lengths_to_mm(one, unit) for one in value] if isinstance(value, list) else unit.to_mm(value)
    )


def refuse_wide_pads(toolkit: Toolkit) -> None:
    """Raise InputError for supports whose pads would overlap in neighbouring holes."""
    apart = min((pitch for plate in toolkit.plates for pitch in plate.pitch), default=inf)
    radius = None if toolkit.supports is None else toolkit.supports.pad_radius
    if radius is not None and 2 * radius > apart:
        raise InputError(
            f"supports: pads of radius {radius:g} mm would overlap in neighbouring holes {apart:g} mm apart: "
            "give a smaller pad_radius."
        )


def read_fit(entries: Mapping[str, Any], unit: Unit, peg_radius: float) -> DowelFit | None:
    """Return the limits of pin and hole that the file gives, or those of the
    standard that the file names; None without both.

    Raises InputError for a pin without a hole or a hole without a pin, and for limits that do not fit
    ``peg_radius`` in mm.
    """
    limits: dict[str, Limits | None] = {"pin_diameter": None, "hole_diameter": None}
    if "dowel" in entries:
        size = find_dowel_size(entries["dowel"], 2 * peg_radius)
        limits = {"pin_diameter": size.pin, "hole_diameter": size.hole}
    for key in limits:
        if key in entries:
            low, high = entries[key]
            limits[key] = (unit.to_mm(low), unit.to_mm(high))
    pin, hole = limits["pin_diameter"], limits["hole_diameter"]
    if pin is None and hole is None:
        if "hole_position" in entries:
            raise InputError(
                "hole_position is given without the pin: add dowel, or pin_diameter and hole_diameter, or "
                "give peg_tolerance alone."
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
    length = ASSUMED_POSITION if position is None else unit.to_mm(position)
    return DowelFit(pin, hole, length, position is None, entries.get("dowel", ""))


def make_tolerance(entries: Mapping[str, Any], unit: Unit, peg_radius: float) -> Tolerance:
    """Return the tolerance that the file gives, or that follows from its pin and hole, or else the usual one.

    Raises InputError for negative lengths, and in the cases of :func:`read_fit`.
    """
    usual, fit = Tolerance(), read_fit(entries, unit, peg_radius)
    # Rounded to where a difference of decimal figures is exact again.
    peg = (
        usual.peg if fit is None else round(compute_peg_error(peg_radius, fit.pin, fit.hole, fit.position), 9)
    )
    given = {key: unit.to_mm(entries[key]) for key in ("peg_tolerance", "face_tolerance") if key in entries}
    return Tolerance(given.get("peg_tolerance", peg), given.get("face_tolerance", usual.face), fit)


ENDING = ".toml"
# How far in mm the tip of a clamp on top keeps from the border of its face in a preset that does not say: a
# tip on the very edge chips it.
TIP_MARGIN = 1.0


@cache
def list_preset_names() -> tuple[str, ...]:
    """Return the names of the presets in this order: equipment that is sold
    first, plates before vises, then by kind and pitch.

    Examples
    --------
    >>> list_preset_names()[0]
    'clamp-plate-20mm'
    """
    presets = [
        load_preset(entry.name.removesuffix(ENDING))
        for entry in (files("workhold") / "data" / "toolkits").iterdir()
        if entry.name.endswith(ENDING)
    ]
    presets.sort(
        key=lambda one: (
            one.name.split("-")[0],
            one.fields.get(PITCH.name, (0.0, 0.0)),
            one.fields.get(COLUMNS.name, 0),
            one.name,
        )
    )
    presets.sort(key=lambda one: (not is_sold(one.name), one.toolkit.moving.has_lattice))
    return tuple(one.name for one in presets)


def is_sold(name: str) -> bool:
    """Return whether a preset's equipment can be bought or drilled; the paper's grippers cannot.

    >>> is_sold("table-50mm"), is_sold("gripper-one-column, radius 2")
    (True, False)
    """
    return not name.startswith("gripper-")


def load_preset(name: str) -> LoadedToolkit:
    """Return the preset of a name, which must exist. A clamp on top for which the preset gives no tip margin
    gets the usual one.
    """
    text = (files("workhold") / "data" / "toolkits" / f"{name}{ENDING}").read_text(encoding="utf-8")
    found = make_described_toolkit(name, tomllib.loads(text))
    if found.toolkit.holds_by_friction:
        return found
    clamp = found.fields.get(TOP_CLAMP) or TopClamp()
    if clamp.tip_margin is None:
        clamp = evolve(clamp, tip_margin=TIP_MARGIN)
    return evolve(found, fields={**found.fields, TOP_CLAMP: clamp})


def load_toolkit(name: str | Path) -> LoadedToolkit:
    """Return a toolkit from a TOML file or the file of a vise in FreeCAD, or by the name of a preset; a file
    is preferred to a preset of the same name.

    Parameters
    ----------
    name : a preset's name in any mixture of capitals, or the path of a file.

    Raises
    ------
    InputError
        For a toolkit that cannot be found, with the names that are close, and for a file that cannot be used.

    Examples
    --------
    >>> from workhold import Vise
    >>> loaded = load_toolkit("plate-20mm")
    >>> Vise(**loaded.fields | {"columns": 2}).pitch
    (20.0, 20.0)
    """
    path = Path(name)
    try:
        is_path = path.exists()
    except (OSError, ValueError):
        is_path = False
    names = list_preset_names()
    asked = str(name).strip().lower()
    if is_path and asked and not (path.is_dir() and asked in names):
        return read_toolkit_file(path)
    if asked in names:
        return load_preset(asked)
    close = get_close_matches(asked, names, n=3, cutoff=0.5) or names
    raise InputError(
        f"{str(name)[:200]!r}: file not found, and no toolkit has that name (try {', '.join(close)})."
    )


def list_presets_of_kind(kind: type[Toolkit]) -> tuple[str, ...]:
    """Return the names of the presets whose toolkit is of exactly this class."""
    return tuple(name for name in list_preset_names() if KINDS[load_preset(name).kind] is kind)


def load_preset_fields(kind: type[Toolkit], name: str) -> dict[str, Any]:
    """Return the fields in mm of a preset or a user's file, as keyword arguments of a class of toolkits or a
    subclass of it.

    Raises
    ------
    InputError
        In the cases of :func:`workhold.files.toolkit_file.load_toolkit`, and for a toolkit of another class.
    """
    loaded = load_toolkit(name)
    is_of = KINDS[loaded.kind]
    if not issubclass(kind, is_of):
        raise InputError(f"{loaded.name} is a {is_of.noun}: ask {is_of.__name__}.preset for it.")
    return loaded.fields


def load_preset_tolerance(name: str) -> Tolerance:
    """Return the tolerances of pegs and faces in a preset or a user's file.

    Raises
    ------
    InputError
        In the cases of :func:`workhold.files.toolkit_file.load_toolkit`.
    """
    return load_toolkit(name).tolerance
