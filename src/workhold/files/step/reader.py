"""Parts in STEP files, or in shapes of another library: the outline of a prismatic part, in mm.

The outline is the silhouette along an axis: all (x, y) at which the part has material at some height. Round
pegs parallel to the axis touch the part on the border of the silhouette. It is computed as the union of the
sections of all layers, of level faces, and of the sections where leaning faces meet or fold. Each of these
lies in the silhouette, and afterwards every face is tested for points outside the union. Instead, the outline
may be the section at a height that the user chose. Shapes of Open CASCADE that another library has made are
solids seen along an axis, or flat faces, which are taken as they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import Any

import numpy as np
from attrs import astuple, evolve

from workhold.conventions import ALIGNED, FREE_VOLUME, SAME_HEIGHT, SAME_VOLUME
from workhold.errors import InputError
from workhold.files.apart import run_apart
from workhold.files.outline.chain import Chain, CurveReading, Drawing
from workhold.files.questions import AXIS
from workhold.files.step.departures import FoundOutline, describe_departures, refuse_overhang
from workhold.files.step.faces import HeightRange, SolidFace, list_solid_faces, make_layers
from workhold.files.step.library import (
    AXES,
    check_axis_name,
    compute_bounding_box,
    list_sub_shapes,
    load_step_library,
    occ,
    read_guarded,
    turn_axis_up,
)
from workhold.files.step.regions import (
    cut_solid_at_height,
    make_level_region,
    measure_area,
    trace_borders,
    unite_regions,
)
from workhold.files.step.solids import (
    Solid,
    choose_solid,
    describe_lost_solids,
    describe_other_solids,
    list_solids_of_shapes,
    read_solids,
)
from workhold.geometry.segment import Line, make_segment_rows
from workhold.kernels.base.distance import is_inside, measure_outline_distances
from workhold.model.solid import FileSolid

__all__ = [
    "restore_drawing",
    "read_as_plain_data",
    "prepare",
    "read_shapes",
    "read_solid",
    "read_step",
    "read_step_apart",
]


def read_step_apart(content: bytes, **options: Any) -> Drawing:
    """Return the drawing of :func:`read_step`, computed in a child process,
    because damaged files crash or hang the library.
    """
    return restore_drawing(run_apart(__name__, content, options, "the STEP file"))


def restore_drawing(answered: Any) -> Drawing:
    """Return the drawing from the plain data that :func:`convert_drawing_to_data` returns."""
    chains = [
        Chain(tuple((x, y) for x, y in points), tuple(bulges), tuple(labels))
        for points, bulges, labels in answered[0]
    ]
    curves = {
        label: CurveReading((x, y), departure, is_disguise, np.array(pieces), arcs)
        for label, (x, y), departure, is_disguise, pieces, arcs in answered[2]
    }
    solids = tuple(FileSolid(*one) for one in answered[3])
    return Drawing(tuple(chains), tuple(answered[1]), curves, solids=solids)


def prepare() -> None:
    """Load the library and compile kernels in the child
    process, see :func:`workhold.files.apart.run_apart`.
    """
    load_step_library()
    rows = make_segment_rows(
        [Line((0.0, 0.0), (1.0, 0.0)), Line((1.0, 0.0), (0.0, 1.0)), Line((0.0, 1.0), (0.0, 0.0))]
    )
    is_inside(0.2, 0.2, rows)
    measure_outline_distances(np.zeros((1, 2)), rows)


def read_as_plain_data(content: bytes, **options: Any) -> Any:
    """Return the drawing of :func:`read_step` as plain data; called in the child process.

    Raises InputError also where the library, or the arithmetic after it, fails over the file.
    """
    return read_guarded(lambda: convert_drawing_to_data(read_step(content, **options)))


def convert_drawing_to_data(drawing: Drawing) -> Any:
    """Return a drawing as nested lists of numbers and text,
    from which :func:`restore_drawing` makes it again.
    """
    chains = [[chain.points, chain.bulges, chain.labels] for chain in drawing.chains]
    curves = [
        [label, one.place, one.departure, one.is_disguise, one.pieces.tolist(), one.arcs]
        for label, one in drawing.curves.items()
    ]
    return chains, drawing.remarks, curves, [astuple(one) for one in drawing.solids]


def read_step(
    content: bytes,
    *,
    axis: str | None = None,
    section_height: float | None = None,
    part_number: int | str | None = None,
    fit: float | None = None,
) -> Drawing:
    """Return the outline of a solid in a STEP file.

    Parameters
    ----------
    axis : "x", "y" or "z" (the default): the direction of the file that the pegs are parallel to. The part is
        seen from the axis's far end. So x and y of the outline are y and z of the file for "x", or z and x
        for "y". With a minus before it the part lies on its other side, turned over like a page.
    section_height : take the section at this height in mm above the part's lowest point, instead of the
        silhouette.
    part_number : number, from 1 by decreasing volume, or name of the solid to take from several; the largest
        when None.
    fit : largest distance in mm of lines and arcs from true curves; with None such curves are replaced
        provisionally, see ``Drawing``.

    Raises
    ------
    InputError
        For files that cannot be read, and parts whose silhouette is not that of their upright faces.
    """
    solids = read_solids(content)
    drawing = read_solid(solids, axis, section_height, part_number, fit)
    remarks = (*describe_lost_solids(content, solids), *drawing.remarks)
    return evolve(drawing, remarks=remarks, solids=tuple(solid.listed for solid in solids))


def read_solid(
    solids: tuple[Solid, ...],
    axis: str | None,
    section_height: float | None,
    part_number: int | str | None,
    fit: float | None,
) -> Drawing:
    """Return the outline of one of ``solids``; the other arguments and the errors are those of
    :func:`read_step`.
    """
    axis = check_axis_name(axis)
    solid = choose_solid(solids, part_number)
    shape = turn_axis_up(solid.shape, axis)
    faces = list_solid_faces(shape)
    layers = make_layers(faces)
    if section_height is None:
        region = compute_silhouette(shape, solid.volume, faces, layers)
    else:
        region = make_section_at_height(shape, faces, section_height)
    edges = trace_borders(region, fit)
    outline = FoundOutline.from_borders(edges, measure_area(region), faces)
    if section_height is None:
        refuse_overhang(outline, faces, solid.shape, axis)
    remarks = [
        *describe_other_solids(solids, solid, part_number),
        *edges.remarks,
        *describe_departures(outline, faces, layers, shape, solid.shape, axis, section_height),
    ]
    return Drawing(edges.chains, tuple(remarks), edges.curves)


def compute_silhouette(
    shape: Any, volume: float, faces: Sequence[SolidFace], layers: Sequence[HeightRange]
) -> Any:
    """Return the silhouette (the solid's projection along its
    axis) as a region: the union of sections and level faces.

    Raises InputError for a solid that the library cannot cut, or whose sections do not fill its ``volume`` in
    mm³, and for sections that it cannot unite.
    """
    prismatic = [layer for layer in layers if layer.prismatic]
    regions = [cut_solid_at_height(shape, layer.middle) for layer in prismatic]
    if len(prismatic) == len(layers):
        swept = sum(
            measure_area(region) * (layer.high - layer.low)
            for region, layer in zip(regions, layers, strict=True)
        )
        free = any(face.is_free for face in faces)
        refuse_missing_volume(swept, volume, FREE_VOLUME if free else SAME_VOLUME)
    for face in faces:
        if face.lie == "level" and not has_layer(layers, face.low, below=face.upward):
            regions.append(make_level_region(face.shape, face.low, face.upward))
    edges = {z for layer in layers for z in (layer.low, layer.high)}
    folds = {face.fold for face in faces if face.fold is not None and face.low <= face.fold <= face.high}
    widest = -inf
    for z in sorted(edges | folds):
        beside_layer = has_layer(layers, z, below=True) or has_layer(layers, z, below=False)
        if (
            not beside_layer
            and layers[0].low + SAME_HEIGHT < z < layers[-1].high - SAME_HEIGHT
            and z > widest + SAME_HEIGHT
        ):
            widest = z
            regions.append(cut_solid_at_height(shape, z))
    if not regions:
        # The widest piece of a section is in the silhouette too, and shows how far the part departs from it.
        middles = (cut_solid_at_height(shape, layer.middle) for layer in layers)
        regions = [
            max((face for middle in middles for face in list_sub_shapes(middle, "FACE")), key=measure_area)
        ]
    return unite_regions(regions)


def refuse_missing_volume(swept: float, volume: float, tolerance: float) -> None:
    """Raise InputError for a solid whose sections do not fill it: it is open, or runs through itself.

    ``swept`` and ``volume`` are in mm³, ``tolerance`` is a share.
    """
    if abs(swept - volume) > tolerance * volume:
        raise InputError(
            f"the sections of the solid fill {swept:.6g} mm³, but it says to have {volume:.6g} mm³: repair "
            "it in the CAD program and export it again."
        )


def has_layer(layers: Sequence[HeightRange], z: float, *, below: bool) -> bool:
    """Return whether a prismatic layer contains z or ends there.

    With ``below`` the layer's upper end may be at z, otherwise its lower end.

    A layer is a range of heights; it is prismatic if its section is the same at all of them.
    """
    return any(
        abs((layer.high if below else layer.low) - z) <= 2 * SAME_HEIGHT or layer.low < z < layer.high
        for layer in layers
        if layer.prismatic
    )


def make_section_at_height(shape: Any, faces: Sequence[SolidFace], height: float) -> Any:
    """Return the section at a height in mm above the solid's lowest point, as a region.

    Raises InputError for a height outside the part or at a level face, and for a section in several pieces.
    """
    low, high = min(face.low for face in faces), max(face.high for face in faces)
    if not 0 < height < high - low:
        raise InputError(
            f"the section height {height:g} is not within the part, which is {high - low:.6g} mm high along "
            "the axis: give a height above its lowest point, in mm."
        )
    z = low + height
    if any(face.lie == "level" and abs(face.low - z) <= SAME_HEIGHT for face in faces):
        raise InputError(
            f"at the section height {height:g} lies a level face: give a height a little above or below."
        )
    region = cut_solid_at_height(shape, z)
    pieces = len(list_sub_shapes(region, "FACE"))
    if pieces > 1:
        raise InputError(
            f"the section at height {height:g} falls into {pieces} pieces: give a height where the part is "
            "in one."
        )
    return region


def read_shapes(
    shapes: Sequence[Any],
    *,
    axis: str | None = None,
    section_height: float | None = None,
    part_number: int | str | None = None,
    fit: float | None = None,
) -> tuple[Drawing, int | str | None]:
    """Return (1) the drawing of Open CASCADE's shapes in mm, and (2) the number of
    the part that still has to be chosen from the drawing.

    The number is None for solids, because one of them has been chosen already; for flat faces it is
    ``part_number``. For the choices see :func:`workhold.files.step.reader.read_step`; for flat faces the axis
    is found when None. Raises InputError for shapes without solids and faces, and for faces that are not
    flat, or not at one height along an axis.
    """
    solids = list_solids_of_shapes(shapes)
    if solids:
        return read_solid(solids, axis, section_height, part_number, fit), None
    faces = [face for shape in shapes for face in list_sub_shapes(shape, "FACE")]
    if not faces:
        raise InputError("the shape has neither a face nor a solid: make a face of its outline first.")
    if section_height is not None:
        raise InputError("a section is taken of solids, and this is a face: leave the section out.")
    axes = [check_axis_name(axis)] if axis else [*AXES]
    views = [
        [one for face in faces for one in list_sub_shapes(turn_axis_up(face, name), "FACE")] for name in axes
    ]
    level = [view for view in views if are_level_and_coplanar(view)]
    if not level:
        raise InputError(
            f"the faces are not flat, level to an axis and at one height: move them there, or give {AXIS}."
        )
    edges = trace_borders(
        unite_regions([make_level_region(face, compute_bounding_box(face)[0][2], True) for face in level[0]]),
        fit,
    )
    return Drawing(edges.chains, edges.remarks, edges.curves), part_number


def are_level_and_coplanar(faces: Sequence[Any]) -> bool:
    """Return whether faces are flat, perpendicular to z, and all at one height."""
    surfaces = [occ.BRepAdaptor_Surface(face) for face in faces]
    if any(surface.GetType() != occ.GeomAbs_Plane for surface in surfaces):
        return False
    planes = [surface.Plane() for surface in surfaces]
    normals = [plane.Axis().Direction() for plane in planes]
    if any(max(abs(normal.X()), abs(normal.Y())) > ALIGNED for normal in normals):
        return False
    heights = [plane.Location().Z() for plane in planes]
    return bool(max(heights) - min(heights) <= SAME_HEIGHT)
