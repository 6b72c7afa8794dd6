"""All bodies of a set-up as a GLB file or a STEP assembly: with supports and a clamp on top, or without.

Both files show the same bodies, in the same places and colours, see ``model.bodies``.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from attrs import frozen

from workhold.errors import InputError
from workhold.files.atomic import write_bytes
from workhold.files.glb import bodies_glb, surface_mesh
from workhold.files.part.finding import read_bytes
from workhold.model.bodies import BodySizes, FixtureBody, fixture_bodies
from workhold.model.recounted import ChosenSupports
from workhold.model.setup import PartZero, part_zero
from workhold.model.support_bodies import bodies_with_supports, supported_sizes

if TYPE_CHECKING:
    from workhold.files.step.part_shape import PartShape
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.model.support_triples import Supports
    from workhold.model.workpiece import Workpiece

__all__ = ["GLB_ENDINGS", "STEP_ENDINGS", "Assembly", "save_glb", "shape_in"]

GLB_ENDINGS, STEP_ENDINGS = (".glb",), (".step", ".stp")


@frozen(eq=False)
class Assembly:
    """The bodies of a set-up.

    Parameters
    ----------
    fixture : the one that they stand as.
    result : which has its part and toolkit.
    sizes : heights.
    bodies : the part first.
    shape : of the part, as its own file has it; None where the prism of its body stands for it.
    """

    fixture: Fixture
    result: Result
    sizes: BodySizes
    bodies: tuple[FixtureBody, ...]
    shape: PartShape | None = None

    @classmethod
    def of(
        cls,
        fixture: Fixture,
        result: Result,
        lengths: Mapping[str, Any],
        chosen: ChosenSupports | None = None,
        shape: PartShape | None = None,
    ) -> Assembly:
        """Makes the bodies of a fixture; on a set of supports where one is chosen, counted as its holes are.

        Parameters
        ----------
        lengths : in mm, named as in :meth:`BodySizes.of`, or as in
            :func:`workhold.model.support_bodies.supported_sizes` for a set of supports.

        Raises
        ------
        InputError
            For lengths that are not positive, and for pegs and pads of radius 0.
        """
        if chosen is None:
            sizes = BodySizes.of(result.workpiece, **lengths)
            bodies = fixture_bodies(fixture, result.workpiece, result.toolkit, sizes)
            return cls(fixture, result, sizes, bodies, shape)
        sizes = supported_sizes(chosen.supports, **lengths)
        return cls(chosen.recounted.fixture, result, sizes, bodies_with_supports(chosen, sizes), shape)

    @property
    def is_simplified(self) -> bool:
        """Whether the part's solid is another shape than the prism that stands for it, as far as is known."""
        solid = self.result.workpiece.solid
        return (
            solid is not None
            and self.shape is None
            and not (
                all(band == (0.0, solid.height) for band in solid.bands)
                and all(height == solid.height for height in solid.top_heights)
            )
        )

    def content(self, ending: str, zero: PartZero | None = None) -> bytes:
        """The bytes of a file with an ending of :data:`GLB_ENDINGS` or :data:`STEP_ENDINGS`.

        Parameters
        ----------
        zero : part zero in a STEP file; that of :func:`part_zero` without a wish if None.

        Raises
        ------
        InputError
            For a STEP file when the extra ``step`` is not installed.
        """
        shape, pose = self.shape, self.fixture.pose
        if ending in GLB_ENDINGS:
            mesh = None if shape is None else surface_mesh(*shape.surface(pose))
            return bodies_glb(self.bodies, f"{self.bodies[0].name} set-up", mesh)
        from workhold.files.step.writer import bodies_step

        point = (zero or part_zero(self.result.workpiece)).point
        solid = None if shape is None else shape.solid(pose)
        return bodies_step(self.bodies, self.result.toolkit, point, pose, solid)

    def write(self, path: str | Path) -> None:
        """Writes a file of the kind that its ending names.

        Raises
        ------
        InputError
            As :meth:`content`, for another ending, and when the file cannot be written.
        """
        ending = Path(path).suffix.lower()
        if ending not in GLB_ENDINGS + STEP_ENDINGS:
            raise InputError(f"{path} is not the name of such a file: let it end in .glb or .step.")
        write_bytes(path, self.content(ending))


def shape_in(path: str | Path | None, workpiece: Workpiece) -> PartShape | None:
    """The shape of a part in the STEP file that it was read from; None without a file.

    Raises
    ------
    InputError
        Naming the file, where it cannot be read, or is of another part.
    """
    if path is None:
        return None
    from workhold.files.step.part_shape import part_shape

    try:
        return part_shape(read_bytes(Path(path)), workpiece)
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
) -> None:
    """Writes a GLB file, see :meth:`workhold.Fixture.save_glb`."""
    chosen = None if supports is None else ChosenSupports.of(supports, best)
    result = fixture.listing.result
    shape = shape_in(part, result.workpiece)
    assembly = Assembly.of(fixture, result, {"thickness": thickness}, chosen, shape)
    write_bytes(path, assembly.content(GLB_ENDINGS[0]))
