"""The shape of a job's part, from the STEP file that it was read from, so that its bodies show it.

A request for a search has an outline and the heights of its faces, not a shape. The file is sent once more,
and what was made of it stays with the job.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from attrs import frozen

from workhold.errors import InputError
from workhold.model.workpiece import Workpiece
from workhold.web.worker import Order

if TYPE_CHECKING:
    from workhold.files.step.part_shape import PartShape

__all__ = ["ShapeOrder", "find_shape", "shape_size"]

# Bytes of a shape that a job keeps at most.
MOST_BYTES = 64_000_000


@frozen(eq=False)
class ShapeOrder:
    """Which part to find in which file.

    Parameters
    ----------
    content : of the STEP file.
    name : what the user calls it.
    workpiece : whose outline one of its solids gives.
    """

    content: bytes
    name: str
    workpiece: Workpiece


def find_shape(payload: ShapeOrder, order: Order) -> PartShape:
    """Finds the solid that gives the outline of a part, and makes a mesh of it.

    Raises
    ------
    InputError
        For a file that cannot be read, one of another part, and a shape too large to keep.
    """
    from workhold.files.step.part_shape import part_shape

    try:
        shape = part_shape(payload.content, payload.workpiece)
        if shape_size(shape) > MOST_BYTES:
            raise InputError(
                f"the shape of the part takes more than {MOST_BYTES // 1_000_000} MB to show: leave out "
                "threads, letters and other small things when you save it."
            )
    except InputError as error:
        raise InputError(f"{payload.name or 'the file'}: {error}") from error
    return shape


def shape_size(shape: PartShape | None) -> int:
    """Returns about how many bytes a shape takes."""
    if shape is None:
        return 0
    return shape.positions.nbytes + shape.normals.nbytes + shape.triangles.nbytes + len(shape.kept)
