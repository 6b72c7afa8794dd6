"""How far the part of a fixture is bent, from its outline and thickness or from its STEP file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from attrs import evolve, fields

from workhold.bending.asking import BendingQuestion, find_bendings
from workhold.bending.figures import Bending
from workhold.bending.shape import KeptShape, PartToBend, PrismShape
from workhold.drawing.bent_part import choose_exaggeration, compute_node_colours
from workhold.errors import InputError
from workhold.files.glb import Mesh, make_bodies_glb, make_surface_mesh
from workhold.files.step.part_shape import PartShape
from workhold.model.bodies import BodySizes, list_fixture_bodies
from workhold.model.elastic_material import ElasticMaterial, find_material
from workhold.model.part_bending import BendingFigures, PadsBelow, find_bending_figure
from workhold.model.pose import Pose
from workhold.model.straps import StrappedHold
from workhold.presenting.assembly import read_part_shape
from workhold.statics.loads import read_jaw_stiffness
from workhold.units import MILLIMETRE

if TYPE_CHECKING:
    from workhold.model.fixture import Fixture
    from workhold.model.query import Query
    from workhold.model.result import Result
    from workhold.model.support_triples import Supports

__all__ = [
    "bend_result",
    "find_sheet_bending",
    "compute_bending",
    "compute_sheet_bending",
    "make_bent_glb",
    "make_bent_mesh",
    "find_pads_below",
    "make_shape_to_bend",
]


def make_shape_to_bend(query: Query, asked: BendingQuestion, shape: PartShape | None) -> PartToBend:
    """Return the shape to bend of a query's part: ``shape`` from its STEP file, or if that is None a prism.

    Raises
    ------
    InputError
        For a part that was read from a solid, if ``shape`` is None, and where nothing gives the prism's height.
    """
    if shape is not None:
        return KeptShape(shape.kept)
    if query.workpiece.solid is not None:
        raise InputError(
            "how far a solid bends depends on all of its shape, which a result does not have: give its STEP file as well."
        )
    return PrismShape(query.workpiece, asked.find_part_height(query))


def make_question(
    material: str | ElasticMaterial,
    thickness: float | None,
    jaw_force: float | None,
    jaw: str | float,
    faces: Sequence[int | str],
) -> BendingQuestion:
    """Return a question of bending from arguments as :meth:`workhold.Fixture.bending` takes them."""
    known = find_material(material) if isinstance(material, str) else material
    return BendingQuestion(known, thickness, jaw_force, tuple(faces), read_jaw_stiffness(jaw))


def find_bending(fixture: Fixture, asked: BendingQuestion, shape: PartShape | None) -> Bending:
    """Return how far one fixture bends its part; ``shape`` as for :func:`make_shape_to_bend`."""
    listed = fixture.listing
    whole = make_shape_to_bend(listed.result.query, asked, shape)
    return find_bendings(listed.result, [listed.row], whole, asked)[0]


def find_pads_below(
    supports: Supports, best: int, shape: PartShape | None, clamp_force: float | None
) -> PadsBelow:
    """Return the pads and the clamp on top of the set with rank ``best``, from 1, of three supports.

    ``clamp_force`` is in N; None takes the force that the set needs. Raises InputError if there is no such
    set.
    """
    if not 1 <= best <= len(supports.triples):
        raise InputError(f"there is no set {best} of supports: choose from 1 to {len(supports.triples)}.")
    triple, request = supports.triples[best - 1], supports.request
    x, y = triple.clamp.at
    top = request.thickness if shape is None else find_top_over(shape, x, y)
    force = triple.clamp.clamp_needed if clamp_force is None else clamp_force
    pads = np.array([(pad.x, pad.y) for pad in triple.supports])
    return PadsBelow(pads, request.pad_radius, np.array([x, y, top]), request.tip_radius, force)


def find_top_over(shape: PartShape, x: float, y: float) -> float:
    """Return the height in mm of the highest face over (x, y) in the part's frame.

    Raises InputError if no face is over the point.
    """
    a, b, c = np.moveaxis(shape.positions[shape.triangles], 1, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1])
        second = ((x - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (y - a[:, 1])) / area
        third = ((b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (x - a[:, 0]) * (b[:, 1] - a[:, 1])) / area
    over = (second >= -1e-9) & (third >= -1e-9) & (second + third <= 1 + 1e-9)
    heights = a[:, 2] + second * (b[:, 2] - a[:, 2]) + third * (c[:, 2] - a[:, 2])
    if not over.any():
        raise InputError(
            "the clamp on top stands beside the part: give the STEP file that belongs to the result."
        )
    return float(heights[over].max())


def compute_bending(
    fixture: Fixture,
    material: str | ElasticMaterial,
    *,
    thickness: float | None = None,
    jaw_force: float | None = None,
    jaw: str | float = "screw",
    faces: Sequence[int | str] = (),
    part: str | Path | None = None,
    supports: Supports | None = None,
    best: int = 1,
    clamp_force: float | None = None,
    straps: StrappedHold | None = None,
) -> Bending:
    """Return how far a fixture bends its part, see :meth:`workhold.Fixture.bending`."""
    listed = fixture.listing
    shape = read_part_shape(part, listed.result.workpiece)
    below = {}
    if supports is not None:
        below[listed.row] = find_pads_below(supports, best, shape, clamp_force)
    if straps is not None and supports is not None:
        raise InputError("straps press the part on their own supports: leave one of straps and supports out.")
    asked = make_question(material, thickness, jaw_force, jaw, faces)
    held = {} if straps is None else {listed.row: straps}
    return find_bending(fixture, evolve(asked, below=below, straps=held), shape)


def bend_result(
    result: Result,
    material: str | ElasticMaterial,
    *,
    best: int = 20,
    rank_by: str | None = None,
    thickness: float | None = None,
    jaw_force: float | None = None,
    jaw: str | float = "screw",
    faces: Sequence[int | str] = (),
    part: str | Path | None = None,
) -> Result:
    """Return a result with how far its best fixtures bend their part, see :meth:`workhold.Result.bend`."""
    asked = make_question(material, thickness, jaw_force, jaw, faces)
    if type(best) is not int or best < 1:
        raise InputError(f"best {best!r} is not a number of fixtures: give a whole number from 1.")
    rows = list_rows_to_bend(result, best)
    key = None if rank_by is None else find_bending_figure(rank_by).key
    shape = read_part_shape(part, result.workpiece)
    found = find_bendings(result, rows, make_shape_to_bend(result.query, asked, shape), asked)
    return result.add_bending({row: one.to_figures() for row, one in zip(rows, found, strict=True)}, key)


def list_rows_to_bend(result: Result, best: int) -> list[int]:
    """Return the indices, from 0, of the first ``best`` fixtures of a result; seats for which no straps were found are
    left out.

    Raises
    ------
    InputError
        Where there are none.
    """
    if not len(result):
        raise InputError("the result lists no fixture: there is nothing to bend.")
    rows = []
    for row in range(len(result)):
        hold = result[row].hold
        if not isinstance(hold, StrappedHold) or hold.straps:
            rows.append(row)
        if len(rows) == best:
            break
    if not rows:
        raise InputError(
            "no seat of the result has straps, so that nothing bends its part: design it again with a load."
        )
    return rows


def find_sheet_bending(
    fixture: Fixture, settings: dict[str, Any], shape: PartShape | None
) -> BendingFigures | None:
    """Return how far a fixture bends its part, for its setup sheet; None where neither the settings name a material nor
    its result file says it.

    What the file says is shown with a picture where its mesh can be made, and without one otherwise.

    Parameters
    ----------
    settings, shape : see :func:`compute_sheet_bending`.
    """
    told = fixture.bent
    if settings.get("material") is not None or told is None:
        return compute_sheet_bending(fixture, settings, shape)
    below = {} if told.below is None else {fixture.listing.row: told.below}
    asked = BendingQuestion(told.material, told.thickness, told.jaw_force, told.faces, told.stiffness, below)
    try:
        drawn = find_bending(fixture, asked, shape)
    except InputError:
        return told
    return evolve(drawn, **{one.name: getattr(told, one.name) for one in fields(BendingFigures)})


def compute_sheet_bending(
    fixture: Fixture, settings: dict[str, Any], shape: PartShape | None
) -> Bending | None:
    """Return how far a fixture bends its part, for its setup sheet; None if the settings name no material.

    Parameters
    ----------
    settings : the fields of a :class:`workhold.asking.sheet.SheetQuestion`.
    shape : shape of the part from its own file; None to use a prism.
    """
    if settings.get("material") is None:
        return None
    asked = make_question(
        settings["material"], settings["thickness"], settings["jaw_force"], settings["jaw"], ()
    )
    return find_bending(fixture, asked, shape)


def make_bent_mesh(bending: Bending, pose: Pose) -> Mesh:
    """Return the mesh of the bent part in the pose of a fixture.

    Its movement is exaggerated, and colours show the true size of the movement.
    """
    surface, times = bending.surface, choose_exaggeration(bending)
    places = surface.nodes + times * bending.moved
    turned = np.column_stack([pose.apply(places[:, :2]), places[:, 2]])
    a, b, c, ab, bc, ca = surface.triangles.T
    small = np.concatenate(
        [np.stack(three, axis=1) for three in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    )
    corners = turned[small]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing /= np.maximum(np.linalg.norm(facing, axis=1), 1e-30)[:, None]
    # Each triangle has vertices of its own, so that edges stay sharp.
    mesh = make_surface_mesh(
        corners.reshape(-1, 3),
        np.repeat(facing, 3, axis=0),
        np.arange(3 * len(small)).reshape(-1, 3),
        compute_node_colours(bending)[small].reshape(-1, 3),
    )
    most = bending.clamp_distortion
    warnings = bending.list_warnings(None, MILLIMETRE)
    told = {"most": most.value, "error": most.error, "times": times, "warnings": warnings}
    return evolve(mesh, about={"bent": told})


def make_bent_glb(fixture: Fixture, bending: Bending) -> bytes:
    """Return the bytes of a GLB file of a fixture, with its part bent (exaggerated) and coloured by its
    movement.
    """
    result = fixture.listing.result
    height = float(bending.surface.nodes[:, 2].max())
    sizes = BodySizes.from_workpiece(result.workpiece, thickness=height)
    bodies = list_fixture_bodies(fixture, result.workpiece, result.toolkit, sizes)
    name = f"{bodies[0].name}, bent {choose_exaggeration(bending):,.0f} times as far"
    return make_bodies_glb(bodies, name, make_bent_mesh(bending, fixture.pose))
