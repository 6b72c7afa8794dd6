"""Bodies that the command hands over as upright prisms, made by FreeCAD's own modeller."""

import FreeCAD as App
import Part

__all__ = ["solids_of"]


def solids_of(bodies):
    """The solids of bodies with their names; one in pieces as several.

    Parameters
    ----------
    bodies : for each its name and its slabs, as the command ``workbench`` describes them.
    """
    named = []
    for body in bodies:
        first, *others = [prism(slab) for slab in body["slabs"]]
        shape = first.fuse(others) if others else first
        for number, solid in enumerate(shape.Solids, 1):
            name = body["name"] if number == 1 else "{} piece {}".format(body["name"], number)
            named.append((name, solid))
    return named


def prism(slab):
    """The solid over a border with holes in it, between two heights."""
    outer, *holes = [Part.Wire([edge(segment) for segment in border]) for border in slab["borders"]]
    solid = raised(outer, slab)
    return solid.cut([raised(hole, slab) for hole in holes]) if holes else solid


def raised(border, slab):
    """The solid over a border without holes, between two heights."""
    face = Part.Face(border)
    face.translate(App.Vector(0, 0, slab["low"]))
    return face.extrude(App.Vector(0, 0, slab["high"] - slab["low"]))


def edge(segment):
    """A line by its ends, or an arc by its centre, radius and angles, as an edge at z = 0."""
    if len(segment) == 4:
        x, y, to_x, to_y = segment
        return Part.LineSegment(App.Vector(x, y, 0), App.Vector(to_x, to_y, 0)).toShape()
    x, y, radius, start, end = segment
    circle = Part.Circle(App.Vector(x, y, 0), App.Vector(0, 0, 1), radius)
    return Part.ArcOfCircle(circle, start, end).toShape()
