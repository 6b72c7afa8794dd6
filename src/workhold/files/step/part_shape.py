"""The shape of a result's part, read again from its STEP file: as a mesh, and in Open CASCADE's own form.

A result file has the outline of a part and the heights of its faces, not its shape. So the file that it was
designed from is read again, and must give the same outline.
"""

from __future__ import annotations

from contextlib import suppress
from io import BytesIO
from math import inf
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_HEIGHT
from workhold.errors import InputError
from workhold.files.apart import run_apart
from workhold.files.step.by_height import HeightView, draw_solid_by_height, turn_solid_up
from workhold.files.step.library import list_sub_shapes, load_step_library, occ, read_guarded
from workhold.files.step.reader import prepare
from workhold.files.step.solids import read_solids
from workhold.geometry.loop import compute_signed_area, make_loop_segments
from workhold.geometry.segment import Point
from workhold.model.pose import Pose
from workhold.model.solid import SolidOutline
from workhold.model.workpiece import Workpiece

__all__ = ["PartShape", "make_part_shape", "make_pose_move", "prepare"]

Array = NDArray[np.float64]
# Bands and level faces of a solid as plain data: pairs of heights, and heights with areas.
Levels = dict[str, list[list[float]]]
# How far chords and triangles may be from the shape, in mm and as a turn in radians.
SAGITTA, TURN = 0.05, 0.35
# Outlines agree where their corners do so far, in mm, and their areas to this part.
SAME_CORNER, SAME_AREA = 1e-5, 1e-6


@frozen(eq=False)
class PartShape:
    """The shape of a part in its own coordinates, its axis up, its lowest point at z = 0.

    Parameters
    ----------
    positions, normals : (N, 3) vertices in mm and unit vectors outward.
    triangles : (M, 3) indices of vertices, counter-clockwise from outside.
    kept : the shape as text in Open CASCADE's own format.
    """

    positions: Array
    normals: Array
    triangles: NDArray[np.int64]
    kept: str

    def place_solid(self, pose: Pose) -> Any:
        """Return Open CASCADE's solid in the pose of a fixture."""
        load_step_library()
        shape = occ.TopoDS_Shape()
        occ.BRepTools.Read_s(shape, BytesIO(self.kept.encode("ascii")), occ.BRep_Builder())
        move = make_pose_move(pose)
        # An assembly keeps no place that a solid has of its own: it becomes part of the surfaces.
        move.Multiply(shape.Location().Transformation())
        bare = shape.Located(occ.TopLoc_Location())
        return list_sub_shapes(occ.BRepBuilderAPI_Transform(bare, move, True).Shape(), "SOLID")[0]

    def place_surface(self, pose: Pose) -> tuple[Array, Array, NDArray[np.int64]]:
        """Return the positions (N, 3) in mm, normals (N, 3) and triangles (M, 3) in the pose of a fixture."""
        (ux, uy), (vx, vy), (x, y) = compute_frame(pose)
        turn = np.array([[ux, uy, 0.0], [vx, vy, 0.0], [0.0, 0.0, 1.0]])
        return self.positions @ turn + (x, y, 0.0), self.normals @ turn, self.triangles


def make_pose_move(pose: Pose) -> Any:
    """Return Open CASCADE's transformation from the part's frame to its pose."""
    (ux, uy), (vx, vy), (x, y) = compute_frame(pose)
    move = occ.gp_Trsf()
    move.SetValues(ux, vx, 0.0, x, uy, vy, 0.0, y, 0.0, 0.0, 1.0, 0.0)
    return move


def compute_frame(pose: Pose) -> tuple[Point, Point, Point]:
    """Return the unit vectors to which the part's x and
    y point in a pose, and the place of its origin in mm.
    """
    x, y = (float(one) for one in pose.apply(0.0, 0.0))
    ends = (pose.apply(1.0, 0.0), pose.apply(0.0, 1.0))
    along_x, along_y = ((float(a) - x, float(b) - y) for a, b in ends)
    return along_x, along_y, (x, y)


def make_part_shape(content: bytes, workpiece: Workpiece) -> PartShape:
    """Return the shape of a part from the bytes of the STEP file that its outline was read from.

    Raises
    ------
    InputError
        For a part without a solid, a file that cannot be read, and one that gives another outline.
    """
    solid = workpiece.solid
    if solid is None:
        raise InputError(
            "the part of this result was not read from a solid at the height of the pegs: design it again "
            "from its STEP file to show its shape."
        )
    view = {name: getattr(solid, name) for name in ("axis", "peg_height", "head_room", "least_band")}
    loops = [loop.tolist() for loop in workpiece.loops]
    options = {"view": view, "loops": loops, "height": solid.height, "levels": list_levels(solid)}
    positions, normals, triangles, kept = run_apart(__name__, content, options, "the STEP file")
    return PartShape(np.array(positions), np.array(normals), np.array(triangles, dtype=np.int64), kept)


def list_levels(solid: SolidOutline) -> Levels:
    """Return a solid's bands (z0, z1) and, for each loop of a level face, (z, signed area); in mm and mm².

    The second list is empty if the file does not give the heights of upper faces.
    """
    bands = [[*band] for band in solid.bands if band is not None]
    # Files of an older program do not say how high upper faces are.
    top = solid.top or ()
    if len(solid.top_heights) < len(top):
        return {"bands": bands, "faces": []}
    faces = [*((0.0, loop) for loop in solid.bottom or ()), *zip(solid.top_heights, top, strict=True)]
    sizes = [
        [float(height), float(compute_signed_area(make_loop_segments(np.array(loop))))]
        for height, loop in faces
    ]
    return {"bands": bands, "faces": sizes}


def read_as_plain_data(
    content: bytes, view: dict[str, Any], loops: list[Any], height: float, levels: Levels
) -> Any:
    """Return mesh and text of the solid whose outline is ``loops``; called in the child process of
    :func:`make_part_shape`.
    """
    wanted = [np.array(loop) for loop in loops]
    return read_guarded(
        lambda: find_shape_of_outline(content, HeightView(**view), wanted, height, levels), ValueError
    )


def find_shape_of_outline(
    content: bytes, view: HeightView, loops: list[Array], height: float, levels: Levels
) -> Any:
    """Return positions, normals, triangles and text of the
    first solid of a file that gives some loops and levels.

    Parameters
    ----------
    height : height of the solid in mm; solids of other heights are left out.
    levels : see :func:`list_levels`.

    Raises
    ------
    InputError
        Where no solid of the file gives these loops and levels.
    """
    for solid in read_solids(content):
        found = turn_solid_up(solid, view)
        if abs(found.height - height) > SAME_HEIGHT:
            continue
        with suppress(InputError):
            own = draw_solid_by_height(solid.shape, found, view, is_advised=False, has_table=False)
            if are_same_loops(loops, own.loops) and has_levels(levels, list_levels(own.solid)):
                return *mesh_shape(found.shape), write_shape_text(found.shape)
    raise InputError(
        "no solid of the STEP file gives the outline of the result, as of another part or after a change: "
        "give the file that it was designed from, or design it again."
    )


def are_same_loops(loops: list[Array], others: tuple[Array, ...]) -> bool:
    """Return whether each corner of ``loops`` is near a
    corner of ``others``, and both enclose the same area.
    """
    corners = np.concatenate(others)[:, :2]
    ours = np.concatenate(loops)[:, :2]
    near = np.abs(ours[:, None, :] - corners[None, :, :]).max(axis=2).min(axis=1)
    areas = [
        sum(compute_signed_area(make_loop_segments(loop)) for loop in every) for every in (loops, others)
    ]
    return bool(near.max() <= SAME_CORNER and abs(areas[0] - areas[1]) <= SAME_AREA * abs(areas[0]))


def has_levels(levels: Levels, others: Levels) -> bool:
    """Return whether two solids have the same bands and the same level faces.

    Level faces are compared only if both solids have some.
    """
    faces, other_faces = levels["faces"], others["faces"]
    if faces and other_faces and (len(faces) != len(other_faces) or not hold_same_pairs(faces, other_faces)):
        return False
    return hold_same_pairs(levels["bands"], others["bands"])


def hold_same_pairs(one: list[list[float]], other: list[list[float]]) -> bool:
    """Return whether two lists of number pairs contain the same pairs within tolerance, in any order."""
    a, b = (np.array(pairs).reshape(-1, 2) for pairs in (one, other))
    off = np.abs(a[:, None] - b[None]) - SAME_AREA * np.abs(a[:, None])
    near = off.max(axis=2, initial=-inf) <= SAME_CORNER
    return bool(near.any(axis=1).all() and near.any(axis=0).all())


def write_shape_text(shape: Any) -> str:
    """Return a shape as text in Open CASCADE's own format; its triangles are removed in place first."""
    occ.BRepTools.Clean_s(shape)
    stream = BytesIO()
    occ.BRepTools.Write_s(shape, stream)
    return stream.getvalue().decode("ascii")


def mesh_shape(shape: Any) -> tuple[list[Any], list[Any], list[Any]]:
    """Return positions in mm, outward normals and triangles
    of a shape as lists; each face has its own vertices.

    Triangles are indices from 0, counter-clockwise from outside.
    """
    occ.BRepMesh_IncrementalMesh(shape, SAGITTA, False, TURN, False)
    positions: list[Any] = []
    normals: list[Any] = []
    triangles: list[Any] = []
    for face in list_sub_shapes(shape, "FACE"):
        location = occ.TopLoc_Location()
        mesh = occ.BRep_Tool.Triangulation_s(face, location)
        if mesh is None:
            continue
        occ.BRepLib_ToolTriangulatedShape.ComputeNormals_s(face, mesh)
        turned = face.Orientation() == occ.TopAbs_REVERSED
        move, sign, first = location.Transformation(), -1.0 if turned else 1.0, len(positions)
        for k in range(1, mesh.NbNodes() + 1):
            point, normal = mesh.Node(k).Transformed(move), mesh.Normal(k).Transformed(move)
            positions.append([point.X(), point.Y(), point.Z()])
            normals.append([sign * normal.X(), sign * normal.Y(), sign * normal.Z()])
        for k in range(1, mesh.NbTriangles() + 1):
            a, b, c = (number - 1 + first for number in mesh.Triangle(k).Get())
            triangles.append([a, c, b] if turned else [a, b, c])
    return positions, normals, triangles
