"""Reading of a part: a file (JSON, DXF, SVG, STEP), a built-in name or an object becomes a workpiece in
millimetres.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from attrs import evolve

from workhold.errors import InputError
from workhold.files.budget import LIMITS, Budget
from workhold.files.outline.chain import Drawing
from workhold.files.outline.curves import check_fit
from workhold.files.part.data import read_json, read_object
from workhold.files.part.finding import (
    detect_file_kind,
    find_builtin_path,
    find_part_file,
    list_builtin_parts,
    read_bytes,
)
from workhold.files.part.loaded import (
    LoadedPart,
    from_drawing,
    from_heights,
    name_part_after_solid,
)
from workhold.files.questions import (
    DRAWING_UNIT,
    PEG_HEIGHT,
    UnitAskedError,
    check_layer_names,
    is_read_by_height,
    name_questions,
    read_number_or_name,
    refuse_axis,
    refuse_layers,
)
from workhold.fixels.toolkit import Toolkit
from workhold.limits import convert_real
from workhold.model.workpiece import Workpiece
from workhold.units import find_drawing_unit

__all__ = ["LoadedPart", "list_builtin_parts", "load", "read_workpiece", "refuse_unsure_numbers"]


def load(
    part: Any,
    *,
    name: str | None = None,
    unit: str | None = None,
    layers: str | Sequence[str] | None = None,
    part_number: int | str | None = None,
    join_tolerance: float = 1e-3,
    fit: float | None = None,
    axis: str | None = None,
    section: float | None = None,
    peg_height: float | None = None,
    head_room: float | None = None,
    least_band: float | None = None,
    heights: Mapping[str, Sequence[float]] | None = None,
    toolkit: Toolkit | None = None,
) -> Workpiece:
    """Return a part from a file, a built-in model, or an object of another library, as a workpiece in mm.

    The ``remarks`` of the workpiece say how it was read: what was left out, joined, or chosen of several
    parts.

    Parameters
    ----------
    part : path of a .json, .dxf, .svg or .step file, or a built-in name such as ``widget``; a file of that
        name is preferred. Or a geometry of shapely, an array (N, 2) of the corners of an outline, a document
        of ezdxf, or a sketch, a face or a solid of build123d or CadQuery.
    name : name of the part; if None the file's name, or for one of several solids of a STEP file the solid's
        name and the file's, as in "lug of machine".
    unit : "mm", "cm", "m" or "inch"; needed for drawings that do not give their unit, and overrides the unit
        of those that do. For an SVG drawing in pixels also the pixels per inch: "px72", "px90", "px96". A
        geometry of shapely and an array are in mm if None.
    layers : the DXF layers to read, in any mixture of capitals, one or several; all visible ones when None.
    part_number : number of the part to take from a drawing with several, from 1 by decreasing area; the
        largest when None. Solids of a STEP file have numbers by decreasing volume, and may have names.
    join_tolerance : largest gap between loose ends to close, in mm.
    fit : largest distance in mm of lines and arcs from the curves that they replace; None refuses curves that
        are not lines or arcs. The workpiece's ``departure`` is the largest distance that occurs.
    axis : "x", "y" or "z", the direction of a STEP file that points up; z when None. With a minus before it
        the part lies on its other side.
    section : take the section of a STEP file's solid at this height in mm above its lowest point, not its
        silhouette.
    peg_height : height up to which pegs reach, in mm above the plane on which a STEP file's solid lies. The
        outline is what they can meet, and only upright faces are touched.
    head_room : with a height of the pegs, the space kept free above them in mm; 0.5 when None.
    least_band : with a height of the pegs, the least height in mm of an upright face that pegs may touch; 1
        when None.
    heights : for a STEP file's solid, the lowest and highest z in mm of carriers that reach over heights of
        their own, by role; ``toolkit.heights`` when None.
    toolkit : what a STEP file's solid will be held in. With a toolkit and without ``peg_height``, the pegs
        are dowels that are sold, high enough to touch half of what pegs of the best height can touch, and if
        possible no higher than twice their diameter. Without both, pegs are as tall as the part.

    Raises
    ------
    InputError
        For a part that cannot be found, read or used, naming the place.

    Examples
    --------
    >>> from workhold import load
    >>> widget = load("widget")
    >>> len(widget.segments)
    16
    """
    loaded = read_workpiece(
        part,
        unit=unit,
        layers=layers,
        part_number=part_number,
        join_tolerance=join_tolerance,
        fit=fit,
        axis=axis,
        section=section,
        peg_height=peg_height,
        head_room=head_room,
        least_band=least_band,
        heights=toolkit.heights if heights is None and toolkit is not None else heights,
        peg_diameter=None if toolkit is None else toolkit.peg_diameter,
    )
    workpiece = evolve(loaded.workpiece, remarks=loaded.remarks)
    return workpiece if name is None else evolve(workpiece, name=name)


def read_workpiece(
    part: Any,
    *,
    unit: str | None = None,
    usual_unit: str | None = None,
    layers: str | Sequence[str] | None = None,
    part_number: int | str | None = None,
    join_tolerance: float = 1e-3,
    fit: float | None = None,
    axis: str | None = None,
    section: float | None = None,
    peg_height: float | None = None,
    head_room: float | None = None,
    least_band: float | None = None,
    heights: Mapping[str, Sequence[float]] | None = None,
    peg_diameter: float | None = None,
    called: Mapping[str, str] | None = None,
) -> LoadedPart:
    """Return a part as :func:`load` does, with remarks and the list of all parts in the file.

    Parameters
    ----------
    usual_unit : the unit of a drawing that does not give its own, when ``unit`` is None. Parameters that are
        not listed are those of :func:`load`.
    peg_diameter : diameter in mm of the pegs beside a solid; None where it is not known.
    called : names of the questions of ``files.questions`` at the caller, such as options of the command line;
        None gives those of Python's arguments.

    Raises
    ------
    InputError
        For a part that cannot be found, read or used, naming the place.
    """
    if not (isfinite(convert_real(join_tolerance, "the join tolerance")) and join_tolerance >= 0):
        raise InputError(
            f"The join tolerance {join_tolerance} is not usable: give a length in mm, 0 or more."
        )
    lengths = {"fit": fit, "section": section, "peg height": peg_height, "head room": head_room}
    for words, length in (lengths | {"least band": least_band}).items():
        if length is not None:
            convert_real(length, words)
    check_fit(fit)
    for name in (unit, usual_unit):
        if name is not None:
            find_drawing_unit(name)
    options: dict[str, Any] = {
        "unit": unit,
        "usual_unit": usual_unit,
        "layers": check_layer_names(layers),
        "part_number": read_number_or_name(part_number),
        "fit": fit,
        "axis": axis,
        "section": section,
        "peg_height": peg_height,
        "head_room": head_room,
        "least_band": least_band,
        "heights": dict(heights or {}),
        "peg_diameter": peg_diameter,
    }
    path = find_part_file(part) if isinstance(part, str | PathLike) else None
    try:
        # Numbers that overflow are refused where they are looked at; NumPy would warn of them before.
        with np.errstate(all="ignore"):
            if path is None:
                loaded = from_object(part, options, join_tolerance)
            else:
                loaded = from_file(path, options, join_tolerance)
    except InputError as error:
        kind_of_error = UnitAskedError if isinstance(error, UnitAskedError) else InputError
        place = f"this {type(part).__name__}" if path is None else path.name
        raise kind_of_error(f"{place}: {name_questions(str(error), called)}") from error
    return evolve(loaded, remarks=tuple(name_questions(remark, called) for remark in loaded.remarks))


def refuse_unsure_numbers(
    loaded: LoadedPart, faces: Sequence[int], called: Mapping[str, str] | None = None
) -> None:
    """Raise InputError for faces named by number if the numbers depend on a peg height that was not given.

    Parameters
    ----------
    faces : their numbers; empty if none are named by number.
    called : see :func:`read_workpiece`.

    Raises
    ------
    InputError
        The message names both heights that may be meant.
    """
    usual = loaded.usual
    if not faces or usual is None or usual.is_whole or not usual.decides_numbers:
        return
    one = f"face {faces[0]} is" if len(faces) == 1 else f"faces {', '.join(map(str, faces))} are"
    sentence = (
        f"{one} named by number, and these numbers depend on how high pegs reach, which is not "
        f"given: give {PEG_HEIGHT} {usual.peg_height:.6g}mm, no higher than pegs must be, or "
        f"{PEG_HEIGHT} {usual.height:.6g}mm, as tall as the part, and the numbers that the part "
        "has with it."
    )
    raise InputError(name_questions(sentence, called))


def from_object(part: Any, options: Mapping[str, Any], join_tolerance: float) -> LoadedPart:
    """Return a part from an object of another library; ``options`` are those of :func:`read_workpiece`.

    Raises InputError for other objects, and for options that do not apply to the object.
    """
    held = read_object(part, **options)
    if not isinstance(held.drawing, Drawing):
        return from_heights(held.name, held.drawing)
    return from_drawing(
        Path(held.name), held.drawing, held.part_number, join_tolerance, options["fit"], held.layered
    )


def from_file(path: Path, options: Mapping[str, Any], join_tolerance: float) -> LoadedPart:
    """Return a part from a file; ``options`` are those of :func:`read_workpiece`.

    Raises InputError for a file that cannot be used, and for options that do not apply to its kind.
    """
    content = read_bytes(path)
    kind = detect_file_kind(path, content)
    part_number, layers, fit = options["part_number"], options["layers"], options["fit"]
    if kind == "step":
        return from_step(path, content, options)
    refuse_axis(options)
    if kind == "json":
        return read_json(path, content, options, own=path == find_builtin_path(path.stem))
    units = {"unit": options["unit"], "usual_unit": options["usual_unit"]}
    budget = Budget(LIMITS[kind], len(content))
    if kind == "dxf":
        from workhold.files.dxf.reader import read_dxf

        return from_drawing(
            path,
            read_dxf(path, content, **units, layers=layers, fit=fit, budget=budget),
            part_number,
            join_tolerance,
            fit,
            True,
            budget,
        )
    refuse_layers(layers)
    from workhold.files.svg.reader import read_svg

    drawing = read_svg(content, **units, fit=fit, budget=budget)
    return from_drawing(path, drawing, part_number, join_tolerance, fit, budget=budget)


def from_step(path: Path, content: bytes, options: Mapping[str, Any]) -> LoadedPart:
    """Return a part from the bytes of a STEP file; only the name of ``path`` is used.

    Raises InputError for content that cannot be used, and for options that do not apply to STEP.
    """
    refuse_layers(options["layers"])
    if options["unit"] is not None:
        raise InputError(f"the STEP file gives its own unit: leave {DRAWING_UNIT} out.")
    asked = is_read_by_height(options, options["fit"])
    if asked or (options["section"] is None and options["fit"] is None):
        from workhold.files.step.by_height import HeightView, read_by_height_apart

        keys = (
            "axis",
            "peg_height",
            "head_room",
            "least_band",
            "part_number",
            "heights",
            "peg_diameter",
        )
        view = HeightView(**{key: options[key] for key in keys if options[key] is not None})
        read = read_by_height_apart(content, view, or_silhouette=not asked)
        if isinstance(read, Drawing):
            loaded = from_drawing(path, read, None, 0.0, None)
        else:
            loaded = from_heights(path.stem, read)
        return name_part_after_solid(loaded, path.stem, options["part_number"])
    from workhold.files.step.reader import read_step_apart

    drawing = read_step_apart(
        content,
        axis=options["axis"],
        section_height=options["section"],
        part_number=options["part_number"],
        fit=options["fit"],
    )
    loaded = from_drawing(path, drawing, None, 0.0, options["fit"])
    return name_part_after_solid(loaded, path.stem, options["part_number"])
