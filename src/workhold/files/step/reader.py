"""Parts in STEP files, or in shapes of another library: the outline of a prismatic part, in mm.

The outline is the silhouette along an axis: where some height of the part has material. Round pegs parallel
to the axis touch a part just there. It is the union of the sections of all layers, of level faces, and of the
sections where leaning faces meet or fold. Each of these lies in the silhouette, and afterwards every face is
looked at whether it reaches out of the union. Or it is the section at a height that the user chose. Shapes of
Open CASCADE that another library has made are solids seen along an axis, or flat faces, which are taken as
they are.
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
from workhold.files.step.departures import Outline, departure_remarks, refuse_overhang
from workhold.files.step.faces import Layer, SolidFace, layers_of, solid_faces
from workhold.files.step.library import (
    AXES,
    along,
    axis_named,
    bounding_box,
    guarded,
    load_step_library,
    occ,
    sub_shapes,
)
from workhold.files.step.regions import area_of, borders, level_region, section, union
from workhold.files.step.solids import (
    Solid,
    chosen_solid,
    lost_remarks,
    read_solids,
    solid_remarks,
    solids_of_shapes,
)
from workhold.geometry.segment import Line, segment_rows
from workhold.kernels.base.distance import is_inside, outline_distances
from workhold.model.solid import FileSolid

__all__ = [
    "drawing_of",
    "plain",
    "prepare",
    "read_shapes",
    "read_solid",
    "read_step",
    "read_step_apart",
]


def read_step_apart(content: bytes, **options: Any) -> Drawing:
    """Runs :func:`read_step` in a process of its own: damaged files crash or hang the library."""
    return drawing_of(run_apart(__name__, content, options, "the STEP file"))


def drawing_of(answered: Any) -> Drawing:
    """The drawing of what :func:`plain_drawing` makes."""
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
    """Loads the library, and compile what the reader calls, see :func:`workhold.files.apart.run_apart`."""
    load_step_library()
    rows = segment_rows(
        [Line((0.0, 0.0), (1.0, 0.0)), Line((1.0, 0.0), (0.0, 1.0)), Line((0.0, 1.0), (0.0, 0.0))]
    )
    is_inside(0.2, 0.2, rows)
    outline_distances(np.zeros((1, 2)), rows)


def plain(content: bytes, **options: Any) -> Any:
    """Chains and remarks of :func:`read_step` as plain data.

    Refuses a file over which the library or the arithmetic after it fails, too.
    """
    return guarded(lambda: plain_drawing(read_step(content, **options)))


def plain_drawing(drawing: Drawing) -> Any:
    """A drawing as plain data, see :func:`drawing_of`."""
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
    """Reads the outline of a solid in a STEP file.

    Parameters
    ----------
    axis : "x", "y" or "z" (the default): the direction of the file that the pegs are parallel to. The part is
        seen from the axis's far end. So x and y of the outline are y and z of the file for "x", or z and x
        for "y". With a minus before it the part lies on its other side, turned over like a page.
    section_height : take the section at this height in mm above the part's lowest point, instead of the
        silhouette.
    part_number : which solid to take of several, its number from 1 by decreasing volume, or its name; the
        largest when None.
    fit : how far lines and arcs may be from true curves, in mm; None keeps a proposal in their place, see
        ``Drawing``.

    Raises
    ------
    InputError
        For files that cannot be read, and parts whose silhouette is not that of their upright faces.
    """
    solids = read_solids(content)
    drawing = read_solid(solids, axis, section_height, part_number, fit)
    remarks = (*lost_remarks(content, solids), *drawing.remarks)
    return evolve(drawing, remarks=remarks, solids=tuple(solid.listed for solid in solids))


def read_solid(
    solids: tuple[Solid, ...],
    axis: str | None,
    section_height: float | None,
    part_number: int | str | None,
    fit: float | None,
) -> Drawing:
    """The outline of one of some solids, see :func:`read_step`."""
    axis = axis_named(axis)
    solid = chosen_solid(solids, part_number)
    shape = along(solid.shape, axis)
    faces = solid_faces(shape)
    layers = layers_of(faces)
    if section_height is None:
        region = silhouette(shape, solid.volume, faces, layers)
    else:
        region = chosen_section(shape, faces, section_height)
    edges = borders(region, fit)
    outline = Outline.of(edges, area_of(region), faces)
    if section_height is None:
        refuse_overhang(outline, faces, solid.shape, axis)
    remarks = [
        *solid_remarks(solids, solid, part_number),
        *edges.remarks,
        *departure_remarks(outline, faces, layers, shape, solid.shape, axis, section_height),
    ]
    return Drawing(edges.chains, tuple(remarks), edges.curves)


def silhouette(shape: Any, volume: float, faces: Sequence[SolidFace], layers: Sequence[Layer]) -> Any:
    """The union of everything flat that the silhouette must hold.

    Refuses a solid that the library cannot cut, and sections that it cannot unite.
    """
    prismatic = [layer for layer in layers if layer.prismatic]
    regions = [section(shape, layer.middle) for layer in prismatic]
    if len(prismatic) == len(layers):
        swept = sum(
            area_of(region) * (layer.high - layer.low) for region, layer in zip(regions, layers, strict=True)
        )
        free = any(face.is_free for face in faces)
        refuse_missing_volume(swept, volume, FREE_VOLUME if free else SAME_VOLUME)
    for face in faces:
        if face.lie == "level" and not has_layer(layers, face.low, below=face.upward):
            regions.append(level_region(face.shape, face.low, face.upward))
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
            regions.append(section(shape, z))
    if not regions:
        # The widest piece of a section is in the silhouette too, and shows how far the part departs from it.
        middles = (section(shape, layer.middle) for layer in layers)
        regions = [max((face for middle in middles for face in sub_shapes(middle, "FACE")), key=area_of)]
    return union(regions)


def refuse_missing_volume(swept: float, volume: float, tolerance: float) -> None:
    """Refuses a solid whose sections do not fill it: it is open, or runs through itself. Volumes are in mm³."""
    if abs(swept - volume) > tolerance * volume:
        raise InputError(
            f"the sections of the solid fill {swept:.6g} mm³, but it says to have {volume:.6g} mm³: repair "
            "it in the CAD program and export it again."
        )


def has_layer(layers: Sequence[Layer], z: float, *, below: bool) -> bool:
    """Whether a prismatic layer ends at z from below, or begins there, or holds z."""
    return any(
        abs((layer.high if below else layer.low) - z) <= 2 * SAME_HEIGHT or layer.low < z < layer.high
        for layer in layers
        if layer.prismatic
    )


def chosen_section(shape: Any, faces: Sequence[SolidFace], height: float) -> Any:
    """The section at a height above the lowest point.

    Refuses a height outside the part or at a level face, and a section that falls into pieces.
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
    region = section(shape, z)
    pieces = len(sub_shapes(region, "FACE"))
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
    """The drawing of some shapes, and the number of the part that is still to be taken of it.

    Shapes are those of Open CASCADE, in mm. For the choices see :func:`workhold.files.step.reader.read_step`;
    faces that are level need no axis. Refuses shapes without solids and faces, and faces that are not flat,
    or not at one height along an axis.
    """
    solids = solids_of_shapes(shapes)
    if solids:
        return read_solid(solids, axis, section_height, part_number, fit), None
    faces = [face for shape in shapes for face in sub_shapes(shape, "FACE")]
    if not faces:
        raise InputError("the shape has neither a face nor a solid: make a face of its outline first.")
    if section_height is not None:
        raise InputError("a section is taken of solids, and this is a face: leave the section out.")
    axes = [axis_named(axis)] if axis else [*AXES]
    views = [[one for face in faces for one in sub_shapes(along(face, name), "FACE")] for name in axes]
    level = [view for view in views if lie_level(view)]
    if not level:
        raise InputError(
            f"the faces are not flat, level to an axis and at one height: move them there, or give {AXIS}."
        )
    edges = borders(union([level_region(face, bounding_box(face)[0][2], True) for face in level[0]]), fit)
    return Drawing(edges.chains, edges.remarks, edges.curves), part_number


def lie_level(faces: Sequence[Any]) -> bool:
    """Whether faces are flat and level, all at one height."""
    surfaces = [occ.BRepAdaptor_Surface(face) for face in faces]
    if any(surface.GetType() != occ.GeomAbs_Plane for surface in surfaces):
        return False
    planes = [surface.Plane() for surface in surfaces]
    normals = [plane.Axis().Direction() for plane in planes]
    if any(max(abs(normal.X()), abs(normal.Y())) > ALIGNED for normal in normals):
        return False
    heights = [plane.Location().Z() for plane in planes]
    return bool(max(heights) - min(heights) <= SAME_HEIGHT)
