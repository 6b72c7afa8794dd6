"""All bodies of a set-up, on supports with a clamp on top or without: in files, build123d and CadQuery.

A GLB file and a STEP assembly show the same bodies, in the same places and colours, see ``model.bodies``.

A solid of build123d or CadQuery becomes a workpiece, a fixture an assembly. Both libraries wrap shapes of
Open CASCADE, so nothing goes through a file. An assembly is in the frame of the toolkit, or placed around the
part in the part's own model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from attrs import frozen

from workhold.errors import InputError
from workhold.files.atomic import write_bytes
from workhold.files.glb import make_bodies_glb, make_surface_mesh
from workhold.files.part.data import list_wrapped_shapes
from workhold.files.part.finding import read_bytes
from workhold.files.part.load import load
from workhold.files.replacing import refuse_output
from workhold.files.step.heights import find_foot_height
from workhold.files.step.library import (
    check_axis_name,
    compute_bounding_box,
    list_sub_shapes,
    turn_along,
    turn_axis_up,
)
from workhold.files.step.part_shape import make_pose_move
from workhold.files.step.writer import make_named_solids
from workhold.model.bodies import COLOURS, BodySizes, FixtureBody, list_fixture_bodies
from workhold.model.setup import PartZero, choose_part_zero
from workhold.model.support_bodies import list_bodies_with_supports, size_supported_bodies
from workhold.model.support_triples import ChosenSupports
from workhold.presenting.data import import_library

if TYPE_CHECKING:
    from workhold.files.step.part_shape import PartShape
    from workhold.fixels.toolkit import Toolkit
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.model.support_triples import Supports
    from workhold.model.workpiece import Workpiece

__all__ = [
    "GLB_ENDINGS",
    "STEP_ENDINGS",
    "Assembly",
    "from_build123d",
    "from_cadquery",
    "save_glb",
    "read_part_shape",
    "to_build123d",
    "to_cadquery",
]

GLB_ENDINGS, STEP_ENDINGS = (".glb",), (".step", ".stp")
AXES = {
    (1.0, 0.0, 0.0): "x",
    (0.0, 1.0, 0.0): "y",
    (0.0, 0.0, 1.0): "z",
    (-1.0, 0.0, 0.0): "-x",
    (0.0, -1.0, 0.0): "-y",
    (0.0, 0.0, -1.0): "-z",
}
# Of a direction's coordinates.
SAME = 1e-9
# Of a part's size in mm.
SAME_SIZE = 1e-3


@frozen(eq=False)
class Assembly:
    """The bodies of a set-up.

    Parameters
    ----------
    fixture : the fixture that the bodies show.
    result : the result that lists it, with its part and toolkit.
    sizes : heights of the bodies.
    bodies : the part first.
    shape : of the part, as its own file has it; None where the part's body is a prism.
    """

    fixture: Fixture
    result: Result
    sizes: BodySizes
    bodies: tuple[FixtureBody, ...]
    shape: PartShape | None = None

    @classmethod
    def from_fixture(
        cls,
        fixture: Fixture,
        result: Result,
        lengths: Mapping[str, Any],
        chosen: ChosenSupports | None = None,
        shape: PartShape | None = None,
    ) -> Assembly:
        """Return the bodies of a fixture; with chosen supports, those of the fixture moved to fit the
        supports' holes.

        Parameters
        ----------
        lengths : in mm, by the parameter names of :meth:`BodySizes.from_workpiece`, or with supports by those
            of :func:`workhold.model.support_bodies.size_supported_bodies`.
        chosen : a set of supports; None for none.
        shape : of the part, as its own file has it; None shows the part as a prism.

        Raises
        ------
        InputError
            For lengths that are not positive, and for pegs and pads of radius 0.
        """
        if chosen is None:
            if fixture.hold is not None and lengths.get("thickness") is None:
                lengths = {**lengths, "thickness": result.query.part_height}
            sizes = BodySizes.from_workpiece(result.workpiece, **lengths)
            bodies = list_fixture_bodies(fixture, result.workpiece, result.toolkit, sizes)
            return cls(fixture, result, sizes, bodies, shape)
        sizes = size_supported_bodies(chosen.supports, **lengths)
        return cls(chosen.recounted.fixture, result, sizes, list_bodies_with_supports(chosen, sizes), shape)

    @property
    def is_simplified(self) -> bool:
        """Whether the part is shown as a prism although its solid is known to have another shape."""
        solid = self.result.workpiece.solid
        return (
            solid is not None
            and self.shape is None
            and not (
                all(band == (0.0, solid.height) for band in solid.bands)
                and all(height == solid.height for height in solid.top_heights)
            )
        )

    def make_file_content(self, ending: str, zero: PartZero | None = None) -> bytes:
        """Return the bytes of a GLB or STEP file of the bodies.

        Parameters
        ----------
        ending : one of :data:`GLB_ENDINGS` or :data:`STEP_ENDINGS`.
        zero : part zero in a STEP file; None takes the usual one, see :func:`choose_part_zero`.

        Raises
        ------
        InputError
            For a STEP file when the extra ``step`` is not installed.
        """
        shape, pose = self.shape, self.fixture.pose
        if ending in GLB_ENDINGS:
            mesh = None if shape is None else make_surface_mesh(*shape.place_surface(pose))
            return make_bodies_glb(self.bodies, f"{self.bodies[0].name} set-up", mesh)
        from workhold.files.step.writer import make_bodies_step

        point = (zero or choose_part_zero(self.result.workpiece)).point
        solid = None if shape is None else shape.place_solid(pose)
        return make_bodies_step(self.bodies, self.result.toolkit, point, pose, solid)

    def write(self, path: str | Path) -> None:
        """Write a GLB or STEP file, as its ending says.

        Raises
        ------
        InputError
            As :meth:`make_file_content`, for another ending, and when the file cannot be written.
        """
        ending = Path(path).suffix.lower()
        if ending not in GLB_ENDINGS + STEP_ENDINGS:
            raise InputError(f"{path} is not the name of such a file: let it end in .glb or .step.")
        write_bytes(path, self.make_file_content(ending))


def read_part_shape(path: str | Path | None, workpiece: Workpiece) -> PartShape | None:
    """Return the shape of a part from the STEP file ``path`` that the part was read from; None if ``path`` is
    None.

    Raises
    ------
    InputError
        When the file cannot be read, or holds another part; the message names the file.
    """
    if path is None:
        return None
    if workpiece.finished is not None:
        raise InputError(
            f"{workpiece.name} is shown as a prism in its raw block: leave the part's own file out."
        )
    from workhold.files.step.part_shape import make_part_shape

    try:
        return make_part_shape(read_bytes(Path(path)), workpiece)
    except InputError as error:
        raise InputError(f"{Path(path).name}: {error}") from error


def save_glb(
    fixture: Fixture,
    path: str | Path,
    *,
    thickness: float | None = None,
    supports: Supports | None = None,
    best: int = 1,
    part: str | Path | None = None,
    overwrite: bool = False,
) -> None:
    """Write a GLB file, see :meth:`workhold.Fixture.save_glb`."""
    if Path(path).suffix.lower() not in GLB_ENDINGS:
        raise InputError(f"{path} is not the name of a GLB file: let the name end in {GLB_ENDINGS[0]}.")
    refuse_output(path, (part,), overwrite)
    chosen = None if supports is None else ChosenSupports.from_fixture(fixture, supports, best)
    result = fixture.listing.result
    shape = read_part_shape(part, result.workpiece)
    assembly = Assembly.from_fixture(fixture, result, {"thickness": thickness}, chosen, shape)
    write_bytes(path, assembly.make_file_content(GLB_ENDINGS[0]))


def from_build123d(
    part: Any,
    up: Any = "z",
    *,
    name: str | None = None,
    part_number: int | str | None = None,
    fit: float | None = None,
    section: float | None = None,
    peg_height: float | None = None,
    head_room: float | None = None,
    least_band: float | None = None,
    heights: Mapping[str, Sequence[float]] | None = None,
    toolkit: Toolkit | None = None,
) -> Workpiece:
    """Return a workpiece from a part of build123d, as :func:`workhold.load` does from a file.

    Parameters
    ----------
    part : a solid, part, sketch, face or builder.
    up : what points up: an ``Axis``, a ``Plane`` or a vector along an axis, or a name such as "-z".
    name, part_number, fit, section, peg_height, head_room, least_band, heights, toolkit : as of
        :func:`workhold.load`.

    Raises
    ------
    InputError
        For a direction along no axis, and as :func:`workhold.load`.
    """
    return load(
        part,
        axis=find_axis_name(up),
        name=name,
        part_number=part_number,
        fit=fit,
        section=section,
        peg_height=peg_height,
        head_room=head_room,
        least_band=least_band,
        heights=heights,
        toolkit=toolkit,
    )


def from_cadquery(
    part: Any,
    up: Any = "z",
    *,
    name: str | None = None,
    part_number: int | str | None = None,
    fit: float | None = None,
    section: float | None = None,
    peg_height: float | None = None,
    head_room: float | None = None,
    least_band: float | None = None,
    heights: Mapping[str, Sequence[float]] | None = None,
    toolkit: Toolkit | None = None,
) -> Workpiece:
    """Return a workpiece from a work plane or a shape of CadQuery, as :func:`from_build123d` does.

    Parameters
    ----------
    part : a work plane, solid or compound.
    up : what points up in the set-up: a vector or plane along an axis, or its name, such as "-z".
    name, part_number, fit, section, peg_height, head_room, least_band, heights, toolkit : as of
        :func:`workhold.load`.

    Raises
    ------
    InputError
        As :func:`from_build123d`.
    """
    return load(
        part,
        axis=find_axis_name(up),
        name=name,
        part_number=part_number,
        fit=fit,
        section=section,
        peg_height=peg_height,
        head_room=head_room,
        least_band=least_band,
        heights=heights,
        toolkit=toolkit,
    )


def find_axis_name(up: Any) -> str:
    """Return the name of the axis, such as "-z", along which ``up`` points: an axis, a plane, a vector or a
    name.

    >>> find_axis_name((0, 0, -2))
    '-z'

    Raises
    ------
    InputError
        For a direction along no axis.
    """
    if isinstance(up, str):
        return check_axis_name(up)
    vector = next((getattr(up, name) for name in ("direction", "zDir", "z_dir") if hasattr(up, name)), up)
    to_tuple = getattr(vector, "toTuple", None)
    try:
        x, y, z = map(float, to_tuple() if to_tuple else vector)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"{type(up).__name__} is not a direction: give an axis, a plane, a vector, or a name such as '-z'."
        ) from error
    length = max(abs(x), abs(y), abs(z))
    for direction, name in AXES.items():
        if length and all(
            abs(one / length - other) <= SAME for one, other in zip((x, y, z), direction, strict=True)
        ):
            return name
    raise InputError(f"the direction ({x:g}, {y:g}, {z:g}) is along none of x, y and z: turn the part first.")


def to_build123d(
    fixture: Fixture,
    around: Any = None,
    *,
    thickness: float | None = None,
    supports: Supports | None = None,
    best: int = 1,
) -> Any:
    """Return a set-up as a compound of build123d, see :meth:`workhold.Fixture.to_build123d`."""
    cad = import_library("build123d")
    children = []
    for name, shape, colour in make_bodies(fixture, around, thickness, supports, best):
        child = cad.Compound.cast(shape)
        child.label = name
        child.color = cad.Color(*colour)
        children.append(child)
    return cad.Compound(label=make_title(fixture), children=children)


def to_cadquery(
    fixture: Fixture,
    around: Any = None,
    *,
    thickness: float | None = None,
    supports: Supports | None = None,
    best: int = 1,
) -> Any:
    """Return a set-up as an assembly of CadQuery, see :meth:`workhold.Fixture.to_cadquery`."""
    cad = import_library("cadquery")
    assembly = cad.Assembly(name=make_title(fixture))
    for name, shape, colour in make_bodies(fixture, around, thickness, supports, best):
        assembly.add(cad.Shape.cast(shape), name=name, color=cad.Color(*colour, 1.0))
    return assembly


def make_title(fixture: Fixture) -> str:
    """Return the part's name and the fixture's rank."""
    listed = fixture.listing
    return f"{listed.result.workpiece.name} fixture {listed.rank}"


def make_bodies(
    fixture: Fixture, around: Any, thickness: float | None, supports: Supports | None, best: int
) -> list[tuple[str, Any, tuple[float, float, float]]]:
    """Return (name, shape of Open CASCADE, colour) of each body of a set-up, the part first.

    Colours are red, green and blue from 0 to 1. With ``around``, the part's own solid, all bodies are in that
    solid's model frame; with None, in the toolkit's frame. ``best`` is the rank, from 1, of the set of
    supports.
    """
    result = fixture.listing.result
    chosen = None if supports is None else ChosenSupports.from_fixture(fixture, supports, best)
    assembly = Assembly.from_fixture(fixture, result, {"thickness": thickness}, chosen)
    if around is None:
        return make_named_solids(assembly.bodies)
    own = find_own_shape(around)
    move = make_location_to_model(own, result.workpiece, assembly.fixture)
    part, *others = assembly.bodies
    moved = [(name, shape.Moved(move), colour) for name, shape, colour in make_named_solids(others)]
    return [(part.name, own, COLOURS[part.kind]), *moved]


def find_own_shape(part: Any) -> Any:
    """Return the one solid of a part as a shape of Open CASCADE.

    Raises
    ------
    InputError
        For a part without a solid, or with several.
    """
    solids = [solid for shape in list_wrapped_shapes(part) for solid in list_sub_shapes(shape, "SOLID")]
    if len(solids) != 1:
        raise InputError(f"around is a part with {len(solids)} solids: give the one that was designed for.")
    return solids[0]


def make_location_to_model(shape: Any, workpiece: Workpiece, fixture: Fixture) -> Any:
    """Return the location of Open CASCADE that carries the toolkit's frame into the model frame of the part's
    solid.

    Raises
    ------
    InputError
        For a part that was not read from a solid, and for a solid of another size.
    """
    from OCP.gp import gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location

    solid = workpiece.solid
    if solid is None:
        raise InputError("the part was not read from a solid, so it is not known where its model lies.")
    turned = turn_axis_up(shape, solid.axis)
    low, high = compute_bounding_box(turned)
    x0, y0, x1, y1 = workpiece.bounds
    room = min(x0 - low[0], y0 - low[1], high[0] - x1, high[1] - y1)
    if room < -SAME_SIZE or abs(high[2] - low[2] - solid.height) > SAME_SIZE:
        raise InputError(f"around is another part than {workpiece.name}: give the one that was designed for.")
    foot = gp_Trsf()
    foot.SetTranslation(gp_Vec(0.0, 0.0, -find_foot_height(turned)))
    there = make_pose_move(fixture.pose).Multiplied(foot).Multiplied(turn_along(solid.axis))
    return TopLoc_Location(there.Inverted())
