"""What a shape of Open CASCADE is made of, and the box about it."""

from __future__ import annotations

from typing import Any

__all__ = ["bounding_box", "sub_shapes"]

# Its x, y and z in mm.
Corner = tuple[float, float, float]


def sub_shapes(shape: Any, kind: str) -> list[Any]:
    """The parts of one kind of a shape, each as often as it is used.

    Parameters
    ----------
    kind : "SOLID", "FACE", "WIRE", "EDGE" or "VERTEX".
    """
    from OCP import TopAbs
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    cast = getattr(TopoDS, kind.capitalize())
    explorer = TopExp_Explorer(shape, getattr(TopAbs.TopAbs_ShapeEnum, f"TopAbs_{kind}"))
    found = []
    while explorer.More():
        found.append(cast(explorer.Current()))
        explorer.Next()
    return found


def bounding_box(shape: Any) -> tuple[Corner, Corner]:
    """Both corners of a shape's bounding box in mm, to rounding."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    return (low.X(), low.Y(), low.Z()), (high.X(), high.Y(), high.Z())
