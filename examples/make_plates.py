"""Draw ``rectangle.dxf``, a plate of 100 x 60 mm, and ``nema34.dxf``, a plate of 100 x 100 mm for a NEMA 34 motor: run
``python examples/make_plates.py`` in any folder.

The motor's face has a pilot of 73.03 mm and four holes on a square of 69.58 mm (NEMA ICS 16); the corners are rounded.
"""

from __future__ import annotations

import sys
from math import pi, tan
from pathlib import Path

import ezdxf

SIDE, CORNER_RADIUS = 100.0, 6.0
PILOT, HOLES_APART, HOLE = 73.1, 69.58, 5.6


def rectangle(path: Path) -> None:
    """Write the plain plate."""
    document = ezdxf.new("R2000")
    document.header["$INSUNITS"] = 4
    document.modelspace().add_lwpolyline([(0, 0), (100, 0), (100, 60), (0, 60)], close=True)
    document.saveas(path)


def motor_plate(path: Path) -> None:
    """Write the plate of the motor."""
    document = ezdxf.new("R2000")
    document.header["$INSUNITS"] = 4
    space, quarter = document.modelspace(), tan(pi / 8)
    near, far = CORNER_RADIUS, SIDE - CORNER_RADIUS
    corners = [(near, 0), (far, 0), (SIDE, near), (SIDE, far), (far, SIDE), (near, SIDE), (0, far), (0, near)]
    points = [(x, y, quarter if number % 2 else 0.0) for number, (x, y) in enumerate(corners)]
    space.add_lwpolyline(points, format="xyb", close=True)
    space.add_circle((SIDE / 2, SIDE / 2), PILOT / 2)
    for x in (-HOLES_APART / 2, HOLES_APART / 2):
        for y in (-HOLES_APART / 2, HOLES_APART / 2):
            space.add_circle((SIDE / 2 + x, SIDE / 2 + y), HOLE / 2)
    document.saveas(path)


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    rectangle(folder / "rectangle.dxf")
    motor_plate(folder / "nema34.dxf")
