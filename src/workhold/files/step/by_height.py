"""Parts in STEP files seen at the height of the pegs: the outline there, and its touchable segments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from attrs import asdict, astuple, evolve, frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_HEIGHT
from workhold.errors import InputError
from workhold.files import questions
from workhold.files.apart import run_apart
from workhold.files.outline.chain import Drawing
from workhold.files.questions import PEG_HEIGHT
from workhold.files.step.departures import suggest_other_axis
from workhold.files.step.heights import (
    HEAD_ROOM,
    LEAST_BAND,
    OwnDrawing,
    StandingSolid,
    advise_on_height,
    describe_outline_by_height,
    draw_own_outlines,
    stand_solid,
    tabulate_peg_heights,
)
from workhold.files.step.level_faces import collect_level_faces
from workhold.files.step.library import check_axis_name, read_guarded, turn_axis_up
from workhold.files.step.projected import OtherCurveError
from workhold.files.step.reader import convert_drawing_to_data, prepare, read_solid, restore_drawing
from workhold.files.step.solids import (
    Solid,
    choose_solid,
    describe_lost_solids,
    describe_other_solids,
    list_solids_of_shapes,
    read_solids,
)
from workhold.files.step.usual_height import UsualPegHeight, choose_usual_height
from workhold.model.solid import FileSolid, HeightRow, SolidOutline

__all__ = [
    "HeightDrawing",
    "HeightView",
    "prepare",
    "read_by_height",
    "read_by_height_apart",
    "draw_shapes_by_height",
    "draw_shapes_at_usual_height",
]

# Faces times sections of a solid of which the library makes a silhouette within seconds.
MOST_SECTIONS = 3_000


@frozen
class HeightView:
    """The choices by which a solid is seen at the height of the pegs.

    Parameters
    ----------
    axis : direction of the file that points up; z when None.
    peg_height : height in mm, above the plane on which the part lies, up to which pegs reach; the part's
        height when None.
    head_room : space kept free above the pegs, in mm.
    least_band : shortest band that may be touched, in mm.
    heights : lowest and highest z in mm over which carriers with heights of their own reach, by their role.
    peg_diameter : diameter of the pegs in mm, used to choose a height if ``peg_height`` is None; None if not
        known.
    part_number : number or name of the solid to take of several; the largest when None.
    """

    axis: str | None = None
    peg_height: float | None = None
    head_room: float = HEAD_ROOM
    least_band: float = LEAST_BAND
    part_number: int | str | None = None
    heights: Mapping[str, Sequence[float]] = {}
    peg_diameter: float | None = None

    def __attrs_post_init__(self) -> None:
        for name, value, least in (
            (PEG_HEIGHT, self.peg_height, SAME_HEIGHT),
            (questions.HEAD_ROOM, self.head_room, 0.0),
            (questions.LEAST_BAND, self.least_band, 0.0),
        ):
            if value is not None and not least <= value < 1e6:
                raise InputError(
                    f"{name} cannot be {value:g} mm: give {'more than 0' if least else '0 or more'}."
                )


@frozen
class HeightDrawing:
    """The outline of a solid at the height of the pegs.

    Parameters
    ----------
    loops : vertices (N, 3) in mm of every loop; outer ones first, the largest of them before all.
    solid : position and heights of the solid, with the bands of the segments.
    remarks : sentences for the user.
    heights : outlines at other heights of the pegs.
    own : outlines that carriers with heights of their own meet.
    solids : all of the file, the largest first.
    usual : height of pegs that was chosen; None where the user gave one, or the pegs' diameter is not known.
    """

    loops: tuple[NDArray[np.float64], ...]
    solid: SolidOutline
    remarks: tuple[str, ...]
    heights: tuple[HeightRow, ...]
    own: tuple[OwnDrawing, ...] = ()
    solids: tuple[FileSolid, ...] = ()
    usual: UsualPegHeight | None = None


def read_by_height_apart(
    content: bytes, view: HeightView, or_silhouette: bool = False
) -> HeightDrawing | Drawing:
    """Return the result of :func:`read_by_height`, computed in a child process,
    because damaged files crash or hang the library.
    """
    options = {"view": asdict(view), "or_silhouette": or_silhouette}
    by_height, answered = run_apart(__name__, content, options, "the STEP file")
    return restore_height_drawing(answered) if by_height else restore_drawing(answered)


def restore_height_drawing(answered: Any) -> HeightDrawing:
    """Return the drawing made from ``answered``, the plain data that :func:`convert_height_drawing_to_data`
    returns.
    """
    loops, solid, remarks, rows, own, solids, usual = answered
    return HeightDrawing(
        tuple(np.array(loop) for loop in loops),
        SolidOutline(*solid),
        tuple(remarks),
        tuple(HeightRow(*row) for row in rows),
        tuple(OwnDrawing(name, tuple(map(np.array, lines)), SolidOutline(*of)) for name, lines, of in own),
        tuple(FileSolid(*one) for one in solids),
        None if usual is None else UsualPegHeight(*usual),
    )


def read_as_plain_data(content: bytes, view: dict[str, Any], or_silhouette: bool) -> Any:
    """Return (is by height, plain data) for the result of
    :func:`read_by_height`; called in the child process.

    The flag is True for an outline by height and False for a silhouette. Raises InputError also where the
    library, or the arithmetic after it, fails over the file.
    """
    found = read_guarded(lambda: read_by_height(content, HeightView(**view), or_silhouette), ValueError)
    return (
        (False, convert_drawing_to_data(found))
        if isinstance(found, Drawing)
        else (True, convert_height_drawing_to_data(found))
    )


def draw_at_usual_height(solids: tuple[Solid, ...], view: HeightView) -> HeightDrawing | Drawing:
    """Return the outline by height of the solid that the view chooses, or its silhouette if that outline is
    refused.

    An outline is refused where pegs of this height can touch nothing, or where its border has a curve that is
    neither line nor arc. The silhouette proposes lines and arcs in place of such curves; it has no heights,
    and pegs may touch leaning faces.
    """
    chosen = choose_solid(solids, view.part_number)
    solid = read_guarded(lambda: turn_solid_up(chosen, view))
    try:
        drawing = read_guarded(
            lambda: draw_solid_by_height(chosen.shape, solid, view, is_advised=False), ValueError
        )
    except InputError as error:
        refusal = error
    else:
        return evolve(
            drawing, remarks=(*describe_other_solids(solids, chosen, view.part_number), *drawing.remarks)
        )
    # A curve of the border is known to be neither line nor arc, and sections may offer others in its place.
    is_curve = isinstance(refusal.__cause__, OtherCurveError)
    try:
        if is_curve and takes_long_by_sections(solid):
            raise refusal
        silhouette = read_solid(solids, view.axis, None, view.part_number, None)
    except InputError:
        if is_curve:
            raise add_height_advice(refusal, solid, view) from refusal
        raise
    if read_guarded(lambda: is_prism(solid)):
        return silhouette
    unknown = f"At which heights its faces are touched is not known: {refusal}"
    return evolve(silhouette, remarks=(*silhouette.remarks, unknown))


def takes_long_by_sections(solid: StandingSolid) -> bool:
    """Return whether making a solid's silhouette from sections would take the library too long."""
    heights = {round(z, 5) for face in solid.faces if face.lie != "upright" for z in (face.low, face.high)}
    return len(heights) * len(solid.faces) > MOST_SECTIONS


def convert_height_drawing_to_data(drawing: HeightDrawing) -> Any:
    """Return an outline by height as nested lists, from
    which :func:`restore_height_drawing` makes it again.
    """
    loops = [loop.tolist() for loop in drawing.loops]
    rows = [astuple(row) for row in drawing.heights]
    own = [(one.role, [loop.tolist() for loop in one.loops], astuple(one.solid)) for one in drawing.own]
    solids = [astuple(one) for one in drawing.solids]
    usual = None if drawing.usual is None else astuple(drawing.usual)
    return loops, astuple(drawing.solid), drawing.remarks, rows, own, solids, usual


def read_by_height(content: bytes, view: HeightView, or_silhouette: bool = False) -> HeightDrawing | Drawing:
    """Return the outline of a solid in a STEP file at the height of the pegs.

    Raises InputError for files that cannot be read, and outlines that are not made of lines and arcs.

    Parameters
    ----------
    or_silhouette : return the silhouette where there is no such outline, see :func:`draw_at_usual_height`.
    """
    solids = read_solids(content)
    found = draw_at_usual_height(solids, view) if or_silhouette else draw_by_height(solids, view)
    remarks = (*describe_lost_solids(content, solids), *found.remarks)
    return evolve(found, remarks=remarks, solids=tuple(solid.listed for solid in solids))


def draw_shapes_by_height(shapes: Sequence[Any], view: HeightView) -> HeightDrawing:
    """Return the outline of one solid of Open CASCADE's shapes at the height of the pegs.

    Raises InputError for shapes without a solid.
    """
    solids = list_solids_of_shapes(shapes)
    if not solids:
        raise InputError(f"only a solid has heights, and the shape holds none: leave {PEG_HEIGHT} out.")
    return draw_by_height(solids, view)


def draw_shapes_at_usual_height(shapes: Sequence[Any], view: HeightView) -> HeightDrawing | Drawing | None:
    """Return the result of :func:`draw_at_usual_height` for the solids in Open
    CASCADE's shapes; None for shapes without a solid.
    """
    solids = list_solids_of_shapes(shapes)
    return draw_at_usual_height(solids, view) if solids else None


def draw_by_height(solids: tuple[Solid, ...], view: HeightView) -> HeightDrawing:
    """Return the outline by height of the solid that the view chooses, with a remark on the other solids."""
    chosen = choose_solid(solids, view.part_number)
    drawing = draw_solid_by_height(chosen.shape, turn_solid_up(chosen, view), view)
    return evolve(
        drawing, remarks=(*describe_other_solids(solids, chosen, view.part_number), *drawing.remarks)
    )


def turn_solid_up(chosen: Solid, view: HeightView) -> StandingSolid:
    """Return a solid turned so that the view's axis points up, and moved
    so that its lowest point is at z = 0.

    Raises InputError for an unknown axis.
    """
    axis = check_axis_name(view.axis)
    # Along z it is not turned, and its box is known.
    return stand_solid(turn_axis_up(chosen.shape, axis), chosen.low[2] if axis == "z" else None)


def draw_solid_by_height(
    shape: Any,
    solid: StandingSolid,
    view: HeightView,
    *,
    is_advised: bool = True,
    has_table: bool = True,
) -> HeightDrawing:
    """Return the outline of a solid at the height of the pegs, with remarks on what may be touched.

    Raises InputError for an outline that cannot be made or has nothing to touch.

    Parameters
    ----------
    shape : the solid as the file has it.
    solid : the same solid turned with its axis up, its lowest point at z = 0.
    is_advised : whether a refusal names a height that helps.
    has_table : whether ``heights`` of the result is filled. Like ``is_advised``, this tries many heights,
        which takes time.
    """
    axis, room, least = check_axis_name(view.axis), view.head_room, view.least_band
    plain_prism = view.peg_height is None and is_prism(solid)
    rows = list[HeightRow]()
    usual: UsualPegHeight | None = None
    if view.peg_height is None and view.peg_diameter is not None:
        rows = [] if plain_prism else tabulate_peg_heights(solid, room, least)
        usual = choose_usual_height(solid, rows, view.peg_diameter, room, least, plain_prism)
    try:
        outline = solid.make_outline(view.peg_height if usual is None else usual.peg_height, room, least)
    except InputError as error:
        refusal = InputError(f"along {axis}: {error}.")
        raise add_height_advice(refusal, solid, view) if is_advised else refusal from error
    if not any(outline.bands):
        raise InputError(
            f"along {axis} no upright face of the part is at least {least:g} mm high below "
            f"{outline.peg_height:g} mm: {advise_on_height(solid, room, least)}."
        )
    sizes = (solid.height, outline.peg_height, room, least)
    found = SolidOutline(axis, *sizes, outline.bands, outline.faces, **collect_level_faces(solid))
    found = evolve(found, runs=outline.runs)
    own = tuple(draw_own_outlines(solid, view.heights, found))
    if usual is None and has_table and not plain_prism:
        rows = tabulate_peg_heights(solid, room, least)
    remarks = [] if plain_prism else describe_outline_by_height(outline, found, rows)
    remarks += [] if usual is None else usual.remarks
    if any(band is None for band in outline.bands):
        remarks += suggest_other_axis(shape, axis)
    return HeightDrawing(outline.vertices, found, tuple(remarks), tuple(rows), own, usual=usual)


def add_height_advice(refusal: InputError, solid: StandingSolid, view: HeightView) -> InputError:
    """Return the error with advice on another height of pegs appended."""
    instead = advise_on_height(solid, view.head_room, view.least_band)
    return InputError(f"{str(refusal).removesuffix('.')}; {instead}.")


def is_prism(solid: StandingSolid) -> bool:
    """Return whether a solid has only upright faces, and level faces at its bottom and top."""
    ends = (0.0, solid.height)
    return all(
        face.lie == "upright" or (face.lie == "level" and min(abs(face.low - z) for z in ends) <= SAME_HEIGHT)
        for face in solid.faces
    )
