"""Sentences on the deviation of a solid from a prism over its outline.

Glossary
--------
inset : how far a face lies inside the outline, seen along the axis, in mm.
overhang : how far a face reaches outside the outline, in mm.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import DEPARTS, FREE_AREA, OVERHANG, SAME_AREA, SAME_HEIGHT
from workhold.errors import InputError
from workhold.files.outline.chain import list_first_items
from workhold.files.outline.joining import make_closed_loop
from workhold.files.outline.nesting import DrawnPart, nest_loops
from workhold.files.questions import AXIS, SECTION
from workhold.files.step.faces import HeightRange, SolidFace, classify_lie, sample_surface_points
from workhold.files.step.library import AXES, list_sub_shapes, occ
from workhold.files.step.regions import RegionBorders, cut_solid_at_height, measure_area
from workhold.geometry.loop import compute_signed_area, make_loop_segments, reverse_vertices
from workhold.geometry.segment import make_segment_rows
from workhold.kernels.base.distance import is_inside, measure_outline_distances

__all__ = ["FoundOutline", "describe_departures", "suggest_other_axis", "refuse_overhang"]


@frozen
class FoundOutline:
    """The outline of a solid, and how far each of its faces is inside or outside of it.

    Parameters
    ----------
    area : area of the outline in mm².
    low, high : z of the solid's lowest and highest point, in mm.
    insets, overhangs : how far each face lies inside the outline and reaches outside it, in mm; 0 if it does
        not.
    departure : largest distance in mm of lines and arcs from curves of the border; a face may deviate from
        them by as much.
    """

    area: float
    low: float
    high: float
    insets: tuple[float, ...]
    overhangs: tuple[float, ...]
    departure: float = 0.0

    @classmethod
    def from_borders(cls, edges: RegionBorders, area: float, faces: Sequence[SolidFace]) -> FoundOutline:
        """Measure faces against the outline that the borders of a region make.

        ``area`` is the region's, in mm².

        Raises
        ------
        InputError
            When the borders do not enclose one region of that area, so that the library's work cannot be
            right.
        """
        parts = nest_loops([make_closed_loop(chain) for chain in edges.chains])
        border = sum(
            segment.length
            for part in parts
            for loop in part.loops
            for segment in make_loop_segments(loop.vertices)
        )
        allowed = (FREE_AREA if edges.curves else 1e-6) * area + edges.departure * border
        if len(parts) != 1 or abs(parts[0].area - area) > allowed:
            raise InputError(
                f"the sections of the solid do not make one outline: give another {AXIS}, or {SECTION}, or "
                "repair the solid in the CAD program."
            )
        rows = make_oriented_rows(parts[0])
        insets, overhangs = [], []
        for face in faces:
            points = sample_surface_points(face)
            away = measure_outline_distances(points, rows)
            inside = np.array([bool(is_inside(x, y, rows)) for x, y in points])
            insets.append(float(np.where(inside, away, 0.0).max(initial=0.0)))
            overhangs.append(float(np.where(inside, 0.0, away).max(initial=0.0)))
        low, high = min(face.low for face in faces), max(face.high for face in faces)
        return cls(area, low, high, tuple(insets), tuple(overhangs), edges.departure)


def make_oriented_rows(part: DrawnPart) -> NDArray[np.float64]:
    """Return the rows (N, 10) of the segments of all loops of a part for the kernels. Each loop runs with the
    material on its left.

    The first loop of the part is its outer one.
    """
    rows = []
    for k, loop in enumerate(part.loops):
        segments = make_loop_segments(loop.vertices)
        if (compute_signed_area(segments) > 0) != (k == 0):
            segments = make_loop_segments(reverse_vertices(loop.vertices))
        rows.append(make_segment_rows(segments))
    return np.concatenate(rows)


def refuse_overhang(outline: FoundOutline, faces: Sequence[SolidFace], solid: Any, axis: str) -> None:
    """Raise InputError if a face reaches out of the silhouette, whose true
    border is then not made of lines and circles.

    For the advice in the message, ``solid`` is the solid as the file has it, and ``axis`` the direction that
    points up.
    """
    worst = int(np.argmax(outline.overhangs))
    if outline.overhangs[worst] <= OVERHANG + outline.departure:
        return
    face = faces[worst]
    name = find_other_axis(solid, axis)
    another = f", or {AXIS} {name}" if name else ""
    raise InputError(
        f"along {axis} the silhouette is not made of lines and circles: a {face.kind} at "
        f"{describe_face_heights(outline, face)} reaches {outline.overhangs[worst]:.3g} mm out of what is; give "
        f"{SECTION}, the height above the part's lowest point (0 to {outline.high - outline.low:.6g} mm) at "
        f"which the pegs touch{another}."
    )


def describe_departures(
    outline: FoundOutline,
    faces: Sequence[SolidFace],
    layers: Sequence[HeightRange],
    shape: Any,
    solid: Any,
    axis: str,
    section_height: float | None,
) -> list[str]:
    """Return sentences on how a part differs from a prism, and where pegs have to touch; [] for a prism.

    A section of a prism gives one sentence that says so.

    Parameters
    ----------
    layers : layers of the faces, see :func:`workhold.files.step.faces.make_layers`.
    shape, solid : the same solid with its axis up (``shape``) and as the file has it (``solid``).
    section_height : height in mm of the section that was chosen; None for the silhouette.
    """
    groups = list_departures(outline, faces)
    chosen = section_height is not None
    if not groups and max(outline.overhangs) <= OVERHANG + outline.departure:
        return ["The part is prismatic: its section is the same at every height."] if chosen else []
    remarks = [f"Not prismatic along {axis}: {list_first_items(groups)}."] if groups else []
    if chosen:
        over = max(outline.overhangs)
        reach = (
            f", and at other heights the part reaches up to {over:.3g} mm out of it"
            if over > OVERHANG + outline.departure
            else ""
        )
        remarks.append(
            f"The outline is the section at height {section_height:g} mm{reach}: pegs have to touch there."
        )
    else:
        remarks.append(describe_silhouette(outline, layers, shape))
    if any(face.lie == "leaning" for face in faces):
        remarks += suggest_other_axis(solid, axis)
    return remarks


def suggest_other_axis(solid: Any, axis: str) -> list[str]:
    """Return one sentence on another axis along which all faces
    of a solid are level or upright; [] where there is none.
    """
    name = find_other_axis(solid, axis)
    return (
        [f"Along {name} no face leans: give {AXIS} {name} if the pegs are parallel to that."] if name else []
    )


def list_departures(outline: FoundOutline, faces: Sequence[SolidFace]) -> list[str]:
    """Return phrases on the faces that are not part of the outline, those farthest from it first.

    Faces that are described alike share one phrase.
    """
    together: dict[tuple[str, str], list[float]] = defaultdict(list)
    for face, inset, overhang in zip(faces, outline.insets, outline.overhangs, strict=True):
        if face.lie != "level" and (face.lie == "leaning" or inset > DEPARTS + outline.departure):
            together[face.kind, describe_face_heights(outline, face)].append(max(inset, overhang))
    ordered = sorted(together.items(), key=lambda item: (-max(item[1]), item[0]))
    return [
        f"{kind} at {where}{f' ({len(sizes)} of them)' if len(sizes) > 1 else ''}, "
        f"up to {max(sizes):.3g} mm from the outline"
        for (kind, where), sizes in ordered
    ]


def describe_face_heights(outline: FoundOutline, face: SolidFace) -> str:
    """Return "heights a to b mm" for a face, above the solid's lowest point."""
    return f"heights {describe_height_range(outline, face.low, face.high)}"


def describe_height_range(outline: FoundOutline, low: float, high: float) -> str:
    """Return two z in mm as heights above the solid's lowest point, "a to b mm", without rounding errors."""
    first, last = (round(z - outline.low, 6) + 0.0 for z in (low, high))
    return f"{first:.6g} to {last:.6g} mm"


def describe_silhouette(outline: FoundOutline, layers: Sequence[HeightRange], shape: Any) -> str:
    """Return a sentence on the heights at which the section equals the whole silhouette.

    It also says at which height the section is smallest, and by which area it is smaller than the silhouette.
    """
    whole: list[tuple[float, float]] = []
    lacks: list[tuple[float, float]] = []
    for layer in layers:
        height = layer.high - layer.low
        probed = [layer.middle] if layer.prismatic else [layer.low + s * height for s in (0.01, 0.5, 0.99)]
        found = [(outline.area - measure_area(cut_solid_at_height(shape, z)), z) for z in probed]
        lacks += found
        if layer.prismatic and found[0][0] <= SAME_AREA * outline.area:
            if whole and layer.low - whole[-1][1] <= 2 * SAME_HEIGHT:
                whole[-1] = (whole[-1][0], layer.high)
            else:
                whole.append((layer.low, layer.high))
    worst, z = max(lacks)
    share = f"{worst:.3g} mm² ({100 * worst / outline.area:.2g} %)"
    lack = f"the section at height {z - outline.low:.6g} mm has {share} less"
    if not whole:
        return (
            f"The outline is the silhouette; no range of heights has all of it ({lack}): pegs have to reach "
            "over all heights."
        )
    ranges = " and ".join(describe_height_range(outline, low, high) for low, high in whole)
    where = f"the section at heights {ranges} ({lack})"
    return f"The outline is the silhouette, which is {where}: pegs have to touch there."


def find_other_axis(solid: Any, axis: str) -> str:
    """Return "x", "y" or "z", other than ``axis``, along which
    all faces of a solid are level or upright; "" for none.
    """
    surfaces = [occ.BRepAdaptor_Surface(face) for face in list_sub_shapes(solid, "FACE")]
    for name, (_, _, up) in AXES.items():
        if name != axis.lstrip("-") and all(classify_lie(surface, up) != "leaning" for surface in surfaces):
            return name
    return ""
