"""Draw ``bracket.dxf``, a lever plate of 120 x 70 mm: run ``python examples/make_bracket.py`` in any folder.

The outline is loose lines and arcs, as most CAD programs write them: a rounded end about a bolt hole, a slanted side
tangent to it, a concave fillet, a convex corner radius and a chamfer; inside, two bolt holes and a slot. A centre line,
a dimension and a text on other layers are there to be ignored.
"""

from __future__ import annotations

import sys
from math import acos, atan2, cos, degrees, hypot, sin
from pathlib import Path

import ezdxf

END, END_RADIUS = (102.0, 18.0), 18.0  # centre and radius of the rounded end, which reaches x = 120
FILLET_RADIUS = 14.0  # concave, between the post's side x = 46 and the slanted side
CORNER_RADIUS = 8.0  # convex, at the post's upper left


def draw(path: Path) -> None:
    """Write the drawing."""
    document = ezdxf.new("R2000", setup=True)
    document.header["$INSUNITS"] = 4
    for name, color in (("OUTLINE", 7), ("CENTER", 1), ("NOTES", 3)):
        document.layers.add(name, color=color)
    space = document.modelspace()
    outline, notes = {"layer": "OUTLINE"}, {"layer": "NOTES"}

    # The slanted side leaves the rounded end at its highest tangent point and meets the fillet tangentially. With a
    # unit normal n pointing up to the outside, the line is n . p = h; the fillet's centre is its radius outside of it.
    through = (46.0, 52.0)  # where side and slant would meet without the fillet
    dx, dy = END[0] - through[0], END[1] - through[1]
    away = hypot(dx, dy)
    turn = atan2(-dy, -dx) - acos(END_RADIUS / away)
    nx, ny = cos(turn), sin(turn)
    tangent = (END[0] + END_RADIUS * nx, END[1] + END_RADIUS * ny)
    height = tangent[0] * nx + tangent[1] * ny
    fx = 46.0 + FILLET_RADIUS
    fy = (height + FILLET_RADIUS - nx * fx) / ny
    foot = (fx - FILLET_RADIUS * nx, fy - FILLET_RADIUS * ny)

    space.add_line((12, 0), (END[0], 0), outline)
    space.add_arc(END, END_RADIUS, -90, degrees(turn), dxfattribs=outline)
    space.add_line(foot, tangent, outline)
    space.add_arc((fx, fy), FILLET_RADIUS, 180, degrees(atan2(-ny, -nx)), dxfattribs=outline)
    space.add_line((46, fy), (46, 70), outline)
    space.add_line((46, 70), (CORNER_RADIUS, 70), outline)
    space.add_arc((CORNER_RADIUS, 70 - CORNER_RADIUS), CORNER_RADIUS, 90, 180, dxfattribs=outline)
    space.add_line((0, 70 - CORNER_RADIUS), (0, 20), outline)
    space.add_line((0, 20), (12, 0), outline)

    space.add_circle(END, 6.5, outline)
    space.add_circle((16, 54), 4.5, outline)
    space.add_lwpolyline(
        [(24, 14, 0), (60, 14, 1), (60, 24, 0), (24, 24, 1)], format="xyb", close=True, dxfattribs=outline
    )

    space.add_line((-6, END[1]), (126, END[1]), {"layer": "CENTER", "linetype": "CENTER"})
    space.add_text("LEVER PLATE, 10 THICK", height=4, dxfattribs=notes).set_placement((52, 62))
    space.add_linear_dim(base=(0, -15), p1=(12, 0), p2=(END[0], 0), dxfattribs=notes).render()
    document.saveas(path)


if __name__ == "__main__":
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name("bracket.dxf"))
