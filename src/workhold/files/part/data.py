"""Parts given as data instead of drawings: in JSON, or as objects of other libraries.

JSON is ``{"name": ..., "units": "mm" | "inch", "loops": [[[x, y, bulge], ...], ...]}``. A result file is read
too: its ``workpiece`` has the same form.

Objects of shapely, ezdxf, build123d and CadQuery are recognized by their attributes, without importing these
libraries. A shapely geometry has ``__geo_interface__`` and ``geom_type``, a document of ezdxf has
``modelspace`` and ``header``.

The libraries build123d and CadQuery keep a shape of Open CASCADE in the attribute ``wrapped``. Other objects
contain such a wrapper: ``part`` or ``sketch`` of a builder, ``vals()`` of a work plane, ``_faces`` of
CadQuery's sketch.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from attrs import frozen

from workhold.errors import InputError
from workhold.files.budget import LIMITS, Budget
from workhold.files.outline.chain import Chain, Drawing
from workhold.files.outline.curves import merge_short_chords
from workhold.files.outline.joining import JoinedLoop
from workhold.files.outline.nesting import choose_part, join_loops_as_one_part
from workhold.files.part.loaded import LoadedPart, build_workpiece, refuse_large
from workhold.files.questions import (
    DRAWING_UNIT,
    FIT,
    is_read_by_height,
    refuse_axis,
    refuse_fit,
    refuse_layers,
)
from workhold.files.text import parse_json
from workhold.model.requirements import to_number_pairs
from workhold.model.solid import SolidOutline
from workhold.units import find_unit

if TYPE_CHECKING:
    from workhold.files.step.by_height import HeightDrawing

__all__ = ["ObjectPart", "read_object", "read_json"]


def read_json(path: Path, content: bytes, options: Mapping[str, Any], own: bool) -> LoadedPart:
    """Return the part in a JSON file, which may be a result file.

    Parameters
    ----------
    options : see :func:`workhold.files.part.load.read_workpiece`.
    own : whether the file is one of workhold's built-in parts, whose form needs no check.

    Raises
    ------
    InputError
        For content of another form, and options that do not apply to JSON.
    """
    refuse_layers(options["layers"])
    fit = options["fit"]
    if options["unit"] is not None:
        raise InputError(f'the JSON file gives its own "units": leave {DRAWING_UNIT} out.')
    try:
        data = parse_json(content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise InputError(
            f"the file is not UTF-8 text (byte {error.start}): save it as UTF-8 JSON."
        ) from error
    solid: SolidOutline | None = None
    if isinstance(data, dict) and str(data.get("format", "")).startswith("workhold-result"):
        solid = read_solid_outline(data)
        data = data.get("workpiece")
        # Of a raw block it is the part inside that a user means.
        data = data.get("finished", data) if isinstance(data, dict) else data
    if own or solid is not None:
        refuse_fit(fit)
    if not isinstance(data, dict):
        raise InputError(
            'The file holds no workpiece: it must be {"name": ..., "units": "mm", "loops": [...]}.'
        )
    if not own:
        from workhold.files.input_forms import check_workpiece_entries

        data = check_workpiece_entries(data)
    units: str = data["units"]
    if units not in ("mm", "inch"):
        raise InputError(f'The units "{units[:40]}" are not known: write "mm" or "inch".')
    scale = find_unit(units).millimetres
    refuse_large(sum(map(len, data["loops"])))
    loops = [JoinedLoop(np.array(loop).reshape(-1, 3) * (scale, scale, 1.0), ()) for loop in data["loops"]]
    departure = scale * (data.get("departure") or 0.0)
    name = data.get("name") or path.stem
    workpiece = build_workpiece(name, loops, False, departure, solid)
    of_chords = list[str]()
    if solid is None and not own:
        # What is checked has no arcs of absurd sizes, which the chords would be compared with.
        budget = Budget(LIMITS["json"], len(content))
        drawn = [JoinedLoop(loop, ("",) * len(loop)) for loop in workpiece.loops]
        merged, away, of_chords = merge_short_chords(drawn, {}, fit, budget)
        if fit is not None:
            workpiece = build_workpiece(name, merged, False, departure + away, None)
        else:
            # Without a fit a file of numbers is read as it is.
            of_chords = [said for said in of_chords if FIT in said]
    part = (join_loops_as_one_part([JoinedLoop(loop, ("",) * len(loop)) for loop in workpiece.loops]),)
    choose_part(part, options["part_number"])
    return LoadedPart(workpiece, (*workpiece.remarks, *of_chords), part)


def read_solid_outline(content: Mapping[str, Any]) -> SolidOutline | None:
    """Return the solid of a result file's workpiece; None
    if it has none. Raise InputError for an incomplete one.
    """
    workpiece, solid = content.get("workpiece"), content.get("solid")
    if solid is None or not isinstance(workpiece, dict):
        return None
    try:
        return SolidOutline.from_entries(solid, workpiece)
    except (TypeError, ValueError, LookupError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("The solid of the result file is not complete: design it again.") from error


WANTED = (
    "give the path of a file, a built-in name, or a polygon of shapely, an array of corners, a document of "
    "ezdxf, or a sketch, face or solid of build123d or CadQuery"
)
CORNERS = (
    "give x and y for every corner of one outline, or make the part by Workpiece.from_loops, which takes holes "
    "and bulges"
)
# What an object of a library that wraps Open CASCADE may hold its shape under, and what a builder may.
HELD = ("_obj", "part", "sketch", "_faces")


@frozen
class ObjectPart:
    """The part read from an object of another library.

    Parameters
    ----------
    drawing : the drawing in mm; for a solid that is read at the height of the pegs, its outline there.
    name : default name of the part.
    part_number : number of the part to take from the drawing; None if the drawing has one part only, or for
        the largest.
    layered : whether layers of the drawing can be chosen.
    """

    drawing: Drawing | HeightDrawing
    name: str
    part_number: int | str | None
    layered: bool = False


def read_object(
    part: Any,
    *,
    unit: str | None,
    usual_unit: str | None,
    layers: Sequence[str] | None,
    part_number: int | str | None,
    fit: float | None,
    **view: Any,
) -> ObjectPart:
    """Return the drawing in an object of shapely, NumPy,
    ezdxf, build123d or CadQuery, or in a list of corners.

    The arguments are those of :func:`workhold.load`; ``view`` holds the arguments for solids. A geometry of
    shapely and an array have no unit and are in mm unless one is given. Raises InputError for other objects,
    and for arguments that do not apply to the object.
    """
    is_geometry = hasattr(part, "__geo_interface__") and hasattr(part, "geom_type")
    if is_geometry or isinstance(part, np.ndarray | list | tuple):
        refuse_axis(view)
        refuse_layers(layers)
        scale = find_unit(unit or usual_unit or "mm").millimetres
        chains = (
            make_chains_from_shapely(part, scale) if is_geometry else (make_chain_from_array(part, scale),)
        )
        return ObjectPart(Drawing(tuple(chains)), "polygon", part_number)
    if hasattr(part, "modelspace") and hasattr(part, "header"):
        from workhold.files.dxf.reader import normalize_unit_code, read_document

        refuse_axis(view)
        code = normalize_unit_code(part.header.get("$INSUNITS", 0))
        drawing = read_document(part, code, unit=unit, usual_unit=usual_unit, layers=layers, fit=fit)
        return ObjectPart(
            drawing, Path(getattr(part, "filename", None) or "drawing").stem, part_number, layered=True
        )
    shapes = list(list_wrapped_shapes(part))
    if not shapes:
        raise InputError(f"a part cannot be read from it: {WANTED}.")
    refuse_layers(layers)
    if unit is not None:
        raise InputError(f"shapes of Open CASCADE are in mm: leave {DRAWING_UNIT} out.")
    name = str(getattr(part, "label", "") or "shape")
    from workhold.files.step.by_height import HeightView, draw_shapes_at_usual_height, draw_shapes_by_height

    keys = ("axis", "peg_height", "head_room", "least_band", "heights", "peg_diameter")
    given = {key: view[key] for key in keys if view.get(key) is not None}
    height_view = HeightView(**given, part_number=part_number)
    if is_read_by_height(view, fit):
        return ObjectPart(draw_shapes_by_height(shapes, height_view), name, None)
    if view["section"] is None and fit is None:
        found = draw_shapes_at_usual_height(shapes, height_view)
        if found is not None:
            return ObjectPart(found, name, None)
    from workhold.files.step.reader import read_shapes

    drawing, rest = read_shapes(
        shapes, axis=view["axis"], section_height=view["section"], part_number=part_number, fit=fit
    )
    return ObjectPart(drawing, name, rest)


def make_chains_from_shapely(geometry: Any, scale: float) -> Iterator[Chain]:
    """Yield the rings and lines of a geometry of shapely as
    chains, multiplied by ``scale``; raise InputError for points.
    """
    kind = geometry.geom_type
    if hasattr(geometry, "geoms"):
        for one in geometry.geoms:
            yield from make_chains_from_shapely(one, scale)
    elif kind == "Polygon":
        for ring in (geometry.exterior, *geometry.interiors):
            yield from make_chains_from_shapely(ring, scale)
    elif kind in ("LinearRing", "LineString"):
        corners = [(scale * float(x), scale * float(y)) for x, y, *_ in geometry.coords]
        if len(corners) > 1:
            yield make_chain_from_corners(corners, kind)
    else:
        raise InputError(f"a {kind} has no outline: give a polygon.")


def make_chain_from_corners(corners: Sequence[tuple[float, float]], kind: str) -> Chain:
    """Return the chain of straight segments from corner to corner; ``kind`` is a word for its labels."""
    labels = tuple(f"corner {k} of a {kind}" for k in range(len(corners) - 1))
    return Chain(tuple(corners), (0.0,) * (len(corners) - 1), labels)


def make_chain_from_array(points: Any, scale: float) -> Chain:
    """Return the closed chain of an array (N, 2) of three or more corners, multiplied by ``scale``.

    The first corner may be repeated at the end. Raises InputError for any other array.
    """
    corners = [(scale * x, scale * y) for x, y in to_number_pairs(points, "a corner of an outline", CORNERS)]
    if len(corners) < 3:
        raise InputError(f"an outline of {len(corners)} corners is not possible: {CORNERS}.")
    return make_chain_from_corners(
        [*corners, *corners[:1]] if corners[:1] != corners[-1:] else corners, "polygon"
    )


def list_wrapped_shapes(part: Any) -> Iterator[Any]:
    """Yield the shapes of Open CASCADE in an object that is a shape, wraps one or holds such objects; other
    objects yield nothing.
    """
    if type(part).__module__.partition(".")[0] == "OCP":
        yield part
    elif getattr(part, "wrapped", None) is not None:
        yield from list_wrapped_shapes(part.wrapped)
    elif callable(getattr(part, "vals", None)) and not hasattr(part, "_faces"):
        for one in part.vals():
            yield from list_wrapped_shapes(one)
    else:
        held = next((getattr(part, name) for name in HELD if getattr(part, name, None) is not None), None)
        if held is not None and held is not part:
            yield from list_wrapped_shapes(held)
